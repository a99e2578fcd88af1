//! Data shared by the queries: constants of a ray, and callbacks of the leaves.
//!
//! A box test bounds its rounding in two parts. The bound for the planes of a box is stored in the node (`widened`);
//! the bound for the origin of the ray is one number for each ray and axis (`RayConstants`). A plane then costs one
//! fused multiply-add, and a primitive far away does not widen the boxes of others.
#![allow(unsafe_code)]

use crate::dispatch::SupportedIsa;
use crate::layout::{ChildRef, Node};
use crate::packet::{Found, Packet};
use crate::simd::Simd;
use crate::triangle::axes;
use crate::widened::WIDEN;
use crate::{Hit, UserHit};
use steradian_math::{Bounds3, Ray, Vec3};

/// Data of a hit beyond [`UserHit`]: nothing, or an index.
pub(crate) trait Extra: Copy {
    /// As bits.
    fn bits(self) -> u32;
    /// From [`Extra::bits`].
    fn from_bits(bits: u32) -> Self;
}

impl Extra for () {
    #[inline(always)]
    fn bits(self) -> u32 {
        0
    }

    #[inline(always)]
    fn from_bits(_: u32) {}
}

impl Extra for u32 {
    #[inline(always)]
    fn bits(self) -> u32 {
        self
    }

    #[inline(always)]
    fn from_bits(bits: u32) -> Self {
        bits
    }
}

/// Leaves behind the user references of a tree: user primitives or instances.
pub(crate) trait UserLeaves {
    /// Data of a hit beyond [`UserHit`].
    type Extra: Extra;
    /// Data of a hit on a triangle of this tree.
    fn triangle(&self) -> Self::Extra;
    /// The nearest hit in `(0, ray.t_max)`.
    fn intersect(&self, index: u32, ray: &Ray) -> Option<(UserHit, Self::Extra)>;
    /// True if there is any hit in `(0, ray.t_max)`.
    fn occluded(&self, index: u32, ray: &Ray) -> bool;
    /// True if a hit on a filtered triangle counts.
    fn accept(&self, index: u32, hit: UserHit, ray: &Ray) -> bool;
    /// Collects hits in `(0, ray.t_max)`: of a user primitive the nearest, of an instance all.
    fn every(&self, index: u32, ray: &Ray, hits: &mut Vec<Hit>) {
        let hit = self.intersect(index, ray).filter(|(hit, _)| hit.t > 0.0 && hit.t < ray.t_max);
        hits.extend(hit.map(|(hit, extra)| self.hit(Nearest { hit, index, extra })));
    }
    /// Hit as the caller of a query gets it.
    fn hit(&self, nearest: Nearest<Self::Extra>) -> Hit;

    /// True if the results at the user references do not depend on the order in which these are tested.
    #[inline(always)]
    fn in_any_order(&self) -> bool {
        false
    }

    /// The nearest hits of the rays in `lanes` in intervals that end where `inner` says, if there is a tree behind the
    /// reference; else `false`.
    #[inline(always)]
    fn intersect_packet(&self, _: SupportedIsa, _: u32, _: &Packet, _: u32, _: &mut Found) -> bool {
        false
    }

    /// The rays in `lanes` that hit anything, if there is a tree behind the reference.
    #[inline(always)]
    fn occluded_packet(&self, _: SupportedIsa, _: u32, _: &Packet, _: u32) -> Option<u32> {
        None
    }
}

/// The nearest hit on a tree.
#[derive(Clone, Copy)]
pub(crate) struct Nearest<E> {
    pub hit: UserHit,
    /// Index over all geometries of the tree.
    pub index: u32,
    pub extra: E,
}

/// Starting point of the search for the nearest hit.
#[derive(Clone, Copy)]
pub(crate) struct Start<E> {
    pub child: ChildRef,
    /// The distance of the best hit, or the end of the interval.
    pub t: f32,
    pub best: Option<Nearest<E>>,
}

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

/// Ray constants of the slab test.
pub(crate) struct Slabs<S: Simd> {
    /// See [`RayConstants`].
    inverse: [S::F; 3],
    offset: [[S::F; 3]; 2],
    /// Rows of the near planes and of the far planes.
    near: [usize; 3],
    far: [usize; 3],
}

impl<S: Simd> Slabs<S> {
    #[inline(always)]
    pub fn new(s: S, constants: &RayConstants) -> Self {
        // The sign of the reciprocal tells which plane of each pair the ray meets first.
        let rows = |x: f32, axis: usize| if x.is_sign_negative() { (axis + 3, axis) } else { (axis, axis + 3) };
        let (x, y, z) = (rows(constants.inverse.x, 0), rows(constants.inverse.y, 1), rows(constants.inverse.z, 2));
        Self {
            inverse: s.splat3(constants.inverse),
            offset: [s.splat3(constants.offset[0]), s.splat3(constants.offset[1])],
            near: [x.0, y.0, z.0],
            far: [x.1, y.1, z.1],
        }
    }

    /// Distances at which the ray enters the boxes, and which boxes it enters.
    #[inline(always)]
    pub fn test(&self, s: S, node: &Node, t_max: S::F) -> (S::F, u32) {
        let near = |axis| self.plane(s, node, self.near[axis], 0, axis);
        let far = |axis| self.plane(s, node, self.far[axis], 1, axis);
        // Intersect the three slabs and [0, t_max] of eight boxes at once (Kay and Kajiya 1986).
        let enter = s.farther(s.farther(near(0), near(1)), s.farther(near(2), s.splat(0.0)));
        let leave = s.nearer(s.nearer(far(0), far(1)), s.nearer(far(2), t_max));
        (enter, s.bits(s.le(enter, leave)))
    }

    /// Distances of the ray to the planes of a row.
    #[inline(always)]
    fn plane(&self, s: S, node: &Node, row: usize, side: usize, axis: usize) -> S::F {
        // SAFETY: rows of planes are less than six.
        let row = unsafe { node.rows.get_unchecked(row) };
        s.mul_add(s.load(row), self.inverse[axis], self.offset[side][axis])
    }
}

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

/// The same for rays that are not common.
#[cold]
#[inline(never)]
fn is_valid(ray: &Ray) -> bool {
    ray.is_valid()
}
