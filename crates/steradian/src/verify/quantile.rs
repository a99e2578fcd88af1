//! Quantiles of Student's distribution.

use std::f64::consts::PI;

/// Number of standard errors that one of so many variables of Student's distribution exceeds with a probability.
pub(super) fn quantile(alpha: f64, tests: usize, freedom: usize) -> f64 {
    let level = -((-alpha).ln_1p() / tests.max(1) as f64).exp_m1();
    // By bisection of the logarithm.
    let (mut low, mut high) = (1e-3_f64, 1e12_f64);
    for _ in 0..80 {
        let middle = (low * high).sqrt();
        if within(middle, freedom.clamp(1, 2000)) < 1.0 - level { low = middle } else { high = middle }
    }
    high
}

/// The probability that a variable of Student's distribution is within `t` of zero (Abramowitz, Stegun 1964, eq. 26.7.3
/// and 26.7.4).
fn within(t: f64, freedom: usize) -> f64 {
    let theta = (t / (freedom as f64).sqrt()).atan();
    let (sin, cos) = theta.sin_cos();
    let odd = freedom % 2;
    // Terms of cos^k with every second k below the number of degrees of freedom.
    let (mut term, mut sum) = (if odd == 1 { cos } else { 1.0 }, 0.0);
    for k in (odd..freedom.saturating_sub(1)).step_by(2) {
        sum += term;
        term *= (k + 1) as f64 / (k + 2) as f64 * cos * cos;
    }
    if odd == 1 { 2.0 / PI * (theta + sin * sum) } else { sin * sum }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_tables() {
        for (alpha, freedom, expected) in
            [(0.05, 1, 12.706), (0.05, 2, 4.303), (0.05, 5, 2.571), (0.01, 15, 2.947), (0.05, 120, 1.980)]
        {
            let t = quantile(alpha, 1, freedom);
            assert!((t - expected).abs() < 2e-3, "{freedom}: {t}");
        }
        // One of ten thousand at a hundredth: 1.005e-6 for each, of nearly normal variables.
        assert!((quantile(0.01, 10_000, 2000) - 4.906).abs() < 1e-2, "{}", quantile(0.01, 10_000, 2000));
    }
}
