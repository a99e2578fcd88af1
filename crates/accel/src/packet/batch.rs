//! Slices of rays, packet by packet.

use super::{Found, Packet, any_packet, nearest_packet};
use crate::Hit;
use crate::bvh::Tree;
use crate::dispatch::SupportedIsa;
use crate::simd::{Lanes, Simd, WIDE};
use crate::traverse::Users;
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
    let mut done = 0;
    while done < rays.len() {
        let (packet, len) = packet(l, &rays[done..]);
        let mut found = Found::nothing(&packet.t_max);
        nearest_packet(isa, (s, l), tree, &packet, (1 << len) - 1, users, &mut found);
        for (lane, hit) in hits[done..done + len].iter_mut().enumerate() {
            *hit = found.get(lane).map(|nearest| users.hit(nearest));
        }
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
    let mut done = 0;
    while done < rays.len() {
        let (packet, len) = packet(l, &rays[done..]);
        let hits = any_packet(isa, (s, l), tree, &packet, (1 << len) - 1, users);
        for (lane, occluded) in occluded[done..done + len].iter_mut().enumerate() {
            *occluded = hits >> lane & 1 == 1;
        }
        done += len;
    }
}
