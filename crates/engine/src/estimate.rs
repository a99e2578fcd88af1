//! Error estimate of a picture by its own samples, and its reliability.
//!
//! The variance of a pixel is found without bias, but what is rare is not found at all most of the time: where much of
//! the light comes by paths that are met a few times in the whole picture, samples tell of a smooth and dark one. So an
//! estimate comes with a [`Doubt`]: an integrator may know how rarely its paths meet some of the light
//! ([`crate::GroupIntegrator::rarest_path_probability`]), and an error that sits in a few pixels, each of which a few
//! bright samples hit, is not known to better than a factor.

use crate::adaptive::FLOOR;
use std::fmt;
use steradian_core::film::Pixel;

/// Edge of the squares within which pixels are near each other.
const CELL: usize = 8;
/// Number of finds below which light is known to worse than some 20 %.
pub(crate) const FEWEST_FINDS: f64 = 32.0;
/// Pixels that are to hold the half of the error, where they hold most of it and few samples make them.
const FEWEST_PIXELS: f64 = 8.0;
/// A variance of the mean of more than this part of its square is that of few samples: four that are equal, where all
/// others are black.
const FEW_SAMPLES: f64 = 0.25;

/// Reason not to trust an estimated error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Doubt {
    /// Photons showed light that paths without them meet a few times in the whole picture, or never.
    HardlyFound,
    /// Most of the error is that of a few pixels, in which a few samples are much brighter than all others.
    FewSamples,
}

impl fmt::Display for Doubt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::HardlyFound => "light arrives by paths that are hardly ever found",
            Self::FewSamples => {
                "light arrives by paths that are hardly ever found: a few bright samples make most of the error"
            }
        })
    }
}

/// A squared error over the squared level of what errs, `I² + 0.01`. The square of a mean exceeds that level by the
/// squared error, in the mean, which is taken out. A pixel that a rare bright sample hit is no measure of its level at
/// all, and would seem to err by no more than itself. Such pixels are held against those around.
fn relative(error: f64, mean: f64, around: f64) -> f64 {
    let square = mean * mean;
    let level = if error < FEW_SAMPLES * square { square - error } else { around.min(square) };
    error / (level + FLOOR)
}

/// The mean of squared levels, each of which is a square of a mean less its squared error. An eighth of them, the
/// brightest, are left out: those that a rare bright sample hit.
fn around(mut levels: Vec<f64>) -> f64 {
    levels.sort_by(f64::total_cmp);
    levels.truncate(levels.len() - levels.len() / 8);
    levels.iter().sum::<f64>().max(0.0) / levels.len().max(1) as f64
}

/// The sum over channels of squared relative errors of places that lie near each other, by their squared errors and
/// means.
pub(crate) fn relative_of(places: &[([f64; 3], [f64; 3])]) -> f64 {
    let around = around(places.iter().map(|(v, m)| (0..3).map(|c| m[c] * m[c] - v[c]).sum::<f64>() / 3.0).collect());
    places.iter().map(|(v, m)| (0..3).map(|c| relative(v[c], m[c], around)).sum::<f64>()).sum()
}

/// The squared relative errors of some pixels, added up.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Sum {
    /// Sum over all pixels.
    all: f64,
    /// Sum over pixels that few samples make, and the sum of its squares.
    rare: f64,
    rare_squares: f64,
}

impl Sum {
    /// Sum over pixels that lie near each other; `None` where one has not the two samples that it takes.
    pub fn of(pixels: &[Pixel]) -> Option<Self> {
        let each = || pixels.iter().map(|p| (p.variance_of_mean(), p.mean()));
        let around = around(each().map(|(v, m)| (0..3).map(|c| m[c] * m[c] - v[c]).sum::<f64>() / 3.0).collect());
        let mut sum = Self::default();
        for (v, m) in each() {
            let error = (0..3).map(|c| relative(v[c], m[c], around)).sum::<f64>();
            sum.all += error;
            if v.iter().sum::<f64>() > FEW_SAMPLES * m.iter().map(|m| m * m).sum::<f64>() {
                sum.rare += error;
                sum.rare_squares += error * error;
            }
        }
        pixels.iter().all(|p| p.samples >= 2).then_some(sum)
    }

