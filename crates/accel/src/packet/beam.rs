//! Rays of a packet that go the same way: what their tests need, by rows.

use crate::layout::{Block, Node};
use crate::packet::Packet;
use crate::simd::{Lanes, Wide};
use crate::traverse::{WIDEN, Way};
use crate::triangle::{Crossing, cross};
use steradian_math::{Bounds3, Ray, Vec3};

/// What the tests need of the rays of a packet, and which way they go.
pub(super) struct Ways<L: Lanes> {
    pub origin: [L::F; 3],
    inverse: [[L::F; 3]; 2],
    direction: [L::F; 3],
    reciprocal: [L::F; 3],
    /// Rays that are valid and have an interval that is not empty.
    pub valid: u32,
    /// Rays whose direction has finite reciprocals.
    pub finite: u32,
    /// By axis the rays whose direction is negative.
    negative: [u32; 3],
    /// By axis the rays whose direction is greatest along it.
    along: [u32; 3],
}

/// Slopes of a beam differ by less than this. Measured.
const NARROW: f32 = 0.6;

/// Rays with the same signs and the same greatest axis.
pub(super) struct Beam<L: Lanes> {
    pub origin: [L::F; 3],
    /// Reciprocals of the direction, made a little smaller for near planes and greater for far ones.
    pub inverse: [[L::F; 3]; 2],
    pub reciprocal: [L::F; 3],
    pub shear: [L::F; 3],
    pub axes: [usize; 3],
    /// Rows of the near planes and of the far planes.
    pub near: [usize; 3],
    pub far: [usize; 3],
}

impl<L: Lanes> Ways<L> {
    /// Looks at all rays of a packet.
    #[inline(always)]
    pub fn new(l: L, packet: &Packet) -> Self {
        let zero = l.splat(0.0);
        let origin = [l.read(&packet.origin[0]), l.read(&packet.origin[1]), l.read(&packet.origin[2])];
        let direction = [l.read(&packet.direction[0]), l.read(&packet.direction[1]), l.read(&packet.direction[2])];
        let one = l.splat(1.0);
        let (shorter, longer) = (l.splat(1.0 - WIDEN), l.splat(1.0 + WIDEN));
        let (mut inverse, mut reciprocals) = ([[zero; 3]; 2], [zero; 3]);
        let mut negative = [0; 3];
        let (mut valid, mut finite, mut moves) = (u32::MAX, u32::MAX, 0);
        let mut size = [zero; 3];
        for axis in 0..3 {
            let (o, d) = (origin[axis], direction[axis]);
            let reciprocal = l.div(one, d);
            reciprocals[axis] = reciprocal;
            inverse[0][axis] = l.mul(reciprocal, shorter);
            inverse[1][axis] = l.mul(reciprocal, longer);
            negative[axis] = l.bits(l.lt(d, zero));
            size[axis] = l.max(d, l.sub(zero, d));
            valid &= l.bits(l.and(l.eq(l.sub(o, o), zero), l.eq(l.sub(d, d), zero)));
            moves |= l.bits(l.lt(zero, size[axis]));
            finite &= l.bits(l.eq(l.sub(inverse[1][axis], inverse[1][axis]), zero));
        }
        valid &= moves & l.bits(l.lt(zero, l.read(&packet.t_max)));
        let [x, y, z] = size;
        let along_x = l.bits(l.and(l.le(y, x), l.le(z, x)));
        let along_y = l.bits(l.le(z, y)) & !along_x;
        let along = [along_x, along_y, !(along_x | along_y)];
        Self { origin, inverse, direction, reciprocal: reciprocals, valid, finite, negative, along }
    }

    /// The rays among `rest` that go the same way as the first of them.
    #[inline(always)]
    pub fn like_first(&self, rest: u32) -> u32 {
        let first = rest & rest.wrapping_neg();
        let mut same = rest;
        for axis in 0..3 {
            same &= if self.negative[axis] & first == 0 { !self.negative[axis] } else { self.negative[axis] };
            same &= if self.along[axis] & first == 0 { !self.along[axis] } else { self.along[axis] };
        }
        same
    }

