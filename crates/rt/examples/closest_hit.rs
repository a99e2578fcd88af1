//! The closest-hit shader of many lectures, and what is wrong with it: two flattened balls, of which the left takes its
//! normals to world space by the object-to-world matrix and the right by the transposed inverse, as normals need it.
//! Written to `closest_hit.png`.

use std::{error::Error, sync::Arc};
use steradian_image::Image;
use steradian_math::Vec3;
use steradian_rt::{context::*, *};

const SIZE: [u32; 3] = [480, 240, 1];

enum Colors {}
impl Interface for Colors {
    type Payload = Vec3;
    type Attributes = ();
    type Parameter = ();
    type Local = ();
    type Output = Vec3;
}

struct Camera(TopLevel);
impl RayGeneration<Colors> for Camera {
    fn run(&self, context: &mut RayGenerationContext<Colors>) -> Result<Vec3, Fault> {
        let LaunchValues { id: [x, y, _], size: [width, height, _] } = context.launch();
        let (x, y) = ((x as f32 + 0.5) / width as f32, (y as f32 + 0.5) / height as f32);
        let ray = RayDesc::new(Vec3::new(4.0 * x - 2.0, 1.0 - 2.0 * y, -4.0), Vec3::Z);
        let mut color = Vec3::splat(0.05);
        context.trace(&TraceRay::new(&self.0, ray), &mut color)?;
        Ok(color)
    }
}

/// Light from above the camera on a matt surface.
struct Matt<'a> {
    normals: &'a [[Vec3; 3]],
}

impl ClosestHit<Colors, Barycentrics> for Matt<'_> {
    fn run(&self, context: &mut ClosestHitContext<Colors>, color: &mut Vec3, at: &Barycentrics) -> Result<(), Fault> {
        let primitive = context.primitive();
        let normal = at.interpolate(self.normals[primitive.primitive_index() as usize]);
        let world_normal = match primitive.custom_index() {
            // mul(attr.normal, (float3x3)ObjectToWorld()), not even of unit length.
            0 => primitive.object_to_world().vector(normal),
            _ => primitive.world_normal(normal).unwrap_or(Vec3::ZERO),
        };
        let light = Vec3::new(0.0, 0.6, -0.8);
        *color = Vec3::new(0.8, 0.5, 0.3) * world_normal.dot(light).max(0.0);
        Ok(())
    }
}

/// A ball of radius one from the faces of a cube: triangles, whose vertices are their own normals.
fn ball(steps: usize) -> Vec<[Vec3; 3]> {
    let point = |face: usize, i: usize, j: usize| {
        let [a, b] = [i, j].map(|n| 2.0 * n as f32 / steps as f32 - 1.0);
        let side = if face < 3 { 1.0 } else { -1.0 };
        let p = [Vec3::new(side, a, b), Vec3::new(b, side, a), Vec3::new(a, b, side)][face % 3];
        p.normalize()
    };
    let cells = (0..6).flat_map(|face| (0..steps * steps).map(move |cell| (face, cell / steps, cell % steps)));
    cells
        .flat_map(|(face, i, j)| {
            let [a, b, c, d] = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)].map(|(i, j)| point(face, i, j));
            [[a, b, c], [a, c, d]]
        })
        .collect()
}

/// The picture.
pub fn picture() -> Result<Image, Box<dyn Error>> {
    let triangles = ball(32);
    let geometry = TriangleGeometry::new(triangles.as_flattened());
    let object = Arc::new(BottomLevel::build(Geometries::Triangles(&[geometry]), BuildOptions::default())?);
    let flat = |custom_index: u32, x: f32| {
        let rows = [[0.9, 0.0, 0.0, x], [0.0, 0.7, 0.0, 0.0], [0.0, 0.0, 0.2, 0.0]];
        Instance::new(object.clone()).with_transform(Transform3x4 { rows }).with_custom_index(custom_index)
    };
    let scene = TopLevel::build(&[flat(0, -1.0), flat(1, 1.0)], BuildOptions::default())?;

    let library = Library::<Colors, _, _>::new()
        .with_ray_generation(Export::new("camera", Camera(scene)))
        .with_hit_group(Export::new("matt", TriangleGroup { any_hit: (), closest_hit: Matt { normals: &triangles } }))
        .with_miss(Export::new("background", ()));
    let pipeline = Pipeline::link([library], PipelineConfig::default())?;
    let matt = pipeline.hit_group("matt").ok_or("no such group")?;
    // A null record of the miss table runs nothing: the payload stays as it was.
    let tables = ShaderTables::new(Record::new(pipeline.ray_generation("camera").ok_or("no such shader")?, ()))
        .with_hit_groups(ShaderTable::new(vec![Record::new(matt, ())]))
        .with_miss(ShaderTable::new(vec![Record::null(())]));
    let colors: Vec<_> = pipeline.launch(&tables, SIZE)?.iter().map(Vec3::to_array).collect();
    Ok(Image::from_rgb(SIZE[0] as usize, SIZE[1] as usize, &colors)?)
}

#[allow(dead_code, reason = "tests include this file")]
fn main() -> Result<(), Box<dyn Error>> {
    Ok(steradian_image::write("closest_hit.png".as_ref(), &picture()?, &Default::default())?)
}
