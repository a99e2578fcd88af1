//! Errors of means over squares of pixels.

use steradian::image::{self, Image, metrics};

/// Edges of the squares in pixels.
pub const EDGES: [usize; 4] = [1, 4, 8, 16];

/// relMSE of two pictures of one size, after a box filter of each of [`EDGES`] has reduced both. Squares at the right
/// and at the bottom may be smaller.
///
/// # Errors
/// Errors of [`metrics::compare`].
pub fn relmse(picture: &Image, reference: &Image) -> image::Result<[f64; EDGES.len()]> {
    let mut all = [0.0; EDGES.len()];
    for (error, edge) in all.iter_mut().zip(EDGES) {
        *error = metrics::compare(&boxed(picture, edge)?, &boxed(reference, edge)?)?.rel_mse;
    }
    Ok(all)
}

/// Means over squares.
fn boxed(image: &Image, edge: usize) -> image::Result<Image> {
    let rgb = image.require_rgb()?;
    let (width, height) = (image.width(), image.height());
    let (columns, rows) = (width.div_ceil(edge), height.div_ceil(edge));
    let mean = |k: usize| {
        let (left, top) = (k % columns * edge, k / columns * edge);
        let (right, bottom) = ((left + edge).min(width), (top + edge).min(height));
        let mut sum = [0.0; 3];
        for i in (top..bottom).flat_map(|y| y * width + left..y * width + right) {
            sum.iter_mut().zip(rgb.at(i)).for_each(|(sum, v)| *sum += f64::from(v));
        }
        sum.map(|sum| (sum / ((right - left) * (bottom - top)) as f64) as f32)
    };
    Image::from_rgb(columns, rows, &(0..columns * rows).map(mean).collect::<Vec<_>>())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Errors of ±0.1 in a checkerboard vanish in squares of an even edge, and offsets do not.
    #[test]
    fn squares_keep_offsets_and_average_noise() {
        let flat = Image::from_rgb(20, 20, &[[0.5; 3]; 400]).unwrap();
        let noise: Vec<[f32; 3]> = (0..400).map(|i| [0.5 + [0.1, -0.1][(i + i / 20) % 2]; 3]).collect();
        let noisy = relmse(&Image::from_rgb(20, 20, &noise).unwrap(), &flat).unwrap();
        assert!((noisy[0] - 0.01 / 0.26).abs() < 1e-6 && noisy[1..].iter().all(|e| *e < 1e-12), "{noisy:?}");
        let offset = relmse(&Image::from_rgb(20, 20, &[[0.6; 3]; 400]).unwrap(), &flat).unwrap();
        assert!(offset.iter().all(|e| (e - 0.01 / 0.26).abs() < 1e-6), "{offset:?}");
    }
}
