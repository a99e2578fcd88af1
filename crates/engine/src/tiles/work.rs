//! The work of a step: samples of groups of pixels, on all threads.
//!
//! A round is counted in *ticks*, as many as the cell with most samples has of these; others take one every so many
//! ticks. What is done in a tick is cut by the tile in which the windows of groups begin ([`Partition::windows`]).
//! These reach into the tiles to the right and below, so tiles are counted from one before the first. All pieces are
//! worked at in the order of ticks. A piece is added to the film as a whole, when the pieces about it are there up to
//! the tick before, which they mostly are long since; so each pixel's samples are added in their order. Where nothing
//! is shared, pieces have nothing to do with each other, and a tile is brought to the end of the step at once
//! (`alone.rs`).

use super::{Frame, lock};
use crate::{
    Control, Counters, GroupIntegrator, PixelSample, Stop,
    camera_rays::CameraRays,
    first_hit,
    partition::{CELLS, Partition, Place, TILE, Window, cell_of},
    shadow_catcher,
};
use std::{
    sync::{
        Mutex, PoisonError,
        atomic::{AtomicU64, Ordering},
    },
    time::Duration,
};
use steradian_core::{
    film::{BandSample, FirstHit, LayerInputs, LayerSums},
    sampler::Sampler,
};
use steradian_math::{Spectrum, Vec3, hash::combine64};

/// Rays are counted for pixels in this part of one, so that a group's can be divided among its members.
pub(super) const RAYS: u64 = 64;

/// A sample of a pixel: its part in a group, or alone.
#[derive(Clone, Copy)]
pub(super) struct Member {
    pub place: Place,
    /// The tile that keeps it, and where; `None` beyond the crop.
    pub kept: Option<(u32, u32)>,
    /// The number of its sample in the round, and the samples of the round.
    sample: u32,
    of: u32,
    /// Number of paths that the sample is the mean of.
    pub paths: u32,
    /// Sum of their values.
    pub sum: Vec3,
    /// Rays that they took, where they share none.
    pub rays: u32,
    /// Tick in which the sample is taken.
    pub tick: u32,
}

/// A sample on its way to the film.
struct Found {
    tile: u32,
    at: u32,
    cell: u32,
    value: Vec3,
    rays: u64,
    /// Measurements of its paths: where they begin among those of the piece, and how many.
    hits: (usize, usize),
}

/// Measurements of a path beside its light, for layers.
pub(super) struct Measured {
    hit: Option<FirstHit>,
    bands: Option<BandSample>,
}

/// Buffers of a thread; kept, so that nothing is allocated per sample.
pub(super) struct Scratch<B> {
    pub members: Vec<Member>,
    /// The pixels of a tile.
    pub of_tile: Vec<Member>,
    /// Members that take part in a path of the group, and the weights that the film gives them.
    pub taking: Vec<(usize, f32)>,
    /// The pixels of a wave, with samplers and numbers of samples, and which members they are of.
    pub pixels: Vec<(Place, Sampler, u32)>,
    pub numbers: Vec<usize>,
    pub weights: Vec<f32>,
    pub camera_rays: Option<CameraRays>,
    pub pixel_samples: Vec<PixelSample>,
    pub buffer: B,
    found: Vec<Found>,
    pub hits: Vec<(usize, Measured)>,
    /// The light of each group of lights that samples bring, one after the other.
    pub lights: Vec<Vec3>,
}

impl<B: Default> Default for Scratch<B> {
    fn default() -> Self {
        Self {
            members: Vec::new(),
            of_tile: Vec::new(),
            taking: Vec::new(),
            pixels: Vec::new(),
            numbers: Vec::new(),
            weights: Vec::new(),
            camera_rays: None,
            pixel_samples: Vec::new(),
            buffer: B::default(),
            found: Vec::new(),
            hits: Vec::new(),
            lights: Vec::new(),
        }
    }
}

/// A step under way.
pub(super) struct Work<'a, G: GroupIntegrator> {
    pub frame: &'a Frame,
    pub integrator: &'a G,
    pub prepared: &'a G::Prepared,
    pub control: &'a Control,
    pub stop: Stop,
    pub partition: Partition,
    /// Tiles of a row, one before the first included.
    across: usize,
    /// Ticks to begin with, and to come to.
    pub ticks: (u32, u32),
    /// The next piece of work.
    next: AtomicU64,
    total: Mutex<Counters>,
}

