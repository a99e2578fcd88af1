//! Split of a range of primitives: the surface area heuristic over bins (Wald, "On fast Construction of SAH-based
//! Bounding Volume Hierarchies", 2007).

#[cfg(target_arch = "x86_64")]
use super::lanes;
use super::primitives::{PrimRef, Span};
use crate::simd::LANES;
use glam::Vec3A;
use rayon::prelude::*;
use steradian_math::{Bounds3, Vec3};

/// Ranges up to this length have two bins ([`HALVES`]) along an axis: finer cuts make no better trees of them.
const FEW: usize = 10;
pub(super) const HALVES: usize = 2;
/// Fewest and most bins along an axis of other ranges.
pub(super) const MIN_BINS: usize = 8;
pub(super) const MAX_BINS: usize = 32;
/// Ranges longer than this are binned by several threads, in pieces of this size.
const PIECE: usize = 1 << 14;

/// Extent of a range: the box of its primitives, and the box of their centres.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extent {
    pub bounds: Bounds3,
    pub centers: Bounds3,
    /// True if all of them are triangles.
    pub triangles: bool,
}

impl Extent {
    pub const EMPTY: Self = Self { bounds: Bounds3::EMPTY, centers: Bounds3::EMPTY, triangles: true };

    /// The extent of a range.
    pub fn of(refs: &[PrimRef]) -> Self {
        // Reduce long ranges in parallel, piece by piece.
        if refs.len() > PIECE {
            return refs.par_chunks(PIECE).map(Self::of).reduce(|| Self::EMPTY, Self::union);
        }
        let (mut bounds, mut centers, mut triangles) = (Span::EMPTY, Span::EMPTY, true);
        for r in refs {
            bounds = bounds.union(r.span());
            centers = centers.union(Span::at(r.center()));
            triangles &= !r.is_user();
        }
        Self { bounds: bounds.bounds(), centers: centers.bounds(), triangles }
    }

    fn union(self, other: Self) -> Self {
        Self {
            bounds: self.bounds.union(other.bounds),
            centers: self.centers.union(other.centers),
            triangles: self.triangles && other.triangles,
        }
    }

    /// Number of intersection tests for `count` of the primitives: triangles are tested by blocks.
    pub fn tests(&self, count: u32) -> f32 {
        if self.triangles { count.div_ceil(LANES as u32) as f32 } else { count as f32 }
    }
}

/// Half the area of a box whose lengths are multiplied by `scale`, which the builder chooses so that nothing overflows.
pub(super) fn half_area(b: &Bounds3, scale: f32) -> f32 {
    if b.is_empty() {
        return 0.0;
    }
    let d = (b.max * 0.5 - b.min * 0.5) * scale;
    d.x * d.y + d.y * d.z + d.z * d.x
}

/// Half the area of a box in registers, scaled as by [`half_area`].
#[inline(always)]
fn area_of(b: &Span, scale: f32) -> f32 {
    if b.min.cmpgt(b.max).any() {
        return 0.0;
    }
    let d = (b.max * 0.5 - b.min * 0.5) * scale;
    d.x * d.y + d.y * d.z + d.z * d.x
}

/// Primitives of a range by the place of their centre, along each axis.
pub(super) struct Bins<const BINS: usize> {
    pub bounds: [[Span; BINS]; 3],
    pub counts: [[u32; BINS]; 3],
}

/// The map from centres to bins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Grid {
    pub count: usize,
    pub origin: Vec3A,
    pub scale: Vec3A,
}

impl Grid {
    pub fn new(centers: &Bounds3, len: usize) -> Self {
        // Use more bins for longer ranges: the cost of binning is in proportion to both.
        let count = if len <= FEW { HALVES } else { (4 + len / 16).clamp(MIN_BINS, MAX_BINS) };
        let scale = count as f32 / centers.diagonal();
        let scale = Vec3::select(scale.is_finite_mask(), scale, Vec3::ZERO);
        Self { count, origin: centers.min.into(), scale: scale.into() }
    }

