//! Constants of a ray that the tests of boxes and triangles share.
//!
//! A box test bounds its rounding in two parts. The bound for the planes of a box is stored in the node (`widened`);
//! the bound for the origin of the ray is one number for each ray and axis (`RayConstants`). A plane then costs one
//! fused multiply-add, and a primitive far away does not widen the boxes of others.
#![expect(unsafe_code, reason = "unchecked reads; each place states why it is sound")]

use crate::widened::WIDEN;
use steradian_math::{Bounds3, Ray, Vec3};

/// Ray constants of both tests, made by divisions.
#[derive(Clone, Copy)]
pub(crate) struct RayConstants {
    /// Reciprocals of the direction, of limited size.
    pub inverse: Vec3,
    /// The distance of a plane is its coordinate times the reciprocal plus one of these: the first is less and the
    /// second more than what is exact by a bound on the rounding that comes from the origin. For that which comes from
    /// the plane see [`crate::widened`].
    pub offset: [Vec3; 2],
    /// See [`crate::triangle::Shear`].
    pub axes: [usize; 3],
    pub shear: [f32; 3],
}

/// Most that a coordinate times a reciprocal may be.
pub(crate) const GREATEST: f32 = 8e37;
/// The bound on rounding of coordinates along which a ray hardly moves, at least.
const AT_REST: f32 = 3e31;

impl RayConstants {
    /// For a valid ray in a tree with given bounds, whose nodes hold [widened](crate::widened) boxes.
    #[inline(always)]
    pub fn new(ray: &Ray, bounds: &Bounds3) -> Self {
        let d = &ray.direction;
        let axes = axes(*d);
        let [x, y, z] = axes;
        let reciprocal = d.recip();
        // Shear constants of the watertight triangle test (Woop, Benthin, Wald 2013): divide by the greatest
        // coordinate.
        let along = at(d, z);
        Self::with(ray, bounds, reciprocal, axes, [at(d, x) / along, at(d, y) / along, 1.0 / along])
    }

    /// From what takes divisions.
    ///
    /// The distance of the plane at `p` is `p·i − o·i` with the reciprocal `i`. Rounding of `i`, of both products and
    /// of the sum moves it by at most 4 units of 2^-24 of `(|p| + |o|)·|i|`. Planes and offsets allow for twice that.
    /// A product may be infinite: the plane is then farther away than any number.
    ///
    /// Where the ray hardly moves along an axis, `i` is limited and with it `o·i`; what is allowed for is then more
    /// than any distance at which there are hits, so that the ray is within a slab for ever or not at all.
    #[inline(always)]
    pub fn with(ray: &Ray, bounds: &Bounds3, reciprocal: Vec3, axes: [usize; 3], shear: [f32; 3]) -> Self {
        let origin = ray.origin.abs();
        let mut inverse = reciprocal;
        let mut error = origin * inverse.abs();
        let moves = error.cmple(Vec3::splat(GREATEST));
        // The common case: all products are finite, and the relative bound covers their rounding.
        if moves.all() {
            error = error * WIDEN + f32::MIN_POSITIVE;
        } else {
            let extent = bounds.min.abs().max(bounds.max.abs()) + origin;
            // All hits are before the ray has left the bounds along the axis where it moves most.
            let last = 2.0 * extent[axes[2]] * inverse[axes[2]].abs();
            // Where nothing is known of distances, all products must be finite.
            let (size, at_rest) = if last <= GREATEST { (origin, AT_REST.max(last)) } else { (extent, f32::INFINITY) };
            let limit = Vec3::splat(GREATEST) / size.max(Vec3::ONE);
            inverse = Vec3::select(moves, inverse, limit.copysign(ray.direction));
            error = Vec3::select(moves, error * WIDEN + f32::MIN_POSITIVE, Vec3::splat(at_rest));
        }
        // p·i − o·i with o·i rounded down for near planes and up for far ones makes the slab test conservative.
        let exact = -(ray.origin * inverse);
        Self { inverse, offset: [exact - error, exact + error], axes, shear }
    }
}

/// The axes in the order x, y, z of the sheared space of a direction.
#[inline(always)]
pub(crate) fn axes(direction: Vec3) -> [usize; 3] {
    let a = direction.abs();
    let z = if a.x >= a.y && a.x >= a.z {
        0
    } else if a.y >= a.z {
        1
    } else {
        2
    };
    AXES[z]
}

/// By the last of them.
pub(crate) static AXES: [[usize; 3]; 3] = [[1, 2, 0], [2, 0, 1], [0, 1, 2]];

/// A coordinate of a vector in memory, without a branch.
#[inline(always)]
pub(crate) fn at(v: &Vec3, axis: usize) -> f32 {
    let coordinates: &[f32; 3] = v.as_ref();
    debug_assert!(axis < 3);
    // SAFETY: axes are less than three.
    unsafe { *coordinates.get_unchecked(axis) }
}

/// True if a ray can hit anything at all.
#[inline(always)]
pub(crate) fn is_traceable(ray: &Ray) -> bool {
    let (o, d) = (ray.origin, ray.direction);
    // Where the sum is finite all of them are.
    let sum = (o.x + o.y + o.z) + (d.x + d.y + d.z);
    let moves = (d.x.to_bits() | d.y.to_bits() | d.z.to_bits()) << 1 != 0;
    ray.t_max > 0.0 && moves && (sum.is_finite() || is_valid(ray))
}

/// Validity of a ray whose components have an infinite or undefined sum: a slow path that is rarely taken.
#[cold]
#[inline(never)]
fn is_valid(ray: &Ray) -> bool {
    ray.is_valid()
}