    /// The beam that a ray belongs to; in the lanes of others it has no meaning.
    #[inline(always)]
    pub fn beam(&self, l: L, lane: usize) -> Beam<L> {
        let is = |lanes: u32| lanes >> lane & 1 == 1;
        let z = if is(self.along[0]) {
            0
        } else if is(self.along[1]) {
            1
        } else {
            2
        };
        let axes = [[1, 2, 0], [2, 0, 1], [0, 1, 2]][z];
        let [x, y, z] = axes;
        let d = &self.direction;
        let (mut near, mut far) = ([0, 1, 2], [3, 4, 5]);
        for axis in 0..3 {
            if is(self.negative[axis]) {
                (near[axis], far[axis]) = (axis + 3, axis);
            }
        }
        Beam {
            origin: self.origin,
            inverse: self.inverse,
            reciprocal: self.reciprocal,
            shear: [l.div(d[x], d[z]), l.div(d[y], d[z]), self.reciprocal[z]],
            axes,
            near,
            far,
        }
    }
}

/// What the rays of a beam need when they go on alone.
pub(super) struct Apart {
    reciprocal: [Wide; 3],
    shear: [Wide; 3],
    axes: [usize; 3],
}

impl Apart {
    /// Of one of the rays.
    #[inline(always)]
    pub fn get(&self, lane: usize, ray: &Ray, bounds: &Bounds3) -> Way {
        let vector = |rows: &[Wide; 3]| Vec3::new(rows[0].0[lane], rows[1].0[lane], rows[2].0[lane]);
        Way::with(ray, bounds, vector(&self.reciprocal), self.axes, vector(&self.shear).to_array())
    }
}

impl<L: Lanes> Beam<L> {
    /// Whether some of its rays go so nearly the same way that their bounds are worth a test.
    #[inline(always)]
    pub fn is_narrow(&self, l: L, lanes: u32) -> bool {
        let mask = l.mask(lanes);
        let (top, bottom) = (l.splat(f32::INFINITY), l.splat(f32::NEG_INFINITY));
        let spread = |shear: L::F| l.greatest(l.select(mask, shear, bottom)) - l.least(l.select(mask, shear, top));
        spread(self.shear[0]).max(spread(self.shear[1])) < NARROW
    }

    /// What its rays need when they go on alone.
    #[inline(always)]
    pub fn apart(&self, l: L) -> Apart {
        let zero = [Wide::splat(0.0); 3];
        let mut apart = Apart { reciprocal: zero, shear: zero, axes: self.axes };
        for axis in 0..3 {
            l.write(self.reciprocal[axis], &mut apart.reciprocal[axis]);
            l.write(self.shear[axis], &mut apart.shear[axis]);
        }
        apart
    }

    /// The rays that enter a box of a node in `[0, t_max]`.
    #[inline(always)]
    pub fn enters(&self, l: L, node: &Node, slot: usize, t_max: L::F) -> u32 {
        let near = [self.plane(l, node, slot, 0, 0), self.plane(l, node, slot, 0, 1), self.plane(l, node, slot, 0, 2)];
        let far = [self.plane(l, node, slot, 1, 0), self.plane(l, node, slot, 1, 1), self.plane(l, node, slot, 1, 2)];
        let enter = l.farther(l.farther(near[0], near[1]), l.farther(near[2], l.splat(0.0)));
        let leave = l.nearer(l.nearer(far[0], far[1]), l.nearer(far[2], t_max));
        l.bits(l.le(enter, leave))
    }

    /// Where the rays meet a near or far plane.
    #[inline(always)]
    fn plane(&self, l: L, node: &Node, slot: usize, side: usize, axis: usize) -> L::F {
        let row = if side == 0 { self.near[axis] } else { self.far[axis] };
        l.mul(l.sub(l.splat(node.rows[row].0[slot]), self.origin[axis]), self.inverse[side][axis])
    }

    /// Tests a triangle of a block.
    #[inline(always)]
    pub fn cross(&self, l: L, block: &Block, slot: usize, t_max: L::F) -> Option<Crossing<L>> {
        let corners = [self.vertex(l, block, slot, 0), self.vertex(l, block, slot, 1), self.vertex(l, block, slot, 2)];
        cross(l, corners, self.shear[2], t_max)
    }

    /// A vertex relative to the origins, sheared.
    #[inline(always)]
    fn vertex(&self, l: L, block: &Block, slot: usize, vertex: usize) -> [L::F; 3] {
        let x = self.coordinate(l, block, slot, 3 * vertex, 0);
        let y = self.coordinate(l, block, slot, 3 * vertex, 1);
        let z = self.coordinate(l, block, slot, 3 * vertex, 2);
        [l.sub(x, l.mul(self.shear[0], z)), l.sub(y, l.mul(self.shear[1], z)), z]
    }

    #[inline(always)]
    fn coordinate(&self, l: L, block: &Block, slot: usize, first_row: usize, axis: usize) -> L::F {
        l.sub(l.splat(block.rows[first_row + self.axes[axis]].0[slot]), self.origin[self.axes[axis]])
    }
}
