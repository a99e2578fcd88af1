//! Potentially visible sets: for each cell all cells that may be seen from somewhere in it.
//!
//! A cell is seen from another where a line passes a sequence of portals (Teller, Séquin 1991). Portals lie along the
//! axes, so that a line that stabs them all does so in the three projections along the axes, too. For lines that rise
//! in a projection, the slopes of those that stab a sequence of rectangles are an interval: each pair of an upper left
//! and a lower right corner bounds it. Sequences without slopes in one projection, or with slopes in the three whose
//! product cannot be 1, have no line. Lines that exist are always found; some that do not are, too.

use super::{cells::Cells, walls::Block};
use rayon::prelude::*;
use steradian_math::DVec3;

/// Most sequences that reach a cell; more are joined, by the side on which they enter.
const MAX_BEAMS: usize = 12;

/// Relative margin of slopes, for rounding.
const MARGIN: f64 = 1e-9;

/// Lines that start in a cell and pass portals, in a frame in which they descend along no axis.
#[derive(Clone, Debug)]
struct Beam {
    /// The cell, and the portals.
    passed: Vec<Block>,
    /// Least and largest slope along the next axis over each axis.
    slopes: [[f64; 2]; 3],
}

impl Beam {
    fn new(cell: Block) -> Self {
        Self { passed: vec![cell], slopes: [[0.0, f64::INFINITY]; 3] }
    }

    /// Lines of it through one more rectangle; `None` where there are none.
    fn through(&self, block: &Block) -> Option<Self> {
        let mut slopes = self.slopes;
        for passed in &self.passed {
            for (upper, lower) in [(passed, block), (block, passed)] {
                for (a, bounds) in slopes.iter_mut().enumerate() {
                    let b = (a + 1) % 3;
                    let (run, rise) = (upper.min[a] - lower.max[a], upper.max[b] - lower.min[b]);
                    if run > 0.0 {
                        bounds[1] = bounds[1].min(rise / run);
                    } else if run < 0.0 {
                        bounds[0] = bounds[0].max(rise / run);
                    } else if rise < 0.0 {
                        bounds[0] = f64::INFINITY;
                    }
                }
            }
        }
        let [least, largest] = [0, 1].map(|end| slopes.iter().map(|bounds| bounds[end]).product::<f64>());
        let is_some = slopes.iter().all(|[low, high]| *low <= high * (1.0 + MARGIN));
        // Zero times infinity tells nothing.
        let misses_one = least > 1.0 + MARGIN || largest < 1.0 - MARGIN;
        let passed = || self.passed.iter().copied().chain([*block]).collect();
        (is_some && !misses_one).then(|| Self { passed: passed(), slopes })
    }

    /// Lines of both, and more.
    fn joined(&self, other: &Self) -> Self {
        let ends = |beam: &Self| beam.passed.last().copied();
        let last = ends(self).zip(ends(other)).map(|(a, b)| a.joined(&b));
        let slopes = |a: usize| {
            let ([low, high], [least, largest]) = (self.slopes[a], other.slopes[a]);
            [low.min(least), high.max(largest)]
        };
        let passed = self.passed.first().copied().into_iter().chain(last).collect();
        Self { passed, slopes: [0, 1, 2].map(slopes) }
    }
}

/// Which cells (second) may be seen from which (first).
pub fn visible_sets(cells: &Cells) -> Vec<Vec<bool>> {
    let seen: Vec<Vec<bool>> = (0..cells.cells.len()).into_par_iter().map(|from| seen_from(cells, from)).collect();
    // Lines have no direction, so that what is found from both sides remains.
    let both = |from: usize| (0..seen.len()).map(|to| seen[from][to] && seen[to][from]).collect();
    (0..seen.len()).map(both).collect()
}

fn seen_from(cells: &Cells, from: usize) -> Vec<bool> {
    let mut seen = vec![false; cells.cells.len()];
    // Lines of one octant of directions meet cells in one order, wherever they start.
    for octant in 0..8_usize {
        let signs = [0, 1, 2].map(|axis| if octant >> axis & 1 == 0 { 1.0 } else { -1.0 });
        let signs = DVec3::from(signs);
        let turned = |block: &Block| {
            let (a, b) = (block.min * signs, block.max * signs);
            Block { min: a.min(b), max: a.max(b) }
        };
        let mut beams: Vec<Vec<(usize, Beam)>> = vec![Vec::new(); cells.cells.len()];
        beams[from].push((0, Beam::new(turned(&cells.cells[from]))));
        for cell in cells.order((-signs).extend(0.0)) {
            let mut here = std::mem::take(&mut beams[cell]);
            seen[cell] |= !here.is_empty();
            if here.len() > MAX_BEAMS {
                let of_side = |side: usize| {
                    let those = here.iter().filter(|beam| beam.0 == side).map(|beam| beam.1.clone());
                    those.reduce(|a, b| a.joined(&b)).map(|beam| (side, beam))
                };
                here = (0..3).filter_map(of_side).collect();
            }
            for portal in cells.of_cell[cell].iter().map(|number| &cells.portals[*number]) {
                let forward = usize::from(signs[portal.axis] > 0.0);
                if portal.cells[forward] != cell {
                    let block = turned(&portal.block);
                    let through = here.iter().filter_map(|(_, beam)| Some((portal.axis, beam.through(&block)?)));
                    beams[portal.cells[forward]].extend(through);
                }
            }
        }
    }
    seen
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lines along no falling axis stab the rectangles that they pass, however little of these is beside them.
    #[test]
    fn beams_hold_their_lines() {
        for i in 0..2000_u32 {
            let turn = |k: u32, step: f64| (f64::from(i * 8 + k) * step).fract();
            let [origin, direction] = [0, 4].map(|k| DVec3::new(turn(k, 0.618), turn(k + 1, 0.755), turn(k + 2, 0.57)));
            let mut beam = Beam::new(Block { min: origin, max: origin }.grown(1e-7));
            for k in 1..8 {
                let (p, axis) = (origin + direction * f64::from(k), (i + k) as usize % 3);
                // The line passes near one corner.
                let (mut min, mut max) = (p - 1e-7, p + 1e-7);
                if turn(k, 0.339) < 0.5 {
                    min -= 1.0
                } else {
                    max += 1.0
                }
                (min[axis], max[axis]) = (p[axis], p[axis]);
                beam = beam.through(&Block { min, max }).expect("the line stabs it");
            }
            // Elsewhere, where no line of the thin beam is, there is none.
            let first = origin + direction;
            let thin = Beam::new(beam.passed[0]).through(&Block { min: first, max: first }).expect("one point");
            let beside = origin + direction * 2.0 + DVec3::new(0.0, 0.1, 0.0);
            assert!(thin.through(&Block { min: beside, max: beside }).is_none(), "{direction}");
        }
    }
}
