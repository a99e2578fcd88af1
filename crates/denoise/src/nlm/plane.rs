//! Numbers of pixels in rows that go on beyond the picture.

use rayon::prelude::*;

/// Columns that are computed together.
pub(super) const BLOCK: usize = 96;
/// Columns that rows are continued by to the left and right: a window's.
pub(super) const MARGIN: usize = 24;
/// A number of each of them.
pub(super) type Block = [f32; BLOCK];

/// A number of each pixel, row by row. Rows are continued to the left and right by a margin, and to the right by what
/// fills a block.
#[derive(Clone, Debug)]
pub(super) struct Plane {
    width: usize,
    height: usize,
    values: Vec<f32>,
}

impl Plane {
    /// Plane of the pixels' values; columns beyond the edge repeat the pixel at the edge.
    pub fn new([width, height]: [usize; 2], value: impl Fn(usize) -> f32 + Sync) -> Self {
        let stride = width + 2 * MARGIN + BLOCK;
        let mut values = vec![0.0; stride * height];
        values.par_chunks_exact_mut(stride).enumerate().for_each(|(y, row)| {
            // Copy the row and repeat its ends over both margins, so that kernels need no bounds.
            row[MARGIN..MARGIN + width].iter_mut().enumerate().for_each(|(x, v)| *v = value(y * width + x));
            let [first, last] = [row[MARGIN], row[MARGIN + width - 1]];
            row[..MARGIN].fill(first);
            row[MARGIN + width..].fill(last);
        });
        Self { width, height, values }
    }

    /// With another value beyond the edge.
    pub fn with_edge(mut self, edge: f32) -> Self {
        let (width, stride) = (self.width, self.stride());
        for row in self.values.chunks_exact_mut(stride) {
            row[..MARGIN].fill(edge);
            row[MARGIN + width..].fill(edge);
        }
        self
    }

    /// Width and height in pixels.
    pub fn size(&self) -> [usize; 2] {
        [self.width, self.height]
    }

    #[inline(always)]
    fn stride(&self) -> usize {
        self.width + 2 * MARGIN + BLOCK
    }

    /// The value of a pixel of the picture.
    pub fn at(&self, place: usize) -> f32 {
        self.values[place / self.width * self.stride() + MARGIN + place % self.width]
    }

    /// The values from a column of a row, at most the margin beyond the edge; rows beyond it are the one at the edge.
    #[inline(always)]
    pub fn block(&self, at: [i64; 2]) -> &Block {
        self.row(at)
    }

    /// Likewise as many as asked for, a block's at most.
    #[inline(always)]
    pub fn row<const N: usize>(&self, [x, y]: [i64; 2]) -> &[f32; N] {
        // Rows beyond the picture are those at its edge.
        let y = y.clamp(0, self.height as i64 - 1) as usize;
        let from = (y * self.stride() + MARGIN).wrapping_add_signed(x as isize);
        self.values[from..].first_chunk().expect("a block lies in its row")
    }
}
