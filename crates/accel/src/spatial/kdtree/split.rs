//! The planes of a k-d tree by the surface area heuristic (MacDonald and Booth 1990): exact where primitives are few,
//! and among evenly spaced ones where they are many. Primitives that a plane cuts go to both sides with the boxes of
//! their parts ("perfect splits", Wald and Havran 2006).

use crate::spatial::items::Items;
use steradian_math::{Bounds3, DVec3, Vec3};

/// Cost of a test in steps.
const TEST: f64 = 1.5;
/// Part of the cost that cutting off empty space saves.
const EMPTY_BONUS: f64 = 0.2;
/// Nodes with no more primitives try every plane that matters.
const EXACT: usize = 128;
/// Planes tried on an axis elsewhere.
const BINS: usize = 64;

/// A primitive in a node, with the box of the part that may lie there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reference {
    pub slot: u32,
    pub bounds: Bounds3,
}

impl Reference {
    /// With a box that is rounded outwards, and kept finite.
    pub fn new(slot: u32, [min, max]: [DVec3; 2]) -> Self {
        let down = min.to_array().map(|x| (x as f32).next_down().max(f32::MIN));
        let up = max.to_array().map(|x| (x as f32).next_up().min(f32::MAX));
        Self { slot, bounds: Bounds3 { min: Vec3::from_array(down), max: Vec3::from_array(up) } }
    }
}

/// The best plane: axis and position; `None` where a leaf is cheaper.
pub(super) fn best_plane(refs: &[Reference], bounds: &Bounds3) -> Option<(usize, f32)> {
    let extent = bounds.max.as_dvec3() - bounds.min.as_dvec3();
    let area = |d: DVec3| d.x * d.y + d.y * d.z + d.z * d.x;
    let whole = area(extent);
    // A leaf costs one test for each primitive; a plane must be cheaper than that.
    let mut best = (TEST * refs.len() as f64, None);
    for axis in 0..3 {
        let (min, max) = (bounds.min[axis], bounds.max[axis]);
        let mut consider = |plane: f32, below: usize, above: usize| {
            if !(plane > min && plane < max) {
                return;
            }
            // Conditional probability that a ray through the node also meets the child: the ratio of their areas.
            let part = |length: f64| {
                let mut d = extent;
                d[axis] = length;
                area(d) / whole
            };
            let low = part(f64::from(plane) - f64::from(min));
            let high = part(f64::from(max) - f64::from(plane));
            // Favour planes that cut off empty space.
            let bonus = if below == 0 || above == 0 { 1.0 - EMPTY_BONUS } else { 1.0 };
            // C = C_step + C_test·(1 − b)·(p_low·n_low + p_high·n_high), with the bonus b for cutting off empty space.
            let cost = 1.0 + TEST * bonus * (low * below as f64 + high * above as f64);
            if cost < best.0 {
                best = (cost, Some((axis, plane)));
            }
        };
        // Try every face of a box where references are few, evenly spaced planes elsewhere.
        if refs.len() <= EXACT {
            sweep(refs, axis, &mut consider);
        } else {
            bins(refs, axis, [min, max], &mut consider);
        }
    }
    best.1
}

/// Every plane at a face of a box, with the numbers of primitives below and above.
fn sweep(refs: &[Reference], axis: usize, consider: &mut impl FnMut(f32, usize, usize)) {
    let mut starts: Vec<f32> = refs.iter().map(|r| r.bounds.min[axis]).collect();
    let mut ends: Vec<f32> = refs.iter().map(|r| r.bounds.max[axis]).collect();
    starts.sort_unstable_by(f32::total_cmp);
    ends.sort_unstable_by(f32::total_cmp);
    // Merge the sorted starts and ends: the primitives below have started, those above have not ended.
    let (mut s, mut e) = (0, 0);
    while e < ends.len() {
        let plane = starts.get(s).map_or(ends[e], |&start| start.min(ends[e]));
        let started = s;
        while e < ends.len() && ends[e] == plane {
            e += 1;
        }
        while s < starts.len() && starts[s] == plane {
            s += 1;
        }
        consider(plane, started, refs.len() - e);
    }
}

/// Evenly spaced planes.
fn bins(refs: &[Reference], axis: usize, [min, max]: [f32; 2], consider: &mut impl FnMut(f32, usize, usize)) {
    let width = (f64::from(max) - f64::from(min)) / BINS as f64;
    // Bin `i` holds what begins or ends between planes `i` and `i + 1`.
    let bin = |x: f32| ((f64::from(x) - f64::from(min)) / width).clamp(0.0, BINS as f64 - 1.0) as usize;
    let (mut begin, mut end) = ([0_usize; BINS], [0_usize; BINS]);
    for r in refs {
        begin[bin(r.bounds.min[axis])] += 1;
        end[bin(r.bounds.max[axis])] += 1;
    }
    let (mut begun, mut ended) = (0, 0);
    // Sweep the planes between bins with running counts.
    for i in 1..BINS {
        begun += begin[i - 1];
        ended += end[i - 1];
        let plane = (f64::from(min) + width * i as f64) as f32;
        consider(plane, begun, refs.len() - ended);
    }
}

/// Partition of references by a plane, below and above. Those on neither side are in both.
pub(super) fn divide(items: &Items, refs: &[Reference], axis: usize, plane: f32) -> [Vec<Reference>; 2] {
    let (mut low, mut high) = (Vec::new(), Vec::new());
    for &r in refs {
        let (is_low, is_high) = (r.bounds.min[axis] < plane, r.bounds.max[axis] > plane);
        match (is_low, is_high) {
            (true, true) => {
                let parts = cut(items, &r, axis, plane);
                if parts.iter().all(|part| part.bounds.is_empty()) {
                    // Rounding alone can do that; nothing may be lost.
                    low.push(r);
                    high.push(r);
                }
                low.extend(Some(parts[0]).filter(|part| !part.bounds.is_empty()));
                high.extend(Some(parts[1]).filter(|part| !part.bounds.is_empty()));
            }
            (_, false) => low.push(r),
            (false, true) => high.push(r),
        }
    }
    [low, high]
}

/// The parts of a primitive on both sides of a plane.
fn cut(items: &Items, r: &Reference, axis: usize, plane: f32) -> [Reference; 2] {
    let item = &items.list[r.slot as usize];
    let mut parts = [*r; 2];
    parts[0].bounds.max[axis] = plane;
    parts[1].bounds.min[axis] = plane;
    if item.is_user() {
        return parts;
    }
    let padding = items.padding();
    // Clip the triangle itself, not only its box, so that flat and long triangles reach few leaves.
    let corners = item.corners.map(Vec3::as_dvec3);
    for (part, side) in parts.iter_mut().zip([-1.0, 1.0]) {
        // All of the triangle that is no farther than the padding beyond the plane, and the padding around it.
        let height = |p: DVec3| (p[axis] - f64::from(plane)) * side + padding;
        let (mut min, mut max) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let mut include = |p: DVec3| (min, max) = (min.min(p), max.max(p));
        for i in 0..3 {
            let (p, q) = (corners[i], corners[(i + 1) % 3]);
            let (a, b) = (height(p), height(q));
            if a >= 0.0 {
                include(p);
            }
            if a * b < 0.0 {
                include(p + (q - p) * (a / (a - b)));
            }
        }
        let rounded = Reference::new(r.slot, [min - padding, max + padding]).bounds;
        // The part's box is no larger than the reference's box on this side.
        part.bounds.min = part.bounds.min.max(rounded.min);
        part.bounds.max = part.bounds.max.min(rounded.max);
    }
    parts
}
