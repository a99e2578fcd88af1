//! Random counts of photons and the noise of reading them: Poisson and normal numbers.

use crate::hash::HashRng;

/// A number in (0, 1) with 53 bits.
pub fn unit(rng: &mut HashRng) -> f64 {
    ((rng.next_u64() >> 11) as f64 + 0.5) * (1.0 / 9_007_199_254_740_992.0)
}

/// A Poisson number of a mean (not negative): by multiplying up to a mean of 10, by Hörmann's transformed rejection
/// (PTRS, 1993) above.
pub fn poisson(mean: f64, rng: &mut HashRng) -> f64 {
    if mean < 10.0 {
        let limit = (-mean).exp();
        let (mut count, mut product) = (0.0, unit(rng));
        while product > limit {
            count += 1.0;
            product *= unit(rng);
        }
        return count;
    }
    let (ln_mean, b) = (mean.ln(), 0.931 + 2.53 * mean.sqrt());
    let a = -0.059 + 0.02483 * b;
    let inverse_alpha = 1.1239 + 1.1328 / (b - 3.4);
    let v_r = 0.9277 - 3.6224 / (b - 2.0);
    loop {
        let (u, v) = (unit(rng) - 0.5, unit(rng));
        let us = 0.5 - u.abs();
        let k = ((2.0 * a / us + b) * u + mean + 0.43).floor();
        if us >= 0.07 && v <= v_r {
            return k;
        }
        if k < 0.0 || (us < 0.013 && v > us) {
            continue;
        }
        if v.ln() + inverse_alpha.ln() - (a / (us * us) + b).ln() <= k * ln_mean - mean - ln_factorial(k) {
            return k;
        }
    }
}

/// A standard normal number (Box and Muller 1958).
pub fn normal(rng: &mut HashRng) -> f64 {
    let (u, v) = (unit(rng), unit(rng));
    (-2.0 * u.ln()).sqrt() * (2.0 * std::f64::consts::PI * v).cos()
}

/// `ln k!`: by the sum for small numbers, else by Stirling's series (error below 1e-10 from 10 on).
pub fn ln_factorial(k: f64) -> f64 {
    if k < 10.0 {
        return (2..=k as u32).map(|i| f64::from(i).ln()).sum();
    }
    let x = k + 1.0;
    (x - 0.5) * x.ln() - x + 0.5 * (2.0 * std::f64::consts::PI).ln() + 1.0 / (12.0 * x) - 1.0 / (360.0 * x.powi(3))
        + 1.0 / (1260.0 * x.powi(5))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chi_square::assert_fits;

    /// Poisson's distribution up to `k`, by the ratio of neighbours outwards from its mode, which no logarithm enters.
    fn masses(mean: f64, most: usize) -> Vec<f64> {
        let mut masses = vec![0.0; most + 1];
        let mode = mean as usize;
        masses[mode] = 1.0;
        (mode + 1..=most).for_each(|k| masses[k] = masses[k - 1] * mean / k as f64);
        (0..mode).rev().for_each(|k| masses[k] = masses[k + 1] * (k + 1) as f64 / mean);
        let sum: f64 = masses.iter().sum();
        masses.iter().map(|m| m / sum).collect()
    }

    /// χ² against the distribution itself, on both sides of the change of method.
    #[test]
    fn counts_are_poisson() {
        const DRAWS: usize = 200_000;
        for (seed, mean) in [2.5, 9.9, 10.1, 40.0, 3000.0].into_iter().enumerate() {
            let mut rng = HashRng::new(seed as u64);
            let masses = masses(mean, (mean + 12.0 * f64::sqrt(mean) + 20.0) as usize);
            let width = (f64::sqrt(mean) / 5.0).ceil() as usize;
            let expected: Vec<f64> = masses.chunks(width).map(|c| c.iter().sum::<f64>() * DRAWS as f64).collect();
            let mut counts = vec![0.0; expected.len()];
            (0..DRAWS).for_each(|_| counts[poisson(mean, &mut rng) as usize / width] += 1.0);
            assert_fits(&format!("mean {mean}"), &counts, &expected);
        }
        assert_eq!(poisson(0.0, &mut HashRng::new(0)), 0.0);
    }

    /// Mean, variance and third and fourth moments, of a normal number.
    #[test]
    fn normal_numbers_have_their_moments() {
        const DRAWS: u32 = 400_000;
        let mut rng = HashRng::new(7);
        let mut sums = [0.0; 4];
        for _ in 0..DRAWS {
            let v = normal(&mut rng);
            (1..).zip(&mut sums).for_each(|(k, sum)| *sum += v.powi(k));
        }
        // The variance of v^k is E v^2k − (E v^k)²: 1, 2, 15, 96.
        for ((sum, mean), variance) in sums.iter().zip([0.0, 1.0, 0.0, 3.0]).zip([1.0, 2.0, 15.0, 96.0]) {
            let (found, error) = (sum / f64::from(DRAWS), f64::sqrt(variance / f64::from(DRAWS)));
            assert!((found - mean).abs() < 4.0 * error, "{found} instead of {mean}");
        }
    }
}
