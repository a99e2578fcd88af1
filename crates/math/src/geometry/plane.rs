//! Planes in all their forms: point and normal, implicit, Hesse, determinant, parametric, plane coordinates.

use super::{Point3, homogeneous::HomogeneousPoint};
use glam::{DMat3, DMat4, DVec3, DVec4};

/// A plane of projective space by its plane coordinates; all multiples but zero are the same plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    /// `[a, b, c, d]` of `a x + b y + c z + d = 0`; `(a, b, c)` is a normal.
    pub coordinates: DVec4,
}

impl Plane {
    /// The plane at infinity, on which all ideal points lie.
    pub const IDEAL: Self = Self { coordinates: DVec4::W };

    /// From plane coordinates; four zeros name no plane.
    pub fn new(coordinates: DVec4) -> Option<Self> {
        (coordinates.is_finite() && coordinates != DVec4::ZERO).then_some(Self { coordinates })
    }

    /// `⟨x − p, n⟩ = 0`; `None` for a zero normal.
    pub fn from_point_normal(p: Point3, n: DVec3) -> Option<Self> {
        (n != DVec3::ZERO).then(|| Self::new(n.extend(-n.dot(p.to_vector())))).flatten()
    }

    /// `p + s u + t v`; `None` where `u` and `v` are dependent. The normal is `u × v`.
    pub fn from_spanning(p: Point3, u: DVec3, v: DVec3) -> Option<Self> {
        Self::from_point_normal(p, u.cross(v))
    }

    /// The plane through three points, which turn counter-clockwise seen from the side of the normal; `None` for
    /// collinear ones.
    pub fn through(p: Point3, q: Point3, r: Point3) -> Option<Self> {
        Self::from_spanning(p, q - p, r - p)
    }

    /// The plane through three homogeneous points: the cofactors of the determinant `|x; p; q; r|`. `None` for
    /// dependent ones.
    pub fn join(p: &HomogeneousPoint, q: &HomogeneousPoint, r: &HomogeneousPoint) -> Option<Self> {
        Self::new(cofactors(p.coordinates(), q.coordinates(), r.coordinates()))
    }

    /// The point that lies on three planes (ideal where they are parallel to one line); `None` where they share more
    /// than a point.
    pub fn meet(&self, q: &Self, r: &Self) -> Option<HomogeneousPoint> {
        HomogeneousPoint::new(cofactors(self.coordinates, q.coordinates, r.coordinates))
    }

    /// The Hesse normal form: the same plane with a unit normal, so that [`Plane::value`] is the signed distance.
    /// `None` for the ideal plane.
    pub fn hesse(&self) -> Option<Self> {
        let l = self.coordinates.truncate().length();
        (l > 0.0).then_some(())?;
        Self::new(self.coordinates / l)
    }

    /// `a x + b y + c z + d`: positive in the half-space that the normal points to.
    pub fn value(&self, p: Point3) -> f64 {
        self.coordinates.dot(p.to_vector().extend(1.0))
    }

    /// True if a homogeneous point lies on the plane, to 1e-12 of the sizes of the coordinates.
    pub fn contains(&self, p: &HomogeneousPoint) -> bool {
        let x = p.coordinates();
        self.coordinates.dot(x).abs() <= 1e-12 * self.coordinates.length() * x.length()
    }

    /// The parametric form `p + s u + t v`: the foot of the perpendicular from the origin and two orthonormal vectors
    /// with `u × v` the unit normal. `None` for the ideal plane.
    pub fn parametric(&self) -> Option<(Point3, DVec3, DVec3)> {
        let h = self.hesse()?.coordinates;
        let n = h.truncate();
        let (u, v) = n.any_orthonormal_pair();
        Some((Point3::from_vector(-h.w * n), u, v))
    }
}

/// Six times the signed volume of the tetrahedron `x p q r`: zero exactly on the plane through `p`, `q`, `r`.
pub fn coplanarity(x: Point3, p: Point3, q: Point3, r: Point3) -> f64 {
    let row = |p: Point3| p.to_vector().extend(1.0);
    DMat4::from_cols(row(x), row(p), row(q), row(r)).determinant()
}

