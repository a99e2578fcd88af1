//! Rays and the robust spawning of new ones (Wächter & Binder; PBR 4th ed., 6.8).

use crate::Vec3;

/// A half-line `origin + t·direction`, `0 < t < t_max`. The direction need not be of unit length.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    /// Origin of the ray.
    pub origin: Vec3,
    /// Direction of the ray; distances are in units of its length.
    pub direction: Vec3,
    /// Exclusive end of the interval in which hits count.
    pub t_max: f32,
    /// The moment of the exposure: 0 as the shutter opens, 1 as it closes.
    pub time: f32,
}

impl Ray {
    /// A ray without end, as the shutter opens.
    #[inline]
    pub const fn new(origin: Vec3, direction: Vec3) -> Self {
        Self { origin, direction, t_max: f32::INFINITY, time: 0.0 }
    }

    /// The point at parameter `t`.
    #[inline]
    pub fn at(&self, t: f32) -> Vec3 {
        self.origin + self.direction * t
    }

    /// True if origin and direction are finite and the direction is not zero.
    pub fn is_valid(&self) -> bool {
        self.origin.is_finite() && self.direction.is_finite() && self.direction != Vec3::ZERO
    }
}

/// The bound `γ(n) = n·ε/(1 − n·ε)` on the relative error of `n` rounded operations (Higham).
#[inline]
pub const fn gamma(n: u32) -> f32 {
    let e = n as f32 * (f32::EPSILON * 0.5);
    e / (1.0 - e)
}

/// Moves a hit point off the surface, just past its error box, to the side that `w` points to.
///
/// `error` is the half-size of the box that is known to contain the true point, `n` the geometric normal.
#[inline(always)]
pub fn offset_ray_origin(p: Vec3, error: Vec3, n: Vec3, w: Vec3) -> Vec3 {
    let d = n.abs().dot(error);
    let offset = n * d.copysign(w.dot(n));
    let o = p + offset;
    // Away from the surface by the rounding of that sum too.
    let nudge = (o.abs() * f32::EPSILON + Vec3::splat(f32::MIN_POSITIVE)).copysign(offset);
    o + Vec3::select(offset.cmpeq(Vec3::ZERO), Vec3::ZERO, nudge)
}
