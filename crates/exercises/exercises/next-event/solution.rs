//! Direct light of a lamp; the task is in README.md.
#![allow(dead_code, unused_imports, unused_variables)]

use std::f64::consts::PI;

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The reflected radiance at the origin, estimated by one point on the lamp.
pub fn direct(
    albedo: f64,
    radiance: f64,
    corner: [f64; 3],
    a: [f64; 3],
    b: [f64; 3],
    visible: f64,
    u: [f64; 2],
) -> f64 {
    // gap
    if visible == 0.0 {
        return 0.0;
    }
    let y = [0, 1, 2].map(|i| corner[i] + u[0] * a[i] + u[1] * b[i]);
    let r = dot(y, y).sqrt();
    let lamp = cross(a, b);
    let area = dot(lamp, lamp).sqrt();
    let cos_x = (y[2] / r).max(0.0);
    let cos_y = (-dot(lamp, y) / (area * r)).max(0.0);
    albedo / PI * radiance * cos_x * cos_y / (r * r) * area
    // end
}
