//! The Henyey–Greenstein phase function and its exact sampling (Henyey and Greenstein 1941; PBR 4th ed., 11.3.1).
//!
//! `wo` and `wi` both point away from the scattering point, so light that goes straight on has `wo·wi = −1`. Both functions clamp
//! the asymmetry `g` to ±0.999, where `f32` can still evaluate the lobe.

use super::{UNIFORM_SPHERE_PDF, spherical_direction};
use crate::{Frame, Vec2, Vec3};
use std::f32::consts::TAU;

const MAX_ASYMMETRY: f32 = 0.999;

/// The phase function of `x = 1 + wo·wi ∈ [0, 2]`: `1 + g² + 2g·cos` is written as a square and a small rest, so that the peak
/// loses no digits.
#[inline]
fn lobe(x: f32, g: f32) -> f32 {
    let d = if g >= 0.0 { (1.0 - g) * (1.0 - g) + 2.0 * g * x } else { (1.0 + g) * (1.0 + g) - 2.0 * g * (2.0 - x) };
    UNIFORM_SPHERE_PDF * ((1.0 - g) * (1.0 + g)) / (d * d.sqrt())
}

/// Phase function (1/sr, it integrates to one) for `cos = wo·wi` and mean cosine `g ∈ (−1, 1)`; `g > 0` scatters forward, to
/// `wi ≈ −wo`.
#[inline]
pub fn hg_phase(cos: f32, g: f32) -> f32 {
    lobe((1.0 + cos).clamp(0.0, 2.0), g.clamp(-MAX_ASYMMETRY, MAX_ASYMMETRY))
}

/// A direction `wi` with density [`hg_phase`], and that density.
#[inline]
pub fn sample_hg(wo: Vec3, g: f32, u: Vec2) -> (Vec3, f32) {
    let g = g.clamp(-MAX_ASYMMETRY, MAX_ASYMMETRY);
    // Inverting the distribution gives x = 1 − cosθ of the deflection θ as a product, without dividing by g.
    let s = if g >= 0.0 { (1.0 - g) + 2.0 * g * (1.0 - u.x) } else { (1.0 + g) - 2.0 * g * u.x };
    let x = (2.0 * u.x * (1.0 - g) * (1.0 - g) * (1.0 + g * (1.0 - u.x)) / (s * s)).clamp(0.0, 2.0);
    let sin_theta = (x * (2.0 - x)).sqrt();
    let deflected = spherical_direction(sin_theta, 1.0 - x, TAU * u.y);
    (Frame::from_z(-wo).to_world(deflected), lobe(x, g))
}
