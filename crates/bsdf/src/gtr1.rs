//! The generalised Trowbridge–Reitz distribution of exponent 1 (Burley 2012, "Physically-Based Shading at Disney",
//! appendix B.2), whose long tail is Disney's clear coat: `D = (α² − 1) / (π ln α² (1 + (α² − 1) cos²θ))`, for
//! `0 < α < 1`.

use std::f32::consts::PI;
use steradian_math::{
    Vec2, Vec3,
    elementary::{ln, pow, sin_cos_turns},
};

/// `D` at a normal of this cosine (sr⁻¹).
#[inline]
pub(super) fn d(alpha: f32, cos: f32) -> f32 {
    let a2 = alpha * alpha;
    // 1 − cos² first: at small α the sum loses all digits otherwise.
    (1.0 - a2) / (-PI * ln(a2) * ((1.0 - cos * cos).max(0.0) + a2 * cos * cos))
}

/// A normal with density `D cosθ` (B.2, eq. 2 and 3).
#[inline]
pub(super) fn sample(alpha: f32, u: Vec2) -> Vec3 {
    let a2 = alpha * alpha;
    let cos2 = ((1.0 - pow(a2, 1.0 - u.y)) / (1.0 - a2)).clamp(0.0, 1.0);
    let (sin, (sin_phi, cos_phi)) = ((1.0 - cos2).sqrt(), sin_cos_turns(u.x));
    Vec3::new(sin * cos_phi, sin * sin_phi, cos2.sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn facets_cover_the_surface_once() {
        // ∫ D cosθ dω = 2π ∫ D c dc, by the midpoint rule in ln(1 − c²).
        for alpha in [0.001, 0.02, 0.1, 0.5] {
            let n = 20_000;
            let (low, high) = (-22.0f64, 0.0f64);
            let sum: f64 = (0..n)
                .map(|i| {
                    let s2 = (low + (high - low) * (f64::from(i) + 0.5) / f64::from(n)).exp();
                    std::f64::consts::PI * f64::from(d(alpha, (1.0 - s2).sqrt() as f32)) * s2
                })
                .sum::<f64>()
                * (high - low)
                / f64::from(n);
            assert!((sum - 1.0).abs() < 5e-3, "{alpha}: {sum}");
        }
    }
}
