//! The sums of a pixel, which tell its mean and the variance of that.

use steradian_math::Vec3;

/// The sums of one pixel. Samples are added in the order of their index, whatever the thread, so the sums have the same
/// bits.
#[derive(Clone, Copy, Debug, Default)]
pub struct Pixel {
    /// Sum of linear Rec.709 radiance.
    pub sum: [f64; 3],
    /// Sum of its squares.
    pub sum_squares: [f64; 3],
    /// Samples added, those with a non-finite value among them (they add zero).
    pub samples: u32,
}

impl Pixel {
    /// The pixel whose mean has a value and an estimated variance, from a number of samples: the inverse of
    /// [`Self::mean`] and [`Self::variance_of_mean`].
    pub fn of(mean: [f64; 3], variance_of_mean: [f64; 3], samples: u32) -> Self {
        let n = f64::from(samples);
        Self {
            sum: mean.map(|m| m * n),
            sum_squares: std::array::from_fn(|c| n * (variance_of_mean[c] * (n - 1.0) + mean[c] * mean[c])),
            samples,
        }
    }

    /// Adds a sample; returns `false`, and adds zero radiance, if it is not finite. This is the one gate for NaN and
    /// infinity.
    #[inline]
    pub fn add(&mut self, rgb: Vec3) -> bool {
        self.samples += 1;
        if !rgb.is_finite() {
            return false;
        }
        for c in 0..3 {
            let v = f64::from(rgb[c]);
            self.sum[c] += v;
            self.sum_squares[c] += v * v;
        }
        true
    }

    /// Adds a finite sample that is a sum of many contributions.
    #[inline]
    pub fn add_value(&mut self, rgb: [f64; 3]) {
        self.samples += 1;
        for (c, v) in rgb.into_iter().enumerate() {
            self.sum[c] += v;
            self.sum_squares[c] += v * v;
        }
    }

    /// Adds the sums of further samples.
    #[inline]
    pub fn add_sums(&mut self, of: &Self) {
        for c in 0..3 {
            self.sum[c] += of.sum[c];
            self.sum_squares[c] += of.sum_squares[c];
        }
        self.samples += of.samples;
    }

    /// The mean: the pixel's linear Rec.709 radiance.
    pub fn mean(&self) -> [f64; 3] {
        let n = f64::from(self.samples.max(1));
        self.sum.map(|s| s / n)
    }

    /// The unbiased estimate of the variance of the mean; zero with fewer than two samples.
    pub fn variance_of_mean(&self) -> [f64; 3] {
        if self.samples < 2 {
            return [0.0; 3];
        }
        let n = f64::from(self.samples);
        std::array::from_fn(|c| {
            let mean = self.sum[c] / n;
            ((self.sum_squares[c] / n - mean * mean).max(0.0)) / (n - 1.0)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn non_finite_samples_are_counted_as_black() {
        let mut p = Pixel::default();
        assert!(p.add(Vec3::ONE));
        assert!(!p.add(Vec3::new(1.0, f32::NAN, 0.0)));
        assert!(!p.add(Vec3::splat(f32::INFINITY)));
        assert!(p.add(Vec3::splat(3.0)));
        assert_eq!((p.samples, p.mean()), (4, [1.0; 3]));
    }

    #[test]
    fn variance_of_mean_is_that_of_statistics() {
        let mut p = Pixel::default();
        for v in [1.0, 2.0, 3.0, 4.0_f32] {
            p.add(Vec3::splat(v));
        }
        // Sample variance 5/3, over four samples.
        assert!((p.variance_of_mean()[0] - 5.0 / 12.0).abs() < 1e-12);
        let q = Pixel::of(p.mean(), p.variance_of_mean(), p.samples);
        assert!((q.mean()[0] - 2.5).abs() < 1e-12 && (q.variance_of_mean()[0] - 5.0 / 12.0).abs() < 1e-12);
    }
}
