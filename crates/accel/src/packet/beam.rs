//! Rays of a packet that go the same way: what their tests need, by rows.

use crate::layout::Node;
use crate::packet_rays::Packet;
use crate::ray_constants::AXES;
use crate::ray_constants::{GREATEST, RayConstants};
use crate::simd::{Lanes, Wide};
use crate::triangle::abs;
use crate::widened::WIDEN;
use steradian_math::Vec3;

/// Ray constants of a packet that the intersection tests need.
#[derive(Clone, Copy)]
pub(super) struct Rows<L: Lanes> {
    pub origin: [L::F; 3],
    /// See [`RayConstants`].
    pub inverse: [L::F; 3],
    offset: [[L::F; 3]; 2],
    /// Twice the greatest bound on rounding of a distance.
    slack: L::F,
    pub shear: [L::F; 3],
}

/// The rays of a packet, and which way they go.
pub(super) struct BeamConstants<L: Lanes> {
    pub rows: Rows<L>,
    /// Rays that are valid and have an interval that is not empty.
    pub valid: u32,
    /// Rays that move enough along each axis, see [`RayConstants`].
    pub moving: u32,
    /// By axis the rays whose direction is negative.
    negative: [u32; 3],
    /// By axis the rays whose direction is greatest along it.
    along: [u32; 3],
}

/// Ray constants of triangle tests, for rays with the same greatest axis.
#[derive(Clone, Copy)]
pub(super) struct ShearedRays<L: Lanes> {
    /// Axes in the order x, y, z of the sheared space.
    pub axes: [usize; 3],
    /// The origins by these axes.
    pub origin: [L::F; 3],
    /// Shear of x and y, and scale of z.
    pub shear: [L::F; 3],
    /// Reciprocals of the directions along x and y.
    pub inverse: [L::F; 2],
}

/// Rays with the same signs and the same greatest axis.
pub(super) struct Beam<L: Lanes> {
    pub rows: Rows<L>,
    pub axes: [usize; 3],
    /// Rows of the near planes and of the far planes.
    pub near: [usize; 3],
    pub far: [usize; 3],
}

impl<L: Lanes> BeamConstants<L> {
    /// Looks at all rays of a packet.
    #[inline(always)]
    pub fn new(l: L, packet: &Packet) -> Self {
        let zero = l.splat(0.0);
        let origin = [l.read(&packet.origin[0]), l.read(&packet.origin[1]), l.read(&packet.origin[2])];
        let d = [l.read(&packet.direction[0]), l.read(&packet.direction[1]), l.read(&packet.direction[2])];
        let (mut inverse, mut offset) = ([zero; 3], [[zero; 3]; 2]);
        let mut negative = [0; 3];
        let (mut valid, mut moving, mut moves) = (u32::MAX, u32::MAX, 0);
        let (mut size, mut slack) = ([zero; 3], zero);
        for axis in 0..3 {
            let (o, d) = (origin[axis], d[axis]);
            // Bound the rounding of (p − o)·(1/d) by a multiple of |o|·|1/d|, as the constants of single rays do.
            let reciprocal = l.div(l.splat(1.0), d);
            let error = l.mul(abs(l, o), abs(l, reciprocal));
            moving &= l.bits(l.le(error, l.splat(GREATEST)));
            let error = l.add(l.mul(error, l.splat(WIDEN)), l.splat(f32::MIN_POSITIVE));
            let exact = l.sub(zero, l.mul(o, reciprocal));
            inverse[axis] = reciprocal;
            offset[0][axis] = l.sub(exact, error);
            offset[1][axis] = l.add(exact, error);
            // Far planes may be tested with the near offset when the sum of both bounds is added to the exit distance.
            slack = l.max(l.add(error, error), slack);
            negative[axis] = l.bits(l.lt(d, zero));
            size[axis] = abs(l, d);
            // x − x is zero for finite x only: infinite and NaN coordinates drop out here.
            valid &= l.bits(l.and(l.eq(l.sub(o, o), zero), l.eq(l.sub(d, d), zero)));
            moves |= l.bits(l.lt(zero, size[axis]));
        }
        valid &= moves & l.bits(l.lt(zero, l.read(&packet.t_max)));
        // Choose the axis of greatest extent of each direction; ties go to the earlier axis, as for single rays.
        let [x, y, z] = size;
        let along_x = l.bits(l.and(l.le(y, x), l.le(z, x)));
        let along_y = l.bits(l.le(z, y)) & !along_x;
        let along_z = !(along_x | along_y);
        let masks = [l.mask(along_x), l.mask(along_y)];
        let greatest = chosen(l, masks, d);
        // Shear constants S_x = d_x/d_z, S_y = d_y/d_z, S_z = 1/d_z (Woop, Benthin, Wald, "Watertight Ray/Triangle
        // Intersection", JCGT 2013).
        let shear = [
            l.div(chosen(l, masks, [d[1], d[2], d[0]]), greatest),
            l.div(chosen(l, masks, [d[2], d[0], d[1]]), greatest),
            chosen(l, masks, inverse),
        ];
        let rows = Rows { origin, inverse, offset, slack, shear };
        Self { rows, valid, moving, negative, along: [along_x, along_y, along_z] }
    }

