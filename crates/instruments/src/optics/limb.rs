//! Discs of spheres: how bright they are from the middle to the limb.
//!
//! A sphere that emits as Lambert's law says is a flat disc, `L(μ) = 1`; the sun darkens towards its limb,
//! `L(μ)/L(1) = 1 − u (1 − μ)` with `u ≈ 0.6` at 550 nm (Allen, *Astrophysical Quantities*); a Lambertian reflector has
//! `μ₀`, the cosine of the light, but dust as on the moon `2μ₀/(μ₀ + μ)` (Lommel and Seeliger), so that the full moon,
//! with `μ₀ = μ`, is flat. Light comes from the side by the phase angle.

use crate::laboratory::{Axis, Chart, Error, Experiment, Parameter, Picture, Report, Run, Series, Values};
use std::f64::consts::TAU;

pub const EXPERIMENT: Experiment = Experiment {
    name: "limb",
    doc: "discs of a Lambertian emitter, the sun, a Lambertian reflector and the full moon",
    source: "Lambert 1760; Seeliger 1887; Allen, Astrophysical Quantities, §81",
    parameters: &[
        Parameter::number("darkening", 0.6, (0.0, 1.0), "", "coefficient u of the sun's limb darkening"),
        Parameter::number("phase", 0.0, (0.0, 180.0), "°", "angle at the reflectors between the light and the eye"),
    ],
    run: Run::Alone(run),
};

/// Radiance by the cosine μ₀ of the direction to the light, the cosine μ of that to the eye, and the sun's coefficient.
type Radiance = fn(f64, f64, f64) -> f64;

/// The discs: name, and radiance relative to the middle in full light.
const DISCS: [(&str, Radiance); 4] = [
    ("Lambertian emitter", |_, _, _| 1.0),
    ("sun", |_, mu, u| 1.0 - u * (1.0 - mu)),
    ("Lambertian reflector", |light, _, _| light),
    ("moon (Lommel–Seeliger)", |light, mu, _| 2.0 * light / (light + mu).max(1e-12)),
];

fn run(values: &Values) -> Result<Report, Error> {
    let u = values.number("darkening");
    let (sin_phase, cos_phase) = values.number("phase").to_radians().sin_cos();
    let at = |radiance: Radiance, x: f64, y: f64| {
        let mu = (1.0 - x * x - y * y).max(1e-12).sqrt();
        radiance((x * sin_phase + mu * cos_phase).max(0.0), mu, u)
    };
    let mut report = Report::default();
    let mut chart = Chart::new(
        "from the middle to the limb",
        Axis::linear("distance from the middle towards the light (radii)"),
        Axis::linear("radiance relative to the middle").over(0.0, 1.05),
    );
    for (name, radiance) in DISCS {
        // ∫ L 2r dr dφ/2π over the disc, which is ∫ L 2μ dμ dφ/2π.
        const RINGS: u32 = 600;
        const SECTORS: u32 = 360;
        let mut mean = 0.0;
        for mu in (0..RINGS).map(|k| (f64::from(k) + 0.5) / f64::from(RINGS)) {
            let r = (1.0 - mu * mu).sqrt();
            let around = (0..SECTORS).map(|k| ((f64::from(k) + 0.5) * TAU / f64::from(SECTORS)).sin_cos());
            mean += 2.0 * mu * around.map(|(s, c)| at(radiance, r * c, r * s)).sum::<f64>();
        }
        report.quantity(format!("mean over the disc, {name}"), mean / f64::from(RINGS * SECTORS), "");
        let points = (-400..=400).map(|k| f64::from(k) / 400.0).map(|r| (r, at(radiance, r, 0.0))).collect();
        chart = chart.with(Series::line(name, points));
    }
    report.chart = Some(chart);
    const EDGE: usize = 256;
    let picture = Picture::from_fn(DISCS.len() * EDGE, EDGE, |x, y| {
        let radiance = DISCS[x / EDGE].1;
        let on = |v: usize, k: u32| (v as f64 + (f64::from(k) + 0.5) / 4.0 - EDGE as f64 / 2.0) / (0.46 * EDGE as f64);
        let sum: f64 = (0..16)
            .map(|k| (on(x % EDGE, k % 4), on(y, k / 4)))
            .map(|(x, y)| if x.hypot(y) < 1.0 { at(radiance, x, y) } else { 0.0 })
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

    /// Phases: the light of a sphere against that of its full disc is (sin α + (π − α) cos α)/π after Lambert, so 1/π
    /// at half moon, and 1 + sin α/2 tan α/2 ln tan α/4 after Lommel and Seeliger (Fairbairn, *J. R. Astron. Soc. Can.*
    /// 99, 2005).
    #[test]
    fn phases_have_their_closed_forms() {
        for degrees in [30.0f64, 60.0, 90.0, 120.0] {
            let a = degrees.to_radians();
            let r = EXPERIMENT.run(&[("phase".to_owned(), degrees.to_string())], None).unwrap();
            let lambert = (a.sin() + (std::f64::consts::PI - a) * a.cos()) / std::f64::consts::PI;
            let dust = 1.0 + (a / 2.0).sin() * (a / 2.0).tan() * (a / 4.0).tan().ln();
            let found = r.value("mean over the disc, Lambertian reflector") / (2.0 / 3.0);
            assert!((found - lambert).abs() < 2e-4, "{degrees}: {found} {lambert}");
            let found = r.value("mean over the disc, moon (Lommel–Seeliger)");
            assert!((found - dust).abs() < 1e-3, "{degrees}: {found} {dust}");
        }
    }
}
