//! Scenes through the graphics pipeline: what is seen is found by rasterisation, and shaded with the very scattering
//! models, textures and lights of the path tracer, so that pictures of both compare pixel by pixel.
//!
//! 1. [`draw_list`]: triangles of meshes as they are; other shapes (spheres, curves, patches, height fields, planes) by
//!    boxes around their parts, in which the fragment shader meets the shape with the pixel's ray. Nothing is
//!    tessellated, so there is no error to state.
//! 2. `visibility`: a picture of which primitive each pixel sees (Burns, Hunt 2013, "The Visibility Buffer"), by a
//!    reversed depth buffer. Painter's algorithm, BSP order, Newell's sort and Warnock's subdivision find the same
//!    (`order`).
//!    [`culling`] leaves out what is found not to be seen before it is drawn.
//! 3. `shading`: what that primitive sends to the eye: emission, light of each light, and what mirrors and glass show.
//!    `triangle_light`: light of the corners of triangles instead (flat, Gouraud).
//! 4. `shadow`: whether a light is seen: by rays, by shadow maps of many kinds, by shadow volumes, by projected
//!    shadows, or always.
//!
//! Shading intersects the pixel's ray with the one primitive that it sees; `Scene::interaction` and `Scene::scattering`
//! then give what a path tracer would have there. Lights are asked one by one, or chosen by the light tree where they
//! are many; mirrors and glass go on with rays. Shadow maps are visibility pictures too, seen from lights. A technique
//! of shadows is a file of `shadow`, a variant of `Shadows` and a row of `SHADOWS`.

mod clusters;
pub mod culling;
pub mod draw_list;
mod hybrid;
mod image_light;
pub mod lesson;
mod method;
mod options;
mod order;
mod preparation;
mod preview;
mod projection;
mod rasterizer;
mod shading;
mod shading_model;
mod shadow;
mod trace;
mod transparency;
mod triangle_light;
mod visibility;
mod world;

pub use culling::{BoundsKind, Culling};
pub use hybrid::Hybrid;
pub use method::{METHODS, RASTER, Raster};
pub use options::{
    BiasBy, EnvironmentKind, FrameKind, LightChoice, Method, Options, SHADOWS, Shadows, Show, Transparency,
};
pub use preview::Preview;
pub use projection::Projected;
pub use rasterizer::Rasterizer;
pub use shading_model::ShadingModel;
pub use visibility::{Cover, Seen, Visibility, Wanted};
pub use world::World;

use steradian_core::Scene;
use steradian_math::{Vec2, Vec3};

/// Errors of rasterised renders.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Error {
    /// An option of the integrator.
    #[error("{0}")]
    Option(String),
    /// A scene that the pipeline cannot take.
    #[error("{0}")]
    Scene(String),
    /// The work was cancelled.
    #[error("cancelled")]
    Cancelled,
    /// A call that the pipeline refused.
    #[error(transparent)]
    Raster(#[from] steradian_raster::Error),
}

/// The middle of the box around a scene and its radius; a unit sphere where there is none.
fn extent(scene: &Scene) -> (Vec3, f32) {
    let bounds = scene.bounds();
    if bounds.is_empty() {
        return (Vec3::ZERO, 1.0);
    }
    // Degenerate scenes take the unit sphere, so that projections stay finite.
    let (center, radius) = bounds.bounding_sphere();
    if radius > 0.0 && radius.is_finite() { (center, radius) } else { (Vec3::ZERO, 1.0) }
}

/// Points that fill the unit square evenly (Roberts 2018, the R2 sequence), from its middle on.
fn spread(index: u32) -> Vec2 {
    // Additive recurrence by the powers of the inverse plastic number, fractional parts alone.
    let turn = |step: f64| (0.5 + step * f64::from(index)).fract() as f32;
    Vec2::new(turn(0.754_877_666_246_692_7), turn(0.569_840_290_998_053_2))
}
