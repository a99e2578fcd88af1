//! Cells of its box in which an expression may be zero: a grid, found by halving the box, so that rays skip empty
//! space.

use glam::DVec3;
use steradian_math::expression::{Expression, Interval};

/// Halvings of the box along each axis, and cells there are then.
const LEVELS: u32 = 5;
const COUNT: usize = 1 << LEVELS;
/// By how much cells overlap, as a part of one: the rounding of where a ray crosses from one to the next.
const OVERLAP: f64 = 1e-4;

/// The cells that the surface may go through.
#[derive(Clone, Debug)]
pub(super) struct Cells {
    low: DVec3,
    /// Size of a cell.
    size: DVec3,
    /// A bit for each cell along x, by y and z.
    rows: Box<[u32; COUNT * COUNT]>,
}

impl Cells {
    /// Cells of an expression in the box between two corners.
    pub fn new(e: &Expression<3>, [low, high]: [DVec3; 2]) -> Self {
        let size = (high - low) / COUNT as f64;
        let mut cells = Self { low, size, rows: Box::new([0; COUNT * COUNT]) };
        cells.mark(e, [0; 3], COUNT);
        cells
    }

    /// Marks what of a block of cells may have a zero.
    fn mark(&mut self, e: &Expression<3>, at: [usize; 3], width: usize) {
        let range: [Interval; 3] = std::array::from_fn(|k| {
            let edge = |cell: f64| self.low[k] + self.size[k] * cell;
            Interval::new(edge(at[k] as f64 - OVERLAP), edge((at[k] + width) as f64 + OVERLAP))
        });
        let value = e.value(range);
        if value.is_none() || !value.has_zero() {
            return;
        }
        if width == 1 {
            self.rows[at[2] * COUNT + at[1]] |= 1 << at[0];
            return;
        }
        let half = width / 2;
        for corner in 0..8 {
            self.mark(e, std::array::from_fn(|k| at[k] + (corner >> k & 1) * half), half);
        }
    }

    fn is_marked(&self, [x, y, z]: [i64; 3]) -> bool {
        self.rows[z as usize * COUNT + y as usize] >> x & 1 == 1
    }

    /// Calls back with the stretches of `o + s d`, `s` in `[0, end]`, that are in marked cells, in order, until one
    /// gives something.
    pub fn walk<R>(&self, [o, d]: [DVec3; 2], end: f64, mut visit: impl FnMut([f64; 2]) -> Option<R>) -> Option<R> {
        let last = COUNT as i64 - 1;
        // Where a box has no width, all is in its first cells.
        let place = (o - self.low) / self.size;
        let mut cell: [i64; 3] = std::array::from_fn(|k| (place[k].floor() as i64).clamp(0, last));
        let step: [i64; 3] = std::array::from_fn(|k| if d[k] < 0.0 { -1 } else { 1 });
        let border = |cell: i64, k: usize| {
            let edge = self.low[k] + self.size[k] * (cell + i64::from(step[k] > 0)) as f64;
            // No border is ahead where the ray does not move, or where it is in the last cell.
            let is_last = cell == if step[k] > 0 { last } else { 0 };
            if is_last || d[k] == 0.0 { f64::INFINITY } else { (edge - o[k]) / d[k] }
        };
        let mut next: [f64; 3] = std::array::from_fn(|k| border(cell[k], k));
        let (mut at, mut begun) = (0.0_f64, None);
        loop {
            let axis = (0..3).min_by(|a, b| next[*a].total_cmp(&next[*b])).unwrap_or(0);
            let until = next[axis].min(end).max(at);
            match (begun, self.is_marked(cell)) {
                (None, true) => begun = Some(at),
                (Some(from), false) => {
                    begun = None;
                    let found = visit([from, at]);
                    if found.is_some() {
                        return found;
                    }
                }
                _ => {}
            }
            at = until;
            if at >= end {
                return begun.and_then(|from| visit([from, end]));
            }
            cell[axis] += step[axis];
            next[axis] = border(cell[axis], axis);
        }
    }

    /// Bytes held beyond its own.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.rows)
    }
}
