//! Spherical angles with their seam and poles settled: `θ ∈ [0, π]` from `+z`, `φ ∈ [0, 2π)` from `+x` towards `+y`.

use crate::{Vec2, Vec3};
use std::f32::consts::{FRAC_1_PI, PI, TAU};

/// The direction with the given sine and cosine of `θ`, and azimuth `φ` in radians.
#[inline]
pub fn spherical_direction(sin_theta: f32, cos_theta: f32, phi: f32) -> Vec3 {
    let (sin_phi, cos_phi) = phi.sin_cos();
    Vec3::new(sin_theta * cos_phi, sin_theta * sin_phi, cos_theta)
}

/// `(θ, φ)` of a direction of any length but zero. At the poles `φ` is 0 or π as the signs of zero say; `θ` comes from
/// `atan2` and so is accurate near the poles and never NaN for finite input.
#[inline]
pub fn spherical_angles(d: Vec3) -> (f32, f32) {
    let theta = d.x.hypot(d.y).atan2(d.z);
    let phi = d.y.atan2(d.x);
    let phi = if phi < 0.0 { phi + TAU } else { phi };
    // A tiny negative angle plus 2π rounds to 2π.
    (theta, if phi < TAU { phi } else { 0.0 })
}

/// `(φ/2π, θ/π)` of a direction: its place in a latitude–longitude image whose first row is `+z`. The first is in
/// `[0,1)`.
#[inline]
pub fn latlong_from_direction(d: Vec3) -> Vec2 {
    let (theta, phi) = spherical_angles(d);
    Vec2::new((phi * (0.5 * FRAC_1_PI)).min(crate::hash::ONE_MINUS_EPSILON), (theta * FRAC_1_PI).clamp(0.0, 1.0))
}

/// The inverse of [`latlong_from_direction`]: the unit direction and `sinθ`, by which densities on the image are
/// divided: `p(ω) = p(u,v)/(2π² sinθ)`.
#[inline]
pub fn direction_from_latlong(uv: Vec2) -> (Vec3, f32) {
    let (sin_theta, cos_theta) = (uv.y * PI).sin_cos();
    (spherical_direction(sin_theta, cos_theta, uv.x * TAU), sin_theta)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hash::HashRng;

    #[test]
    fn angles_and_directions_are_inverse() {
        let mut rng = HashRng::new(4);
        for _ in 0..50_000 {
            let d = crate::warp::uniform_sphere(Vec2::new(rng.next_f32(), rng.next_f32()));
            let (theta, phi) = spherical_angles(d * 7.0);
            assert!((0.0..=PI).contains(&theta) && (0.0..TAU).contains(&phi));
            assert!((spherical_direction(theta.sin(), theta.cos(), phi) - d).length() < 1e-6);
            let uv = latlong_from_direction(d);
            let (back, sin_theta) = direction_from_latlong(uv);
            assert!((back - d).length() < 2e-6 && (sin_theta - d.x.hypot(d.y)).abs() < 1e-6);
        }
    }

    #[test]
    fn seam_and_poles_are_settled() {
        let (_, phi) = spherical_angles(Vec3::new(1.0, -1e-12, 0.0));
        assert_eq!(phi, 0.0);
        assert!(latlong_from_direction(Vec3::new(1.0, -1e-6, 0.0)).x < 1.0);
        assert!((spherical_angles(-Vec3::Y).1 - 1.5 * PI).abs() < 1e-6);
        assert_eq!(spherical_angles(Vec3::Z), (0.0, 0.0));
        assert!((spherical_angles(-Vec3::Z).0 - PI).abs() < 1e-7);
        // acos of z would round this angle to zero or to 3e-4.
        assert!((spherical_angles(Vec3::new(1e-5, 0.0, 1.0)).0 / 1e-5 - 1.0).abs() < 1e-5);
        assert!(latlong_from_direction(Vec3::ZERO).is_finite());
    }
}
