//! Axis-aligned bounding boxes (M58).

use crate::Vec3;

/// An axis-aligned box, `min ≤ max` on every axis unless it is [`Bounds3::EMPTY`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds3 {
    /// Smallest corner.
    pub min: Vec3,
    /// Largest corner.
    pub max: Vec3,
}

impl Default for Bounds3 {
    fn default() -> Self {
        Self::EMPTY
    }
}

impl Bounds3 {
    /// The box that contains nothing: the neutral element of [`Bounds3::union`].
    pub const EMPTY: Self = Self { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };

    /// The smallest box that contains both points.
    pub fn new(a: Vec3, b: Vec3) -> Self {
        Self { min: a.min(b), max: a.max(b) }
    }

    /// The smallest box that contains every point; [`Bounds3::EMPTY`] for none.
    pub fn from_points(points: impl IntoIterator<Item = Vec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, |b, p| b.union_point(p))
    }

    /// The smallest box that contains both boxes.
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// The smallest box that contains this one and a point.
    pub fn union_point(self, p: Vec3) -> Self {
        Self { min: self.min.min(p), max: self.max.max(p) }
    }

    /// Whether the box contains no point.
    pub fn is_empty(&self) -> bool {
        !(self.min.x <= self.max.x && self.min.y <= self.max.y && self.min.z <= self.max.z)
    }

    /// From the smallest to the largest corner.
    pub fn diagonal(&self) -> Vec3 {
        self.max - self.min
    }

    /// The middle of the box.
    pub fn center(&self) -> Vec3 {
        self.min * 0.5 + self.max * 0.5
    }

    /// Surface area; zero for an empty box.
    pub fn area(&self) -> f32 {
        if self.is_empty() {
            return 0.0;
        }
        let d = self.diagonal();
        2.0 * (d.x * d.y + d.y * d.z + d.z * d.x)
    }

    /// The axis (0, 1, 2) of greatest extent.
    pub fn longest_axis(&self) -> usize {
        let d = self.diagonal();
        if d.x >= d.y && d.x >= d.z {
            0
        } else if d.y >= d.z {
            1
        } else {
            2
        }
    }

    /// One of the eight corners; bit `a` of `i` picks the maximum on axis `a`.
    pub fn corner(&self, i: usize) -> Vec3 {
        Vec3::new(
            if i & 1 == 0 { self.min.x } else { self.max.x },
            if i & 2 == 0 { self.min.y } else { self.max.y },
            if i & 4 == 0 { self.min.z } else { self.max.z },
        )
    }

    /// The sphere around the centre that contains the box: centre and radius (0 for an empty box).
    pub fn bounding_sphere(&self) -> (Vec3, f32) {
        if self.is_empty() {
            return (Vec3::ZERO, 0.0);
        }
        let c = self.center();
        (c, (self.max - c).length())
    }

    /// Whether the point lies in the closed box.
    pub fn contains(&self, p: Vec3) -> bool {
        p.cmpge(self.min).all() && p.cmple(self.max).all()
    }

    /// Slab test of `[0, t_max]`: the interval of the ray within the box, or `None`.
    ///
    /// The interval starts as `[0, t_max]` before the first axis (the lectures reset it per axis), and a NaN that comes from
    /// `0·∞` (a ray within a slab plane) leaves it as it is. The far distance is widened by `1 + 2γ(3)` so that no hit is lost
    /// to rounding (Ize 2013).
    pub fn intersect(&self, origin: Vec3, inv_direction: Vec3, t_max: f32) -> Option<(f32, f32)> {
        const WIDEN: f32 = 1.0 + 2.0 * (3.0 * f32::EPSILON * 0.5) / (1.0 - 3.0 * f32::EPSILON * 0.5);
        let (mut t0, mut t1) = (0.0_f32, t_max);
        for a in 0..3 {
            let (mut near, mut far) =
                ((self.min[a] - origin[a]) * inv_direction[a], (self.max[a] - origin[a]) * inv_direction[a]);
            if near > far {
                std::mem::swap(&mut near, &mut far);
            }
            far *= WIDEN;
            t0 = if near > t0 { near } else { t0 };
            t1 = if far < t1 { far } else { t1 };
            if t0 > t1 {
                return None;
            }
        }
        Some((t0, t1))
    }
}
