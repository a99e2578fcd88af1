//! Terms without noise, by what frames before and neighbours saw.

use super::{frame::Picture, surface::Surface};
use crate::Error;
use steradian_denoise::{
    GBuffer, Image,
    svgf::{Denoiser, Settings, Term},
};
use steradian_math::{Vec2, Vec3};

/// The object of pixels that see nothing.
const NOTHING: u32 = u32::MAX;

/// Denoisers of the terms of frames, applied one after the other.
#[derive(Clone, Debug)]
pub struct Filters {
    pub light: Denoiser,
    pub occlusion: Denoiser,
}

impl Filters {
    /// Before the first frame.
    pub fn new() -> Result<Self, Error> {
        let new = || {
            Denoiser::new(Settings { keeps_mean: true, ..Settings::default() }).map_err(|e| Error::Scene(e.to_string()))
        };
        Ok(Self { light: new()?, occlusion: new()? })
    }
}

/// Filters some terms of a frame.
pub fn filter(
    denoiser: &mut Denoiser,
    surfaces: &[Option<Surface>],
    [width, height]: [u32; 2],
    terms: Vec<Picture>,
) -> Result<Vec<Picture>, Error> {
    let run = || -> steradian_denoise::Result<Vec<Picture>> {
        // Filter demodulated light: albedo is divided out beforehand, so that textures stay sharp (Schied et al. 2017).
        let guides = guides(surfaces, width, height)?;
        let images: Vec<_> = terms.into_iter().map(|t| Image::new(width, height, t)).collect::<Result<_, _>>()?;
        let terms: Vec<_> = images.iter().map(|radiance| Term { radiance, has_albedo: false }).collect();
        let filtered = denoiser.frame(&terms, &guides)?;
        Ok(filtered.into_iter().map(|f| f.radiance.values().to_vec()).collect())
    };
    run().map_err(|e| Error::Scene(format!("filtering: {e}")))
}

/// G-buffer that guides the filter.
fn guides(surfaces: &[Option<Surface>], width: u32, height: u32) -> steradian_denoise::Result<GBuffer> {
    fn image<T>(
        surfaces: &[Option<Surface>],
        [width, height]: [u32; 2],
        of: impl Fn(&Surface, Vec2) -> T,
        nothing: T,
    ) -> steradian_denoise::Result<Image<T>>
    where
        T: Copy,
    {
        let place = |k: usize| Vec2::new((k as u32 % width) as f32 + 0.5, (k as u32 / width) as f32 + 0.5);
        let values = surfaces.iter().enumerate().map(|(k, s)| s.as_ref().map_or(nothing, |s| of(s, place(k))));
        Image::new(width, height, values.collect())
    }
    let size = [width, height];
    Ok(GBuffer {
        // Depth, its screen-space gradient, normal and object drive the edge-stopping functions.
        depth: image(surfaces, size, |s, _| s.depth, f32::INFINITY)?,
        depth_gradient: image(surfaces, size, |s, _| s.gradient, Vec2::ZERO)?,
        previous_depth: image(surfaces, size, |s, _| s.before.map_or(s.depth, |b| b.depth), f32::INFINITY)?,
        normal: image(surfaces, size, |s, _| s.normal, Vec3::ZERO)?,
        albedo: image(surfaces, size, |s, _| s.albedo, Vec3::ONE)?,
        id: image(surfaces, size, |s, _| s.object, NOTHING)?,
        // What was not in view before finds no history there.
        motion: image(surfaces, size, |s, at| s.before.map_or(Vec2::NAN, |b| b.at - at), Vec2::ZERO)?,
    })
}
