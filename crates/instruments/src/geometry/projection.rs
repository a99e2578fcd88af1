//! Projections to clip space, and the central one as three maps.
//!
//! The first map makes the frustum square, `x/tan(φₓ/2)` and `y/tan(φᵧ/2)`, and shears it upright where the window is
//! shifted; the second makes the lines through the eye
//! parallel to its axis, `z ↦ −(n + f) − nf/z` with `w = −z`; the third scales the box that this leaves to the cube.
//! Their product is the matrix of OpenGL.

use super::{tell3, vector3};
use crate::laboratory::{Axis, Chart, Error, Experiment, Parameter, Report, Run, Series, Values};
use glam::{DMat4, DVec3};
use steradian_math::geometry::projection::{Depth, View};

pub const EXPERIMENT: Experiment = Experiment {
    name: "projection",
    doc: "a view as a matrix, for each range of depth, and the three steps of the central projection",
    source: "OpenGL 4.6, §13.8; Hughes and others, Computer Graphics: Principles and Practice, §13",
    parameters: &[
        Parameter::choice("kind", &["perspective", "orthographic", "oblique"], "which projection"),
        Parameter::choice("depth", &["-1..1", "0..1", "reversed"], "depths of the near and the far plane"),
        Parameter::number(
            "fov",
            60.0,
            (1.0, 170.0),
            "°",
            "vertical angle of view; of parallel views, of the window at 1",
        ),
        Parameter::number("aspect", 1.5, (1e-2, 1e2), "", "width over height"),
        Parameter::number("shift-x", 0.0, (-10.0, 10.0), "", "of the window, in halves of its width: off-axis views"),
        Parameter::number("shift-y", 0.0, (-10.0, 10.0), "", "of the window, in halves of its height"),
        Parameter::number("near", 1.0, (1e-3, 1e3), "", "distance of the near plane"),
        Parameter::number("far", 4.0, (1e-2, 1e6), "", "distance of the far plane"),
        Parameter::number("angle", 45.0, (0.0, 360.0), "°", "direction of receding lines, for kind=oblique"),
        Parameter::number(
            "foreshortening",
            0.5,
            (0.0, 4.0),
            "",
            "length of receding lines, for kind=oblique: 1 cavalier, ½ cabinet",
        ),
        Parameter::number("x", 0.5, (-1e6, 1e6), "", "the point, in eye space"),
        Parameter::number("y", 0.25, (-1e6, 1e6), "", "the point, in eye space"),
        Parameter::number("z", -2.0, (-1e6, 1e6), "", "the point, in eye space: in front of the eye z is negative"),
    ],
    run: Run::Alone(run),
};

fn run(values: &Values) -> Result<Report, Error> {
    let [near, far, aspect] = ["near", "far", "aspect"].map(|n| values.number(n));
    let impossible = |why: &str| Error::Impossible(why.into());
    let top = (0.5 * values.number("fov").to_radians()).tan();
    let (x, y) = (values.number("shift-x") * aspect * top, values.number("shift-y") * top);
    let view = View::new([x - aspect * top, x + aspect * top, y - top, y + top], near, far)
        .ok_or_else(|| impossible("the near plane ('near') lies before the far one ('far')"))?;
    let depth = match values.choice("depth") {
        "0..1" => Depth::ZeroToOne,
        "reversed" => Depth::Reversed,
        _ => Depth::MinusOneToOne,
    };
    let (sin, cos) = values.number("angle").to_radians().sin_cos();
    let recede = values.number("foreshortening");
    let matrix = match values.choice("kind") {
        "orthographic" => view.orthographic(depth),
        // Points behind the plane z = 0 move by their distance times the length.
        "oblique" => view.oblique(DVec3::new(-cos * recede, -sin * recede, -1.0), depth),
        _ => view.perspective(depth),
    };
    let matrix = matrix.ok_or_else(|| impossible("there is no such projection"))?;
    let p = vector3(values, ["x", "y", "z"]);
    let mut report = Report::default();
    tell4(&mut report, "matrix", &matrix);
    let clip = matrix * p.extend(1.0);
    for (name, c) in ["x", "y", "z", "w"].into_iter().zip(clip.to_array()) {
        report.quantity(format!("the point in clip space, {name}"), c + 0.0, "");
    }
    if clip.w > 0.0 {
        tell3(&mut report, "after division", clip.truncate() / clip.w);
        let (low, high) = (depth.range().0.min(depth.range().1) * clip.w, clip.w);
        let is_seen = clip.x.abs() <= clip.w && clip.y.abs() <= clip.w && (low..=high).contains(&clip.z);
        report.fact("the point", if is_seen { "is seen" } else { "is clipped" });
    } else {
        report.fact("the point", "lies behind the eye: it is clipped before the division");
    }
    for (name, distance) in [("near", near), ("far", far)] {
        let image = matrix * DVec3::new(0.0, 0.0, -distance).extend(1.0);
        report.quantity(format!("depth of the {name} plane"), image.z / image.w + 0.0, "");
    }
    let steps = view.steps().ok_or_else(|| impossible("there is no such projection"))?;
    let is_central = values.choice("kind") == "perspective";
    if is_central {
        let (mut image, mut product) = (p.extend(1.0), DMat4::IDENTITY);
        for (k, step) in steps.iter().enumerate() {
            image = *step * image;
            product = *step * product;
            tell4(&mut report, &format!("step {}", k + 1), step);
            tell3(&mut report, &format!("after step {}", k + 1), image.truncate() / image.w);
        }
        tell4(&mut report, "product of the steps, for -1..1", &product);
    }
    let maps = if is_central {
        let [square, parallel, cube] = steps;
        let names = ["eye space", "1: square frustum", "2: parallel lines", "3: cube"];
        let maps = [DMat4::IDENTITY, square, parallel * square, cube * parallel * square];
        names.into_iter().zip(maps).collect()
    } else {
        vec![("eye space", DMat4::IDENTITY), ("clip space", matrix)]
    };
    report.chart = Some(chart(&view_outline(near, far, is_central, &matrix), &maps));
    Ok(report)
}

