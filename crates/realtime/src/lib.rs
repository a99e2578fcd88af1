//! Scenes through the graphics pipeline: what is seen is found by rasterisation, and shaded with the very scattering
//! models, textures and lights of the path tracer, so that pictures of both compare pixel by pixel.
//!
//! 1. [`draw_list`]: triangles of meshes as they are; other shapes (spheres, curves, patches, height fields, planes) by
//!    boxes around their parts, in which the fragment shader meets the shape with the pixel's ray. Nothing is
//!    tessellated, so there is no error to state.
//! 2. `visibility`: a picture of which primitive each pixel sees (Burns, Hunt 2013, "The Visibility Buffer"), by a
//!    reversed depth buffer. Painter's algorithm, BSP order, Newell's sort and Warnock's subdivision find the same
//!    (`order`).
//! 3. `shading`: what that primitive sends to the eye: emission, light of each light, and what mirrors and glass show.
//! 4. `shadow`: whether a light is seen: by rays, by shadow maps of many kinds, by shadow volumes, by projected
//!    shadows, or always.

pub mod draw_list;
pub mod lesson;
mod options;
mod order;
mod projection;
mod shading;
mod shadow;
mod visibility;

pub use options::{BiasBy, Method, Options, SHADOWS, Shadows, Show};
pub use projection::Projected;
pub use visibility::{Seen, Visibility};

use rayon::prelude::*;
use steradian_core::{Scene, film::Pixel};
use steradian_math::{Vec2, Vec3};
use steradian_raster::Counters;

/// What cannot be drawn.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Error {
    /// An option of the integrator.
    #[error("{0}")]
    Option(String),
    /// A scene that the pipeline cannot take.
    #[error("{0}")]
    Scene(String),
    /// A call that the pipeline refused.
    #[error(transparent)]
    Raster(#[from] steradian_raster::Error),
}

/// A finished picture.
#[derive(Clone, Debug)]
pub struct Picture {
    /// Pixels of the crop by rows.
    pub pixels: Vec<Pixel>,
    /// What the pipeline did for the pixels that are seen.
    pub counters: Counters,
    /// Rays that were traced for shadows, mirrors and glass.
    pub rays: u64,
    /// Samples that were not finite and count as black.
    pub nonfinite: u64,
    /// What is to be said of it.
    pub notes: Vec<String>,
}

/// Draws a scene with `spp` samples for each pixel: with one, at the centres of pixels; with more, spread over the
/// pixels and the lights, so that pictures converge.
///
/// # Errors
/// Cameras that have no projection to a plane, and sizes that the pipeline refuses.
pub fn render(scene: &Scene, spp: u32, options: &Options) -> Result<Picture, Error> {
    let list = draw_list::DrawList::new(scene);
    let crop = scene.film.crop;
    // Views that show no light are RGB whatever the scene is.
    let mode = if options.show == Show::Picture { scene.mode } else { steradian_core::ColorMode::Rgb };
    let mut pixels = vec![Pixel::default(); (crop.width() * crop.height()) as usize];
    let (mut counters, mut rays, mut nonfinite) = (Counters::default(), 0, 0);
    let mut notes = Vec::new();
    let mut made = None;
    for pass in 0..spp.max(1) {
        let offset = if spp <= 1 { Vec2::splat(0.5) } else { spread(pass) };
        let projected = Projected::new(scene, offset)?;
        let visibility = Visibility::draw_with(scene, &list, &projected, Some(options.visibility))?;
        if options.visibility == Method::Painter && pass == 0 {
            let wrong = visibility.differing(&Visibility::draw(scene, &list, &projected)?);
            notes.push(format!("the order of the painter's algorithm is wrong in {wrong} pixels"));
        }
        counters += visibility.counters;
        if made.is_none() || options.shadows.is_of_pixels() {
            let eye = shadow::Eye { projected: &projected, visibility: &visibility };
            made = Some(shadow::Shadowing::new(scene, &list, options, &eye)?);
        }
        let Some(shadows) = &made else { continue };
        let eye = shadow::Eye { projected: &projected, visibility: &visibility };
        let lesson = lesson::picture(scene, &list, &eye, options, shadows)?;
        let shader = shading::Shader { scene, shadows, options, pass };
        let width = crop.width() as usize;
        let row_of = |(row, pixels): (usize, &mut [Pixel])| {
            let (mut traced, mut dropped) = (0, 0);
            for (column, pixel) in pixels.iter_mut().enumerate() {
                let at = [column as u32, row as u32];
                if let Some(lesson) = &lesson {
                    pixel.add(lesson[row * width + column]);
                    continue;
                }
                let seen = visibility.seen(scene, &list, &projected, at);
                if options.show == Show::Clip {
                    let item = visibility.item(row * width + column);
                    let shown =
                        item.zip(seen).map(|(item, seen)| lesson::clipping(scene, &list, &projected, item, &seen));
                    pixel.add(shown.unwrap_or(Vec3::ZERO));
                    continue;
                }
                let (radiance, lambda) = shader.radiance(&projected.ray(scene, at), seen, at, &mut traced);
                dropped += u64::from(!pixel.add(scene.film.developed(radiance, &lambda, mode)));
            }
            (traced, dropped)
        };
        let sum = |a: (u64, u64), b: (u64, u64)| (a.0 + b.0, a.1 + b.1);
        let (traced, dropped) = pixels.par_chunks_mut(width).enumerate().map(row_of).reduce(|| (0, 0), sum);
        rays += traced;
        nonfinite += dropped;
    }
    Ok(Picture { pixels, counters, rays, nonfinite, notes })
}

/// Points that fill the unit square evenly (Roberts 2018, the R2 sequence), from its middle on.
fn spread(index: u32) -> Vec2 {
    let turn = |step: f64| (0.5 + step * f64::from(index)).fract() as f32;
    Vec2::new(turn(0.754_877_666_246_692_7), turn(0.569_840_290_998_053_2))
}

/// The middle of the box around a scene and its radius; a unit sphere where there is none.
fn extent(scene: &Scene) -> (Vec3, f32) {
    let bounds = scene.bounds();
    if bounds.is_empty() {
        return (Vec3::ZERO, 1.0);
    }
    let (center, radius) = bounds.bounding_sphere();
    if radius > 0.0 && radius.is_finite() { (center, radius) } else { (Vec3::ZERO, 1.0) }
}
