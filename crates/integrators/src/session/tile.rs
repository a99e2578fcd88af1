//! A tile of the film: sums of the pixels over the round under way, and what the rounds before it came to.

use crate::adaptive::{CELL, FLOOR, Need, Round};
use crate::partition::TILE;
use steradian_core::film::{Crop, FirstHitSums, Pixel};

/// Cells along the edge of a tile.
pub const CELLS: u32 = TILE / CELL;

/// A square of a tile that gets a number of samples of its own.
#[derive(Clone, Copy, Debug, Default)]
pub struct Cell {
    /// Samples that its pixels have of the round under way.
    pub done: u32,
    /// Samples that they get in it.
    pub target: u32,
    /// Rays traced for them, in all rounds, and samples of all of them.
    pub rays: u64,
    /// Samples over its pixels.
    pub samples: u64,
    /// Relative variance of samples, summed over rounds by degrees of freedom.
    variance: f64,
    freedom: f64,
}

/// The sums over a rectangle of pixels.
#[derive(Debug)]
pub struct Tile {
    /// Where it is.
    pub area: Crop,
    /// The round under way.
    pub pixels: Vec<Pixel>,
    /// The rounds before it; empty in the first.
    past: Vec<Pixel>,
    /// First hits, of all rounds.
    pub features: Vec<FirstHitSums>,
    /// By rows.
    pub cells: [Cell; (CELLS * CELLS) as usize],
}

/// The number of the cell in which a pixel of the frame lies.
pub fn cell_of(x: u32, y: u32) -> usize {
    (y % TILE / CELL * CELLS + x % TILE / CELL) as usize
}

impl Tile {
    /// Without samples; each pixel shall get `target` in the first round.
    pub fn new(area: Crop, features: bool, target: u32) -> Self {
        let n = (area.width() * area.height()) as usize;
        Self {
            area,
            pixels: vec![Pixel::default(); n],
            past: Vec::new(),
            features: if features { vec![FirstHitSums::default(); n] } else { Vec::new() },
            cells: [Cell { target, ..Cell::default() }; (CELLS * CELLS) as usize],
        }
    }

    /// The pixels with all that is known of them, by rows.
    pub fn film(&self, round: Round) -> impl Iterator<Item = Pixel> + '_ {
        self.pixels.iter().enumerate().map(move |(at, now)| match self.past.get(at) {
            None => *now,
            Some(past) => {
                let cell = &self.cells[self.cell_at(at)];
                joined(past, now, round.weight(cell.done, cell.target))
            }
        })
    }

    /// The cell of the pixel that is stored at an index.
    fn cell_at(&self, at: usize) -> usize {
        let (at, width) = (at as u32, self.area.width());
        cell_of(self.area.x0 + at % width, self.area.y0 + at / width)
    }

    /// Ends a round that is complete: it becomes part of the past. What each cell needs from now on.
    pub fn close(&mut self, round: Round) -> [Need; (CELLS * CELLS) as usize] {
        let joined: Vec<Pixel> = self.film(round).collect();
        let mut needs = [Need::default(); (CELLS * CELLS) as usize];
        let mut means = [0.0; (CELLS * CELLS) as usize];
        for (at, p) in joined.iter().enumerate() {
            let c = self.cell_at(at);
            needs[c].pixels += 1;
            means[c] += p.mean().iter().map(|m| m * m).sum::<f64>() / 3.0;
        }
        let mut found = [0.0; (CELLS * CELLS) as usize];
        for (at, (now, all)) in self.pixels.iter().zip(&joined).enumerate() {
            let c = self.cell_at(at);
            let around = means[c] / f64::from(needs[c].pixels.max(1));
            let (v, m) = (now.variance_of_mean(), all.mean());
            for k in 0..3 {
                // Half by the cell: the mean of a pixel that a rare bright sample hit is no measure of its level.
                let level = 0.5 * (m[k] * m[k] + around) + FLOOR;
                found[c] += v[k] * f64::from(now.samples) / level / 3.0;
            }
        }
        for ((cell, need), found) in self.cells.iter_mut().zip(&mut needs).zip(found) {
            let freedom = f64::from(cell.done.saturating_sub(1));
            cell.variance += found / f64::from(need.pixels.max(1)) * freedom;
            cell.freedom += freedom;
            let variance = if cell.freedom > 0.0 { cell.variance / cell.freedom } else { 0.0 };
            need.variance = if variance.is_finite() { variance } else { f64::MAX };
            need.rays = cell.rays as f64 / cell.samples.max(1) as f64;
            cell.done = 0;
        }
        self.past = joined;
        self.pixels.fill(Pixel::default());
        needs
    }

    /// Sum over pixels and channels of the estimated relative squared errors; `None` where a pixel has not the two samples that it takes.
    pub fn squared_errors(&self, round: Round) -> Option<f64> {
        self.film(round)
            .map(|p| {
                let (v, m) = (p.variance_of_mean(), p.mean());
                (p.samples >= 2).then(|| (0..3).map(|c| v[c] / (m[c] * m[c] + FLOOR)).sum::<f64>())
            })
            .sum()
    }
}

/// Two independent estimates of a pixel as one, the second with weight `a`.
fn joined(past: &Pixel, now: &Pixel, a: f64) -> Pixel {
    let (m, n, v, w) = (past.mean(), now.mean(), past.variance_of_mean(), now.variance_of_mean());
    let b = 1.0 - a;
    Pixel::of(
        std::array::from_fn(|c| b * m[c] + a * n[c]),
        std::array::from_fn(|c| b * b * v[c] + a * a * w[c]),
        past.samples + now.samples,
    )
}
