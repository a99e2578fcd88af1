//! Barycentric coordinates: a point as a mean of the corners of a triangle or a tetrahedron, with weights that add up
//! to one, each the ratio of two signed areas or volumes (Möbius 1827). On a segment they are those of a balanced rod:
//! the nearer end has the greater weight.

use super::{RANGE, drawing, tell3, vector3};
use crate::laboratory::{Error, Experiment, Marker, Parameter, Report, Run, Values};
use glam::DVec3;
use steradian_math::geometry::{
    Point3,
    barycentric::{simplex, tetrahedron, triangle_2d, triangle_3d},
};

pub const EXPERIMENT: Experiment = Experiment {
    name: "barycentric",
    doc: "barycentric coordinates of a point in a triangle or a tetrahedron, or on a segment",
    source: "Coxeter, Introduction to Geometry, §13.7",
    parameters: &[
        Parameter::choice(
            "of",
            &["triangle", "plane-triangle", "tetrahedron", "segment"],
            "in space, in the plane of x and y, of four points, or on the line of a and b",
        ),
        Parameter::number("ax", 0.0, RANGE, "", "corner a"),
        Parameter::number("ay", 0.0, RANGE, "", "corner a"),
        Parameter::number("az", 0.0, RANGE, "", "corner a"),
        Parameter::number("bx", 4.0, RANGE, "", "corner b"),
        Parameter::number("by", 0.0, RANGE, "", "corner b"),
        Parameter::number("bz", 0.0, RANGE, "", "corner b"),
        Parameter::number("cx", 0.0, RANGE, "", "corner c"),
        Parameter::number("cy", 4.0, RANGE, "", "corner c"),
        Parameter::number("cz", 0.0, RANGE, "", "corner c"),
        Parameter::number("dx", 0.0, RANGE, "", "corner d"),
        Parameter::number("dy", 0.0, RANGE, "", "corner d"),
        Parameter::number("dz", 4.0, RANGE, "", "corner d"),
        Parameter::number("x", 1.0, RANGE, "", "the point"),
        Parameter::number("y", 2.0, RANGE, "", "the point"),
        Parameter::number("z", 0.5, RANGE, "", "the point"),
    ],
    run: Run::Alone(run),
};

/// Weights of the ends of a segment, for the foot of a point on its line: of `a` that of the part towards `b`. `None`
/// where the ends are one.
fn segment(a: DVec3, b: DVec3, p: DVec3) -> Option<[f64; 2]> {
    let u = (p - a).dot(b - a) / (b - a).length_squared();
    u.is_finite().then_some([1.0 - u, u])
}

