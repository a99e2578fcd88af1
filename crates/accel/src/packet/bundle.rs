//! Rays of a packet that go different ways, but begin near each other: they share the nodes around their origins.
//!
//! The boxes of such nodes are tested one after the other with all rays; for nearest hits, from those near the origins
//! to those far away. Where few of the rays are left in a part of the tree, they go on alone.
#![expect(unsafe_code, reason = "unchecked reads; each place states why it is sound")]

use super::Set;
use super::any::at_user_alone;
use super::beam::{Rows, SingleRays};
use super::nearest::at_user;
use super::stack::BundleStack;
use crate::layout::{Block, ChildRef, Node};
use crate::leaves::UserLeaves;
use crate::nearest::Start;
use crate::packet_hits::Found;
use crate::packet_rays::Packet;
use crate::ray_constants::RayConstants;
use crate::search::{any_in_block, nearest_in_block};
use crate::simd::{LANES, Lanes, Simd, key_lane};
use crate::single::{any_hit_from, nearest_hit_from};
use crate::supported_isa::SupportedIsa;
use crate::tree::Tree;
use crate::triangle::Shear;
use steradian_math::Ray;

/// A bundle has at least so many rays. Measured.
const BUNDLE: u32 = 8;
/// With fewer rays than these in a part of the tree, they go on alone. Measured.
const FEW: u32 = 5;

/// Rays that remain of a packet.
#[derive(Clone, Copy)]
pub(super) struct RemainingRays {
    /// Rays that must go alone.
    pub alone: u32,
    /// True if a bundle fell apart, so that tracing its rays singly would have been faster.
    pub poor: bool,
}

impl RemainingRays {
    /// Takes a bundle out of the rays that would go alone: those that move, if there are enough of them.
    #[inline(always)]
    pub fn bundle(&mut self, moving: u32) -> u32 {
        let group = self.alone & moving;
        if group.count_ones() < BUNDLE {
            return 0;
        }
        self.alone &= !group;
        group
    }
}

/// Query of the rays of a bundle.
pub(super) trait Question<S: Simd, L: Lanes, U: UserLeaves> {
    /// True if visiting children near the origins first is faster.
    const ORDERED: bool;
    /// Current ends of the rays' intervals.
    fn ends(&self, l: L, packet: &Packet) -> L::F;
    /// Asks it of a ray and the triangles of a block: whether that was the last thing to ask of this ray.
    fn in_block(&mut self, s: S, lane: usize, block: &Block, ray: &Ray, constants: &RayConstants, users: &U) -> bool;
    /// Asks it of the `active` rays at a user reference: the rays of which that was the last thing to ask.
    fn at_user(&mut self, bundle: &Bundle<S, L, U>, index: u32, active: u32) -> u32;
    /// Asks it of one ray and the subtree below a child: whether that was the last thing to ask of this ray.
    fn below(
        &mut self,
        bundle: &Bundle<S, L, U>,
        lane: usize,
        child: ChildRef,
        ray: &Ray,
        constants: &RayConstants,
    ) -> bool;
}

/// Occlusion query: any hit.
pub(super) struct AnyHit;

impl<S: Simd, L: Lanes, U: UserLeaves> Question<S, L, U> for AnyHit {
    const ORDERED: bool = false;

    #[inline(always)]
    fn ends(&self, l: L, packet: &Packet) -> L::F {
        l.read(&packet.t_max)
    }

    #[inline(always)]
    fn in_block(&mut self, s: S, _: usize, block: &Block, ray: &Ray, constants: &RayConstants, users: &U) -> bool {
        any_in_block(s, &Shear::new(s, ray, constants), block, ray, users)
    }

    #[inline(always)]
    fn at_user(&mut self, bundle: &Bundle<S, L, U>, index: u32, active: u32) -> u32 {
        at_user_alone(bundle.packet, index, active, bundle.users)
    }

    #[inline(always)]
    fn below(
        &mut self,
        bundle: &Bundle<S, L, U>,
        _: usize,
        child: ChildRef,
        ray: &Ray,
        constants: &RayConstants,
    ) -> bool {
        any_hit_from(bundle.isa, bundle.tree, ray, bundle.users, constants, child)
    }
}

impl<S: Simd, L: Lanes, U: UserLeaves> Question<S, L, U> for &mut Found {
    const ORDERED: bool = true;

    #[inline(always)]
    fn ends(&self, l: L, _: &Packet) -> L::F {
        l.read(&self.t)
    }

    #[inline(always)]
    fn in_block(&mut self, s: S, lane: usize, block: &Block, ray: &Ray, constants: &RayConstants, users: &U) -> bool {
        let (mut t, mut best) = (self.t.0[lane], self.get(lane));
        nearest_in_block(s, &Shear::new(s, ray, constants), block, ray, users, (&mut t, &mut best));
        if let Some(nearest) = best {
            self.set(lane, nearest);
        }
        false
    }

