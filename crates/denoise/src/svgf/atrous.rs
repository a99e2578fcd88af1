//! The edge-avoiding à-trous wavelet filter.

use steradian_math::{Vec3, color::luminance};

use super::{settings::Settings, surface::Surface};
use crate::{
    image::Image,
    kernel::{B3_SPLINE, GAUSSIAN, visit},
};

/// Keeps the exponent of luminance finite where there is no variance.
const LEAST_DEVIATION: f32 = 1e-10;

/// What is filtered.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Estimate {
    pub color: Vec3,
    /// Its luminance.
    luminance: f32,
    /// Of luminance.
    pub variance: f32,
    /// Whether there is a value.
    is_known: bool,
}

impl Estimate {
    /// Of a value.
    pub fn new(color: Vec3, variance: f32) -> Self {
        Self { color, luminance: luminance(color), variance, is_known: true }
    }

    /// Of no value.
    pub fn unknown(variance: f32) -> Self {
        Self { variance, ..Self::default() }
    }
}

/// Goes over the picture once, with gaps of 2^`iteration` pixels: equations 1, 2 and 5.
pub(super) fn filter(
    estimates: &Image<Estimate>,
    surfaces: &Image<Surface>,
    iteration: u32,
    settings: &Settings,
) -> Image<Estimate> {
    let [width, height] = estimates.size();
    Image::by_rows(width, height, |x, y| filter_pixel(estimates, surfaces, [x, y], 1i64 << iteration, settings))
}

fn filter_pixel(
    estimates: &Image<Estimate>,
    surfaces: &Image<Surface>,
    [x, y]: [u32; 2],
    step: i64,
    settings: &Settings,
) -> Estimate {
    let (surface, middle) = (surfaces.at(x, y), estimates.at(x, y));
    let deviation = deviation(estimates, surfaces, [x, y], settings.sigma_luminance);
    let (mut color, mut variance, mut weights) = (Vec3::ZERO, 0.0, 0.0);
    visit(&B3_SPLINE, [x, y], estimates.size(), step, |tap| {
        let other = &estimates.values()[tap.place];
        if !other.is_known {
            return;
        }
        let weight = if tap.offset == [0, 0] {
            tap.weight
        } else {
            let apart = (middle.luminance - other.luminance).abs();
            let difference = if middle.is_known && apart > 0.0 { apart / deviation } else { 0.0 };
            tap.weight * surface.weight(&surfaces.values()[tap.place], tap.offset, difference, settings)
        };
        color += weight * other.color;
        variance += weight * weight * other.variance;
        weights += weight;
    });
    if weights > 0.0 {
        // Twice, since the square of a weight may be too small to divide by.
        Estimate::new(color / weights, variance / weights / weights)
    } else {
        middle
    }
}

/// By how much luminance may differ: σ_l times the standard deviation, whose square is smoothed over the 3×3 pixels of
/// the object.
fn deviation(estimates: &Image<Estimate>, surfaces: &Image<Surface>, [x, y]: [u32; 2], sigma: f32) -> f32 {
    if sigma == f32::INFINITY {
        return sigma;
    }
    let id = surfaces.at(x, y).id;
    let (mut variance, mut weights) = (0.0, 0.0);
    visit(&GAUSSIAN, [x, y], estimates.size(), 1, |tap| {
        let other = &estimates.values()[tap.place];
        if other.is_known && surfaces.values()[tap.place].id == id {
            variance += tap.weight * other.variance;
            weights += tap.weight;
        }
    });
    if weights > 0.0 { sigma * (variance / weights).sqrt() + LEAST_DEVIATION } else { LEAST_DEVIATION }
}
