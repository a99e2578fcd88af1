//! Homogeneous coordinates: points, ideal points (directions), and their images in perspective.
//!
//! `[x, y, z, w]` and its multiples are one point, `(x/w, y/w, z/w)`, or with `w = 0` the common point at infinity of
//! all lines of one direction. The central projection from the origin to the plane `z = d` is the matrix with the rows
//! `x, y, z` and `z/d`: parallel lines, which share their ideal point, meet in its image, the vanishing point.

use super::{RANGE, tell2, tell3, vector3};
use crate::laboratory::{Axis, Chart, Error, Experiment, Marker, Parameter, Report, Run, Series, Values};
use glam::{DMat4, DVec3, DVec4};
use steradian_math::geometry::{Point3, homogeneous::HomogeneousPoint};

pub const EXPERIMENT: Experiment = Experiment {
    name: "homogeneous",
    doc: "homogeneous coordinates, ideal points, and the image of parallel lines in perspective",
    source: "Coxeter, Introduction to Geometry, §14; Hartley, Zisserman, Multiple View Geometry, §2.2 and §6.1",
    parameters: &[
        Parameter::number("x", 1.0, RANGE, "", "coordinate of the point"),
        Parameter::number("y", 2.0, RANGE, "", "coordinate of the point"),
        Parameter::number("z", 4.0, RANGE, "", "coordinate of the point"),
        Parameter::number("w", 0.0, RANGE, "", "coordinate of the point; 0 for a direction"),
        Parameter::number("x2", 2.0, RANGE, "", "coordinate of another point"),
        Parameter::number("y2", 4.0, RANGE, "", "coordinate of another point"),
        Parameter::number("z2", 8.0, RANGE, "", "coordinate of another point"),
        Parameter::number("w2", 0.0, RANGE, "", "coordinate of another point"),
        Parameter::number("d", 1.0, (1e-3, 1e3), "", "distance of the image plane from the eye"),
    ],
    run: Run::Alone(run),
};

fn run(values: &Values) -> Result<Report, Error> {
    let point = |names: [&str; 3], w: &str| {
        HomogeneousPoint::new(vector3(values, names).extend(values.number(w)))
            .ok_or_else(|| Error::Impossible("four zeros are the coordinates of no point".into()))
    };
    let (p, q) = (point(["x", "y", "z"], "w")?, point(["x2", "y2", "z2"], "w2")?);
    let d = values.number("d");
    let projection = DMat4::from_cols(DVec4::X, DVec4::Y, DVec4::new(0.0, 0.0, 1.0, 1.0 / d), DVec4::ZERO);
    let mut report = Report::default();
    report.fact("the point", if p.is_ideal() { "ideal: a direction" } else { "ordinary" });
    if let Some(ordinary) = p.to_point() {
        tell3(&mut report, "Cartesian", ordinary.to_vector());
    } else {
        tell3(&mut report, "direction", p.coordinates().truncate().normalize_or_zero());
    }
    report.fact("the other point", if p.is_same(&q) { "the same" } else { "another" });
    let image = p.transformed(&projection);
    match &image {
        None => report.fact("its image", "none: it is the eye"),
        Some(image) => match image.to_point() {
            Some(at) => tell2(&mut report, "its image", at.to_vector().truncate()),
            None => report.fact("its image", "at infinity: it lies in the plane of the eye"),
        },
    }
    if let Some(image) = image {
        for (name, c) in ["x", "y", "z", "w"].into_iter().zip(image.coordinates().to_array()) {
            report.quantity(format!("coordinates of its image, {name}"), c + 0.0, "");
        }
    }
    // Rails in the direction of (x, y, z), from before the eye on.
    let along = vector3(values, ["x", "y", "z"]);
    let vanishing = HomogeneousPoint::ideal(along).and_then(|p| p.transformed(&projection)).and_then(|p| p.to_point());
    let mut chart = Chart::new("parallel lines in perspective", Axis::linear("x"), Axis::linear("y"));
    chart =
        Chart { x: chart.x.over(-2.0 * d, 2.0 * d), y: chart.y.over(-2.0 * d, 2.0 * d), is_isometric: true, ..chart };
    for (x, y) in [(-1.0, -1.0), (-0.5, -1.0), (0.0, -1.0), (0.5, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)] {
        let start = Point3::new(x * d, y * d, d);
        let unit = along.try_normalize().unwrap_or(DVec3::Z) * d;
        let image = |k: u32| {
            let p = start + unit * (f64::from(k) / 8.0).exp_m1();
            let p = HomogeneousPoint::from_point(p).filter(|p| p.coordinates().z > 1e-6 * d)?;
            p.transformed(&projection)?.to_point()
        };
        let points: Vec<_> = (0..=80).map_while(image).map(|p| (p.x, p.y)).collect();
        chart = chart.with(Series::line("", points).colored([0x1f, 0x5f, 0xa8]));
    }
    if let Some(v) = vanishing {
        tell2(&mut report, "vanishing point of lines along x, y, z", v.to_vector().truncate());
        chart = chart.with(Series::line("vanishing point", vec![(v.x, v.y)]).drawn(Marker::Dots));
    }
    report.chart = Some(chart);
    Ok(report)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::run_with;

    /// M8: by hand: the direction (1, 2, 4) vanishes at (1/4, 1/2) of the plane z = 1, [1, 2, 4, 2] is (1/2, 1, 2) with
    /// the same image, multiples are the same point, a direction in the image plane has no image at hand.
    #[test]
    fn points_and_directions_by_hand() {
        let ideal = run_with(&EXPERIMENT, &[]).unwrap();
        let ordinary = run_with(&EXPERIMENT, &[("w", "2"), ("w2", "4")]).unwrap();
        for r in [&ideal, &ordinary] {
            assert_eq!((r.value("its image, x"), r.value("its image, y")), (0.25, 0.5));
            assert_eq!(r.facts[1].text, "the same");
        }
        assert!((ideal.value("direction, z") - 4.0 / 21f64.sqrt()).abs() < 1e-12);
        assert_eq!((ordinary.value("Cartesian, x"), ordinary.value("Cartesian, z")), (0.5, 2.0));
        assert_eq!(run_with(&EXPERIMENT, &[("w", "2")]).unwrap().facts[1].text, "another");
        assert!(run_with(&EXPERIMENT, &[("z", "0")]).unwrap().facts[2].text.contains("infinity"));
        let eye = [("x", "0"), ("y", "0"), ("z", "0"), ("w", "1")];
        assert!(run_with(&EXPERIMENT, &eye).unwrap().facts[2].text.contains("the eye"));
        assert!(run_with(&EXPERIMENT, &eye[..3]).is_err());
    }
}
