//! Noise: random functions of space that are smooth, band-limited and repeat nowhere that matters. Only exact
//! arithmetic, so that a texture has the same bits on every machine.

pub mod cellular;
pub mod fractal;
pub mod lattice;

pub use cellular::{Cellular, Metric};
pub use fractal::{Basis, Fractal};
pub use lattice::{gradient_noise, value_noise};

/// `6t⁵ − 15t⁴ + 10t³`: from 0 to 1 with first and second derivatives of zero at both ends (Perlin, "Improving Noise",
/// 2002).
#[inline]
pub fn quintic_fade(t: f32) -> f32 {
    t * t * t * (t * (t * 6.0 - 15.0) + 10.0)
}

/// `3t² − 2t³` of where `x` lies between `a` and `b`, clamped.
#[inline]
pub fn smoothstep(x: f32, a: f32, b: f32) -> f32 {
    let t = ((x - a) / (b - a)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}
