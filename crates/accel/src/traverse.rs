//! Queries: single rays through the hierarchy, nearest children first.

use crate::UserHit;
use crate::bvh::Tree;
use crate::layout::{ChildRef, Node};
use crate::simd::{LANES, Simd};
use crate::triangle::Shear;
use steradian_math::Ray;

/// What lies below the user references of a tree: user primitives or instances.
pub(crate) trait Users {
    /// What a hit carries beyond [`UserHit`].
    type Extra: Copy;
    /// What a hit on a triangle of this tree carries.
    fn triangle(&self) -> Self::Extra;
    /// The nearest hit in `(0, ray.t_max)`.
    fn intersect(&self, index: u32, ray: &Ray) -> Option<(UserHit, Self::Extra)>;
    /// Whether there is any hit in `(0, ray.t_max)`.
    fn occluded(&self, index: u32, ray: &Ray) -> bool;
    /// Whether a hit on a filtered triangle counts.
    fn accept(&self, index: u32, hit: UserHit, ray: &Ray) -> bool;
}

/// The nearest hit on a tree.
#[derive(Clone, Copy)]
pub(crate) struct Nearest<E> {
    pub hit: UserHit,
    /// Index over all geometries of the tree.
    pub index: u32,
    pub extra: E,
}

/// Depth of the stack, enough for every tree: the builder bounds the depth, and a level pushes at most seven children.
const STACK: usize = (LANES - 1) * crate::build::MAX_DEPTH;

/// What the slab test needs of a ray.
struct Slabs<S: Simd> {
    origin: [S::F; 3],
    /// Reciprocals of the direction, made a little smaller for near planes and greater for far ones.
    inverse: [[S::F; 3]; 2],
    /// Rows of the near planes; the far ones are opposite.
    near: [usize; 3],
}

impl<S: Simd> Slabs<S> {
    #[inline(always)]
    fn new(s: S, ray: &Ray) -> Self {
        // Rounding moves a distance by at most 3 units of 2^-24. Widening by more keeps every box that the exact ray touches
        // (Ize, "Robust BVH Ray Traversal", JCGT 2(2), 2013).
        const WIDEN: f32 = 4.0 * f32::EPSILON;
        let inverse = ray.direction.recip().to_array();
        Self {
            origin: ray.origin.to_array().map(|x| s.splat(x)),
            inverse: [1.0 - WIDEN, 1.0 + WIDEN].map(|k| inverse.map(|x| s.splat(x * k))),
            near: std::array::from_fn(|axis| if inverse[axis].is_sign_negative() { axis + 3 } else { axis }),
        }
    }

    /// Distances at which the ray enters the boxes, and which boxes it enters.
    ///
    /// A ray within a plane gives 0·∞ = NaN. NaN is always the first operand where it matters, so the other one counts.
    #[inline(always)]
    fn test(&self, s: S, node: &Node, t_max: S::F) -> (S::F, u32) {
        let plane = |row: usize, axis: usize, side: usize| {
            s.mul(s.sub(s.load(&node.rows[row]), self.origin[axis]), self.inverse[side][axis])
        };
        let near: [S::F; 3] = std::array::from_fn(|axis| plane(self.near[axis], axis, 0));
        let far: [S::F; 3] = std::array::from_fn(|axis| plane((self.near[axis] + 3) % 6, axis, 1));
        let enter = s.max(s.max(near[0], near[1]), s.max(near[2], s.splat(0.0)));
        let leave = s.min(s.min(far[0], far[1]), s.min(far[2], t_max));
        (enter, s.bits(s.le(enter, leave)))
    }
}

/// The nearest hit in `(0, ray.t_max)`.
#[inline(always)]
pub(crate) fn nearest<S: Simd, U: Users>(s: S, tree: &Tree, ray: &Ray, users: &U) -> Option<Nearest<U::Extra>> {
    if !ray.is_valid() || !(ray.t_max > 0.0) {
        return None;
    }
    let slabs = Slabs::new(s, ray);
    let shear = Shear::new(s, ray);
    let mut stack = [(0_u32, ChildRef::EMPTY); STACK];
    let mut depth = 0;
    let mut best: Option<Nearest<U::Extra>> = None;
    let mut t = ray.t_max;
    let mut current = tree.root;
    loop {
        if current.is_node() {
            let node = &tree.nodes[current.index()];
            let (enter, mut lanes) = slabs.test(s, node, s.splat(t));
            if lanes != 0 {
                let enter = s.store(enter);
                let base = depth;
                let mut first = lanes.trailing_zeros() as usize;
                lanes &= lanes - 1;
                let mut key = enter[first].to_bits() & !7 | first as u32;
                while lanes != 0 {
                    let lane = lanes.trailing_zeros() as usize;
                    lanes &= lanes - 1;
                    let mut other = enter[lane].to_bits() & !7 | lane as u32;
                    if other < key {
                        std::mem::swap(&mut key, &mut other);
                    }
                    // Insertion into the part of the stack that belongs to this node: farthest first.
                    let mut slot = depth;
                    while slot > base && stack[slot - 1].0 < other {
                        stack[slot] = stack[slot - 1];
                        slot -= 1;
                    }
                    stack[slot] = (other, node.children[other as usize & 7]);
                    depth += 1;
                }
                first = key as usize & 7;
                current = node.children[first];
                continue;
            }
        } else if current.is_block() {
            let block = &tree.blocks[current.index()];
            if let Some(candidates) = shear.test(s, block, s.splat(t)) {
                let mut lanes = candidates.lanes;
                while lanes != 0 {
                    let lane = lanes.trailing_zeros() as usize;
                    lanes &= lanes - 1;
                    let index = block.ids[lane] & !crate::layout::Block::FILTERED;
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
        loop {
            if depth == 0 {
                return best;
            }
            depth -= 1;
            let (key, child) = stack[depth];
            if f32::from_bits(key & !7) <= t {
                current = child;
                break;
            }
        }
    }
}

/// Whether there is any hit in `(0, ray.t_max)`.
#[inline(always)]
pub(crate) fn any<S: Simd, U: Users>(s: S, tree: &Tree, ray: &Ray, users: &U) -> bool {
    if !ray.is_valid() || !(ray.t_max > 0.0) {
        return false;
    }
    let slabs = Slabs::new(s, ray);
    let shear = Shear::new(s, ray);
    let t_max = s.splat(ray.t_max);
    let mut stack = [ChildRef::EMPTY; STACK];
    let mut depth = 0;
    let mut current = tree.root;
    loop {
        if current.is_node() {
            let node = &tree.nodes[current.index()];
            let (_, mut lanes) = slabs.test(s, node, t_max);
            if lanes != 0 {
                current = node.children[lanes.trailing_zeros() as usize];
                lanes &= lanes - 1;
                while lanes != 0 {
                    stack[depth] = node.children[lanes.trailing_zeros() as usize];
                    depth += 1;
                    lanes &= lanes - 1;
                }
                continue;
            }
        } else if current.is_block() {
            let block = &tree.blocks[current.index()];
            if let Some(candidates) = shear.test(s, block, t_max) {
                let mut lanes = candidates.lanes;
                while lanes != 0 {
                    let lane = lanes.trailing_zeros() as usize;
                    lanes &= lanes - 1;
                    let index = block.ids[lane] & !crate::layout::Block::FILTERED;
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
        if depth == 0 {
            return false;
        }
        depth -= 1;
        current = stack[depth];
    }
}
