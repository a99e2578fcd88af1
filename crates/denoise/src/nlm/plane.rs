//! Numbers of pixels in rows that go on beyond the picture.

/// A number of each pixel, row by row. Rows are continued to the left and right by a margin.
#[derive(Clone, Debug)]
pub(super) struct Plane {
    width: usize,
    height: usize,
    margin: usize,
    values: Vec<f32>,
}

impl Plane {
    /// Of the values of pixels; those beyond the edge are that of the pixel at the edge.
    pub fn new([width, height]: [usize; 2], margin: usize, value: impl Fn(usize) -> f32) -> Self {
        let columns = -(margin as i64)..(width + margin) as i64;
        let columns: Vec<usize> = columns.map(|x| x.clamp(0, width as i64 - 1) as usize).collect();
        let values = (0..height).flat_map(|y| columns.iter().map(move |x| y * width + x)).map(value).collect();
        Self { width, height, margin, values }
    }

    /// With another value beyond the edge.
    pub fn with_edge(mut self, edge: f32) -> Self {
        let (margin, width) = (self.margin, self.width);
        for row in self.values.chunks_exact_mut(width + 2 * margin) {
            row[..margin].fill(edge);
            row[margin + width..].fill(edge);
        }
        self
    }

    /// `count` values of a row, from a column; rows beyond the edge are that at the edge.
    #[inline(always)]
    pub fn row(&self, y: i64, x: i64, count: usize) -> &[f32] {
        let y = y.clamp(0, self.height as i64 - 1) as usize;
        let from = (y * (self.width + 2 * self.margin) + self.margin).wrapping_add_signed(x as isize);
        &self.values[from..from + count]
    }
}
