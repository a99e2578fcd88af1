//! Which samples of a block a primitive covers.

use super::lanes::{COLUMN, ROW, bits_where};
use crate::{
    primitive::{Edge, Primitive},
    render_target::BLOCK,
    samples::{Pattern, SUBPIXELS},
};

/// A block that a primitive touches.
pub(super) struct Block {
    /// The edges that cross the block: gradients, and the value at the block's corner.
    edges: [(Edge, i64); 4],
    count: usize,
    /// Columns in the primitive's box, one bit each; rows of it.
    columns: u16,
    rows: [i32; 2],
}

impl Block {
    /// The block at this pixel; `None` where an edge has all of it outside.
    #[inline]
    pub fn new(primitive: &Primitive, pattern: &Pattern, pixel: [i32; 2]) -> Option<Self> {
        let size = BLOCK as i32;
        let at = pixel.map(|x| i64::from(x) * i64::from(SUBPIXELS));
        let last = i64::from((size - 1) * SUBPIXELS);
        // The box of all samples.
        let low = [0, 1].map(|i| at[i] + i64::from(pattern.min[i]));
        let high = [0, 1].map(|i| at[i] + last + i64::from(pattern.max[i]));
        let mut edges = [(Edge::default(), 0); 4];
        let mut count = 0;
        for edge in &primitive.edges[..usize::from(primitive.edge_count)] {
            // Evaluate each edge at the corner of the sample box farthest inside and at the one farthest outside
            // (Pineda, "A Parallel Algorithm for Polygon Rasterization", SIGGRAPH 1988).
            let (x0, x1) = if edge.a > 0 { (low[0], high[0]) } else { (high[0], low[0]) };
            let (y0, y1) = if edge.b > 0 { (low[1], high[1]) } else { (high[1], low[1]) };
            // The most inner corner is outside: the edge rejects the block.
            if edge.at(x1, y1) < 0 {
                return None;
            }
            // Only an edge that crosses the block needs a test at each sample.
            if edge.at(x0, y0) < 0 {
                edges[count] = (*edge, edge.at(at[0], at[1]));
                count += 1;
            }
        }
        let within = |axis: usize| {
            [(primitive.min[axis] - pixel[axis]).clamp(0, size), (primitive.max[axis] - pixel[axis]).clamp(0, size)]
        };
        let [first, end] = within(0);
        // Restrict to the columns of the primitive's box, as a bit mask.
        let columns = if first < end { ((1u16 << (end - first)) - 1) << first } else { 0 };
        Some(Self { edges, count, columns, rows: within(1) })
    }

    /// The strips with rows in the primitive's box.
    pub fn strips(&self) -> std::ops::Range<usize> {
        (self.rows[0] / 2) as usize..((self.rows[1] + 1) / 2) as usize
    }

    /// True if all samples of the block are covered.
    pub fn is_whole(&self) -> bool {
        self.count == 0 && self.columns == 0xff && self.rows == [0, BLOCK as i32]
    }

    /// The covered samples of a strip.
    #[inline]
    pub fn strip(&self, pattern: &Pattern, index: usize, wanted: u32, masks: &mut [u16; 16]) {
        let row = 2 * index as i32;
        let in_box = |r: i32| if (self.rows[0]..self.rows[1]).contains(&r) { self.columns } else { 0 };
        let limit = in_box(row) | in_box(row + 1) << 8;
        for (sample, mask) in masks[..pattern.count].iter_mut().enumerate() {
            if wanted >> sample & 1 == 0 {
                continue;
            }
            *mask = limit;
            if self.count > 0 {
                *mask &= self.inside(pattern.offsets[sample], row);
            }
        }
    }

    /// The pixels whose sample at this offset is inside all edges. Steps from pixel to pixel are whole multiples of
    /// 256, so that values may be divided by 256 and rounded down without a change of sign.
    #[inline]
    fn inside(&self, offset: [i32; 2], row: i32) -> u16 {
        let mut all = [0i32; 16];
        for (edge, corner) in &self.edges[..self.count] {
            // Edge function at the first pixel's sample, then steps by its gradients: sixteen pixels at a time.
            let start = corner + i64::from(edge.a) * i64::from(offset[0]) + i64::from(edge.b) * i64::from(offset[1]);
            let start = (start >> SUBPIXELS.trailing_zeros()) as i32 + edge.b * row;
            for (i, all) in all.iter_mut().enumerate() {
                // The sign bit of the disjunction is set where any edge function is negative.
                *all |= start + edge.a * COLUMN[i] + edge.b * ROW[i];
            }
        }
        bits_where(|i| all[i] >= 0)
    }
}
