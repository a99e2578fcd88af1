//! The spatial part of the filter alone: à-trous wavelets without histories.

use steradian_accel::Lanes;
use steradian_math::Vec3;

use super::{
    atrous::filter,
    estimates::{Estimates, VARIANCE},
    geometry::Geometry,
    settings::Settings,
    surface::Surface,
};
use crate::image::Image;

/// Filters a picture by what variance the luminance of its pixels has. Colours that are not finite are filled from
/// their neighbours; where these have none, 0. The images have one size, with a pixel at least.
pub(crate) fn filter_spatially(
    surfaces: &Image<Surface>,
    colors: &Image<Vec3>,
    variance: &Image<f32>,
    (lanes, settings): (Lanes, &Settings),
) -> Image<Vec3> {
    use rayon::prelude::*;
    let [width, height] = colors.size();
    // A margin as wide as the last gap reaches.
    let margin = (1 << settings.iterations).min(width as usize);
    let geometry = Geometry::new(surfaces, margin);
    let mut estimates = Estimates::unknown(colors.size(), 1, margin);
    let weights = estimates.luminance;
    // One frame without history: colours, luminance and the given variance.
    estimates.rows.par_rows().for_each(|(y, mut row)| {
        for x in 0..width {
            let color = Some(colors.at(x, y as u32)).filter(|color| color.is_finite());
            let luminance = color.map_or(f32::NAN, |color| weights.dot(color));
            Estimates::set_color(&mut row, 0, x as usize, color.unwrap_or_default(), luminance);
            row.set(VARIANCE, x as usize, variance.at(x, y as u32));
        }
    });
    // Passes with doubling gaps between two buffers.
    let mut filtered = estimates.clone();
    for iteration in 0..settings.iterations {
        filter(&estimates, &mut filtered, &geometry, iteration, (lanes, settings));
        std::mem::swap(&mut estimates, &mut filtered);
    }
    Image::by_rows(width, height, |x, y| estimates.color(0, x as usize, y as usize))
}