impl<'a, G: GroupIntegrator> Work<'a, G> {
    pub fn new(frame: &'a Frame, integrator: &'a G, prepared: &'a G::Prepared, control: &'a Control) -> Self {
        let begin = frame.done.iter().map(|done| done.load(Ordering::Relaxed)).min().unwrap_or(0);
        Self {
            frame,
            integrator,
            prepared,
            control,
            stop: Stop::by(&control.cancel),
            partition: Partition::new(integrator.group_size(prepared), frame.plan.sampler.seed),
            across: frame.columns / CELLS as usize + 1,
            ticks: (begin, frame.round.share(frame.ticks, frame.next)),
            next: AtomicU64::new(0),
            total: Mutex::default(),
        }
    }

    /// More threads than this have nothing to do.
    pub fn most_threads(&self) -> usize {
        self.frame.done.len()
    }

    /// Counters of the work, and true if nothing is missing.
    pub fn end(self) -> (Counters, bool) {
        let is_complete = self.frame.done.iter().all(|done| done.load(Ordering::Relaxed) >= self.ticks.1);
        (self.total.into_inner().unwrap_or_else(PoisonError::into_inner), is_complete)
    }

    /// Works until nothing is left, or it is cancelled.
    pub fn run(&self) {
        let _guard = CancelOnPanic(self.control);
        let (mut scratch, mut counters) = (Scratch::default(), Counters::until(&self.stop));
        scratch.camera_rays = CameraRays::new(&self.frame.scene, &self.sampler());
        let tiles = self.frame.done.len() as u64;
        let ticks = u64::from(self.ticks.1.saturating_sub(self.ticks.0));
        let alone = self.partition.size() == 1;
        let pieces = if alone { tiles } else { tiles * ticks };
        loop {
            let piece = self.next.fetch_add(1, Ordering::Relaxed);
            if piece >= pieces {
                break;
            }
            let (tile, tick) = ((piece % tiles) as usize, self.ticks.0 + (piece / tiles) as u32);
            let is_done = match alone {
                true => self.finish(tile, &mut scratch, &mut counters),
                false => self.advance(tile, tick, &mut scratch, &mut counters),
            };
            if !is_done {
                break;
            }
        }
        *lock(&self.total) += &counters;
    }

    /// Takes the samples of a tick whose groups begin in a tile; `false` where that was cancelled, which leaves no
    /// trace.
    fn advance(&self, tile: usize, tick: u32, scratch: &mut Scratch<G::Buffer<'a>>, counters: &mut Counters) -> bool {
        let done = &self.frame.done[tile];
        if done.load(Ordering::Relaxed) > tick {
            return true;
        }
        let mut mine = Counters::until(&self.stop);
        scratch.found.clear();
        scratch.hits.clear();
        let place = self.place(tile);
        let first = self.origin().map(|v| v as i32);
        for window in self.partition.windows([0, 1].map(|axis| first[axis] + place[axis]), tick) {
            if self.stop.is_asked() {
                return false;
            }
            self.group(window, tick, scratch, &mut mine);
        }
        if self.stop.is_asked() || !self.wait(place, tick) {
            return false;
        }
        self.add(tick, scratch, &mut mine);
        done.store(tick + 1, Ordering::Release);
        self.report(&mine);
        *counters += &mine;
        true
    }

    /// Column and row of a tile among those that are kept.
    pub fn place(&self, tile: usize) -> [i32; 2] {
        [(tile % self.across) as i32 - 1, (tile / self.across) as i32 - 1]
    }

    /// Column and row in the frame of the first tile that is kept.
    pub fn origin(&self) -> [u32; 2] {
        let crop = self.frame.scene.film().crop;
        [crop.x0 / TILE, crop.y0 / TILE]
    }

    /// Adds to what others see of the step.
    pub fn report(&self, mine: &Counters) {
        self.control.samples.fetch_add(mine.samples, Ordering::Relaxed);
        self.control.rays.fetch_add(mine.rays, Ordering::Relaxed);
    }

    /// Waits for the pieces about a tile to be added up to a tick; `false` where that was cancelled. They were begun
    /// before, so each will be.
    fn wait(&self, [column, row]: [i32; 2], tick: u32) -> bool {
        let down = self.frame.done.len() / self.across;
        for (x, y) in (-1..=1).flat_map(|y| (-1..=1).map(move |x| (column + 1 + x, row + 1 + y))) {
            if !((0..self.across as i32).contains(&x) && (0..down as i32).contains(&y)) {
                continue;
            }
            let done = &self.frame.done[y as usize * self.across + x as usize];
            let mut looks = 0;
            while done.load(Ordering::Acquire) < tick {
                if self.stop.is_asked() {
                    return false;
                }
                looks += 1;
                if looks < 64 { std::thread::yield_now() } else { std::thread::sleep(Duration::from_micros(50)) }
            }
        }
        true
    }