/// The 4-vector orthogonal to three others, by the cofactors of their matrix: the product behind join and meet.
fn cofactors(a: DVec4, b: DVec4, c: DVec4) -> DVec4 {
    let minor = |i: usize, j: usize, k: usize| {
        DMat3::from_cols(DVec3::new(a[i], a[j], a[k]), DVec3::new(b[i], b[j], b[k]), DVec3::new(c[i], c[j], c[k]))
            .determinant()
    };
    DVec4::new(minor(1, 2, 3), -minor(0, 2, 3), minor(0, 1, 3), -minor(0, 1, 2))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::random::Random;

    fn ordinary(p: Point3) -> HomogeneousPoint {
        HomogeneousPoint::from_point(p).expect("finite")
    }

    #[test]
    fn all_forms_describe_the_same_plane() {
        let mut r = Random::new(13);
        for _ in 0..1000 {
            let (p, q, s, x) = (r.point(), r.point(), r.point(), r.point());
            let n = (q - p).cross(s - p);
            if n.length() < 0.1 {
                continue;
            }
            let forms = [
                Plane::through(p, q, s).expect("a plane"),
                Plane::from_point_normal(q, n * -3.0).expect("a plane"),
                Plane::from_spanning(s, q - p, s - q).expect("a plane"),
                Plane::join(&ordinary(p), &ordinary(q), &ordinary(s)).expect("a plane"),
            ];
            let distance = n.dot(x - p) / n.length();
            assert!((coplanarity(x, p, q, s).abs() - distance.abs() * n.length()).abs() < 1e-13);
            for plane in forms {
                let h = plane.hesse().expect("ordinary");
                assert!((h.value(x).abs() - distance.abs()).abs() < 1e-12);
                let (foot, u, v) = plane.parametric().expect("ordinary");
                let y = foot + u * (r.number() * 10.0) + v * (r.number() * 10.0);
                assert!(h.value(y).abs() < 1e-11 && coplanarity(y, p, q, s).abs() < 1e-10);
                assert!((u.cross(v) - h.coordinates.truncate()).length() < 1e-12);
                // The foot is the point nearest to the origin.
                assert!(foot.to_vector().dot(u).abs() < 1e-12 && foot.to_vector().dot(v).abs() < 1e-12);
            }
            assert!((forms[0].hesse().expect("ordinary").value(x) - distance).abs() < 1e-12, "the side of the normal");
        }
    }

    #[test]
    fn join_and_meet_are_dual() {
        let mut r = Random::new(14);
        for _ in 0..1000 {
            let x = r.point();
            let planes: [Plane; 3] =
                std::array::from_fn(|_| Plane::from_point_normal(x, r.direction()).expect("a plane"));
            let normals = planes.map(|p| p.coordinates.truncate());
            if crate::geometry::vector::determinant(normals[0], normals[1], normals[2]).abs() < 0.05 {
                continue;
            }
            let back = planes[0].meet(&planes[1], &planes[2]).expect("a point");
            assert!(back.to_point().expect("ordinary").distance(x) < 1e-12);
            assert!(planes.iter().all(|p| p.contains(&back)));
        }
    }

    #[test]
    fn ideal_elements_and_degenerate_input() {
        let ideal = |v| HomogeneousPoint::ideal(v).expect("a direction");
        let at_infinity = Plane::join(&ideal(DVec3::X), &ideal(DVec3::Y), &ideal(DVec3::Z)).expect("a plane");
        assert!(at_infinity.coordinates.truncate() == DVec3::ZERO && at_infinity.coordinates.w != 0.0);
        assert!(Plane::IDEAL.contains(&ideal(DVec3::ONE)) && !Plane::IDEAL.contains(&ordinary(Point3::ORIGIN)));
        assert_eq!(Plane::IDEAL.hesse(), None);
        // Three planes through one direction meet in its ideal point.
        let walls = [DVec3::X, DVec3::Y, DVec3::new(1.0, 1.0, 0.0)];
        let [a, b, c] = walls.map(|n| {
            Plane::from_point_normal(Point3::new(1.0, 2.0, 3.0) + n * n.length_squared(), n).expect("a plane")
        });
        assert!(a.meet(&b, &c).expect("a point").is_same(&ideal(DVec3::Z)));
        assert!(a.meet(&a, &b).is_none());
        let p = Point3::new(1.0, 1.0, 1.0);
        assert_eq!(Plane::through(p, p + DVec3::X, p + DVec3::X * 2.0), None);
        assert_eq!(Plane::new(DVec4::ZERO), None);
    }
}
