//! Pixels in columns of numbers, for loops over many at once.

use rayon::prelude::*;

/// Pixels of a block.
pub(crate) const WIDTH: usize = 64;
/// A number of each pixel of a block.
pub(crate) type Column<T = f32> = [T; WIDTH];

/// Planes of values for each pixel, row by row; in a row, one plane after another. Planes are continued to the left and
/// right by a margin, and by what fills the last block of a row, with pixels that are not of the picture.
#[derive(Clone, Debug)]
pub(crate) struct Rows<T = f32> {
    width: usize,
    height: usize,
    planes: usize,
    margin: usize,
    values: Vec<T>,
}

impl<T: Copy + Send + Sync> Rows<T> {
    /// Rows of one value for each plane.
    pub fn filled([width, height]: [u32; 2], planes: &[T], margin: usize) -> Self {
        let (width, height) = (width as usize, height as usize);
        let rows = Self { width, height, planes: planes.len(), margin, values: Vec::new() };
        let row: Vec<T> = planes.iter().flat_map(|&value| std::iter::repeat_n(value, rows.stride())).collect();
        Self { values: row.repeat(height), ..rows }
    }

    /// Width and height in pixels.
    pub fn size(&self) -> [u32; 2] {
        [self.width as u32, self.height as u32]
    }

    /// Width in pixels.
    #[inline(always)]
    pub fn width(&self) -> usize {
        self.width
    }

    /// Number of planes.
    #[inline(always)]
    pub fn planes(&self) -> usize {
        self.planes
    }

    /// From a plane's row to the next plane's.
    #[inline(always)]
    fn stride(&self) -> usize {
        self.width.next_multiple_of(WIDTH) + 2 * self.margin
    }

    /// The row some rows from another, if there is one.
    #[inline(always)]
    pub fn row_at(&self, y: usize, offset: i64) -> Option<usize> {
        usize::try_from(y as i64 + offset).ok().filter(|&y| y < self.height)
    }

    /// The value of a pixel of the picture.
    #[inline(always)]
    pub fn at(&self, plane: usize, x: usize, y: usize) -> T {
        self.values[(y * self.planes + plane) * self.stride() + self.margin + x]
    }

    /// The values of a block of pixels, some columns from that at (x, y). Columns beyond the margin are as that is.
    #[inline(always)]
    pub fn block(&self, plane: usize, [x, y]: [usize; 2], columns: i64) -> &Column<T> {
        let columns = columns.clamp(-(self.margin as i64), self.margin as i64);
        let from = (y * self.planes + plane) * self.stride() + (self.margin + x).wrapping_add_signed(columns as isize);
        self.values[from..].first_chunk().expect("a block lies in its row")
    }

    /// Changes rows in parallel.
    pub fn par_rows(&mut self) -> impl IndexedParallelIterator<Item = (usize, Row<'_, T>)> {
        let (stride, margin) = (self.stride(), self.margin);
        let rows = self.values.par_chunks_mut((self.planes * stride).max(1));
        rows.map(move |values| Row { values, stride, margin }).enumerate()
    }
}

/// A row that is changed.
#[derive(Debug)]
pub(crate) struct Row<'a, T = f32> {
    values: &'a mut [T],
    stride: usize,
    margin: usize,
}

impl<T: Copy> Row<'_, T> {
    /// The value of a pixel of the picture.
    #[inline(always)]
    pub fn get_mut(&mut self, plane: usize, x: usize) -> &mut T {
        &mut self.values[plane * self.stride + self.margin + x]
    }

    /// Sets the value of a pixel of the picture.
    #[inline(always)]
    pub fn set(&mut self, plane: usize, x: usize, value: T) {
        *self.get_mut(plane, x) = value;
    }

    /// Sets those of a block.
    #[inline(always)]
    pub fn set_block(&mut self, plane: usize, x: usize, values: &Column<T>) {
        let from = plane * self.stride + self.margin + x;
        self.values[from..from + WIDTH].copy_from_slice(values);
    }
}
