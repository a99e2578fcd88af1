//! Poisson numbers, the counts of photons.

use steradian_math::hash::HashRng;

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
    use steradian_testkit as testkit;

    /// M136: χ² against the distribution itself, on both sides of the change of method.
    #[test]
    fn counts_are_poisson() {
        for (k, mean) in [0.3, 3.0, 9.9, 10.1, 40.0, 3000.0].into_iter().enumerate() {
            let mut rng = HashRng::new(k as u64);
            const DRAWS: u64 = 200_000;
            let deviation = f64::sqrt(mean).max(1.0);
            let width = (deviation / 5.0).ceil();
            let first = (mean - 5.0 * deviation).floor().max(0.0);
            let mut counts = [0_u64; 50];
            for _ in 0..DRAWS {
                let at = (poisson(mean, &mut rng) - first) / width;
                if (0.0..50.0).contains(&at) {
                    counts[at as usize] += 1;
                }
            }
            let mass = |k: f64| (k * mean.ln() - mean - ln_factorial(k)).exp();
            let expected: [f64; 50] = std::array::from_fn(|b| {
                (0..width as u32).map(|j| mass(first + b as f64 * width + f64::from(j))).sum::<f64>() * DRAWS as f64
            });
            let outcome = testkit::chi2_test(&counts, &expected, DRAWS);
            assert!(outcome.p_value > testkit::sidak(0.01, 6), "mean {mean}: {outcome:?}");
        }
        assert_eq!(poisson(0.0, &mut HashRng::new(0)), 0.0);
    }
}
