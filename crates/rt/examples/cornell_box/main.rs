//! The Cornell box of `steradian render builtin:cornell-box-area` by a path tracer that is written as shaders. A path
//! goes on in a loop of the ray-generation shader, or with the argument `recursive` in the closest-hit shader: the
//! picture is the same. Written to `cornell_box.png`.

pub mod scene;

use scene::{Sphere, Surface, on_sphere, records};
use std::error::Error;
use steradian_image::Image;
use steradian_math::{Vec3, hash::HashRng};
use steradian_rt::{context::*, *};

/// Most rays of a path.
pub const MAX_RAYS: u32 = 31;

/// A path on its way.
struct Path {
    rng: HashRng,
    throughput: Vec3,
    radiance: Vec3,
    rays: u32,
    next: Option<RayDesc>,
}

enum Light {}
impl Interface for Light {
    type Payload = Path;
    /// The normal of a sphere.
    type Attributes = Vec3;
    type Parameter = ();
    type Local = Surface;
    type Output = Vec3;
}

/// Traces a number of paths from a seed.
struct Camera<'s>(&'s TopLevel, u32, u64);
impl RayGeneration<Light> for Camera<'_> {
    fn run(&self, context: &mut RayGenerationContext<Light>) -> Result<Vec3, Fault> {
        let LaunchValues { id: [x, y, _], size: [width, height, _] } = context.launch();
        let mut rng = HashRng::new(self.2 << 40 ^ u64::from(y) << 20 ^ u64::from(x));
        let mut sum = Vec3::ZERO;
        for _ in 0..self.1 {
            let on_plane = |i: u32, n: u32, jitter: f32| 2.0 * (i as f32 + jitter) / n as f32 - 1.0;
            let (x, y) = (on_plane(x, width, rng.next_f32()), -on_plane(y, height, rng.next_f32()));
            let ray = RayDesc::new(Vec3::new(0.0, 0.0, -3.5), Vec3::new(x, y, 3.0).normalize());
            let rng = HashRng::new(rng.next_u64());
            let mut path = Path { rng, throughput: Vec3::ONE, radiance: Vec3::ZERO, rays: 1, next: Some(ray) };
            while let Some(ray) = path.next.take() {
                context.trace(&TraceRay::new(self.0, ray), &mut path)?;
            }
            sum += path.radiance;
        }
        Ok(sum / self.1 as f32)
    }
}

/// A matt surface.
struct Matt<'s> {
    scene: &'s TopLevel,
    is_recursive: bool,
}

impl Matt<'_> {
    fn scatter(&self, context: &mut ClosestHitContext<Light>, path: &mut Path, normal: Vec3) -> Result<(), Fault> {
        let (Surface { albedo, emission }, ray) = (*context.local(), context.ray());
        path.radiance += path.throughput * emission;
        path.throughput *= albedo;
        let normal = context.primitive().world_normal(normal).unwrap_or(Vec3::Y);
        let normal = if normal.dot(ray.direction) > 0.0 { -normal } else { normal };
        let direction = (normal + on_sphere(&mut path.rng)).try_normalize().unwrap_or(normal);
        if path.rays < MAX_RAYS {
            path.rays += 1;
            let next = RayDesc::new(ray.origin + ray.direction * ray.t_current + normal * 1e-4, direction);
            match self.is_recursive {
                true => context.trace(&TraceRay::new(self.scene, next), path)?,
                false => path.next = Some(next),
            }
        }
        Ok(())
    }
}

impl ClosestHit<Light, Barycentrics> for Matt<'_> {
    fn run(&self, context: &mut ClosestHitContext<Light>, path: &mut Path, _: &Barycentrics) -> Result<(), Fault> {
        let [a, b, c] = context.primitive().triangle().unwrap_or_default();
        self.scatter(context, path, (b - a).cross(c - a))
    }
}

impl ClosestHit<Light, Vec3> for Matt<'_> {
    fn run(&self, context: &mut ClosestHitContext<Light>, path: &mut Path, normal: &Vec3) -> Result<(), Fault> {
        self.scatter(context, path, *normal)
    }
}

/// Radiance, pixel by pixel.
pub fn render(width: u32, samples: u32, seed: u64, is_recursive: bool) -> Result<Vec<Vec3>, Box<dyn Error>> {
    let scene = scene::scene()?;
    let closest_hit = || Matt { scene: &scene, is_recursive };
    let wall: Box<dyn HitGroup<Light>> = Box::new(TriangleGroup { any_hit: (), closest_hit: closest_hit() });
    let sphere = Box::new(ProceduralGroup { intersection: Sphere, any_hit: (), closest_hit: closest_hit() });
    let library = Library::<Light, _, _>::new()
        .with_ray_generation(Export::new("camera", Camera(&scene, samples, seed)))
        .with_hit_group(Export::new("wall", wall))
        .with_hit_group(Export::new("sphere", sphere));
    let max_recursion_depth = if is_recursive { MAX_RAYS } else { 1 };
    let pipeline = Pipeline::link([library], PipelineConfig { max_recursion_depth, ..Default::default() })?;
    let records = records(pipeline.hit_group("wall"), pipeline.hit_group("sphere"));
    let tables = ShaderTables::new(Record { handle: pipeline.ray_generation("camera"), local: Surface::default() })
        .with_hit_groups(ShaderTable::new(records))
        .with_miss(ShaderTable::new(vec![Record::null(Surface::default())]));
    Ok(pipeline.launch(&tables, [width, width, 1])?)
}

#[allow(dead_code, reason = "tests include this file")]
fn main() -> Result<(), Box<dyn Error>> {
    let is_recursive = std::env::args().any(|argument| argument == "recursive");
    let colors: Vec<_> = render(256, 16, 0, is_recursive)?.iter().map(Vec3::to_array).collect();
    Ok(steradian_image::write("cornell_box.png".as_ref(), &Image::from_rgb(256, 256, &colors)?, &Default::default())?)
}
