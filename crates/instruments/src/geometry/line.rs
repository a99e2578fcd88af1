//! Lines of the plane in all their forms (point and normal, implicit, Hesse's, slope, parametric), and of space.
//!
//! `[a, b, c]` of `a x + b y + c = 0` are the cross product of two homogeneous points; the cross product of two lines
//! is their common point, ideal where they are parallel.

use super::{RANGE, tell2, vector2};
use crate::laboratory::{Axis, Chart, Error, Experiment, Marker, Parameter, Report, Run, Series, Values};
use glam::DVec2;
use steradian_math::geometry::{
    Point3,
    conic::Segment,
    line::{Line2, Line3, collinearity},
};

pub const EXPERIMENT: Experiment = Experiment {
    name: "line",
    doc: "a line of the plane in all its forms, the distance of a point, and where it meets another line",
    source: "Coxeter, Introduction to Geometry, §8 and §14",
    parameters: &[
        Parameter::choice(
            "from",
            &["points", "normal", "direction", "slope"],
            "p and q, or p with q as a vector, or p",
        ),
        Parameter::number("px", 0.0, RANGE, "", "point p of the line"),
        Parameter::number("py", 3.0, RANGE, "", "point p of the line; the intercept, for from=slope"),
        Parameter::number("qx", 4.0, RANGE, "", "point q, or the normal or direction"),
        Parameter::number("qy", 0.0, RANGE, "", "point q, or the normal or direction; the slope, for from=slope"),
        Parameter::number("x", 0.0, RANGE, "", "point whose distance is told"),
        Parameter::number("y", 0.0, RANGE, "", "point whose distance is told"),
        Parameter::number("a", 1.0, RANGE, "", "the other line, a x + b y + c = 0"),
        Parameter::number("b", -1.0, RANGE, "", "the other line"),
        Parameter::number("c", 0.0, RANGE, "", "the other line"),
    ],
    run: Run::Alone(run),
};

fn impossible(why: &str) -> Error {
    Error::Impossible(why.to_owned())
}

