//! Variance estimation of pixels.

use rayon::prelude::*;
use steradian_accel::{Lanes, kernel};
use steradian_math::Vec2;

use super::{
    accumulate::Accumulated,
    estimates::{Estimates, PLANES, VARIANCE},
    geometry::{Geometry, Likeness},
    settings::Settings,
};
use crate::rows::{Column, Row, Rows, WIDTH};

/// Frames of a history that tell a variance by themselves.
const LONG_ENOUGH: u32 = 4;
/// Pixels on either side of one whose history is short that tell it too.
pub(super) const REACH: usize = 3;
/// All of them, along an axis.
const TAPS: usize = 2 * REACH + 1;

/// Fills in the variances of luminance: section 4.2. Of a short history over 7×7 pixels of the same surface, and larger
/// the shorter it is.
pub(super) fn variances(
    accumulated: &Rows<Accumulated>,
    estimates: &mut Estimates,
    geometry: &Geometry,
    (lanes, settings): (Lanes, &Settings),
) {
    let all = All { accumulated, geometry, settings };
    estimates.rows.par_rows().for_each(|(y, mut row)| variances_of_row(lanes, &all, y, &mut row));
}

fn of_moments(moments: Vec2) -> f32 {
    // Var = μ₂ − μ₁².
    (moments.y - moments.x * moments.x).max(0.0)
}

/// Inputs of the variance estimates.
struct All<'a> {
    accumulated: &'a Rows<Accumulated>,
    geometry: &'a Geometry,
    settings: &'a Settings,
}

kernel! {
    /// Variances of a row.
    fn variances_of_row(all: &'a All<'a>, y: usize, row: &'a mut Row<'a>) {
        // Whole blocks with long histories need no neighbours.
        for x in (0..all.accumulated.width()).step_by(WIDTH) {
            if all.temporal([x, y], row) {
                continue;
            }
            let weights = all.weights([x, y]);
            for term in 0..all.accumulated.planes() {
                all.spatial(term, [x, y], &weights, row);
            }
        }
    }
}

impl All<'_> {
    /// Sets variances over time, and tells whether all histories of a block are long enough for that.
    #[inline(always)]
    fn temporal(&self, [from, y]: [usize; 2], row: &mut Row<'_>) -> bool {
        let mut is_enough = true;
        for term in 0..self.accumulated.planes() {
            // Temporal variance from the accumulated moments (section 4.2).
            for x in from..(from + WIDTH).min(self.accumulated.width()) {
                let Accumulated { moments, length, .. } = self.accumulated.at(term, x, y);
                row.set(term * PLANES + VARIANCE, x, of_moments(moments));
                is_enough &= length >= LONG_ENOUGH;
            }
        }
        is_enough
    }

    /// Weights of the pixels around those of the block.
    #[inline(always)]
    fn weights(&self, at: [usize; 2]) -> [[Column; TAPS]; TAPS] {
        // Bilateral weights of the 7×7 window: w_z·w_n, without luminance.
        let (mut weights, mut likeness) = ([[[0.0; WIDTH]; TAPS]; TAPS], Likeness::WHOLE);
        for (j, weights) in weights.iter_mut().enumerate() {
            let rows = j as i64 - REACH as i64;
            let Some(y) = self.accumulated.row_at(at[1], rows) else { continue };
            for (i, weights) in weights.iter_mut().enumerate() {
                self.geometry.compare(at, y, [i as i64 - REACH as i64, rows], self.settings, &mut likeness);
                *weights = likeness.weights();
            }
        }
        weights
    }

    /// Both moments of a row's pixels from three before the block on, and 1 where they are known.
    #[inline(always)]
    fn moments(&self, term: usize, [from, y]: [usize; 2]) -> [[f32; WIDTH + 2 * REACH]; 3] {
        let mut columns = [[0.0; WIDTH + 2 * REACH]; 3];
        // Copy the moments of the row into columns, so that taps are shifted reads.
        for x in from.saturating_sub(REACH)..(from + WIDTH + REACH).min(self.accumulated.width()) {
            let (k, Accumulated { moments, length, .. }) = (x + REACH - from, self.accumulated.at(term, x, y));
            let is_known = if length > 0 { 1.0 } else { 0.0 };
            (columns[0][k], columns[1][k], columns[2][k]) = (moments.x, moments.y, is_known);
        }
        columns
    }

    /// Sets the variances of a term where histories are short.
    #[inline(always)]
    fn spatial(&self, term: usize, at: [usize; 2], weights: &[[Column; TAPS]; TAPS], row: &mut Row<'_>) {
        // Sum both moments over the window of pixels that are known.
        let mut sums = [[0.0; WIDTH]; 3];
        for (j, weights) in weights.iter().enumerate() {
            let Some(y) = self.accumulated.row_at(at[1], j as i64 - REACH as i64) else { continue };
            let moments = self.moments(term, [at[0], y]);
            for k in 0..WIDTH {
                for i in 0..TAPS {
                    let weight = weights[i][k] * moments[2][k + i];
                    sums[0][k] += weight * moments[0][k + i];
                    sums[1][k] += weight * moments[1][k + i];
                    sums[2][k] += weight;
                }
            }
        }
        // Short histories take the spatial variance, raised the more the shorter they are.
        for x in at[0]..(at[0] + WIDTH).min(self.accumulated.width()) {
            let length = self.accumulated.at(term, x, at[1]).length;
            if length < LONG_ENOUGH {
                let [first, second, weights] = sums.map(|sums| sums[x - at[0]]);
                // Weighted mean moments, then Var = μ₂ − μ₁²; histories of n frames take 4/n of it.
                let variance = of_moments(Vec2::new(first, second) / weights);
                let scale = LONG_ENOUGH as f32 / length.max(1) as f32;
                row.set(term * PLANES + VARIANCE, x, if weights > 0.0 { variance * scale } else { 0.0 });
            }
        }
    }
}
