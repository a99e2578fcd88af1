//! Queries: single rays through the hierarchy, nearest children first.
#![allow(unsafe_code)]

use crate::bvh::Tree;
use crate::dispatch::SupportedIsa;
use crate::layout::{Block, ChildRef, Node};
use crate::packet::{Found, Packet};
use crate::simd::{LANES, Simd};
use crate::stack::{OrderedStack, Stack};
use crate::triangle::{Shear, axes};
use crate::{Hit, UserHit};
use steradian_math::{Ray, Vec3};

/// What a hit carries beyond [`UserHit`]: nothing, or an index.
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

/// What lies below the user references of a tree: user primitives or instances.
pub(crate) trait Users {
    /// What a hit carries beyond [`UserHit`].
    type Extra: Extra;
    /// What a hit on a triangle of this tree carries.
    fn triangle(&self) -> Self::Extra;
    /// The nearest hit in `(0, ray.t_max)`.
    fn intersect(&self, index: u32, ray: &Ray) -> Option<(UserHit, Self::Extra)>;
    /// Whether there is any hit in `(0, ray.t_max)`.
    fn occluded(&self, index: u32, ray: &Ray) -> bool;
    /// Whether a hit on a filtered triangle counts.
    fn accept(&self, index: u32, hit: UserHit, ray: &Ray) -> bool;
    /// Collects hits in `(0, ray.t_max)`: of a user primitive the nearest, of an instance all.
    fn every(&self, index: u32, ray: &Ray, hits: &mut Vec<Hit>) {
        let hit = self.intersect(index, ray).filter(|(hit, _)| hit.t > 0.0 && hit.t < ray.t_max);
        hits.extend(hit.map(|(hit, extra)| self.hit(Nearest { hit, index, extra })));
    }
    /// What the caller of a query gets.
    fn hit(&self, nearest: Nearest<Self::Extra>) -> Hit;

    /// The nearest hits of the rays in `lanes` in intervals that end where `inner` says, if there is a tree behind the reference;
    /// else `false`.
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

/// Where the search for the nearest hit begins.
#[derive(Clone, Copy)]
pub(crate) struct Start<E> {
    pub child: ChildRef,
    /// The distance of the best hit, or the end of the interval.
    pub t: f32,
    pub best: Option<Nearest<E>>,
}

/// By how much reciprocals of directions are made smaller for near planes and greater for far ones. Rounding moves a distance by at
/// most 3 units of 2^-24. Widening by more keeps every box that the exact ray touches (Ize, "Robust BVH Ray Traversal", JCGT 2(2),
/// 2013).
pub(crate) const WIDEN: f32 = 4.0 * f32::EPSILON;

/// What the slab test needs of a ray.
pub(crate) struct Slabs<S: Simd> {
    origin: [S::F; 3],
    /// Reciprocals of the direction, made a little smaller for near planes and greater for far ones.
    inverse: [[S::F; 3]; 2],
    /// Rows of the near planes and of the far planes.
    near: [usize; 3],
    far: [usize; 3],
}

/// What both tests need of a ray beyond its origin: numbers that take divisions to make.
#[derive(Clone, Copy)]
pub(crate) struct Way {
    /// Reciprocals of the direction, made a little smaller for near planes and greater for far ones.
    pub inverse: [Vec3; 2],
    /// See [`Shear`].
    pub axes: [usize; 3],
    pub shear: [f32; 3],
}

impl Way {
    /// For a valid ray.
    #[inline(always)]
    pub fn new(ray: &Ray) -> Self {
        let d = ray.direction;
        let inverse = d.recip();
        let axes = axes(d);
        let [x, y, z] = axes;
        Self {
            inverse: [inverse * (1.0 - WIDEN), inverse * (1.0 + WIDEN)],
            axes,
            shear: [d[x] / d[z], d[y] / d[z], 1.0 / d[z]],
        }
    }
}

impl<S: Simd> Slabs<S> {
    #[inline(always)]
    pub fn new(s: S, ray: &Ray, way: &Way) -> Self {
        let inverse = way.inverse[0];
        let rows = |x: f32, axis: usize| if x.is_sign_negative() { (axis + 3, axis) } else { (axis, axis + 3) };
        let (x, y, z) = (rows(inverse.x, 0), rows(inverse.y, 1), rows(inverse.z, 2));
        Self {
            origin: s.splat3(ray.origin),
            inverse: [s.splat3(way.inverse[0]), s.splat3(way.inverse[1])],
            near: [x.0, y.0, z.0],
            far: [x.1, y.1, z.1],
        }
    }

    /// Distances at which the ray enters the boxes, and which boxes it enters.
    ///
    /// A ray within a plane gives 0·∞ = NaN. NaN is always the first operand where it matters, so the other one counts.
    #[inline(always)]
    pub fn test(&self, s: S, node: &Node, t_max: S::F) -> (S::F, u32) {
        let near = [self.near(s, node, 0), self.near(s, node, 1), self.near(s, node, 2)];
        let far = [self.far(s, node, 0), self.far(s, node, 1), self.far(s, node, 2)];
        let enter = s.max(s.max(near[0], near[1]), s.max(near[2], s.splat(0.0)));
        let leave = s.min(s.min(far[0], far[1]), s.min(far[2], t_max));
        (enter, s.bits(s.le(enter, leave)))
    }

    /// Where the ray meets the near planes of an axis.
    #[inline(always)]
    fn near(&self, s: S, node: &Node, axis: usize) -> S::F {
        // SAFETY: rows of planes are less than six.
        let row = unsafe { node.rows.get_unchecked(self.near[axis]) };
        s.mul(s.sub(s.load(row), self.origin[axis]), self.inverse[0][axis])
    }

