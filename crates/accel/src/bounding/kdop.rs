//! Discrete oriented polytopes (Kay and Kajiya 1986; Klosowski et al. 1998): slabs in fixed directions.

use super::{Hull, ROUNDING, Volume, line, slab};
use glam::DMat3;
use steradian_math::{DVec3, Vec3};

/// Which directions: half as many as there are planes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Directions {
    /// The axes: a box.
    K6,
    /// The axes and the diagonals through corners.
    K14,
    /// The axes and the diagonals through edges.
    K18,
    /// All of them.
    K26,
}

/// Axes, then corners, then edges of a cube.
const ALL: [DVec3; 13] = [
    DVec3::X,
    DVec3::Y,
    DVec3::Z,
    DVec3::ONE,
    DVec3::new(1.0, 1.0, -1.0),
    DVec3::new(1.0, -1.0, 1.0),
    DVec3::new(-1.0, 1.0, 1.0),
    DVec3::new(1.0, 1.0, 0.0),
    DVec3::new(1.0, -1.0, 0.0),
    DVec3::new(1.0, 0.0, 1.0),
    DVec3::new(1.0, 0.0, -1.0),
    DVec3::new(0.0, 1.0, 1.0),
    DVec3::new(0.0, 1.0, -1.0),
];

impl Directions {
    /// All sets, few directions first.
    pub const SETS: [Self; 4] = [Self::K6, Self::K14, Self::K18, Self::K26];

    /// The directions, not normalised: their coordinates are −1, 0 and 1.
    pub fn get(self) -> impl Iterator<Item = DVec3> {
        let (axes, corners, edges) = match self {
            Self::K6 => (3, 0, 0),
            Self::K14 => (3, 4, 0),
            Self::K18 => (3, 0, 6),
            Self::K26 => (3, 4, 6),
        };
        ALL[..axes].iter().chain(&ALL[3..3 + corners]).chain(&ALL[7..7 + edges]).copied()
    }

    /// The number of planes.
    pub fn planes(self) -> usize {
        2 * self.get().count()
    }
}

/// A k-DOP.
#[derive(Clone, Debug, PartialEq)]
pub struct KDop {
    directions: Directions,
    /// For each direction the least and greatest product with a point.
    slabs: Vec<[f64; 2]>,
}

impl KDop {
    /// Around points; `None` without any, or where one is not finite.
    pub fn around(directions: Directions, points: &[Vec3]) -> Option<Self> {
        if points.is_empty() || points.iter().any(|p| !p.is_finite()) {
            return None;
        }
        // The extent of the points along each direction.
        let slab = |d: DVec3| {
            let heights = points.iter().map(|p| d.dot(p.as_dvec3()));
            heights.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], h| [low.min(h), high.max(h)])
        };
        Some(Self { directions, slabs: directions.get().map(slab).collect() })
    }

    /// The directions and slabs.
    pub fn slabs(&self) -> impl Iterator<Item = (DVec3, [f64; 2])> {
        self.directions.get().zip(self.slabs.iter().copied())
    }

    /// The corners: where three planes meet and no other cuts them off. Some may be there more than once.
    pub fn corners(&self) -> Vec<DVec3> {
        let planes: Vec<(DVec3, f64)> = self.slabs().flat_map(|(d, s)| s.map(|height| (d, height))).collect();
        let mut corners = Vec::new();
        // Intersect every triple of planes and keep the points inside all slabs.
        for i in 0..planes.len() {
            for j in i + 1..planes.len() {
                for k in j + 1..planes.len() {
                    // Coordinates of the directions are integers: a determinant below one half means that the planes
                    // are parallel.
                    let normals = DMat3::from_cols(planes[i].0, planes[j].0, planes[k].0).transpose();
                    if normals.determinant().abs() < 0.5 {
                        continue;
                    }
                    let p = normals.inverse() * DVec3::new(planes[i].1, planes[j].1, planes[k].1);
                    if self.contains(p) {
                        corners.push(p);
                    }
                }
            }
        }
        corners
    }
}

impl Volume for KDop {
    fn contains(&self, p: DVec3) -> bool {
        let slack = 4.0 * ROUNDING * self.slabs.iter().flatten().fold(0.0, |a: f64, b| a.max(b.abs()));
        self.slabs().all(|(d, [low, high])| (low - slack..=high + slack).contains(&d.dot(p)))
    }

    fn intersect(&self, origin: DVec3, direction: DVec3) -> Option<[f64; 2]> {
        let whole = line(origin, direction)?;
        self.slabs().try_fold(whole, |t, (d, s)| slab(t, d.dot(origin), d.dot(direction), s))
    }

    fn overlaps(&self, other: &Self) -> bool {
        // Slabs of equal directions are compared as intervals; more directions would be needed for an exact answer.
        let both = self.slabs.iter().zip(&other.slabs);
        self.directions == other.directions && both.clone().all(|(a, b)| a[0] <= b[1] && b[0] <= a[1])
    }

    fn volume(&self) -> f64 {
        let corners: Vec<Vec3> = self.corners().into_iter().map(|p| p.as_vec3()).collect();
        Hull::around(&corners).map_or(0.0, |hull| hull.volume())
    }
}
