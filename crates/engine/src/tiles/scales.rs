//! The error of means over pixels. Pixels that share paths err alike, so the variance of a pixel does not tell that of
//! a mean over several.
//!
//! In some tiles samples of even ticks are summed apart. Half the difference of the means `A` of these and `B` of the
//! others errs as their mean does, whatever the pixels have in common and however well samples are spread, so with `a`
//! and `b` samples the mean over a square has the squared error `(A − B)² ab/(a + b)²`, in the mean over squares.

use super::{Frame, lock};
use crate::{estimate::relative_of, partition::TILE};

/// Edges of the squares, pixels.
pub const SCALES: [u32; 4] = [1, 4, 8, TILE];

/// Most tiles that are looked at.
const TILES: usize = 1024;

/// Sum over a part of a pixel's samples, those of even number or ticks.
#[derive(Clone, Copy, Debug, Default)]
pub struct Even {
    pub sum: [f64; 3],
    pub samples: u32,
}

impl Even {
    /// Adds a sample, as the film does.
    pub fn add(&mut self, value: steradian_math::Vec3) {
        self.samples += 1;
        if value.is_finite() {
            (0..3).for_each(|c| self.sum[c] += f64::from(value[c]));
        }
    }
}

impl Frame {
    /// Begins to sum samples apart in tiles here and there.
    pub(super) fn watch_scales(&mut self) {
        let whole = |area: &steradian_core::film::Crop| area.width() == TILE && area.height() == TILE;
        let whole: Vec<usize> = (0..self.tiles.len()).filter(|t| whole(&lock(&self.tiles[*t]).area)).collect();
        let every = whole.len().div_ceil(TILES).max(1);
        for tile in whole.into_iter().step_by(every) {
            let mut tile = lock(&self.tiles[tile]);
            // Not of tiles that are computed elsewhere.
            let is_here = !tile.pixels.is_empty();
            tile.even = vec![Even::default(); if is_here { (TILE * TILE) as usize } else { 0 }];
        }
    }

    /// The estimated relative error of means over squares of pixels with the edges [`SCALES`], of which the first is
    /// the error of pixels, by samples of the first round: the root of the mean of squared errors over `I² + 0.01` of
    /// the square. `None` before there are two samples, and where no tile lies in the picture as a whole.
    pub(super) fn errors_of_means(&self) -> Option<[f64; SCALES.len()]> {
        if self.round.number > 0 {
            return self.errors_of_first_round;
        }
        let (mut sums, mut count) = ([0.0; SCALES.len()], 0_u32);
        for tile in &self.tiles {
            let tile = lock(tile);
            if tile.even.is_empty() {
                continue;
            }
            for (sum, edge) in sums.iter_mut().zip(SCALES).skip(1) {
                let of = TILE / edge;
                let mut places = Vec::with_capacity((of * of) as usize);
                for square in 0..of * of {
                    let (mut level, mut error) = ([0.0; 3], [0.0; 3]);
                    for pixel in 0..edge * edge {
                        let (x, y) = (square % of * edge + pixel % edge, square / of * edge + pixel / edge);
                        let at = (y * TILE + x) as usize;
                        let (all, even) = (&tile.pixels[at], &tile.even[at]);
                        let (a, n) = (f64::from(even.samples), f64::from(all.samples));
                        if even.samples == 0 || even.samples == all.samples {
                            return None;
                        }
                        for c in 0..3 {
                            let odd = (all.sum[c] - even.sum[c]) / (n - a);
                            error[c] += (even.sum[c] / a - odd) * (a * (n - a)).sqrt() / n;
                            level[c] += all.sum[c] / n;
                        }
                    }
                    let n = f64::from(edge * edge);
                    places.push((error.map(|e| (e / n).powi(2)), level.map(|l| l / n)));
                }
                *sum += relative_of(&places) / f64::from(3 * of * of);
            }
            count += 1;
        }
        let mut errors = sums.map(|s| (s / f64::from(count.max(1))).sqrt());
        // Halves of a pixel's samples may be those of halves of the pixel: at edges they differ by more than they err.
        errors[0] = self.error()?;
        (count > 0).then_some(errors)
    }
}
