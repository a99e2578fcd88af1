//! Rays of a packet that go different ways, but begin near each other: they share the nodes around their origins. For the question whether there is
//! a hit: the nearest hit wants each ray to go its own way, from near to far.
//!
//! The boxes of such nodes are tested one after the other with all rays. Where few of the rays are left in a part of the tree, they go on
//! alone.
#![allow(unsafe_code)]

use super::beam::{Apart, Rows};
use super::stack::BundleStack;
use super::{Packet, Set};
use crate::bvh::Tree;
use crate::dispatch::{SupportedIsa, any_hit_from};
use crate::layout::ChildRef;
use crate::search::any_in_block;
use crate::simd::{Lanes, Simd};
use crate::traverse::Users;
use crate::triangle::Shear;

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

/// The query of a bundle.
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
    pub fn run(&self, group: u32, hits: &mut u32) -> bool {
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
                    let ray = self.packet.ray(lane, self.packet.t_max.0[lane]);
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
}
