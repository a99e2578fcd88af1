//! Surfaces: a point of each, its normal two ways, fundamental forms and curvature, area and volume against a mesh.

use super::{
    curvature::{Forms, total},
    drawing, tell3,
};
use crate::laboratory::{Error, Experiment, Marker, Parameter, Report, Run, Values};
use glam::DVec3;
use steradian_math::geometry::{
    Point3,
    surface::{Ellipsoid, Explicit, Implicit, Paraboloid, Parametric, Torus, tessellate},
};

pub const EXPERIMENT: Experiment = Experiment {
    name: "surface",
    doc: "a surface: points, normals, fundamental forms, curvature, area and volume",
    source: "do Carmo, Differential Geometry of Curves and Surfaces, §2.5 and §3.3",
    parameters: &[
        Parameter::choice("kind", &["torus", "sphere", "ellipsoid", "paraboloid", "saddle"], "which surface"),
        Parameter::number("a", 2.0, (1e-3, 1e3), "", "radius or first semi-axis; of x² in z = a x² ± b y²"),
        Parameter::number("b", 0.7, (1e-3, 1e3), "", "radius of the tube; second semi-axis; of y²"),
        Parameter::number("c", 1.0, (1e-3, 1e3), "", "third semi-axis; half the extent in x and y"),
        Parameter::number("u", 0.125, (0.0, 1.0), "", "first parameter of the point, as a share of its range"),
        Parameter::number("v", 0.2, (0.0, 1.0), "", "second parameter of the point, as a share of its range"),
        Parameter::count("cells", 32, (3, 256), "cells of the mesh along each parameter"),
    ],
    run: Run::Alone(run),
};

fn run(values: &Values) -> Result<Report, Error> {
    let [a, b, c] = ["a", "b", "c"].map(|name| values.number(name));
    let kind = values.choice("kind");
    let none = |why: &str| Error::Impossible(why.to_owned());
    match kind {
        "sphere" | "ellipsoid" => {
            let radii = if kind == "sphere" { DVec3::splat(a) } else { DVec3::new(a, b, c) };
            let s = Ellipsoid::new(Point3::ORIGIN, radii).ok_or_else(|| none("semi-axes must be positive"))?;
            let mut report = examine(&s, Some(s.volume()), values);
            let [u, v] = place(&s, values);
            let (u, v) = s.parameters(s.point(u, v));
            report.quantity("azimuth φ of the point", u.to_degrees(), "°");
            report.quantity("angle θ of the point", v.to_degrees(), "°");
            Ok(report)
        }
        "torus" => {
            let s = Torus::new(a, b).ok_or_else(|| none("the tube 'b' must be thinner than the radius 'a' is long"))?;
            Ok(examine(&s, Some(s.volume()), values))
        }
        _ => {
            let b = if kind == "saddle" { -b } else { b };
            let s = Paraboloid::new(Point3::ORIGIN, a, b, c).ok_or_else(|| none("the extent 'c' must be positive"))?;
            let mut report = examine(&s, None, values);
            let [u, v] = place(&s, values);
            report.quantity("explicit, z", s.height(u, v), "");
            Ok(report)
        }
    }
}

/// The parameters of the point.
fn place(surface: &impl Parametric, values: &Values) -> [f64; 2] {
    let [[u0, u1], [v0, v1]] = surface.domain();
    let (s, t) = (values.number("u"), values.number("v"));
    [u0 + (u1 - u0) * s, v0 + (v1 - v0) * t]
}

