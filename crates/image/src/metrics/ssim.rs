//! Structural similarity: Wang, Bovik, Sheikh, Simoncelli, "Image Quality Assessment: From Error Visibility to
//! Structural Similarity" (IEEE Transactions on Image Processing 13(4), 2004), equation 13.

use super::colours;
use crate::{Error, Image, Result, RgbPlanes, encoding::srgb_encode};
use rayon::prelude::*;

/// Pixels of the window's edge, and its standard deviation in pixels (§III.C).
const WINDOW: usize = 11;
const DEVIATION: f64 = 1.5;
/// (K₁ L)² and (K₂ L)² for values from 0 to L = 1.
const C1: f64 = 0.01 * 0.01;
const C2: f64 = 0.03 * 0.03;
/// Rows of windows that are measured at a time.
const BAND: usize = 64;

/// Mean SSIM of two pictures: 1 for equal ones, less the less alike they are, −1 at the least.
///
/// It is that of display luminance: linear colours are cut to [0, 1] (NaN counts as black), their Rec.709 luminance is
/// encoded as sRGB, and L is 1. The window is a Gaussian of 11 × 11 pixels with a standard deviation of 1.5 pixels and
/// sum 1; K₁ = 0.01, K₂ = 0.03; variances are those of the population, as in the authors' program, and so is the mean
/// over all windows that lie inside of the picture. Along an edge of fewer than 11 pixels there is one window, the
/// Gaussian around the middle of that edge, cut to it. Pictures are not reduced before.
///
/// # Errors
/// [`Error::SizeMismatch`], [`Error::MissingChannels`], and [`Error::Invalid`] when the pictures are empty.
pub fn ssim(image: &Image, reference: &Image) -> Result<f64> {
    let (a, b) = colours(image, reference)?;
    let (width, height) = (image.width(), image.height());
    if image.pixel_count() == 0 {
        return Err(Error::Invalid("the pictures are empty".into()));
    }
    let (along_x, along_y) = (window(width), window(height));
    let (columns, rows) = (width + 1 - along_x.len(), height + 1 - along_y.len());
    let tops: Vec<usize> = (0..rows).step_by(BAND).collect();
    // Sums of bands are added in their order: the value does not depend on the number of threads.
    let sums: Vec<f64> = tops
        .into_par_iter()
        .map(|top| {
            let count = BAND.min(rows - top);
            let filtered: Vec<Moments> = (top..top + count + along_y.len() - 1)
                .flat_map(|y| filtered_row(a, b, y * width..(y + 1) * width, &along_x))
                .collect();
            let window = |k: usize| {
                let rows = along_y.iter().zip(filtered[k..].iter().step_by(columns));
                similarity(rows.fold([0.0; 5], |sum, (w, m)| plus(sum, *w, *m)))
            };
            (0..count * columns).map(window).sum()
        })
        .collect();
    Ok(sums.iter().sum::<f64>() / (columns * rows) as f64)
}

/// Weighted means of x, y, x², y² and x y.
type Moments = [f64; 5];

fn plus(sum: Moments, weight: f64, m: Moments) -> Moments {
    std::array::from_fn(|k| sum[k] + weight * m[k])
}

/// The Gaussian along an edge, with sum 1.
fn window(edge: usize) -> Vec<f64> {
    let count = WINDOW.min(edge);
    let middle = 0.5 * (count as f64 - 1.0);
    let weight = |k: usize| (-0.5 * ((k as f64 - middle) / DEVIATION).powi(2)).exp();
    let sum: f64 = (0..count).map(weight).sum();
    (0..count).map(|k| weight(k) / sum).collect()
}

/// Moments of one row under a window at each of its places.
fn filtered_row(a: RgbPlanes<'_>, b: RgbPlanes<'_>, row: std::ops::Range<usize>, window: &[f64]) -> Vec<Moments> {
    let point = |i: usize| {
        let (x, y) = (luminance(a.at(i)), luminance(b.at(i)));
        [x, y, x * x, y * y, x * y]
    };
    let points: Vec<Moments> = row.map(point).collect();
    let sum = |points: &[Moments]| points.iter().zip(window).fold([0.0; 5], |sum, (m, w)| plus(sum, *w, *m));
    points.windows(window.len()).map(sum).collect()
}

/// SSIM of one window.
fn similarity([x, y, xx, yy, xy]: Moments) -> f64 {
    let (var_x, var_y, covariance) = (xx - x * x, yy - y * y, xy - x * y);
    let means = (2.0 * x * y + C1) / (x * x + y * y + C1);
    means * (2.0 * covariance + C2) / (var_x + var_y + C2)
}

