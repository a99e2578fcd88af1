//! Convex polygons, and what a plane makes of them.

use super::Plane;
use crate::spatial::items::Items;
use steradian_math::{DVec3, Vec3};

/// A part of a primitive. Of user primitives all corners of the box, which are never cut.
#[derive(Clone, Debug)]
pub(super) struct Fragment {
    pub slot: u32,
    pub points: Vec<DVec3>,
    is_solid: bool,
}

/// On which side of a plane something is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    /// In the plane.
    On,
    /// On its back.
    Behind,
    /// On its front.
    Front,
    /// On both sides.
    Both,
}

impl Fragment {
    /// A whole primitive.
    pub fn new(items: &Items, slot: u32) -> Self {
        let item = &items.list[slot as usize];
        let bounds = item.bounds();
        let points = if item.is_user() {
            (0..8).map(|i| bounds.corner(i).as_dvec3()).collect()
        } else {
            item.corners.map(Vec3::as_dvec3).to_vec()
        };
        Self { slot, points, is_solid: item.is_user() }
    }

    /// The plane of a polygon; `None` where it has no area.
    pub fn plane(&self) -> Option<Plane> {
        if self.is_solid {
            return None;
        }
        let [a, b, c] = [self.points[0], self.points[1], self.points[2]];
        let normal = (b - a).cross(c - a).try_normalize()?;
        // Through the middle, so that no corner is favoured.
        let plane = Plane { normal, offset: normal.dot((a + b + c) / 3.0) };
        plane.offset.is_finite().then_some(plane)
    }

    /// Side of the plane; points within the tolerance count as in the plane.
    pub fn side(&self, plane: &Plane, tolerance: f64) -> Side {
        // The least and greatest height over the plane classify the fragment.
        let heights = self.points.iter().map(|&p| plane.height(p));
        let (low, high) = heights.fold((0.0_f64, 0.0_f64), |(low, high), h| (low.min(h), high.max(h)));
        match (low < -tolerance, high > tolerance) {
            (true, true) => Side::Both,
            (true, false) => Side::Behind,
            (false, true) => Side::Front,
            // A box is more than a polygon, however flat.
            (false, false) if self.is_solid => Side::Both,
            (false, false) => Side::On,
        }
    }

    /// The parts behind and in front of a plane that cuts it (Sutherland and Hodgman 1974).
    pub fn split(self, plane: &Plane, tolerance: f64) -> [Self; 2] {
        if self.is_solid {
            return [self.clone(), self];
        }
        let part = |side: f64| {
            let height = |p: DVec3| {
                let h = plane.height(p) * side;
                if h.abs() <= tolerance { 0.0 } else { h }
            };
            let n = self.points.len();
            let mut points = Vec::with_capacity(n + 1);
            // Keep the vertices on this side, and add the point where an edge crosses the plane.
            for (i, &p) in self.points.iter().enumerate() {
                let q = self.points[(i + 1) % n];
                let (a, b) = (height(p), height(q));
                if a >= 0.0 {
                    points.push(p);
                }
                if a * b < 0.0 {
                    points.push(p + (q - p) * (a / (a - b)));
                }
            }
            Self { slot: self.slot, points, is_solid: false }
        };
        [part(-1.0), part(1.0)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spatial::testing;
    use steradian_math::hash::HashRng;

    fn area(points: &[DVec3]) -> f64 {
        (2..points.len()).map(|i| (points[i - 1] - points[0]).cross(points[i] - points[0]).length() / 2.0).sum()
    }

    #[test]
    fn parts_have_the_area_of_the_whole() {
        let items = testing::items(&testing::soup(500, 0.5, 91));
        let mut rng = HashRng::new(92);
        let mut cut = 0;
        for slot in 0..items.list.len() as u32 {
            let whole = Fragment::new(&items, slot);
            let normal = testing::direction(&mut rng).as_dvec3().normalize();
            let plane = Plane { normal, offset: normal.dot(whole.points[0] * 0.4 + whole.points[1] * 0.6) };
            if whole.side(&plane, 1e-9) != Side::Both {
                continue;
            }
            cut += 1;
            let expected = area(&whole.points);
            let parts = whole.split(&plane, 1e-9);
            assert_eq!(parts[0].side(&plane, 1e-8), Side::Behind);
            assert_eq!(parts[1].side(&plane, 1e-8), Side::Front);
            let sum = area(&parts[0].points) + area(&parts[1].points);
            assert!((sum - expected).abs() < 1e-9 * (1.0 + expected), "{sum} {expected}");
        }
        assert!(cut > 100, "{cut}");
    }
}
