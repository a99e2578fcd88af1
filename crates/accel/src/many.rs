//! Queries of many rays, compiled for each instruction set.
#![expect(unsafe_code, reason = "unchecked reads; each place states why it is sound")]

use crate::Hit;
use crate::dispatch::queries;
use crate::packet::{any_batch, any_packet, nearest_batch, nearest_packet};
use crate::packet_hits::Found;
use crate::packet_rays::Packet;
use crate::simd::DoubleLanes;
use crate::tree::Tree;
use glam::Mat4;
use steradian_math::Ray;

queries! {
    /// The nearest hits of rays.
    fn nearest_hits<U: UserLeaves>(tree: &Tree, rays: &[Ray], users: &U, hits: &mut [Option<Hit>]) = |isa, s, l| {
        let isa = isa.for_rays(l, rays.len());
        if isa.is_narrow(l) {
            nearest_batch(isa, (s, l), tree, rays, users, hits);
        } else {
            nearest_batch(isa, (s, DoubleLanes(l)), tree, rays, users, hits);
        }
    };
    /// Which rays hit anything.
    fn any_hits<U: UserLeaves>(tree: &Tree, rays: &[Ray], users: &U, occluded: &mut [bool]) = |isa, s, l| {
        let isa = isa.for_rays(l, rays.len());
        if isa.is_narrow(l) {
            any_batch(isa, (s, l), tree, rays, users, occluded);
        } else {
            any_batch(isa, (s, DoubleLanes(l)), tree, rays, users, occluded);
        }
    };
    /// The nearest hits of a packet that is moved to the space of a tree, in intervals that end where `found` says.
    fn nearest_packet_in<U: UserLeaves>(
        tree: &Tree, placed: (&Packet, &Mat4), lanes: u32, users: &U, found: &mut Found,
    ) = |isa, s, l| {
        if isa.is_narrow(l) {
            let packet = placed.0.transformed(l, placed.1, &found.t);
            nearest_packet(isa, (s, l), tree, &packet, lanes, users, found);
        } else {
            let packet = placed.0.transformed(DoubleLanes(l), placed.1, &found.t);
            nearest_packet(isa, (s, DoubleLanes(l)), tree, &packet, lanes, users, found);
        }
    };
    /// Which rays of a packet that is moved to the space of a tree hit anything.
    fn any_packet_in<U: UserLeaves>(tree: &Tree, placed: (&Packet, &Mat4), lanes: u32, users: &U) -> u32 = |isa, s, l| {
        if isa.is_narrow(l) {
            let packet = placed.0.transformed(l, placed.1, &placed.0.t_max);
            any_packet(isa, (s, l), tree, &packet, lanes, users)
        } else {
            let packet = placed.0.transformed(DoubleLanes(l), placed.1, &placed.0.t_max);
            any_packet(isa, (s, DoubleLanes(l)), tree, &packet, lanes, users)
        }
    };
}
