//! The bounds of a beam against the boxes of a node.

use super::beam::Beam;
use crate::layout::Node;
use crate::simd::{Lanes, Simd};

/// Bounds of the origins and of the reciprocal directions of a beam: of what the rays' own tests compute with, so that a box that one
/// of them enters is entered by the bounds, whatever the rounding.
pub(super) struct Interval<S: Simd> {
    /// Of the origins the bound that makes the distance least, for near planes, and greatest, for far planes.
    origin: [[S::F; 3]; 2],
    /// Least and greatest reciprocal, for near planes and for far planes.
    inverse: [[[S::F; 3]; 2]; 2],
    near: [usize; 3],
    far: [usize; 3],
}

impl<S: Simd> Interval<S> {
    /// The bounds of some rays of a beam.
    #[inline(always)]
    pub fn new<L: Lanes>(s: S, l: L, beam: &Beam<L>, lanes: u32) -> Self {
        let mask = l.mask(lanes);
        let zero = s.splat(0.0);
        let mut interval =
            Self { origin: [[zero; 3]; 2], inverse: [[[zero; 3]; 2]; 2], near: beam.near, far: beam.far };
        let (top, bottom) = (l.splat(f32::INFINITY), l.splat(f32::NEG_INFINITY));
        for axis in 0..3 {
            let origin = beam.origin[axis];
            let least = s.splat(l.least(l.select(mask, origin, top)));
            let greatest = s.splat(l.greatest(l.select(mask, origin, bottom)));
            let negative = beam.near[axis] >= 3;
            interval.origin[0][axis] = if negative { least } else { greatest };
            interval.origin[1][axis] = if negative { greatest } else { least };
            for side in 0..2 {
                let inverse = beam.inverse[side][axis];
                interval.inverse[side][0][axis] = s.splat(l.least(l.select(mask, inverse, top)));
                interval.inverse[side][1][axis] = s.splat(l.greatest(l.select(mask, inverse, bottom)));
            }
        }
        interval
    }

    /// Distances that are not greater than those at which any ray enters the boxes, and which boxes may be entered before `t_max`.
    #[inline(always)]
    pub fn test(&self, s: S, node: &Node, t_max: S::F) -> (S::F, u32) {
        let near = [self.near(s, node, 0), self.near(s, node, 1), self.near(s, node, 2)];
        let far = [self.far(s, node, 0), self.far(s, node, 1), self.far(s, node, 2)];
        let enter = s.max(s.max(near[0], near[1]), s.max(near[2], s.splat(0.0)));
        let leave = s.min(s.min(far[0], far[1]), s.min(far[2], t_max));
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
