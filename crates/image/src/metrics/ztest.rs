//! Is a Monte Carlo picture the same as a reference, but for noise? The test of Mitsuba 3's render suite (Subr and
//! Arvo, "Statistical Hypothesis Testing for Assessing Monte Carlo Estimators", 2007).

use super::colours;
use crate::{Error, Image, Result};

/// Significance level of the whole picture.
const ALPHA: f64 = 0.01;
/// Share of components that must be accepted.
const REQUIRED: f64 = 0.9975;
/// Smallest variance that is believed.
const MIN_VARIANCE: f64 = 1e-4;

/// CIE XYZ of linear Rec.709 (IEC 61966-2-1).
const XYZ: [[f64; 3]; 3] =
    [[0.412_453, 0.357_580, 0.180_423], [0.212_671, 0.715_160, 0.072_169], [0.019_334, 0.119_193, 0.950_227]];

/// The outcome of [`z_test`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ZTest {
    /// Share of the components (three per pixel) whose p-value is above `level`, 0 to 1.
    pub accepted: f64,
    /// Significance level of one component, Šidák corrected over the pixels.
    pub level: f64,
    /// Smallest p-value.
    pub min_p: f64,
    /// True if at least 99.75 % are accepted.
    pub passes: bool,
}

/// Tests the mean of `samples` samples per pixel against a reference mean, given the variance of a single sample.
///
/// All three pictures hold linear Rec.709, the variance too, as Mitsuba stores its references: they are turned into
/// XYZ, where the variance was taken. Per component z = |mean − reference| · √(samples / max(variance, 10⁻⁴)) and p =
/// erfc(z / √2); a component is accepted when p > 1 − 0.99^(1/pixels). Components that are not finite are rejected.
///
/// # Errors
/// [`Error::SizeMismatch`], [`Error::MissingChannels`], [`Error::Invalid`] when `samples` is not positive.
pub fn z_test(mean: &Image, reference: &Image, variance: &Image, samples: f64) -> Result<ZTest> {
    let (_, v) = colours(mean, variance)?;
    z_test_with(mean, reference, |i| v.at(i).map(f64::from), samples)
}

/// [`z_test`] with the variance of each pixel, by index, from a function.
///
/// # Errors
/// As [`z_test`].
pub fn z_test_with(
    mean: &Image,
    reference: &Image,
    variance: impl Fn(usize) -> [f64; 3],
    samples: f64,
) -> Result<ZTest> {
    if samples.is_nan() || samples <= 0.0 {
        return Err(Error::Invalid(format!("the number of samples must be positive, not {samples}")));
    }
    let (m, r) = colours(mean, reference)?;
    let pixels = mean.pixel_count();
    if pixels == 0 {
        return Err(Error::Invalid("the pictures are empty".into()));
    }
    let level = 1.0 - (1.0 - ALPHA).powf(1.0 / pixels as f64);
    let (mut accepted, mut min_p) = (0usize, 1.0f64);
    for i in 0..pixels {
        let [m, r] = [m.at(i), r.at(i)].map(|c| xyz(c.map(f64::from)));
        let v = xyz(variance(i));
        for lane in 0..3 {
            let z = (m[lane] - r[lane]).abs() * (samples / v[lane].max(MIN_VARIANCE)).sqrt();
            let p = if z.is_finite() { erfc(z / std::f64::consts::SQRT_2) } else { 0.0 };
            accepted += usize::from(p > level);
            min_p = min_p.min(p);
        }
    }
    let accepted = accepted as f64 / (3 * pixels) as f64;
    Ok(ZTest { accepted, level, min_p, passes: accepted >= REQUIRED })
}

fn xyz([r, g, b]: [f64; 3]) -> [f64; 3] {
    XYZ.map(|row| row[0] * r + row[1] * g + row[2] * b)
}

/// Complementary error function for x ≥ 0, relative error below 1.2·10⁻⁷ (W. Press et al., "Numerical Recipes in C",
/// 2nd ed., §6.2).
fn erfc(x: f64) -> f64 {
    const C: [f64; 10] = [
        0.170_872_77,
        -0.822_152_23,
        1.488_515_87,
        -1.135_203_98,
        0.278_868_07,
        -0.186_288_06,
        0.096_784_18,
        0.374_091_96,
        1.000_023_68,
        -1.265_512_23,
    ];
    let t = 1.0 / (1.0 + 0.5 * x);
    let polynomial = C.iter().fold(0.0, |sum, c| sum * t + c);
    t * (-x * x + polynomial).exp()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn erfc_at_known_points() {
        for (x, expected) in
            [(0.0, 1.0), (0.5, 0.479_500_122), (1.0, 0.157_299_207), (2.0, 0.004_677_735), (4.0, 1.541_725_8e-8)]
        {
            assert!((erfc(x) / expected - 1.0).abs() < 2e-7, "{x}: {}", erfc(x));
        }
    }

    /// Pictures whose pixels are means of `n` uniform numbers in [0, 1] (variance 1/12), with a bias added.
    fn noisy(n: u32, bias: f32) -> Image {
        let mut rng = steradian_math::hash::HashRng::new(7);
        let mut value = || (0..n).map(|_| rng.next_f32()).sum::<f32>() / n as f32 + bias;
        let pixels: Vec<_> = (0..64 * 64).map(|_| [value(); 3]).collect();
        Image::from_rgb(64, 64, &pixels).unwrap()
    }

    #[test]
    fn noise_passes_and_bias_fails() {
        let reference = Image::from_rgb(64, 64, &[[0.5; 3]; 64 * 64]).unwrap();
        // A grey of variance σ² has XYZ of variance σ² · (row sum)²; stored as Rec.709 this is close to grey σ².
        let variance = Image::from_rgb(64, 64, &[[1.0 / 12.0; 3]; 64 * 64]).unwrap();
        let good = z_test(&noisy(64, 0.0), &reference, &variance, 64.0).unwrap();
        assert!(good.passes && good.accepted > 0.999, "{good:?}");
        let biased = z_test(&noisy(64, 0.2), &reference, &variance, 64.0).unwrap();
        assert!(!biased.passes, "{biased:?}");
    }

    #[test]
    fn not_finite_is_rejected() {
        let reference = Image::from_rgb(1, 1, &[[0.5; 3]]).unwrap();
        let nan = Image::from_rgb(1, 1, &[[f32::NAN; 3]]).unwrap();
        assert_eq!(z_test(&nan, &reference, &reference, 4.0).unwrap().accepted, 0.0);
        assert!(z_test(&nan, &reference, &reference, 0.0).is_err());
    }
}
