//! Tests of a Monte Carlo mean against the value it should have.

use statrs::distribution::{ContinuousCDF, Normal};

/// Running mean and variance (Welford 1962).
#[derive(Clone, Copy, Debug, Default)]
pub struct Moments {
    count: u64,
    mean: f64,
    squares: f64,
}

impl Moments {
    /// Adds a sample.
    pub fn push(&mut self, x: f64) {
        self.count += 1;
        let d = x - self.mean;
        self.mean += d / self.count as f64;
        self.squares += d * (x - self.mean);
    }

    /// Mean of the samples; zero for none.
    pub fn mean(&self) -> f64 {
        self.mean
    }

    /// Variance of one sample (unbiased); zero for fewer than two.
    pub fn variance(&self) -> f64 {
        if self.count < 2 { 0.0 } else { self.squares / (self.count - 1) as f64 }
    }

    /// Standard deviation of the mean.
    pub fn standard_error(&self) -> f64 {
        if self.count == 0 { 0.0 } else { (self.variance() / self.count as f64).sqrt() }
    }
}

impl Extend<f64> for Moments {
    fn extend<T: IntoIterator<Item = f64>>(&mut self, iter: T) {
        iter.into_iter().for_each(|x| self.push(x));
    }
}

impl FromIterator<f64> for Moments {
    fn from_iter<T: IntoIterator<Item = f64>>(iter: T) -> Self {
        let mut m = Self::default();
        m.extend(iter);
        m
    }
}

/// Probability that a standard normal variable is at least `|z|` from zero.
pub fn normal_two_sided_p(z: f64) -> f64 {
    Normal::new(0.0, 1.0).map_or(0.0, |n| (2.0 * n.sf(z.abs())).min(1.0))
}

/// Two-sided p-value of the hypothesis that `samples` have the mean `expected`. `tolerance` is a known error of the
/// expectation itself (a bound; rounding, quadrature): only what exceeds it counts. Without spread, a difference beyond
/// the tolerance gives 0.
pub fn z_test(samples: &Moments, expected: f64, tolerance: f64) -> f64 {
    let excess = ((samples.mean() - expected).abs() - tolerance).max(0.0);
    if excess == 0.0 {
        return 1.0;
    }
    let error = samples.standard_error();
    if error > 0.0 && excess.is_finite() { normal_two_sided_p(excess / error) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use steradian_math::hash::HashRng;

    fn uniform(seed: u64, n: usize) -> Moments {
        let mut rng = HashRng::new(seed);
        (0..n).map(|_| f64::from(rng.next_f32())).collect()
    }

    #[test]
    fn moments_are_those_of_the_distribution() {
        let m = uniform(3, 100_000);
        assert!((m.mean() - 0.5).abs() < 0.004);
        assert!((m.variance() - 1.0 / 12.0).abs() < 0.001);
        let few: Moments = [1.0, 2.0, 4.0].into_iter().collect();
        assert!((few.mean() - 7.0 / 3.0).abs() < 1e-12 && (few.variance() - 7.0 / 3.0).abs() < 1e-12);
    }

    #[test]
    fn the_test_accepts_the_mean_and_rejects_another() {
        assert!((normal_two_sided_p(1.959_964) - 0.05).abs() < 1e-6);
        let accepted = (0..200).filter(|&s| z_test(&uniform(s, 1000), 0.5, 0.0) > 0.05).count();
        assert!((175..=199).contains(&accepted), "{accepted} of 200");
        assert!(z_test(&uniform(1, 10_000), 0.52, 0.0) < 1e-6);
        assert!(z_test(&uniform(1, 10_000), 0.52, 0.03) > 0.01);
        let constant: Moments = [0.25; 4].into_iter().collect();
        assert_eq!(z_test(&constant, 0.25, 0.0), 1.0);
        assert_eq!(z_test(&constant, 0.26, 0.0), 0.0);
    }
}
