//! Samples that share nothing: a tile at a time, in waves of many paths, which an integrator may follow together.

use super::{
    lock,
    work::{Member, RAYS, Scratch, Work},
};
use crate::{
    Counters, GroupIntegrator, PixelSample,
    partition::{Place, TILE, cell_of},
};
use std::sync::atomic::Ordering;
use steradian_core::film::LayerInputs;
use steradian_math::{Spectrum, Vec3};

/// Paths of a wave. More of them keep what a thread works with out of its cache; with fewer, what is done for many at
/// once is done for few.
const WAVE: usize = 1024;

impl<'a, G: GroupIntegrator> Work<'a, G> {
    /// Brings a tile to the end of the step; `false` where that was cancelled, which leaves no trace of the last ticks.
    pub fn finish(&self, tile: usize, scratch: &mut Scratch<G::Buffer<'a>>, counters: &mut Counters) -> bool {
        let done = &self.frame.done[tile];
        let mut next = done.load(Ordering::Relaxed).max(self.ticks.0);
        if next >= self.ticks.1 {
            return true;
        }
        // Those before the first have no pixels of their own.
        let [Ok(column), Ok(row)] = self.place(tile).map(u32::try_from) else {
            done.fetch_max(self.ticks.1, Ordering::Relaxed);
            return true;
        };
        let at = self.origin();
        let at = [at[0] + column, at[1] + row];
        scratch.of_tile.clear();
        scratch.of_tile.extend(pixels(at).filter_map(|place| self.pixel(place)).filter(|m| m.kept.is_some()));
        while next < self.ticks.1 {
            let mut mine = Counters::until(&self.stop);
            mine.parts.resize(self.frame.parts, Spectrum::ZERO);
            mine.by_bounce = self.frame.plan.has(LayerInputs::BOUNCES);
            let begin = next;
            scratch.members.clear();
            while next < self.ticks.1 && (next == begin || scratch.members.len() < WAVE) {
                scratch.members.extend(scratch.of_tile.iter().filter_map(|m| self.in_tick(*m, next)));
                next += 1;
            }
            self.waves(scratch, &mut mine);
            if self.stop.is_asked() {
                return false;
            }
            self.keep(scratch, &mut mine);
            done.store(next, Ordering::Release);
            self.report(&mine);
            *counters += &mine;
        }
        true
    }

    /// Takes the samples of all members, wave by wave.
    fn waves(&self, scratch: &mut Scratch<G::Buffer<'a>>, counters: &mut Counters) {
        scratch.hits.clear();
        scratch.lights.clear();
        scratch.lights.resize(scratch.members.len() * counters.parts.len(), Vec3::ZERO);
        scratch.pixels.clear();
        scratch.numbers.clear();
        let sampler = self.sampler();
        for number in 0..scratch.members.len() {
            let m = scratch.members[number];
            for path in 0..m.paths {
                let (sampler, index) = self.numbered(sampler, &m, path);
                scratch.pixels.push((m.place, sampler, index));
                scratch.numbers.push(number);
                if scratch.pixels.len() == WAVE {
                    self.wave(scratch, counters);
                }
            }
        }
        self.wave(scratch, counters);
    }

    /// Takes the samples of a wave.
    fn wave(&self, scratch: &mut Scratch<G::Buffer<'a>>, counters: &mut Counters) {
        let scene = &*self.frame.scene;
        let Scratch { members, pixels, numbers, weights, camera_rays, pixel_samples, buffer, hits, lights, .. } =
            scratch;
        pixel_samples.clear();
        weights.clear();
        match camera_rays {
            Some(camera_rays) => camera_rays.extend(scene, pixels, pixel_samples, weights),
            None => {
                let at = |(place, sampler, index): &_| PixelSample::at(scene, sampler, &self.partition, *index, place);
                (*pixel_samples, *weights) = pixels.iter().map(at).unzip();
            }
        }
        let parts = counters.parts.len();
        if parts == 0 {
            self.integrator.wave(scene, self.prepared, pixel_samples, buffer, counters);
        }
        for ((number, weight), pixel_sample) in numbers.drain(..).zip(&*weights).zip(&mut *pixel_samples) {
            if parts > 0 {
                // Light is kept apart for one path at a time.
                let before = counters.rays;
                self.integrator.group(scene, self.prepared, std::slice::from_mut(pixel_sample), buffer, counters);
                pixel_sample.rays = (counters.rays - before) as u32;
            }
            let m = &mut members[number];
            let (l, hit) = self.exposed(pixel_sample, *weight / m.paths as f32);
            for (sum, light) in lights[number * parts..][..parts].iter_mut().zip(&mut counters.parts) {
                let scale = if l.is_black() { 0.0 } else { l.max_element() / pixel_sample.radiance.max_element() };
                let light = std::mem::replace(light, Spectrum::ZERO) * scale;
                *sum += scene.film().to_rgb(light, &pixel_sample.lambda, scene.mode()) * (*weight / m.paths as f32);
            }
            m.sum += scene.film().to_rgb(l, &pixel_sample.lambda, scene.mode()) * *weight;
            m.rays += pixel_sample.rays;
            hits.extend(hit.map(|hit| (number, hit)));
        }
        pixels.clear();
    }

    /// Adds what was found to the film.
    fn keep(&self, scratch: &Scratch<G::Buffer<'a>>, counters: &mut Counters) {
        let parts = counters.parts.len();
        let Some((number, _)) = scratch.members.first().and_then(|m| m.kept) else { return };
        let mut tile = lock(&self.frame.tiles[number as usize]);
        for (number, m) in scratch.members.iter().enumerate() {
            let Member { place, kept: Some((_, at)), paths, sum, rays, .. } = *m else { continue };
            let (at, value) = (at as usize, sum / paths as f32);
            counters.samples += 1;
            counters.nonfinite += u64::from(!tile.add(at, value, m.tick));
            let cell = &mut tile.cells[cell_of(place.x, place.y)];
            cell.rays += u64::from(rays) * RAYS;
            cell.samples += 1;
            if parts > 0 && value.is_finite() {
                tile.layers.add_lights(at, &scratch.lights[number * parts..][..parts]);
            }
        }
        for (number, hit) in &scratch.hits {
            if let Some((_, at)) = scratch.members[*number].kept {
                self.add_measured(&mut tile.layers, at as usize, hit);
            }
        }
    }
}

/// The pixels of a tile given by column and row, in an order in which neighbours follow each other.
fn pixels([column, row]: [u32; 2]) -> impl Iterator<Item = Place> {
    (0..TILE * TILE).map(move |k| {
        let odd = |k: u32| (0..TILE.trailing_zeros()).fold(0, |v, bit| v | (k >> bit & 1 << bit));
        Place::alone([column * TILE + odd(k), row * TILE + odd(k >> 1)])
    })
}
