//! Pearson's χ² test of a histogram against expected counts.

use statrs::distribution::{ChiSquared, ContinuousCDF};

/// The outcome of a χ² test.
#[derive(Clone, Copy, Debug)]
pub struct Chi2 {
    /// `Σ (observed − expected)² / expected` over the cells, small ones pooled.
    pub statistic: f64,
    /// Degrees of freedom: cells after pooling, less one.
    pub degrees: usize,
    /// Probability of a statistic at least as large if the histogram follows the expectation.
    pub p_value: f64,
}

/// Cells with a smaller expected count are pooled: below it the statistic is not χ² distributed.
const MIN_EXPECTED: f64 = 5.0;

/// Tests whether `observed` counts follow the `expected` ones.
///
/// `total` samples were drawn; what they and `expected` leave out of the cells (draws that were rejected) forms one
/// more cell. Cells that expect fewer than five are pooled, smallest first. Two outcomes are so wrong that they need no
/// statistics and give `p = 0`: more than one sample where less than 10⁻⁶ of one was expected, and an expectation that
/// sums to over 0.1 % (and one sample) more than `total`.
pub fn chi2_test(observed: &[u64], expected: &[f64], total: u64) -> Chi2 {
    chi2_test_within(observed, expected, total, 0.0)
}

/// [`chi2_test`] for expectations whose sum may err by a part `quadrature` of `total`: of the draws that were rejected
/// only what exceeds that counts. So many samples as to find the quadrature itself wanting need it.
pub fn chi2_test_within(observed: &[u64], expected: &[f64], total: u64, quadrature: f64) -> Chi2 {
    assert_eq!(observed.len(), expected.len(), "one expectation per cell");
    let impossible = Chi2 { statistic: f64::INFINITY, degrees: 0, p_value: 0.0 };
    let (seen, foreseen) = (observed.iter().sum::<u64>(), expected.iter().sum::<f64>());
    if seen > total || !foreseen.is_finite() || foreseen > total as f64 * 1.001 + 1.0 {
        return impossible;
    }
    let mut cells: Vec<(f64, f64)> = observed.iter().map(|&o| o as f64).zip(expected.iter().copied()).collect();
    let (rejected, slack) = ((total - seen) as f64, quadrature * total as f64);
    let left_out = total as f64 - foreseen;
    cells.push((rejected, rejected.clamp(left_out - slack, left_out + slack).max(0.0)));
    // The last cell holds the rounding of the quadrature too, so an unexpected sample or two may be real.
    if cells.iter().any(|&(o, e)| e < 0.0 || (e < 1e-6 && o > 1.0)) {
        return impossible;
    }
    cells.sort_by(|a, b| a.1.total_cmp(&b.1));
    let mut pooled: Vec<(f64, f64)> = Vec::with_capacity(cells.len());
    let mut pool = (0.0, 0.0);
    for (o, e) in cells {
        pool = (pool.0 + o, pool.1 + e);
        if pool.1 >= MIN_EXPECTED {
            pooled.push(pool);
            pool = (0.0, 0.0);
        }
    }
    // Only when all cells together expect fewer than five is anything left over.
    let statistic = pooled.iter().map(|&(o, e)| (o - e) * (o - e) / e).sum();
    let degrees = pooled.len().saturating_sub(1);
    if degrees == 0 {
        // One cell holds everything, and its total is right by construction.
        return Chi2 { statistic, degrees, p_value: 1.0 };
    }
    let p_value = ChiSquared::new(degrees as f64).map_or(0.0, |d| d.sf(statistic));
    Chi2 { statistic, degrees, p_value }
}

/// The significance level of each of `tests` independent tests for which the chance that any of them fails by accident
/// is `alpha`: `1 − (1 − α)^(1/n)` (Šidák 1967).
pub fn sidak(alpha: f64, tests: usize) -> f64 {
    1.0 - (1.0 - alpha).powf(1.0 / tests.max(1) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use steradian_math::hash::HashRng;

    fn histogram(seed: u64, cells: usize, n: u64, warp: impl Fn(f32) -> f32) -> Vec<u64> {
        let mut rng = HashRng::new(seed);
        let mut h = vec![0; cells];
        for _ in 0..n {
            h[((warp(rng.next_f32()) * cells as f32) as usize).min(cells - 1)] += 1;
        }
        h
    }

    #[test]
    fn accepts_what_follows_the_density_and_p_values_are_uniform() {
        let p: Vec<f64> =
            (0..400).map(|seed| chi2_test(&histogram(seed, 32, 4000, |u| u), &[125.0; 32], 4000).p_value).collect();
        let below = p.iter().filter(|&&p| p < 0.1).count();
        assert!((20..=60).contains(&below), "{below} of 400 p-values below 0.1");
        assert!(p.iter().all(|&p| p > 1e-5));
    }

    #[test]
    fn rejects_what_does_not() {
        let bent = histogram(1, 32, 40_000, |u| u.powf(1.1));
        assert!(chi2_test(&bent, &[1250.0; 32], 40_000).p_value < 1e-9);
        // Samples where none can be.
        assert_eq!(chi2_test(&[50, 50], &[100.0, 0.0], 100).p_value, 0.0);
        // A density that integrates to more than one.
        assert_eq!(chi2_test(&[50, 50], &[60.0, 60.0], 100).p_value, 0.0);
        // Samples lost that the density does not account for.
        assert!(chi2_test(&[4000, 4000], &[5000.0, 5000.0], 10_000).p_value < 1e-9);
    }

    #[test]
    fn rejected_draws_are_a_cell_and_rare_cells_are_pooled() {
        let c = chi2_test(&[500, 250, 1, 0, 2, 1, 0, 1], &[500.0, 250.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0], 1000);
        // {1,1,1,1,1}, {1 + 244}, {250}, {500}.
        assert_eq!(c.degrees, 3);
        assert!(c.p_value > 0.5, "{c:?}");
    }

    #[test]
    fn the_reference_values_of_the_distribution() {
        // P(χ²₄ > 9.4877) = 0.05.
        let shift = (9.487_729_f64 * 1000.0 / 2.0).sqrt();
        let o = [1000.0 + shift, 1000.0 - shift, 1000.0, 1000.0, 1000.0].map(|v: f64| v.round() as u64);
        let c = chi2_test(&o, &[1000.0; 5], 5000);
        assert_eq!(c.degrees, 4);
        assert!((c.p_value - 0.05).abs() < 2e-3, "{c:?}");
        assert!((sidak(0.01, 100) - 1.00498e-4).abs() < 1e-8);
        assert!((sidak(0.01, 1) - 0.01).abs() < 1e-15);
    }
}
