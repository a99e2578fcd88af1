//! A triangle by a ray-generation shader, written to `triangle.png`. What its middle pixel did is printed.

use std::{error::Error, sync::Arc};
use steradian_image::Image;
use steradian_math::Vec3;
use steradian_rt::{context::*, *};

const SIZE: [u32; 3] = [320, 240, 1];

/// Interface of the shaders: the payload of a ray and the output of a launch id are colours.
enum Colors {}
impl Interface for Colors {
    type Payload = Vec3;
    type Attributes = ();
    type Parameter = ();
    type Local = ();
    type Output = Vec3;
}

/// A parallel projection along z.
struct Camera(TopLevel);
impl RayGeneration<Colors> for Camera {
    fn run(&self, context: &mut RayGenerationContext<Colors>) -> Result<Vec3, Fault> {
        let LaunchValues { id: [x, y, _], size: [width, height, _] } = context.launch();
        let (x, y) = ((x as f32 + 0.5) / width as f32, (y as f32 + 0.5) / height as f32);
        let ray = RayDesc::new(Vec3::new(2.0 * x - 1.0, 1.0 - 2.0 * y, -1.0), Vec3::Z);
        let mut color = Vec3::ZERO;
        context.trace(&TraceRay::new(&self.0, ray), &mut color)?;
        Ok(color)
    }
}

struct Weights;
impl ClosestHit<Colors, Barycentrics> for Weights {
    fn run(&self, _: &mut ClosestHitContext<Colors>, color: &mut Vec3, at: &Barycentrics) -> Result<(), Fault> {
        *color = at.interpolate([Vec3::X, Vec3::Y, Vec3::Z]);
        Ok(())
    }
}

struct Background;
impl Miss<Colors> for Background {
    fn run(&self, _: &mut MissContext<Colors>, color: &mut Vec3) -> Result<(), Fault> {
        *color = Vec3::new(0.1, 0.1, 0.12);
        Ok(())
    }
}

/// The picture, and what happened for the pixel in its middle.
pub fn picture() -> Result<(Image, Inspection<Vec3>), Box<dyn Error>> {
    let corners = [Vec3::new(-0.8, -0.7, 0.0), Vec3::new(0.0, 0.8, 0.0), Vec3::new(0.8, -0.7, 0.0)];
    let object = BottomLevel::build(Geometries::Triangles(&[TriangleGeometry::new(&corners)]), Default::default())?;
    let scene = TopLevel::build(&[Instance::new(Arc::new(object))], BuildOptions::default())?;

    let library = Library::<Colors, _, _, _>::new()
        .with_ray_generation(Export::new("camera", Camera(scene)))
        .with_hit_group(Export::new("weights", TriangleGroup { any_hit: (), closest_hit: Weights }))
        .with_miss(Export::new("background", Background));
    let pipeline = Pipeline::link([library], PipelineConfig::default())?;

    let camera = pipeline.ray_generation("camera").ok_or("no such shader")?;
    let weights = pipeline.hit_group("weights").ok_or("no such group")?;
    let background = pipeline.miss("background").ok_or("no such shader")?;
    let tables = ShaderTables::new(Record::new(camera, ()))
        .with_hit_groups(ShaderTable::new(vec![Record::new(weights, ())]))
        .with_miss(ShaderTable::new(vec![Record::new(background, ())]));
    let [width, height, _] = SIZE;
    let colors: Vec<_> = pipeline.launch(&tables, SIZE)?.iter().map(Vec3::to_array).collect();
    let image = Image::from_rgb(width as usize, height as usize, &colors)?;
    Ok((image, pipeline.inspect(&tables, SIZE, [width / 2, height / 2, 0])?))
}

#[allow(dead_code, clippy::print_stdout, reason = "tests include this file")]
fn main() -> Result<(), Box<dyn Error>> {
    let (image, middle) = picture()?;
    print!("{middle}");
    Ok(steradian_image::write("triangle.png".as_ref(), &image, &Default::default())?)
}
