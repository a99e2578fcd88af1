//! Experiments of Monte Carlo integration, each with its equation and source in its file.

mod branching;
mod importance;
mod quadrature;
mod samplers;
mod solid_angle;

use crate::laboratory::Experiment;

/// The experiments.
pub const EXPERIMENTS: &[Experiment] = &[
    quadrature::EXPERIMENT,
    importance::EXPERIMENT,
    samplers::EXPERIMENT,
    branching::EXPERIMENT,
    solid_angle::EXPERIMENT,
];

/// Slope of the least-squares line through the logarithms of points: `y ∝ x^slope`. Points that are not positive are
/// left out.
fn log_slope(points: &[(f64, f64)]) -> f64 {
    let logs: Vec<_> = points.iter().filter(|p| p.0 > 0.0 && p.1 > 0.0).map(|p| (p.0.ln(), p.1.ln())).collect();
    let n = logs.len() as f64;
    let (mx, my) = (logs.iter().map(|p| p.0).sum::<f64>() / n, logs.iter().map(|p| p.1).sum::<f64>() / n);
    logs.iter().map(|p| (p.0 - mx) * (p.1 - my)).sum::<f64>() / logs.iter().map(|p| (p.0 - mx).powi(2)).sum::<f64>()
}
