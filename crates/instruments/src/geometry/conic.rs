//! Conic sections: what a curve of second order is, from its coefficients or from focus, directrix and eccentricity.
//!
//! `A x² + B xy + C y² + D x + E y + F = 0` has the invariants `δ = AC − B²/4` and `Δ`, the determinant of its
//! symmetric matrix: `Δ = 0` for pairs of lines and single points; else `δ > 0` is an ellipse, `δ < 0` a hyperbola, `δ
//! = 0` a parabola (Bronshtein et al., *Handbook of Mathematics*, §3.5.2.11). A focus `f`, a directrix `⟨n, x⟩ = d` and
//! an eccentricity `e` give `|x − f|² = e² (⟨n, x⟩ − d)²`.

use super::{RANGE, tell2, vector2};
use crate::laboratory::{Axis, Chart, Error, Experiment, Marker, Parameter, Report, Run, Series, Values};
use glam::{DMat3, DVec2, DVec3};
use std::f64::consts::TAU;
use steradian_math::geometry::{
    conic::{Ellipse, Parabola},
    line::Line2,
};

pub const EXPERIMENT: Experiment = Experiment {
    name: "conic",
    doc: "a curve of second order: kind, centre, axes, eccentricity, foci, directrices",
    source: "Bronshtein et al., Handbook of Mathematics, §3.5.2.11",
    parameters: &[
        Parameter::choice("from", &["coefficients", "focus"], "A to F, or focus, directrix and eccentricity"),
        Parameter::number("A", 5.0, RANGE, "", "coefficient of x²"),
        Parameter::number("B", 4.0, RANGE, "", "coefficient of xy"),
        Parameter::number("C", 8.0, RANGE, "", "coefficient of y²"),
        Parameter::number("D", -6.0, RANGE, "", "coefficient of x"),
        Parameter::number("E", 12.0, RANGE, "", "coefficient of y"),
        Parameter::number("F", -27.0, RANGE, "", "constant coefficient"),
        Parameter::number("fx", 1.0, RANGE, "", "focus"),
        Parameter::number("fy", 0.0, RANGE, "", "focus"),
        Parameter::number("angle", 0.0, (-360.0, 360.0), "°", "direction of the normal n of the directrix"),
        Parameter::number("distance", -1.0, RANGE, "", "d of the directrix ⟨n, x⟩ = d"),
        Parameter::number("eccentricity", 1.0, (0.0, 1e3), "", "of the conic"),
        Parameter::number("x", 0.0, RANGE, "", "point whose side is told"),
        Parameter::number("y", 0.0, RANGE, "", "point whose side is told"),
    ],
    run: Run::Alone(run),
};

/// A curve of second order in its own axes.
#[derive(Debug)]
enum Conic {
    /// Also a circle.
    Ellipse(Ellipse),
    /// Centre, transverse axis (unit), and the semi-axes along it and across.
    Hyperbola(DVec2, DVec2, DVec2),
    /// In axes of which the second is given (unit); the first is a quarter turn before it.
    Parabola(Parabola, DVec2),
    /// One, two that meet, or two that are parallel.
    Lines(Vec<Line2>),
    Point(DVec2),
    Nothing,
}

/// Sum of terms, zero where it is within rounding of it.
fn sum(terms: &[f64]) -> f64 {
    let (sum, size) = terms.iter().fold((0.0, 0.0), |(s, m), t| (s + t, m + t.abs()));
    if sum.abs() <= 1e-12 * size { 0.0 } else { sum }
}