    /// Sum over pixels by rows of `width`, in squares of [`CELL`].
    pub fn of_rows(pixels: &[Pixel], width: usize) -> Option<Self> {
        let mut sum = Self::default();
        for rows in pixels.chunks(CELL * width.max(1)) {
            for x in (0..width).step_by(CELL) {
                let to = width.min(x + CELL);
                let cell: Vec<Pixel> = rows.chunks(width).flat_map(|row| &row[x..to]).copied().collect();
                sum = sum.plus(Self::of(&cell)?);
            }
        }
        Some(sum)
    }

    /// The root of the mean over pixels and channels.
    pub fn relative(&self, pixels: usize) -> f64 {
        (self.all / (3 * pixels) as f64).sqrt()
    }

    /// Reason to doubt the estimate, by itself.
    pub fn doubt(&self) -> Option<Doubt> {
        self.is_of_few().then_some(Doubt::FewSamples)
    }

    pub fn plus(self, other: Self) -> Self {
        Self {
            all: self.all + other.all,
            rare: self.rare + other.rare,
            rare_squares: self.rare_squares + other.rare_squares,
        }
    }

    /// True if most of it is that of a few pixels, each of which few samples make: as many as would have this sum and
    /// these squares.
    fn is_of_few(&self) -> bool {
        self.rare > 0.5 * self.all && self.rare * self.rare < FEWEST_PIXELS * self.rare_squares
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `n` samples, of which `hits` have a value and the others are one.
    fn pixel(n: u32, hits: u32, value: f64) -> Pixel {
        let (n, hits) = (f64::from(n), f64::from(hits));
        let sum = n - hits + hits * value;
        Pixel { sum: [sum; 3], sum_squares: [n - hits + hits * value * value; 3], samples: n as u32 }
    }

    /// One sample that is 10⁵ times as bright as all others in the picture makes its error what it is, `(10⁵/64)²` of
    /// one pixel, not one.
    #[test]
    fn a_bright_sample_is_no_measure_of_its_pixel() {
        let mut pixels = [pixel(64, 0, 0.0); 64];
        pixels[20] = pixel(64, 1, 1e5);
        let sum = Sum::of(&pixels).expect("64 samples each");
        let true_error = 3.0 * (1e5_f64 / 64.0).powi(2) / 1.01;
        assert!((sum.all / true_error - 1.0).abs() < 0.02, "{sum:?} for {true_error}");
        assert!(sum.is_of_few());
        assert_eq!(Sum::of(&[pixel(1, 0, 0.0)]).map(|s| s.all), None);
    }

    /// Pixels that are bright throughout, and noise that all pixels have, are as they were: the variance over the
    /// square.
    #[test]
    fn plain_noise_is_what_it_was() {
        let mut pixels = [pixel(64, 32, 3.0); 64];
        pixels[20] = pixel(64, 32, 3e4);
        let sum = Sum::of(&pixels).expect("64 samples each");
        let plain = |p: &Pixel| p.variance_of_mean()[0] / (p.mean()[0].powi(2) + FLOOR);
        let expected = 3.0 * pixels.iter().map(plain).sum::<f64>();
        assert!((sum.all / expected - 1.0).abs() < 0.02, "{sum:?} for {expected}");
        assert!(!sum.is_of_few());
        // Many pixels with a rare sample each: their number tells how much that is.
        let speckled: Vec<Pixel> = (0..64).map(|k| pixel(64, u32::from(k % 3 == 0), 1e4)).collect();
        assert!(!Sum::of(&speckled).expect("64 samples each").is_of_few());
    }
}