    /// The sample that a pixel takes in a tick, if it takes one.
    pub fn member(&self, place: Place, tick: u32) -> Option<Member> {
        self.in_tick(self.pixel(place)?, tick)
    }

    /// The first sample of a pixel that takes some in the round.
    pub fn pixel(&self, place: Place) -> Option<Member> {
        let Frame { scene, round, columns, targets, ticks, .. } = self.frame;
        let Place { x, y, .. } = place;
        let film = scene.film();
        if x >= film.width || y >= film.height {
            return None;
        }
        let crop = film.crop;
        let is_kept = (crop.x0..crop.x1).contains(&x) && (crop.y0..crop.y1).contains(&y);
        let tile = || [x / TILE - crop.x0 / TILE, y / TILE - crop.y0 / TILE];
        // Members beyond the crop take part, so that a crop has the bits of the whole; nothing is known of what they
        // need.
        let of = match (round.number, is_kept) {
            (0, _) => *ticks,
            (_, true) => {
                let cell = cell_of(x, y) as u32;
                let [column, row] = tile().map(|v| v * CELLS);
                targets[(row + cell / CELLS) as usize * columns + (column + cell % CELLS) as usize]
            }
            (_, false) => return None,
        };
        let kept = is_kept.then(|| {
            let [column, row] = tile();
            let corner = [(x / TILE * TILE).max(crop.x0), (y / TILE * TILE).max(crop.y0)];
            let width = (x / TILE * TILE + TILE).min(crop.x1) - corner[0];
            (row * (*columns as u32 / CELLS) + column, (y - corner[1]) * width + x - corner[0])
        });
        let paths = self.integrator.paths(self.prepared, [x, y]);
        Some(Member { place, kept, sample: 0, of, paths, sum: Vec3::ZERO, rays: 0, tick: 0 })
    }

    /// The sample of a pixel in a tick, if it takes one then.
    #[inline]
    pub fn in_tick(&self, pixel: Member, tick: u32) -> Option<Member> {
        let ticks = self.frame.ticks;
        if pixel.of == ticks {
            return Some(Member { sample: tick, tick, ..pixel });
        }
        let until = |tick: u32| (u64::from(pixel.of) * u64::from(tick) / u64::from(ticks.max(1))) as u32;
        let sample = until(tick);
        (until(tick + 1) != sample).then_some(Member { sample, tick, ..pixel })
    }

    /// The sampler of the step. Rounds are independent of each other.
    pub fn sampler(&self) -> Sampler {
        let Frame { plan, round, .. } = self.frame;
        let seed = match round.number {
            0 => plan.sampler.seed,
            n => combine64(plan.sampler.seed, n.into()),
        };
        Sampler { seed, ..plan.sampler }
    }

    /// The sampler of one of the paths that a sample is the mean of, and its number.
    pub fn numbered(&self, sampler: Sampler, m: &Member, path: u32) -> (Sampler, u32) {
        // The first paths of all samples come first in a pixel's points, then the second ones, for those who have such.
        let (sampler, sample, of) = match self.frame.plan.has(LayerInputs::HALVES) {
            true => (sampler.half(m.sample), m.sample / 2, m.of.div_ceil(2)),
            false => (sampler, m.sample, m.of),
        };
        (Sampler { spp: of.saturating_mul(m.paths), ..sampler }, sample.wrapping_add(path.wrapping_mul(of)))
    }

    /// Value of a path for the film, and what layers ask for: the first hit of its ray, and its light by wavelengths
    /// with its weight in the sample.
    pub fn exposed(&self, pixel_sample: &PixelSample, weight: f32) -> (Spectrum, Option<Measured>) {
        let Frame { scene, plan, bands, .. } = self.frame;
        let mut l = scene.film().exposed(pixel_sample.radiance);
        let gathers = plan.has(LayerInputs::FIRST_HITS) || plan.has(LayerInputs::MATTES);
        let mut measured = Measured { hit: None, bands: None };
        if gathers || plan.transparent || scene.has_shadow_catchers() {
            let before = self.frame.before.as_deref();
            let hit = first_hit(scene, pixel_sample.ray, &pixel_sample.lambda, plan.sight(), before);
            let PixelSample { ray, lambda, .. } = pixel_sample;
            l = shadow_catcher::shown(scene, ray, &hit, plan.transparent, lambda).unwrap_or(l);
            measured.hit = gathers.then_some(hit);
        }
        if bands.is_some() {
            measured.bands = scene.film().band_sample(l, &pixel_sample.lambda, weight);
        }
        (l, (gathers || bands.is_some()).then_some(measured))
    }

