//! Which rays of a packet hit anything.
#![expect(unsafe_code, reason = "unchecked reads; each place states why it is sound")]

use super::beam::{Beam, BeamConstants, ShearedRays, SingleRays};
use super::bundle::{AnyHit, Bundle, RemainingRays};
use super::interval::{Interval, range};
use super::seen::{Boxes, Seen};
use super::stack::{PacketStack, Waiting};
use super::{Set, accepted, beam};
use crate::layout::{Block, ChildRef};
use crate::leaves::UserLeaves;
use crate::packet_rays::Packet;
use crate::ray_constants::RayConstants;
use crate::simd::{LANES, Lanes, Simd, key_lane};
use crate::single::any_hit_from;
use crate::supported_isa::SupportedIsa;
use crate::tree::Tree;
use crate::triangle::Crossing;

/// Slopes of a beam differ by less than this. Measured.
const NARROW: f32 = 0.6;

/// With fewer rays of a beam than these in a part of the tree, they go on alone. Measured: nearest hits are found
/// faster together.
const FEW: u32 = 4;

/// The rays in `lanes` that hit anything.
#[inline(always)]
pub(crate) fn any_packet<S: Simd, L: Lanes, U: UserLeaves>(
    isa: SupportedIsa,
    (s, l): (S, L),
    tree: &Tree,
    packet: &Packet,
    lanes: u32,
    users: &U,
) -> u32 {
    // Trace beams and bundles together, then each remaining ray on its own from the root.
    let (mut hits, left) = any_beams(isa, (s, l), tree, packet, (lanes, true), users);
    for lane in Set(left.alone) {
        let ray = packet.ray(lane, packet.t_max.0[lane]);
        hits |=
            u32::from(any_hit_from(isa, tree, &ray, users, &RayConstants::new(&ray, &tree.bounds), tree.root)) << lane;
    }
    hits
}

/// Occlusion of the rays that go nearly the same way, or begin near each other: the rays that hit anything, and the
/// rays that remain.
#[inline(always)]
pub(super) fn any_beams<S: Simd, L: Lanes, U: UserLeaves>(
    isa: SupportedIsa,
    (s, l): (S, L),
    tree: &Tree,
    packet: &Packet,
    (lanes, may_bundle): (u32, bool),
    users: &U,
) -> (u32, RemainingRays) {
    let beam_constants = BeamConstants::new(l, packet);
    let single = beam_constants.single(l);
    let lanes = lanes & beam_constants.valid;
    // Rays that hardly move along an axis need limited reciprocals, which only the constants of single rays have.
    let (mut rest, mut alone) = (lanes & beam_constants.moving, lanes & !beam_constants.moving);
    let mut hits = 0;
    while rest != 0 {
        // Form a beam of all rays that share the signs and the greatest axis of the first one.
        let group = beam_constants.like_first(rest);
        rest &= !group;
        if group.count_ones() < beam(isa.width()) {
            alone |= group;
            continue;
        }
        let beam = beam_constants.beam(group.trailing_zeros() as usize);
        // A wide beam overlaps nearly every box of a large tree: its interval test would cull nothing.
        if !tree.is_small() && !beam.is_narrow(l, group, NARROW) {
            alone |= group;
        } else {
            hits |= Query { isa, s, l, tree, packet, users, beam, single: &single }.run(group);
        }
    }
    // Bundle what no beam has taken, so that the nodes around the origins are fetched once for all of it.
    let bundle = Bundle { isa, s, l, rows: &beam_constants.rows, single: &single, tree, packet, users };
    let mut left = RemainingRays { alone, poor: false };
    let group = if may_bundle { left.bundle(beam_constants.moving) } else { 0 };
    if group != 0 {
        let (occluded, poor) = bundle.run(group, AnyHit);
        hits |= occluded;
        left.poor = poor;
    }
    (hits, left)
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
    single: &'a SingleRays,
}