/// Conic section of `A x² + B xy + C y² + D x + E y + F = 0`; `None` where all coefficients of variables are zero.
fn classify(coefficients: [f64; 6]) -> Option<Conic> {
    let size = coefficients[..5].iter().fold(0.0, |m: f64, c| m.max(c.abs()));
    if size == 0.0 {
        return None;
    }
    let [a, b, c, d, e, f] = coefficients.map(|x| x / size);
    if [a, b, c] == [0.0; 3] {
        return Line2::new(DVec3::new(d, e, f)).map(|l| Conic::Lines(vec![l]));
    }
    let delta = sum(&[a * c, -0.25 * b * b]);
    let determinant = sum(&[a * c * f, 0.25 * b * e * d, -0.25 * c * d * d, -0.25 * a * e * e, -0.25 * b * b * f]);
    // The axes, and the coefficients of the squares along them.
    let axis = DVec2::from_angle(0.5 * b.atan2(a - c));
    let half = 0.5 * (a - c).hypot(b);
    let lambda = [0.5 * (a + c) + half, 0.5 * (a + c) - half];
    if delta == 0.0 {
        let (x, l) = if lambda[0].abs() >= lambda[1].abs() { (axis, lambda[0]) } else { (axis.perp(), lambda[1]) };
        return Some(parabolic(x, l, DVec2::new(d, e), f, determinant == 0.0));
    }
    let center = DVec2::new(0.25 * b * e - 0.5 * c * d, 0.25 * b * d - 0.5 * a * e) / delta;
    if determinant == 0.0 {
        if delta > 0.0 {
            return Some(Conic::Point(center));
        }
        let (along, across) = (axis * lambda[1].abs().sqrt(), axis.perp() * lambda[0].abs().sqrt());
        let lines = [along + across, along - across].map(|v| Line2::from_point_direction(center, v));
        return Some(Conic::Lines(lines.into_iter().flatten().collect()));
    }
    // λ₁ x² + λ₂ y² = −Δ/δ in the axes.
    let squares = lambda.map(|l| -determinant / (delta * l));
    Some(match squares.map(|s| s > 0.0) {
        [true, true] => {
            let radii = squares.map(f64::sqrt);
            if (radii[0] - radii[1]).abs() <= 1e-12 * radii[0] {
                return Ellipse::circle(center, radii[0]).map(Conic::Ellipse);
            }
            let (axis, [long, short]) =
                if radii[0] > radii[1] { (axis, radii) } else { (axis.perp(), [radii[1], radii[0]]) };
            return Ellipse::new(center, axis, DVec2::new(long, short)).map(Conic::Ellipse);
        }
        [true, false] => Conic::Hyperbola(center, axis, DVec2::new(squares[0].sqrt(), (-squares[1]).sqrt())),
        [false, true] => Conic::Hyperbola(center, axis.perp(), DVec2::new(squares[1].sqrt(), (-squares[0]).sqrt())),
        [false, false] => Conic::Nothing,
    })
}

/// `λ x² + ⟨linear, p⟩ + f = 0` with `x` along a unit vector: a parabola, or parallel lines.
fn parabolic(x: DVec2, lambda: f64, linear: DVec2, f: f64, is_degenerate: bool) -> Conic {
    let y = x.perp();
    let (d, e) = (linear.dot(x), linear.dot(y));
    let apex_x = -0.5 * d / lambda;
    if is_degenerate || e == 0.0 {
        let square = sum(&[d * d / (4.0 * lambda * lambda), -f / lambda]);
        if square < 0.0 {
            return Conic::Nothing;
        }
        let root = square.sqrt();
        let at: &[f64] = if root == 0.0 { &[0.0] } else { &[-root, root] };
        return Conic::Lines(at.iter().filter_map(|r| Line2::new(x.extend(-(apex_x + r)))).collect());
    }
    let (apex_y, focal) = ((0.25 * d * d / lambda - f) / e, -0.25 * e / lambda);
    // Turned so that it opens along its axis.
    let s = focal.signum();
    Parabola::new(s * DVec2::new(apex_x, apex_y), focal.abs()).map_or(Conic::Nothing, |p| Conic::Parabola(p, s * y))
}

fn coefficients(values: &Values) -> [f64; 6] {
    if values.choice("from") == "coefficients" {
        return ["A", "B", "C", "D", "E", "F"].map(|name| values.number(name));
    }
    let (f, n) = (vector2(values, ["fx", "fy"]), DVec2::from_angle(values.number("angle").to_radians()));
    let (d, e2) = (values.number("distance"), values.number("eccentricity").powi(2));
    let [dx, dy] = (-2.0 * f + 2.0 * e2 * d * n).to_array();
    [1.0 - e2 * n.x * n.x, -2.0 * e2 * n.x * n.y, 1.0 - e2 * n.y * n.y, dx, dy, f.length_squared() - e2 * d * d]
}

/// A point from coordinates in axes of which the second is given.
fn from_axes(y: DVec2, p: DVec2) -> DVec2 {
    -y.perp() * p.x + y * p.y
}