    /// The bins of a centre along all axes.
    #[inline(always)]
    fn bins(&self, center: Vec3A) -> [usize; 3] {
        let place = (center - self.origin) * self.scale;
        place.to_array().map(|x| (x as i32 as usize).min(self.count - 1))
    }

    /// The bin of a centre along one axis.
    #[inline(always)]
    fn bin(&self, center: f32, axis: usize) -> usize {
        let place = (center - self.origin[axis]) * self.scale[axis];
        (place as i32 as usize).min(self.count - 1)
    }
}

impl<const BINS: usize> Bins<BINS> {
    fn new() -> Self {
        Self { bounds: [[Span::EMPTY; BINS]; 3], counts: [[0; BINS]; 3] }
    }

    fn of(refs: &[PrimRef], grid: Grid) -> Self {
        // Reduce long ranges in parallel; the union of boxes does not depend on the order.
        if refs.len() > PIECE {
            let pieces = refs.par_chunks(PIECE).map(|piece| Self::of(piece, grid));
            return pieces.reduce_with(|a, b| a.union(&b)).unwrap_or_else(Self::new);
        }
        #[cfg(target_arch = "x86_64")]
        if let Some(bins) = lanes::bins(refs, grid) {
            return bins;
        }
        Self::one_by_one(refs, grid)
    }

    /// Bins of the references without wide registers.
    pub fn one_by_one(refs: &[PrimRef], grid: Grid) -> Self {
        let mut bins = Self::new();
        for r in refs {
            let span = r.span();
            for (axis, bin) in grid.bins(r.center()).into_iter().enumerate() {
                let bin = bin.min(BINS - 1);
                bins.bounds[axis][bin] = bins.bounds[axis][bin].union(span);
                bins.counts[axis][bin] += 1;
            }
        }
        bins
    }

    fn union(mut self, other: &Self) -> Self {
        for axis in 0..3 {
            for bin in 0..BINS {
                self.bounds[axis][bin] = self.bounds[axis][bin].union(other.bounds[axis][bin]);
                self.counts[axis][bin] += other.counts[axis][bin];
            }
        }
        self
    }
}

/// Sorts a range into two parts that are not empty, and says where the second one begins and what is known of both.
pub(super) fn split(refs: &mut [PrimRef], extent: &Extent, scale: f32, use_sah: bool) -> (usize, [Extent; 2]) {
    // Fall back to halves when no plane separates the centres.
    let chosen = if use_sah { best_plane(refs, extent, scale) } else { None };
    if let Some(parts) = chosen.and_then(|cut| cut.apply(refs, extent)) {
        return parts;
    }
    let middle = halve(refs, extent);
    let (left, right) = refs.split_at(middle);
    (middle, [Extent::of(left), Extent::of(right)])
}

/// Sorts a range into halves, and says where the second one begins.
pub(super) fn halve(refs: &mut [PrimRef], extent: &Extent) -> usize {
    // All centres at one place, or a tree that grows too deep: halves, by the centre and then by the index.
    let axis = extent.centers.longest_axis();
    let middle = refs.len() / 2;
    refs.select_nth_unstable_by(middle, |a, b| {
        a.center_on(axis).total_cmp(&b.center_on(axis)).then(a.index().cmp(&b.index()))
    });
    middle
}

/// A cut between bins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Cut {
    pub grid: Grid,
    pub axis: usize,
    /// The first bin of the second part.
    pub bin: usize,
    /// Areas of the parts times how many tests are in them.
    pub cost: f32,
    /// The boxes of both parts.
    pub bounds: [Bounds3; 2],
}

