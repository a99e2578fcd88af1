//! Error metrics between two pictures.

mod area;
mod delta_e;
mod difference;
mod flip;
mod ssim;
mod ztest;

pub use area::resampled;
pub use delta_e::{DeltaE, delta_e};
pub use difference::{absolute_difference, flip_picture, magma};
pub use flip::{DEFAULT_PIXELS_PER_DEGREE, flip, flip_map};
pub use ssim::ssim;
pub use ztest::{ZTest, z_test, z_test_with};

use crate::encoding::srgb_encode;
use crate::{Error, Image, Result, RgbPlanes};

/// Keeps relative errors finite where the reference is black.
const EPSILON: f64 = 0.01;

/// |x − reference| / (|reference| + 0.01), the term of [`Comparison::mape`].
pub fn relative_error(x: f64, reference: f64) -> f64 {
    (x - reference).abs() / (reference.abs() + EPSILON)
}

/// Pixel-wise differences between a picture and its reference, over the three colour components.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Comparison {
    /// Mean of (x − ref)².
    pub mse: f64,
    /// Square root of `mse`.
    pub rmse: f64,
    /// Mean of (x − ref)² / (ref² + 0.01).
    pub rel_mse: f64,
    /// Mean of |x − ref| / (|ref| + 0.01). Of the same ε as tev's relative absolute error, and not in percent.
    pub mape: f64,
    /// Mean of |x − ref| / (|x| + |ref| + 0.01), at most 1: Vogels et al., "Denoising with Kernel Prediction and
    /// Asymmetric Loss Functions" (2018), with its ε.
    pub smape: f64,
    /// Peak signal-to-noise ratio in dB of the display values (sRGB-encoded, cut to [0, 1]); infinite for equal ones.
    pub psnr: f64,
    /// Largest |x − ref|.
    pub max_abs: f64,
    /// Mean R, G, B of the picture.
    pub mean: [f64; 3],
    /// Mean R, G, B of the reference.
    pub reference_mean: [f64; 3],
    /// Mean / reference mean; NaN where the reference is black.
    pub ratio: [f64; 3],
    /// Components that are NaN or infinite in either picture; they are left out of all other numbers.
    pub non_finite: usize,
}

/// Compares the colours of two pictures.
///
/// # Errors
/// [`Error::SizeMismatch`], [`Error::MissingChannels`], and [`Error::Invalid`] when no component is finite in both.
pub fn compare(image: &Image, reference: &Image) -> Result<Comparison> {
    let (a, b) = colours(image, reference)?;
    let (mut squared, mut relative, mut display, mut max_abs) = (0.0, 0.0, 0.0, 0.0f64);
    let (mut mape, mut smape) = (0.0, 0.0);
    let (mut mean, mut reference_mean, mut counts) = ([0.0; 3], [0.0; 3], [0usize; 3]);
    for (lane, (x, r)) in [(a.r, b.r), (a.g, b.g), (a.b, b.b)].into_iter().enumerate() {
        for (&x, &r) in x.iter().zip(r).filter(|(x, r)| x.is_finite() && r.is_finite()) {
            let shown = |v: f32| f64::from(srgb_encode(v.clamp(0.0, 1.0)));
            let seen = shown(x) - shown(r);
            let (x, r) = (f64::from(x), f64::from(r));
            let difference = x - r;
            squared += difference * difference;
            relative += difference * difference / (r * r + 0.01);
            mape += relative_error(x, r);
            smape += difference.abs() / (x.abs() + r.abs() + EPSILON);
            display += seen * seen;
            max_abs = max_abs.max(difference.abs());
            mean[lane] += x;
            reference_mean[lane] += r;
            counts[lane] += 1;
        }
    }
    let count: usize = counts.iter().sum();
    if count == 0 {
        return Err(Error::Invalid("no component is finite in both pictures".into()));
    }
    let n = count as f64;
    for lane in 0..3 {
        mean[lane] /= counts[lane] as f64;
        reference_mean[lane] /= counts[lane] as f64;
    }
    let mse = squared / n;
    Ok(Comparison {
        mse,
        rmse: mse.sqrt(),
        rel_mse: relative / n,
        mape: mape / n,
        smape: smape / n,
        psnr: -10.0 * (display / n).log10(),
        max_abs,
        mean,
        reference_mean,
        ratio: std::array::from_fn(|lane| mean[lane] / reference_mean[lane]),
        non_finite: 3 * image.pixel_count() - count,
    })
}

/// The colour planes of two pictures of the same size.
fn colours<'a>(a: &'a Image, b: &'a Image) -> Result<(RgbPlanes<'a>, RgbPlanes<'a>)> {
    let size = |image: &Image| format!("{}x{}", image.width(), image.height());
    if (a.width(), a.height()) != (b.width(), b.height()) {
        return Err(Error::SizeMismatch { left: size(a), right: size(b) });
    }
    Ok((a.require_rgb()?, b.require_rgb()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_differences() {
        let reference = Image::from_rgb(2, 1, &[[1.0, 0.0, 0.5], [2.0, 0.0, 0.5]]).unwrap();
        let image = Image::from_rgb(2, 1, &[[1.1, 0.0, 0.5], [2.0, 0.2, 0.5]]).unwrap();
        let c = compare(&image, &reference).unwrap();
        let mse = (0.01 + 0.04) / 6.0;
        assert!((c.mse - mse).abs() < 1e-7 && (c.rmse - mse.sqrt()).abs() < 1e-7);
        assert!((c.rel_mse - (0.01 / 1.01 + 0.04 / 0.01) / 6.0).abs() < 1e-6);
        assert!((c.mape - (0.1 / 1.01 + 0.2 / 0.01) / 6.0).abs() < 1e-6);
        assert!((c.smape - (0.1 / 2.11 + 0.2 / 0.21) / 6.0).abs() < 1e-6);
        assert!((c.ratio[0] - 3.1 / 3.0).abs() < 1e-7 && c.ratio[2] == 1.0 && c.ratio[1].is_infinite());
        assert!((c.max_abs - 0.2).abs() < 1e-7);
        // 1.1 is cut at 1, so that only the green 0.2 is seen.
        let seen = f64::from(srgb_encode(0.2));
        assert!((c.psnr - 10.0 * (6.0 / (seen * seen)).log10()).abs() < 1e-4);
    }

    #[test]
    fn equal_pictures_and_mismatches() {
        let a = Image::from_rgb(1, 1, &[[f32::NAN, 0.5, 2.0]]).unwrap();
        let c = compare(&a, &a).unwrap();
        assert_eq!((c.mse, c.mape, c.smape, c.psnr, c.non_finite), (0.0, 0.0, 0.0, f64::INFINITY, 1));
        let b = Image::from_rgb(2, 1, &[[0.0; 3]; 2]).unwrap();
        assert!(matches!(compare(&a, &b), Err(Error::SizeMismatch { .. })));
        let nan = Image::from_rgb(1, 1, &[[f32::NAN; 3]]).unwrap();
        assert!(compare(&nan, &a).is_err());
    }
}
