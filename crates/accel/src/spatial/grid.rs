//! The uniform grid, walked by a three-dimensional digital differential analyser (Amanatides and Woo, "A Fast Voxel
//! Traversal Algorithm for Ray Tracing", Eurographics 1987). Bresenham's lines, which are sometimes named here, skip
//! cells.
//!
//! There are at most [`CELLS_PER_ITEM`] cells for each primitive and [`LISTED_PER_ITEM`] entries in their lists; a grid
//! that would have more is made coarser.

use super::items::Items;
use super::line::{Line, is_beyond, padded};
use super::lists::Lists;
use super::overlap::overlaps;
use super::search::Visitor;
use steradian_math::DVec3;

/// Cells for each primitive, about (the density of Jevans and Wyvill, "Adaptive Voxel Subdivision for Ray Tracing",
/// 1989, and later practice: 3 to 8).
const CELLS_PER_ITEM: f64 = 5.0;
/// Most entries in lists for each primitive.
const LISTED_PER_ITEM: u64 = 24;
/// Most cells on an axis.
const MOST_ON_AXIS: f64 = 2048.0;

/// A grid.
#[derive(Clone, Debug)]
pub(super) struct Grid {
    min: DVec3,
    /// Size of a cell.
    cell: DVec3,
    /// Cells on each axis.
    counts: [u32; 3],
    lists: Lists,
}

impl Grid {
    /// Sorts the primitives into cells.
    pub fn build(items: &Items) -> Self {
        let bounds = items.padded_bounds();
        let mut wanted = CELLS_PER_ITEM * items.list.len() as f64;
        loop {
            let grid = Self::empty(bounds, items.list.len(), wanted);
            // Count the entries that this resolution would need, and halve the number of cells while they are too many.
            let listed = items.list.iter().map(|item| {
                let b = item.bounds();
                let [low, high] = padded(b.min, b.max, items.padding()).map(|p| grid.cell_at(p));
                (0..3).map(|axis| u64::from(high[axis] - low[axis] + 1)).product::<u64>()
            });
            // Bound the memory whatever the scene: large primitives would be listed in most cells of a fine grid.
            let most = (LISTED_PER_ITEM * items.list.len() as u64 + 1024).min(1 << 31);
            if grid.counts == [1; 3] || listed.sum::<u64>() <= most {
                return grid.filled(items);
            }
            wanted /= 2.0;
        }
    }

    /// A grid of about so many cells, near cubes, and no more than one for an axis without extent.
    fn empty([min, max]: [DVec3; 2], items: usize, wanted: f64) -> Self {
        if items == 0 {
            let lists = Lists::from_pairs(1, &[]);
            return Self { min: DVec3::ZERO, cell: DVec3::ONE, counts: [1; 3], lists };
        }
        let extent = max - min;
        // Flat axes have one cell; the others share the cells.
        let mut counts = [1_u32; 3];
        let mut is_flat = [false; 3];
        // Cell size s = (V/N)^(1/k) for k axes with extent; an axis shorter than that gets one cell, and the size is
        // found anew.
        for _ in 0..3 {
            let open: Vec<usize> = (0..3).filter(|&axis| !is_flat[axis]).collect();
            let volume: f64 = open.iter().map(|&axis| extent[axis]).product();
            let size = (volume / wanted.max(1.0)).powf(1.0 / open.len().max(1) as f64);
            let mut changed = false;
            for &axis in &open {
                counts[axis] = (extent[axis] / size).clamp(1.0, MOST_ON_AXIS) as u32;
                let is_long = extent[axis] >= size;
                if !is_long {
                    (is_flat[axis], changed) = (true, true);
                }
            }
            if !changed {
                break;
            }
        }
        let cell = extent / DVec3::new(f64::from(counts[0]), f64::from(counts[1]), f64::from(counts[2]));
        Self { min, cell, counts, lists: Lists::default() }
    }

    /// The grid with its lists.
    fn filled(mut self, items: &Items) -> Self {
        let padding = items.padding();
        let mut pairs = Vec::new();
        for (slot, item) in items.list.iter().enumerate() {
            let b = item.bounds();
            let [low, high] = padded(b.min, b.max, padding).map(|p| self.cell_at(p));
            let is_one = low == high;
            for z in low[2]..=high[2] {
                for y in low[1]..=high[1] {
                    for x in low[0]..=high[0] {
                        // List a primitive only in cells that it really overlaps, not in all that its box does.
                        let [min, max] = [[x, y, z], [x + 1, y + 1, z + 1]].map(|c| self.corner(c));
                        if is_one || overlaps(item, [min - padding, max + padding]) {
                            pairs.push((self.index([x, y, z]), slot as u32));
                        }
                    }
                }
            }
        }
        let cells = self.counts.iter().map(|&n| n as usize).product();
        self.lists = Lists::from_pairs(cells, &pairs);
        self
    }

