//! What is filtered, and what comes out.

use steradian_math::Vec3;

use crate::{gbuffer::GBuffer, image::Image};

/// The least albedo that is divided by.
const LEAST_ALBEDO: f32 = 1e-3;
/// Components of radiance beyond it count as it: squares of luminance stay finite.
const MOST: f32 = 1e15;

/// A part of the light of a frame.
#[derive(Clone, Copy, Debug)]
pub struct Term<'a> {
    /// Radiance in linear RGB, or whatever else has noise.
    pub radiance: &'a Image<Vec3>,
    /// Whether it has the G-buffer's albedo as a factor, as diffuse light has: what is filtered is illumination, and
    /// textures stay sharp.
    pub has_albedo: bool,
}

/// A term without noise.
#[derive(Clone, Debug, PartialEq)]
pub struct Filtered {
    /// What [`Term::radiance`] is an estimate of.
    pub radiance: Image<Vec3>,
    /// Variance of the luminance of one frame's sample, filtered with it: for illumination without its albedo, as the
    /// filter sees it. Assumes that what is averaged is independent, so it is too small after several iterations.
    pub variance: Image<f32>,
    /// How many frames each pixel is a mean of: 1 where the history began with this frame, 0 where no value was finite
    /// yet.
    pub history: Image<u32>,
    /// Pixels of this frame whose radiance was not finite.
    pub left_out: u64,
}

impl Term<'_> {
    /// What the filter sees of each pixel: radiance over albedo, or NaN where it is left out; and how many are.
    pub(super) fn samples(&self, gbuffer: &GBuffer) -> (Image<Vec3>, u64) {
        let [width, height] = gbuffer.size();
        let samples = Image::by_rows(width, height, |x, y| {
            let radiance = self.radiance.at(x, y);
            if radiance.is_finite() {
                radiance.clamp(Vec3::splat(-MOST), Vec3::splat(MOST)) / self.factor(gbuffer, x, y)
            } else {
                Vec3::NAN
            }
        });
        let left_out = samples.values().iter().filter(|sample| sample.is_nan()).count() as u64;
        (samples, left_out)
    }

    /// What the filter's result is multiplied by: the albedo, at most 1 and not too small to divide by.
    pub(super) fn factor(&self, gbuffer: &GBuffer, x: u32, y: u32) -> Vec3 {
        let albedo = gbuffer.albedo.at(x, y);
        if self.has_albedo && albedo.is_finite() {
            albedo.clamp(Vec3::splat(LEAST_ALBEDO), Vec3::ONE)
        } else {
            Vec3::ONE
        }
    }
}
