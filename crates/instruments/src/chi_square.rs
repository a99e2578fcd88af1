//! Pearson's χ² test of counts against what is expected of them.

use statrs::function::gamma::checked_gamma_ur;

/// Result of the χ² test.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ChiSquare {
    /// `Σ (o − e)²/e`.
    pub statistic: f64,
    /// Cells less one.
    pub freedom: f64,
    /// The probability of that much or more where the expectation is right, in [0, 1].
    pub p: f64,
}

impl ChiSquare {
    /// Test of counts against expectations with the same sum. Cells that expect fewer than five are taken together, the
    /// smallest first.
    pub fn of(observed: &[f64], expected: &[f64]) -> Self {
        let mut sorted: Vec<(f64, f64)> = observed.iter().copied().zip(expected.iter().copied()).collect();
        sorted.sort_by(|a, b| a.1.total_cmp(&b.1));
        let (mut cells, mut pool): (Vec<(f64, f64)>, _) = (Vec::new(), (0.0, 0.0));
        for (o, e) in sorted {
            pool = (pool.0 + o, pool.1 + e);
            if pool.1 >= 5.0 {
                cells.push(pool);
                pool = (0.0, 0.0);
            }
        }
        let statistic = cells.iter().map(|(o, e)| (o - e).powi(2) / e).sum::<f64>();
        let freedom = cells.len().saturating_sub(1) as f64;
        let p = if freedom > 0.0 { checked_gamma_ur(0.5 * freedom, 0.5 * statistic).unwrap_or(0.0) } else { 1.0 };
        Self { statistic, freedom, p }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Critical values of tables (NIST/SEMATECH e-Handbook, §1.3.6.7.4): 5 % beyond 3.841, 11.070 and 18.307 of 1, 5
    /// and 10 degrees of freedom.
    #[test]
    fn probabilities_are_those_of_tables() {
        for (freedom, critical) in [(1, 3.841), (5, 11.070), (10, 18.307)] {
            // All the excess in one cell, and in the last what it lacks.
            let n = freedom + 1;
            let expected = vec![1000.0; n];
            let mut observed = expected.clone();
            let off = (critical * 1000.0 / 2.0f64).sqrt();
            observed[0] += off;
            observed[n - 1] -= off;
            let test = ChiSquare::of(&observed, &expected);
            assert!((test.statistic - critical).abs() < 1e-9 && test.freedom == freedom as f64);
            assert!((test.p - 0.05).abs() < 2e-5, "{}", test.p);
        }
        assert!(ChiSquare::of(&[100.0, 100.0, 100.0], &[150.0, 150.0, 0.0]).p < 1e-4);
    }
}
