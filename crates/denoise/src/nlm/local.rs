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

/// A function of the 3×3 pixels around each, rows in parallel; those at the edge stand for those beyond.
fn map_neighbours([width, height]: [usize; 2], values: &[f32], value: impl Fn([f32; 9]) -> f32 + Sync) -> Vec<f32> {
    let mut of_all = vec![0.0; width * height];
    of_all.par_chunks_mut(width).enumerate().for_each(|(y, of_row)| {
        let rows = [y.saturating_sub(1), y, (y + 1).min(height - 1)].map(|y| {
            let row = &values[y * width..][..width];
            [&row[..1], row, &row[width - 1..]].concat()
        });
        let [above, own, below] = rows.each_ref().map(|row| row.windows(3));
        for (((place, a), b), c) in of_row.iter_mut().zip(above).zip(own).zip(below) {
            *place = value([a[0], a[1], a[2], b[0], b[1], b[2], c[0], c[1], c[2]]);
        }
    });
    of_all
}

/// Variance between neighbours on one side of an edge: that of the calmest of the nine windows of 3×3 pixels that hold
/// the pixel (the windows of Nagao and Matsuyama, "Edge Preserving Smoothing", CGIP 9, 1979, as squares). Beside a
/// sharp edge, one window lies on the pixel's side.
pub(crate) fn calm_variance(size: [usize; 2], values: &[f32]) -> Vec<f32> {
    let of_windows = map_neighbours(size, values, |near| {
        let (mut sum, mut squares) = (0.0, 0.0);
        // Sums of differences from the middle, so that large values do not cancel.
        for value in near {
            let difference = value - near[4];
            sum += difference;
            squares += difference * difference;
        }
        ((squares - sum * sum / WINDOW) / (WINDOW - 1.0)).max(0.0)
    });
    // The least variance of the windows that hold the pixel.
    map_neighbours(size, &of_windows, |near| near.into_iter().fold(f32::INFINITY, f32::min))
}
