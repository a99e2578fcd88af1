//! Interpolation in perspective; the task is in README.md.
#![allow(unused_variables)]

/// The attribute on the surface, by weights on the screen.
pub fn interpolate(b: [f64; 3], a: [f64; 3], w: [f64; 3]) -> f64 {
    // gap
    let above: f64 = (0..3).map(|i| b[i] * a[i] / w[i]).sum();
    let below: f64 = (0..3).map(|i| b[i] / w[i]).sum();
    above / below
    // end
}

/// Depth after the division, from 0 to 1.
pub fn depth(distance: f64, near: f64, far: f64) -> f64 {
    // gap
    far * (distance - near) / (distance * (far - near))
    // end
}
