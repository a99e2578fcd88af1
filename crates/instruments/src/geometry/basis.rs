//! Bases: coordinates with respect to any three vectors, and the orthonormal basis that Gram and Schmidt make of them.
//!
//! With the basis vectors as columns of `B` and the origin `c`, a point has the coordinates `B⁻¹(p − c)`, which is
//! `Bᵀ(p − c)` for an orthonormal basis.

use super::{RANGE, drawing, tell_matrix, tell3, vector3};
use crate::laboratory::{Error, Experiment, Marker, Parameter, Report, Run, Values};
use glam::DMat3;
use steradian_math::{
    geometry::{
        axes::{Handedness, handedness},
        vector::{angle_between, decompose, determinant, signed_projection},
    },
    transform::Transform,
};

pub const EXPERIMENT: Experiment = Experiment {
    name: "basis",
    doc: "coordinates of a point in a basis, its handedness, and the orthonormal basis made of it",
    source: "Strang, Introduction to Linear Algebra, §4.4",
    parameters: &[
        Parameter::number("ux", 1.0, RANGE, "", "first vector"),
        Parameter::number("uy", 1.0, RANGE, "", "first vector"),
        Parameter::number("uz", 0.0, RANGE, "", "first vector"),
        Parameter::number("vx", 1.0, RANGE, "", "second vector"),
        Parameter::number("vy", 0.0, RANGE, "", "second vector"),
        Parameter::number("vz", 1.0, RANGE, "", "second vector"),
        Parameter::number("wx", 0.0, RANGE, "", "third vector"),
        Parameter::number("wy", 1.0, RANGE, "", "third vector"),
        Parameter::number("wz", 1.0, RANGE, "", "third vector"),
        Parameter::number("cx", 0.0, RANGE, "", "origin of the system"),
        Parameter::number("cy", 0.0, RANGE, "", "origin of the system"),
        Parameter::number("cz", 0.0, RANGE, "", "origin of the system"),
        Parameter::number("x", 2.0, RANGE, "", "the point"),
        Parameter::number("y", 3.0, RANGE, "", "the point"),
        Parameter::number("z", 5.0, RANGE, "", "the point"),
    ],
    run: Run::Alone(run),
};

fn run(values: &Values) -> Result<Report, Error> {
    let vectors = [["ux", "uy", "uz"], ["vx", "vy", "vz"], ["wx", "wy", "wz"]];
    let [u, v, w] = vectors.map(|names| vector3(values, names));
    let (c, p) = (vector3(values, ["cx", "cy", "cz"]), vector3(values, ["x", "y", "z"]));
    let none = || Error::Impossible("the three vectors lie in a plane: they are no basis of space".into());
    let to_basis = Transform::to_basis(c, [u, v, w]).ok_or_else(none)?;
    let mut report = Report::default();
    let hand = handedness(u, v, w).ok_or_else(none)?;
    report.fact("handedness", if hand == Handedness::Right { "right-handed" } else { "left-handed" });
    report.quantity("determinant", determinant(u, v, w), "");
    for (name, a, b) in [("first and second", u, v), ("second and third", v, w), ("third and first", w, u)] {
        report.quantity(format!("angle of the {name} vector"), angle_between(a, b).to_degrees(), "°");
    }
    tell3(&mut report, "coordinates of the point", to_basis.point(p));
    tell_matrix(&mut report, DMat3::from_mat4(to_basis.matrix));
    // Each vector less its parts along those before it.
    let e1 = u.try_normalize().ok_or_else(none)?;
    let e2 = decompose(v, e1).and_then(|(_, rest)| rest.try_normalize()).ok_or_else(none)?;
    let e3 = decompose(w, e1)
        .and_then(|(_, rest)| decompose(rest, e2))
        .and_then(|(_, rest)| rest.try_normalize())
        .ok_or_else(none)?;
    let orthonormal = [("first", e1), ("second", e2), ("third", e3)];
    for (name, e) in orthonormal {
        tell3(&mut report, &format!("orthonormal basis, {name}"), e);
        if let Some(along) = signed_projection(p - c, e) {
            report.quantity(format!("coordinate of the point along it, {name}"), along, "");
        }
    }
    let size = [u, v, w, p - c].iter().map(|a| a.length()).fold(0.0, f64::max);
    let mut chart = drawing::view("a basis", size);
    for (name, a, e) in [("first", u, e1), ("second", v, e2), ("third", w, e3)] {
        chart = chart.with(drawing::curve(name, [c, c + a]));
        chart = chart.with(drawing::curve("", [c, c + e * size * 0.3]).drawn(Marker::Dashed));
    }
    let steps = to_basis.point(p);
    let way = [c, c + u * steps.x, c + u * steps.x + v * steps.y, p];
    chart = chart
        .with(drawing::curve("the way to the point", way).colored([0x88, 0x88, 0x88]))
        .with(drawing::curve("the point", [p]).drawn(Marker::Dots).colored([0, 0, 0]));
    report.chart = Some(chart);
    Ok(report)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::run_with;

    /// M2, M21: by hand: (2, 3, 5) = 0·(1, 1, 0) + 2·(1, 0, 1) + 3·(0, 1, 1), a left-handed basis of the determinant −2
    /// with angles of 60°; Gram and Schmidt give (1, 1, 0)/√2, (1, −1, 2)/√6, (−1, 1, 1)/√3.
    #[test]
    fn coordinates_by_hand() {
        let r = run_with(&EXPERIMENT, &[]).unwrap();
        assert_eq!(r.facts[0].text, "left-handed");
        for (name, exact) in [
            ("determinant", -2.0),
            ("angle of the third and first vector", 60.0),
            ("coordinates of the point, x", 0.0),
            ("coordinates of the point, y", 2.0),
            ("coordinates of the point, z", 3.0),
            ("orthonormal basis, second, z", 2.0 / 6f64.sqrt()),
            ("orthonormal basis, third, x", -1.0 / 3f64.sqrt()),
            ("coordinate of the point along it, third", 6.0 / 3f64.sqrt()),
        ] {
            assert!((r.value(name) - exact).abs() < 1e-12, "{name} {}", r.value(name));
        }
        let origin = [("cx", "2"), ("cy", "3"), ("cz", "5")];
        let r = run_with(&EXPERIMENT, &origin).unwrap();
        assert!(["x", "y", "z"].iter().all(|a| r.value(&format!("coordinates of the point, {a}")).abs() < 1e-12));
        assert!(run_with(&EXPERIMENT, &[("wx", "2"), ("wz", "1")]).is_err());
    }
}
