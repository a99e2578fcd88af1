//! Slices of rays, packet by packet.

use super::any::any_beams;
use super::bundle::RemainingRays;
use super::flight::alone;
use super::nearest::nearest_beams;
use super::{Set, beam, first_lanes};
use crate::arena::prefetch;
use crate::leaves::UserLeaves;
use crate::nearest::{Extra, Nearest};
use crate::packet_hits::Found;
use crate::packet_rays::Packet;
use crate::ray_constants::axes;
use crate::search::{Any, Closest};
use crate::simd::{Lanes, Simd, WIDE};
use crate::single::{any_hit, nearest_hit};
use crate::supported_isa::SupportedIsa;
use crate::tree::Tree;
use crate::{Hit, UserHit};
use std::cell::Cell;
use steradian_math::Ray;

/// True if some rays include enough for a beam with directions of the same signs and the same greatest axis. Otherwise
/// nothing is done in the widest registers, whose use makes a processor slower for a while.
#[inline(always)]
fn may_be_beam(rays: &[Ray], width: usize) -> bool {
    let mut counts = [0; 32];
    rays.iter().any(|ray| {
        // Classify by octant and dominant axis: 8 × 3 classes in 32 counters.
        let d = &ray.direction;
        let signs = u32::from(d.x < 0.0) | u32::from(d.y < 0.0) << 1 | u32::from(d.z < 0.0) << 2;
        let count = &mut counts[(signs as usize) << 2 | axes(*d)[2]];
        *count += 1;
        *count >= beam(width)
    })
}

/// After a packet of which most rays went alone, so many packets are not tried: their rays go alone at once.
const PAUSE: usize = 7;

/// Whole rays in a line of memory.
const IN_LINE: usize = 2;

/// Rays that go alone, until there are enough of them.
struct Alone {
    places: [u32; Self::MOST],
    len: usize,
}

impl Alone {
    const MOST: usize = 256;

    fn new() -> Self {
        Self { places: [0; Self::MOST], len: 0 }
    }

    /// Adds rays of a packet that begins at a place.
    #[inline(always)]
    fn add(&mut self, first: usize, lanes: u32) {
        for lane in Set(lanes) {
            self.places[self.len] = (first + lane) as u32;
            self.len += 1;
        }
    }

    /// True if there is no room for another packet.
    #[inline(always)]
    fn is_full(&self) -> bool {
        self.len + WIDE > Self::MOST
    }

    /// Takes all of them.
    #[inline(always)]
    fn take(&mut self) -> &[u32] {
        &self.places[..std::mem::take(&mut self.len)]
    }
}

/// Many queries of one kind.
trait Batch<S: Simd, L: Lanes> {
    /// True if bundles may be faster.
    fn may_bundle(&self) -> bool;
    /// Traces the packet that begins at a place and has so many rays, with bundles or without, and says what is left to
    /// do.
    fn together(&self, s: S, l: L, packet: (usize, usize), may_bundle: bool) -> RemainingRays;
    /// Traces rays alone.
    fn alone(&self, s: S, places: &[u32]);

    /// The rays.
    fn rays(&self) -> &[Ray];

    /// Traces all rays, in packets of at most so many: the next packets in one go, those that go alone when there are
    /// enough of them.
    #[inline(always)]
    fn run(&self, s: S, l: L, width: usize) {
        let rays = self.rays();
        let (mut done, mut pausing, mut doubtful, mut may_bundle) = (0, 0, true, self.may_bundle());
        let mut waiting = Alone::new();
        while done < rays.len() {
            let len = L::COUNT.min(width).min(rays.len() - done);
            let all = first_lanes(len);
            // Prefetch the rays of the next packet while this one is traced.
            for ray in rays[done + len..].iter().take(len).step_by(IN_LINE) {
                prefetch(ray);
            }
            let lanes = if pausing > 0 {
                pausing -= 1;
                all
            } else {
                // Without bundles, and after an incoherent packet, count ray classes before touching the wide
                // registers.
                let hopeless = doubtful && !may_bundle && !may_be_beam(&rays[done..done + len], width);
                let lanes = if hopeless {
                    all
                } else {
                    let left = self.together(s, l, (done, len), may_bundle);
                    may_bundle &= !left.poor;
                    left.alone
                };
                // A packet of which more than three quarters of the rays went alone is incoherent; pause before the
                // next attempt.
                doubtful = lanes.count_ones() as usize * 4 > len * 3;
                pausing = if doubtful { PAUSE } else { 0 };
                lanes
            };
            waiting.add(done, lanes);
            done += len;
            if waiting.is_full() || done == rays.len() {
                self.alone(s, waiting.take());
            }
        }
    }
}

