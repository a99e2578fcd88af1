//! Branching against single paths: in a closed Lambertian room of albedo ρ that emits 1 everywhere, radiance is `Σ ρᵏ`
//! up to the last bounce. A tracer that branches into `N` rays at each of `k` bounces traces `N + N² + … + Nᵏ` rays;
//! `Nᵏ` single paths trace `k Nᵏ`. Both have the same mean.
//!
//! Rays are made noisy as in a scene: a bounce meets a wall whose emission is 1 ± `contrast`.

use crate::laboratory::{Axis, Chart, Error, Experiment, Parameter, Report, Run, Series, Values};
use steradian_math::{hash::HashRng, photon_noise::unit};

pub const EXPERIMENT: Experiment = Experiment {
    name: "branching",
    doc: "N rays at each bounce against single paths: mean, variance, and numbers of rays",
    source: "Cook, Porter, Carpenter 1984; Kajiya 1986",
    parameters: &[
        Parameter::count("rays", 4, (1, 16), "N: rays at each bounce"),
        Parameter::count("bounces", 4, (1, 8), "k: bounces"),
        Parameter::number("albedo", 0.7, (0.0, 1.0), "", "of the walls"),
        Parameter::number("contrast", 0.9, (0.0, 1.0), "", "how much emission differs from wall to wall"),
        Parameter::count("estimates", 400, (2, 100_000), "of each kind"),
        Parameter::count("seed", 0, (0, u32::MAX), "random seed"),
    ],
    run: Run::Alone(run),
};

/// Radiance that a ray brings, with so many bounces after it, branching `n`-fold; counts the rays.
fn ray(n: usize, bounces: usize, albedo: f64, contrast: f64, rng: &mut HashRng, rays: &mut u64) -> f64 {
    *rays += 1;
    let emission = 1.0 + contrast * (2.0 * unit(rng) - 1.0);
    if bounces == 0 {
        return emission;
    }
    let sum: f64 = (0..n).map(|_| ray(n, bounces - 1, albedo, contrast, rng, rays)).sum();
    emission + albedo * sum / n as f64
}

/// Mean and variance of estimates, and rays for each.
fn estimate(count: usize, rays: &mut u64, mut one: impl FnMut(&mut u64) -> f64) -> (f64, f64, f64) {
    let values: Vec<f64> = (0..count).map(|_| one(rays)).collect();
    let mean = values.iter().sum::<f64>() / count as f64;
    let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (count - 1) as f64;
    (mean, variance, *rays as f64 / count as f64)
}

fn run(values: &Values) -> Result<Report, Error> {
    let (n, k, count) = (values.count("rays"), values.count("bounces"), values.count("estimates"));
    let (albedo, contrast) = (values.number("albedo"), values.number("contrast"));
    let leaves = n.pow(k as u32);
    if (leaves * k).saturating_mul(count) > 1 << 28 {
        return Err(Error::Impossible("N^k × k × 'estimates' exceeds 2^28 rays".into()));
    }
    let mut rng = HashRng::new(values.count("seed") as u64);
    // The first vertex is seen by the camera: its emission is 1, its bounces branch.
    let (mut branched, mut single) = (0, 0);
    let trees = estimate(count, &mut branched, |rays| {
        let sum: f64 = (0..n).map(|_| ray(n, k - 1, albedo, contrast, &mut rng, rays)).sum();
        1.0 + albedo * sum / n as f64
    });
    let paths = estimate(count, &mut single, |rays| {
        let sum: f64 = (0..leaves).map(|_| ray(1, k - 1, albedo, contrast, &mut rng, rays)).sum();
        1.0 + albedo * sum / leaves as f64
    });
    let exact: f64 = (0..=k).map(|j| albedo.powi(j as i32)).sum();
    let mut report = Report::default();
    report.quantity("exact value", exact, "");
    for (name, (mean, variance, rays)) in [("branching", trees), ("single paths", paths)] {
        report.quantity(format!("{name}: mean"), mean, "");
        report.quantity(format!("{name}: standard error"), (variance / count as f64).sqrt(), "");
        report.quantity(format!("{name}: rays for each estimate"), rays, "");
        report.quantity(format!("{name}: variance × rays"), variance * rays, "");
    }
    let rays = |n: f64| (1..=8).map(|k| (f64::from(k), (1..=k).map(|j| n.powi(j)).sum::<f64>())).collect::<Vec<_>>();
    report.chart = Some(
        Chart::new("rays of one branching estimate", Axis::linear("bounces"), Axis::log("rays"))
            .with(Series::line("N = 1", rays(1.0)))
            .with(Series::line("N = 2", rays(2.0)))
            .with(Series::line("N = 4", rays(4.0)))
            .with(Series::line("N = 16", rays(16.0))),
    );
    Ok(report)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// M152: the same mean, and N + N² + … + Nᵏ rays against k Nᵏ.
    #[test]
    fn both_have_the_same_mean_and_their_numbers_of_rays() {
        let r = EXPERIMENT.run(&[], None).unwrap();
        for name in ["branching", "single paths"] {
            let error = r.value(&format!("{name}: standard error"));
            assert!((r.value(&format!("{name}: mean")) - r.value("exact value")).abs() < 4.0 * error, "{name}");
        }
        assert_eq!(r.value("branching: rays for each estimate"), 4.0 + 16.0 + 64.0 + 256.0);
        assert_eq!(r.value("single paths: rays for each estimate"), 4.0 * 256.0);
    }
}
