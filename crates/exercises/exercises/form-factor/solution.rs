//! Form factors; the task is in README.md.
#![allow(dead_code, unused_imports, unused_variables)]

use std::f64::consts::PI;

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The kernel of the form factor at two points (1/m²).
pub fn kernel(x: [f64; 3], nx: [f64; 3], y: [f64; 3], ny: [f64; 3]) -> f64 {
    // gap
    let d = [0, 1, 2].map(|i| y[i] - x[i]);
    let r = dot(d, d).sqrt();
    let (cos_x, cos_y) = ((dot(nx, d) / r).max(0.0), (-dot(ny, d) / r).max(0.0));
    cos_x * cos_y / (PI * r * r)
    // end
}

/// The form factor the other way.
pub fn reverse(f_ij: f64, area_i: f64, area_j: f64) -> f64 {
    // gap
    f_ij * area_i / area_j
    // end
}

/// The radiosity of a patch after one step of Jacobi's iteration (W/m²).
pub fn step(emission: f64, albedo: f64, f: [f64; 4], b: [f64; 4]) -> f64 {
    // gap
    emission + albedo * (0..4).map(|j| f[j] * b[j]).sum::<f64>()
    // end
}
