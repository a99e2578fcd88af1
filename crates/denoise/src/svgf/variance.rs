//! How noisy pixels are.

use steradian_math::Vec2;

use super::{accumulate::Accumulated, settings::Settings, surface::Surface};
use crate::{image::Image, kernel::visit};

/// Frames of a history that tell a variance by themselves.
const LONG_ENOUGH: u32 = 4;

/// The variance of a pixel's luminance: section 4.2. Of a short history over 7×7 pixels of the same surface, and larger
/// the shorter it is.
pub(super) fn variance(
    accumulated: &Image<Accumulated>,
    surfaces: &Image<Surface>,
    [x, y]: [u32; 2],
    settings: &Settings,
) -> f32 {
    let Accumulated { moments, length, .. } = accumulated.at(x, y);
    if length >= LONG_ENOUGH {
        return of_moments(moments);
    }
    let surface = surfaces.at(x, y);
    let (mut sum, mut weights) = (Vec2::ZERO, 0.0);
    visit(&[1.0; 7], [x, y], accumulated.size(), 1, |tap| {
        let other = &accumulated.values()[tap.place];
        if other.length > 0 {
            let weight = surface.weight(&surfaces.values()[tap.place], tap.offset, 0.0, settings);
            sum += weight * other.moments;
            weights += weight;
        }
    });
    if weights > 0.0 { of_moments(sum / weights) * (LONG_ENOUGH as f32 / length.max(1) as f32) } else { 0.0 }
}

fn of_moments(moments: Vec2) -> f32 {
    (moments.y - moments.x * moments.x).max(0.0)
}
