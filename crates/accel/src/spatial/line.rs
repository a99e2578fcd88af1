//! A ray as the walks through cells see it: in `f64`, where origin and direction are exact and a crossing with a plane
//! is off by a relative 2⁻⁵¹ at most.
//!
//! The triangle test works in `f32` and may accept a triangle that the exact ray passes at a distance of a few units of
//! 2⁻²⁴ of the distance between origin and triangle. So that every structure tests what brute force accepts, primitives
//! are sorted into cells with some padding around them, and a ray that begins so far away that the padding does not
//! cover the rounding walks with a *reach*: it visits the cells that are within this distance too.

use steradian_math::{DVec3, Ray, Vec3};

/// Bound on the distance at which the triangle test accepts, in units of the distance to the triangle: 16 times 2⁻²⁴.
pub(super) const ROUNDING: f64 = 1.0 / 1_048_576.0;

/// A valid ray within the bounds of a structure.
#[derive(Clone, Copy, Debug)]
pub(super) struct Line {
    pub origin: DVec3,
    pub direction: DVec3,
    /// Reciprocals; infinite for zero.
    pub inverse: DVec3,
    /// Interval within the bounds.
    pub t: [f64; 2],
    /// Distance from the line within which cells must be visited: zero, but for rays from far away.
    pub reach: f64,
}

impl Line {
    /// The part of a ray within bounds to which `padding` was added; `None` if there is none, or the ray is not valid.
    pub fn new(ray: &Ray, [min, max]: [DVec3; 2], padding: f64) -> Option<Self> {
        if !is_askable(ray) || !min.cmple(max).all() {
            return None;
        }
        let (origin, direction) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
        // The rounding of the triangle test grows with the distance: what the padding does not cover becomes the reach.
        let farthest = (min - origin).abs().max((max - origin).abs()).max_element();
        let reach = (farthest * ROUNDING - padding).max(0.0);
        let mut line = Self { origin, direction, inverse: direction.recip(), t: [0.0, f64::from(ray.t_max)], reach };
        line.t = line.clip([min - reach, max + reach], line.t)?;
        Some(line)
    }

    /// The part of an interval that lies in a closed box.
    #[inline]
    pub fn clip(&self, [min, max]: [DVec3; 2], [mut t0, mut t1]: [f64; 2]) -> Option<[f64; 2]> {
        for axis in 0..3 {
            let (o, d) = (self.origin[axis], self.direction[axis]);
            // Intersect with the slab of the axis.
            if d == 0.0 {
                if o < min[axis] || o > max[axis] {
                    return None;
                }
                continue;
            }
            let (a, b) = ((min[axis] - o) * self.inverse[axis], (max[axis] - o) * self.inverse[axis]);
            t0 = t0.max(a.min(b));
            t1 = t1.min(a.max(b));
        }
        (t0 <= t1).then_some([t0, t1])
    }

    /// The point at a parameter.
    #[inline]
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + self.direction * t
    }
}

/// True if a ray can hit anything at all.
#[inline]
pub(super) fn is_askable(ray: &Ray) -> bool {
    ray.is_valid() && ray.t_max > 0.0
}

/// True if cells that begin at `entry` cannot hold a hit before `t`, for any rounding of `t`.
#[inline]
pub(super) fn is_beyond(entry: f64, t: f32) -> bool {
    entry * (1.0 - 4.0 * ROUNDING) > f64::from(t)
}

/// A box in `f64`, padded.
pub(super) fn padded(min: Vec3, max: Vec3, padding: f64) -> [DVec3; 2] {
    [min.as_dvec3() - padding, max.as_dvec3() + padding]
}
