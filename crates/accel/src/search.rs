//! Queries of single rays, nearest children first, step by step: a step is the test of a node or of a leaf, so that
//! several rays can be on their way at once.
#![expect(unsafe_code, reason = "unchecked reads; each place states why it is sound")]

use crate::UserHit;
use crate::layout::{Block, ChildRef};
use crate::leaves::UserLeaves;
use crate::nearest::{Nearest, Start};
use crate::ray_constants::RayConstants;
use crate::simd::{LANES, Simd};
use crate::slabs::Slabs;
use crate::stack::{OrderedStack, Stack, Waiting};
use crate::tree::Tree;
use crate::triangle::Shear;
use std::mem::MaybeUninit;
use steradian_math::Ray;

/// A query on its way.
pub(crate) trait Query<S: Simd, U: UserLeaves>: Sized {
    /// Result of the query; the default for a ray that is not traceable.
    type Answer: Copy + Default;
    /// Stack of references to be visited.
    type Stack: Waiting;
    /// At the root of a tree.
    fn at_root(s: S, tree: &Tree, ray: &Ray, constants: &RayConstants) -> Self;
    /// Reference visited next.
    fn current(&self) -> ChildRef;
    /// Visits a node or a leaf: the answer when that was the last one. The ray is the one that it began with, and the
    /// stack the one that was empty then.
    fn step(&mut self, stack: &mut Self::Stack, s: S, tree: &Tree, ray: &Ray, users: &U) -> Option<Self::Answer>;
}

/// The search for the nearest hit of a traceable ray in `(0, ray.t_max)`.
pub(crate) struct Closest<S: Simd, E> {
    slabs: Slabs<S>,
    shear: Shear<S>,
    current: ChildRef,
    t: f32,
    best: Option<Nearest<E>>,
}

impl<S: Simd, E: Copy> Closest<S, E> {
    #[inline(always)]
    fn new(s: S, ray: &Ray, constants: &RayConstants, Start { child, t, best }: Start<E>) -> Self {
        let (slabs, shear) = (Slabs::new(s, constants), Shear::new(s, ray, constants));
        Self { slabs, shear, current: child, t, best }
    }
}

impl<S: Simd, U: UserLeaves> Query<S, U> for Closest<S, U::Extra> {
    type Answer = Option<Nearest<U::Extra>>;
    type Stack = OrderedStack;

    #[inline(always)]
    fn at_root(s: S, tree: &Tree, ray: &Ray, constants: &RayConstants) -> Self {
        Self::new(s, ray, constants, Start { child: tree.root, t: ray.t_max, best: None })
    }

    #[inline(always)]
    fn current(&self) -> ChildRef {
        self.current
    }

    #[inline(always)]
    fn step(&mut self, stack: &mut OrderedStack, s: S, tree: &Tree, ray: &Ray, users: &U) -> Option<Self::Answer> {
        let current = self.current;
        if current.is_node() {
            // SAFETY: the reference comes from the tree and is to a node.
            let node = unsafe { tree.arena.node(current) };
            // Test the boxes of all eight children and keep those that begin before the hit so far.
            let (enter, lanes) = self.slabs.test(s, node, s.splat(self.t));
            if lanes & lanes.wrapping_sub(1) != 0 {
                // The nearest child is next; the others wait, nearer ones above.
                tree.prefetch_children(node, lanes);
                self.current = node.children[s.nearest(enter, lanes) & (LANES - 1)];
                let (keys, children) = s.sort_descending(enter, lanes, ChildRef::bits(&node.children));
                // SAFETY: the number of lanes is at most LANES; the stack is deep enough for the tree.
                unsafe { stack.push_all_but_nearest(keys, children, lanes.count_ones() as usize) };
                return None;
            }
            if lanes != 0 {
                self.current = node.children[lanes.trailing_zeros() as usize & (LANES - 1)];
                return None;
            }
        } else if current.is_block() {
            // SAFETY: the reference comes from the tree and is to a block.
            let block = unsafe { tree.arena.block(current) };
            nearest_in_block(s, &self.shear, block, ray, users, (&mut self.t, &mut self.best));
        } else if current != ChildRef::EMPTY {
            // A user primitive may win a tie, so that it sees an interval that contains the hit so far.
            let index = current.index() as u32;
            let wins_ties = self.best.is_some_and(|best| index < best.index);
            let t_max = if wins_ties { self.t.next_up() } else { self.t };
            if let Some((hit, extra)) = users.intersect(index, &Ray { t_max, ..*ray })
                && hit.t > 0.0
                && hit.t < t_max
            {
                self.t = hit.t;
                self.best = Some(Nearest { hit, index, extra });
            }
        }
        // Continue with the nearest waiting child; those behind the hit are dropped unvisited.
        match stack.pop(self.t) {
            Some(child) => {
                self.current = child;
                None
            }
            None => Some(self.best),
        }
    }
}

/// The search for any hit of a traceable ray in `(0, ray.t_max)`.
pub(crate) struct Any<S: Simd> {
    slabs: Slabs<S>,
    shear: Shear<S>,
    current: ChildRef,
    t_max: S::F,
}

impl<S: Simd> Any<S> {
    #[inline(always)]
    fn new(s: S, ray: &Ray, constants: &RayConstants, start: ChildRef) -> Self {
        let (slabs, shear) = (Slabs::new(s, constants), Shear::new(s, ray, constants));
        Self { slabs, shear, current: start, t_max: s.splat(ray.t_max) }
    }
}

