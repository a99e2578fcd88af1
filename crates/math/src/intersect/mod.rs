//! Ray intersections with surfaces, in closed form.
//!
//! Rays and results are `f32`, the arithmetic between is `f64`: products of two `f32` are exact there, so nothing
//! cancels that the input does not already leave open. Directions need not be of unit length. Functions that return one
//! distance count hits in the ray's open interval `(0, t_max)`; those that return two roots return both of the whole
//! line, in order, and [`nearest`] picks.

mod plane;
mod polygon;
mod quadric;
mod sphere;
mod triangle;

pub use plane::{ParametricHit, plane, plane_parametric, plane_point_normal};
pub use polygon::{FillRule, Polygon, is_inside, winding_number};
pub use quadric::{Quadric, ellipsoid, paraboloid};
pub use sphere::sphere;
pub use triangle::{TriangleHit, triangle};

use crate::Ray;

/// The real roots `t0 ≤ t1` of `a t² + 2h t + c`, without cancellation; the one root twice where `a` is zero, `None`
/// where there is no root or every number is one.
#[inline]
pub(crate) fn roots(a: f64, h: f64, c: f64) -> Option<[f64; 2]> {
    roots_with_discriminant(a, h, c, h * h - a * c)
}

/// [`roots`] of `a t² + 2h t + c`, whose discriminant `h² − a c` the caller knows, perhaps better than that
/// difference.
#[inline]
pub(crate) fn roots_with_discriminant(a: f64, h: f64, c: f64, discriminant: f64) -> Option<[f64; 2]> {
    if a == 0.0 {
        let t = -0.5 * c / h;
        return (h != 0.0 && t.is_finite()).then_some([t, t]);
    }
    if discriminant < 0.0 || discriminant.is_nan() {
        return None;
    }
    // The sum of numbers of one sign gives the root of larger size, the product of the roots gives the other.
    let q = -(h + discriminant.sqrt().copysign(h));
    let (t0, t1) = (q / a, if q == 0.0 { 0.0 } else { c / q });
    Some(if t0 <= t1 { [t0, t1] } else { [t1, t0] })
}

/// The smaller of two ordered roots that lies in `(0, t_max)`; from inside, that is the far one.
#[inline]
pub fn nearest(roots: [f32; 2], t_max: f32) -> Option<f32> {
    roots.into_iter().find(|&t| t > 0.0 && t < t_max)
}

/// The distance as `f32` where it lies in the ray's interval.
#[inline]
fn within(t: f64, ray: &Ray) -> Option<f32> {
    let t = t as f32;
    (t > 0.0 && t < ray.t_max).then_some(t)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hash::HashRng;

    #[test]
    fn roots_are_those_that_the_polynomial_was_made_from() {
        let mut rng = HashRng::new(1);
        for _ in 0..10_000 {
            let mut n = || (f64::from(rng.next_f32() - 0.5) * 2000.0).round() / 8.0;
            let (x, y, a) = (n(), n(), n());
            if a == 0.0 {
                continue;
            }
            let (x, y) = (x.min(y), x.max(y));
            let [t0, t1] = roots(a, -0.5 * a * (x + y), a * x * y).expect("real roots");
            let close = |t: f64, r: f64| (t - r).abs() <= 1e-12 * r.abs().max(1.0);
            assert!(t0 <= t1 && close(t0, x) && close(t1, y), "{x} {y}: {t0} {t1}");
        }
    }

    #[test]
    fn the_small_root_keeps_its_digits() {
        // x² − 10⁹x + 1: the textbook formula gives 0 for the small root, 1e-9.
        let [t0, t1] = roots(1.0, -5e8, 1.0).expect("real roots");
        assert!((t0 / 1e-9 - 1.0).abs() < 1e-15 && (t1 / 1e9 - 1.0).abs() < 1e-15);
        assert_eq!(roots(0.0, 1.0, -6.0), Some([3.0, 3.0]));
        assert_eq!(roots(1.0, 0.0, 0.0), Some([0.0, 0.0]));
        assert_eq!(roots(1.0, 0.0, -4.0), Some([-2.0, 2.0]));
        assert_eq!(roots(-1.0, 0.0, 4.0), Some([-2.0, 2.0]));
        for (a, h, c) in [(1.0, 0.0, 1.0), (0.0, 0.0, 1.0), (0.0, 0.0, 0.0), (f64::NAN, 0.5, 1.0)] {
            assert_eq!(roots(a, h, c), None);
        }
    }

    #[test]
    fn nearest_skips_what_lies_behind_or_beyond() {
        assert_eq!(nearest([1.0, 2.0], f32::INFINITY), Some(1.0));
        assert_eq!(nearest([-1.0, 2.0], f32::INFINITY), Some(2.0));
        assert_eq!(nearest([-1.0, 2.0], 1.5), None);
        assert_eq!(nearest([-2.0, -1.0], f32::INFINITY), None);
    }
}
