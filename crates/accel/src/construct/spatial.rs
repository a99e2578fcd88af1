//! A binary tree whose nodes may cut triangles in two (Stich, Friedrich, Dietrich, "Spatial Splits in Bounding Volume
//! Hierarchies", HPG 2009): where the boxes of both parts of a range overlap, a plane through space is tried as well as
//! a partition of the primitives.
//!
//! References beyond one for each primitive come out of a budget, which is shared among subtrees in proportion to their
//! size, so that it does not matter which thread builds what.

use super::binary::{SAH_DEPTH, fitted, scale};
use super::clip::{clip, intersection};
use super::explicit::{Explicit, bounds_of};
use super::primitives::{PrimRef, Primitives};
use super::split::{Extent, best_plane, half_area, halve};
use crate::simd::LANES;
use steradian_math::Bounds3;

/// Additional references, as a share of the primitives.
const BUDGET: f32 = 0.3;
/// Planes are tried where boxes overlap by more than this share of the area of the whole.
const OVERLAP: f32 = 1e-5;
/// Bins along an axis.
const BINS: usize = 16;
/// Ranges longer than this are cut by several threads.
const PARALLEL: usize = 1 << 12;

/// Builds the tree; there is a reference at least.
pub(super) fn build(primitives: &Primitives, refs: Vec<PrimRef>) -> Explicit {
    let extent = Extent::of(&refs);
    let scale = scale(&extent.bounds);
    let least_overlap = half_area(&extent.bounds, scale) * OVERLAP;
    let budget = (refs.len() as f32 * BUDGET) as usize;
    Builder { primitives, scale, least_overlap }.build(refs, budget, 0)
}

/// Parameters shared by all ranges.
struct Builder<'a> {
    primitives: &'a Primitives<'a>,
    scale: f32,
    least_overlap: f32,
}

/// A plane between bins.
struct Plane {
    axis: usize,
    at: f32,
    cost: f32,
    /// Box and number of references on either side.
    sides: [(Bounds3, usize); 2],
}