fn run(values: &Values) -> Result<Report, Error> {
    let given = coefficients(values);
    let conic = classify(given).ok_or_else(|| {
        Error::Impossible(
            "the coefficients 'A' to 'E' are all zero, or too far apart in size: there is no curve".into(),
        )
    })?;
    let mut report = Report::default();
    for (name, value) in ["A", "B", "C", "D", "E", "F"].into_iter().zip(given) {
        report.quantity(name, value + 0.0, "");
    }
    let mut chart = Chart::new("a curve of second order", Axis::linear("x"), Axis::linear("y"));
    chart.is_isometric = true;
    let dots = |name: &str, points: &[DVec2]| {
        Series::line(name, points.iter().map(|p| (p.x, p.y)).collect()).drawn(Marker::Dots)
    };
    // Foci, directrices and the curve, in the window around a centre.
    let (curves, marks, center, reach) = describe(&conic, &mut report);
    let x = vector2(values, ["x", "y"]);
    let [a, b, c, d, e, f] = given;
    let form = DMat3::from_cols(
        DVec3::new(a, 0.5 * b, 0.5 * d),
        DVec3::new(0.5 * b, c, 0.5 * e),
        DVec3::new(0.5 * d, 0.5 * e, f),
    );
    report.quantity("form at the point", x.extend(1.0).dot(form * x.extend(1.0)), "");
    let span = |c: f64| (c - reach, c + reach);
    (chart.x.range, chart.y.range) = (Some(span(center.x)), Some(span(center.y)));
    for (k, points) in curves.iter().enumerate() {
        let name = if k == 0 { "the curve" } else { "" };
        let clipped = points
            .iter()
            .map(|p| if (*p - center).abs().max_element() <= reach { (p.x, p.y) } else { (f64::NAN, 0.0) });
        chart = chart.with(Series::line(name, clipped.collect()).colored([0x1f, 0x5f, 0xa8]));
    }
    if !marks.is_empty() {
        chart = chart.with(dots("foci, or the points", &marks));
    }
    report.chart = Some(chart.with(dots("the point whose side is told", &[x])));
    Ok(report)
}

/// Tells what is known of the curve; its branches, its foci, and the middle and half width of a view of it.
fn describe(conic: &Conic, report: &mut Report) -> (Vec<Vec<DVec2>>, Vec<DVec2>, DVec2, f64) {
    const POINTS: u32 = 240;
    let steps = || (0..=POINTS).map(|k| f64::from(k) / f64::from(POINTS));
    match conic {
        Conic::Ellipse(e) => {
            let (long, short) = (e.radii.x, e.radii.y);
            let eccentricity = ((long - short) * (long + short)).sqrt() / long;
            report.fact("kind", if long == short { "circle" } else { "ellipse" });
            central(report, e.center, e.axis, e.radii, eccentricity);
            report.quantity("area", e.area(), "");
            if let Some([low, high]) = e.explicit(e.center.x) {
                report.quantity("y below the centre", low, "");
                report.quantity("y above the centre", high, "");
            }
            let foci = [-1.0, 1.0].map(|s| e.center + e.axis * (s * long * eccentricity)).to_vec();
            (vec![steps().map(|t| e.at(TAU * t)).collect()], foci, e.center, 1.3 * long)
        }
        Conic::Hyperbola(center, axis, radii) => {
            let eccentricity = radii.length() / radii.x;
            report.fact(
                "kind",
                if (radii.x - radii.y).abs() <= 1e-12 * radii.x { "rectangular hyperbola" } else { "hyperbola" },
            );
            central(report, *center, *axis, *radii, eccentricity);
            report.quantity("angle between the asymptotes", 2.0 * radii.y.atan2(radii.x).to_degrees(), "°");
            let branch = |side: f64| {
                let at = move |t: f64| *axis * (side * radii.x * t.cosh()) + axis.perp() * (radii.y * t.sinh());
                steps().map(|t| *center + at(8.0 * t - 4.0)).collect::<Vec<_>>()
            };
            let foci = [-1.0, 1.0].map(|s| *center + *axis * (s * radii.length())).to_vec();
            (vec![branch(-1.0), branch(1.0)], foci, *center, 3.0 * radii.length())
        }
        Conic::Parabola(p, y) => {
            report.fact("kind", "parabola");
            tell2(report, "apex", from_axes(*y, p.apex));
            tell2(report, "direction it opens in", *y);
            let focus = from_axes(*y, p.focus());
            tell2(report, "focus", focus);
            report.quantity("eccentricity", 1.0, "");
            report.quantity("distance of the focus from the apex", p.focal_length, "");
            report.quantity("distance of the focus from the directrix", 2.0 * p.focal_length, "");
            let at = |t: f64| from_axes(*y, p.at(8.0 * p.focal_length * (2.0 * t - 1.0)));
            (vec![steps().map(at).collect()], vec![focus], focus, 5.0 * p.focal_length)
        }
        Conic::Lines(lines) => {
            let meet = lines.first().zip(lines.get(1)).and_then(|(a, b)| a.meet(b)).filter(|m| m.z.abs() > 1e-12);
            report.fact(
                "kind",
                match (lines.len(), meet) {
                    (1, _) => "one line",
                    (_, Some(_)) => "two lines that meet",
                    _ => "two parallel lines",
                },
            );
            let mut curves = Vec::new();
            let mut center = meet.map(|m| m.truncate() / m.z);
            for (k, line) in lines.iter().filter_map(Line2::hesse).enumerate() {
                for (name, value) in ["a", "b", "c"].into_iter().zip(line.coordinates.to_array()) {
                    report.quantity(format!("line {}, {name}", k + 1), value + 0.0, "");
                }
                let Some((foot, direction)) = line.parametric() else { continue };
                let middle = *center.get_or_insert(foot);
                let foot = middle - line.value(middle) * line.coordinates.truncate();
                curves.push(vec![foot - 30.0 * direction, foot + 30.0 * direction]);
            }
            let center = center.unwrap_or_default();
            let apart = lines.iter().filter_map(Line2::hesse).map(|l| l.value(center).abs()).fold(1.0, f64::max);
            let cut = |c: &Vec<DVec2>| (0..=240).map(|k| c[0].lerp(c[1], f64::from(k) / 240.0)).collect();
            (curves.iter().map(cut).collect(), Vec::new(), center, 2.0 * apart)
        }
        Conic::Point(p) => {
            report.fact("kind", "a single point");
            tell2(report, "point", *p);
            (Vec::new(), vec![*p], *p, 1.0)
        }
        Conic::Nothing => {
            report.fact("kind", "no real point");
            (Vec::new(), Vec::new(), DVec2::ZERO, 1.0)
        }
    }
}

