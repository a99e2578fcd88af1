//! The equal-area octahedral map between the square and the sphere (Clarberg 2008), in the orientation of pbrt-v4's
//! environment images: the centre of the square is `+z`, its four corners are `−z`, `u` grows with `x` and `v` with
//! `y`.

use crate::{Vec2, Vec3};
use std::f32::consts::{FRAC_2_PI, FRAC_PI_4};

/// The direction of a point of the square; areas keep their proportion (`4π` sr to 1). The point is clamped to the
/// square.
#[inline]
pub fn equal_area_square_to_sphere(u: Vec2) -> Vec3 {
    let p = 2.0 * u.clamp(Vec2::ZERO, Vec2::ONE) - Vec2::ONE;
    let q = p.abs();
    // The diamond |x| + |y| < 1 is the upper hemisphere; r is the distance from the nearer pole.
    let to_diagonal = 1.0 - (q.x + q.y);
    let r = 1.0 - to_diagonal.abs();
    let phi = if r == 0.0 { 0.0 } else { ((q.y - q.x) / r + 1.0) * FRAC_PI_4 };
    let (sin, cos) = phi.sin_cos();
    let r2 = r * r;
    let sin_theta = r * (2.0 - r2).sqrt();
    Vec3::new(cos.copysign(p.x) * sin_theta, sin.copysign(p.y) * sin_theta, (1.0 - r2).copysign(to_diagonal))
}

/// The point of the square of a unit direction: the inverse of [`equal_area_square_to_sphere`].
#[inline]
pub fn equal_area_sphere_to_square(d: Vec3) -> Vec2 {
    let a = d.abs();
    // r = √(1 − |z|), without the cancellation near the poles.
    let r = ((a.x * a.x + a.y * a.y) / (1.0 + a.z)).sqrt().min(1.0);
    let (lo, hi) = (a.x.min(a.y), a.x.max(a.y));
    let octant = if hi == 0.0 { 0.0 } else { (lo / hi).atan() * FRAC_2_PI };
    let phi = if a.x < a.y { 1.0 - octant } else { octant };
    let v = phi * r;
    let u = r - v;
    // The lower hemisphere is folded out over the diagonal.
    let (u, v) = if d.z < 0.0 { (1.0 - v, 1.0 - u) } else { (u, v) };
    Vec2::new(0.5 * (u.copysign(d.x) + 1.0), 0.5 * (v.copysign(d.y) + 1.0)).clamp(Vec2::ZERO, Vec2::ONE)
}

/// Brings a point at most one square outside back to the point of the square that stands for the same direction, so
/// that filters can reach over the seams.
#[inline]
pub fn wrap_equal_area_square(p: Vec2) -> Vec2 {
    let mut p = p;
    if !(0.0..=1.0).contains(&p.x) {
        p = Vec2::new(if p.x < 0.0 { -p.x } else { 2.0 - p.x }, 1.0 - p.y);
    }
    if !(0.0..=1.0).contains(&p.y) {
        p = Vec2::new(1.0 - p.x, if p.y < 0.0 { -p.y } else { 2.0 - p.y });
    }
    p
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hash::HashRng;

    #[test]
    fn the_orientation_is_that_of_environment_images() {
        // Evaluated in double precision from Clarberg's formula as pbrt-v4 orients it.
        let known = [
            ([0.5, 0.5], [0.0, 0.0, 1.0]),
            ([0.0, 0.0], [0.0, 0.0, -1.0]),
            ([1.0, 0.5], [1.0, 0.0, 0.0]),
            ([0.75, 0.5], [0.661_437_8, 0.0, 0.75]),
            ([0.9, 0.6], [0.951_056_5, 0.309_017, 0.0]),
            ([0.1, 0.3], [-0.861_935_5, -0.357_025_4, -0.36]),
            ([0.2, 0.95], [-0.204_395_5, 0.629_064_8, -0.75]),
            ([0.55, 0.48], [0.177_506_5, -0.085_482_6, 0.9804]),
            ([0.97, 0.03], [0.119_567_2, -0.119_567_2, -0.9856]),
            ([0.5, 0.8], [0.0, 0.768_374_9, 0.64]),
        ];
        for (uv, d) in known {
            let (uv, d) = (Vec2::from(uv), Vec3::from(d));
            assert!((equal_area_square_to_sphere(uv) - d).length() < 2e-6, "{uv}");
            if uv != Vec2::ZERO {
                assert!((equal_area_sphere_to_square(d.normalize()) - uv).length() < 2e-6, "{d}");
            }
        }
    }

    #[test]
    fn the_maps_are_inverse() {
        let mut rng = HashRng::new(3);
        for _ in 0..100_000 {
            let d = crate::warp::uniform_sphere(Vec2::new(rng.next_f32(), rng.next_f32())).normalize();
            let uv = equal_area_sphere_to_square(d);
            assert!((0.0..=1.0).contains(&uv.x) && (0.0..=1.0).contains(&uv.y));
            assert!((equal_area_square_to_sphere(uv) - d).length() < 2e-6, "{d}");
        }
        for d in [Vec3::X, Vec3::Y, Vec3::Z, -Vec3::X, -Vec3::Y, -Vec3::Z] {
            assert!((equal_area_square_to_sphere(equal_area_sphere_to_square(d)) - d).length() < 1e-6);
        }
    }

    #[test]
    fn wrapping_continues_over_every_edge() {
        for t in [0.07, 0.3, 0.5, 0.81] {
            let e = 1e-4;
            for p in [Vec2::new(-e, t), Vec2::new(1.0 + e, t), Vec2::new(t, -e), Vec2::new(t, 1.0 + e)] {
                let q = wrap_equal_area_square(p);
                assert!((0.0..=1.0).contains(&q.x) && (0.0..=1.0).contains(&q.y));
                let (near, far) = (equal_area_square_to_sphere(p), equal_area_square_to_sphere(q));
                assert!((near - far).length() < 2e-3, "{p}");
            }
        }
    }
}
