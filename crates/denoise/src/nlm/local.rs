//! Noise estimates from a neighbourhood.

use rayon::prelude::*;

/// Pixels of a window of 3×3.
const WINDOW: f32 = 9.0;

/// The value of each pixel, rows in parallel.
pub(super) fn map<T>([width, height]: [usize; 2], value: impl Fn(usize, usize) -> T + Sync) -> Vec<T>
where
    T: Copy + Default + Send,
{
    let mut values = vec![T::default(); width * height];
    values.par_chunks_mut(width).enumerate().for_each(|(y, row)| {
        row.iter_mut().enumerate().for_each(|(x, place)| *place = value(x, y));
    });
    values
}

/// The places of the pixels at most `reach` columns and rows away, those at the edge for those beyond.
pub(super) fn around(
    [width, height]: [usize; 2],
    [x, y]: [usize; 2],
    reach: i64,
) -> impl Iterator<Item = usize> + Clone {
    // Clamp rows and columns to the picture: the edge stands for what is beyond.
    let rows = (-reach..=reach).map(move |dy| (y as i64 + dy).clamp(0, height as i64 - 1) as usize);
    let columns = (-reach..=reach).map(move |dx| (x as i64 + dx).clamp(0, width as i64 - 1) as usize);
    rows.flat_map(move |y| columns.clone().map(move |x| y * width + x))
}

/// Variance between neighbours on one side of an edge: that of the calmest of the nine windows of 3×3 pixels that hold
/// the pixel (the windows of Nagao and Matsuyama, "Edge Preserving Smoothing", CGIP 9, 1979, as squares). Beside a
/// sharp edge, one window lies on the pixel's side.
pub(crate) fn calm_variance(size: [usize; 2], values: &[f32]) -> Vec<f32> {
    let of_windows = map(size, |x, y| {
        let middle = values[y * size[0] + x];
        let (mut sum, mut squares) = (0.0, 0.0);
        // Sums of differences from the middle, so that large values do not cancel.
        for place in around(size, [x, y], 1) {
            let difference = values[place] - middle;
            sum += difference;
            squares += difference * difference;
        }
        ((squares - sum * sum / WINDOW) / (WINDOW - 1.0)).max(0.0)
    });
    // The least variance of the windows that hold the pixel.
    map(size, |x, y| around(size, [x, y], 1).map(|place| of_windows[place]).fold(f32::INFINITY, f32::min))
}
