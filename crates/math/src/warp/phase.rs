//! The Henyey–Greenstein phase function and its exact sampling (Henyey and Greenstein 1941; PBR 4th ed., 11.3.1).
//!
//! `wo` and `wi` both point away from the scattering point, so light that goes straight on has `wo·wi = −1`. Both
//! functions clamp the asymmetry `g` to ±0.999, where `f32` can still evaluate the lobe.

use super::UNIFORM_SPHERE_PDF;
use crate::{Frame, Vec2, Vec3, elementary};

const MAX_ASYMMETRY: f32 = 0.999;

/// The phase function of `x = 1 + wo·wi ∈ [0, 2]`: `1 + g² + 2g·cos` is written as a square and a small rest, so that
/// the peak loses no digits.
#[inline(always)]
fn lobe(x: f32, g: f32) -> f32 {
    let d = if g >= 0.0 { (1.0 - g) * (1.0 - g) + 2.0 * g * x } else { (1.0 + g) * (1.0 + g) - 2.0 * g * (2.0 - x) };
    UNIFORM_SPHERE_PDF * ((1.0 - g) * (1.0 + g)) / (d * d.sqrt())
}

/// Phase function (1/sr, it integrates to one) for `cos = wo·wi` and mean cosine `g ∈ (−1, 1)`; `g > 0` scatters
/// forward, to `wi ≈ −wo`.
#[inline(always)]
pub fn hg_phase(cos: f32, g: f32) -> f32 {
    lobe((1.0 + cos).clamp(0.0, 2.0), g.clamp(-MAX_ASYMMETRY, MAX_ASYMMETRY))
}

/// A direction `wi` with density [`hg_phase`], and that density.
#[inline(always)]
pub fn sample_hg(wo: Vec3, g: f32, u: Vec2) -> (Vec3, f32) {
    let g = g.clamp(-MAX_ASYMMETRY, MAX_ASYMMETRY);
    // Inverting the distribution gives x = 1 − cosθ of the deflection θ as a product, without dividing by g.
    let s = if g >= 0.0 { (1.0 - g) + 2.0 * g * (1.0 - u.x) } else { (1.0 + g) - 2.0 * g * u.x };
    let x = (2.0 * u.x * (1.0 - g) * (1.0 - g) * (1.0 + g * (1.0 - u.x)) / (s * s)).clamp(0.0, 2.0);
    let sin_theta = (x * (2.0 - x)).sqrt();
    let (sin_phi, cos_phi) = elementary::sin_cos_turns(u.y);
    let deflected = Vec3::new(sin_theta * cos_phi, sin_theta * sin_phi, 1.0 - x);
    (Frame::from_z(-wo).to_world(deflected), lobe(x, g))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chi_square::test_sphere;
    use crate::hash::ONE_MINUS_EPSILON;

    #[test]
    fn samples_follow_the_phase_function() {
        let wo = Vec3::new(0.3, -0.5, 0.8).normalize();
        for g in [-0.7, -0.2, 0.0, 1e-4, 0.5, 0.85] {
            test_sphere(
                &format!("g = {g}"),
                200_000,
                |u| sample_hg(wo, g, u).0,
                |wi| f64::from(hg_phase(wo.dot(wi), g)),
            );
        }
    }

    #[test]
    fn density_mean_cosine_and_extremes() {
        let wo = Vec3::new(-0.2, 0.6, 0.7).normalize();
        for g in [-0.99_f32, -0.9, -0.3, 0.0, 0.3, 0.9, 0.99] {
            let n = 4096;
            let mut mean = 0.0_f64;
            for i in 0..n {
                let (wi, pdf) = sample_hg(wo, g, Vec2::new((i as f32 + 0.5) / n as f32, 0.3));
                let evaluated = hg_phase(wo.dot(wi), g);
                assert!((pdf / evaluated - 1.0).abs() < 0.02, "g = {g}: {pdf} is not {evaluated}");
                mean -= f64::from(wo.dot(wi)) / f64::from(n);
            }
            assert!((mean - f64::from(g)).abs() < 1e-3, "g = {g}: mean cosine {mean}");
            for u in [0.0, ONE_MINUS_EPSILON] {
                let (wi, pdf) = sample_hg(wo, g, Vec2::new(u, u));
                assert!((wi.length() - 1.0).abs() < 1e-5 && pdf.is_finite() && pdf > 0.0);
            }
        }
        assert!(hg_phase(-1.0, 1.0).is_finite() && hg_phase(1.0, -1.0).is_finite());
    }
}
