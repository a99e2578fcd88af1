//! Procedural spheres: boxes, an intersection shader that fills them, and shadows by rays that end at their first hit.
//! Written to `spheres.png`.

use std::{error::Error, ops::ControlFlow, sync::Arc};
use steradian_image::Image;
use steradian_math::{Bounds3, Vec3};
use steradian_rt::{context::*, *};

const SIZE: [u32; 3] = [320, 240, 1];
const LIGHT: Vec3 = Vec3::new(0.48, 0.8, -0.36);

/// The attribute of a hit is the normal.
enum Balls {}
impl Interface for Balls {
    type Payload = Vec3;
    type Attributes = Vec3;
    type Parameter = ();
    /// The colour of what a record is for.
    type Local = Vec3;
    type Output = Vec3;
}

struct Camera<'s>(&'s TopLevel);
impl RayGeneration<Balls> for Camera<'_> {
    fn run(&self, context: &mut RayGenerationContext<Balls>) -> Result<Vec3, Fault> {
        let LaunchValues { id: [x, y, _], size: [width, height, _] } = context.launch();
        let x = (2.0 * x as f32 + 1.0 - width as f32) / height as f32;
        let y = 1.0 - (2.0 * y as f32 + 1.0) / height as f32;
        let mut color = Vec3::ZERO;
        let ray = RayDesc::new(Vec3::new(0.0, 1.2, -5.0), Vec3::new(x, y - 0.3, 2.5));
        context.trace(&TraceRay::new(self.0, ray), &mut color)?;
        Ok(color)
    }
}

/// The ball that touches the sides of the box from -1 to 1, in object space.
struct Ball;
impl Intersection<Balls> for Ball {
    fn run(&self, context: &mut IntersectionContext<Balls>) -> ControlFlow<EndSearch> {
        let (o, d) = (context.primitive().object_ray_origin(), context.primitive().object_ray_direction());
        let (a, b, c) = (d.dot(d), o.dot(d), o.dot(o) - 1.0);
        let root = (b * b - a * c).sqrt();
        if let (true, Some(kind)) = (root.is_finite(), HitKind::procedural(0)) {
            for t in [(-b - root) / a, (-b + root) / a] {
                context.report_hit(t, kind, o + d * t)?;
            }
        }
        ControlFlow::Continue(())
    }
}

struct Matt<'s>(&'s TopLevel);
impl ClosestHit<Balls, Vec3> for Matt<'_> {
    fn run(&self, context: &mut ClosestHitContext<Balls>, color: &mut Vec3, normal: &Vec3) -> Result<(), Fault> {
        let normal = context.primitive().world_normal(*normal).unwrap_or(Vec3::Y);
        let RayValues { origin, direction, t_current, .. } = context.ray();
        let ray = RayDesc::new(origin + direction * t_current + normal * 1e-3, LIGHT);
        // No hit shader runs for shadows: what the miss shader does not touch stays dark.
        let flags = RayFlags::ACCEPT_FIRST_HIT_AND_END_SEARCH | RayFlags::SKIP_CLOSEST_HIT_SHADER;
        let mut light = Vec3::ZERO;
        context.trace(&TraceRay { flags, miss_index: 1, ..TraceRay::new(self.0, ray) }, &mut light)?;
        *color = *context.local() * (light * normal.dot(LIGHT).max(0.0) + Vec3::splat(0.1));
        Ok(())
    }
}

/// Whatever is far away has the colour of its record.
struct Far;
impl Miss<Balls> for Far {
    fn run(&self, context: &mut MissContext<Balls>, color: &mut Vec3) -> Result<(), Fault> {
        *color = *context.local();
        Ok(())
    }
}

/// The picture.
pub fn picture() -> Result<Image, Box<dyn Error>> {
    let boxes = [Bounds3::new(Vec3::NEG_ONE, Vec3::ONE)];
    let ball = Arc::new(BottomLevel::build(Geometries::Boxes(&[BoxGeometry::new(&boxes)]), Default::default())?);
    let place = |i: u32, [x, y, z]: [f32; 3], [a, b, c]: [f32; 3]| {
        let rows = [[a, 0.0, 0.0, x], [0.0, b, 0.0, y], [0.0, 0.0, c, z]];
        Instance::new(ball.clone()).with_transform(Transform3x4 { rows }).with_hit_group_offset(i)
    };
    let instances = [
        place(0, [-1.5, 0.6, 0.0], [0.6, 0.6, 0.6]),
        place(1, [0.0, 0.9, 0.5], [0.5, 0.9, 0.5]),
        place(2, [1.4, 0.4, -0.4], [0.8, 0.4, 0.6]),
        place(3, [0.0, -500.0, 0.0], [500.0, 500.0, 500.0]),
    ];
    let scene = TopLevel::build(&instances, BuildOptions::default())?;

    let group = ProceduralGroup { intersection: Ball, any_hit: (), closest_hit: Matt(&scene) };
    let library = Library::<Balls, _, _, _>::new()
        .with_ray_generation(Export::new("camera", Camera(&scene)))
        .with_hit_group(Export::new("ball", group))
        .with_miss(Export::new("far", Far));
    let pipeline = Pipeline::link([library], PipelineConfig { max_recursion_depth: 2, ..Default::default() })?;
    let (ball, far) = (pipeline.hit_group("ball").ok_or("no group")?, pipeline.miss("far").ok_or("no shader")?);
    let colors = [[0.8, 0.2, 0.1], [0.2, 0.6, 0.2], [0.1, 0.3, 0.8], [0.6, 0.6, 0.6]].map(Vec3::from_array);
    let camera = pipeline.ray_generation("camera").ok_or("no shader")?;
    let tables = ShaderTables::new(Record::new(camera, Vec3::ZERO))
        .with_hit_groups(ShaderTable::new(colors.map(|color| Record::new(ball, color)).into()))
        .with_miss(ShaderTable::new([Vec3::new(0.3, 0.5, 0.8), Vec3::ONE].map(|c| Record::new(far, c)).into()));
    let colors: Vec<_> = pipeline.launch(&tables, SIZE)?.iter().map(Vec3::to_array).collect();
    Ok(Image::from_rgb(SIZE[0] as usize, SIZE[1] as usize, &colors)?)
}

#[allow(dead_code, reason = "tests include this file")]
fn main() -> Result<(), Box<dyn Error>> {
    Ok(steradian_image::write("spheres.png".as_ref(), &picture()?, &Default::default())?)
}
