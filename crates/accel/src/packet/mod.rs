//! Queries of many rays: packets that go through the hierarchy together while they stay close to each other, and single
//! rays where they do not. Every ray gets the bits that it gets alone.
//!
//! A packet has as many rays as two registers have lanes: what is found about nodes is shared by more rays, and two
//! chains of operations do not wait for each other. Rays whose directions have the same signs and the same greatest
//! axis form a beam. One test of a beam's bounds against the eight children of a node sorts out most of them; each of
//! the rest is then tested with all rays of the beam when its turn comes (Boulos et al., "Packet-based Whitted and
//! Distribution Ray Tracing", 2007; Benthin and Wald, "Efficient Ray Traversal on Multi-Core x86 Hardware", 2012, for
//! going on with single rays). Where the rays that enter the box of a block are in one of the registers, the other is
//! left out of the tests of its triangles. Rays of no beam share the nodes around their origins as a bundle. What is
//! left goes alone, one ray after the other or several at once.

mod any;
mod batch;
mod beam;
mod bundle;
mod flight;
mod interval;
mod nearest;
mod seen;
mod stack;

pub(crate) use any::any_packet;
pub(crate) use batch::{any_batch, nearest_batch};
pub(crate) use nearest::nearest_packet;

use crate::UserHit;
use crate::leaves::UserLeaves;
use crate::packet_rays::Packet;
use crate::simd::{Lanes, WIDE, Wide};

/// A beam has at least so many rays; others go alone. Measured.
const BEAM: u32 = 8;

/// Least number of rays of a beam in packets of `width` rays.
#[inline(always)]
fn beam(width: usize) -> u32 {
    BEAM.min(width as u32)
}

/// The first lanes, at least one.
#[inline(always)]
fn first_lanes(count: usize) -> u32 {
    u32::MAX >> (WIDE - count)
}

/// The rays, from one on, whose hits on a filtered triangle the caller accepts: distances, parameters times their sums,
/// and these are given.
#[inline(always)]
fn accepted<L: Lanes, U: UserLeaves>(
    l: L,
    packet: &Packet,
    users: &U,
    index: u32,
    hits: [L::F; 4],
    (first, lanes): (usize, u32),
) -> u32 {
    let mut rows = [Wide::splat(0.0); 4];
    for (row, hits) in rows.iter_mut().zip(hits) {
        l.write(hits, row);
    }
    let mut accepted = 0;
    for lane in Set(lanes) {
        let [t, v, w, sum] = [rows[0].0[lane], rows[1].0[lane], rows[2].0[lane], rows[3].0[lane]];
        let ray = packet.ray(first + lane, packet.t_max.0[first + lane]);
        accepted |= u32::from(users.accept(index, UserHit { t, u: v / sum, v: w / sum }, &ray)) << lane;
    }
    accepted
}

/// The lanes of a set, from the lowest.
#[derive(Clone, Copy)]
pub(crate) struct Set(pub u32);

impl Iterator for Set {
    type Item = usize;

    #[inline(always)]
    fn next(&mut self) -> Option<usize> {
        if self.0 == 0 {
            return None;
        }
        let lane = self.0.trailing_zeros() as usize & (WIDE - 1);
        self.0 &= self.0 - 1;
        Some(lane)
    }
}