impl<S: Simd, L: Lanes, U: UserLeaves> Query<'_, S, L, U> {
    #[inline(always)]
    fn run(&self, group: u32) -> u32 {
        let (s, l, tree) = (self.s, self.l, self.tree);
        // Bound the origins and reciprocals of the beam: one slab test with these bounds culls children for all its
        // rays.
        let interval = Interval::new(s, l, &self.beam, group);
        let t_max = l.read(&self.packet.t_max);
        let ends @ [_, farthest] = range(l, l.mask(group), t_max);
        let mut stack = PacketStack::new();
        // Rays that have hit nothing yet, and those of them that enter the box of the present child.
        let (mut open, mut active) = (group, group);
        let mut current = tree.root;
        loop {
            let mut next = None;
            if current.is_node() {
                // SAFETY: the reference comes from the tree and is to a node.
                let node = unsafe { tree.arena.node(current) };
                // Cull the eight children against the beam up to the farthest end of its rays.
                let (enter, lanes) = interval.test(s, node, s.splat(farthest));
                if lanes != 0 {
                    tree.prefetch_children(node, lanes);
                    // The nearest child is next, and known before the order of the others.
                    let slot = s.nearest(enter, lanes) & (LANES - 1);
                    next = Some(Waiting { key: slot as u32, child: node.children[slot], parent: current });
                    let (keys, children) = s.sort_descending(enter, lanes, ChildRef::bits(&node.children));
                    // SAFETY: the stack is deep enough for the tree.
                    unsafe { stack.push(keys, children, current, lanes.count_ones() as usize - 1) };
                }
            } else {
                if current.is_block() {
                    // Close the rays that hit something in the leaf; an occlusion query ends with the first hit of
                    // each.
                    open &= !self.block(&interval, current, active, ends);
                } else if current != ChildRef::EMPTY {
                    open &= !self.user(current.index() as u32, active);
                }
                if open == 0 {
                    return group;
                }
            }
            // Take the next child and test its box with all open rays: the beam's bounds alone are conservative.
            loop {
                let Some(Waiting { key, child, parent }) = next.take().or_else(|| stack.pop(farthest)) else {
                    return group & !open;
                };
                // SAFETY: parents are nodes of the tree.
                let node = unsafe { tree.arena.node(parent) };
                active = open & self.beam.enters(l, node, key_lane(key), t_max);
                if active.count_ones() >= FEW.min(self.isa.width() as u32 / 2) {
                    current = child;
                    break;
                }
                // Too few rays are left for shared tests: let each search this subtree alone.
                for lane in Set(active) {
                    let ray = self.packet.ray(lane, self.packet.t_max.0[lane]);
                    if any_hit_from(self.isa, tree, &ray, self.users, &self.single.get(lane), child) {
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
    fn block(&self, interval: &Interval<S>, reference: ChildRef, active: u32, [nearest, farthest]: [f32; 2]) -> u32 {
        // SAFETY: the reference comes from the tree and is to a block.
        let block = unsafe { self.tree.arena.block(reference) };
        let boxes = Boxes::new(self.s, interval, block, farthest);
        // Where a hit is exactly matters to rays that end.
        let some_end = nearest < f32::INFINITY;
        // Where all active rays lie in one register, test with that half only.
        match self.l.half_of(active) {
            Some(first) => self.triangles(self.l.half(), (block, &boxes), (first, active >> first), some_end) << first,
            None => self.triangles(self.l, (block, &boxes), (0, active), some_end),
        }
    }

    /// The active rays that hit a triangle of a block, for the rays from `first` on; `active` counts from there, as do
    /// the answers.
    #[inline(always)]
    fn triangles<K: Lanes>(
        &self,
        k: K,
        (block, boxes): (&Block, &Boxes),
        (first, active): (usize, u32),
        some_end: bool,
    ) -> u32 {
        let sheared = ShearedRays::new(k, self.packet, self.single, first, self.beam.axes);
        let t_max = k.read_from(&self.packet.t_max, first);
        let mut open = active;
        let mut seen = Seen::new(boxes.entered);
        while seen.rest != 0 && open != 0 {
            // Compute edge functions until every open ray may hit one of the triangles, then solve for the distances.
            seen.look(k, &sheared, block, open, true);
            for slot in Set(seen.slots) {
                let slot = slot & (LANES - 1);
                // SAFETY: the slot is in the set.
                if let Some(mut crossing) = unsafe { seen.cross(k, &sheared, block, slot, t_max) } {
                    if some_end {
                        crossing.t = boxes.at_least(k, &sheared, slot, &crossing);
                    }
                    let Crossing { lanes, t, v, w, sum, .. } = crossing;
                    let mut hits = lanes & open & k.bits(k.lt(t, t_max));
                    let index = block.ids[slot] & !Block::FILTERED;
                    // Ask the caller's filter, for example an alpha test, before a hit counts.
                    if block.ids[slot] != index {
                        hits = accepted(k, self.packet, self.users, index, [t, v, w, sum], (first, hits));
                    }
                    open &= !hits;
                    if open == 0 {
                        break;
                    }
                }
            }
        }
        active & !open
    }

    /// The active rays that hit what is at a user reference.
    #[inline(always)]
    fn user(&self, index: u32, active: u32) -> u32 {
        // Fewer would go alone below.
        if active.count_ones() >= beam(self.isa.width())
            && let Some(hits) = self.users.occluded_packet(self.isa, index, self.packet, active)
        {
            return hits;
        }
        at_user_alone(self.packet, index, active, self.users)
    }
}

/// The active rays that hit what is at a user reference, asked one after the other.
#[inline(always)]
pub(super) fn at_user_alone<U: UserLeaves>(packet: &Packet, index: u32, active: u32, users: &U) -> u32 {
    let mut hits = 0;
    for lane in Set(active) {
        let ray = packet.ray(lane, packet.t_max.0[lane]);
        hits |= u32::from(users.occluded(index, &ray)) << lane;
    }
    hits
}
