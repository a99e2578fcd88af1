//! Which rays of a packet hit anything.
#![allow(unsafe_code)]

use super::beam::{Beam, Ways};
use super::interval::Interval;
use super::stack::{PacketStack, Waiting};
use super::{FEW, Packet, Set};
use crate::UserHit;
use crate::bvh::Tree;
use crate::dispatch::{SupportedIsa, any_hit_from};
use crate::layout::{Block, ChildRef};
use crate::simd::{LANES, Lanes, Simd, Wide, key, key_lane};
use crate::traverse::Users;
use crate::triangle::Crossing;

/// The rays in `lanes` that hit anything.
#[inline(always)]
pub(crate) fn any_packet<S: Simd, L: Lanes, U: Users>(
    isa: SupportedIsa,
    (s, l): (S, L),
    tree: &Tree,
    packet: &Packet,
    lanes: u32,
    users: &U,
) -> u32 {
    let ways = Ways::new(l, packet);
    let lanes = lanes & ways.valid;
    let (mut rest, mut alone) = (lanes & ways.finite, lanes & !ways.finite);
    let mut hits = 0;
    while rest != 0 {
        let group = ways.like_first(rest);
        rest &= !group;
        if group.count_ones() < FEW {
            alone |= group;
        } else {
            let beam = ways.beam(l, group.trailing_zeros() as usize);
            hits |= Query { isa, s, l, tree, packet, users, beam }.run(group);
        }
    }
    for lane in Set(alone) {
        hits |= u32::from(single(isa, tree, packet, lane, tree.root, users)) << lane;
    }
    hits
}

/// Goes on with one ray of a packet below a child.
#[inline(always)]
fn single<U: Users>(isa: SupportedIsa, tree: &Tree, packet: &Packet, lane: usize, child: ChildRef, users: &U) -> bool {
    any_hit_from(isa, tree, &packet.ray(lane, packet.t_max.0[lane]), users, child)
}

/// The query of a beam.
struct Query<'a, S: Simd, L: Lanes, U> {
    isa: SupportedIsa,
    s: S,
    l: L,
    tree: &'a Tree,
    packet: &'a Packet,
    users: &'a U,
    beam: Beam<L>,
}

impl<S: Simd, L: Lanes, U: Users> Query<'_, S, L, U> {
    #[inline(always)]
    fn run(&self, group: u32) -> u32 {
        let (s, l, tree) = (self.s, self.l, self.tree);
        let interval = Interval::new(s, l, &self.beam, group);
        let t_max = l.read(&self.packet.t_max);
        let farthest = l.greatest(l.select(l.mask(group), t_max, l.splat(f32::NEG_INFINITY)));
        let mut stack = PacketStack::new();
        // Rays that have hit nothing yet, and those of them that enter the box of the present child.
        let (mut open, mut active) = (group, group);
        let mut current = tree.root;
        loop {
            if current.is_node() {
                // SAFETY: the reference comes from the tree and is to a node.
                let node = unsafe { tree.node(current) };
                let (_, lanes) = interval.test(s, node, s.splat(farthest));
                for slot in Set(lanes) {
                    let slot = slot & (LANES - 1);
                    let waiting = Waiting { key: key(0.0, slot), child: node.children[slot], parent: current };
                    // SAFETY: the stack is deep enough for the tree.
                    unsafe { stack.push(waiting) };
                }
            } else {
                if current.is_block() {
                    open &= !self.block(current, active, t_max);
                } else if current != ChildRef::EMPTY {
                    open &= !self.user(current.index() as u32, active);
                }
                if open == 0 {
                    return group;
                }
            }
            loop {
                let Some(Waiting { key, child, parent }) = stack.pop(farthest) else { return group & !open };
                // SAFETY: parents are nodes of the tree.
                let node = unsafe { tree.node(parent) };
                active = open & self.beam.enters(l, node, key_lane(key), t_max);
                if active.count_ones() >= FEW {
                    current = child;
                    break;
                }
                for lane in Set(active) {
                    if single(self.isa, tree, self.packet, lane, child, self.users) {
                        open &= !(1 << lane);
                    }
                }
                if open == 0 {
                    return group;
                }
            }
        }
    }

    /// The active rays that hit a triangle of a block.
    #[inline(always)]
    fn block(&self, reference: ChildRef, active: u32, t_max: L::F) -> u32 {
        let (s, l) = (self.s, self.l);
        // SAFETY: the reference comes from the tree and is to a block.
        let block = unsafe { self.tree.block(reference) };
        let row = s.load(&block.rows[0]);
        let mut open = active;
        for slot in Set(s.bits(s.eq(row, row))) {
            let slot = slot & (LANES - 1);
            if let Some(crossing) = self.beam.cross(l, block, slot, t_max) {
                open &= !self.triangle(block.ids[slot], &crossing, open, t_max);
                if open == 0 {
                    break;
                }
            }
        }
        active & !open
    }

    /// The open rays whose hit on a triangle counts.
    #[inline(always)]
    fn triangle(&self, id: u32, crossing: &Crossing<L>, open: u32, t_max: L::F) -> u32 {
        let l = self.l;
        let hits = crossing.lanes & open & l.bits(l.lt(crossing.t, t_max));
        let index = id & !Block::FILTERED;
        if id == index {
            return hits;
        }
        let mut rows = [Wide::splat(0.0); 4];
        l.write(crossing.t, &mut rows[0]);
        l.write(crossing.v, &mut rows[1]);
        l.write(crossing.w, &mut rows[2]);
        l.write(crossing.sum, &mut rows[3]);
        let mut accepted = 0;
        for lane in Set(hits) {
            let [t, v, w, sum] = [rows[0].0[lane], rows[1].0[lane], rows[2].0[lane], rows[3].0[lane]];
            let ray = self.packet.ray(lane, self.packet.t_max.0[lane]);
            accepted |= u32::from(self.users.accept(index, UserHit { t, u: v / sum, v: w / sum }, &ray)) << lane;
        }
        accepted
    }

    /// The active rays that hit what is at a user reference.
    #[inline(always)]
    fn user(&self, index: u32, active: u32) -> u32 {
        if let Some(hits) = self.users.occluded_packet(self.isa, index, self.packet, active) {
            return hits;
        }
        let mut hits = 0;
        for lane in Set(active) {
            let ray = self.packet.ray(lane, self.packet.t_max.0[lane]);
            hits |= u32::from(self.users.occluded(index, &ray)) << lane;
        }
        hits
    }
}
