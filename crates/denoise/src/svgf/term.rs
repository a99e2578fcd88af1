//! Input and output of the filter.

use rayon::prelude::*;
use steradian_math::Vec3;

use super::{accumulate::Accumulated, estimates::Estimates};
use crate::{gbuffer::GBuffer, image::Image, rows::Rows};

/// The least albedo that is divided by.
const LEAST_ALBEDO: f32 = 1e-3;
/// Components of radiance beyond it count as it: squares of luminance stay finite.
const MOST: f32 = 1e15;

/// A part of the light of a frame.
#[derive(Clone, Copy, Debug)]
pub struct Term<'a> {
    /// Radiance in linear RGB, or whatever else has noise.
    pub radiance: &'a Image<Vec3>,
    /// True if it has the G-buffer's albedo as a factor, as diffuse light has: illumination is then filtered, and
    /// textures stay sharp.
    pub has_albedo: bool,
}

/// A term without noise.
#[derive(Clone, Debug, PartialEq)]
pub struct Filtered {
    /// Filtered estimate of [`Term::radiance`].
    pub radiance: Image<Vec3>,
    /// Variance of the luminance of one frame's sample, filtered with it: for illumination without its albedo, as the
    /// filter sees it. Assumes that what is averaged is independent, so it is too small after several iterations.
    pub variance: Image<f32>,
    /// Number of frames averaged in each pixel: 1 where the history began with this frame, 0 where no value was finite
    /// yet.
    pub history: Image<u32>,
    /// Pixels of this frame whose radiance was not finite.
    pub left_out: u64,
}

impl Term<'_> {
    /// Filter input of a pixel: radiance over albedo. `None` where it is left out.
    #[inline]
    pub(super) fn sample(&self, gbuffer: &GBuffer, [x, y]: [u32; 2]) -> Option<Vec3> {
        // Hold radiance so that squares stay finite, and divide the albedo out.
        let radiance = self.radiance.at(x, y);
        let limited = radiance.clamp(Vec3::splat(-MOST), Vec3::splat(MOST));
        radiance.is_finite().then(|| limited / self.factor(gbuffer, x, y))
    }

    /// Number of pixels left out.
    pub(super) fn left_out(&self) -> u64 {
        self.radiance.values().par_iter().filter(|radiance| !radiance.is_finite()).count() as u64
    }

    /// Factor on the filter's result: the albedo, at most 1 and not too small to divide by.
    #[inline]
    pub(super) fn factor(&self, gbuffer: &GBuffer, x: u32, y: u32) -> Vec3 {
        // Albedo is held above zero, so that dividing and multiplying cancel.
        let albedo = gbuffer.albedo.at(x, y);
        if self.has_albedo && albedo.is_finite() {
            albedo.clamp(Vec3::splat(LEAST_ALBEDO), Vec3::ONE)
        } else {
            Vec3::ONE
        }
    }

    /// Result of the filter for the term at a place among all.
    pub(super) fn filtered(
        &self,
        place: usize,
        gbuffer: &GBuffer,
        (colors, estimates): (&Image<Vec3>, &Estimates),
        accumulated: &Rows<Accumulated>,
    ) -> Filtered {
        let [width, height] = gbuffer.size();
        // Modulate by the albedo again.
        Filtered {
            radiance: Image::by_rows(width, height, |x, y| {
                // What no neighbour could fill in either is black.
                let color = colors.at(x, y);
                if color.is_nan() { Vec3::ZERO } else { color * self.factor(gbuffer, x, y) }
            }),
            variance: Image::by_rows(width, height, |x, y| estimates.variance(place, x as usize, y as usize)),
            history: Image::by_rows(width, height, |x, y| accumulated.at(place, x as usize, y as usize).length),
            left_out: self.left_out(),
        }
    }
}