    /// Where the ray meets the far planes of an axis.
    #[inline(always)]
    fn far(&self, s: S, node: &Node, axis: usize) -> S::F {
        // SAFETY: rows of planes are less than six.
        let row = unsafe { node.rows.get_unchecked(self.far[axis]) };
        s.mul(s.sub(s.load(row), self.origin[axis]), self.inverse[1][axis])
    }
}

/// Whether a ray can hit anything at all.
#[inline(always)]
pub(crate) fn is_traceable(ray: &Ray) -> bool {
    ray.is_valid() && ray.t_max > 0.0
}

/// The nearest hit of a traceable ray in `(0, ray.t_max)`, from a start on.
#[inline(always)]
pub(crate) fn nearest<S: Simd, U: Users>(
    s: S,
    tree: &Tree,
    ray: &Ray,
    users: &U,
    way: &Way,
    start: Start<U::Extra>,
) -> Option<Nearest<U::Extra>> {
    let slabs = Slabs::new(s, ray, way);
    let shear = Shear::new(s, ray, way);
    let mut stack = OrderedStack::new();
    let Start { child: mut current, mut t, mut best } = start;
    loop {
        if current.is_node() {
            // SAFETY: the reference comes from the tree and is to a node.
            let node = unsafe { tree.node(current) };
            let (enter, lanes) = slabs.test(s, node, s.splat(t));
            if lanes & lanes.wrapping_sub(1) != 0 {
                // The nearest child is next; the others wait, nearer ones above.
                let (keys, children) = s.sort_descending(enter, lanes, &ChildRef::bits(&node.children));
                // SAFETY: the number of lanes is at most LANES; the stack is deep enough for the tree.
                current =
                    unsafe { stack.push_all_but_nearest(keys, children.map(ChildRef), lanes.count_ones() as usize) };
                continue;
            }
            if lanes != 0 {
                current = node.children[lanes.trailing_zeros() as usize & (LANES - 1)];
                continue;
            }
        } else if current.is_block() {
            // SAFETY: the reference comes from the tree and is to a block.
            let block = unsafe { tree.block(current) };
            if let Some(candidates) = shear.test(s, block, s.splat(t)) {
                let mut lanes = candidates.lanes;
                while lanes != 0 {
                    let lane = lanes.trailing_zeros() as usize & (LANES - 1);
                    lanes &= lanes - 1;
                    let index = block.ids[lane] & !Block::FILTERED;
                    let closer = candidates.t[lane] < t
                        || candidates.t[lane] == t && best.is_some_and(|best| index < best.index);
                    if closer {
                        let (u, v) = candidates.barycentrics(lane);
                        let hit = UserHit { t: candidates.t[lane], u, v };
                        if block.ids[lane] == index || users.accept(index, hit, ray) {
                            t = hit.t;
                            best = Some(Nearest { hit, index, extra: users.triangle() });
                        }
                    }
                }
            }
        } else if current != ChildRef::EMPTY {
            // A user primitive may win a tie, so that it sees an interval that contains the hit so far.
            let index = current.index() as u32;
            let wins_ties = best.is_some_and(|best| index < best.index);
            let t_max = if wins_ties { t.next_up() } else { t };
            if let Some((hit, extra)) = users.intersect(index, &Ray { t_max, ..*ray })
                && hit.t > 0.0
                && hit.t < t_max
            {
                t = hit.t;
                best = Some(Nearest { hit, index, extra });
            }
        }
        match stack.pop(t) {
            Some(child) => current = child,
            None => return best,
        }
    }
}

/// Whether a traceable ray has any hit in `(0, ray.t_max)` below a child.
#[inline(always)]
pub(crate) fn any<S: Simd, U: Users>(s: S, tree: &Tree, ray: &Ray, users: &U, way: &Way, start: ChildRef) -> bool {
    let slabs = Slabs::new(s, ray, way);
    let shear = Shear::new(s, ray, way);
    let t_max = s.splat(ray.t_max);
    let mut stack = Stack::new();
    let mut current = start;
    loop {
        if current.is_node() {
            // SAFETY: the reference comes from the tree and is to a node.
            let node = unsafe { tree.node(current) };
            let (_, mut lanes) = slabs.test(s, node, t_max);
            if lanes != 0 {
                current = node.children[lanes.trailing_zeros() as usize & (LANES - 1)];
                lanes &= lanes - 1;
                while lanes != 0 {
                    // SAFETY: the stack is deep enough for the tree.
                    unsafe { stack.push(node.children[lanes.trailing_zeros() as usize & (LANES - 1)]) };
                    lanes &= lanes - 1;
                }
                continue;
            }
        } else if current.is_block() {
            // SAFETY: the reference comes from the tree and is to a block.
            let block = unsafe { tree.block(current) };
            if let Some(candidates) = shear.test(s, block, t_max) {
                let mut lanes = candidates.lanes;
                while lanes != 0 {
                    let lane = lanes.trailing_zeros() as usize & (LANES - 1);
                    lanes &= lanes - 1;
                    let index = block.ids[lane] & !Block::FILTERED;
                    if candidates.t[lane] < ray.t_max {
                        let (u, v) = candidates.barycentrics(lane);
                        let hit = UserHit { t: candidates.t[lane], u, v };
                        if block.ids[lane] == index || users.accept(index, hit, ray) {
                            return true;
                        }
                    }
                }
            }
        } else if current != ChildRef::EMPTY && users.occluded(current.index() as u32, ray) {
            return true;
        }
        match stack.pop() {
            Some(child) => current = child,
            None => return false,
        }
    }
}
