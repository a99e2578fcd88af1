//! Rays of a packet that go different ways, but begin near each other: they share the nodes around their origins.
//!
//! The boxes of such nodes are tested one after the other with all rays. Where few of the rays are left in a part of the tree, they go on
//! alone.
#![allow(unsafe_code)]

use super::beam::{Apart, Rows};
use super::nearest::single;
use super::stack::{BundleStack, PacketStack, Waiting};
use super::{Found, Packet, Set};
use crate::bvh::Tree;
use crate::dispatch::{SupportedIsa, any_hit_from};
use crate::layout::ChildRef;
use crate::search::{any_in_block, nearest_in_block};
use crate::simd::{LANES, Lanes, Simd, key_lane};
use crate::traverse::{Slabs, Users};
use crate::triangle::Shear;
use steradian_math::Ray;

/// A bundle has at least so many rays. Measured.
const BUNDLE: u32 = 8;
/// With fewer rays than these in a part of the tree, they go on alone. Measured.
const FEW: u32 = 5;

/// What is left of a packet.
#[derive(Clone, Copy)]
pub(super) struct Left {
    /// Rays that must go alone.
    pub alone: u32,
    /// Whether a bundle fell apart, so that it had been better to begin alone.
    pub poor: bool,
}

impl Left {
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

/// Many queries at once.
pub(super) struct Bundle<'a, S: Simd, L: Lanes, U> {
    pub isa: SupportedIsa,
    pub s: S,
    pub l: L,
    pub rows: &'a Rows<L>,
    pub apart: &'a Apart,
    pub tree: &'a Tree,
    pub packet: &'a Packet,
    pub users: &'a U,
}

impl<S: Simd, L: Lanes, U: Users> Bundle<'_, S, L, U> {
    /// Adds the rays that hit anything, and says whether the bundle fell apart.
    /// That is where rays went on alone below nodes more often than there are rays.
    #[inline(always)]
    pub fn any(&self, group: u32, hits: &mut u32) -> bool {
        let (l, tree) = (self.l, self.tree);
        let t_max = l.read(&self.packet.t_max);
        let (mut open, mut apart) = (group, 0);
        let mut stack = BundleStack::new();
        let (mut current, mut active) = (tree.root, group);
        loop {
            if current.is_node() && active.count_ones() >= FEW {
                // SAFETY: the reference comes from the tree and is to a node.
                let node = unsafe { tree.arena.node(current) };
                for (slot, &child) in node.children.iter().enumerate() {
                    if child != ChildRef::EMPTY {
                        let lanes = active & self.rows.enter(l, node, slot, t_max);
                        // SAFETY: the stack is deep enough for the tree.
                        unsafe { stack.push(child, lanes) };
                    }
                }
            } else {
                for lane in Set(active) {
                    let ray = self.ray(lane);
                    let way = self.apart.get(lane);
                    let hit = if current.is_block() {
                        // SAFETY: the reference comes from the tree and is to a block.
                        let block = unsafe { tree.arena.block(current) };
                        any_in_block(self.s, &Shear::new(self.s, &ray, &way), block, &ray, self.users)
                    } else {
                        apart += u32::from(current.is_node());
                        any_hit_from(self.isa, tree, &ray, self.users, &way, current)
                    };
                    open &= !(u32::from(hit) << lane);
                }
            }
            loop {
                let Some((child, lanes)) = stack.pop() else {
                    *hits |= group & !open;
                    return apart > group.count_ones();
                };
                active = lanes & open;
                if active != 0 {
                    current = child;
                    break;
                }
            }
        }
    }

    /// Finds nearest hits, and says whether the bundle fell apart.
    #[inline(always)]
    pub fn nearest(&self, group: u32, found: &mut Found) -> bool {
        let (s, l, tree) = (self.s, self.l, self.tree);
        let mut apart = 0;
        let mut stack = PacketStack::new();
        let (mut current, mut active) = (tree.root, group);
        loop {
            if current.is_node() && active.count_ones() >= FEW {
                // SAFETY: the reference comes from the tree and is to a node.
                let node = unsafe { tree.arena.node(current) };
                let mut present = 0;
                for (slot, &child) in node.children.iter().enumerate() {
                    present |= u32::from(child != ChildRef::EMPTY) << slot;
                }
                // In the order of one of the rays.
                let slabs = Slabs::new(s, &self.apart.get(active.trailing_zeros() as usize));
                let (enter, _) = slabs.test(s, node, s.splat(f32::INFINITY));
                let (keys, children) = s.sort_descending(enter, present, ChildRef::bits(&node.children));
                // SAFETY: the stack is deep enough for the tree.
                unsafe { stack.push(keys, children, current, present.count_ones() as usize) };
            } else {
                for lane in Set(active) {
                    if current.is_block() {
                        let ray = self.ray(lane);
                        let shear = Shear::new(s, &ray, &self.apart.get(lane));
                        // SAFETY: the reference comes from the tree and is to a block.
                        let block = unsafe { tree.arena.block(current) };
                        let (mut t, mut best) = (found.t.0[lane], found.get(lane));
                        if nearest_in_block(s, &shear, block, &ray, self.users, (&mut t, &mut best))
                            && let Some(best) = best
                        {
                            found.set(lane, best);
                        }
                    } else {
                        apart += u32::from(current.is_node());
                        let way = |_: &Ray| self.apart.get(lane);
                        single(self.isa, tree, self.packet, (lane, way), current, self.users, found);
                    }
                }
            }
            loop {
                let Some(Waiting { key, child, parent }) = stack.pop(f32::INFINITY) else {
                    return apart > group.count_ones();
                };
                // SAFETY: parents are nodes of the tree.
                let node = unsafe { tree.arena.node(parent) };
                active = group & self.rows.enter(l, node, key_lane(key) & (LANES - 1), l.read(&found.t));
                if active != 0 {
                    current = child;
                    break;
                }
            }
        }
    }

    /// One of the rays.
    #[inline(always)]
    fn ray(&self, lane: usize) -> Ray {
        self.packet.ray(lane, self.packet.t_max.0[lane])
    }
}
