//! A tile of the film: sums of the pixels over the round under way, and what the rounds before it came to.

use super::{Plan, scales::Even, work::RAYS};
use crate::{
    adaptive::{FLOOR, Need, Round},
    partition::{CELLS, cell_of},
};
use steradian_core::film::{Crop, Half, LayerInputs, LayerSums, Pixel};
use steradian_math::Vec3;

/// A square of a tile that gets a number of samples of its own.
#[derive(Clone, Copy, Debug, Default)]
pub struct Cell {
    /// Samples that its pixels get in the round under way.
    pub target: u32,
    /// Rays traced for them, in all rounds, in parts of one; and samples of all of them.
    pub rays: u64,
    /// Samples over its pixels.
    pub samples: u64,
    /// Relative variance of samples, summed over rounds by degrees of freedom.
    pub(super) variance: f64,
    pub(super) freedom: f64,
}

/// Relative variance of samples in a cell, estimated by a round in two ways.
#[derive(Clone, Copy, Debug, Default)]
struct Noise {
    /// By how samples of a pixel differ, summed over pixels: too much where samplers spread them well.
    samples: f64,
    /// By how pixels differ from their neighbours: too much where the picture has detail.
    bends: f64,
    /// Number of neighbourhoods that were looked at.
    count: u32,
}

impl Noise {
    /// The lesser of both.
    fn variance(self, pixels: u32) -> f64 {
        let samples = self.samples / f64::from(pixels.max(1));
        if self.count > 0 { samples.min(self.bends / f64::from(self.count)) } else { samples }
    }
}

/// The sums over a rectangle of pixels.
#[derive(Debug)]
pub struct Tile {
    /// Rectangle of pixels.
    pub area: Crop,
    /// The round under way.
    pub pixels: Vec<Pixel>,
    /// The rounds before it; empty in the first.
    pub(super) past: Vec<Pixel>,
    /// Sums of even ticks of the first round, by which the error of means over pixels is told; empty where it is not
    /// ([`super::scales`]).
    pub(super) even: Vec<Even>,
    /// Sums of layers, of all rounds.
    pub layers: LayerSums,
    /// Samples of even number in the round under way, and the halves of the rounds before it, which are empty in the
    /// first; both are empty where halves are not kept.
    pub(super) halves: Vec<Even>,
    pub(super) past_halves: Vec<Half>,
    /// By rows.
    pub cells: [Cell; (CELLS * CELLS) as usize],
}

impl Tile {
    /// Without samples, of light in so many parts and bands; each pixel shall get `target` in the first round.
    pub fn new(area: Crop, plan: &Plan, [parts, bands]: [usize; 2], target: u32) -> Self {
        let n = (area.width() * area.height()) as usize;
        Self {
            area,
            pixels: vec![Pixel::default(); n],
            past: Vec::new(),
            even: Vec::new(),
            layers: LayerSums::new(plan.inputs, n, parts, bands),
            halves: vec![Even::default(); if plan.has(LayerInputs::HALVES) { n } else { 0 }],
            past_halves: Vec::new(),
            cells: [Cell { target, ..Cell::default() }; (CELLS * CELLS) as usize],
        }
    }

    /// A tile that is computed elsewhere: without pixels, and as much to do for each as here.
    pub fn hollow(area: Crop, target: u32) -> Self {
        Self {
            area,
            pixels: Vec::new(),
            past: Vec::new(),
            even: Vec::new(),
            layers: LayerSums::default(),
            halves: Vec::new(),
            past_halves: Vec::new(),
            cells: [Cell { target, ..Cell::default() }; (CELLS * CELLS) as usize],
        }
    }

    /// True for what [`Self::hollow`] makes with this target.
    pub fn is_hollow(&self, target: u32) -> bool {
        let is_fresh = |cell: &Cell| cell.target == target && cell.rays == 0 && cell.samples == 0;
        self.pixels.is_empty() && self.cells.iter().all(is_fresh)
    }

    /// Adds a sample that was taken in a tick to a pixel of the round under way; `false` where it is not finite and
    /// counts as black.
    pub fn add(&mut self, at: usize, value: Vec3, tick: u32) -> bool {
        let number = self.pixels[at].samples;
        if let Some(even) = self.halves.get_mut(at).filter(|_| number.is_multiple_of(2)) {
            even.add(value);
        }
        let is_finite = self.pixels[at].add(value);
        if let Some(even) = self.even.get_mut(at).filter(|_| tick.is_multiple_of(2)) {
            even.add(value);
        }
        is_finite
    }