/// The nearest hits of rays.
struct ClosestHits<'a, U> {
    isa: SupportedIsa,
    tree: &'a Tree,
    rays: &'a [Ray],
    users: &'a U,
    hits: &'a [Cell<Option<Hit>>],
}

impl<S: Simd, L: Lanes, U: UserLeaves> Batch<S, L> for ClosestHits<'_, U> {
    /// Bundles need hits that are independent of the order of visits. Those of triangles are, see [`crate::triangle`];
    /// user primitives report their own.
    #[inline(always)]
    fn may_bundle(&self) -> bool {
        self.tree.only_triangles || self.users.in_any_order()
    }

    #[inline(always)]
    fn rays(&self) -> &[Ray] {
        self.rays
    }

    #[inline(always)]
    fn together(&self, s: S, l: L, (first, len): (usize, usize), may_bundle: bool) -> RemainingRays {
        let packet = Packet::new(l, &self.rays[first..first + len]);
        let mut found = Found::nothing(&packet.t_max);
        let lanes = (first_lanes(len), may_bundle);
        let left = nearest_beams(self.isa, (s, l), self.tree, &packet, lanes, self.users, &mut found);
        // Divide the scaled barycentrics by their sum once for the whole packet, not at each candidate hit.
        let sum = l.read(&found.sum);
        l.write(l.div(l.read(&found.u), sum), &mut found.u);
        l.write(l.div(l.read(&found.v), sum), &mut found.v);
        for (lane, hit) in self.hits[first..first + len].iter().enumerate() {
            let lane = lane & (WIDE - 1);
            hit.set((found.hits >> lane & 1 == 1).then(|| {
                let parameters = UserHit { t: found.t.0[lane], u: found.u.0[lane], v: found.v.0[lane] };
                let extra = U::Extra::from_bits(found.extra.0[lane].to_bits());
                self.users.hit(Nearest { hit: parameters, index: found.index(lane), extra })
            }));
        }
        left
    }

    #[inline(always)]
    fn alone(&self, s: S, places: &[u32]) {
        let ask = |ray: &Ray| nearest_hit(self.isa, self.tree, ray, self.users);
        alone::<S, U, Closest<S, U::Extra>>(ask, s, self.tree, self.rays, self.users, places, |place, nearest| {
            self.hits[place].set(nearest.map(|nearest| self.users.hit(nearest)));
        });
    }
}

/// Which rays hit anything.
struct AnyHits<'a, U> {
    isa: SupportedIsa,
    tree: &'a Tree,
    rays: &'a [Ray],
    users: &'a U,
    occluded: &'a [Cell<bool>],
}

impl<S: Simd, L: Lanes, U: UserLeaves> Batch<S, L> for AnyHits<'_, U> {
    #[inline(always)]
    fn may_bundle(&self) -> bool {
        true
    }

    #[inline(always)]
    fn rays(&self) -> &[Ray] {
        self.rays
    }

    #[inline(always)]
    fn together(&self, s: S, l: L, (first, len): (usize, usize), may_bundle: bool) -> RemainingRays {
        let packet = Packet::new(l, &self.rays[first..first + len]);
        let (hits, left) = any_beams(self.isa, (s, l), self.tree, &packet, (first_lanes(len), may_bundle), self.users);
        for (lane, occluded) in self.occluded[first..first + len].iter().enumerate() {
            occluded.set(hits >> lane & 1 == 1);
        }
        left
    }

    #[inline(always)]
    fn alone(&self, s: S, places: &[u32]) {
        let ask = |ray: &Ray| any_hit(self.isa, self.tree, ray, self.users);
        alone::<S, U, Any<S>>(ask, s, self.tree, self.rays, self.users, places, |place, hit| {
            self.occluded[place].set(hit)
        });
    }
}

/// The nearest hits of rays.
#[inline(always)]
pub(crate) fn nearest_batch<S: Simd, L: Lanes, U: UserLeaves>(
    isa: SupportedIsa,
    (s, l): (S, L),
    tree: &Tree,
    rays: &[Ray],
    users: &U,
    hits: &mut [Option<Hit>],
) {
    assert_eq!(rays.len(), hits.len(), "as many answers as rays");
    let hits = Cell::from_mut(hits).as_slice_of_cells();
    ClosestHits { isa, tree, rays, users, hits }.run(s, l, isa.width());
}

/// Which rays hit anything.
#[inline(always)]
pub(crate) fn any_batch<S: Simd, L: Lanes, U: UserLeaves>(
    isa: SupportedIsa,
    (s, l): (S, L),
    tree: &Tree,
    rays: &[Ray],
    users: &U,
    occluded: &mut [bool],
) {
    assert_eq!(rays.len(), occluded.len(), "as many answers as rays");
    let occluded = Cell::from_mut(occluded).as_slice_of_cells();
    AnyHits { isa, tree, rays, users, occluded }.run(s, l, isa.width());
}
