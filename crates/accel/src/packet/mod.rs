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
#![allow(unsafe_code)]

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
use crate::simd::{COLUMNS, Lanes, WIDE, Wide};
use crate::traverse::{Extra, Nearest, UserLeaves};
use glam::Mat4;
use std::mem::offset_of;
use steradian_math::{Ray, Vec3};

/// A beam has at least so many rays; others go alone. Measured.
const BEAM: u32 = 8;

/// The same for packets of so many rays.
#[inline(always)]
fn beam(width: usize) -> u32 {
    BEAM.min(width as u32)
}

/// The first lanes, at least one.
#[inline(always)]
fn first_lanes(count: usize) -> u32 {
    u32::MAX >> (WIDE - count)
}

/// The rays of a packet by rows.
#[derive(Clone, Debug)]
pub(crate) struct Packet {
    pub origin: [Wide; 3],
    pub direction: [Wide; 3],
    pub t_max: Wide,
}

impl Packet {
    /// Without rays.
    const EMPTY: Self =
        Self { origin: [Wide::splat(0.0); 3], direction: [Wide::splat(0.0); 3], t_max: Wide::splat(0.0) };

    /// Packet of some rays, no more than there are lanes; the lanes after these have no meaning.
    #[inline(always)]
    pub fn new<L: Lanes>(l: L, rays: &[Ray]) -> Self {
        // Fill the lanes of a short packet with copies of the first ray, which keeps their arithmetic harmless.
        if rays.len() < L::COUNT {
            let mut padded = [rays[0]; WIDE];
            padded[..rays.len()].copy_from_slice(rays);
            return Self::full(l, &padded);
        }
        Self::full(l, rays)
    }

    /// Packet of as many rays as there are lanes, from the start of a slice.
    #[inline(always)]
    fn full<L: Lanes>(l: L, rays: &[Ray]) -> Self {
        const { assert!(size_of::<Ray>() == size_of::<[f32; COLUMNS]>() && align_of::<Ray>() == align_of::<f32>()) };
        // Transpose rays into columns, one register for each coordinate.
        // SAFETY: a ray is so many `f32`.
        let columns = l.columns(unsafe { std::slice::from_raw_parts(rays.as_ptr().cast(), rays.len()) });
        let mut packet = Self::EMPTY;
        const ORIGIN: usize = offset_of!(Ray, origin) / size_of::<f32>();
        const DIRECTION: usize = offset_of!(Ray, direction) / size_of::<f32>();
        for axis in 0..3 {
            l.write(columns[ORIGIN + axis], &mut packet.origin[axis]);
            l.write(columns[DIRECTION + axis], &mut packet.direction[axis]);
        }
        l.write(columns[offset_of!(Ray, t_max) / size_of::<f32>()], &mut packet.t_max);
        packet
    }

    /// The rays in the space of an instance, with the same rounding as `Mat4::transform_point3` and
    /// `transform_vector3`, up to given distances.
    #[inline(always)]
    pub fn transformed<L: Lanes>(&self, l: L, m: &Mat4, t_max: &Wide) -> Self {
        let mut packet = Self { t_max: *t_max, ..Self::EMPTY };
        let [ox, oy, oz] = [l.read(&self.origin[0]), l.read(&self.origin[1]), l.read(&self.origin[2])];
        let [dx, dy, dz] = [l.read(&self.direction[0]), l.read(&self.direction[1]), l.read(&self.direction[2])];
        for axis in 0..3 {
            let (x, y) = (l.splat(m.x_axis[axis]), l.splat(m.y_axis[axis]));
            let (z, w) = (l.splat(m.z_axis[axis]), l.splat(m.w_axis[axis]));
            // Multiply and add in the order of the scalar matrix product, so that every ray gets its own bits.
            let origin = l.add(l.mul(z, oz), l.add(l.mul(y, oy), l.mul(x, ox)));
            let direction = l.add(l.mul(z, dz), l.add(l.mul(y, dy), l.mul(x, dx)));
            l.write(l.add(w, origin), &mut packet.origin[axis]);
            l.write(direction, &mut packet.direction[axis]);
        }
        packet
    }

