//! Tests of a state that is to be that of a frame ([`crate::sound`]).

use super::{
    Frame, lock,
    pieces::ELSEWHERE,
    scales::Even,
    tile::{Cell, Tile},
    work::RAYS,
};
use crate::{
    MOST_PATHS,
    adaptive::{CELL, Round, most},
    partition::CELLS,
    state_checks::{are_counters, are_hits, are_mattes, is_look, is_pixel, is_total},
};
use std::sync::atomic::Ordering;
use steradian_core::film::Pixel;

impl Frame {
    /// True if steps can have led here.
    pub(super) fn is_sound(&self) -> bool {
        // Later ones rely on those before them.
        self.has_sound_round() && self.has_sound_targets() && self.has_sound_progress() && self.has_sound_film()
    }

    fn has_sound_round(&self) -> bool {
        let (plan, Round { number, start, end }) = (&self.plan, self.round);
        let first = |adaptive| Round::first(plan.sampler.spp, adaptive);
        let is_round = match number {
            0 => [first(plan.adaptive), first(false)].contains(&self.round),
            // A round has one sample per pixel or more, and the number of the second may be two.
            _ => first(plan.adaptive).end <= start && start < end && number - 1 <= start,
        };
        let errors = self.errors_of_first_round;
        is_round
            && (number == 0 || !self.is_part())
            && is_total(self.total, plan.sampler.spp)
            && end <= self.total
            && (self.total == plan.sampler.spp || !self.is_part())
            && (start..=end).contains(&self.next)
            && is_look(self.look, self.next, plan.error)
            && !(self.is_good_enough && plan.error.is_none())
            && errors.is_none_or(|errors| number > 0 && errors.iter().all(|e| e.is_finite() && *e >= 0.0))
    }

    /// True if cells can be meant to get so many samples.
    fn has_sound_targets(&self) -> bool {
        let length = self.round.length();
        let is_even = self.round.number == 0 || !self.plan.adaptive;
        let (mut samples, mut pixels) = (0, 0);
        for tile in &self.tiles {
            let tile = lock(tile);
            let range = if is_even { length..=length } else { 1..=most(length) };
            if !tile.cells.iter().all(|cell| range.contains(&cell.target)) {
                return false;
            }
            for at in 0..tile.pixels.len() {
                samples += u64::from(tile.cells[tile.cell_at(at)].target);
            }
            pixels += tile.pixels.len() as u64;
        }
        // In the mean what the round has, or two, which is the fewest; but for the rounding of one cell.
        let slack = u64::from(most(length)) * u64::from(CELL * CELL);
        is_even || samples <= 2 * u64::from(length) * pixels + slack
    }

    fn has_sound_progress(&self) -> bool {
        let ticks = self.round.share(self.ticks, self.next);
        let here = self.done.iter().map(|done| done.load(Ordering::Relaxed)).filter(|done| *done != ELSEWHERE);
        let done = || here.clone();
        done().all(|done| done <= ticks) && self.is_complete == done().all(|done| done == ticks)
    }

    fn has_sound_film(&self) -> bool {
        let (mut samples, mut rays) = (0, 0_u64);
        for (t, tile) in self.tiles.iter().enumerate() {
            let tile = lock(tile);
            if !self.is_sound_tile(t, &tile) {
                return false;
            }
            samples += tile.cells.iter().map(|cell| cell.samples).sum::<u64>();
            rays = tile.cells.iter().fold(rays, |rays, cell| rays.saturating_add(cell.rays));
        }
        let counters = &self.counters;
        are_counters(counters)
            && counters.samples == samples
            && counters.nonfinite <= samples
            && rays <= counters.rays * RAYS
    }

    fn is_sound_tile(&self, number: usize, tile: &Tile) -> bool {
        let mut samples = [0; (CELLS * CELLS) as usize];
        let [least, most] = self.ticks_done(number);
        for (at, now) in tile.pixels.iter().enumerate() {
            let cell = tile.cell_at(at);
            let of = |ticks| u64::from(tile.cells[cell].target) * u64::from(ticks) / u64::from(self.ticks.max(1));
            let past = tile.past.get(at).copied().unwrap_or_default();
            let even = tile.even.get(at).copied().unwrap_or_default();
            let all = u64::from(past.samples) + u64::from(now.samples);
            samples[cell] += all;
            let is_sound = (of(least)..=of(most)).contains(&u64::from(now.samples))
                && self.is_past(past.samples)
                && is_pixel(now)
                && is_pixel(&past)
                && even.samples <= now.samples
                && is_pixel(&Pixel { sum: even.sum, samples: even.samples, ..Pixel::default() })
                && are_sound_halves(tile, at)
                && self.are_sound_layers(tile, at, all);
            if !is_sound {
                return false;
            }
        }
        let numbers = |cell: &Cell| [cell.variance, cell.freedom];
        tile.cells
            .iter()
            .zip(samples)
            .all(|(cell, samples)| cell.samples == samples && numbers(cell).iter().all(|v| v.is_finite() && *v >= 0.0))
    }

    /// True if a pixel can have got so many samples in the rounds before.
    fn is_past(&self, samples: u32) -> bool {
        let start = self.round.start;
        if self.plan.adaptive { (start.min(1)..=most(start)).contains(&samples) } else { samples == start }
    }

    /// The fewest and the most ticks of the round that are done in the tiles whose groups reach into a tile.
    fn ticks_done(&self, tile: usize) -> [u32; 2] {
        if self.is_part() {
            return [self.done[self.done_of(tile)].load(Ordering::Relaxed); 2];
        }
        let columns = self.columns / CELLS as usize;
        let corner = tile / columns * (columns + 1) + tile % columns;
        let around = [corner, corner + 1, corner + columns + 1, corner + columns + 2];
        let done = around.map(|at| self.done[at].load(Ordering::Relaxed));
        [done.into_iter().min(), done.into_iter().max()].map(|ticks| ticks.unwrap_or(0))
    }

    /// True if the layers of a pixel with so many samples can be.
    fn are_sound_layers(&self, tile: &Tile, at: usize, samples: u64) -> bool {
        // A sample may have several paths.
        let paths = samples..=(samples * u64::from(MOST_PATHS)).min(u64::from(u32::MAX / 2));
        let groups = tile.layers.by_light.len() / tile.pixels.len().max(1);
        let lights = &tile.layers.by_light[at * groups..(at + 1) * groups];
        let largest = samples as f64 * f64::from(f32::MAX);
        let bands = tile.layers.by_band.len() / tile.pixels.len().max(1);
        tile.layers.features.get(at).is_none_or(|sums| paths.contains(&u64::from(sums.samples)) && are_hits(sums))
            && tile
                .layers
                .mattes
                .get(at)
                .is_none_or(|sums| paths.contains(&u64::from(sums.samples)) && are_mattes(sums))
            && lights.as_flattened().iter().all(|sum| sum.abs() <= largest)
            && tile.layers.by_band[at * bands..(at + 1) * bands].iter().all(|sum| sum.is_finite())
    }
}

/// True if the halves of a pixel's samples can be.
fn are_sound_halves(tile: &Tile, at: usize) -> bool {
    let largest = f64::from(f32::MAX);
    let (now, past) = (tile.pixels[at].samples, tile.past_halves.get(at).copied().unwrap_or_default());
    let is_sum = |even: &Even| {
        even.samples == now.div_ceil(2) && even.sum.iter().all(|sum| sum.abs() <= f64::from(now) * largest)
    };
    tile.halves.get(at).is_none_or(is_sum)
        && (0.0..=1.0).contains(&past.weight)
        && past.part.iter().all(|part| part.abs() <= largest)
}
