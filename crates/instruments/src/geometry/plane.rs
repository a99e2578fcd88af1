//! Planes: three points, a point and a normal, or coefficients; implicit, Hesse's and parametric forms.
//!
//! `a x + b y + c z + d = 0`; the coefficients of the plane through three points are the cofactors of the determinant
//! `|x; p; q; r|`.

use super::{RANGE, drawing, tell3, vector3};
use crate::laboratory::{Error, Experiment, Marker, Parameter, Report, Run, Values};
use glam::DVec4;
use steradian_math::geometry::{
    Point3,
    homogeneous::HomogeneousPoint,
    plane::{Plane, coplanarity},
};

pub const EXPERIMENT: Experiment = Experiment {
    name: "plane",
    doc: "a plane in all its forms, the distance of a point, and where three planes meet",
    source: "Coxeter, Introduction to Geometry, §12 and §14",
    parameters: &[
        Parameter::choice(
            "from",
            &["points", "normal", "coefficients"],
            "p, q, r; or p and the normal q; or a, b, c, d",
        ),
        Parameter::number("px", 3.0, RANGE, "", "point p"),
        Parameter::number("py", 0.0, RANGE, "", "point p"),
        Parameter::number("pz", 0.0, RANGE, "", "point p"),
        Parameter::number("qx", 0.0, RANGE, "", "point q, or the normal"),
        Parameter::number("qy", 3.0, RANGE, "", "point q, or the normal"),
        Parameter::number("qz", 0.0, RANGE, "", "point q, or the normal"),
        Parameter::number("rx", 0.0, RANGE, "", "point r"),
        Parameter::number("ry", 0.0, RANGE, "", "point r"),
        Parameter::number("rz", 1.5, RANGE, "", "point r"),
        Parameter::number("a", 1.0, RANGE, "", "coefficient of x"),
        Parameter::number("b", 1.0, RANGE, "", "coefficient of y"),
        Parameter::number("c", 2.0, RANGE, "", "coefficient of z"),
        Parameter::number("d", -3.0, RANGE, "", "constant coefficient"),
        Parameter::number("x", 2.0, RANGE, "", "point whose distance is told, and whose coordinate planes are met"),
        Parameter::number("y", 2.0, RANGE, "", "the same point"),
        Parameter::number("z", 2.5, RANGE, "", "the same point"),
    ],
    run: Run::Alone(run),
};

/// The plane that the parameters say.
fn plane(values: &Values) -> Option<Plane> {
    let [p, q, r] = [["px", "py", "pz"], ["qx", "qy", "qz"], ["rx", "ry", "rz"]].map(|names| vector3(values, names));
    match values.choice("from") {
        "normal" => Plane::from_point_normal(Point3::from_vector(p), q),
        "coefficients" => Plane::new(DVec4::from(["a", "b", "c", "d"].map(|n| values.number(n)))),
        _ => {
            let [p, q, r] = [p, q, r].map(Point3::from_vector);
            Plane::through(p, q, r)
        }
    }
}