impl Cut {
    /// Sorts a range into its parts, and says where the second one begins and what is known of both, unless one of them
    /// is empty.
    pub fn apply(&self, refs: &mut [PrimRef], extent: &Extent) -> Option<(usize, [Extent; 2])> {
        let (middle, centers) = self.partition(refs);
        if middle == 0 || middle == refs.len() {
            return None;
        }
        let (left, right) = refs.split_at(middle);
        let part = |i: usize, refs: &[PrimRef]| {
            let triangles = extent.triangles || refs.iter().all(|r| !r.is_user());
            Extent { bounds: self.bounds[i], centers: centers[i], triangles }
        };
        Some((middle, [part(0, left), part(1, right)]))
    }

    /// Moves the primitives of the first part to the front, in an order that depends on the input only, and counts
    /// them; and measures the centres of both parts.
    fn partition(&self, refs: &mut [PrimRef]) -> (usize, [Bounds3; 2]) {
        #[cfg(target_arch = "x86_64")]
        if let Some(parts) = lanes::partition(self, refs) {
            return parts;
        }
        self.partition_one_by_one(refs)
    }

    /// Partition without wide registers. Every primitive changes its place with the first one of the second part, so
    /// that there is no branch to guess.
    pub fn partition_one_by_one(&self, refs: &mut [PrimRef]) -> (usize, [Bounds3; 2]) {
        let (mut middle, mut centers) = (0, [Span::EMPTY; 2]);
        for i in 0..refs.len() {
            let center = refs[i].center();
            let is_first = self.grid.bin(center[self.axis], self.axis) < self.bin;
            let part = &mut centers[usize::from(!is_first)];
            *part = part.union(Span::at(center));
            refs.swap(i, middle);
            middle += usize::from(is_first);
        }
        (middle, centers.map(Span::bounds))
    }
}

/// The cheapest cut between bins.
pub(super) fn best_plane(refs: &[PrimRef], extent: &Extent, scale: f32) -> Option<Cut> {
    let grid = Grid::new(&extent.centers, refs.len());
    #[cfg(target_arch = "x86_64")]
    if refs.len() <= PIECE
        && let Some(best) = lanes::cheapest(refs, extent, scale, grid)
    {
        return best;
    }
    // What few primitives do not fill need not be cleared and looked through.
    match grid.count {
        HALVES => Bins::<HALVES>::of(refs, grid).cheapest(extent, scale, grid),
        MIN_BINS => Bins::<MIN_BINS>::of(refs, grid).cheapest(extent, scale, grid),
        _ => Bins::<MAX_BINS>::of(refs, grid).cheapest(extent, scale, grid),
    }
}

impl<const BINS: usize> Bins<BINS> {
    /// The cheapest cut; none if no cut has two sides.
    pub fn cheapest(&self, extent: &Extent, scale: f32, grid: Grid) -> Option<Cut> {
        let bins = self;
        let (mut best, mut best_cost) = (None, f32::INFINITY);
        for axis in 0..3 {
            // All second parts, from the end.
            let (mut costs, mut parts) = ([0.0_f32; BINS], [Span::EMPTY; BINS]);
            let (mut bounds, mut count) = (Span::EMPTY, 0);
            for bin in (1..grid.count.min(BINS)).rev() {
                bounds = bounds.union(bins.bounds[axis][bin]);
                count += bins.counts[axis][bin];
                costs[bin] = if count == 0 { f32::INFINITY } else { area_of(&bounds, scale) * extent.tests(count) };
                parts[bin] = bounds;
            }
            let (mut bounds, mut count) = (Span::EMPTY, 0);
            // Sweep from the left and add the cost of the second part: A_l·N_l + A_r·N_r.
            for bin in 1..grid.count.min(BINS) {
                bounds = bounds.union(bins.bounds[axis][bin - 1]);
                count += bins.counts[axis][bin - 1];
                let cost = area_of(&bounds, scale) * extent.tests(count) + costs[bin];
                if count > 0 && cost < best_cost {
                    best_cost = cost;
                    let bounds = [bounds.bounds(), parts[bin].bounds()];
                    best = Some(Cut { grid, axis, bin, cost, bounds });
                }
            }
        }
        best
    }
}
