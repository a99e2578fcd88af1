//! Where to cut a range of primitives: the surface area heuristic over bins (Wald, "On fast Construction of SAH-based Bounding Volume
//! Hierarchies", 2007).

use super::primitives::PrimRef;
use rayon::prelude::*;
use steradian_math::{Bounds3, Vec3};

/// Most bins along an axis.
const MAX_BINS: usize = 32;
/// Ranges longer than this are binned by several threads, in pieces of this size.
const PIECE: usize = 1 << 14;

/// What is known of a range: the box of its primitives, and the box of their centres.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extent {
    pub bounds: Bounds3,
    pub centers: Bounds3,
}

impl Extent {
    pub const EMPTY: Self = Self { bounds: Bounds3::EMPTY, centers: Bounds3::EMPTY };

    /// The extent of a range.
    pub fn of(refs: &[PrimRef]) -> Self {
        if refs.len() > PIECE {
            refs.par_chunks(PIECE).map(Self::of).reduce(|| Self::EMPTY, Self::union)
        } else {
            refs.iter().fold(Self::EMPTY, Self::with)
        }
    }

    #[inline]
    fn with(self, r: &PrimRef) -> Self {
        Self { bounds: self.bounds.union(r.bounds()), centers: self.centers.union_point(r.center()) }
    }

    fn union(self, other: Self) -> Self {
        Self { bounds: self.bounds.union(other.bounds), centers: self.centers.union(other.centers) }
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

/// Primitives of a range by the place of their centre, along each axis.
#[derive(Clone)]
struct Bins {
    bounds: [[Bounds3; MAX_BINS]; 3],
    counts: [[u32; MAX_BINS]; 3],
}

/// The map from centres to bins.
#[derive(Clone, Copy)]
struct Grid {
    count: usize,
    origin: Vec3,
    scale: Vec3,
}

impl Grid {
    fn new(centers: &Bounds3, len: usize) -> Self {
        let count = (4 + len / 16).clamp(8, MAX_BINS);
        let scale = count as f32 / centers.diagonal();
        Self { count, origin: centers.min, scale: Vec3::select(scale.is_finite_mask(), scale, Vec3::ZERO) }
    }

    #[inline]
    fn bins(&self, center: Vec3) -> [usize; 3] {
        let place = (center - self.origin) * self.scale;
        place.to_array().map(|x| (x as usize).min(self.count - 1))
    }
}

impl Bins {
    fn new() -> Self {
        Self { bounds: [[Bounds3::EMPTY; MAX_BINS]; 3], counts: [[0; MAX_BINS]; 3] }
    }

    fn of(refs: &[PrimRef], grid: Grid) -> Self {
        if refs.len() > PIECE {
            let pieces = refs.par_chunks(PIECE).map(|piece| Self::of(piece, grid));
            return pieces.reduce_with(|a, b| a.union(&b)).unwrap_or_else(Self::new);
        }
        let mut bins = Self::new();
        for r in refs {
            for (axis, bin) in grid.bins(r.center()).into_iter().enumerate() {
                bins.bounds[axis][bin] = bins.bounds[axis][bin].union(r.bounds());
                bins.counts[axis][bin] += 1;
            }
        }
        bins
    }

    fn union(mut self, other: &Self) -> Self {
        for axis in 0..3 {
            for bin in 0..MAX_BINS {
                self.bounds[axis][bin] = self.bounds[axis][bin].union(other.bounds[axis][bin]);
                self.counts[axis][bin] += other.counts[axis][bin];
            }
        }
        self
    }
}

/// Sorts a range into two parts that are not empty, and says where the second one begins.
pub(super) fn split(refs: &mut [PrimRef], extent: &Extent, scale: f32, use_sah: bool) -> usize {
    let chosen = if use_sah { best_plane(refs, extent, scale) } else { None };
    if let Some((grid, axis, bin)) = chosen {
        let middle = partition(refs, |r| grid.bins(r.center())[axis] < bin);
        if middle > 0 && middle < refs.len() {
            return middle;
        }
    }
    // All centres at one place, or a tree that grows too deep: halves, by the centre and then by the index.
    let axis = extent.centers.longest_axis();
    let middle = refs.len() / 2;
    refs.select_nth_unstable_by(middle, |a, b| {
        a.center()[axis].total_cmp(&b.center()[axis]).then(a.index().cmp(&b.index()))
    });
    middle
}

/// The cheapest cut between bins: the first bin of the second part.
fn best_plane(refs: &[PrimRef], extent: &Extent, scale: f32) -> Option<(Grid, usize, usize)> {
    let grid = Grid::new(&extent.centers, refs.len());
    let bins = Bins::of(refs, grid);
    let mut best = None;
    let mut best_cost = f32::INFINITY;
    for axis in 0..3 {
        // Costs of all second parts, from the end.
        let mut costs = [0.0_f32; MAX_BINS];
        let (mut bounds, mut count) = (Bounds3::EMPTY, 0);
        for bin in (1..grid.count).rev() {
            bounds = bounds.union(bins.bounds[axis][bin]);
            count += bins.counts[axis][bin];
            costs[bin] = if count == 0 { f32::INFINITY } else { half_area(&bounds, scale) * count as f32 };
        }
        let (mut bounds, mut count) = (Bounds3::EMPTY, 0);
        for (bin, second_cost) in costs.into_iter().enumerate().take(grid.count).skip(1) {
            bounds = bounds.union(bins.bounds[axis][bin - 1]);
            count += bins.counts[axis][bin - 1];
            let cost = half_area(&bounds, scale) * count as f32 + second_cost;
            if count > 0 && cost < best_cost {
                best_cost = cost;
                best = Some((grid, axis, bin));
            }
        }
    }
    best
}

/// Moves what satisfies the predicate to the front, in an order that depends on the input only, and counts it.
fn partition(refs: &mut [PrimRef], mut first: impl FnMut(&PrimRef) -> bool) -> usize {
    let (mut i, mut j) = (0, refs.len());
    loop {
        while i < j && first(&refs[i]) {
            i += 1;
        }
        while i < j && !first(&refs[j - 1]) {
            j -= 1;
        }
        if i >= j {
            return i;
        }
        refs.swap(i, j - 1);
        i += 1;
        j -= 1;
    }
}
