//! The nearest hits of the rays of a packet.
#![expect(unsafe_code, reason = "unchecked reads; each place states why it is sound")]

use super::beam::{Beam, BeamConstants, ShearedRays, SingleRays};
use super::bundle::{Bundle, RemainingRays};
use super::interval::Interval;
use super::seen::{Boxes, Seen};
use super::stack::{PacketStack, Waiting};
use super::{Set, accepted, beam};
use crate::layout::{Block, ChildRef};
use crate::leaves::UserLeaves;
use crate::nearest::{Extra, Nearest, Start};
use crate::packet_hits::Found;
use crate::packet_rays::Packet;
use crate::ray_constants::RayConstants;
use crate::simd::{LANES, Lanes, Simd, key_lane};
use crate::single::nearest_hit_from;
use crate::supported_isa::SupportedIsa;
use crate::tree::Tree;
use crate::triangle::Crossing;

/// Slopes of a beam differ by less than this. Measured.
const NARROW: f32 = 0.4;

/// Finds the nearest hits of the rays in `lanes`: `found` begins with the ends of the intervals.
#[inline(always)]
pub(crate) fn nearest_packet<S: Simd, L: Lanes, U: UserLeaves>(
    isa: SupportedIsa,
    (s, l): (S, L),
    tree: &Tree,
    packet: &Packet,
    lanes: u32,
    users: &U,
    found: &mut Found,
) {
    for lane in Set(nearest_beams(isa, (s, l), tree, packet, (lanes, tree.only_triangles), users, found).alone) {
        let ray = packet.ray(lane, packet.t_max.0[lane]);
        let start = Start { child: tree.root, t: found.t.0[lane], best: None };
        if let Some(nearest) = nearest_hit_from(isa, tree, &ray, users, &RayConstants::new(&ray, &tree.bounds), start) {
            found.set(lane, nearest);
        }
    }
}

