//! A matt surface; the task is in README.md.
#![allow(unused_imports, unused_variables)]

use std::f64::consts::PI;

/// The BRDF (1/sr), without the cosine; 0 if a direction is below the surface.
pub fn eval(albedo: f64, wo: [f64; 3], wi: [f64; 3]) -> f64 {
    // gap
    if wo[2] <= 0.0 || wi[2] <= 0.0 {
        return 0.0;
    }
    albedo / PI
    // end
}

/// A direction above the surface, drawn in proportion to its cosine.
pub fn sample(u1: f64, u2: f64) -> [f64; 3] {
    // gap
    let (r, phi) = (u1.sqrt(), 2.0 * PI * u2);
    [r * phi.cos(), r * phi.sin(), (1.0 - u1).sqrt()]
    // end
}

/// The density of `sample` (1/sr).
pub fn pdf(wi: [f64; 3]) -> f64 {
    // gap
    wi[2].max(0.0) / PI
    // end
}
