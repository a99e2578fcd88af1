//! Random directions of the hemisphere: uniform in the two angles, uniform in solid angle, or by the cosine.
//!
//! `θ = πξ/2`, `φ = 2πξ'` has the density `1/(π² sin θ)` per solid angle, so it crowds at the pole, where an estimate
//! `f/p` has the weight `sin θ`; uniform directions have `1/2π` and those by the cosine `cos θ/π` (Pharr, Jakob,
//! Humphreys, *Physically Based Rendering*, 4th ed., §A.5).

use crate::{
    chi_square::ChiSquare,
    laboratory::{Axis, Chart, Error, Experiment, Marker, Parameter, Report, Run, Series, Values},
};
use std::f64::consts::{FRAC_PI_2, TAU};
use steradian_math::{Vec2, Vec3, geometry::solid_angle::integrate_sphere, hash::HashRng, warp};

pub const EXPERIMENT: Experiment = Experiment {
    name: "directions",
    doc: "random directions of the hemisphere against their density, and what they make of an integral",
    source: "Pharr, Jakob, Humphreys, Physically Based Rendering, 4th ed., §A.5",
    parameters: &[
        Parameter::choice(
            "by",
            &["angle", "solid-angle", "cosine"],
            "what is uniform: θ and φ, the solid angle, the disc",
        ),
        Parameter::number("power", 1.0, (0.0, 100.0), "", "n of the integral of cosⁿ θ that is estimated"),
        Parameter::count("samples", 100_000, (64, 1 << 24), "directions"),
        Parameter::count("seed", 0, (0, u32::MAX), "random seed"),
    ],
    run: Run::Alone(run),
};

/// Draws a direction.
fn draw(by: &str, u: Vec2) -> Vec3 {
    match by {
        "solid-angle" => warp::uniform_hemisphere(u),
        "cosine" => warp::cosine_hemisphere(u),
        _ => warp::uniform_angle_hemisphere(u),
    }
}

/// Density per solid angle, sr⁻¹.
fn density(by: &str, sin: f64, cos: f64) -> f64 {
    f64::from(match by {
        "solid-angle" => warp::UNIFORM_HEMISPHERE_PDF,
        "cosine" => warp::cosine_hemisphere_pdf(cos as f32),
        _ => warp::uniform_angle_hemisphere_pdf(sin as f32),
    })
}

fn run(values: &Values) -> Result<Report, Error> {
    let (by, power, samples) = (values.choice("by"), values.number("power"), values.count("samples"));
    const RINGS: usize = 18;
    const SECTORS: usize = 12;
    let mut rng = HashRng::new(values.count("seed") as u64);
    let mut counts = vec![0.0; RINGS * SECTORS];
    let (mut mean, mut squares) = (0.0, 0.0);
    for k in 0..samples {
        let d = draw(by, Vec2::new(rng.next_f32(), rng.next_f32())).as_dvec3();
        let (sin, cos) = (d.x.hypot(d.y), d.z.max(0.0));
        let ring = ((sin.atan2(cos) / FRAC_PI_2 * RINGS as f64) as usize).min(RINGS - 1);
        let sector = ((d.y.atan2(d.x).rem_euclid(TAU) / TAU * SECTORS as f64) as usize).min(SECTORS - 1);
        counts[ring * SECTORS + sector] += 1.0;
        // At the very pole, where the density has no bound, the weight is zero.
        let p = density(by, sin, cos);
        let estimate = if p > 0.0 && p.is_finite() { cos.powf(power) / p } else { 0.0 };
        let off = estimate - mean;
        mean += off / (k + 1) as f64;
        squares += off * (estimate - mean);
    }
    let edge = |ring: usize| FRAC_PI_2 * ring as f64 / RINGS as f64;
    // Shares of the rings: the integrals of the densities.
    let below = |theta: f64| match by {
        "solid-angle" => 1.0 - theta.cos(),
        "cosine" => theta.sin().powi(2),
        _ => theta / FRAC_PI_2,
    };
    let share = |ring: usize| below(edge(ring + 1)) - below(edge(ring));
    let expected: Vec<f64> =
        (0..RINGS * SECTORS).map(|k| samples as f64 * share(k / SECTORS) / SECTORS as f64).collect();
    let fit = ChiSquare::of(&counts, &expected);
    let mut report = Report::default();
    report.quantity("χ² of the counts", fit.statistic, "");
    report.quantity("degrees of freedom", fit.freedom, "");
    report.quantity("probability of as much or more", fit.p, "");
    // Over the sphere |cos θ|ⁿ would be counted twice.
    report.quantity("integral of cosⁿ θ", 0.5 * integrate_sphere(|d| d.z.abs().powf(power), 256), "sr");
    report.quantity("its estimate", mean, "sr");
    let variance = squares / (samples - 1) as f64;
    report.quantity("standard deviation of one estimate", variance.sqrt(), "sr");
    report.quantity("standard error", (variance / samples as f64).sqrt(), "sr");
    let middle = |ring: usize| 0.5 * (edge(ring) + edge(ring + 1));
    let observed = |ring: usize| {
        let count: f64 = counts[ring * SECTORS..(ring + 1) * SECTORS].iter().sum();
        count / samples as f64 / (TAU * (edge(ring).cos() - edge(ring + 1).cos()))
    };
    let curve = |theta: f64| (theta.to_degrees(), density(by, theta.sin(), theta.cos()));
    report.chart = Some(
        Chart::new(
            "density of directions",
            Axis::linear("angle from the pole (°)").over(0.0, 90.0),
            Axis::linear("density (1/sr)").over(0.0, 1.0),
        )
        .with(Series::line(
            "p(θ)",
            (1..=360).map(|k| curve(FRAC_PI_2 * f64::from(k) / 360.0)).filter(|p| p.1 <= 1.0).collect(),
        ))
        .with(
            Series::line("directions drawn", (0..RINGS).map(|r| (middle(r).to_degrees(), observed(r))).collect())
                .drawn(Marker::Dots),
        ),
    );
    Ok(report)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::run_with;
    use std::f64::consts::PI;

    /// M146: directions fit their densities; ∫cos θ dω = π, and one estimate has the variances of theory: from uniform
    /// angles E[(π² sin θ cos θ)²] − π² = π⁴/8 − π², uniform directions 4π²/3 − π², and none by the cosine.
    #[test]
    fn directions_have_their_density_and_variance() {
        for (by, variance) in [("angle", PI.powi(4) / 8.0 - PI * PI), ("solid-angle", PI * PI / 3.0), ("cosine", 0.0)] {
            let r = run_with(&EXPERIMENT, &[("by", by)]).unwrap();
            assert!(r.value("probability of as much or more") > 1e-4, "{by}");
            assert!((r.value("integral of cosⁿ θ") - PI).abs() < 1e-4);
            let error = (variance / 1e5).sqrt();
            assert!((r.value("its estimate") - PI).abs() <= 4.0 * error + 1e-6, "{by}");
            assert!(
                (r.value("standard deviation of one estimate") - variance.sqrt()).abs() < 0.02 * variance.sqrt() + 1e-5
            );
        }
    }
}