/// Report of the quantities common to ellipses and hyperbolas.
fn central(report: &mut Report, center: DVec2, axis: DVec2, radii: DVec2, eccentricity: f64) {
    tell2(report, "centre", center);
    report.quantity("first semi-axis", radii.x, "");
    report.quantity("second semi-axis", radii.y, "");
    report.quantity("direction of the first axis", (axis.y.atan2(axis.x)).to_degrees().rem_euclid(180.0), "°");
    report.quantity("eccentricity", eccentricity, "");
    report.quantity("distance of the foci from the centre", radii.x * eccentricity, "");
    if eccentricity > 0.0 {
        report.quantity("distance of the directrices from the centre", radii.x / eccentricity, "");
    }
    report.quantity("chord through a focus across (latus rectum)", 2.0 * radii.y * radii.y / radii.x, "");
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::run_with;

    fn of(c: [f64; 6]) -> Report {
        let given = ["A", "B", "C", "D", "E", "F"].into_iter().zip(c.map(|x| x.to_string()));
        let given: Vec<_> = given.map(|(name, value)| (name.to_owned(), value)).collect();
        EXPERIMENT.run(&given, None).unwrap()
    }

    /// M11: by hand: 5x² + 4xy + 8y² has the eigenvalues 9 and 4, so 5(x−1)² + 4(x−1)(y+1) + 8(y+1)² = 36 an ellipse
    /// around (1, −1) with the semi-axes 3 along (2, −1) and 2; xy = 2 a rectangular hyperbola with the semi-axis 2.
    #[test]
    fn central_conics_by_hand() {
        let r = of([5.0, 4.0, 8.0, -6.0, 12.0, -27.0]);
        assert_eq!(r.facts[0].text, "ellipse");
        for (name, exact) in [
            ("centre, x", 1.0),
            ("centre, y", -1.0),
            ("first semi-axis", 3.0),
            ("second semi-axis", 2.0),
            ("eccentricity", 5f64.sqrt() / 3.0),
            ("direction of the first axis", 180.0 - 0.5f64.atan().to_degrees()),
            ("area", 6.0 * std::f64::consts::PI),
            ("form at the point", -27.0),
            ("y above the centre", -1.0 + 4.5f64.sqrt()),
        ] {
            assert!((r.value(name) - exact).abs() < 1e-10, "{name} {}", r.value(name));
        }
        let r = of([0.0, 1.0, 0.0, 0.0, 0.0, -2.0]);
        assert_eq!(r.facts[0].text, "rectangular hyperbola");
        assert!((r.value("first semi-axis") - 2.0).abs() < 1e-12);
        assert!((r.value("eccentricity") - 2f64.sqrt()).abs() < 1e-12);
        assert!((r.value("direction of the first axis") - 45.0).abs() < 1e-12);
        assert!((r.value("angle between the asymptotes") - 90.0).abs() < 1e-12);
    }

    /// Each degenerate form, and parabolas in every direction.
    #[test]
    fn kinds_are_told() {
        for (c, kind) in [
            ([1.0, 0.0, 1.0, 0.0, 0.0, -4.0], "circle"),
            ([1.0, 0.0, 1.0, 0.0, 0.0, 4.0], "no real point"),
            ([1.0, 0.0, 2.0, -2.0, 0.0, 1.0], "a single point"),
            ([1.0, 0.0, -1.0, 0.0, 0.0, 0.0], "two lines that meet"),
            ([1.0, 2.0, 1.0, 0.0, 0.0, -1.0], "two parallel lines"),
            ([1.0, 2.0, 1.0, 2.0, 2.0, 1.0], "one line"),
            ([1.0, 0.0, 0.0, 0.0, 0.0, 1.0], "no real point"),
            ([0.0, 0.0, 0.0, 1.0, 2.0, 3.0], "one line"),
            ([4.0, 0.0, -9.0, 0.0, 0.0, -36.0], "hyperbola"),
            ([-4.0, 0.0, 9.0, 0.0, 0.0, -36.0], "hyperbola"),
            ([0.0, 0.0, 1.0, -8.0, 0.0, 0.0], "parabola"),
            ([1.0, -2.0, 1.0, -8.0, -8.0, 0.0], "parabola"),
        ] {
            assert_eq!(of(c).facts[0].text, kind, "{c:?}");
        }
        // y² = 8x opens along x, with its focus at (2, 0).
        let r = of([0.0, 0.0, 1.0, -8.0, 0.0, 0.0]);
        assert!((r.value("focus, x") - 2.0).abs() < 1e-12 && (r.value("direction it opens in, x") - 1.0).abs() < 1e-12);
        assert!(run_with(&EXPERIMENT, &["A", "B", "C", "D", "E"].map(|n| (n, "0"))).is_err());
    }

    /// Conics of a given focus, directrix and eccentricity have these: e = 1/2 with the focus 3 from the directrix is
    /// an ellipse with a = ep/(1 − e²) = 2 and b = √3; e = 2 a hyperbola with a = 2 as well.
    #[test]
    fn focus_and_directrix() {
        for angle in [0.0f64, 30.0, 100.0] {
            let n = DVec2::from_angle(angle.to_radians());
            let (fx, fy) = ((n.x * 2.0).to_string(), (n.y * 2.0).to_string());
            let turned = angle.to_string();
            let with = |e: &str| {
                let given = [("from", "focus"), ("fx", &*fx), ("fy", &*fy), ("angle", &*turned), ("eccentricity", e)];
                run_with(&EXPERIMENT, &given).unwrap()
            };
            for (e, kind, a, b) in [("0.5", "ellipse", 2.0, 3f64.sqrt()), ("2", "hyperbola", 2.0, 12f64.sqrt())] {
                let r = with(e);
                assert_eq!(r.facts[0].text, kind);
                assert!(
                    (r.value("first semi-axis") - a).abs() < 1e-9 && (r.value("second semi-axis") - b).abs() < 1e-9
                );
                assert!((r.value("eccentricity") - e.parse::<f64>().unwrap()).abs() < 1e-9);
            }
            let r = with("1");
            assert_eq!(r.facts[0].text, "parabola");
            assert!((r.value("focus, x") - 2.0 * n.x).abs() < 1e-9 && (r.value("focus, y") - 2.0 * n.y).abs() < 1e-9);
            assert!((r.value("distance of the focus from the directrix") - 3.0).abs() < 1e-9);
        }
    }
}