impl<S: Simd, U: UserLeaves> Query<S, U> for Any<S> {
    type Answer = bool;
    type Stack = Stack;

    #[inline(always)]
    fn at_root(s: S, tree: &Tree, ray: &Ray, constants: &RayConstants) -> Self {
        Self::new(s, ray, constants, tree.root)
    }

    #[inline(always)]
    fn current(&self) -> ChildRef {
        self.current
    }

    #[inline(always)]
    fn step(&mut self, stack: &mut Stack, s: S, tree: &Tree, ray: &Ray, users: &U) -> Option<bool> {
        let current = self.current;
        if current.is_node() {
            // SAFETY: the reference comes from the tree and is to a node.
            let node = unsafe { tree.arena.node(current) };
            // Any order will do: take the first child entered and stack the others unsorted.
            let (_, mut lanes) = self.slabs.test(s, node, self.t_max);
            if lanes != 0 {
                if lanes & (lanes - 1) != 0 {
                    tree.prefetch_children(node, lanes);
                }
                self.current = node.children[lanes.trailing_zeros() as usize & (LANES - 1)];
                lanes &= lanes - 1;
                while lanes != 0 {
                    // SAFETY: the stack is deep enough for the tree.
                    unsafe { stack.push(node.children[lanes.trailing_zeros() as usize & (LANES - 1)]) };
                    lanes &= lanes - 1;
                }
                return None;
            }
        } else if current.is_block() {
            // SAFETY: the reference comes from the tree and is to a block.
            let block = unsafe { tree.arena.block(current) };
            if any_in_block(s, &self.shear, block, ray, users) {
                return Some(true);
            }
        } else if current != ChildRef::EMPTY && users.occluded(current.index() as u32, ray) {
            return Some(true);
        }
        match stack.pop() {
            Some(child) => {
                self.current = child;
                None
            }
            None => Some(false),
        }
    }
}

/// Looks for hits on the triangles of a block that are nearer than the best one so far.
#[inline(always)]
pub(crate) fn nearest_in_block<S: Simd, U: UserLeaves>(
    s: S,
    shear: &Shear<S>,
    block: &Block,
    ray: &Ray,
    users: &U,
    (t, best): (&mut f32, &mut Option<Nearest<U::Extra>>),
) {
    let Some(candidates) = shear.test(s, block, s.splat(*t), true) else { return };
    let mut lanes = candidates.lanes;
    while lanes != 0 {
        let lane = lanes.trailing_zeros() as usize & (LANES - 1);
        lanes &= lanes - 1;
        let index = block.ids[lane] & !Block::FILTERED;
        // Of equal distances the smaller index wins, in whatever order leaves are visited.
        let closer = candidates.t[lane] < *t || candidates.t[lane] == *t && best.is_some_and(|best| index < best.index);
        if closer {
            let hit = UserHit { t: candidates.t[lane], u: candidates.u[lane], v: candidates.v[lane] };
            if block.ids[lane] == index || users.accept(index, hit, ray) {
                *t = hit.t;
                *best = Some(Nearest { hit, index, extra: users.triangle() });
            }
        }
    }
}

/// True if a ray hits a triangle of a block.
#[inline(always)]
pub(crate) fn any_in_block<S: Simd, U: UserLeaves>(
    s: S,
    shear: &Shear<S>,
    block: &Block,
    ray: &Ray,
    users: &U,
) -> bool {
    let Some(candidates) = shear.test(s, block, s.splat(ray.t_max), ray.t_max < f32::INFINITY) else { return false };
    let mut lanes = candidates.lanes;
    while lanes != 0 {
        let lane = lanes.trailing_zeros() as usize & (LANES - 1);
        lanes &= lanes - 1;
        let index = block.ids[lane] & !Block::FILTERED;
        if candidates.t[lane] < ray.t_max {
            let hit = UserHit { t: candidates.t[lane], u: candidates.u[lane], v: candidates.v[lane] };
            if block.ids[lane] == index || users.accept(index, hit, ray) {
                return true;
            }
        }
    }
    false
}

/// The nearest hit of a traceable ray in `(0, ray.t_max)`, from a start on.
#[inline(always)]
pub(crate) fn nearest<S: Simd, U: UserLeaves>(
    s: S,
    tree: &Tree,
    ray: &Ray,
    users: &U,
    constants: &RayConstants,
    start: Start<U::Extra>,
) -> Option<Nearest<U::Extra>> {
    to_the_end(s, tree, ray, users, Closest::new(s, ray, constants, start))
}

/// True if a traceable ray has any hit in `(0, ray.t_max)` below a child.
#[inline(always)]
pub(crate) fn any<S: Simd, U: UserLeaves>(
    s: S,
    tree: &Tree,
    ray: &Ray,
    users: &U,
    constants: &RayConstants,
    start: ChildRef,
) -> bool {
    to_the_end(s, tree, ray, users, Any::new(s, ray, constants, start))
}

/// Step after step.
#[inline(always)]
pub(crate) fn to_the_end<S: Simd, U: UserLeaves, Q: Query<S, U>>(
    s: S,
    tree: &Tree,
    ray: &Ray,
    users: &U,
    mut query: Q,
) -> Q::Answer {
    let mut stack = MaybeUninit::uninit();
    let stack = Q::Stack::emptied(&mut stack);
    loop {
        if let Some(answer) = query.step(stack, s, tree, ray, users) {
            return answer;
        }
    }
}
