//! The bounds of a beam against boxes.

use super::beam::Beam;
use crate::layout::{Block, Node};
use crate::simd::{Lanes, Simd};
use crate::triangle::abs;
use crate::widened::WIDEN;

/// Bounds of the distances at which the rays of a beam meet planes. All directions have the same signs. Where the depth
/// of a near plane is positive, the least distance is that of the ray that begins nearest to it and goes fastest; where
/// it is negative, distances are, too, and another bound would do as well, since rays begin at 0. So with far planes. A
/// bound is thus a distance of one ray, with its rounding (see [`crate::ray_constants::RayConstants`]).
pub(super) struct Interval<S: Simd> {
    /// For near and for far planes.
    inverse: [[S::F; 3]; 2],
    offset: [[S::F; 3]; 2],
    near: [usize; 3],
    far: [usize; 3],
}

impl<S: Simd> Interval<S> {
    /// The bounds of some rays of a beam.
    #[inline(always)]
    pub fn new<L: Lanes>(s: S, l: L, beam: &Beam<L>, lanes: u32) -> Self {
        let mask = l.mask(lanes);
        let zero = [[s.splat(0.0); 3]; 2];
        let mut interval = Self { inverse: zero, offset: zero, near: beam.near, far: beam.far };
        for axis in 0..3 {
            let [first, last] = range(l, mask, beam.rows.origin[axis]);
            let [least, greatest] = range(l, mask, beam.rows.inverse[axis]);
            let negative = beam.near[axis] >= 3;
            // The near distance (p − o)·(1/d) is least for the greatest origin and the least reciprocal of a positive
            // direction; for far planes and negative directions the extremes change roles.
            let sides = if negative { [(first, greatest), (last, least)] } else { [(last, least), (first, greatest)] };
            for (side, (origin, inverse)) in sides.into_iter().enumerate() {
                // Widen by the rounding of the product, downwards for near planes and upwards for far ones.
                let error = origin.abs() * inverse.abs() * WIDEN + f32::MIN_POSITIVE;
                let error = if side == 0 { -error } else { error };
                interval.inverse[side][axis] = s.splat(inverse);
                interval.offset[side][axis] = s.splat(error - origin * inverse);
            }
        }
        interval
    }

    /// Distances that are not greater than those at which any ray enters the boxes of a node, and which of them may be
    /// entered before `t_max`.
    #[inline(always)]
    pub fn test(&self, s: S, node: &Node, t_max: S::F) -> (S::F, u32) {
        let ([x, y, z], [u, v, w]) = (self.near, self.far);
        let rows = &node.rows;
        let near = [s.load(&rows[x]), s.load(&rows[y]), s.load(&rows[z])];
        self.boxes(s, near, [s.load(&rows[u]), s.load(&rows[v]), s.load(&rows[w])], t_max)
    }

    /// The triangles of a block whose boxes may be entered before `t_max`, and the near planes of these boxes.
    #[inline(always)]
    pub fn triangles(&self, s: S, block: &Block, t_max: S::F) -> (u32, [S::F; 3]) {
        let (mut near, mut far) = ([s.splat(0.0); 3], [s.splat(0.0); 3]);
        // Bound each triangle of the block by the minimum and maximum of its vertices, eight triangles at once.
        for axis in 0..3 {
            let [a, b, c] = [s.load(&block.rows[axis]), s.load(&block.rows[axis + 3]), s.load(&block.rows[axis + 6])];
            let (least, greatest) = (s.min(s.min(a, b), c), s.max(s.max(a, b), c));
            (near[axis], far[axis]) = if self.near[axis] == axis { (least, greatest) } else { (greatest, least) };
        }
        // Pad the planes outwards by their own rounding.
        // As [`crate::widened::widened`] does it.
        let margin = |x| s.mul_add(abs(s, x), s.splat(WIDEN), s.splat(f32::MIN_POSITIVE));
        let (mut first, mut last) = (near, far);
        for axis in 0..3 {
            let (a, b) = (margin(near[axis]), margin(far[axis]));
            (first[axis], last[axis]) = if self.near[axis] == axis {
                (s.sub(near[axis], a), s.add(far[axis], b))
            } else {
                (s.add(near[axis], a), s.sub(far[axis], b))
            };
        }
        // Lanes without a triangle are NaN.
        let row = s.load(&block.rows[0]);
        (self.boxes(s, first, last, t_max).1 & s.bits(s.eq(row, row)), near)
    }

    /// The boxes with the given near and far planes that may be entered before `t_max`, with the distances at which the
    /// beam enters them.
    #[inline(always)]
    fn boxes(&self, s: S, near: [S::F; 3], far: [S::F; 3], t_max: S::F) -> (S::F, u32) {
        let ([i, j], [o, p]) = (&self.inverse, &self.offset);
        let near = [s.mul_add(near[0], i[0], o[0]), s.mul_add(near[1], i[1], o[1]), s.mul_add(near[2], i[2], o[2])];
        let far = [s.mul_add(far[0], j[0], p[0]), s.mul_add(far[1], j[1], p[1]), s.mul_add(far[2], j[2], p[2])];
        // Intersect the intervals of the three slabs with [0, t_max]; where it is empty no ray of the beam enters.
        let enter = s.farther(s.farther(near[0], near[1]), s.farther(near[2], s.splat(0.0)));
        let leave = s.nearer(s.nearer(far[0], far[1]), s.nearer(far[2], t_max));
        (enter, s.bits(s.le(enter, leave)))
    }
}

/// The least and the greatest of chosen numbers.
#[inline(always)]
pub(super) fn range<L: Lanes>(l: L, mask: L::M, x: L::F) -> [f32; 2] {
    let (top, bottom) = (l.splat(f32::INFINITY), l.splat(f32::NEG_INFINITY));
    [l.least(l.select(mask, x, top)), l.greatest(l.select(mask, x, bottom))]
}
