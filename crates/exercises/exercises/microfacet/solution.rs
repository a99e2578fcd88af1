//! A rough mirror by GGX; the task is in README.md.
#![allow(dead_code, unused_imports, unused_variables)]

use std::f64::consts::PI;

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The density D of facets' normals (1/sr).
pub fn distribution(alpha: f64, cos_m: f64) -> f64 {
    // gap
    let a2 = alpha * alpha;
    let bracket = cos_m * cos_m * (a2 - 1.0) + 1.0;
    a2 / (PI * bracket * bracket)
    // end
}

/// The part of the facets that are lit and seen.
pub fn shadowing(alpha: f64, cos_o: f64, cos_i: f64) -> f64 {
    // gap
    let hidden = |cosine: f64| {
        let tan2 = (1.0 - cosine * cosine) / (cosine * cosine);
        (-1.0 + (1.0 + alpha * alpha * tan2).sqrt()) / 2.0
    };
    1.0 / (1.0 + hidden(cos_o) + hidden(cos_i))
    // end
}

/// The BRDF (1/sr), without the cosine; 0 if a direction is below the surface.
pub fn eval(f0: f64, alpha: f64, wo: [f64; 3], wi: [f64; 3]) -> f64 {
    // gap
    if wo[2] <= 0.0 || wi[2] <= 0.0 {
        return 0.0;
    }
    let m = [0, 1, 2].map(|i| wo[i] + wi[i]);
    let length = dot(m, m).sqrt();
    let m = m.map(|x| x / length);
    let fresnel = f0 + (1.0 - f0) * (1.0 - dot(wo, m)).powi(5);
    let lit = distribution(alpha, m[2]) * shadowing(alpha, wo[2], wi[2]);
    fresnel * lit / (4.0 * wo[2] * wi[2])
    // end
}