fn examine<S: Parametric + Implicit>(surface: &S, volume: Option<f64>, values: &Values) -> Report {
    let mut report = Report::default();
    let [u, v] = place(surface, values);
    let p = surface.point(u, v);
    tell3(&mut report, "point", p.to_vector());
    report.quantity("implicit form at the point", surface.value(p), "");
    let normal = surface.normal_at(u, v);
    tell3(&mut report, "outward normal", normal);
    if let Some(gradient) = surface.normal(p) {
        tell3(&mut report, "normal by the gradient", gradient);
    }
    let [du, dv] = surface.partials(u, v);
    match du.cross(dv).try_normalize() {
        Some(n) => report.quantity("∂u × ∂v along the outward normal", n.dot(normal), ""),
        None => report.fact("∂u × ∂v", "zero: the parameters have a pole here"),
    }
    let forms = Forms::at(surface, u, v);
    for (name, value) in ["E", "F", "G"].into_iter().zip(forms.first) {
        report.quantity(format!("first fundamental form, {name}"), value, "");
    }
    for (name, value) in ["L", "M", "N"].into_iter().zip(forms.second) {
        report.quantity(format!("second fundamental form, {name}"), value + 0.0, "");
    }
    if let Some((k, h)) = forms.curvatures() {
        report.quantity("Gaussian curvature", k, "");
        report.quantity("mean curvature", h, "");
        let half = (h * h - k).max(0.0).sqrt();
        report.quantity("first principal curvature", h + half, "");
        report.quantity("second principal curvature", h - half, "");
        let sign = 1e-9 * h * h;
        let kind = ["hyperbolic", "parabolic", "elliptic"][usize::from(k >= -sign) + usize::from(k > sign)];
        report.fact("the point", kind);
    }
    const NODES: usize = 64;
    let area = surface.area(NODES);
    report.quantity("area", area, "");
    report.quantity("total curvature over 2π", total(surface, NODES) / std::f64::consts::TAU, "");
    let cells = values.count("cells");
    if let Some(mesh) = tessellate(surface, cells, cells) {
        report.quantity("area of the mesh", mesh.area(), "");
        if let Some(volume) = volume {
            report.quantity("volume", volume, "");
            report.quantity("volume of the mesh", mesh.volume(), "");
        }
    }
    let [[u0, u1], [v0, v1]] = surface.domain();
    let at = |s: f64, t: f64| surface.point(u0 + (u1 - u0) * s, v0 + (v1 - v0) * t).to_vector();
    let size = (0..=8).map(|k| at(f64::from(k) / 8.0, 0.5).length()).fold(p.to_vector().length(), f64::max);
    let mut chart = drawing::view(format!("{}, a point and its normal", values.choice("kind")), size);
    for line in 0..=16 {
        let share = f64::from(line) / 16.0;
        let along = || (0..=48).map(|k| f64::from(k) / 48.0);
        for curve in
            [drawing::curve("", along().map(|s| at(s, share))), drawing::curve("", along().map(|t| at(share, t)))]
        {
            chart = chart.with(curve.colored([0xa8, 0xb4, 0xc4]));
        }
    }
    let tip = p.to_vector() + normal * size * 0.4;
    chart = chart
        .with(drawing::curve("outward normal", [p.to_vector(), tip]).colored([0xa8, 0x2c, 0x62]))
        .with(drawing::curve("the point", [p.to_vector()]).drawn(Marker::Dots).colored([0, 0, 0]));
    report.chart = Some(chart);
    report
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::run_with;
    use std::f64::consts::PI;

    /// M12–M14: the sphere of radius 2 has 16π and 32π/3, Gaussian curvature 1/4 and total curvature 4π; the torus of 2
    /// and 0.7 has 5.6π² and 1.96π²; the ellipsoid of 1, 2, 3 an area of 48.8821 (Legendre's integrals).
    #[test]
    fn areas_volumes_and_curvatures_are_the_known_ones() {
        let sphere = run_with(&EXPERIMENT, &[("kind", "sphere")]).unwrap();
        let torus = run_with(&EXPERIMENT, &[]).unwrap();
        let ellipsoid = run_with(&EXPERIMENT, &[("kind", "ellipsoid"), ("a", "1"), ("b", "2"), ("c", "3")]).unwrap();
        for (report, name, exact) in [
            (&sphere, "area", 16.0 * PI),
            (&sphere, "volume", 32.0 * PI / 3.0),
            (&sphere, "Gaussian curvature", 0.25),
            (&sphere, "total curvature over 2π", 2.0),
            (&torus, "area", 5.6 * PI * PI),
            (&torus, "volume", 1.96 * PI * PI),
            (&torus, "total curvature over 2π", 0.0),
            (&ellipsoid, "area", 48.882_146_3),
            (&ellipsoid, "volume", 8.0 * PI),
        ] {
            assert!((report.value(name) - exact).abs() < 1e-6 * (1.0 + exact), "{name} {}", report.value(name));
        }
        // The usual parameters of an ellipsoid turn inwards (E24).
        assert!((ellipsoid.value("∂u × ∂v along the outward normal") + 1.0).abs() < 1e-9);
        assert!((torus.value("∂u × ∂v along the outward normal") - 1.0).abs() < 1e-9);
    }

    /// M14: the mesh nears the area as the square of its cells.
    #[test]
    fn the_mesh_is_of_second_order() {
        let error = |cells: &str| {
            16.0 * PI
                - run_with(&EXPERIMENT, &[("kind", "sphere"), ("cells", cells)]).unwrap().value("area of the mesh")
        };
        let order = (error("32") / error("64")).log2();
        assert!((order - 2.0).abs() < 0.02, "{order}");
    }

    #[test]
    fn points_are_told_apart() {
        let fact = |kind: &str, v: &str| {
            let report = run_with(&EXPERIMENT, &[("kind", kind), ("v", v)]).unwrap();
            report.facts.last().map(|f| f.text.clone()).unwrap_or_default()
        };
        assert_eq!((fact("torus", "0").as_str(), fact("torus", "0.25").as_str()), ("elliptic", "parabolic"));
        assert_eq!((fact("torus", "0.5").as_str(), fact("saddle", "0.3").as_str()), ("hyperbolic", "hyperbolic"));
        assert!(fact("sphere", "0").contains("pole"));
        assert!(run_with(&EXPERIMENT, &[("b", "3")]).is_err());
    }
}