    /// One of the rays, up to a distance. Packets are of scenes in which nothing moves.
    #[inline(always)]
    pub fn ray(&self, lane: usize, t_max: f32) -> Ray {
        let vector = |rows: &[Wide; 3]| Vec3::new(rows[0].0[lane], rows[1].0[lane], rows[2].0[lane]);
        Ray { t_max, ..Ray::new(vector(&self.origin), vector(&self.direction)) }
    }
}

/// The nearest hits of the rays of a packet so far.
#[derive(Clone, Debug)]
pub(crate) struct Found {
    /// Distances; those of rays without a hit are where their intervals end.
    pub t: Wide,
    /// Parameters times `sum`.
    pub u: Wide,
    pub v: Wide,
    pub sum: Wide,
    /// The bits of the indices over all geometries of the tree.
    pub index: Wide,
    /// The bits of what a hit carries beyond that.
    pub extra: Wide,
    /// Bit `i`: ray `i` has a hit.
    pub hits: u32,
}

impl Found {
    /// No hits in intervals that end at given distances.
    #[inline(always)]
    pub fn nothing(t_max: &Wide) -> Self {
        let zero = Wide::splat(0.0);
        Self { t: *t_max, u: zero, v: zero, sum: zero, index: zero, extra: zero, hits: 0 }
    }

    /// The index of the hit of a ray.
    #[inline(always)]
    pub fn index(&self, lane: usize) -> u32 {
        self.index.0[lane].to_bits()
    }

    /// The hit of a ray.
    #[inline(always)]
    pub fn get<E: Extra>(&self, lane: usize) -> Option<Nearest<E>> {
        (self.hits >> lane & 1 == 1).then(|| {
            let sum = self.sum.0[lane];
            let hit = UserHit { t: self.t.0[lane], u: self.u.0[lane] / sum, v: self.v.0[lane] / sum };
            Nearest { hit, index: self.index(lane), extra: E::from_bits(self.extra.0[lane].to_bits()) }
        })
    }

    /// Sets the hit of a ray.
    #[inline(always)]
    pub fn set<E: Extra>(&mut self, lane: usize, Nearest { hit, index, extra }: Nearest<E>) {
        self.hits |= 1 << lane;
        self.t.0[lane] = hit.t;
        self.u.0[lane] = hit.u;
        self.v.0[lane] = hit.v;
        self.sum.0[lane] = 1.0;
        self.index.0[lane] = f32::from_bits(index);
        self.extra.0[lane] = f32::from_bits(extra.bits());
    }

    /// Takes over hits with one index, whose parameters and sums are given, of rays from one on: `lanes` counts from
    /// there.
    #[inline(always)]
    pub fn merge<L: Lanes>(&mut self, l: L, (first, lanes): (usize, u32), new: [L::F; 4], index: u32, extra: L::F) {
        let mask = l.mask(lanes);
        let [t, u, v, sum] = new;
        let index = l.splat(f32::from_bits(index));
        // Blend the new hits into the stored ones by the mask; the other lanes keep their values.
        l.write_from(l.select(mask, t, l.read_from(&self.t, first)), &mut self.t, first);
        l.write_from(l.select(mask, u, l.read_from(&self.u, first)), &mut self.u, first);
        l.write_from(l.select(mask, v, l.read_from(&self.v, first)), &mut self.v, first);
        l.write_from(l.select(mask, sum, l.read_from(&self.sum, first)), &mut self.sum, first);
        l.write_from(l.select(mask, index, l.read_from(&self.index, first)), &mut self.index, first);
        l.write_from(l.select(mask, extra, l.read_from(&self.extra, first)), &mut self.extra, first);
        self.hits |= lanes << first;
    }
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
