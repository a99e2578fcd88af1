//! Slices of rays, packet by packet.

use super::any::any_beams;
use super::nearest::nearest_beams;
use super::{Found, Packet, Set};
use crate::bvh::Tree;
use crate::dispatch::{SupportedIsa, any_hit, nearest_hit};
use crate::simd::{Lanes, Simd, WIDE};
use crate::traverse::{Extra, Nearest, Users};
use crate::{Hit, UserHit};
use steradian_math::Ray;

/// The next packet of a slice, and how many rays of the slice are in it. The last one is filled with copies.
#[inline(always)]
fn packet<L: Lanes>(l: L, rays: &[Ray]) -> (Packet, usize) {
    if rays.len() >= L::COUNT {
        return (Packet::new(l, rays), L::COUNT);
    }
    let mut padded = [rays[0]; WIDE];
    padded[..rays.len()].copy_from_slice(rays);
    (Packet::new(l, &padded), rays.len())
}

/// After a packet of which most rays went alone, so many packets are not tried: their rays go alone at once.
const PAUSE: usize = 7;

/// How many of the next rays go alone without being tried together.
#[inline(always)]
fn pause<L: Lanes>(alone: u32, len: usize) -> usize {
    if alone.count_ones() as usize * 4 > len * 3 { PAUSE * L::COUNT } else { 0 }
}

/// The nearest hits of rays.
#[inline(always)]
pub(crate) fn nearest_batch<S: Simd, L: Lanes, U: Users>(
    isa: SupportedIsa,
    (s, l): (S, L),
    tree: &Tree,
    rays: &[Ray],
    users: &U,
    hits: &mut [Option<Hit>],
) {
    assert_eq!(rays.len(), hits.len(), "as many answers as rays");
    let (mut done, mut pausing) = (0, 0);
    while done < rays.len() {
        if pausing > 0 {
            let end = (done + pausing).min(rays.len());
            for (ray, hit) in rays[done..end].iter().zip(&mut hits[done..end]) {
                *hit = nearest_hit(isa, tree, ray, users).map(|nearest| users.hit(nearest));
            }
            (done, pausing) = (end, 0);
            continue;
        }
        let (packet, len) = packet(l, &rays[done..]);
        let mut found = Found::nothing(&packet.t_max);
        let alone = nearest_beams(isa, (s, l), tree, &packet, (1 << len) - 1, users, &mut found);
        let sum = l.read(&found.sum);
        l.write(l.div(l.read(&found.u), sum), &mut found.u);
        l.write(l.div(l.read(&found.v), sum), &mut found.v);
        let (rays, hits) = (&rays[done..done + len], &mut hits[done..done + len]);
        for (lane, hit) in hits.iter_mut().enumerate() {
            let lane = lane & (WIDE - 1);
            *hit = (found.hits >> lane & 1 == 1).then(|| {
                let parameters = UserHit { t: found.t.0[lane], u: found.u.0[lane], v: found.v.0[lane] };
                let extra = U::Extra::from_bits(found.extra.0[lane].to_bits());
                users.hit(Nearest { hit: parameters, index: found.index(lane), extra })
            });
        }
        for lane in Set(alone) {
            hits[lane] = nearest_hit(isa, tree, &rays[lane], users).map(|nearest| users.hit(nearest));
        }
        pausing = pause::<L>(alone, len);
        done += len;
    }
}

/// Which rays hit anything.
#[inline(always)]
pub(crate) fn any_batch<S: Simd, L: Lanes, U: Users>(
    isa: SupportedIsa,
    (s, l): (S, L),
    tree: &Tree,
    rays: &[Ray],
    users: &U,
    occluded: &mut [bool],
) {
    assert_eq!(rays.len(), occluded.len(), "as many answers as rays");
    let (mut done, mut pausing) = (0, 0);
    while done < rays.len() {
        if pausing > 0 {
            let end = (done + pausing).min(rays.len());
            for (ray, occluded) in rays[done..end].iter().zip(&mut occluded[done..end]) {
                *occluded = any_hit(isa, tree, ray, users);
            }
            (done, pausing) = (end, 0);
            continue;
        }
        let (packet, len) = packet(l, &rays[done..]);
        let (hits, alone) = any_beams(isa, (s, l), tree, &packet, (1 << len) - 1, users);
        let (rays, occluded) = (&rays[done..done + len], &mut occluded[done..done + len]);
        for (lane, occluded) in occluded.iter_mut().enumerate() {
            *occluded = hits >> lane & 1 == 1;
        }
        for lane in Set(alone) {
            occluded[lane] = any_hit(isa, tree, &rays[lane], users);
        }
        pausing = pause::<L>(alone, len);
        done += len;
    }
}
