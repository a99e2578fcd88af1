//! A binary tree from the leaves up: parallel locally-ordered clustering (Meister, Bittner, "Parallel Locally-Ordered
//! Clustering for Bounding Volume Hierarchy Construction", TVCG 24(3), 2018). Clusters lie along a Z-order curve; each
//! looks for the neighbour within a distance with which it has the smallest box, and those that choose each other are
//! merged, until there is one.

use super::binary::scale;
use super::explicit::{Branch, Explicit, NodeContent, leaves};
use super::primitives::PrimRef;
use super::split::{Extent, half_area};
use glam::Vec3A;
use rayon::prelude::*;
use steradian_math::Bounds3;

/// Search radius: clusters that a cluster looks at along the curve in each direction.
const RADIUS: usize = 12;
/// Clusters that a thread looks at in one go.
const PIECE: usize = 1 << 10;

/// With more references than these in a cell of the curve, they are sorted along a finer one.
const CROWDED: usize = 1 << 5;
/// Size of primitives, as a share of the whole extent, below which areas are computed in `f64`.
const TINY: f32 = 1.0 / (1_u64 << 40) as f32;

/// Builds the tree; there is a reference at least.
pub(super) fn build(refs: Vec<PrimRef>) -> Explicit {
    let extent = Extent::of(&refs);
    let scale = scale(&extent.bounds);
    // Areas relative to the scene underflow in `f32` when primitives are tiny: switch to `f64` for these.
    let is_tiny = |r: &PrimRef| ((r.max() * 0.5 - r.min() * 0.5) * scale).max_element() < TINY;
    let any_tiny = refs.par_iter().with_min_len(PIECE).any(is_tiny);
    let refs = along_curve(&refs, &extent.centers);
    if any_tiny { cluster(refs, wide_area) } else { cluster(refs, |b| half_area(b, scale).min(f32::MAX)) }
}

/// Half the area of a box, of any size.
fn wide_area(b: &Bounds3) -> f64 {
    let d = b.max.as_dvec3() - b.min.as_dvec3();
    d.x * d.y + d.y * d.z + d.z * d.x
}

/// Merges clusters until there is one.
fn cluster<A: PartialOrd + Copy>(refs: Vec<PrimRef>, area: impl Fn(&Bounds3) -> A + Sync) -> Explicit {
    let mut nodes = leaves(&refs);
    nodes.reserve(refs.len());
    let mut clusters: Vec<(Bounds3, u32)> = nodes.iter().zip(0..).map(|(node, i)| (node.bounds, i)).collect();
    while clusters.len() > 1 {
        // Find the best partner of each cluster within the search radius.
        let nearest = nearest_neighbours(&clusters, &area);
        let mut merged = Vec::with_capacity(clusters.len() / 2 + 1);
        // Merge mutual nearest neighbours; the lower index makes the new cluster, the others wait for the next round.
        for (i, &(bounds, node)) in clusters.iter().enumerate() {
            let other = nearest[i] as usize;
            if nearest[other] as usize != i {
                merged.push((bounds, node));
            } else if i < other {
                let bounds = bounds.union(clusters[other].0);
                merged.push((bounds, nodes.len() as u32));
                nodes.push(Branch { bounds, below: NodeContent::Children([node, clusters[other].1]) });
            }
        }
        clusters = merged;
    }
    Explicit { root: nodes.len() as u32 - 1, nodes, refs }
}

/// For each cluster the neighbour with which it has the smallest box; of several the first pair. A pair of least area
/// chooses itself, so that there is always one to merge.
fn nearest_neighbours<A: PartialOrd + Copy>(
    clusters: &[(Bounds3, u32)],
    area: &(impl Fn(&Bounds3) -> A + Sync),
) -> Vec<u32> {
    let mut nearest = vec![0; clusters.len()];
    let look = |(piece, nearest): (usize, &mut [u32])| {
        for (i, nearest) in (piece * PIECE..).zip(nearest) {
            let neighbours = i.saturating_sub(RADIUS)..(i + RADIUS + 1).min(clusters.len());
            let mut best: Option<(A, usize, usize)> = None;
            for j in neighbours.filter(|&j| j != i) {
                // The order of pairs is the same from both sides, or none might choose each other.
                let pair = (area(&clusters[i].0.union(clusters[j].0)), i.min(j), i.max(j));
                if best.is_none_or(|best| pair < best) {
                    best = Some(pair);
                    *nearest = j as u32;
                }
            }
        }
    };
    nearest.par_chunks_mut(PIECE).enumerate().for_each(look);
    nearest
}

/// References by the place of their centre along a Z-order curve of 2^10 cells in each direction, then by their index.
/// Those of a crowded cell go along a curve through this cell: else one primitive far away would put all others into
/// one cell. Cells become smaller by 2^10 each time, so that this ends.
fn along_curve(refs: &[PrimRef], centers: &Bounds3) -> Vec<PrimRef> {
    // Quantise centres to ten bits on each axis and interleave them to a Morton code.
    let (origin, scale) = (Vec3A::from(centers.min), Vec3A::from(1024.0 / centers.diagonal()));
    let key = |(r, place): (&PrimRef, u32)| {
        let cell = ((r.center() - origin) * scale).to_array().map(|x| (x as u32).min(1023));
        let code = cell.into_iter().fold(0, |code, x| code << 1 | spread(x));
        u64::from(code) << 32 | u64::from(place)
    };
    let places = 0..refs.len() as u32;
    // Sort by code, then by place: unique keys make the order independent of the number of threads.
    let mut keys: Vec<u64> = refs.par_iter().zip(places).map(key).collect();
    keys.par_sort_unstable();
    let mut sorted: Vec<PrimRef> = keys.par_iter().map(|&key| refs[key as u32 as usize]).collect();
    let mut rest = &mut sorted[..];
    // Refine crowded cells by a curve over their own extent.
    for cell in keys.chunk_by(|a, b| a >> 32 == b >> 32) {
        let (of_cell, others) = rest.split_at_mut(cell.len());
        rest = others;
        if cell.len() > CROWDED {
            let centers = Extent::of(of_cell).centers;
            if centers.min != centers.max {
                of_cell.copy_from_slice(&along_curve(of_cell, &centers));
            }
        }
    }
    sorted
}

/// Ten bits with two zeros before each.
fn spread(x: u32) -> u32 {
    let x = (x | x << 16) & 0x0300_00ff;
    let x = (x | x << 8) & 0x0300_f00f;
    let x = (x | x << 4) & 0x030c_30c3;
    (x | x << 2) & 0x0924_9249
}