    /// The cell of a point; of points outside, the nearest one.
    #[inline]
    fn cell_at(&self, p: DVec3) -> [u32; 3] {
        std::array::from_fn(|axis| {
            let cell = ((p[axis] - self.min[axis]) / self.cell[axis]).floor();
            cell.clamp(0.0, f64::from(self.counts[axis] - 1)) as u32
        })
    }

    /// The lowest corner of a cell.
    #[inline]
    fn corner(&self, cell: [u32; 3]) -> DVec3 {
        self.min + self.cell * DVec3::new(f64::from(cell[0]), f64::from(cell[1]), f64::from(cell[2]))
    }

    #[inline]
    fn index(&self, [x, y, z]: [u32; 3]) -> u32 {
        (z * self.counts[1] + y) * self.counts[0] + x
    }

    /// Visits the cells along a line in order, each once.
    pub fn walk(&self, line: &Line, visitor: &mut impl Visitor) {
        if line.reach > 0.0 {
            return self.walk_slices(line, visitor);
        }
        // Start in the cell of the entry point.
        let mut cell = self.cell_at(line.at(line.t[0]));
        // Where the line leaves the cell on each axis.
        let leave = |axis: usize, cell: u32| {
            let d = line.direction[axis];
            if d == 0.0 {
                return f64::INFINITY;
            }
            let plane = self.min[axis] + self.cell[axis] * f64::from(cell + u32::from(d > 0.0));
            (plane - line.origin[axis]) * line.inverse[axis]
        };
        // Only the crossed axis needs a new distance at each step.
        let mut next = [0, 1, 2].map(|axis| leave(axis, cell[axis]));
        loop {
            visitor.step();
            if visitor.visit(self.lists.get(self.index(cell))) {
                return;
            }
            // Step across the nearest of the three planes (Amanatides and Woo 1987).
            let axis = match (next[0] <= next[1], next[0] <= next[2], next[1] <= next[2]) {
                (true, true, _) => 0,
                (false, _, true) => 1,
                _ => 2,
            };
            let entry = next[axis];
            // The next cell begins behind the ray's end or behind the hit: nothing there can be nearer.
            if entry > line.t[1] || is_beyond(entry, visitor.t_max()) {
                return;
            }
            // Leave the grid through an outer face, or enter the neighbour and find where its slab ends.
            let is_up = line.direction[axis] > 0.0;
            if cell[axis] == if is_up { self.counts[axis] - 1 } else { 0 } {
                return;
            }
            cell[axis] = if is_up { cell[axis] + 1 } else { cell[axis] - 1 };
            next[axis] = leave(axis, cell[axis]);
        }
    }

    /// Visits the cells within the line's reach, slice by slice on the axis where it moves most.
    fn walk_slices(&self, line: &Line, visitor: &mut impl Visitor) {
        let d = (line.direction / self.cell).abs();
        let axis = if d.x >= d.y && d.x >= d.z {
            0
        } else if d.y >= d.z {
            1
        } else {
            2
        };
        let is_up = line.direction[axis] > 0.0;
        // Visit slices front to back; each is bounded by two planes widened by the reach.
        for i in 0..self.counts[axis] {
            let slice = if is_up { i } else { self.counts[axis] - 1 - i };
            let low = self.min[axis] + self.cell[axis] * f64::from(slice);
            let planes = [low - line.reach, low + self.cell[axis] + line.reach];
            let [a, b] = planes.map(|p| (p - line.origin[axis]) * line.inverse[axis]);
            let (t0, t1) = (a.min(b).max(line.t[0]), a.max(b).min(line.t[1]));
            if t0 > t1 {
                continue;
            }
            if is_beyond(t0, visitor.t_max()) {
                return;
            }
            // All cells that the widened line may touch in the slice, as a rectangle.
            let (p, q) = (line.at(t0), line.at(t1));
            let [mut from, mut to] = [p.min(q) - line.reach, p.max(q) + line.reach].map(|p| self.cell_at(p));
            (from[axis], to[axis]) = (slice, slice);
            for z in from[2]..=to[2] {
                for y in from[1]..=to[1] {
                    for x in from[0]..=to[0] {
                        visitor.step();
                        if visitor.visit(self.lists.get(self.index([x, y, z]))) {
                            return;
                        }
                    }
                }
            }
        }
    }

    /// The cell of a point.
    pub fn leaf(&self, p: DVec3) -> u32 {
        self.index(self.cell_at(p))
    }

    /// The boxes of the cells that list something; the box of the grid at level 0.
    pub fn boxes(&self, level: u32) -> Vec<[DVec3; 2]> {
        if level == 0 {
            return vec![[self.min, self.corner(self.counts)]];
        }
        let [nx, ny, nz] = self.counts;
        let cells = (0..nz).flat_map(|z| (0..ny).flat_map(move |y| (0..nx).map(move |x| [x, y, z])));
        let listed = cells.filter(|&cell| !self.lists.get(self.index(cell)).is_empty());
        listed.map(|cell| [self.corner(cell), self.corner(cell.map(|x| x + 1))]).collect()
    }