/// Finds the nearest hits of those rays that go nearly the same way, or begin near each other; and says what is left to
/// do.
#[inline(always)]
pub(super) fn nearest_beams<S: Simd, L: Lanes, U: UserLeaves>(
    isa: SupportedIsa,
    (s, l): (S, L),
    tree: &Tree,
    packet: &Packet,
    (lanes, may_bundle): (u32, bool),
    users: &U,
    found: &mut Found,
) -> RemainingRays {
    let beam_constants = BeamConstants::new(l, packet);
    let single = beam_constants.single(l);
    let lanes = lanes & beam_constants.valid;
    let (mut rest, mut alone) = (lanes & beam_constants.moving, lanes & !beam_constants.moving);
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
            Query { isa, s, l, tree, packet, users, beam, single: &single }.run(group, found);
        }
    }
    // Bundle what no beam has taken.
    let bundle = Bundle { isa, s, l, rows: &beam_constants.rows, single: &single, tree, packet, users };
    let mut left = RemainingRays { alone, poor: false };
    let group = if may_bundle { left.bundle(beam_constants.moving) } else { 0 };
    if group != 0 {
        (_, left.poor) = bundle.run(group, found);
    }
    left
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
    fn run(&self, group: u32, found: &mut Found) {
        let (s, l, tree) = (self.s, self.l, self.tree);
        // Bound the origins and reciprocals of the beam for one slab test on behalf of all its rays.
        let interval = Interval::new(s, l, &self.beam, group);
        let in_group = l.mask(group);
        let none = l.splat(f32::NEG_INFINITY);
        let mut stack = PacketStack::new();
        let mut active = group;
        let mut current = tree.root;
        // The farthest of the rays' hits so far.
        let mut farthest = l.greatest(l.select(in_group, l.read(&found.t), none));
        loop {
            let mut next = None;
            if current.is_node() {
                // SAFETY: the reference comes from the tree and is to a node.
                let node = unsafe { tree.arena.node(current) };
                // Cull the eight children against the beam up to its farthest hit so far.
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
                // Intersect the leaf; a nearer hit may shorten the interval of the whole beam.
                let hits = if current.is_block() {
                    self.block(&interval, current, active, farthest, found)
                } else {
                    current != ChildRef::EMPTY
                        && at_user((self.isa, l), self.packet, current.index() as u32, active, self.users, found)
                };
                if hits {
                    farthest = l.greatest(l.select(in_group, l.read(&found.t), none));
                }
            }
            // Pop the next child that begins before the farthest hit and that some ray enters.
            loop {
                let Some(Waiting { key, child, parent }) = next.take().or_else(|| stack.pop(farthest)) else { return };
                // SAFETY: parents are nodes of the tree.
                let node = unsafe { tree.arena.node(parent) };
                active = group & self.beam.enters(l, node, key_lane(key), l.read(&found.t));
                if active != 0 {
                    current = child;
                    break;
                }
            }
        }
    }

    /// Tests the triangles of a block with the active rays, and says whether there may be hits.
    #[inline(always)]
    fn block(
        &self,
        interval: &Interval<S>,
        reference: ChildRef,
        active: u32,
        farthest: f32,
        found: &mut Found,
    ) -> bool {
        // SAFETY: the reference comes from the tree and is to a block.
        let block = unsafe { self.tree.arena.block(reference) };
        let boxes = Boxes::new(self.s, interval, block, farthest);
        // Where all active rays lie in one register, test with that half only.
        match self.l.half_of(active) {
            Some(first) => self.triangles(self.l.half(), (block, &boxes), (first, active >> first), found),
            None => self.triangles(self.l, (block, &boxes), (0, active), found),
        }
    }

    /// Tests the triangles of a block with the rays from `first` on; `active` counts from there. True if there may be
    /// hits.
    #[inline(always)]
    fn triangles<K: Lanes>(
        &self,
        k: K,
        (block, boxes): (&Block, &Boxes),
        (first, active): (usize, u32),
        found: &mut Found,
    ) -> bool {
        let sheared = ShearedRays::new(k, self.packet, self.single, first, self.beam.axes);
        // Evaluate the edge functions of all triangles in entered boxes first, then solve for the distances of the
        // survivors.
        let mut seen = Seen::new(boxes.entered);
        seen.look(k, &sheared, block, active, false);
        let mut hits = false;
        for slot in Set(seen.slots) {
            let slot = slot & (LANES - 1);
            let so_far = k.read_from(&found.t, first);
            // SAFETY: the slot is in the set.
            if let Some(mut crossing) = unsafe { seen.cross(k, &sheared, block, slot, so_far) } {
                // Move a hit in front of its triangle's box to the box, so that culling by boxes never contradicts it.
                crossing.t = boxes.at_least(k, &sheared, slot, &crossing);
                crossing.lanes &= active & k.bits(k.le(crossing.t, so_far));
                self.triangle(k, block.ids[slot], &crossing, first, found);
                hits = true;
            }
        }
        hits
    }

    /// Takes over hits on a triangle.
    #[inline(always)]
    fn triangle<K: Lanes>(&self, k: K, id: u32, crossing: &Crossing<K>, first: usize, found: &mut Found) {
        let &Crossing { lanes, t, v, w, sum, .. } = crossing;
        let index = id & !Block::FILTERED;
        // Nearer hits replace; equal distances are resolved below, so that results do not depend on the order of
        // visits.
        let mut closer = lanes & k.bits(k.lt(t, k.read_from(&found.t, first)));
        for lane in Set(lanes & !closer) {
            // At equal distance the smaller index wins.
            if found.hits >> (first + lane) & 1 == 1 && index < found.index(first + lane) {
                closer |= 1 << lane;
            }
        }
        if id != index {
            closer = accepted(k, self.packet, self.users, index, [t, v, w, sum], (first, closer));
        }
        if closer != 0 {
            let extra = f32::from_bits(self.users.triangle().bits());
            found.merge(k, (first, closer), [t, v, w, sum], index, k.splat(extra));
        }
    }
}

/// Asks for nearer hits of active rays at a user reference, and says whether there may be some.
#[inline(always)]
pub(super) fn at_user<L: Lanes, U: UserLeaves>(
    (isa, l): (SupportedIsa, L),
    packet: &Packet,
    index: u32,
    active: u32,
    users: &U,
    found: &mut Found,
) -> bool {
    // Fewer would go alone below.
    if active.count_ones() >= beam(isa.width()) {
        // Descend with the packet into the instance; intervals end at the hits so far, inclusive where this index wins
        // ties.
        let mut t_max = found.t;
        for lane in Set(active & found.hits) {
            t_max.0[lane] = end(found, lane, index);
        }
        let mut inner = Found::nothing(&t_max);
        if users.intersect_packet(isa, index, packet, active, &mut inner) {
            if inner.hits != 0 {
                let new = [l.read(&inner.t), l.read(&inner.u), l.read(&inner.v), l.read(&inner.sum)];
                // Below an instance the index is that of the primitive.
                found.merge(l, (0, inner.hits), new, index, l.read(&inner.index));
            }
            return inner.hits != 0;
        }
    }
    // Test user primitives, and instances with few rays, one ray at a time.
    for lane in Set(active) {
        let t_max = end(found, lane, index);
        if let Some((hit, extra)) = users.intersect(index, &packet.ray(lane, t_max))
            && hit.t > 0.0
            && hit.t < t_max
        {
            found.set(lane, Nearest { hit, index, extra });
        }
    }
    true
}

/// End of a ray's interval for a primitive with an index: one that may win a tie sees the hit so far in it.
#[inline(always)]
fn end(found: &Found, lane: usize, index: u32) -> f32 {
    let t = found.t.0[lane];
    if found.hits >> lane & 1 == 1 && index < found.index(lane) { t.next_up() } else { t }
}