impl Builder<'_> {
    /// The tree over some references, with so many additional ones. Its depth is at most [`SAH_DEPTH`].
    fn build(&self, mut refs: Vec<PrimRef>, budget: usize, depth: u32) -> Explicit {
        let extent = Extent::of(&refs);
        if refs.len() <= LANES || depth >= SAH_DEPTH {
            return Explicit::leaf(extent.bounds, refs);
        }
        let count = refs.len();
        // Try the object split first.
        // Where that is not the scale of all, boxes are too small for planes.
        let cut = best_plane(&refs, &extent, fitted(self.scale, &extent.bounds));
        let cost = cut.as_ref().map_or(f32::INFINITY, |cut| cut.cost);
        let middle = cut
            .and_then(|cut| cut.apply(&mut refs, &extent))
            .map_or_else(|| halve(&mut refs, &extent), |(middle, _)| middle);
        let (left, right) = refs.split_at(middle);
        // Try a spatial split only where the boxes of the object split overlap noticeably: elsewhere it cannot save
        // much.
        let overlap = intersection(&bounds_of(left), &bounds_of(right));
        let plane = if budget > 0 && half_area(&overlap, self.scale) > self.least_overlap {
            self.best_plane(&refs, &extent).filter(|plane| plane.cost < cost)
        } else {
            None
        };
        // Keep the spatial split only if it makes progress and stays within the budget of references.
        let parts = plane.and_then(|plane| self.cut(&refs, &plane)).filter(|[left, right]| {
            let both = left.len() + right.len();
            left.len() < count && right.len() < count && !left.is_empty() && !right.is_empty() && both <= count + budget
        });
        let [left, right] = parts.unwrap_or_else(|| {
            let right = refs.split_off(middle);
            [refs, right]
        });
        // Share the rest of the budget by size.
        let rest = count + budget - left.len() - right.len();
        let of_left = (rest as u64 * left.len() as u64 / (left.len() + right.len()) as u64) as usize;
        let left = || self.build(left, of_left, depth + 1);
        let right = || self.build(right, rest - of_left, depth + 1);
        let (left, right) = if count > PARALLEL { rayon::join(left, right) } else { (left(), right()) };
        Explicit::join(extent.bounds, left, right)
    }

    /// The cheapest plane through a box.
    fn best_plane(&self, refs: &[PrimRef], extent: &Extent) -> Option<Plane> {
        let mut best: Option<Plane> = None;
        let bounds = &extent.bounds;
        let size = bounds.max - bounds.min;
        for axis in (0..3).filter(|&axis| size[axis] > 0.0 && size[axis].is_finite()) {
            let place = |bin: usize| bounds.min[axis] + size[axis] * (bin as f32 / BINS as f32);
            let bin = |x: f32| (((x - bounds.min[axis]) / size[axis] * BINS as f32) as usize).min(BINS - 1);
            let mut boxes = [Bounds3::EMPTY; BINS];
            let (mut begin, mut end) = ([0; BINS], [0; BINS]);
            // Chop every reference at the bin borders and add its pieces to the bins; count where it begins and where
            // it ends.
            for r in refs {
                let (first, last) = (bin(r.min()[axis]), bin(r.max()[axis]));
                let mut rest = *r;
                for (bin, bounds) in boxes.iter_mut().enumerate().take(last).skip(first) {
                    let [below, above] = self.parts(&rest, axis, place(bin + 1));
                    *bounds = bounds.union(below);
                    rest = rest.part(above);
                }
                boxes[last] = boxes[last].union(rest.bounds());
                begin[first] += 1;
                end[last] += 1;
            }
            // Sweep from the right, then from the left, and keep the plane of least SAH cost.
            let mut after = [(Bounds3::EMPTY, 0); BINS + 1];
            for bin in (1..BINS).rev() {
                after[bin] = (after[bin + 1].0.union(boxes[bin]), after[bin + 1].1 + end[bin]);
            }
            let mut before = (Bounds3::EMPTY, 0);
            for bin in 1..BINS {
                before = (before.0.union(boxes[bin - 1]), before.1 + begin[bin - 1]);
                let sides = [before, after[bin]];
                let cost = sides.iter().map(|(b, n)| half_area(b, self.scale) * extent.tests(*n as u32)).sum();
                let is_better = best.as_ref().is_none_or(|best| cost < best.cost);
                if is_better && sides.iter().all(|side| side.1 > 0 && side.1 < refs.len()) {
                    best = Some(Plane { axis, at: place(bin), cost, sides });
                }
            }
        }
        best
    }

    /// Boxes of the parts of a reference below and above a plane. User primitives cannot be cut, only their boxes.
    fn parts(&self, r: &PrimRef, axis: usize, at: f32) -> [Bounds3; 2] {
        if r.max()[axis] <= at {
            return [r.bounds(), Bounds3::EMPTY];
        }
        if r.min()[axis] >= at {
            return [Bounds3::EMPTY, r.bounds()];
        }
        if let Some((corners, _)) = self.primitives.triangle(r.index()) {
            return clip(corners, &r.bounds(), axis, at);
        }
        let [mut below, mut above] = [r.bounds(); 2];
        (below.max[axis], above.min[axis]) = (at, at);
        [below, above]
    }

    /// The references on both sides of a plane. One that would be on both is put wholly on one side where that is
    /// cheaper.
    fn cut(&self, refs: &[PrimRef], plane: &Plane) -> Option<[Vec<PrimRef>; 2]> {
        let mut sides = [Vec::with_capacity(refs.len()), Vec::with_capacity(refs.len())];
        let [mut left, mut right] = plane.sides;
        for r in refs {
            let parts = self.parts(r, plane.axis, plane.at);
            if parts[1].is_empty() {
                sides[0].push(*r);
                continue;
            }
            if parts[0].is_empty() {
                sides[1].push(*r);
                continue;
            }
            let area = |b: &Bounds3| half_area(b, self.scale);
            let (a, b) = (area(&left.0), area(&right.0));
            let (to_left, to_right) = (left.0.union(r.bounds()), right.0.union(r.bounds()));
            // Reference unsplitting: the costs of a reference on both sides, wholly on the left and wholly on the right
            // (Stich et al. 2009).
            let costs = [
                a * left.1 as f32 + b * right.1 as f32,
                area(&to_left) * left.1 as f32 + b * (right.1 - 1) as f32,
                a * (left.1 - 1) as f32 + area(&to_right) * right.1 as f32,
            ];
            // Take the cheapest of the three and keep boxes and counts of both sides up to date.
            if costs[1] < costs[0] && costs[1] <= costs[2] {
                (left.0, right.1) = (to_left, right.1 - 1);
                sides[0].push(*r);
            } else if costs[2] < costs[0] {
                (right.0, left.1) = (to_right, left.1 - 1);
                sides[1].push(*r);
            } else {
                sides[0].push(r.part(parts[0]));
                sides[1].push(r.part(parts[1]));
            }
        }
        Some(sides)
    }
}
