//! Leaves: cards of two triangles, of which an any-hit shader lets through what is no leaf. Written to `leaves.png`.

use std::{error::Error, sync::Arc};
use steradian_image::Image;
use steradian_math::{Vec3, hash::HashRng};
use steradian_rt::{context::*, *};

const SIZE: [u32; 3] = [320, 240, 1];
const LIGHT: Vec3 = Vec3::new(0.6, 0.64, -0.48);

enum Leaves {}
impl Interface for Leaves {
    type Payload = Vec3;
    type Attributes = ();
    type Parameter = ();
    type Local = ();
    type Output = Vec3;
}

struct Camera<'s>(&'s TopLevel);
impl RayGeneration<Leaves> for Camera<'_> {
    fn run(&self, context: &mut RayGenerationContext<Leaves>) -> Result<Vec3, Fault> {
        let LaunchValues { id: [x, y, _], size: [width, height, _] } = context.launch();
        let x = (2.0 * x as f32 + 1.0 - width as f32) / height as f32;
        let y = 1.0 - (2.0 * y as f32 + 1.0) / height as f32;
        let mut color = Vec3::ZERO;
        context.trace(&TraceRay::new(self.0, RayDesc::new(Vec3::Z * -4.0, Vec3::new(x, y, 2.5))), &mut color)?;
        Ok(color)
    }
}

/// Position on the card: from -1 to 1 in both directions.
fn on_card(primitive: u32, at: &Barycentrics) -> (f32, f32) {
    let corners = [[(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0)], [(-1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]];
    let p = at.interpolate(corners[primitive as usize % 2].map(|(x, y)| Vec3::new(x, y, 0.0)));
    (p.x, p.y)
}

/// A leaf is what two arcs enclose.
struct Outline;
impl AnyHit<Leaves, Barycentrics> for Outline {
    fn run(&self, context: &AnyHitContext<Leaves>, _: &mut Vec3, at: &Barycentrics) -> Decision {
        let (x, y) = on_card(context.primitive().primitive_index(), at);
        if x.abs() <= 0.5 * (1.0 - y * y) { context.accept_hit() } else { context.ignore_hit() }
    }
}

struct Green<'s>(&'s TopLevel);
impl ClosestHit<Leaves, Barycentrics> for Green<'_> {
    fn run(&self, context: &mut ClosestHitContext<Leaves>, color: &mut Vec3, at: &Barycentrics) -> Result<(), Fault> {
        let primitive = context.primitive();
        let (x, _) = on_card(primitive.primitive_index(), at);
        let [a, b, c] = primitive.triangle().unwrap_or_default();
        let normal = primitive.world_normal((b - a).cross(c - a)).unwrap_or(Vec3::Z);
        let RayValues { origin, direction, t_current, .. } = context.ray();
        let ray = RayDesc::new(origin + direction * t_current, LIGHT).with_extents(1e-3, f32::INFINITY);
        let flags = RayFlags::ACCEPT_FIRST_HIT_AND_END_SEARCH | RayFlags::SKIP_CLOSEST_HIT_SHADER;
        let mut light = Vec3::ZERO;
        context.trace(&TraceRay { flags, ..TraceRay::new(self.0, ray) }, &mut light)?;
        let rib = if x.abs() < 0.03 { 0.3 } else { 0.0 };
        let green = Vec3::new(0.15 + rib, 0.5 + rib, 0.05);
        *color = green * (light * normal.dot(LIGHT).abs() + Vec3::splat(0.15));
        Ok(())
    }
}

struct Sky;
impl Miss<Leaves> for Sky {
    fn run(&self, _: &mut MissContext<Leaves>, color: &mut Vec3) -> Result<(), Fault> {
        *color = Vec3::new(0.7, 0.85, 1.0);
        Ok(())
    }
}

/// A card with a random place and direction.
fn card(rng: &mut HashRng) -> [Vec3; 4] {
    let mut random = || Vec3::new(rng.next_f32(), rng.next_f32(), rng.next_f32()) * 2.0 - 1.0;
    let center = random() * Vec3::new(1.4, 1.0, 1.0);
    let x = random().try_normalize().unwrap_or(Vec3::X) * 0.35;
    let y = x.cross(random()).try_normalize().unwrap_or(Vec3::Y) * 0.35;
    [center - x - y, center + x - y, center + x + y, center - x + y]
}

/// The picture.
pub fn picture() -> Result<Image, Box<dyn Error>> {
    let mut rng = HashRng::new(7);
    let corners: Vec<Vec3> = (0..60).flat_map(|_| card(&mut rng)).collect();
    let indices: Vec<u16> = (0..60).flat_map(|i| [0, 1, 2, 0, 2, 3].map(|corner| 4 * i + corner)).collect();
    let cards = TriangleGeometry {
        indices: Indices::U16(&indices),
        ..TriangleGeometry::new(&corners).with_flags(GeometryFlags::NONE)
    };
    let cards = BottomLevel::build(Geometries::Triangles(&[cards]), BuildOptions::default())?;
    let scene = TopLevel::build(&[Instance::new(Arc::new(cards))], BuildOptions::default())?;

    let library = Library::<Leaves, _, _, _>::new()
        .with_ray_generation(Export::new("camera", Camera(&scene)))
        .with_hit_group(Export::new("leaf", TriangleGroup { any_hit: Outline, closest_hit: Green(&scene) }))
        .with_miss(Export::new("sky", Sky));
    let pipeline = Pipeline::link([library], PipelineConfig { max_recursion_depth: 2, ..Default::default() })?;
    let (leaf, sky) = (pipeline.hit_group("leaf").ok_or("no group")?, pipeline.miss("sky").ok_or("no shader")?);
    let tables = ShaderTables::new(Record::new(pipeline.ray_generation("camera").ok_or("no shader")?, ()))
        .with_hit_groups(ShaderTable::new(vec![Record::new(leaf, ())]))
        .with_miss(ShaderTable::new(vec![Record::new(sky, ())]));
    let colors: Vec<_> = pipeline.launch(&tables, SIZE)?.iter().map(Vec3::to_array).collect();
    Ok(Image::from_rgb(SIZE[0] as usize, SIZE[1] as usize, &colors)?)
}

#[allow(dead_code, reason = "tests include this file")]
fn main() -> Result<(), Box<dyn Error>> {
    Ok(steradian_image::write("leaves.png".as_ref(), &picture()?, &Default::default())?)
}