    /// The axis along which a ray moves most.
    #[inline(always)]
    fn greatest_axis(&self, lane: usize) -> usize {
        let is = |lanes: u32| lanes >> lane & 1 == 1;
        if is(self.along[0]) {
            0
        } else if is(self.along[1]) {
            1
        } else {
            2
        }
    }

    /// The rays among `rest` that go the same way as the first of them.
    #[inline(always)]
    pub fn like_first(&self, rest: u32) -> u32 {
        // Isolate the lowest set bit and keep the lanes that agree with it in all signs and in the dominant axis.
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
    pub fn beam(&self, lane: usize) -> Beam<L> {
        let (mut near, mut far) = ([0, 1, 2], [3, 4, 5]);
        // A ray in a negative direction enters through the upper plane and leaves through the lower one.
        for axis in 0..3 {
            if self.negative[axis] >> lane & 1 == 1 {
                (near[axis], far[axis]) = (axis + 3, axis);
            }
        }
        Beam { rows: self.rows, axes: AXES[self.greatest_axis(lane)], near, far }
    }

    /// Ray constants for tracing the rays singly.
    #[inline(always)]
    pub fn single(&self, l: L) -> SingleRays {
        let zero = [Wide::splat(0.0); 3];
        let mut single = SingleRays { inverse: zero, offset: [zero; 2], shear: zero, along: self.along };
        for axis in 0..3 {
            l.write(self.rows.inverse[axis], &mut single.inverse[axis]);
            l.write(self.rows.offset[0][axis], &mut single.offset[0][axis]);
            l.write(self.rows.offset[1][axis], &mut single.offset[1][axis]);
            l.write(self.rows.shear[axis], &mut single.shear[axis]);
        }
        single
    }
}

/// The first numbers where the first mask is set, else the second ones where the second is, else the third ones.
#[inline(always)]
fn chosen<L: Lanes>(l: L, [first, second]: [L::M; 2], [a, b, c]: [L::F; 3]) -> L::F {
    l.select(first, a, l.select(second, b, c))
}

/// Ray constants of a packet's rays for tracing them singly, or by one register without the others.
pub(super) struct SingleRays {
    inverse: [Wide; 3],
    offset: [[Wide; 3]; 2],
    shear: [Wide; 3],
    along: [u32; 3],
}

impl SingleRays {
    /// Constants of one of the rays.
    #[inline(always)]
    pub fn get(&self, lane: usize) -> RayConstants {
        let vector = |rows: &[Wide; 3]| Vec3::new(rows[0].0[lane], rows[1].0[lane], rows[2].0[lane]);
        let [_, y, z] = self.along.map(|lanes| (lanes >> lane & 1) as usize);
        RayConstants {
            inverse: vector(&self.inverse),
            offset: [vector(&self.offset[0]), vector(&self.offset[1])],
            axes: AXES[(y + 2 * z) % 3],
            shear: vector(&self.shear).to_array(),
        }
    }
}

impl<L: Lanes> ShearedRays<L> {
    /// Constants of as many rays of a packet as there are lanes, from `first` on.
    #[inline(always)]
    pub fn new(l: L, packet: &Packet, single: &SingleRays, first: usize, axes: [usize; 3]) -> Self {
        let [x, y, z] = axes;
        Self {
            axes,
            origin: [
                l.read_from(&packet.origin[x], first),
                l.read_from(&packet.origin[y], first),
                l.read_from(&packet.origin[z], first),
            ],
            shear: [
                l.read_from(&single.shear[0], first),
                l.read_from(&single.shear[1], first),
                l.read_from(&single.shear[2], first),
            ],
            inverse: [l.read_from(&single.inverse[x], first), l.read_from(&single.inverse[y], first)],
        }
    }
}

impl<L: Lanes> Rows<L> {
    /// The rays that enter a box of a node in `[0, t_max]`, whichever way they go, and perhaps some that almost do.
    #[inline(always)]
    pub fn enter(&self, l: L, node: &Node, slot: usize, t_max: L::F) -> u32 {
        let (mut enter, mut leave) = (l.splat(0.0), t_max);
        for axis in 0..3 {
            // Both with the bound on rounding of near planes: that of far ones is in the slack.
            let (inverse, offset) = (self.inverse[axis], self.offset[0][axis]);
            let first = l.mul_add(l.splat(node.rows[axis].0[slot]), inverse, offset);
            let last = l.mul_add(l.splat(node.rows[axis + 3].0[slot]), inverse, offset);
            // The signs of the rays differ: sort both slab distances, near and far, by minimum and maximum.
            enter = l.max(l.min(first, last), enter);
            leave = l.min(l.max(first, last), leave);
        }
        l.bits(l.le(enter, l.add(leave, self.slack)))
    }
}

impl<L: Lanes> Beam<L> {
    /// True if the slopes of the rays in `lanes` differ by less than `than`, so that their bounds are worth a test.
    #[inline(always)]
    pub fn is_narrow(&self, l: L, lanes: u32, than: f32) -> bool {
        let mask = l.mask(lanes);
        let (top, bottom) = (l.splat(f32::INFINITY), l.splat(f32::NEG_INFINITY));
        let spread = |shear: L::F| l.greatest(l.select(mask, shear, bottom)) - l.least(l.select(mask, shear, top));
        spread(self.rows.shear[0]).max(spread(self.rows.shear[1])) < than
    }

