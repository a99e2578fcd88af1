//! Drawing facet normals in proportion to their visible area, for unit roughness.

use super::gaussian::{erf, erf_inv, erfc_scaled};
use std::f32::consts::PI;
use steradian_math::{
    Vec2, Vec3,
    elementary::{acos, exp, ln, pow, sin_cos_turns},
};

/// A visible normal of GGX with `α = 1`, not of unit length: the mirror direction of a visible hemisphere is uniform on
/// a spherical cap, so the normal is the half vector of `w` and a uniform point of the cap (Dupuy & Benyoub 2023),
/// which here has the radius of `w`, its length. `w.z ≥ 0`.
#[inline]
pub(super) fn sample_ggx(w: Vec3, length: f32, u: Vec2) -> Vec3 {
    let (sin_phi, cos_phi) = sin_cos_turns(u.x);
    let z = (1.0 - u.y) * (length + w.z) - w.z;
    let r = ((length - z) * (length + z)).max(0.0).sqrt();
    Vec3::new(r * cos_phi, r * sin_phi, z) + w
}

/// A visible normal of Beckmann with `α = 1`, as minus its slopes: the slope along `w` by inverting its cumulative
/// distribution numerically in the variable `x = erf(slope)`, the slope across is Gaussian (Heitz & d'Eon 2014; the
/// domain is Jakob's, 2014). `w.z ≥ 0`.
pub(super) fn sample_beckmann(w: Vec3, u: Vec2) -> Vec2 {
    let sin = (w.x * w.x + w.y * w.y).sqrt();
    let across = erf_inv(2.0 * u.y - 1.0);
    if sin < 1e-4 {
        // From straight above all slopes are seen alike.
        let (sin_phi, cos_phi) = sin_cos_turns(u.x);
        let r = (-ln(1.0 - u.y)).sqrt();
        return Vec2::new(r * cos_phi, r * sin_phi);
    }
    let along = beckmann_slope(w.z.max(1e-6) / sin, u.x);
    let (cos_phi, sin_phi) = (w.x / sin, w.y / sin);
    // A slope is minus the gradient of the normal.
    Vec2::new(-(cos_phi * along - sin_phi * across), -(sin_phi * along + cos_phi * across))
}

/// The slope along a direction of cotangent `cot`, for the cumulative probability `u`.
///
/// With `t = tanθ` the unnormalised cumulative distribution is `C(s) = 1 + erf(s) + t·exp(−s²)/√π` up to `s = cot`,
/// where it is steepest no more: `C' = 2 exp(−s²)(1 − s·t)/√π`. Halley's method, which takes one or two steps, inside a
/// shrinking bracket.
fn beckmann_slope(cot: f32, u: f32) -> f32 {
    let tan = 1.0 / cot;
    let inv_sqrt_pi = 1.0 / PI.sqrt();
    // `C` and `exp(−s²)`.
    let cumulative = |s: f32| {
        let e = exp(-s * s);
        let beyond = erfc_scaled(s.abs()) * e;
        let shallower = if s < 0.0 { beyond } else { 2.0 - beyond };
        (shallower + inv_sqrt_pi * tan * e, e)
    };
    let u = u.clamp(1e-6, 1.0 - 1e-6);
    let target = u * cumulative(cot).0;
    // Jakob's fit (2014) of erf(s).
    let theta = acos(cot / (1.0 + cot * cot).sqrt());
    let power = 1.0 + theta * (-0.876 + theta * (0.4265 - 0.0594 * theta));
    let most = erf(cot);
    let mut s = erf_inv(most - (most + 1.0) * pow(1.0 - u, power));
    let (mut lo, mut hi) = (-f32::MAX, cot);
    for _ in 0..10 {
        let (c, e) = cumulative(s);
        let excess = c - target;
        if excess.abs() < 1e-5 * target + 2e-7 {
            break;
        }
        if excess > 0.0 {
            hi = s;
        } else {
            lo = s;
        }
        // Halley: s − f/(f' − f f''/2f').
        let rest = 1.0 - s * tan;
        let slope = 2.0 * inv_sqrt_pi * e * rest;
        let next = s - excess * rest / (slope * rest + 0.5 * excess * (2.0 * s * rest + tan));
        s = if next > lo && next < hi { next } else { 0.5 * (lo.max(-5.0) + hi) };
    }
    s
}
