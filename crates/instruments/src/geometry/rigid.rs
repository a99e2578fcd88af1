//! Rigid maps `x ↦ R x + t`: is this matrix one, and what does it keep?
//!
//! `R` is a rotation if its columns are orthonormal, `RᵀR = I`, and its determinant is +1. With −1 it mirrors as well;
//! with `RᵀR = s² I` it is a similarity, which keeps angles. The inverse of a rigid map is `x ↦ Rᵀ(x − t)`. Each one is
//! a screw: a turn about an axis, and a shift along it (Chasles 1830).

use super::{RANGE, drawing, tell3, vector3};
use crate::laboratory::{Error, Experiment, Parameter, Report, Run, Values};
use glam::{DMat3, DVec3};
use steradian_math::transform::Transform;

pub const EXPERIMENT: Experiment = Experiment {
    name: "rigid",
    doc: "a matrix with a translation: is it rigid, what does it keep, and which screw is it",
    source: "Coxeter, Introduction to Geometry, §7.5 and §15.5; Chasles 1830",
    parameters: &[
        Parameter::number("m11", 0.0, RANGE, "", "matrix, first row"),
        Parameter::number("m12", -1.0, RANGE, "", "matrix, first row"),
        Parameter::number("m13", 0.0, RANGE, "", "matrix, first row"),
        Parameter::number("m21", 1.0, RANGE, "", "matrix, second row"),
        Parameter::number("m22", 0.0, RANGE, "", "matrix, second row"),
        Parameter::number("m23", 0.0, RANGE, "", "matrix, second row"),
        Parameter::number("m31", 0.0, RANGE, "", "matrix, third row"),
        Parameter::number("m32", 0.0, RANGE, "", "matrix, third row"),
        Parameter::number("m33", 1.0, RANGE, "", "matrix, third row"),
        Parameter::number("tx", 2.0, RANGE, "", "translation"),
        Parameter::number("ty", 0.0, RANGE, "", "translation"),
        Parameter::number("tz", 1.0, RANGE, "", "translation"),
        Parameter::number("tolerance", 1e-6, (0.0, 0.1), "", "of the entries of the transposed times the matrix"),
    ],
    run: Run::Alone(run),
};

/// Greatest difference of the entries of two matrices.
fn apart(a: DMat3, b: DMat3) -> f64 {
    (a - b).to_cols_array().into_iter().map(f64::abs).fold(0.0, f64::max)
}

/// Nearest rotation to a matrix that is nearly one (Gram and Schmidt).
fn orthonormalized(m: DMat3) -> DMat3 {
    let x = m.x_axis.normalize_or_zero();
    let y = (m.y_axis - m.y_axis.dot(x) * x).normalize_or_zero();
    DMat3::from_cols(x, y, x.cross(y))
}