fn run(values: &Values) -> Result<Report, Error> {
    let all = [["ax", "ay", "az"], ["bx", "by", "bz"], ["cx", "cy", "cz"], ["dx", "dy", "dz"]];
    let [a, b, c, d] = all.map(|names| vector3(values, names));
    let p = vector3(values, ["x", "y", "z"]);
    let of = values.choice("of");
    let weights = match of {
        "tetrahedron" => tetrahedron([a, b, c, d], p).map(|w| w.to_vec()),
        "plane-triangle" => triangle_2d([a, b, c].map(|v| v.truncate()), p.truncate()).map(|w| w.to_vec()),
        "segment" => segment(a, b, p).map(|w| w.to_vec()),
        _ => triangle_3d([a, b, c], p).map(|w| w.to_vec()),
    }
    .ok_or_else(|| {
        Error::Impossible("the corners lie on one point, line or plane: they have no length, area or volume".into())
    })?;
    let flat = of == "plane-triangle";
    let place = |v: DVec3| if flat { v.with_z(0.0) } else { v };
    let corners: Vec<_> = [a, b, c, d].into_iter().take(weights.len()).map(place).collect();
    let mut report = Report::default();
    for (name, weight) in ["a", "b", "c", "d"].into_iter().zip(&weights) {
        report.quantity(format!("weight of {name}"), weight + 0.0, "");
    }
    let least = weights.iter().copied().fold(f64::INFINITY, f64::min);
    report.fact(
        "the point",
        if least > 0.0 {
            "inside"
        } else if least == 0.0 {
            "on the border"
        } else {
            "outside"
        },
    );
    let terms = |shift: f64| -> Vec<_> {
        weights.iter().zip(&corners).map(|(w, v)| (w - shift, Point3::from_vector(*v))).collect()
    };
    let mean = Point3::combination(&terms(0.0));
    if let Some(mean) = mean {
        tell3(&mut report, "mean of the corners", mean.to_vector());
        report.quantity("distance of the point from it", mean.distance(Point3::from_vector(place(p))), "");
    }
    // Less the weights of the centroid, which leaves a sum of zero: a vector.
    if let Some(from) = Point3::difference(&terms(1.0 / weights.len() as f64)) {
        tell3(&mut report, "vector from the centroid", from);
    }
    // The same by elimination, as in any dimension; it has no answer for a triangle or segment in space.
    let axes = if flat { 2 } else { 3 };
    let (rows, point): (Vec<_>, _) = (corners.iter().map(|v| v.to_array()).collect(), p.to_array());
    let rows: Vec<&[f64]> = rows.iter().map(|r| &r[..axes]).collect();
    if let Some(solved) = simplex(&rows, &point[..axes]) {
        let apart = solved.iter().zip(&weights).map(|(s, w)| (s - w).abs()).fold(0.0, f64::max);
        report.quantity("greatest difference from elimination", apart, "");
    }
    let size = corners.iter().chain([&p]).map(|v| v.length()).fold(1e-3, f64::max);
    let mut chart = drawing::view("barycentric coordinates", size);
    for (i, v) in corners.iter().enumerate() {
        for w in &corners[i + 1..] {
            chart = chart.with(drawing::curve("", [*v, *w]).colored([0x1f, 0x5f, 0xa8]));
        }
        let from = mean.map_or(p, Point3::to_vector);
        chart = chart.with(drawing::curve("", [from, *v]).drawn(Marker::Dashed).colored([0x88, 0x88, 0x88]));
    }
    report.chart = Some(chart.with(drawing::curve("the point", [place(p)]).drawn(Marker::Dots)));
    Ok(report)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::run_with;

    /// M6, M7: by hand: (1, 2) in the triangle of (0, 0), (4, 0), (0, 4) has the weights 1/4, 1/4, 1/2, and (1, 2, 1/2)
    /// in the tetrahedron over it 1/8, 1/4, 1/2, 1/8; the lectures' formula gives another sign (E19).
    #[test]
    fn weights_by_hand() {
        for (of, exact) in [
            ("triangle", &[0.25, 0.25, 0.5][..]),
            ("plane-triangle", &[0.25, 0.25, 0.5]),
            ("tetrahedron", &[0.125, 0.25, 0.5, 0.125]),
        ] {
            let r = run_with(&EXPERIMENT, &[("of", of)]).unwrap();
            for (name, w) in ["a", "b", "c", "d"].into_iter().zip(exact) {
                assert!((r.value(&format!("weight of {name}")) - w).abs() < 1e-12, "{of} {name}");
            }
            let away = if of == "triangle" { 0.5 } else { 0.0 };
            assert!((r.value("distance of the point from it") - away).abs() < 1e-12);
            assert_eq!(r.facts[0].text, "inside");
            if of != "triangle" {
                assert!(r.value("greatest difference from elimination") < 1e-12);
            }
        }
        // E30: on the rod from (0, 0, 0) to (4, 0, 0), x = 1 weighs ¾ of a and ¼ of b, and the end a all of a.
        let rod = |x: &str| run_with(&EXPERIMENT, &[("of", "segment"), ("x", x), ("y", "0"), ("z", "0")]).unwrap();
        assert_eq!(["weight of a", "weight of b"].map(|n| rod("1").value(n)), [0.75, 0.25]);
        assert_eq!(["weight of a", "weight of b"].map(|n| rod("0").value(n)), [1.0, 0.0]);
        assert_eq!((rod("0").facts[0].text.as_str(), rod("5").facts[0].text.as_str()), ("on the border", "outside"));
        assert!(run_with(&EXPERIMENT, &[("of", "segment"), ("bx", "0")]).is_err());
        assert_eq!(run_with(&EXPERIMENT, &[("y", "3.5")]).unwrap().facts[0].text, "outside");
        assert_eq!(run_with(&EXPERIMENT, &[("x", "2")]).unwrap().facts[0].text, "on the border");
        assert!(run_with(&EXPERIMENT, &[("cy", "0")]).is_err());
    }
}
