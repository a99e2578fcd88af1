//! Gain of importance sampling: `∫ cosⁿθ dω` over the hemisphere, with directions drawn by `p ∝ cosᵐθ`.
//!
//! With `p = (m + 1)/(2π) cosᵐθ` one estimate is `2π/(m + 1) cosⁿ⁻ᵐθ`, its mean `2π/(n + 1)`, and its second moment
//! `4π²/((m + 1)(2n − m + 1))`, so the variance is known for `m < 2n + 1`, zero at `m = n`, and infinite from there on.

use crate::laboratory::{Axis, Chart, Error, Experiment, Marker, Parameter, Report, Run, Series, Values};
use std::f64::consts::PI;
use steradian_math::{hash::HashRng, photon_noise::unit};

pub const EXPERIMENT: Experiment = Experiment {
    name: "importance",
    doc: "variance of an integral over directions by the density they are drawn from, measured and by theory",
    source: "Veach 1997, §2.5.2; the moments above",
    parameters: &[
        Parameter::number("lobe", 5.0, (0.0, 1000.0), "", "exponent n of the integrand"),
        Parameter::number(
            "density",
            1.0,
            (0.0, 1000.0),
            "",
            "exponent m of the density: 0 is uniform, 1 cosine-weighted",
        ),
        Parameter::count("samples", 100_000, (2, 1 << 24), "estimates"),
        Parameter::count("seed", 0, (0, u32::MAX), "random seed"),
    ],
    run: Run::Alone(run),
};

/// Variance of one estimate.
fn variance(n: f64, m: f64) -> f64 {
    if m >= 2.0 * n + 1.0 {
        return f64::INFINITY;
    }
    4.0 * PI * PI / ((m + 1.0) * (2.0 * n - m + 1.0)) - (2.0 * PI / (n + 1.0)).powi(2)
}

fn run(values: &Values) -> Result<Report, Error> {
    let (n, m) = (values.number("lobe"), values.number("density"));
    let samples = values.count("samples");
    let mut rng = HashRng::new(values.count("seed") as u64);
    let (mut sum, mut squares) = (0.0, 0.0);
    for k in 0..samples {
        // cos θ = ξ^(1/(m+1)) (Welford's sums).
        let estimate = 2.0 * PI / (m + 1.0) * unit(&mut rng).powf((n - m) / (m + 1.0));
        let d = estimate - sum;
        sum += d / (k + 1) as f64;
        squares += d * (estimate - sum);
    }
    let measured = squares / (samples - 1) as f64;
    let mut report = Report::default();
    report.quantity("exact value", 2.0 * PI / (n + 1.0), "");
    report.quantity("mean of the estimates", sum, "");
    report.quantity("variance, measured", measured, "");
    report.quantity("variance, by theory", variance(n, m), "");
    if variance(n, m) > 0.0 && measured > 0.0 {
        report.quantity("gain over uniform directions, by theory", variance(n, 0.0) / variance(n, m), "");
        report.quantity("gain over uniform directions, measured", variance(n, 0.0) / measured, "");
    }
    let far = 2.0 * n + 1.0;
    let points = (0..400).map(|k| far * f64::from(k) / 400.0).map(|m| (m, variance(n, m).max(0.0) + 1e-12)).collect();
    report.chart = Some(
        Chart::new(
            format!("∫ cos^{n} θ dω"),
            Axis::linear("exponent of the density"),
            Axis::log("variance of one estimate"),
        )
        .with(Series::line("theory", points))
        .with(Series::line("measured", vec![(m, measured.max(1e-12))]).drawn(Marker::Dots)),
    );
    Ok(report)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// M149: means and variances are those of theory; the perfect density has none.
    #[test]
    fn the_gain_is_that_of_theory() {
        for (n, m) in [(1.0, 0.0), (1.0, 1.0), (5.0, 1.0), (20.0, 10.0), (3.0, 4.0)] {
            let given = [("lobe".to_owned(), f64::to_string(&n)), ("density".to_owned(), f64::to_string(&m))];
            let r = EXPERIMENT.run(&given, None).unwrap();
            let (exact, v) = (r.value("exact value"), r.value("variance, by theory"));
            let error = (v / 1e5).sqrt();
            assert!((r.value("mean of the estimates") - exact).abs() <= 4.0 * error + 1e-12, "{n} {m}");
            if n == m {
                assert!(r.value("variance, measured") < 1e-20);
            } else {
                // Fourth moments of these are at most some twenty times the squared variance: five per cent is five
                // deviations.
                assert!(
                    (r.value("variance, measured") / v - 1.0).abs() < 0.08,
                    "{n} {m}: {}",
                    r.value("variance, measured") / v
                );
            }
        }
        assert!(variance(1.0, 3.0).is_infinite());
    }
}
