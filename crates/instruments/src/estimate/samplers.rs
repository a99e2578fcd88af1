//! The samplers of the renderer on known integrals over the unit square: root-mean-square error by the number of
//! samples, and its slope.

use super::log_slope;
use crate::laboratory::{Axis, Chart, Error, Experiment, Parameter, Report, Run, Series, Values};
use steradian_core::sampler::{SAMPLERS, Sampler, SamplerKind};

pub const EXPERIMENT: Experiment = Experiment {
    name: "samplers",
    doc: "error of every sampler on a known integral by the number of samples, with fitted slopes",
    source: "Pharr, Jakob, Humphreys, Physically Based Rendering, §8.2",
    parameters: &[
        Parameter::choice(
            "integrand",
            &["gaussian", "disk", "triangle", "step"],
            "smooth, a quarter disk, below the diagonal, or left of 1/π",
        ),
        Parameter::count("samples", 1024, (4, 65_536), "most samples"),
        Parameter::count("runs", 64, (2, 1024), "pixels, each an estimate of its own"),
        Parameter::count("seed", 0, (0, u32::MAX), "random seed"),
    ],
    run: Run::Alone(run),
};

fn integrand(kind: &str, x: f64, y: f64) -> f64 {
    match kind {
        "gaussian" => (-(x * x + y * y)).exp(),
        "disk" => f64::from(u8::from(x * x + y * y < 1.0)),
        "triangle" => f64::from(u8::from(y < x)),
        _ => f64::from(u8::from(x < std::f64::consts::FRAC_1_PI)),
    }
}

fn integral(kind: &str) -> f64 {
    match kind {
        // (√π/2 erf 1)²
        "gaussian" => 0.746_824_132_812_427_f64.powi(2),
        "disk" => std::f64::consts::FRAC_PI_4,
        "triangle" => 0.5,
        _ => std::f64::consts::FRAC_1_PI,
    }
}

fn run(values: &Values) -> Result<Report, Error> {
    let (kind, most, runs) = (values.choice("integrand"), values.count("samples"), values.count("runs"));
    if most * runs > 1 << 24 {
        return Err(Error::Impossible("'samples' × 'runs' exceeds 2^24".into()));
    }
    let exact = integral(kind);
    let mut report = Report::default();
    report.quantity("exact value", exact, "");
    let mut chart = Chart::new(kind, Axis::log("samples"), Axis::log("root-mean-square error"));
    // Runs are pixels, which must be independent of each other.
    for (name, sampler) in SAMPLERS.iter().filter(|(_, kind)| *kind != SamplerKind::Fixed) {
        let mut points = Vec::new();
        let mut n = 4;
        while n <= most {
            let sampler = Sampler { kind: *sampler, spp: n as u32, seed: values.count("seed") as u64 };
            let square = (0..runs as u32)
                .map(|pixel| {
                    // Pixels far apart, so that none shares its points with another.
                    let sum: f64 = (0..n as u32)
                        .map(|i| sampler.pixel(pixel * 512, pixel * 256, i).get_2d(0))
                        .map(|u| integrand(kind, f64::from(u.x), f64::from(u.y)))
                        .sum();
                    (sum / n as f64 - exact).powi(2)
                })
                .sum::<f64>()
                / runs as f64;
            points.push((n as f64, square.sqrt()));
            n *= 4;
        }
        report.quantity(format!("{name}: error with the most samples"), points.last().map_or(f64::NAN, |p| p.1), "");
        if points.len() > 1 {
            report.quantity(format!("{name}: slope"), log_slope(&points), "");
        }
        chart = chart.with(Series::line(*name, points));
    }
    report.chart = Some(chart);
    Ok(report)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// M153: independent points err as N^(−1/2); stratified ones at least as N^(−3/4) on an edge; scrambled nets as
    /// N^(−3/2) on a smooth function.
    #[test]
    fn slopes_are_those_of_theory() {
        let slope = |kind: &str, sampler: &str| {
            let given = [("integrand".to_owned(), kind.to_owned())];
            EXPERIMENT.run(&given, None).unwrap().value(&format!("{sampler}: slope"))
        };
        assert!((slope("gaussian", "independent") + 0.5).abs() < 0.08);
        assert!(slope("disk", "stratified") < -0.65 && slope("disk", "sobol") < -0.65);
        assert!(slope("gaussian", "sobol") < -1.2 && slope("gaussian", "pmj02") < -1.2);
    }
}
