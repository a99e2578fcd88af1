//! Deterministic quadrature against Monte Carlo: the midpoint rule on a grid is exact for linear functions and
//! converges as `N^(−2/d)` for smooth ones in `d` dimensions, but errs always in the same way (bias); the mean of `N`
//! random values errs as `N^(−1/2)` in any dimension, and by chance.

use super::log_slope;
use crate::laboratory::{Axis, Chart, Error, Experiment, Marker, Parameter, Report, Run, Series, Values};
use steradian_math::{hash::HashRng, photon_noise::unit};

pub const EXPERIMENT: Experiment = Experiment {
    name: "quadrature",
    doc: "error of a grid and of random points by the number of points, in one to six dimensions",
    source: "Davis, Rabinowitz, Methods of Numerical Integration, §5.2 and §5.9",
    parameters: &[
        Parameter::count("dimensions", 2, (1, 6), "of the integral over the unit cube"),
        Parameter::choice(
            "integrand",
            &["smooth", "edge"],
            "a product of exponentials, or the indicator of a ball's corner",
        ),
        Parameter::count("points", 65_536, (64, 1 << 22), "most points"),
        Parameter::count(
            "runs",
            32,
            (2, 1000),
            "independent Monte Carlo estimates of which the error is the root mean square",
        ),
        Parameter::count("seed", 0, (0, u32::MAX), "random seed"),
    ],
    run: Run::Alone(run),
};

/// The integrand at a point, and its integral.
fn integrand(kind: &str, x: &[f64]) -> f64 {
    match kind {
        "smooth" => x.iter().map(|v| (-v).exp()).product(),
        _ => f64::from(u8::from(x.iter().map(|v| v * v).sum::<f64>() < 1.0)),
    }
}

fn integral(kind: &str, dimensions: usize) -> f64 {
    if kind == "smooth" {
        return (1.0 - (-1f64).exp()).powi(dimensions as i32);
    }
    // Volume of the unit ball over 2^d: V_d = V_{d−2} 2π/d.
    let volume = (0..=dimensions).fold([0.0, 0.0], |[a, b], d| match d {
        0 => [0.0, 1.0],
        1 => [1.0, 2.0],
        _ => [b, a * 2.0 * std::f64::consts::PI / d as f64],
    })[1];
    volume / 2f64.powi(dimensions as i32)
}

fn grid(kind: &str, dimensions: usize, edge: usize) -> f64 {
    let total = edge.pow(dimensions as u32);
    let mut x = [0.0; 6];
    (0..total)
        .map(|mut i| {
            for v in &mut x[..dimensions] {
                *v = ((i % edge) as f64 + 0.5) / edge as f64;
                i /= edge;
            }
            integrand(kind, &x[..dimensions])
        })
        .sum::<f64>()
        / total as f64
}

fn random(kind: &str, dimensions: usize, points: usize, rng: &mut HashRng) -> f64 {
    let mut x = [0.0; 6];
    (0..points)
        .map(|_| {
            x[..dimensions].iter_mut().for_each(|v| *v = unit(rng));
            integrand(kind, &x[..dimensions])
        })
        .sum::<f64>()
        / points as f64
}

fn run(values: &Values) -> Result<Report, Error> {
    let (dimensions, most) = (values.count("dimensions"), values.count("points"));
    let (kind, runs) = (values.choice("integrand"), values.count("runs"));
    if most * runs > 1 << 28 {
        return Err(Error::Impossible("'points' × 'runs' exceeds 2^28".into()));
    }
    let exact = integral(kind, dimensions);
    let (mut grids, mut means) = (Vec::new(), Vec::new());
    let mut edge = 2usize;
    while edge.pow(dimensions as u32) <= most {
        let n = edge.pow(dimensions as u32);
        grids.push((n as f64, (grid(kind, dimensions, edge) - exact).abs()));
        edge = (edge + 1).max((edge as f64 * 1.4) as usize);
    }
    let mut rng = HashRng::new(values.count("seed") as u64);
    let mut n = 4;
    let mut last_bias = 0.0;
    while n <= most {
        let errors: Vec<f64> = (0..runs).map(|_| random(kind, dimensions, n, &mut rng) - exact).collect();
        let square = errors.iter().map(|e| e * e).sum::<f64>() / runs as f64;
        last_bias = errors.iter().sum::<f64>() / runs as f64 / (square / runs as f64).sqrt();
        means.push((n as f64, square.sqrt()));
        n *= 4;
    }
    let mut report = Report::default();
    report.quantity("exact value", exact, "");
    for (name, points) in [("slope of the grid", &grids), ("slope of Monte Carlo", &means)] {
        if points.len() > 1 {
            report.quantity(name, log_slope(points), "");
        }
    }
    report.quantity("error of the finest grid", grids.last().map_or(f64::NAN, |p| p.1), "");
    report.quantity("error of the most random points", means.last().map_or(f64::NAN, |p| p.1), "");
    report.quantity("mean error of Monte Carlo in standard errors", last_bias, "");
    report.chart = Some(
        Chart::new(format!("{kind} integrand, {dimensions} dimensions"), Axis::log("points"), Axis::log("error"))
            .with(Series::line("grid (midpoints)", grids))
            .with(Series::line("random points, root mean square", means).drawn(Marker::Line)),
    );
    Ok(report)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// M145: the grid's slope is −2/d for a smooth function, Monte Carlo's −1/2 in any dimension, without bias.
    #[test]
    fn slopes_are_those_of_theory() {
        for d in [1, 2, 4] {
            let given = [("dimensions".to_owned(), d.to_string())];
            let r = EXPERIMENT.run(&given, None).unwrap();
            assert!((r.value("slope of the grid") + 2.0 / f64::from(d)).abs() < 0.05, "{d}");
            assert!((r.value("slope of Monte Carlo") + 0.5).abs() < 0.06, "{d}");
            assert!(r.value("mean error of Monte Carlo in standard errors").abs() < 4.0);
        }
        assert!((integral("edge", 2) - std::f64::consts::FRAC_PI_4).abs() < 1e-15);
        assert!((integral("edge", 3) - std::f64::consts::PI / 6.0).abs() < 1e-15);
    }
}
