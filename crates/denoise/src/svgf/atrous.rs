//! The edge-avoiding à-trous wavelet filter.

use steradian_math::{Vec3, color::luminance};

use super::{settings::Settings, surface::Surface};
use crate::{
    image::Image,
    kernel::{B3_SPLINE, GAUSSIAN, Tap, taps},
};

/// Keeps the exponent of luminance finite where there is no variance.
const LEAST_DEVIATION: f32 = 1e-10;

/// What is filtered.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Estimate {
    pub color: Vec3,
    /// Of luminance.
    pub variance: f32,
    /// Whether there is a value.
    pub is_known: bool,
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
    let lightness = luminance(middle.color);
    let (mut color, mut variance, mut weights) = (Vec3::ZERO, 0.0, 0.0);
    for tap in taps([x, y], estimates.size(), 2, step) {
        let other = estimates.at(tap.x, tap.y);
        if !other.is_known {
            continue;
        }
        let kernel = product(&B3_SPLINE, &tap, 2);
        let weight = if tap.offset == [0, 0] {
            kernel
        } else {
            let apart = (lightness - luminance(other.color)).abs();
            let difference = if middle.is_known && apart > 0.0 { apart / deviation } else { 0.0 };
            let offset = tap.offset.map(|i| i64::from(i) * step);
            kernel * surface.weight(&surfaces.at(tap.x, tap.y), offset, difference, settings)
        };
        color += weight * other.color;
        variance += weight * weight * other.variance;
        weights += weight;
    }
    if weights > 0.0 {
        // Twice, since the square of a weight may be too small to divide by.
        Estimate { color: color / weights, variance: variance / weights / weights, is_known: true }
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
    for tap in taps([x, y], estimates.size(), 1, 1) {
        let other = estimates.at(tap.x, tap.y);
        if other.is_known && surfaces.at(tap.x, tap.y).id == id {
            let weight = product(&GAUSSIAN, &tap, 1);
            variance += weight * other.variance;
            weights += weight;
        }
    }
    if weights > 0.0 { sigma * (variance / weights).sqrt() + LEAST_DEVIATION } else { LEAST_DEVIATION }
}

/// The weight of a tap of a separable kernel.
fn product<const N: usize>(kernel: &[f32; N], tap: &Tap, radius: i32) -> f32 {
    let [x, y] = tap.offset.map(|i| kernel.get((i + radius) as usize).copied().unwrap_or_default());
    x * y
}
