//! The bounds of a beam against the boxes of a node.

use super::beam::Beam;
use crate::layout::{Block, Node};
use crate::simd::{Lanes, Simd};
use crate::traverse::WIDEN;

/// Bounds of the origins and of the reciprocal directions of a beam: of what the rays' own tests compute with, so that a box that one
/// of them enters is entered by the bounds, whatever the rounding.
pub(super) struct Interval<S: Simd> {
    /// Of the origins the bound that makes the distance least, for near planes, and greatest, for far planes.
    origin: [[S::F; 3]; 2],
    /// Least and greatest reciprocal, for near planes and for far planes.
    inverse: [[[S::F; 3]; 2]; 2],
    near: [usize; 3],
    far: [usize; 3],
    /// Least and greatest of the origins by the axes of the sheared space, and of the shears.
    sheared_origin: [[S::F; 3]; 2],
    shear: [[S::F; 2]; 2],
    axes: [usize; 3],
}

impl<S: Simd> Interval<S> {
    /// The bounds of some rays of a beam.
    #[inline(always)]
    pub fn new<L: Lanes>(s: S, l: L, beam: &Beam<L>, lanes: u32) -> Self {
        let mask = l.mask(lanes);
        let zero = s.splat(0.0);
        let mut interval = Self {
            origin: [[zero; 3]; 2],
            inverse: [[[zero; 3]; 2]; 2],
            near: beam.near,
            far: beam.far,
            sheared_origin: [[zero; 3]; 2],
            shear: [[zero; 2]; 2],
            axes: beam.axes,
        };
        let (top, bottom) = (l.splat(f32::INFINITY), l.splat(f32::NEG_INFINITY));
        for axis in 0..3 {
            let origin = beam.origin[axis];
            let least = s.splat(l.least(l.select(mask, origin, top)));
            let greatest = s.splat(l.greatest(l.select(mask, origin, bottom)));
            let negative = beam.near[axis] >= 3;
            interval.origin[0][axis] = if negative { least } else { greatest };
            interval.origin[1][axis] = if negative { greatest } else { least };
            // Rounding is monotonic: the bounds of products are the products of bounds.
            let least = l.least(l.select(mask, beam.reciprocal[axis], top));
            let greatest = l.greatest(l.select(mask, beam.reciprocal[axis], bottom));
            for (side, factor) in [1.0 - WIDEN, 1.0 + WIDEN].into_iter().enumerate() {
                interval.inverse[side][0][axis] = s.splat(least * factor);
                interval.inverse[side][1][axis] = s.splat(greatest * factor);
            }
        }
        for axis in 0..3 {
            let of = beam.axes[axis];
            let negative = beam.near[of] >= 3;
            interval.sheared_origin[0][axis] = interval.origin[usize::from(!negative)][of];
            interval.sheared_origin[1][axis] = interval.origin[usize::from(negative)][of];
        }
        for axis in 0..2 {
            interval.shear[0][axis] = s.splat(l.least(l.select(mask, beam.shear[axis], top)));
            interval.shear[1][axis] = s.splat(l.greatest(l.select(mask, beam.shear[axis], bottom)));
        }
        interval
    }

    /// The triangles of a block that any of the rays may hit: not those that lie, sheared, to one side of the rays as a whole. The
    /// test of a triangle is exact in what it computes from the sheared corners, and these are bounded here with the same rounding.
    #[inline(always)]
    pub fn triangles(&self, s: S, block: &Block) -> u32 {
        let row = s.load(&block.rows[0]);
        let zero = s.splat(0.0);
        let mut outside = 0;
        let (a, b, c) = (self.depths(s, block, 0), self.depths(s, block, 1), self.depths(s, block, 2));
        for axis in 0..2 {
            let (a, b) = (self.corner(s, block, 0, axis, a), self.corner(s, block, 1, axis, b));
            let c = self.corner(s, block, 2, axis, c);
            let least = s.min(s.min(a[0], b[0]), c[0]);
            let greatest = s.max(s.max(a[1], b[1]), c[1]);
            outside |= s.bits(s.or(s.lt(zero, least), s.lt(greatest, zero)));
        }
        // Lanes without a triangle are NaN; numbers that overflowed decide nothing.
        s.bits(s.eq(row, row)) & !outside
    }

    /// Bounds of the depths of a corner.
    #[inline(always)]
    fn depths(&self, s: S, block: &Block, corner: usize) -> [S::F; 2] {
        let z = s.load(&block.rows[3 * corner + self.axes[2]]);
        [s.sub(z, self.sheared_origin[1][2]), s.sub(z, self.sheared_origin[0][2])]
    }

    /// Bounds of a sheared coordinate of a corner with given depths.
    #[inline(always)]
    fn corner(&self, s: S, block: &Block, corner: usize, axis: usize, [near, far]: [S::F; 2]) -> [S::F; 2] {
        let x = s.load(&block.rows[3 * corner + self.axes[axis]]);
        let (a, b) = (s.mul(self.shear[0][axis], near), s.mul(self.shear[1][axis], near));
        let (c, d) = (s.mul(self.shear[0][axis], far), s.mul(self.shear[1][axis], far));
        let least = s.min(s.min(a, b), s.min(c, d));
        let greatest = s.max(s.max(a, b), s.max(c, d));
        [s.sub(s.sub(x, self.sheared_origin[1][axis]), greatest), s.sub(s.sub(x, self.sheared_origin[0][axis]), least)]
    }

    /// Distances that are not greater than those at which any ray enters the boxes, and which boxes may be entered before `t_max`.
    #[inline(always)]
    pub fn test(&self, s: S, node: &Node, t_max: S::F) -> (S::F, u32) {
        let near = [self.near(s, node, 0), self.near(s, node, 1), self.near(s, node, 2)];
        let far = [self.far(s, node, 0), self.far(s, node, 1), self.far(s, node, 2)];
        let enter = s.farther(s.farther(near[0], near[1]), s.farther(near[2], s.splat(0.0)));
        let leave = s.nearer(s.nearer(far[0], far[1]), s.nearer(far[2], t_max));
        (enter, s.bits(s.le(enter, leave)))
    }

    #[inline(always)]
    fn near(&self, s: S, node: &Node, axis: usize) -> S::F {
        let depth = s.sub(s.load(&node.rows[self.near[axis]]), self.origin[0][axis]);
        s.min(s.mul(depth, self.inverse[0][0][axis]), s.mul(depth, self.inverse[0][1][axis]))
    }

    #[inline(always)]
    fn far(&self, s: S, node: &Node, axis: usize) -> S::F {
        let depth = s.sub(s.load(&node.rows[self.far[axis]]), self.origin[1][axis]);
        s.max(s.mul(depth, self.inverse[1][0][axis]), s.mul(depth, self.inverse[1][1][axis]))
    }
}