    /// Adds measurements of a path to those of a pixel of a tile.
    pub fn add_measured(&self, layers: &mut LayerSums, at: usize, measured: &Measured) {
        if let Some(hit) = &measured.hit {
            layers.add_hit(at, hit);
        }
        if let (Some(bands), Some(sample)) = (&self.frame.bands, &measured.bands) {
            layers.add_bands(at, bands, sample);
        }
    }

    /// One sample of each pixel of a group, which is the mean of as many paths as the preparation wants.
    fn group(&self, window: Window, tick: u32, scratch: &mut Scratch<G::Buffer<'a>>, counters: &mut Counters) {
        let Frame { scene, .. } = self.frame;
        let Scratch { members, taking, pixel_samples, buffer, found, hits, .. } = scratch;
        members.clear();
        members.extend(self.partition.places(window).filter_map(|place| self.member(place, tick)));
        if !members.iter().any(|m| m.kept.is_some()) {
            return;
        }
        let (begin, sampler) = (hits.len(), self.sampler());
        let before = counters.rays;
        for path in 0..members.iter().map(|m| m.paths).max().unwrap_or(0) {
            pixel_samples.clear();
            taking.clear();
            for (number, m) in members.iter().enumerate().filter(|(_, m)| m.paths > path) {
                let (sampler, index) = self.numbered(sampler, m, path);
                let (pixel_sample, weight) = PixelSample::at(scene, &sampler, &self.partition, index, &m.place);
                pixel_samples.push(pixel_sample);
                taking.push((number, weight));
            }
            self.integrator.group(scene, self.prepared, pixel_samples, buffer, counters);
            for (&(number, weight), pixel_sample) in taking.iter().zip(&*pixel_samples) {
                let paths = members[number].paths as f32;
                let (l, hit) = self.exposed(pixel_sample, weight / paths);
                members[number].sum += scene.film().to_rgb(l, &pixel_sample.lambda, scene.mode()) * weight;
                if let Some(hit) = hit.filter(|_| members[number].kept.is_some()) {
                    hits.push((number, hit));
                }
            }
        }
        hits[begin..].sort_by_key(|(number, _)| *number);
        let rays = (counters.rays - before) * RAYS / members.len() as u64;
        let mut at_hit = begin;
        for (number, m) in members.iter().enumerate() {
            let Some((tile, at)) = m.kept else { continue };
            let count = hits[at_hit..].iter().take_while(|(n, _)| *n == number).count();
            let (value, cell) = (m.sum / m.paths as f32, cell_of(m.place.x, m.place.y) as u32);
            found.push(Found { tile, at, cell, value, rays, hits: (at_hit, count) });
            at_hit += count;
        }
    }

    /// Adds what was found to the film.
    fn add(&self, tick: u32, scratch: &mut Scratch<G::Buffer<'a>>, counters: &mut Counters) {
        scratch.found.sort_unstable_by_key(|f| (f.tile, f.at));
        for found in scratch.found.chunk_by(|a, b| a.tile == b.tile) {
            let mut tile = lock(&self.frame.tiles[found[0].tile as usize]);
            for f in found {
                counters.samples += 1;
                counters.nonfinite += u64::from(!tile.add(f.at as usize, f.value, tick));
                let cell = &mut tile.cells[f.cell as usize];
                cell.rays += f.rays;
                cell.samples += 1;
                for (_, hit) in &scratch.hits[f.hits.0..f.hits.0 + f.hits.1] {
                    self.add_measured(&mut tile.layers, f.at as usize, hit);
                }
            }
        }
    }
}

/// Lets no thread wait for one that panicked.
struct CancelOnPanic<'a>(&'a Control);

impl Drop for CancelOnPanic<'_> {
    fn drop(&mut self) {
        if std::thread::panicking() {
            self.0.cancel.store(true, Ordering::Relaxed);
        }
    }
}