    /// The rays that enter a box of a node in `[0, t_max]`.
    #[inline(always)]
    pub fn enters(&self, l: L, node: &Node, slot: usize, t_max: L::F) -> u32 {
        let near = [self.plane(l, node, slot, 0, 0), self.plane(l, node, slot, 0, 1), self.plane(l, node, slot, 0, 2)];
        let far = [self.plane(l, node, slot, 1, 0), self.plane(l, node, slot, 1, 1), self.plane(l, node, slot, 1, 2)];
        // Enter at the last near plane, leave at the first far plane; the box is entered where the interval is not
        // empty (Kay and Kajiya 1986).
        let enter = l.farther(l.farther(near[0], near[1]), l.farther(near[2], l.splat(0.0)));
        let leave = l.nearer(l.nearer(far[0], far[1]), l.nearer(far[2], t_max));
        l.bits(l.le(enter, leave))
    }

    /// Distances of the rays to a near or far plane.
    #[inline(always)]
    fn plane(&self, l: L, node: &Node, slot: usize, side: usize, axis: usize) -> L::F {
        let row = if side == 0 { self.near[axis] } else { self.far[axis] };
        l.mul_add(l.splat(node.rows[row].0[slot]), self.rows.inverse[axis], self.rows.offset[side][axis])
    }
}
