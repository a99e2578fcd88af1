//! Shaders and geometry.

use steradian_math::Vec3;
use steradian_rt::{context::*, *};

/// Interface of the shaders.
pub enum Colors {}
impl Interface for Colors {
    type Payload = Vec3;
    type Attributes = ();
    type Parameter = ();
    /// The colour of a surface.
    type Local = Vec3;
    type Output = Vec3;
}

/// A camera above the ground.
pub struct Camera<'s>(&'s TopLevel);
impl RayGeneration<Colors> for Camera<'_> {
    fn run(&self, context: &mut RayGenerationContext<Colors>) -> Result<Vec3, Fault> {
        let LaunchValues { id: [x, y, _], size: [width, height, _] } = context.launch();
        let (x, y) = ((x as f32 + 0.5) / width as f32, (y as f32 + 0.5) / height as f32);
        let ray = RayDesc::new(Vec3::new(0.0, 1.5, -4.0), Vec3::new(1.6 * x - 0.8, 0.2 - 1.2 * y, 1.0));
        let mut color = Vec3::new(0.3, 0.4, 0.6);
        context.trace(&TraceRay::new(self.0, ray), &mut color)?;
        Ok(color)
    }
}

/// A surface that is lit from both sides.
pub struct Matt;
impl ClosestHit<Colors, Barycentrics> for Matt {
    fn run(&self, context: &mut ClosestHitContext<Colors>, color: &mut Vec3, _: &Barycentrics) -> Result<(), Fault> {
        let [a, b, c] = context.primitive().triangle().unwrap_or_default();
        let normal = context.primitive().world_normal((b - a).cross(c - a)).unwrap_or(Vec3::Y);
        *color = *context.local() * (0.2 + 0.8 * normal.dot(Vec3::new(0.48, 0.64, -0.6)).abs());
        Ok(())
    }
}

/// The pipeline.
pub type Shaders<'s> = Pipeline<Colors, Camera<'s>, TriangleGroup<(), Matt>>;

/// Links it; it is the same each time.
pub fn pipeline(scene: &TopLevel) -> Result<Shaders<'_>, PipelineError> {
    let library = Library::new()
        .with_ray_generation(Export::new("camera", Camera(scene)))
        .with_hit_group(Export::new("matt", TriangleGroup { any_hit: (), closest_hit: Matt }));
    Pipeline::link([library], PipelineConfig::default())
}

/// Triangles of a square grid from -1 to 1, each point taken somewhere.
pub fn grid(steps: usize, place: impl Fn(f32, f32) -> Vec3) -> Vec<Vec3> {
    let point = |i: usize, j: usize| place(2.0 * i as f32 / steps as f32 - 1.0, 2.0 * j as f32 / steps as f32 - 1.0);
    let cell = |(i, j)| [(i, j), (i + 1, j), (i + 1, j + 1), (i, j), (i + 1, j + 1), (i, j + 1)];
    let cells = (0..steps * steps).map(|n| (n / steps, n % steps));
    cells.flat_map(cell).map(|(i, j)| point(i, j)).collect()
}
