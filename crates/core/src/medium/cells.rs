//! A box cut into cells of equal size.

use std::cmp::Ordering;
use steradian_math::{Ray, Vec3, transform::Affine};

/// A box, placed by the map into the unit cube that stands for it, and the number of cells along each of its axes.
#[derive(Clone, Debug)]
pub struct Cells {
    /// Transform of the box to the unit cube.
    pub cube_from_world: Affine,
    /// Cells along each axis.
    pub count: [usize; 3],
}

impl Cells {
    /// The cell that a point is in.
    pub fn cell(&self, p: Vec3) -> Option<usize> {
        let p = self.cube_from_world.point(p);
        let is_within = p.min_element() >= 0.0 && p.max_element() < 1.0;
        let [x, y, z] = [0, 1, 2].map(|a| ((p[a] * self.count[a] as f32) as usize).min(self.count[a] - 1));
        is_within.then_some((z * self.count[1] + y) * self.count[0] + x)
    }

    /// Goes through the cells along a ray up to a distance: `visit` is given where each begins and ends, and its index,
    /// x fastest, until it says `false`.
    pub fn walk(&self, ray: &Ray, distance: f32, mut visit: impl FnMut(f32, f32, usize) -> bool) {
        let (o, d) = (self.cube_from_world.point(ray.origin), self.cube_from_world.vector(ray.direction));
        // Clip the ray to the unit cube, slab by slab.
        let (mut begin, mut end) = (0.0_f32, distance);
        for axis in 0..3 {
            let (a, b) = (-o[axis] / d[axis], (1.0 - o[axis]) / d[axis]);
            if d[axis] == 0.0 {
                if !(0.0..=1.0).contains(&o[axis]) {
                    return;
                }
                continue;
            }
            (begin, end) = (begin.max(a.min(b)), end.min(a.max(b)));
        }
        if begin.partial_cmp(&end) != Some(Ordering::Less) {
            return;
        }
        // Start in the cell of the entry point, and step through cells by the nearest border (Amanatides and Woo 1987).
        let p = o + d * begin;
        let count = Vec3::from_array(self.count.map(|c| c as f32));
        let mut cell: [i64; 3] =
            std::array::from_fn(|a| ((p[a] * count[a]).floor() as i64).clamp(0, self.count[a] as i64 - 1));
        let step: [i64; 3] = std::array::from_fn(|a| if d[a] < 0.0 { -1 } else { 1 });
        // The plane of the cell at which the ray leaves it along an axis.
        let border = |cell: &[i64; 3], a: usize| {
            let edge = (cell[a] + i64::from(step[a] > 0)) as f32 / count[a];
            if d[a] == 0.0 { f32::INFINITY } else { (edge - o[a]) / d[a] }
        };
        let mut at = begin;
        loop {
            let axis = (0..3).min_by(|a, b| border(&cell, *a).total_cmp(&border(&cell, *b))).unwrap_or(0);
            let next = border(&cell, axis).min(end).max(at);
            // Skip intervals without length, which rounding makes.
            let [x, y, z] = cell.map(|c| c as usize);
            if next > at && !visit(at, next, (z * self.count[1] + y) * self.count[0] + x) {
                return;
            }
            at = next;
            cell[axis] += step[axis];
            if at >= end || !(0..self.count[axis] as i64).contains(&cell[axis]) {
                return;
            }
        }
    }
}
