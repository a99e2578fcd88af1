//! Light of lights without noise, guided by the surfaces that pixels show.

use super::{Pixel, Surface};
use crate::Error;
use steradian_denoise::{
    GBuffer, Image, Result,
    svgf::{Denoiser, Settings, Term},
};
use steradian_math::{Vec2, Vec3};

/// Normals may differ more than by default, since one frame alone has few neighbours on what is curved.
const SETTINGS: Settings = Settings {
    alpha: 0.2,
    moments_alpha: 0.2,
    clamp_history: false,
    iterations: 4,
    sigma_depth: 2.0,
    normal_power: 24,
    sigma_luminance: 4.0,
    // A preview is replaced within a second: quick before exact.
    keeps_mean: false,
};
/// The object of pixels that show no surface.
const NOTHING: u32 = u32::MAX;

/// Direct light over albedo, by rows.
pub fn filter([width, height]: [u32; 2], pixels: &[Pixel]) -> std::result::Result<Vec<Vec3>, Error> {
    let run = || -> Result<Vec<Vec3>> {
        // Spatial filtering alone: a preview has no frames before it, and motion is marked as unknown.
        let guides = guides([width, height], pixels)?;
        let light = pixels.iter().map(|p| p.surface.map_or(Vec3::ZERO, |s| s.direct)).collect();
        let radiance = &Image::new(width, height, light)?;
        let filtered = Denoiser::new(SETTINGS)?.frame(&[Term { radiance, has_albedo: false }], &guides)?;
        Ok(filtered.into_iter().flat_map(|f| f.radiance.values().to_vec()).collect())
    };
    run().map_err(|e| Error::Scene(format!("filtering: {e}")))
}

fn guides(size: [u32; 2], pixels: &[Pixel]) -> Result<GBuffer> {
    fn image<T: Copy>(
        [width, height]: [u32; 2],
        pixels: &[Pixel],
        of: impl Fn(&Surface) -> T,
        none: T,
    ) -> Result<Image<T>> {
        Image::new(width, height, pixels.iter().map(|p| p.surface.as_ref().map_or(none, &of)).collect())
    }
    let gradients = (0..pixels.len()).map(|k| gradient(size, pixels, k)).collect();
    Ok(GBuffer {
        depth: image(size, pixels, |s| s.distance, f32::INFINITY)?,
        depth_gradient: Image::new(size[0], size[1], gradients)?,
        previous_depth: image(size, pixels, |s| s.distance, f32::INFINITY)?,
        normal: image(size, pixels, |s| s.normal, Vec3::ZERO)?,
        albedo: image(size, pixels, |_| Vec3::ONE, Vec3::ONE)?,
        id: image(size, pixels, |s| s.object, NOTHING)?,
        motion: image(size, pixels, |_| Vec2::NAN, Vec2::NAN)?,
    })
}

/// Screen-space gradient of distance along each axis: the smaller of the differences to the neighbours of the same
/// object on both sides.
fn gradient([width, height]: [u32; 2], pixels: &[Pixel], k: usize) -> Vec2 {
    let Some(here) = &pixels[k].surface else { return Vec2::ZERO };
    let other = |k: usize| pixels[k].surface.as_ref().filter(|s| s.object == here.object);
    let along = |at: u32, size: u32, step: usize| {
        // The smaller difference, as the larger one may lie across a crease of the same object.
        let before = (at > 0).then(|| other(k - step)).flatten().map(|s| here.distance - s.distance);
        let after = (at + 1 < size).then(|| other(k + step)).flatten().map(|s| s.distance - here.distance);
        match (before, after) {
            (Some(a), Some(b)) => {
                if a.abs() < b.abs() {
                    a
                } else {
                    b
                }
            }
            (a, b) => a.or(b).unwrap_or(0.0),
        }
    };
    let at = k as u32;
    Vec2::new(along(at % width, width, 1), along(at / width, height, width as usize))
}
