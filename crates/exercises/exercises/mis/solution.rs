//! Multiple importance sampling; the task is in README.md.
#![allow(unused_variables)]

/// The weight of the power heuristic for a point that was drawn with density p.
pub fn weight(p: f64, other: f64) -> f64 {
    // gap
    let below = p * p + other * other;
    if below > 0.0 { p * p / below } else { 0.0 }
    // end
}

/// The estimate of the integral from one point of each strategy.
pub fn estimate(fa: f64, pa_a: f64, pb_a: f64, fb: f64, pa_b: f64, pb_b: f64) -> f64 {
    // gap
    weight(pa_a, pb_a) * fa / pa_a + weight(pb_b, pa_b) * fb / pb_b
    // end
}