    #[inline(always)]
    fn at_user(&mut self, bundle: &Bundle<S, L, U>, index: u32, active: u32) -> u32 {
        at_user((bundle.isa, bundle.l), bundle.packet, index, active, bundle.users, self);
        0
    }

    #[inline(always)]
    fn below(
        &mut self,
        bundle: &Bundle<S, L, U>,
        lane: usize,
        child: ChildRef,
        ray: &Ray,
        constants: &RayConstants,
    ) -> bool {
        let start = Start { child, t: self.t.0[lane], best: self.get(lane) };
        if let Some(nearest) = nearest_hit_from(bundle.isa, bundle.tree, ray, bundle.users, constants, start) {
            self.set(lane, nearest);
        }
        false
    }
}

/// The query of a bundle.
pub(super) struct Bundle<'a, S: Simd, L: Lanes, U> {
    pub isa: SupportedIsa,
    pub s: S,
    pub l: L,
    pub rows: &'a Rows<L>,
    pub single: &'a SingleRays,
    pub tree: &'a Tree,
    pub packet: &'a Packet,
    pub users: &'a U,
}

impl<S: Simd, L: Lanes, U: UserLeaves> Bundle<'_, S, L, U> {
    /// Asks a question of all rays of a group: those for which it was answered before everything was looked at, and
    /// whether the bundle fell apart. That is where rays went on alone below nodes more often than there are rays.
    #[inline(always)]
    pub fn run<Q: Question<S, L, U>>(&self, group: u32, mut question: Q) -> (u32, bool) {
        let (l, tree) = (self.l, self.tree);
        let (mut open, mut single) = (group, 0);
        let mut stack = BundleStack::new();
        let (mut current, mut active) = (tree.root, group);
        loop {
            if current.is_node() && active.count_ones() >= FEW {
                // SAFETY: the reference comes from the tree and is to a node.
                let node = unsafe { tree.arena.node(current) };
                let ends = question.ends(l, self.packet);
                // Push the farthest child first, so that the nearest one is popped next.
                if Q::ORDERED {
                    let (slots, count) = self.farthest_first(node, group.trailing_zeros() as usize);
                    for &slot in &slots[..count] {
                        let lanes = active & self.rows.enter(l, node, slot, ends);
                        // SAFETY: the stack is deep enough for the tree.
                        unsafe { stack.push(node.children[slot], lanes) };
                    }
                } else {
                    for (slot, &child) in node.children.iter().enumerate() {
                        if child != ChildRef::EMPTY {
                            let lanes = active & self.rows.enter(l, node, slot, ends);
                            // SAFETY: the stack is deep enough for the tree.
                            unsafe { stack.push(child, lanes) };
                        }
                    }
                }
            } else if current.is_user() {
                open &= !question.at_user(self, current.index() as u32, active);
            } else {
                // In leaves, and where the bundle has thinned out, every ray continues with its own test or traversal.
                for lane in Set(active) {
                    let ray = self.packet.ray(lane, self.packet.t_max.0[lane]);
                    let constants = self.single.get(lane);
                    let done = if current.is_block() {
                        // SAFETY: the reference comes from the tree and is to a block.
                        let block = unsafe { tree.arena.block(current) };
                        question.in_block(self.s, lane, block, &ray, &constants, self.users)
                    } else {
                        single += u32::from(current.is_node());
                        question.below(self, lane, current, &ray, &constants)
                    };
                    open &= !(u32::from(done) << lane);
                }
            }
            // Pop children until one has rays that still search; rays that have their answer drop out of the mask.
            loop {
                let Some((child, lanes)) = stack.pop() else { return (group & !open, single > group.count_ones()) };
                active = lanes & open;
                if active != 0 {
                    current = child;
                    break;
                }
            }
        }
    }

    /// The slots of the children of a node that are not empty, and how many there are: farthest from the origin of a
    /// ray first.
    #[inline(always)]
    fn farthest_first(&self, node: &Node, lane: usize) -> ([usize; LANES], usize) {
        let s = self.s;
        let mut square = s.splat(0.0);
        for axis in 0..3 {
            let origin = s.splat(self.packet.origin[axis].0[lane]);
            let (least, greatest) = (s.load(&node.rows[axis]), s.load(&node.rows[axis + 3]));
            // Squared distance of the box from the origin: the part of each coordinate outside the slab.
            let outside = s.max(s.max(s.sub(least, origin), s.sub(origin, greatest)), s.splat(0.0));
            square = s.add(square, s.mul(outside, outside));
        }
        // Unused slots have inverted boxes.
        let chosen = s.bits(s.le(s.load(&node.rows[0]), s.load(&node.rows[3])));
        let (keys, _) = s.sort_descending(square, chosen, ChildRef::bits(&node.children));
        (keys.map(key_lane), chosen.count_ones() as usize)
    }
}