    /// Memory in bytes.
    pub fn bytes(&self) -> usize {
        self.lists.bytes() + size_of::<Self>()
    }

    /// True if a cell lists a slot and its box has a property.
    #[cfg(test)]
    pub fn holds(&self, slot: u32, cell: u32, is_in: impl Fn(steradian_math::Bounds3) -> bool) -> bool {
        let [nx, ny, _] = self.counts;
        let at = [cell % nx, cell / nx % ny, cell / nx / ny];
        let [min, max] = [at, at.map(|x| x + 1)].map(|c| self.corner(c).as_vec3());
        self.lists.get(cell).contains(&slot) && is_in(steradian_math::Bounds3 { min, max })
    }

    /// Cells, and entries in their lists.
    #[cfg(test)]
    pub fn sizes(&self) -> (u64, usize) {
        (self.counts.iter().map(|&n| u64::from(n)).product(), self.lists.len())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spatial::testing;
    use std::collections::HashSet;
    use steradian_math::Vec3;

    /// Remembers what it is shown.
    struct Trace(Vec<u32>);

    impl Visitor for Trace {
        fn step(&mut self) {}
        fn visit(&mut self, slots: &[u32]) -> bool {
            // Every cell lists itself.
            self.0.extend_from_slice(slots);
            false
        }
        fn t_max(&self) -> f32 {
            f32::INFINITY
        }
    }

    /// A grid of cells of odd sizes in which each cell lists its own number.
    fn numbered() -> Grid {
        let counts = [7, 5, 9];
        let pairs: Vec<_> = (0..7 * 5 * 9).map(|i| (i, i)).collect();
        Grid {
            min: DVec3::new(-1.0, 0.5, 2.0),
            cell: DVec3::new(0.3, 0.7, 0.11),
            counts,
            lists: Lists::from_pairs(pairs.len(), &pairs),
        }
    }

    #[test]
    fn each_cell_on_the_line_is_visited_once_and_in_order() {
        let grid = numbered();
        let bounds = [grid.min, grid.corner(grid.counts)];
        let center = ((bounds[0] + bounds[1]) * 0.5).as_vec3();
        let mut visited = 0;
        for ray in testing::assorted_rays(center, 1.2, 4000, 81) {
            // The cells by their boxes alone, in the order of entry. Those that are only touched may be visited or not.
            let Some(line) = Line::new(&ray, bounds, 1.0) else { continue };
            let mut crossed: Vec<(f64, u32, bool)> = Vec::new();
            for z in 0..9 {
                for y in 0..5 {
                    for x in 0..7 {
                        let [min, max] = [[x, y, z], [x + 1, y + 1, z + 1]].map(|c| grid.corner(c));
                        if let Some([a, b]) = line.clip([min - 1e-9, max + 1e-9], line.t) {
                            let is_inside = line.clip([min + 1e-9, max - 1e-9], line.t).is_some();
                            crossed.push(((a + b) * 0.5, grid.index([x, y, z]), is_inside));
                        }
                    }
                }
            }
            crossed.sort_by(|a, b| a.0.total_cmp(&b.0));
            let mut trace = Trace(Vec::new());
            grid.walk(&line, &mut trace);
            let once: HashSet<u32> = trace.0.iter().copied().collect();
            assert_eq!(once.len(), trace.0.len(), "{ray:?} visits a cell twice");
            let expected: Vec<u32> = crossed.iter().filter(|c| c.2).map(|c| c.1).collect();
            let walked: Vec<u32> = trace.0.iter().copied().filter(|c| expected.contains(c)).collect();
            assert_eq!(walked, expected, "{ray:?}");
            let touched: HashSet<u32> = crossed.iter().map(|c| c.1).collect();
            assert!(once.is_subset(&touched), "{ray:?} strays");
            visited += expected.len();

            // With a reach it visits more.
            let mut wide = Trace(Vec::new());
            grid.walk(&Line { reach: 1e-6, ..line }, &mut wide);
            let wide: HashSet<u32> = wide.0.into_iter().collect();
            assert!(once.is_subset(&wide) && expected.iter().all(|c| wide.contains(c)), "{ray:?}");
        }
        assert!(visited > 4000, "{visited}");
    }

    #[test]
    fn the_caps_hold() {
        // Large triangles that fill every cell, and a flat mesh.
        let big = testing::soup(3000, 2.0, 82);
        let mut flat = testing::soup(3000, 0.05, 83);
        for p in &mut flat.0 {
            *p *= Vec3::new(1.0, 0.0, 1.0);
        }
        let small = testing::soup(3000, 0.02, 84);
        for (mesh, least) in [(big, 1), (flat, 3000), (small, 5000)] {
            let items = testing::items(&mesh);
            let (cells, listed) = Grid::build(&items).sizes();
            let n = items.list.len();
            assert!(cells as f64 <= 2.0 * CELLS_PER_ITEM * n as f64 && cells >= least, "{cells} cells");
            assert!(listed as u64 <= LISTED_PER_ITEM * n as u64 + 1024, "{listed} entries");
        }
    }
}
