//! A path tracer in a sphere that glows; the task is in README.md.
#![allow(dead_code, unused_imports, unused_variables)]

use std::f64::consts::PI;

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The distance along the ray to the unit sphere, from inside.
pub fn hit(o: [f64; 3], d: [f64; 3]) -> f64 {
    // gap
    let (b, c) = (dot(o, d), dot(o, o) - 1.0);
    -b + (b * b - c).max(0.0).sqrt()
    // end
}

/// A direction on the side of n, drawn in proportion to its cosine.
pub fn direction(n: [f64; 3], u1: f64, u2: f64) -> [f64; 3] {
    // gap
    let x = cross(if n[0].abs() < 0.5 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] }, n);
    let length = dot(x, x).sqrt();
    let x = x.map(|c| c / length);
    let y = cross(n, x);
    let (r, phi, z) = (u1.sqrt(), 2.0 * PI * u2, (1.0 - u1).sqrt());
    [0, 1, 2].map(|i| r * phi.cos() * x[i] + r * phi.sin() * y[i] + z * n[i])
    // end
}

/// The radiance at o from the direction d, estimated by one path of four bounces.
pub fn radiance(albedo: f64, o: [f64; 3], d: [f64; 3], u: [f64; 8]) -> f64 {
    // gap
    let step = |p: [f64; 3], d: [f64; 3]| {
        let t = hit(p, d);
        [0, 1, 2].map(|i| p[i] + t * d[i])
    };
    let mut p = step(o, d);
    let (mut light, mut beta) = (1.0 + p[2], 1.0);
    for k in 0..4 {
        let d = direction(p.map(|c| -c), u[2 * k], u[2 * k + 1]);
        beta *= albedo;
        p = step(p, d);
        light += beta * (1.0 + p[2]);
    }
    light
    // end
}
