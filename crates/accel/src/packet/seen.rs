//! The triangles of a block, seen from the rays of a beam.
//!
//! First the edge functions of all triangles are computed, and only then the question is asked which of them are hit:
//! nothing waits for the answer to a question that is hard to guess.
#![expect(unsafe_code, reason = "unchecked reads; each place states why it is sound")]

use super::beam::ShearedRays;
use super::interval::Interval;
use crate::layout::Block;
use crate::simd::{LANES, Lanes, Simd};
use crate::triangle::{Corners, Crossing, cross_at, edges, of_one_sign};
use std::mem::MaybeUninit;

/// Culling results for the triangles of a block.
pub(super) struct Seen<L: Lanes> {
    /// Bit `i`: triangle `i` may be hit.
    pub slots: u32,
    /// Triangles that have not been looked at.
    pub rest: u32,
    /// Edge functions of those in `slots`.
    edges: [MaybeUninit<[L::F; 3]>; LANES],
}

impl<L: Lanes> Seen<L> {
    /// Results for the triangles in `rest`, none of which has been looked at.
    #[inline(always)]
    pub fn new(rest: u32) -> Self {
        Self { slots: 0, rest, edges: [const { MaybeUninit::uninit() }; LANES] }
    }

    /// Looks with the active rays at all triangles, or, if one for each ray will do, until each may hit one.
    #[inline(always)]
    pub fn look(&mut self, l: L, sheared: &ShearedRays<L>, block: &Block, active: u32, one_will_do: bool) {
        self.slots = 0;
        let mut met = 0;
        while self.rest != 0 {
            let slot = self.rest.trailing_zeros() as usize & (LANES - 1);
            self.rest &= self.rest - 1;
            // Signed areas of the three edges as seen along the ray; equal signs mean that the ray passes inside.
            let edges = edges(l, Spot { sheared, block, slot }.across(l));
            self.edges[slot].write(edges);
            let lanes = l.bits(of_one_sign(l, edges)) & active;
            self.slots |= u32::from(lanes != 0) << slot;
            met |= lanes;
            // One candidate for each ray suffices for occlusion: stop once all have one.
            if one_will_do && met == active {
                return;
            }
        }
    }

    /// Tests a triangle.
    ///
    /// # Safety
    /// It must be in `slots`.
    #[inline(always)]
    pub unsafe fn cross(
        &self,
        l: L,
        sheared: &ShearedRays<L>,
        block: &Block,
        slot: usize,
        t_max: L::F,
    ) -> Option<Crossing<L>> {
        // SAFETY: the edge functions of those in the set have been written, and the caller promises that this is one.
        let edges = unsafe { self.edges[slot].assume_init() };
        cross_at(l, &Spot { sheared, block, slot }, edges, &sheared.shear, t_max)
    }
}

/// The boxes of the triangles of a block.
pub(super) struct Boxes {
    /// Bit `i`: the box of triangle `i` may be entered.
    pub entered: u32,
    /// Their near planes.
    near: [[f32; LANES]; 3],
}

impl Boxes {
    /// As rays of a beam may enter them before `t_max`.
    #[inline(always)]
    pub fn new<S: Simd>(s: S, interval: &Interval<S>, block: &Block, t_max: f32) -> Self {
        let (entered, near) = interval.triangles(s, block, s.splat(t_max));
        Self { entered, near: [s.store(near[0]), s.store(near[1]), s.store(near[2])] }
    }

    /// Distances of hits on a triangle, moved to its box where they are before it, see [`crate::triangle`].
    #[inline(always)]
    pub fn at_least<L: Lanes>(&self, l: L, sheared: &ShearedRays<L>, slot: usize, crossing: &Crossing<L>) -> L::F {
        // Distances at which each ray meets the near planes of the triangle's box across the two minor axes.
        let ([x, y, _], origin, inverse) = (sheared.axes, sheared.origin, sheared.inverse);
        let along_x = l.mul(l.sub(l.splat(self.near[x][slot]), origin[0]), inverse[0]);
        let along_y = l.mul(l.sub(l.splat(self.near[y][slot]), origin[1]), inverse[1]);
        l.max(along_y, l.max(along_x, l.max(crossing.depth, crossing.t)))
    }
}

/// A triangle of a block, seen from rays.
struct Spot<'a, L: Lanes> {
    sheared: &'a ShearedRays<L>,
    block: &'a Block,
    slot: usize,
}

impl<L: Lanes> Spot<'_, L> {
    #[inline(always)]
    fn coordinate(&self, l: L, vertex: usize, i: usize) -> L::F {
        let row = &self.block.rows[3 * vertex + self.sheared.axes[i]];
        l.sub(l.splat(row.0[self.slot]), self.sheared.origin[i])
    }

    #[inline(always)]
    fn vertex(&self, l: L, vertex: usize) -> [L::F; 2] {
        let [x, y, z] = [self.coordinate(l, vertex, 0), self.coordinate(l, vertex, 1), self.coordinate(l, vertex, 2)];
        let shear = &self.sheared.shear;
        // Shear so that the ray becomes the z axis: p' = (x − S_x·z, y − S_y·z).
        [l.sub(x, l.mul(shear[0], z)), l.sub(y, l.mul(shear[1], z))]
    }
}

impl<L: Lanes> Corners<L> for Spot<'_, L> {
    #[inline(always)]
    fn across(&self, l: L) -> [[L::F; 2]; 3] {
        [self.vertex(l, 0), self.vertex(l, 1), self.vertex(l, 2)]
    }

    #[inline(always)]
    fn along(&self, l: L) -> [L::F; 3] {
        [self.coordinate(l, 0, 2), self.coordinate(l, 1, 2), self.coordinate(l, 2, 2)]
    }

    #[inline(always)]
    fn absolute(&self, l: L) -> [[L::F; 3]; 4] {
        let row =
            |vertex: usize, axis: usize| l.splat(self.block.rows[3 * vertex + self.sheared.axes[axis]].0[self.slot]);
        let vertex = |vertex: usize| [row(vertex, 0), row(vertex, 1), row(vertex, 2)];
        [vertex(0), vertex(1), vertex(2), self.sheared.origin]
    }
}
