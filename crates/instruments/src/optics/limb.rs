//! Discs of spheres: how bright they are from the middle to the limb.
//!
//! A sphere that emits as Lambert's law says is a flat disc, `L(μ) = 1`; the sun darkens towards its limb,
//! `L(μ)/L(1) = 1 − u (1 − μ)` with `u ≈ 0.6` at 550 nm (Allen, *Astrophysical Quantities*); a Lambertian reflector lit
//! from behind the observer falls off as `μ`, but dust as on the full moon (Lommel and Seeliger, `μ₀/(μ₀ + μ)` with
//! `μ₀ = μ`) is flat.

use crate::laboratory::{Axis, Chart, Error, Experiment, Parameter, Picture, Report, Run, Series, Values};

pub const EXPERIMENT: Experiment = Experiment {
    name: "limb",
    doc: "discs of a Lambertian emitter, the sun, a Lambertian reflector and the full moon",
    source: "Lambert 1760; Seeliger 1887; Allen, Astrophysical Quantities, §81",
    parameters: &[Parameter::number("darkening", 0.6, (0.0, 1.0), "", "coefficient u of the sun's limb darkening")],
    run: Run::Alone(run),
};

/// Radiance by the cosine μ and the sun's coefficient u.
type Radiance = fn(f64, f64) -> f64;

/// The discs: name, and radiance by the cosine μ of the direction to the eye, relative to the middle.
const DISCS: [(&str, Radiance); 4] = [
    ("Lambertian emitter", |_, _| 1.0),
    ("sun", |mu, u| 1.0 - u * (1.0 - mu)),
    ("Lambertian reflector, lit from the eye", |mu, _| mu),
    ("full moon (Lommel–Seeliger)", |mu, _| 2.0 * mu / (mu + mu)),
];

fn run(values: &Values) -> Result<Report, Error> {
    let u = values.number("darkening");
    let mu = |r: f64| (1.0 - r * r).max(1e-12).sqrt();
    let mut report = Report::default();
    let mut chart = Chart::new(
        "from the middle to the limb",
        Axis::linear("distance from the middle (radii)"),
        Axis::linear("radiance relative to the middle").over(0.0, 1.05),
    );
    for (name, radiance) in DISCS {
        // ∫ L 2r dr over the disc.
        let n = 100_000;
        let mean: f64 =
            (0..n).map(|k| radiance(mu(((f64::from(k) + 0.5) / f64::from(n)).sqrt()), u)).sum::<f64>() / f64::from(n);
        report.quantity(format!("mean over the disc, {name}"), mean, "");
        let points = (0..=400).map(|k| f64::from(k) / 400.0).map(|r| (r, radiance(mu(r), u))).collect();
        chart = chart.with(Series::line(name, points));
    }
    report.chart = Some(chart);
    const EDGE: usize = 256;
    let picture = Picture::from_fn(DISCS.len() * EDGE, EDGE, |x, y| {
        let radiance = DISCS[x / EDGE].1;
        let at = |v: usize, k: u32| (v as f64 + (f64::from(k) + 0.5) / 4.0 - EDGE as f64 / 2.0) / (0.46 * EDGE as f64);
        let sum: f64 = (0..16)
            .map(|k| at(x % EDGE, k % 4).hypot(at(y, k / 4)))
            .map(|r| if r < 1.0 { radiance(mu(r), u) } else { 0.0 })
            .sum();
        [(sum / 16.0) as f32; 3]
    });
    report.picture = Some(picture.to_image()?);
    Ok(report)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// M77: means over the disc: 1, 1 − u/3, 2/3 and 1.
    #[test]
    fn means_over_the_disc_have_their_closed_forms() {
        let report = EXPERIMENT.run(&[], None).unwrap();
        for (q, exact) in report.quantities.iter().zip([1.0, 1.0 - 0.6 / 3.0, 2.0 / 3.0, 1.0]) {
            assert!((q.value - exact).abs() < 1e-5, "{}: {} {exact}", q.name, q.value);
        }
    }
}
