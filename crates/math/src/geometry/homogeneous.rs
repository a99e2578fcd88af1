//! Homogeneous coordinates: points of projective space, the ideal ones (directions) among them.

use super::Point3;
use glam::{DMat4, DVec3, DVec4};

/// A point of projective space: `[x, y, z, w]` and all its multiples but zero. With `w = 0` it is ideal: the common
/// point at infinity of all lines of one direction.
#[derive(Clone, Copy, Debug)]
pub struct HomogeneousPoint(DVec4);

impl HomogeneousPoint {
    /// From any coordinates but four zeros, which name no point; non-finite ones are refused too.
    pub fn new(coordinates: DVec4) -> Option<Self> {
        (coordinates.is_finite() && coordinates != DVec4::ZERO).then_some(Self(coordinates))
    }

    /// An ordinary point, with `w = 1`.
    pub fn from_point(p: Point3) -> Option<Self> {
        Self::new(p.to_vector().extend(1.0))
    }

    /// The ideal point of a direction; none for the zero vector.
    pub fn ideal(direction: DVec3) -> Option<Self> {
        Self::new(direction.extend(0.0))
    }

    /// One of its coordinate quadruples.
    pub fn coordinates(&self) -> DVec4 {
        self.0
    }

    /// True if it lies at infinity.
    pub fn is_ideal(&self) -> bool {
        self.0.w == 0.0
    }

    /// The ordinary point; `None` for an ideal one, and for one so far that its coordinates overflow.
    pub fn to_point(&self) -> Option<Point3> {
        let p = self.0.truncate() / self.0.w;
        p.is_finite().then_some(Point3::from_vector(p))
    }

    /// True if both are the same point: proportional quadruples, to a relative error of 1e-12.
    pub fn is_same(&self, other: &Self) -> bool {
        let (a, b) = (scaled(self.0), scaled(other.0));
        (a - b).length() < 1e-12 || (a + b).length() < 1e-12
    }

    /// The image under a projective map; `None` where a singular map loses the point.
    pub fn transformed(&self, m: &DMat4) -> Option<Self> {
        Self::new(*m * self.0)
    }
}

/// To unit length, by way of the largest entry so that nothing overflows.
fn scaled(v: DVec4) -> DVec4 {
    (v / v.abs().max_element()).normalize()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::random::Random;

    #[test]
    fn multiples_are_the_same_point() {
        let mut r = Random::new(9);
        for _ in 0..1000 {
            let p = r.point();
            let h = HomogeneousPoint::from_point(p).expect("a point");
            let factor = if r.number() > 0.0 { 1e3 } else { -1e-3 } * (1.5 + r.number());
            let multiple = HomogeneousPoint::new(h.coordinates() * factor).expect("a point");
            assert!(h.is_same(&multiple));
            assert!(multiple.to_point().expect("ordinary").distance(p) < 1e-14);
            let other = HomogeneousPoint::from_point(p + DVec3::X * 1e-6).expect("a point");
            assert!(!h.is_same(&other));
            // A projective map acts on points, not on quadruples.
            let m = DMat4::from_cols_array(&std::array::from_fn(|_| r.number()));
            if let (Some(a), Some(b)) = (h.transformed(&m), multiple.transformed(&m)) {
                assert!(a.is_same(&b));
            }
        }
    }

    #[test]
    fn ideal_points_and_forbidden_ones() {
        let x = HomogeneousPoint::ideal(DVec3::X).expect("a direction");
        assert!(x.is_ideal() && x.to_point().is_none());
        assert!(x.is_same(&HomogeneousPoint::ideal(-DVec3::X * 5.0).expect("a direction")), "both ends are one point");
        assert!(HomogeneousPoint::ideal(DVec3::ZERO).is_none());
        assert!(HomogeneousPoint::new(DVec4::ZERO).is_none());
        assert!(HomogeneousPoint::new(DVec4::NAN).is_none());
        // Affine maps keep ideal points ideal; translation does not move them.
        let moved = x.transformed(&DMat4::from_translation(DVec3::new(1.0, 2.0, 3.0))).expect("a point");
        assert!(moved.is_same(&x));
        let huge = HomogeneousPoint::new(DVec4::splat(1e308)).expect("a point");
        assert!(huge.is_same(&HomogeneousPoint::new(DVec4::ONE).expect("a point")));
    }
}