fn run(values: &Values) -> Result<Report, Error> {
    let rows = [["m11", "m12", "m13"], ["m21", "m22", "m23"], ["m31", "m32", "m33"]];
    let m = DMat3::from_cols_array_2d(&rows.map(|row| row.map(|n| values.number(n)))).transpose();
    let t = vector3(values, ["tx", "ty", "tz"]);
    let tolerance = values.number("tolerance");
    let gram = m.transpose() * m;
    let determinant = m.determinant();
    // A similarity has one scale for all columns.
    let scale = (gram.x_axis.x + gram.y_axis.y + gram.z_axis.z) / 3.0;
    let mut report = Report::default();
    for (name, column) in ["first", "second", "third"].into_iter().zip([m.x_axis, m.y_axis, m.z_axis]) {
        report.quantity(format!("length of the {name} column"), column.length(), "");
    }
    for (name, product) in [
        ("first · second column", gram.x_axis.y),
        ("first · third column", gram.x_axis.z),
        ("second · third column", gram.y_axis.z),
    ] {
        report.quantity(name, product + 0.0, "");
    }
    report.quantity("determinant", determinant + 0.0, "");
    report.quantity("greatest difference of RᵀR and I", apart(gram, DMat3::IDENTITY), "");
    let keeps_lengths = apart(gram, DMat3::IDENTITY) <= tolerance;
    let keeps_angles = scale > 0.0 && apart(gram, DMat3::from_diagonal(DVec3::splat(scale))) <= tolerance * scale;
    let is_rigid = keeps_lengths && determinant > 0.0;
    report.fact(
        "the map",
        match (keeps_lengths, keeps_angles, determinant) {
            (true, _, d) if d > 0.0 => "is rigid",
            (true, ..) => "is a reflection with a turn: an isometry, but not rigid",
            (_, true, d) if d > 0.0 => "is a similarity: a turn and a scaling",
            (_, true, _) => "is a similarity that mirrors",
            (.., 0.0) => "is singular: space is flattened",
            _ => "is affine, and no more",
        },
    );
    let kept = [
        ("lengths", keeps_lengths),
        ("angles", keeps_lengths || keeps_angles),
        ("volumes", (determinant.abs() - 1.0).abs() <= 3.0 * tolerance),
        ("handedness", determinant > 0.0),
        ("parallels", determinant != 0.0),
        ("ratios on lines", determinant != 0.0),
    ];
    let kept: Vec<&str> = kept.into_iter().filter(|(_, is)| *is).map(|(name, _)| name).collect();
    report.fact("it keeps", if kept.is_empty() { "nothing of these".to_owned() } else { kept.join(", ") });
    if is_rigid {
        let r = orthonormalized(m);
        tell3(&mut report, "translation of the inverse", -(r.transpose() * t));
        let (axis, angle) = Transform::linear(r).to_axis_angle().unwrap_or((DVec3::X, 0.0));
        report.quantity("angle of the turn", angle.to_degrees(), "°");
        if angle > 1e-9 {
            let along = t.dot(axis);
            let across = t - along * axis;
            tell3(&mut report, "axis of the screw", axis);
            tell3(&mut report, "point on the axis", 0.5 * (across + axis.cross(across) / (0.5 * angle).tan()));
            report.quantity("shift along the axis", along + 0.0, "");
        } else {
            report.fact("screw", "none: the map is a translation");
        }
    }
    report.chart = Some(drawing::cube_and_image(|p| m * p + t));
    Ok(report)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::run_with;

    fn with_rows(rows: [[f64; 3]; 3], t: [f64; 3]) -> Report {
        let names = ["m11", "m12", "m13", "m21", "m22", "m23", "m31", "m32", "m33", "tx", "ty", "tz"];
        let numbers: Vec<String> = rows.concat().into_iter().chain(t).map(|v| v.to_string()).collect();
        let given: Vec<_> = names.into_iter().zip(numbers.iter().map(String::as_str)).collect();
        run_with(&EXPERIMENT, &given).unwrap()
    }

    /// By hand: a quarter turn about z with (2, 0, 1) is a screw about the line through (1, 1, 0), with a shift of 1.
    #[test]
    fn a_quarter_turn_is_a_screw() {
        let r = run_with(&EXPERIMENT, &[]).unwrap();
        assert_eq!(r.facts[0].text, "is rigid");
        assert_eq!(r.facts[1].text, "lengths, angles, volumes, handedness, parallels, ratios on lines");
        let of = |name: &str| DVec3::from(["x", "y", "z"].map(|a| r.value(&format!("{name}, {a}"))));
        assert!((of("point on the axis") - DVec3::new(1.0, 1.0, 0.0)).length() < 1e-12);
        assert!((of("axis of the screw") - DVec3::Z).length() < 1e-12);
        assert!((r.value("shift along the axis") - 1.0).abs() < 1e-12);
        assert!((r.value("angle of the turn") - 90.0).abs() < 1e-9);
        assert!((of("translation of the inverse") - DVec3::new(0.0, 2.0, -1.0)).length() < 1e-12);
    }

    /// The point on the axis stays on it: for turns about any axis.
    #[test]
    fn the_axis_is_mapped_to_itself() {
        for (yaw, pitch, roll) in [(0.3, -0.4, 1.0), (2.0, 1.2, -0.7), (3.0, 0.1, 0.2)] {
            let m = DMat3::from_mat4(Transform::yaw_pitch_roll(yaw, pitch, roll).matrix);
            let t = DVec3::new(0.7, -2.0, 1.5);
            let r = with_rows(m.transpose().to_cols_array_2d(), t.to_array());
            let of = |name: &str| DVec3::from(["x", "y", "z"].map(|a| r.value(&format!("{name}, {a}"))));
            let (point, axis) = (of("point on the axis"), of("axis of the screw"));
            let image = m * point + t;
            assert!((image - point - r.value("shift along the axis") * axis).length() < 1e-9);
        }
    }

    /// A mirror, a scaling, a shear and a flattening are none, and are told apart.
    #[test]
    fn other_maps_are_told_apart() {
        for (rows, kind, kept) in [
            ([[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], "reflection", "lengths, angles, volumes, parallels"),
            ([[0.0, -2.0, 0.0], [2.0, 0.0, 0.0], [0.0, 0.0, 2.0]], "similarity", "angles, handedness"),
            ([[1.0, 0.5, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], "affine", "volumes, handedness"),
            ([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 0.0]], "singular", "nothing"),
        ] {
            let r = with_rows(rows, [0.0; 3]);
            assert!(r.facts[0].text.contains(kind) && r.facts[1].text.starts_with(kept), "{kind}: {:?}", r.facts);
            assert!(r.value("angle of the turn").is_nan());
        }
        let shift = with_rows([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [1.0, 2.0, 3.0]);
        assert!(shift.facts[2].text.contains("translation"));
    }
}
