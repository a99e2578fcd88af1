//! Axis-aligned bounding boxes.

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

    /// True if the box contains no point.
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

    /// True if the point lies in the closed box.
    pub fn contains(&self, p: Vec3) -> bool {
        p.cmpge(self.min).all() && p.cmple(self.max).all()
    }

    /// Slab test of `[0, t_max]`: the interval of the ray within the box, or `None`.
    ///
    /// The interval starts as `[0, t_max]` before the first axis (the lectures reset it per axis), and a NaN that comes
    /// from `0·∞` (a ray within a slab plane) leaves it as it is. The far distance is widened by `1 + 2γ(3)` so that no
    /// hit is lost to rounding (Ize 2013).
    pub fn intersect(&self, origin: Vec3, inv_direction: Vec3, t_max: f32) -> Option<(f32, f32)> {
        const WIDEN: f32 = 1.0 + 2.0 * (3.0 * f32::EPSILON * 0.5) / (1.0 - 3.0 * f32::EPSILON * 0.5);
        let (mut t0, mut t1) = (0.0_f32, t_max);
        for a in 0..3 {
            // Which plane comes first is a matter of the sign alone: the empty box, turned inside out, stays a miss.
            let (first, second) = if inv_direction[a].is_sign_negative() {
                (self.max[a], self.min[a])
            } else {
                (self.min[a], self.max[a])
            };
            let near = (first - origin[a]) * inv_direction[a];
            let far = (second - origin[a]) * inv_direction[a] * WIDEN;
            t0 = if near > t0 { near } else { t0 };
            t1 = if far < t1 { far } else { t1 };
            if t0 > t1 {
                return None;
            }
        }
        Some((t0, t1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hash::HashRng;

    fn hit(b: &Bounds3, origin: Vec3, direction: Vec3) -> Option<(f32, f32)> {
        b.intersect(origin, direction.recip(), f32::INFINITY)
    }

    #[test]
    fn slabs_agree_with_points_along_the_ray() {
        let mut rng = HashRng::new(1);
        let mut hits = 0;
        for _ in 0..20_000 {
            let mut v = || Vec3::new(rng.next_f32() - 0.5, rng.next_f32() - 0.5, rng.next_f32() - 0.5);
            let b = Bounds3::new(v(), v());
            let o = v() * 3.0;
            let d = b.center() + v() * 0.5 - o;
            // Where the ray is inside, by brute force.
            let inside = |t: f32| b.contains(o + d * t);
            let first = (0..2000).map(|i| i as f32 * 0.01).find(|&t| inside(t));
            match hit(&b, o, d) {
                Some((t0, t1)) => {
                    assert!(t0 <= t1 && t0 >= 0.0);
                    let grown = Bounds3::new(b.min - 1e-4, b.max + 1e-4);
                    assert!(grown.contains(o + d * t0) && grown.contains(o + d * t1));
                    assert!(first.is_none_or(|t| t >= t0 - 1e-4 && t <= t1 + 1e-4));
                    hits += 1;
                }
                None => assert_eq!(first, None),
            }
        }
        assert!(hits > 300);
    }

    #[test]
    fn axis_parallel_rays_and_rays_within_a_face() {
        let b = Bounds3::new(Vec3::ZERO, Vec3::ONE);
        let at = |o: [f32; 3], d: [f32; 3]| hit(&b, Vec3::from(o), Vec3::from(d)).map(|(t, _)| t);
        assert_eq!(at([-2.0, 0.5, 0.5], [1.0, 0.0, 0.0]), Some(2.0));
        assert_eq!(at([-2.0, 0.5, 0.5], [1.0, -0.0, -0.0]), Some(2.0));
        assert_eq!(at([-2.0, 1.5, 0.5], [1.0, 0.0, 0.0]), None);
        assert_eq!(at([3.0, 0.5, 0.5], [-1.0, 0.0, 0.0]), Some(2.0));
        assert_eq!(at([3.0, 0.5, 0.5], [1.0, 0.0, 0.0]), None);
        // 0·∞ is NaN here: a ray within the plane of a face counts as inside that slab.
        assert_eq!(at([-2.0, 0.0, 0.5], [1.0, 0.0, 0.0]), Some(2.0));
        assert_eq!(at([-2.0, 1.0, 0.5], [1.0, -0.0, 0.0]), Some(2.0));
        assert_eq!(at([-2.0, 0.0, 1.0], [1.0, 0.0, 0.0]), Some(2.0));
    }

    #[test]
    fn inside_flat_empty_and_bounded() {
        let b = Bounds3::new(Vec3::ZERO, Vec3::ONE);
        let (t0, t1) = hit(&b, Vec3::splat(0.5), Vec3::Y).expect("inside");
        assert!(t0 == 0.0 && (t1 - 0.5).abs() < 1e-6);
        let flat = Bounds3::new(Vec3::ZERO, Vec3::new(1.0, 1.0, 0.0));
        assert!(hit(&flat, Vec3::new(0.3, 0.3, 1.0), -Vec3::Z).is_some());
        assert!(hit(&flat, Vec3::new(0.3, 0.3, 1.0), Vec3::new(0.1, 0.1, -1.0)).is_some());
        assert!(hit(&Bounds3::EMPTY, Vec3::ZERO, Vec3::ONE).is_none());
        assert!(b.intersect(Vec3::new(-2.0, 0.5, 0.5), Vec3::X.recip(), 1.5).is_none());
        assert!(Bounds3::EMPTY.is_empty() && Bounds3::EMPTY.area() == 0.0);
        assert_eq!(b.union(Bounds3::EMPTY), b);
    }
}
