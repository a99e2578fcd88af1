//! Bounding volumes of sets of points: sphere, box, oriented box, k-DOP and convex hull, from loose and cheap to tight
//! and dear.
//!
//! All compute in `f64` on points that were `f32`. Each contains its points up to [`ROUNDING`] times the greatest
//! coordinate, which is what [`Volume::contains`] allows; the ray tests allow the same.

mod classifier;
mod hull;
mod kdop;
mod oriented;
mod sphere;
#[cfg(test)]
mod tests;

pub use classifier::{Answers, Class};
pub use hull::Hull;
pub use kdop::{Directions, KDop};
pub use oriented::OrientedBox;
pub use sphere::Sphere;

use steradian_math::{Bounds3, DVec3};

/// Rounding that is allowed for, relative to the greatest coordinate.
pub const ROUNDING: f64 = 1e-12;

/// Interface of every bounding volume.
pub trait Volume {
    /// Tests containment of a point, with a tolerance of the rounding error.
    fn contains(&self, p: DVec3) -> bool;

    /// The part of a line `origin + t·direction` that is in it, `t` from −∞ to ∞. `None` where it is missed, and for a
    /// direction of zero or one that is not finite.
    fn intersect(&self, origin: DVec3, direction: DVec3) -> Option<[f64; 2]>;

    /// Tests whether it has a point in common with another volume of its kind. For disjoint volumes this is `false` but
    /// for rounding, except for k-DOPs, which are compared by their own directions only and may be disjoint in others.
    fn overlaps(&self, other: &Self) -> bool;

    /// Its volume.
    fn volume(&self) -> f64;
}

/// The part of a line between two parallel planes, `low ≤ normal·p ≤ high`; what is outside by rounding is inside.
fn slab(interval: [f64; 2], at: f64, along: f64, [low, high]: [f64; 2]) -> Option<[f64; 2]> {
    // Widen the slab by the rounding of the dot products.
    let slack = ROUNDING * (low.abs().max(high.abs()) + at.abs());
    let (low, high) = (low - slack, high + slack);
    if along == 0.0 {
        return (low <= at && at <= high).then_some(interval);
    }
    // Distances of both planes, sorted by `min` and `max`.
    let (a, b) = ((low - at) / along, (high - at) / along);
    let [t0, t1] = [interval[0].max(a.min(b)), interval[1].min(a.max(b))];
    (t0 <= t1).then_some([t0, t1])
}

/// The whole line, if it is one.
fn line(origin: DVec3, direction: DVec3) -> Option<[f64; 2]> {
    let is_line = origin.is_finite() && direction.is_finite() && direction != DVec3::ZERO;
    is_line.then_some([f64::NEG_INFINITY, f64::INFINITY])
}

/// The axis-aligned box.
impl Volume for Bounds3 {
    fn contains(&self, p: DVec3) -> bool {
        let (min, max) = (self.min.as_dvec3(), self.max.as_dvec3());
        let slack = ROUNDING * min.abs().max(max.abs()).max_element();
        p.cmpge(min - slack).all() && p.cmple(max + slack).all()
    }

    fn intersect(&self, origin: DVec3, direction: DVec3) -> Option<[f64; 2]> {
        let sides = |axis: usize| [f64::from(self.min[axis]), f64::from(self.max[axis])];
        let whole = line(origin, direction).filter(|_| !self.is_empty())?;
        (0..3).try_fold(whole, |t, axis| slab(t, origin[axis], direction[axis], sides(axis)))
    }

    fn overlaps(&self, other: &Self) -> bool {
        self.min.cmple(other.max).all() && other.min.cmple(self.max).all()
    }

    fn volume(&self) -> f64 {
        if self.is_empty() {
            return 0.0;
        }
        (self.max.as_dvec3() - self.min.as_dvec3()).element_product()
    }
}