    /// The pixels with all that is known of them, by rows.
    pub fn film(&self, round: Round) -> impl Iterator<Item = Pixel> + '_ {
        self.pixels.iter().enumerate().map(move |(at, now)| match self.past.get(at) {
            None => *now,
            Some(past) => joined(past, now, self.weight(at, round)),
        })
    }

    /// The halves of all rounds, by rows; none where they are not kept.
    pub fn film_halves(&self, round: Round) -> impl Iterator<Item = Half> + '_ {
        self.halves.iter().zip(&self.pixels).enumerate().map(move |(at, (even, pixel))| {
            let now = Half::of(even.sum, even.samples, pixel);
            self.past_halves.get(at).map_or(now, |past| past.joined(&now, self.weight(at, round)))
        })
    }

    /// The weight of the round under way in a pixel, against those before it.
    fn weight(&self, at: usize, round: Round) -> f64 {
        round.weight(self.pixels[at].samples, self.cells[self.cell_at(at)].target)
    }

    /// The cell of the pixel that is stored at an index.
    pub(super) fn cell_at(&self, at: usize) -> usize {
        let (at, width) = (at as u32, self.area.width());
        cell_of(self.area.x0 + at % width, self.area.y0 + at / width)
    }

    /// Need of each cell after a round that is complete.
    pub fn needs(&mut self, round: Round) -> [Need; (CELLS * CELLS) as usize] {
        let joined: Vec<Pixel> = self.film(round).collect();
        let mut needs = [Need::default(); (CELLS * CELLS) as usize];
        let mut means = [0.0; (CELLS * CELLS) as usize];
        for (at, p) in joined.iter().enumerate() {
            let c = self.cell_at(at);
            needs[c].pixels += 1;
            means[c] += p.mean().iter().map(|m| m * m).sum::<f64>() / 3.0;
        }
        let mut found = [Noise::default(); (CELLS * CELLS) as usize];
        for (at, (now, all)) in self.pixels.iter().zip(&joined).enumerate() {
            let c = self.cell_at(at);
            let around = means[c] / f64::from(needs[c].pixels.max(1));
            let (v, m) = (now.variance_of_mean(), all.mean());
            // Half by the cell: the mean of a pixel that a rare bright sample hit is no measure of its level.
            let levels = m.map(|m| f64::from(now.samples) / (0.5 * (m * m + around) + FLOOR) / 3.0);
            found[c].samples += (0..3).map(|k| v[k] * levels[k]).sum::<f64>();
            for beside in [1, self.area.width() as usize] {
                let Some(bends) = self.bends(at, beside) else { continue };
                found[c].bends += (0..3).map(|k| bends[k] * levels[k]).sum::<f64>();
                found[c].count += 1;
            }
        }
        for ((cell, need), found) in self.cells.iter_mut().zip(&mut needs).zip(found) {
            let freedom = if need.pixels > 0 { f64::from(cell.target.saturating_sub(1)) } else { 0.0 };
            cell.variance += found.variance(need.pixels) * freedom;
            cell.freedom += freedom;
            let variance = if cell.freedom > 0.0 { cell.variance / cell.freedom } else { 0.0 };
            need.variance = if variance.is_finite() { variance } else { f64::MAX };
            need.rays = cell.rays as f64 / (RAYS * cell.samples.max(1)) as f64;
        }
        needs
    }

    /// Ends a round that is complete: it becomes part of the past.
    pub fn close(&mut self, round: Round) {
        self.past_halves = self.film_halves(round).collect();
        self.past = self.film(round).collect();
        self.even = Vec::new();
        self.pixels.fill(Pixel::default());
        self.halves.fill(Even::default());
    }

    /// The square by which a pixel's mean leaves the line between its neighbours to both sides, if they lie in its
    /// cell: that of independent errors, on a smooth surface.
    fn bends(&self, at: usize, beside: usize) -> Option<[f64; 3]> {
        let (a, b) = (at.checked_sub(beside)?, at + beside);
        let (c, width) = (self.cell_at(at), self.area.width() as usize);
        let is_in_line = beside == width || a / width == b / width;
        if !is_in_line || b >= self.pixels.len() || self.cell_at(a) != c || self.cell_at(b) != c {
            return None;
        }
        let [before, here, after] = [a, at, b].map(|i| self.pixels[i].mean());
        Some(std::array::from_fn(|k| (before[k] - 2.0 * here[k] + after[k]).powi(2) / 6.0))
    }

    /// The pixels of each cell, with all that is known of them.
    pub fn by_cells(&self, round: Round) -> Vec<Vec<Pixel>> {
        let mut cells = vec![Vec::new(); (CELLS * CELLS) as usize];
        for (at, pixel) in self.film(round).enumerate() {
            cells[self.cell_at(at)].push(pixel);
        }
        cells
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
