//! Bounding volumes of chunks.

use steradian_accel::bounding::{Directions, Hull, KDop, OrientedBox, Sphere};
use steradian_math::{Bounds3, DVec3, Vec3};

/// Kind of bounding volume.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BoundsKind {
    /// Box along the axes of the world.
    Aabb,
    /// Ritter's sphere.
    Sphere,
    /// Box along the principal axes of the points.
    Obb,
    /// Polytope of 14 planes.
    KDop,
    /// Convex hull.
    Hull,
}

/// A convex volume in the world: all points within `radius` of the convex hull of `corners`.
#[derive(Clone, Debug, PartialEq)]
pub struct Bounding {
    /// Corners; never empty.
    pub corners: Vec<DVec3>,
    /// Distance around them.
    pub radius: f64,
}

impl Bounding {
    /// Volume of a kind around points; `None` without points, or where one is not finite.
    pub fn around(kind: BoundsKind, points: &[Vec3]) -> Option<Self> {
        if points.is_empty() || points.iter().any(|p| !p.is_finite()) {
            return None;
        }
        let of_corners = |corners| Self { corners, radius: 0.0 };
        let made = match kind {
            BoundsKind::Aabb => None,
            BoundsKind::Sphere => Sphere::ritter(points).map(|s| Self { corners: vec![s.center], radius: s.radius }),
            BoundsKind::Obb => OrientedBox::principal(points).map(|b| of_corners(corners_of(&b))),
            BoundsKind::KDop => KDop::around(Directions::K14, points).map(|k| of_corners(k.corners())),
            // Points may stick out of the lattice on which the hull was found.
            BoundsKind::Hull => {
                Hull::around(points).map(|h| Self { corners: h.vertices().to_vec(), radius: h.error() })
            }
        };
        // Degenerate points may leave a volume without corners: the box holds them all.
        made.filter(|made| !made.corners.is_empty()).or_else(|| {
            let bounds = Bounds3::from_points(points.iter().copied());
            Some(of_corners((0..8).map(|i| bounds.corner(i).as_dvec3()).collect()))
        })
    }

    /// Corners of a polytope that contains the volume: those of cubes where it is round.
    pub fn outer_corners(&self) -> impl Iterator<Item = DVec3> {
        let count = if self.radius > 0.0 { 8 } else { 1 };
        let sign = |i: usize, axis: usize| if i >> axis & 1 == 0 { -1.0 } else { 1.0 };
        let offset = move |i: usize| DVec3::new(sign(i, 0), sign(i, 1), sign(i, 2)) * self.radius;
        self.corners.iter().flat_map(move |p| (0..count).map(move |i| *p + offset(i)))
    }
}

fn corners_of(of: &OrientedBox) -> Vec<DVec3> {
    let corner = |i: usize| (0..3).map(|axis| of.axes[axis] * of.extent[axis][i >> axis & 1]).sum();
    (0..8).map(corner).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::culling::BOUNDS;

    /// The support of every kind reaches as far as the points in all directions.
    #[test]
    fn volumes_hold_their_points() {
        let turn = |i: u32, step: f32| (i as f32 * step).fract() - 0.5;
        let points: Vec<Vec3> =
            (0..300).map(|i| Vec3::new(turn(i, 0.618) * 4.0, turn(i, 0.755), turn(i, 0.57) + 10.0)).collect();
        for (name, kind) in BOUNDS {
            for points in [&points[..], &points[..1], &points[..2], &points[..3]] {
                let volume = Bounding::around(kind, points).expect(name);
                for i in 0..100 {
                    let d = DVec3::new(f64::from(turn(i, 0.31)), f64::from(turn(i, 0.77)), f64::from(turn(i, 0.13)));
                    let reach = volume.corners.iter().map(|p| p.dot(d)).fold(f64::MIN, f64::max);
                    let most = points.iter().map(|p| p.as_dvec3().dot(d)).fold(f64::MIN, f64::max);
                    assert!(reach + volume.radius * d.length() > most - 1e-9, "{name} {d}");
                }
            }
        }
        assert_eq!(Bounding::around(BoundsKind::Hull, &[]), None);
        assert_eq!(Bounding::around(BoundsKind::Aabb, &[Vec3::NAN]), None);
    }
}
