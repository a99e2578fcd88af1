//! Maps of a page: where two pictures of one size differ, in colours.

use crate::html;
use steradian::{
    compare::Noise,
    image::{self, Image, metrics},
};

/// Share of the pixels that the scale of relative errors holds.
const SHOWN: f64 = 0.99;
/// Rounding of two values that are taken for one, as a part of the larger.
const ROUNDING: f32 = 1e-6;

/// Relative errors |x − ref| / (|ref| + 0.01), means over the colours, and the error that has the lightest colour: the
/// 99th percentile, rounded up to 1, 2 or 5 of a power of ten.
///
/// # Errors
/// A picture without colours.
pub fn relative(picture: &Image, reference: &Image) -> image::Result<(Image, f64)> {
    let (a, b) = (picture.require_rgb()?, reference.require_rgb()?);
    let error = |i: usize| {
        let (a, b) = (a.at(i), b.at(i));
        (0..3).map(|c| metrics::relative_error(a[c].into(), b[c].into())).sum::<f64>() / 3.0
    };
    let errors: Vec<f64> = (0..picture.pixel_count()).map(error).collect();
    let mut sorted: Vec<f64> = errors.iter().copied().filter(|e| e.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    let place = (sorted.len().saturating_sub(1) as f64 * SHOWN).ceil() as usize;
    let full = rounded_up(sorted.get(place).copied().unwrap_or(0.0));
    // What is not finite is grey.
    let colour = |e: f64| if e.is_finite() { metrics::magma((e / full) as f32) } else { html::signed(None) };
    Ok((of(picture, errors.into_iter().map(colour))?, full))
}

/// Differences in standard errors, of red, green and blue the one that differs most.
///
/// # Errors
/// A picture without colours.
pub fn signed(picture: &Image, reference: &Image, noise: &Noise<'_>) -> image::Result<Image> {
    let (a, b) = (picture.require_rgb()?, reference.require_rgb()?);
    let z = |i: usize| {
        let (a, b, variance) = (a.at(i), b.at(i), noise.of_one_sample(i));
        let one = |c: usize| match (a[c] - b[c]).abs() <= ROUNDING * a[c].abs().max(b[c].abs()) {
            true => 0.0,
            false => f64::from(a[c] - b[c]) / (variance[c] / noise.samples()).sqrt(),
        };
        [0, 1, 2].map(one).into_iter().max_by(|a, b| a.abs().total_cmp(&b.abs()))
    };
    of(picture, (0..picture.pixel_count()).map(|i| html::signed(z(i))))
}

fn of(picture: &Image, colours: impl Iterator<Item = [f32; 3]>) -> image::Result<Image> {
    Image::from_rgb(picture.width(), picture.height(), &colours.collect::<Vec<_>>())
}

/// The least of 1, 2 and 5 times powers of ten that is no less than a number; 0.01 for zero.
fn rounded_up(number: f64) -> f64 {
    if number <= 0.0 {
        return 0.01;
    }
    let decade = 10f64.powf(number.log10().floor());
    // Rounding of logarithms may put a number a little above its own decade.
    [1.0, 2.0, 5.0, 10.0].map(|digit| digit * decade).into_iter().find(|v| *v >= number * 0.999_999).unwrap_or(number)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scales_end_at_round_numbers() {
        for (number, expected) in [(0.0, 0.01), (0.3, 0.5), (0.1, 0.1), (7.0, 10.0), (0.012, 0.02), (1e-7, 1e-7)] {
            assert!((rounded_up(number) / expected - 1.0).abs() < 1e-9, "{number}: {}", rounded_up(number));
        }
    }

    #[test]
    fn relative_errors_by_hand() {
        let of = |values: [f32; 4]| Image::from_rgb(4, 1, &values.map(|v| [v; 3])).unwrap();
        let (map, full) = relative(&of([1.0, 1.01, 0.69, f32::NAN]), &of([1.0, 1.515, 0.99, 1.0])).unwrap();
        // Errors of 0, 0.505/1.525 and 0.3: the scale ends at 0.5.
        assert!((full - 0.5).abs() < 1e-12, "{full}");
        let rgb = map.rgb().unwrap();
        assert_eq!((rgb.at(0), rgb.at(2)), (metrics::magma(0.0), metrics::magma(0.6)));
        assert_eq!(rgb.at(3), html::signed(None));
    }
}
