//! Numbers of pixels in rows that go on beyond the picture.

use rayon::prelude::*;

/// Columns that are computed together.
pub(super) const BLOCK: usize = 96;
/// A number of each of them.
pub(super) type Block = [f32; BLOCK];

/// A number of each pixel, row by row. Rows are continued to the left and right by a margin, and to the right by what
/// fills a block.
#[derive(Clone, Debug)]
pub(super) struct Plane {
    width: usize,
    height: usize,
    margin: usize,
    values: Vec<f32>,
}

impl Plane {
    /// Plane of the pixels' values; columns beyond the edge repeat the pixel at the edge.
    pub fn new([width, height]: [usize; 2], margin: usize, value: impl Fn(usize) -> f32 + Sync) -> Self {
        let stride = width + 2 * margin + BLOCK;
        let mut values = vec![0.0; stride * height];
        values.par_chunks_exact_mut(stride).enumerate().for_each(|(y, row)| {
            // Copy the row and repeat its ends over both margins, so that kernels need no bounds.
            row[margin..margin + width].iter_mut().enumerate().for_each(|(x, v)| *v = value(y * width + x));
            let [first, last] = [row[margin], row[margin + width - 1]];
            row[..margin].fill(first);
            row[margin + width..].fill(last);
        });
        Self { width, height, margin, values }
    }

    /// With another value beyond the edge.
    pub fn with_edge(mut self, edge: f32) -> Self {
        let (margin, width, stride) = (self.margin, self.width, self.stride());
        for row in self.values.chunks_exact_mut(stride) {
            row[..margin].fill(edge);
            row[margin + width..].fill(edge);
        }
        self
    }

    #[inline(always)]
    fn stride(&self) -> usize {
        self.width + 2 * self.margin + BLOCK
    }

    /// The value of a pixel of the picture.
    pub fn at(&self, place: usize) -> f32 {
        self.values[place / self.width * self.stride() + self.margin + place % self.width]
    }

    /// The values from a column of a row, at most the margin beyond the edge; rows beyond it are the one at the edge.
    #[inline(always)]
    pub fn block(&self, [x, y]: [i64; 2]) -> &Block {
        // Rows beyond the picture are those at its edge.
        let y = y.clamp(0, self.height as i64 - 1) as usize;
        let from = (y * self.stride() + self.margin).wrapping_add_signed(x as isize);
        self.values[from..].first_chunk().expect("a block lies in its row")
    }
}