/// Encoded luminance of a linear colour that is cut to what a display shows.
fn luminance(rgb: [f32; 3]) -> f64 {
    let [r, g, b] = rgb.map(|v| if v > 0.0 { v.min(1.0) } else { 0.0 });
    f64::from(srgb_encode((0.2126 * r + 0.7152 * g + 0.0722 * b).min(1.0)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::encoding::srgb_decode;

    fn grey(width: usize, height: usize, display: impl Fn(usize, usize) -> f64) -> Image {
        let pixel = |i: usize| [srgb_decode(display(i % width, i / width) as f32); 3];
        Image::from_rgb(width, height, &(0..width * height).map(pixel).collect::<Vec<_>>()).unwrap()
    }

    #[test]
    fn equal_pictures_are_alike_and_offsets_have_the_luminance_term_alone() {
        let waves = grey(40, 90, |x, y| 0.5 + 0.3 * (0.7 * x as f64 + 0.2 * y as f64).sin());
        assert!((ssim(&waves, &waves).unwrap() - 1.0).abs() < 1e-12);
        let (x, y) = (0.4, 0.6);
        let expected = (2.0 * x * y + 1e-4) / (x * x + y * y + 1e-4);
        for (width, height) in [(30, 20), (3, 70), (1, 1)] {
            let found = ssim(&grey(width, height, |_, _| x), &grey(width, height, |_, _| y)).unwrap();
            assert!((found - expected).abs() < 1e-5, "{width} x {height}: {found}, expected {expected}");
        }
    }

    /// A window of 2 × 1 pixels has weights of one half: means (a + b)/2, variances ((a − b)/2)², and for the mirror
    /// image the negative of it as covariance.
    #[test]
    fn two_pixels_by_hand() {
        let (a, b) = (0.8, 0.5);
        let found = ssim(&grey(2, 1, |x, _| [a, b][x]), &grey(2, 1, |x, _| [b, a][x])).unwrap();
        let variance = 0.15f64 * 0.15;
        let expected = (-2.0 * variance + 9e-4) / (2.0 * variance + 9e-4);
        assert!((found - expected).abs() < 1e-5, "{found}, expected {expected}");
    }

    /// The sums of the definition, window by window and without separating the axes.
    #[test]
    fn agrees_with_the_sums_of_the_definition() {
        let (width, height) = (17, 80);
        let f = |x: usize, y: usize| ((x * 7 + y * 13) % 32) as f64 / 40.0 + 0.1;
        let g = |x: usize, y: usize| ((x * 7 + y * 12) % 32) as f64 / 45.0 + 0.15;
        let weight = |i: usize, j: usize| {
            let square = |k: usize| (k as f64 - 5.0) * (k as f64 - 5.0);
            (-(square(i) + square(j)) / 4.5).exp()
        };
        let places: Vec<(usize, usize)> = (0..11).flat_map(|j| (0..11).map(move |i| (i, j))).collect();
        let total: f64 = places.iter().map(|&(i, j)| weight(i, j)).sum();
        let mut sum = 0.0;
        for (left, top) in (0..height - 10).flat_map(|y| (0..width - 10).map(move |x| (x, y))) {
            let mean = |of: &dyn Fn(f64, f64) -> f64| -> f64 {
                let term = |&(i, j): &(usize, usize)| weight(i, j) * of(f(left + i, top + j), g(left + i, top + j));
                places.iter().map(term).sum::<f64>() / total
            };
            let (mf, mg) = (mean(&|f, _| f), mean(&|_, g| g));
            let (vf, vg) = (mean(&|f, _| (f - mf).powi(2)), mean(&|_, g| (g - mg).powi(2)));
            let covariance = mean(&|f, g| (f - mf) * (g - mg));
            sum += (2.0 * mf * mg + 1e-4) * (2.0 * covariance + 9e-4) / ((mf * mf + mg * mg + 1e-4) * (vf + vg + 9e-4));
        }
        let expected = sum / ((width - 10) * (height - 10)) as f64;
        let found = ssim(&grey(width, height, f), &grey(width, height, g)).unwrap();
        assert!((found - expected).abs() < 1e-5 && expected < 0.9, "{found}, expected {expected}");
    }

    #[test]
    fn what_is_not_shown_does_not_count() {
        let odd = Image::from_rgb(2, 1, &[[f32::NAN, -3.0, f32::NEG_INFINITY], [7.0, f32::INFINITY, 1.0]]).unwrap();
        let shown = Image::from_rgb(2, 1, &[[0.0; 3], [1.0; 3]]).unwrap();
        assert!((ssim(&odd, &shown).unwrap() - 1.0).abs() < 1e-12);
        assert!(ssim(&Image::from_rgb(0, 0, &[]).unwrap(), &Image::from_rgb(0, 0, &[]).unwrap()).is_err());
        assert!(ssim(&odd, &grey(3, 1, |_, _| 0.0)).is_err());
    }
}
