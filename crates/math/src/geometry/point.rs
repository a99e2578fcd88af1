//! Points as a type of their own: what makes no sense for points does not compile.
//!
//! `P − P` is a vector, `P + v` a point; sums of points exist only as combinations, with weights that add up to one (a
//! point) or to zero (a vector).
//!
//! ```
//! use steradian_math::{DVec3, geometry::Point3};
//! let (p, q) = (Point3::new(1.0, 2.0, 3.0), Point3::new(3.0, 2.0, 1.0));
//! assert_eq!(p + (q - p), q);
//! ```
//!
//! ```compile_fail
//! use steradian_math::geometry::Point3;
//! let (p, q) = (Point3::new(1.0, 2.0, 3.0), Point3::new(3.0, 2.0, 1.0));
//! let nonsense = p + q;
//! ```

use glam::DVec3;
use std::ops::{Add, AddAssign, Sub, SubAssign};

/// A place in space, given by its Cartesian coordinates.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Point3 {
    /// First coordinate.
    pub x: f64,
    /// Second coordinate.
    pub y: f64,
    /// Third coordinate.
    pub z: f64,
}

impl Point3 {
    /// The origin of the coordinate system.
    pub const ORIGIN: Self = Self::new(0.0, 0.0, 0.0);

    /// From coordinates.
    pub const fn new(x: f64, y: f64, z: f64) -> Self {
        Self { x, y, z }
    }

    /// The vector from the origin.
    pub const fn to_vector(self) -> DVec3 {
        DVec3::new(self.x, self.y, self.z)
    }

    /// The point at a vector from the origin.
    pub const fn from_vector(v: DVec3) -> Self {
        Self::new(v.x, v.y, v.z)
    }

    /// Distance between two points.
    pub fn distance(self, other: Self) -> f64 {
        (self - other).length()
    }

    /// `(1 − t)·self + t·other`.
    pub fn lerp(self, other: Self, t: f64) -> Self {
        self + (other - self) * t
    }

    /// The affine combination `Σ λᵢ Pᵢ`; `None` where the weights do not add up to one (to 1e-9 of their sizes).
    pub fn combination(terms: &[(f64, Self)]) -> Option<Self> {
        weights_sum_to(terms, 1.0).then(|| Self::from_vector(weighted_sum(terms)))
    }

    /// The vector `Σ λᵢ Pᵢ` of weights that add up to zero: it does not depend on the origin. `None` for other weights.
    pub fn difference(terms: &[(f64, Self)]) -> Option<DVec3> {
        weights_sum_to(terms, 0.0).then(|| weighted_sum(terms))
    }
}

fn weights_sum_to(terms: &[(f64, Point3)], sum: f64) -> bool {
    let size: f64 = terms.iter().map(|(w, _)| w.abs()).sum();
    (terms.iter().map(|(w, _)| w).sum::<f64>() - sum).abs() <= 1e-9 * size.max(1.0)
}

fn weighted_sum(terms: &[(f64, Point3)]) -> DVec3 {
    terms.iter().map(|(w, p)| *w * p.to_vector()).sum()
}

impl Sub for Point3 {
    type Output = DVec3;
    fn sub(self, o: Self) -> DVec3 {
        self.to_vector() - o.to_vector()
    }
}

impl Add<DVec3> for Point3 {
    type Output = Self;
    fn add(self, v: DVec3) -> Self {
        Self::from_vector(self.to_vector() + v)
    }
}

impl Sub<DVec3> for Point3 {
    type Output = Self;
    fn sub(self, v: DVec3) -> Self {
        Self::from_vector(self.to_vector() - v)
    }
}

impl AddAssign<DVec3> for Point3 {
    fn add_assign(&mut self, v: DVec3) {
        *self = *self + v;
    }
}

impl SubAssign<DVec3> for Point3 {
    fn sub_assign(&mut self, v: DVec3) {
        *self = *self - v;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::random::Random;

    #[test]
    fn affine_identities() {
        let mut r = Random::new(1);
        for _ in 0..1000 {
            let (p, q, s) = (r.point(), r.point(), r.point());
            let (v, w) = (r.vector(), r.vector());
            assert!(((p + v) + w).distance(p + (v + w)) < 1e-14);
            assert!(((p - q) + (q - s) - (p - s)).length() < 1e-14);
            assert!((p + (q - p)).distance(q) < 1e-15 && p + DVec3::ZERO == p);
            assert!(((p + v) - v).distance(p) < 1e-15);
            assert!(p.lerp(q, 0.5).distance(q.lerp(p, 0.5)) < 1e-15);
        }
    }

    #[test]
    fn combinations_do_not_depend_on_the_origin() {
        let mut r = Random::new(2);
        for _ in 0..1000 {
            let (p, q, s, shift) = (r.point(), r.point(), r.point(), r.vector() * 10.0);
            let (a, b) = (r.number(), r.number());
            let moved = |terms: &[(f64, Point3)]| terms.iter().map(|&(w, p)| (w, p + shift)).collect::<Vec<_>>();
            let point = [(a, p), (b, q), (1.0 - a - b, s)];
            let here = Point3::combination(&point).expect("weights of one");
            assert!(Point3::combination(&moved(&point)).expect("weights of one").distance(here + shift) < 1e-13);
            let vector = [(a, p), (b, q), (-a - b, s)];
            let here = Point3::difference(&vector).expect("weights of zero");
            assert!((Point3::difference(&moved(&vector)).expect("weights of zero") - here).length() < 1e-13);
            assert_eq!(Point3::combination(&vector), None);
            assert_eq!(Point3::difference(&point), None);
        }
        assert_eq!(Point3::combination(&[]), None);
        assert_eq!(Point3::combination(&[(f64::NAN, Point3::ORIGIN)]), None);
    }
}
