//! The test of a ray against the boxes of a node.
#![expect(unsafe_code, reason = "unchecked reads; each place states why it is sound")]

use crate::layout::Node;
use crate::ray_constants::RayConstants;
use crate::simd::Simd;

/// Ray constants of the slab test.
pub(crate) struct Slabs<S: Simd> {
    /// See [`RayConstants`].
    inverse: [S::F; 3],
    offset: [[S::F; 3]; 2],
    /// Rows of the near planes and of the far planes.
    near: [usize; 3],
    far: [usize; 3],
}

impl<S: Simd> Slabs<S> {
    #[inline(always)]
    pub fn new(s: S, constants: &RayConstants) -> Self {
        // The sign of the reciprocal tells which plane of each pair the ray meets first.
        let rows = |x: f32, axis: usize| if x.is_sign_negative() { (axis + 3, axis) } else { (axis, axis + 3) };
        let (x, y, z) = (rows(constants.inverse.x, 0), rows(constants.inverse.y, 1), rows(constants.inverse.z, 2));
        Self {
            inverse: s.splat3(constants.inverse),
            offset: [s.splat3(constants.offset[0]), s.splat3(constants.offset[1])],
            near: [x.0, y.0, z.0],
            far: [x.1, y.1, z.1],
        }
    }

    /// Distances at which the ray enters the boxes, and which boxes it enters.
    #[inline(always)]
    pub fn test(&self, s: S, node: &Node, t_max: S::F) -> (S::F, u32) {
        let near = |axis| self.plane(s, node, self.near[axis], 0, axis);
        let far = |axis| self.plane(s, node, self.far[axis], 1, axis);
        // Intersect the three slabs and [0, t_max] of eight boxes at once (Kay and Kajiya 1986).
        let enter = s.farther(s.farther(near(0), near(1)), s.farther(near(2), s.splat(0.0)));
        let leave = s.nearer(s.nearer(far(0), far(1)), s.nearer(far(2), t_max));
        (enter, s.bits(s.le(enter, leave)))
    }

    /// Distances of the ray to the planes of a row.
    #[inline(always)]
    fn plane(&self, s: S, node: &Node, row: usize, side: usize, axis: usize) -> S::F {
        // SAFETY: rows of planes are less than six.
        let row = unsafe { node.rows.get_unchecked(row) };
        s.mul_add(s.load(row), self.inverse[axis], self.offset[side][axis])
    }
}
