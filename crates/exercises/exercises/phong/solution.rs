//! Phong's lobe as a BRDF; the task is in README.md.
#![allow(dead_code, unused_imports, unused_variables)]

use std::f64::consts::PI;

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The mirror direction of w.
pub fn mirror(w: [f64; 3]) -> [f64; 3] {
    // gap
    [-w[0], -w[1], w[2]]
    // end
}

/// The BRDF (1/sr), without the cosine; 0 if a direction is below the surface.
pub fn eval(ks: f64, n: f64, wo: [f64; 3], wi: [f64; 3]) -> f64 {
    // gap
    if wo[2] <= 0.0 || wi[2] <= 0.0 {
        return 0.0;
    }
    let cosine = dot(mirror(wo), wi).max(0.0);
    ks * (n + 2.0) / (2.0 * PI) * cosine.powf(n)
    // end
}

/// A direction around the mirror direction of wo.
pub fn sample(n: f64, wo: [f64; 3], u1: f64, u2: f64) -> [f64; 3] {
    // gap
    let z = mirror(wo);
    // Two directions at right angles to z and to each other.
    let a = if z[0].abs() < 0.5 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
    let x = cross(a, z);
    let length = dot(x, x).sqrt();
    let x = x.map(|c| c / length);
    let y = cross(z, x);
    let (cosine, phi) = (u1.powf(1.0 / (n + 1.0)), 2.0 * PI * u2);
    let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
    [0, 1, 2].map(|i| sine * phi.cos() * x[i] + sine * phi.sin() * y[i] + cosine * z[i])
    // end
}

/// The density of `sample` (1/sr).
pub fn pdf(n: f64, wo: [f64; 3], wi: [f64; 3]) -> f64 {
    // gap
    let cosine = dot(mirror(wo), wi).max(0.0);
    (n + 1.0) / (2.0 * PI) * cosine.powf(n)
    // end
}
