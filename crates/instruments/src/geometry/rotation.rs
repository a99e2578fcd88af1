//! Rotations: yaw, pitch and roll, the matrix, axis and angle, and back.
//!
//! The world is y-up: `R = R_Y(yaw) R_X(pitch) R_Z(roll)`, each factor right-handed, or `R_Z R_Y R_X`, as the angles
//! are called in aeronautics (there z is the axis of yaw, y that of pitch, x that of roll). At a pitch of ±90° yaw and
//! roll turn about the same axis and only their sum or difference is left: gimbal lock.

use super::{drawing, tell_matrix, tell3};
use crate::laboratory::{Error, Experiment, Marker, Parameter, Report, Run, Values};
use glam::{DMat3, DVec3};
use steradian_math::transform::Transform;

const TURN: (f64, f64) = (-360.0, 360.0);

pub const EXPERIMENT: Experiment = Experiment {
    name: "rotation",
    doc: "yaw, pitch and roll as a matrix and as an axis with an angle, and back; gimbal lock",
    source: "Diebel, Representing Attitude, 2006, §8.11 and §8.12",
    parameters: &[
        Parameter::choice("order", &["yxz", "zyx"], "axes of yaw, pitch and roll, the last applied first"),
        Parameter::number("yaw", 30.0, TURN, "°", "first angle"),
        Parameter::number("pitch", 20.0, TURN, "°", "second angle"),
        Parameter::number("roll", 10.0, TURN, "°", "third angle"),
    ],
    run: Run::Alone(run),
};

fn run(values: &Values) -> Result<Report, Error> {
    let [yaw, pitch, roll] = ["yaw", "pitch", "roll"].map(|name| values.number(name).to_radians());
    let is_zyx = values.choice("order") == "zyx";
    let turn =
        if is_zyx { Transform::rotate_zyx(yaw, pitch, roll) } else { Transform::yaw_pitch_roll(yaw, pitch, roll) };
    let lost = || Error::Impossible("the matrix of these angles is no rotation within rounding".into());
    let mut report = Report::default();
    let matrix = DMat3::from_mat4(turn.matrix);
    tell_matrix(&mut report, matrix);
    let (axis, angle) = turn.to_axis_angle().ok_or_else(lost)?;
    tell3(&mut report, "axis", axis);
    report.quantity("angle about the axis", angle.to_degrees(), "°");
    // Z Y X is Y X Z with the axes renamed in turn: y for z, x for y, z for x.
    let renamed = if is_zyx { renamed(&turn) } else { turn };
    let back = renamed.to_yaw_pitch_roll().ok_or_else(lost)?.map(f64::to_degrees);
    for (name, angle) in ["yaw", "pitch", "roll"].into_iter().zip(back) {
        report.quantity(format!("back from the matrix, {name}"), angle + 0.0, "°");
    }
    if pitch.cos().abs() < 1e-9 {
        let what = if pitch.sin() > 0.0 { "yaw minus roll" } else { "yaw plus roll" };
        report.fact("gimbal lock", format!("only {what} is determined; the roll is taken as 0"));
    }
    let mut chart = drawing::view("turned axes", 1.0);
    for (k, (name, color)) in
        [("x turned", [190, 60, 50]), ("y turned", [50, 140, 60]), ("z turned", [40, 80, 190])].into_iter().enumerate()
    {
        chart = chart.with(drawing::curve(name, [DVec3::ZERO, matrix.col(k)]).drawn(Marker::Dashed).colored(color));
        let way = (0..=24).map(|s| Transform::rotate(axis, angle * f64::from(s) / 24.0).vector(DVec3::AXES[k]));
        chart = chart.with(drawing::curve("", way).colored([0xa8, 0xb4, 0xc4]));
    }
    report.chart = Some(chart);
    Ok(report)
}

/// A rotation in coordinates `(y, z, x)`.
fn renamed(turn: &Transform) -> Transform {
    let cycle = Transform::linear(steradian_math::geometry::axes::CYCLE);
    let back = Transform::linear(steradian_math::geometry::axes::CYCLE.transpose());
    cycle * *turn * back
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::run_with;

    fn angles(order: &str, given: [f64; 3]) -> Report {
        let [yaw, pitch, roll] = given.map(|a| a.to_string());
        run_with(&EXPERIMENT, &[("order", order), ("yaw", &yaw), ("pitch", &pitch), ("roll", &roll)]).unwrap()
    }

    /// M17, M18: quarter turns by hand: a yaw about y takes z to x, and about z takes x to y; yaw then pitch is the
    /// third of a turn about a diagonal; the middle factor of Z Y X is right-handed, so its lower left entry is −sin β
    /// (E23).
    #[test]
    fn quarter_turns_by_hand() {
        let entry = |r: &Report, i: u32, j: u32| r.value(&format!("matrix, row {i}, column {j}"));
        assert!((entry(&angles("yxz", [90.0, 0.0, 0.0]), 1, 3) - 1.0).abs() < 1e-12);
        assert!((entry(&angles("zyx", [90.0, 0.0, 0.0]), 2, 1) - 1.0).abs() < 1e-12);
        assert!((entry(&angles("zyx", [0.0, 30.0, 0.0]), 3, 1) + 0.5).abs() < 1e-12);
        let r = angles("yxz", [90.0, 90.0, 0.0]);
        assert!((r.value("angle about the axis") - 120.0).abs() < 1e-9);
        assert!((r.value("axis, x") - 3f64.sqrt().recip()).abs() < 1e-9);
    }

    #[test]
    fn angles_come_back() {
        for order in ["yxz", "zyx"] {
            for given in [[30.0, 20.0, 10.0], [-120.0, -75.0, 160.0], [179.0, 89.0, -1.0]] {
                let r = angles(order, given);
                for (name, angle) in ["yaw", "pitch", "roll"].into_iter().zip(given) {
                    let back = r.value(&format!("back from the matrix, {name}"));
                    assert!((back - angle).abs() < 1e-6, "{order} {given:?} {name}: {back}");
                }
                assert!(r.facts.is_empty());
            }
            for (pitch, yaw) in [(90.0, 20.0), (-90.0, 40.0)] {
                let r = angles(order, [30.0, pitch, 10.0]);
                assert!(r.facts[0].text.contains("determined"));
                assert!((r.value("back from the matrix, yaw") - yaw).abs() < 1e-6, "{order} {pitch}");
                assert_eq!(r.value("back from the matrix, roll"), 0.0);
            }
        }
    }
}