/// Adds a matrix by rows.
fn tell4(report: &mut Report, name: &str, m: &DMat4) {
    for i in 0..4 {
        for j in 0..4 {
            report.quantity(format!("{name}, row {}, column {}", i + 1, j + 1), m.col(j)[i] + 0.0, "");
        }
    }
}

/// Outline of what is seen in the plane of x and z, and a line in its middle, as points of eye space.
fn view_outline(near: f64, far: f64, is_central: bool, matrix: &DMat4) -> Vec<DVec3> {
    let inverse = matrix.inverse();
    let corner = |x: f64, distance: f64| {
        // The depth of the distance on the axis, then the point of the window there.
        let axis = *matrix * DVec3::new(0.0, 0.0, -distance).extend(1.0);
        let depth = if is_central { axis.z / axis.w } else { axis.z };
        let p = inverse * DVec3::new(x, 0.0, depth).extend(1.0);
        p.truncate() / p.w
    };
    let (a, b, c, d) = (corner(-1.0, near), corner(1.0, near), corner(1.0, far), corner(-1.0, far));
    let (e, f) = (corner(0.5, near), corner(0.5, far));
    let line = |from: DVec3, to: DVec3| (0..=32).map(move |k| from.lerp(to, f64::from(k) / 32.0));
    line(a, b).chain(line(b, c)).chain(line(c, d)).chain(line(d, a)).chain(line(a, e)).chain(line(e, f)).collect()
}

fn chart(outline: &[DVec3], maps: &[(&str, DMat4)]) -> Chart {
    let chart = Chart::new("what is seen, from above", Axis::linear("z"), Axis::linear("x"));
    maps.iter().fold(Chart { is_isometric: true, ..chart }, |chart, (name, map)| {
        let image = |p: &DVec3| {
            let q = *map * p.extend(1.0);
            (q.z / q.w, q.x / q.w)
        };
        chart.with(Series::line(*name, outline.iter().map(image).collect()))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::run_with;

    /// M29, by hand: with near 1 and far 4 the depth of z = −2 is (f + n)/(f − n) − 2fn/((f − n)·2) = 5/3 − 4/3 = ⅓;
    /// with 0 … 1 it is ⅔, reversed ⅓. The second step maps −2 to −(n + f) + nf/2 = −3.
    #[test]
    fn depths_by_hand() {
        for (depth, at, near, far) in
            [("-1..1", 1.0 / 3.0, -1.0, 1.0), ("0..1", 2.0 / 3.0, 0.0, 1.0), ("reversed", 1.0 / 3.0, 1.0, 0.0)]
        {
            let r = run_with(&EXPERIMENT, &[("depth", depth)]).unwrap();
            assert!((r.value("after division, z") - at).abs() < 1e-12, "{depth}");
            assert!((r.value("depth of the near plane") - near).abs() < 1e-12);
            assert!((r.value("depth of the far plane") - far).abs() < 1e-12);
            assert!((r.value("after step 2, z") + 3.0).abs() < 1e-12);
            assert!((r.value("after step 3, z") - 1.0 / 3.0).abs() < 1e-12);
            assert_eq!(r.facts[0].text, "is seen");
            // The product of the steps is the matrix of OpenGL.
            let apart = (0..16).map(|k| format!(", row {}, column {}", k / 4 + 1, k % 4 + 1)).map(|place| {
                let product = r.value(&format!("product of the steps, for -1..1{place}"));
                (product - run_with(&EXPERIMENT, &[]).unwrap().value(&format!("matrix{place}"))).abs()
            });
            assert!(apart.fold(0.0, f64::max) < 1e-12);
        }
        // A shifted window shears: the middle of the window, one half of its width aside, goes to the middle.
        let given = [("shift-x", "1"), ("fov", "90"), ("aspect", "1"), ("x", "2"), ("y", "0")];
        let shifted = run_with(&EXPERIMENT, &given).unwrap();
        assert!(shifted.value("after division, x").abs() < 1e-12 && shifted.value("after step 1, x").abs() < 1e-12);
        assert!((shifted.value("step 1, row 1, column 3") - 1.0).abs() < 1e-12);
        let behind = run_with(&EXPERIMENT, &[("z", "1")]).unwrap();
        assert!(behind.facts[0].text.contains("behind the eye"));
        assert!(run_with(&EXPERIMENT, &[("near", "5")]).is_err());
        // A cabinet projection draws a unit away from the eye half a unit long.
        let of = |z: &str| {
            let r = run_with(&EXPERIMENT, &[("kind", "oblique"), ("fov", "90"), ("aspect", "1"), ("z", z)]).unwrap();
            DVec3::new(r.value("after division, x"), r.value("after division, y"), 0.0)
        };
        assert!(((of("-3") - of("-2")).length() - 0.5).abs() < 1e-12);
    }
}