fn run(values: &Values) -> Result<Report, Error> {
    let [p, q, x] = [["px", "py"], ["qx", "qy"], ["x", "y"]].map(|names| vector2(values, names));
    let line = match values.choice("from") {
        "normal" => Line2::from_point_normal(p, q),
        "direction" => Line2::from_point_direction(p, q),
        "slope" => Line2::from_slope(q.y, p.y),
        _ => Line2::through(p, q),
    }
    .ok_or_else(|| impossible("p and q are the same point, or the vector is zero: they name no line"))?;
    let hesse = line.hesse().ok_or_else(|| impossible("the line has no normal: its coordinates are too small"))?;
    let (foot, direction) = hesse.parametric().ok_or_else(|| impossible("the line lies at infinity"))?;
    let mut report = Report::default();
    for (name, value) in ["a", "b", "c"].into_iter().zip(line.coordinates.to_array()) {
        report.quantity(format!("implicit, {name}"), value + 0.0, "");
    }
    for (name, value) in ["a", "b", "c"].into_iter().zip(hesse.coordinates.to_array()) {
        report.quantity(format!("Hesse's, {name}"), value + 0.0, "");
    }
    match line.slope_intercept() {
        Some((slope, intercept)) => {
            report.quantity("slope", slope + 0.0, "");
            report.quantity("intercept", intercept + 0.0, "");
        }
        None => report.fact("slope", "none: the line is vertical"),
    }
    tell2(&mut report, "point nearest to the origin", foot);
    tell2(&mut report, "direction", direction);
    report.quantity("signed distance of the point", hesse.value(x), "");
    if values.choice("from") == "points" {
        report.quantity("its distance from the segment p q", Segment { a: p, b: q }.distance(x), "");
        report.quantity("twice the area of the triangle x p q", collinearity(x, p, q), "");
    }
    let space = |v: DVec2| Point3::from_vector(v.extend(0.0));
    if let Some(line) = Line3::new(space(foot), direction.extend(0.0)) {
        let t = line.nearest(space(x));
        report.quantity("parameter of the nearest point", t, "");
        tell2(&mut report, "nearest point", line.at(t).to_vector().truncate());
    }
    let other = Line2::new(["a", "b", "c"].map(|n| values.number(n)).into())
        .ok_or_else(|| impossible("'a', 'b' and 'c' are all zero: they name no line"))?;
    match line.meet(&other) {
        None => report.fact("the other line", "the same line"),
        Some(m) if m.z == 0.0 && other.hesse().is_none() => report.fact("the other line", "the one at infinity"),
        Some(m) if m.z == 0.0 => report.fact("the other line", "parallel: they meet at infinity"),
        Some(m) => {
            let at = m.truncate() / m.z;
            if at.is_finite() {
                tell2(&mut report, "meets the other line", at);
            }
        }
    }
    let reach = [p, x, foot].iter().fold(1.0, |m: f64, v| m.max(v.distance(foot))) * 1.2;
    let ends = |l: &Line2| l.parametric().map(|(f, d)| [f - reach * d, f + reach * d].map(|v| (v.x, v.y)).to_vec());
    let nearest = x - hesse.value(x) * hesse.coordinates.truncate();
    let mut chart = Chart::new("a line", Axis::linear("x"), Axis::linear("y"));
    chart.is_isometric = true;
    chart = chart.with(Series::line("the line", ends(&hesse).unwrap_or_default()));
    if let Some(points) = other.hesse().and_then(|h| ends(&h)) {
        chart = chart.with(Series::line("the other line", points));
    }
    chart = chart
        .with(Series::line("distance of the point", vec![(x.x, x.y), (nearest.x, nearest.y)]).drawn(Marker::Dashed))
        .with(Series::line("the point", vec![(x.x, x.y)]).drawn(Marker::Dots));
    report.chart = Some(chart);
    Ok(report)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::run_with;

    /// M9: the line through (0, 3) and (4, 0) is 3x + 4y = 12: distance 12/5 from the origin, slope −3/4, nearest point
    /// (36/25, 48/25), and it meets x = y at 12/7.
    #[test]
    fn all_forms_by_hand() {
        for given in [
            &[][..],
            &[("from", "normal"), ("qx", "3"), ("qy", "4")],
            &[("from", "direction"), ("qx", "4"), ("qy", "-3")],
            &[("from", "slope"), ("qy", "-0.75")],
        ] {
            let r = run_with(&EXPERIMENT, given).unwrap();
            let [a, b, c] = ["a", "b", "c"].map(|n| r.value(&format!("implicit, {n}")));
            assert!((b / a - 4.0 / 3.0).abs() < 1e-12 && (c / a + 4.0).abs() < 1e-12, "{given:?}");
            assert!((r.value("signed distance of the point").abs() - 2.4).abs() < 1e-12);
            assert!((r.value("slope") + 0.75).abs() < 1e-12 && (r.value("intercept") - 3.0).abs() < 1e-12);
            for (name, exact) in
                [("nearest point, x", 1.44), ("nearest point, y", 1.92), ("meets the other line, x", 12.0 / 7.0)]
            {
                assert!((r.value(name) - exact).abs() < 1e-12, "{name}");
            }
        }
        let beyond = run_with(&EXPERIMENT, &[("x", "8"), ("y", "3")]).unwrap();
        assert!((beyond.value("its distance from the segment p q") - 5.0).abs() < 1e-12);
        let area = run_with(&EXPERIMENT, &[]).unwrap().value("twice the area of the triangle x p q");
        assert!((area.abs() - 12.0).abs() < 1e-12);
    }

    #[test]
    fn what_has_no_exception_is_told() {
        let facts = |given: &[(&str, &str)]| run_with(&EXPERIMENT, given).unwrap().facts;
        assert!(facts(&[("a", "3"), ("b", "4")])[0].text.contains("parallel"));
        assert!(facts(&[("a", "3"), ("b", "4"), ("c", "-12")])[0].text.contains("the same"));
        assert!(facts(&[("a", "0"), ("b", "0"), ("c", "1")])[0].text.contains("infinity"));
        assert!(facts(&[("qx", "0")])[0].text.contains("vertical"));
        assert!(run_with(&EXPERIMENT, &[("qx", "0"), ("qy", "3")]).is_err());
    }
}