fn run(values: &Values) -> Result<Report, Error> {
    let none = "the points lie on one line, or the normal is zero: they name no ordinary plane";
    let plane = plane(values).ok_or_else(|| Error::Impossible(none.into()))?;
    let (hesse, parametric) = (plane.hesse(), plane.parametric());
    let (hesse, (foot, u, v)) = hesse.zip(parametric).ok_or_else(|| Error::Impossible(none.into()))?;
    let x = Point3::from_vector(vector3(values, ["x", "y", "z"]));
    let mut report = Report::default();
    for (form, plane) in [("implicit", &plane), ("Hesse's", &hesse)] {
        for (name, value) in ["a", "b", "c", "d"].into_iter().zip(plane.coordinates.to_array()) {
            report.quantity(format!("{form}, {name}"), value + 0.0, "");
        }
    }
    tell3(&mut report, "parametric, point nearest to the origin", foot.to_vector());
    tell3(&mut report, "parametric, first direction", u);
    tell3(&mut report, "parametric, second direction", v);
    let distance = hesse.value(x);
    let nearest = x - hesse.coordinates.truncate() * distance;
    report.quantity("signed distance of the point", distance, "");
    tell3(&mut report, "nearest point", nearest.to_vector());
    if values.choice("from") == "points" {
        let corners = [["px", "py", "pz"], ["qx", "qy", "qz"], ["rx", "ry", "rz"]];
        let [p, q, r] = corners.map(|names| Point3::from_vector(vector3(values, names)));
        report.quantity("volume of the tetrahedron x p q r", coplanarity(x, p, q, r).abs() / 6.0, "");
        let joined = [p, q, r].map(HomogeneousPoint::from_point);
        if let [Some(p), Some(q), Some(r)] = joined
            && let Some(joined) = Plane::join(&p, &q, &r)
        {
            let on = [p, q, r].iter().filter(|p| joined.contains(p)).count();
            report.quantity("points on the plane of cofactors", on as f64, "");
        }
    }
    // Where the lines through the point along the axes meet the plane: two planes through the point, and this one.
    let through = |axis: usize| Plane::from_point_normal(x, glam::DVec3::AXES[axis]);
    for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
        let (Some(first), Some(second)) = (through((axis + 1) % 3), through((axis + 2) % 3)) else { continue };
        match plane.meet(&first, &second) {
            Some(point) => match point.to_point() {
                Some(p) => report.quantity(format!("{name} on the plane above the point"), p.to_vector()[axis], ""),
                None => report.quantity(format!("{name} on the plane above the point"), f64::INFINITY, ""),
            },
            None => report.fact("axis in the plane", format!("the line through the point along {name}")),
        }
    }
    let size = [x.to_vector().length(), foot.to_vector().length(), 1.0].into_iter().fold(0.0, f64::max);
    let patch = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0)];
    let corner = |(s, t): (f64, f64)| (nearest + (u * s + v * t) * size * 0.7).to_vector();
    let chart = drawing::view("a plane, a point and its foot", size)
        .with(drawing::curve("the plane", patch.map(corner)).drawn(Marker::Area))
        .with(drawing::curve("distance of the point", [x.to_vector(), nearest.to_vector()]).drawn(Marker::Dashed))
        .with(drawing::curve("the point", [x.to_vector()]).drawn(Marker::Dots));
    report.chart = Some(chart);
    Ok(report)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::run_with;

    /// M10: x + y + 2z = 3 by its intercepts, by a point and the normal, and by coefficients: (2, 2, 2.5) is 6/√6 above
    /// it, its foot is (1, 1, 1/2), the line upwards meets it at z = −1/2, and the tetrahedron over the intercepts has
    /// 6/√6 · (area 9√6/4)/3 = 9/2.
    #[test]
    fn all_forms_by_hand() {
        for given in
            [&[][..], &[("from", "normal"), ("qx", "1"), ("qy", "1"), ("qz", "2")], &[("from", "coefficients")]]
        {
            let r = run_with(&EXPERIMENT, given).unwrap();
            assert!((r.value("signed distance of the point") - 6f64.sqrt()).abs() < 1e-12, "{given:?}");
            for (name, exact) in [
                ("nearest point, x", 1.0),
                ("nearest point, z", 0.5),
                ("z on the plane above the point", -0.5),
                ("x on the plane above the point", -4.0),
                ("parametric, point nearest to the origin, z", 1.0),
                ("Hesse's, d", -3.0 / 6f64.sqrt()),
            ] {
                assert!((r.value(name) - exact).abs() < 1e-12, "{given:?} {name}: {}", r.value(name));
            }
        }
        let r = run_with(&EXPERIMENT, &[]).unwrap();
        assert!((r.value("volume of the tetrahedron x p q r") - 4.5).abs() < 1e-12);
        assert_eq!(r.value("points on the plane of cofactors"), 3.0);
    }

    #[test]
    fn parallels_and_what_is_no_plane() {
        let flat = run_with(&EXPERIMENT, &[("from", "coefficients"), ("a", "0")]).unwrap();
        assert_eq!(flat.value("x on the plane above the point"), f64::INFINITY);
        let within = [("from", "coefficients"), ("a", "0"), ("y", "0"), ("z", "1.5")];
        assert!(run_with(&EXPERIMENT, &within).unwrap().facts[0].text.contains("along x"));
        assert!(run_with(&EXPERIMENT, &[("from", "normal"), ("qy", "0")]).is_err());
        let ideal = [("from", "coefficients"), ("a", "0"), ("b", "0"), ("c", "0")];
        assert!(run_with(&EXPERIMENT, &ideal).is_err());
    }
}
