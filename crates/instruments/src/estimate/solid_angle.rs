//! Areas on the sphere: caps `2π (1 − cos α)`, lunes `2α`, triangles (Girard: the sum of the angles less π) and
//! rectangles seen from a point, each by its closed form and by counting random directions.

use crate::laboratory::{Axis, Chart, Error, Experiment, Parameter, Report, Run, Series, Values};
use glam::DVec3;
use std::f64::consts::PI;
use steradian_math::{hash::HashRng, photon_noise::unit};

pub const EXPERIMENT: Experiment = Experiment {
    name: "solid-angle",
    doc: "solid angles of a cap, a lune, a triangle and a rectangle, by closed form and by random directions",
    source: "Girard 1629; Oosterom, Strackee 1983 (triangle)",
    parameters: &[
        Parameter::choice("set", &["cap", "lune", "triangle", "rectangle"], "what is measured"),
        Parameter::number("angle", 30.0, (0.01, 180.0), "°", "half the opening of the cap, or the angle of the lune"),
        Parameter::number(
            "width",
            1.0,
            (1e-3, 1e3),
            "",
            "of the rectangle; legs of the triangle's corners on the axes",
        ),
        Parameter::number("height", 1.0, (1e-3, 1e3), "", "of the rectangle"),
        Parameter::number("distance", 1.0, (1e-3, 1e3), "", "of the rectangle's middle from the eye"),
        Parameter::count("samples", 200_000, (10, 1 << 24), "directions"),
        Parameter::count("seed", 0, (0, u32::MAX), "random seed"),
    ],
    run: Run::Alone(run),
};

/// Solid angle of the triangle with unit corners: `tan(Ω/2) = |a·(b×c)| / (1 + a·b + b·c + c·a)`.
fn triangle(a: DVec3, b: DVec3, c: DVec3) -> f64 {
    2.0 * a.dot(b.cross(c)).abs().atan2(1.0 + a.dot(b) + b.dot(c) + c.dot(a))
}

fn run(values: &Values) -> Result<Report, Error> {
    let angle = values.number("angle").to_radians();
    let (w, h, d) = (values.number("width"), values.number("height"), values.number("distance"));
    let corners =
        [DVec3::new(1.0, 0.0, 0.2 * w), DVec3::new(0.0, 1.0, 0.2), DVec3::new(0.3, 0.3, 1.0)].map(DVec3::normalize);
    let set = values.choice("set");
    let exact = match set {
        "cap" => 2.0 * PI * (1.0 - angle.cos()),
        "lune" => 2.0 * angle,
        "triangle" => triangle(corners[0], corners[1], corners[2]),
        _ => 4.0 * (w * h / (2.0 * d * (4.0 * d * d + w * w + h * h).sqrt())).atan(),
    };
    let is_inside = |v: DVec3| match set {
        "cap" => v.z > angle.cos(),
        "lune" => v.y.atan2(v.x).rem_euclid(2.0 * PI) < angle,
        "triangle" => {
            let [a, b, c] = corners;
            let side = a.dot(b.cross(c)).signum();
            [(a, b), (b, c), (c, a)].iter().all(|(p, q)| side * v.dot(p.cross(*q)) > 0.0)
        }
        _ => v.z > 0.0 && (v.x / v.z * d).abs() < w / 2.0 && (v.y / v.z * d).abs() < h / 2.0,
    };
    let mut rng = HashRng::new(values.count("seed") as u64);
    let samples = values.count("samples");
    let mut inside = 0u32;
    let mut points = Vec::new();
    for k in 1..=samples {
        let (z, phi) = (1.0 - 2.0 * unit(&mut rng), 2.0 * PI * unit(&mut rng));
        let r = (1.0 - z * z).sqrt();
        inside += u32::from(is_inside(DVec3::new(r * phi.cos(), r * phi.sin(), z)));
        if k.is_power_of_two() || k == samples {
            points.push((k as f64, 4.0 * PI * f64::from(inside) / k as f64));
        }
    }
    let share = f64::from(inside) / samples as f64;
    let mut report = Report::default();
    report.quantity("closed form", exact, "sr");
    report.quantity("by random directions", 4.0 * PI * share, "sr");
    report.quantity("its standard error", 4.0 * PI * (share * (1.0 - share) / samples as f64).sqrt(), "sr");
    report.chart = Some(
        Chart::new(set, Axis::log("directions"), Axis::linear("solid angle (sr)"))
            .with(Series::line("estimate", points))
            .with(Series::line("closed form", vec![(1.0, exact), (samples as f64, exact)])),
    );
    Ok(report)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// M26: the closed forms and the count agree; an octant by Girard is π/2.
    #[test]
    fn closed_forms_agree_with_counting() {
        for set in ["cap", "lune", "triangle", "rectangle"] {
            let r = EXPERIMENT.run(&[("set".to_owned(), set.to_owned())], None).unwrap();
            let off = r.value("by random directions") - r.value("closed form");
            assert!(off.abs() < 4.0 * r.value("its standard error"), "{set}: {off}");
        }
        assert!((triangle(DVec3::X, DVec3::Y, DVec3::Z) - PI / 2.0).abs() < 1e-15);
    }
}
