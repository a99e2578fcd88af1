//! Analytic geometry as experiments: the forms of lines, planes, conics and surfaces, coordinates of all kinds, and the
//! maps between them, each with its equation and source in its file.

mod barycentric;
mod basis;
mod conic;
mod coordinates;
mod curvature;
mod directions;
mod drawing;
mod homogeneous;
mod intersect;
mod line;
mod map;
mod plane;
mod projection;
mod rigid;
mod rotation;
mod surface;

use crate::laboratory::{Experiment, Report, Values};
use glam::{DMat3, DVec2, DVec3};

/// The experiments.
pub const EXPERIMENTS: &[Experiment] = &[
    coordinates::EXPERIMENT,
    line::EXPERIMENT,
    plane::EXPERIMENT,
    conic::EXPERIMENT,
    surface::EXPERIMENT,
    intersect::EXPERIMENT,
    barycentric::EXPERIMENT,
    homogeneous::EXPERIMENT,
    projection::EXPERIMENT,
    basis::EXPERIMENT,
    rotation::EXPERIMENT,
    map::EXPERIMENT,
    rigid::EXPERIMENT,
    directions::EXPERIMENT,
];

/// The range of coordinates.
const RANGE: (f64, f64) = (-1e6, 1e6);

/// The point or vector of the plane whose coordinates are parameters.
fn vector2(values: &Values, [x, y]: [&str; 2]) -> DVec2 {
    DVec2::new(values.number(x), values.number(y))
}

/// The point or vector of space whose coordinates are parameters.
fn vector3(values: &Values, [x, y, z]: [&str; 3]) -> DVec3 {
    DVec3::new(values.number(x), values.number(y), values.number(z))
}

/// Adds the coordinates of a point or vector of the plane.
fn tell2(report: &mut Report, name: &str, v: DVec2) {
    for (axis, value) in ["x", "y"].into_iter().zip(v.to_array()) {
        report.quantity(format!("{name}, {axis}"), value + 0.0, "");
    }
}

/// Adds the coordinates of a point or vector of space.
fn tell3(report: &mut Report, name: &str, v: DVec3) {
    for (axis, value) in ["x", "y", "z"].into_iter().zip(v.to_array()) {
        report.quantity(format!("{name}, {axis}"), value + 0.0, "");
    }
}

/// Adds a matrix by rows.
fn tell_matrix(report: &mut Report, m: DMat3) {
    for i in 0..3 {
        for j in 0..3 {
            report.quantity(format!("matrix, row {}, column {}", i + 1, j + 1), m.col(j)[i] + 0.0, "");
        }
    }
}

#[cfg(test)]
fn run_with(experiment: &Experiment, given: &[(&str, &str)]) -> Result<Report, crate::laboratory::Error> {
    let given: Vec<_> = given.iter().map(|(a, b)| ((*a).to_owned(), (*b).to_owned())).collect();
    experiment.run(&given, None)
}
