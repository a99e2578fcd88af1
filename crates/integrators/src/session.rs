//! A rendering session: advances a film by samples, on any number of threads, with the same bits for any of them.
//!
//! The frame is cut into tiles, each owned by one thread at a time. A pixel's samples are added in the order of their index, whatever
//! the number of steps they come in, so sums do not depend on threads, tiles or steps. What depends on the picture so far, namely how many samples a
//! cell gets ([`crate::adaptive`]) and whether the error is small enough, is decided between steps, at numbers of samples that are fixed.

#[cfg(test)]
mod sizes_tests;
mod state;
mod tile;

use crate::{
    Counters, Integrator, IntegratorKind,
    adaptive::{self, CELL, Need, Round},
    features,
    partition::{CELLS, Partition, Place, TILE},
    reuse::{Room, Seat},
    survey::Survey,
};
use std::{
    sync::{
        Mutex,
        atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering},
    },
    time::{Duration, Instant},
};
use steradian_core::{
    Scene, color,
    film::{Crop, FirstHit, FirstHitSums, Pixel},
    sampler::Sampler,
};
use steradian_math::{Vec3, hash::combine64};
use tile::Tile;

/// The error is looked at when there are this many samples per pixel, and then whenever they have grown by a quarter.
const FIRST_LOOK: u32 = 16;

/// Samples are spread unevenly from this [`adaptive::gain`] on: it is told from few samples.
const WORTH: f64 = 1.25;

/// What is to be rendered, and how.
#[derive(Clone, Copy, Debug)]
pub struct Plan {
    /// The estimator.
    pub integrator: IntegratorKind,
    /// The random numbers; its `spp` is the number that a full render takes.
    pub sampler: Sampler,
    /// Threads; 0 for one per processor.
    pub threads: usize,
    /// Whether first hits are gathered for auxiliary layers.
    pub features: bool,
    /// Whether cells that err more get more samples, where the first ones tell that it pays; `spp` is the mean then.
    pub adaptive: bool,
    /// The relative error of the picture ([`Session::error`]) at which to stop.
    pub error: Option<f64>,
}

/// Shared with whoever watches a step: progress, and the wish to stop.
#[derive(Debug, Default)]
pub struct Control {
    /// Samples (of all pixels) taken so far.
    pub samples: AtomicU64,
    /// Rays traced so far.
    pub rays: AtomicU64,
    /// Set to stop at the next tile.
    pub cancel: AtomicBool,
}

/// A group's pixels while they are worked at; kept, so that nothing is allocated per sample.
#[derive(Default)]
struct Desk<'s> {
    places: Vec<Place>,
    seats: Vec<Seat>,
    weights: Vec<f32>,
    /// What the paths of a sample bring.
    sums: Vec<Vec3>,
    room: Room<'s>,
}

/// Which sample of which group, and how many paths it is the mean of.
#[derive(Clone, Copy)]
struct Number {
    group: u32,
    index: u32,
    paths: u32,
}

/// The state of a film: what a session gives to be looked at or saved.
#[derive(Clone, Debug)]
pub struct Film {
    /// What of the full frame it shows.
    pub crop: Crop,
    /// Pixels by rows.
    pub pixels: Vec<Pixel>,
    /// First hits by rows; empty where they were not gathered.
    pub features: Vec<FirstHitSums>,
}

/// A render in progress.
#[derive(Debug)]
pub struct Session<'s> {
    scene: &'s Scene,
    plan: Plan,
    survey: Survey,
    tiles: Vec<Mutex<Tile>>,
    /// Cells of a row of tiles.
    columns: usize,
    round: Round,
    /// Samples per pixel, in the mean, that the steps so far were to reach, and whether all tiles have.
    next: u32,
    is_complete: bool,
    /// When the error is looked at next.
    look: u32,
    is_good_enough: bool,
    counters: Counters,
    wall: Duration,
    cpu: Duration,
}

/// CPU time of all threads of this process.
fn cpu_time() -> Duration {
    let t = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    Duration::new(t.tv_sec as u64, t.tv_nsec as u32)
}

impl<'s> Session<'s> {
    /// Starts with an empty film.
    pub fn new(scene: &'s Scene, plan: Plan) -> Self {
        let crop = scene.film.crop;
        let round = Round::first(plan.sampler.spp, plan.adaptive);
        let mut tiles = Vec::new();
        let aligned = |v: u32| v / TILE * TILE;
        let columns = (aligned(crop.x0)..crop.x1).step_by(TILE as usize);
        for y in (aligned(crop.y0)..crop.y1).step_by(TILE as usize) {
            for x in columns.clone() {
                let area = Crop {
                    x0: x.max(crop.x0),
                    y0: y.max(crop.y0),
                    x1: (x + TILE).min(crop.x1),
                    y1: (y + TILE).min(crop.y1),
                };
                tiles.push(Mutex::new(Tile::new(area, plan.features, round.length())));
            }
        }
        let (start, cpu) = (Instant::now(), cpu_time());
        let survey = plan.integrator.survey(scene, plan.sampler.spp, plan.adaptive);
        Self {
            scene,
            plan,
            survey,
            tiles,
            columns: columns.len() * CELLS as usize,
            round,
            next: 0,
            is_complete: true,
            look: FIRST_LOOK,
            is_good_enough: false,
            counters: Counters::default(),
            wall: start.elapsed(),
            cpu: cpu_time().saturating_sub(cpu),
        }
    }

    /// Threads that a step uses.
    pub fn threads(&self) -> usize {
        match self.plan.threads {
            0 => std::thread::available_parallelism().map_or(1, |n| n.get()),
            n => n,
        }
    }

    /// Takes further samples of every pixel, up to the plan's number or error; fewer where `control` cancels. Tiles that a cancelled step
    /// did not reach are caught up by the next one.
    pub fn step(&mut self, samples: u32, control: &Control) {
        let goal = self.next.saturating_add(samples).min(self.plan.sampler.spp);
        loop {
            if !self.is_complete {
                self.advance(control);
                if !self.is_complete {
                    return;
                }
                self.decide();
            }
            if self.next >= goal || self.is_good_enough {
                return;
            }
            let look = if self.plan.error.is_some() { self.look } else { u32::MAX };
            self.next = goal.min(self.round.end).min(look);
            self.is_complete = false;
        }
    }

    /// Brings all tiles to where the steps are.
    fn advance(&mut self, control: &Control) {
        let (start, cpu) = (Instant::now(), cpu_time());
        let (counters, reached) = match &self.plan.integrator {
            IntegratorKind::Path(i) => self.run(i, control),
            IntegratorKind::VolPath(i) => self.run(i, control),
            IntegratorKind::Whitted(i) => self.run(i, control),
            IntegratorKind::Raycast(i) => self.run(i, control),
            IntegratorKind::PathRecursive(i) => self.run(i, control),
            IntegratorKind::Stokes(i) => self.run(i, control),
        };
        self.is_complete = reached == self.tiles.len();
        self.counters += counters;
        self.wall += start.elapsed();
        self.cpu += cpu_time().saturating_sub(cpu);
    }

    /// What the picture decides, when all tiles are where the steps are.
    fn decide(&mut self) {
        if let Some(error) = self.plan.error.filter(|_| self.next >= self.look) {
            self.is_good_enough = self.error().is_some_and(|e| e <= error);
            self.look = self.look.saturating_add(self.look / 4);
        }
        if self.next == self.round.end && self.next < self.plan.sampler.spp && !self.is_good_enough {
            let mut needs = vec![Need::default(); self.tiles.len() * (CELLS * CELLS) as usize];
            let at = |tile: usize, cell: usize| -> usize {
                let (cells, across) = (CELLS as usize, self.columns / CELLS as usize);
                (tile / across * cells + cell / cells) * self.columns + tile % across * cells + cell % cells
            };
            for (t, tile) in self.tiles.iter().enumerate() {
                for (c, need) in lock(tile).needs(self.round).into_iter().enumerate() {
                    needs[at(t, c)] = need;
                }
            }
            let round = self.round.next(self.plan.sampler.spp);
            let counts = adaptive::allocate(&needs, self.columns, round.length());
            if self.round.number == 0 && adaptive::gain(&needs, &counts, self.round, round) < WORTH {
                // As if nothing else had been asked for.
                self.round = Round::first(self.plan.sampler.spp, false);
                for tile in &self.tiles {
                    lock(tile).cells.iter_mut().for_each(|cell| cell.target = self.round.length());
                }
                return;
            }
            for (t, tile) in self.tiles.iter().enumerate() {
                let mut tile = lock(tile);
                tile.close(self.round);
                for (c, cell) in tile.cells.iter_mut().enumerate() {
                    cell.target = counts[at(t, c)];
                }
            }
            self.round = round;
        }
    }

    /// Samples that a pixel has, in the mean, when the steps so far are complete.
    pub fn samples(&self) -> u32 {
        self.next
    }

    /// Whether the plan is carried out: all samples are taken, or the error is small enough.
    pub fn is_done(&self) -> bool {
        self.is_complete && (self.next >= self.plan.sampler.spp || self.is_good_enough)
    }

    /// Whether the plan's error was reached.
    pub fn is_good_enough(&self) -> bool {
        self.is_good_enough
    }

    /// Whether parts of the picture get more samples than others, as the plan's `adaptive` allows.
    pub fn is_uneven(&self) -> bool {
        self.round.number > 0
    }

    /// Whether photons tell where light comes from behind mirrors and glass.
    pub fn asks_photons(&self) -> bool {
        self.survey.caustics.is_some()
    }

    /// The estimated relative error of the picture: the square root of the mean, over pixels and channels, of the variance of the pixel
    /// over `I² + 0.01`, which is the root of what the metric relMSE expects. Variances are those of independent samples: with a sampler that
    /// spreads them well the true error is smaller. `None` before all pixels have two samples.
    pub fn error(&self) -> Option<f64> {
        let crop = self.scene.film.crop;
        let values = 3.0 * f64::from(crop.width()) * f64::from(crop.height());
        let sum: Option<f64> = self.tiles.iter().map(|t| lock(t).squared_errors(self.round)).sum();
        sum.map(|s| (s / values).sqrt())
    }

    /// What was done so far.
    pub fn counters(&self) -> Counters {
        self.counters
    }

    /// Wall time spent in steps.
    pub fn wall(&self) -> Duration {
        self.wall
    }

    /// CPU time spent in steps.
    pub fn cpu(&self) -> Duration {
        self.cpu
    }

    /// The film as it is.
    pub fn film(&self) -> Film {
        let crop = self.scene.film.crop;
        let n = crop.width() as usize * crop.height() as usize;
        let mut film = Film {
            crop,
            pixels: vec![Pixel::default(); n],
            features: vec![FirstHitSums::default(); if self.plan.features { n } else { 0 }],
        };
        for tile in &self.tiles {
            let tile = lock(tile);
            let w = tile.area.width() as usize;
            let pixels: Vec<Pixel> = tile.film(self.round).collect();
            for (row, y) in (tile.area.y0..tile.area.y1).enumerate() {
                let to = (y - crop.y0) as usize * crop.width() as usize + (tile.area.x0 - crop.x0) as usize;
                film.pixels[to..to + w].copy_from_slice(&pixels[row * w..(row + 1) * w]);
                if self.plan.features {
                    film.features[to..to + w].copy_from_slice(&tile.features[row * w..(row + 1) * w]);
                }
            }
        }
        film
    }

    /// Brings tiles to where the steps are until cancelled; what was done, and how many tiles are there.
    fn run<I: Integrator>(&self, integrator: &I, control: &Control) -> (Counters, usize) {
        let (next_tile, reached) = (AtomicUsize::new(0), AtomicUsize::new(0));
        let total = Mutex::new(Counters::default());
        let work = || {
            let mut counters = Counters::default();
            while let Some(tile) = self.tiles.get(next_tile.fetch_add(1, Ordering::Relaxed)) {
                if control.cancel.load(Ordering::Relaxed) {
                    break;
                }
                let mut mine = Counters::default();
                self.render_tile(integrator, &mut lock(tile), &mut mine);
                reached.fetch_add(1, Ordering::Relaxed);
                control.samples.fetch_add(mine.samples, Ordering::Relaxed);
                control.rays.fetch_add(mine.rays, Ordering::Relaxed);
                counters += mine;
            }
            *lock(&total) += counters;
        };
        std::thread::scope(|scope| {
            for _ in 1..self.threads() {
                scope.spawn(work);
            }
            work();
        });
        (total.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner), reached.into_inner())
    }

    fn render_tile<I: Integrator>(&self, integrator: &I, tile: &mut Tile, counters: &mut Counters) {
        let area = tile.area;
        let mut desk = Desk::default();
        let partition =
            Partition::new([area.x0 / TILE * TILE, area.y0 / TILE * TILE], integrator.reuse(), self.plan.sampler.seed);
        for cell in 0..tile.cells.len() {
            if !meets(cell, &area) {
                continue;
            }
            let (done, target) = (tile.cells[cell].done, tile.cells[cell].target);
            let goal = self.round.share(target, self.next);
            // Rounds are independent of each other.
            let mut sampler = match self.round.number {
                0 => self.plan.sampler,
                n => Sampler { spp: target, seed: combine64(self.plan.sampler.seed, n.into()), ..self.plan.sampler },
            };
            let groups: Vec<u32> = partition.groups_of(cell).collect();
            let paths = groups.first().map_or(1, |g| self.survey.splitting.paths(partition.first(*g)));
            sampler.spp = sampler.spp.saturating_mul(paths);
            let mut mine = Counters::default();
            for index in done..goal {
                for group in &groups {
                    let number = Number { group: *group, index, paths };
                    self.render_group(integrator, tile, &mut desk, &partition, &sampler, number, &mut mine);
                }
            }
            let cell = &mut tile.cells[cell];
            cell.done = goal;
            cell.rays += mine.rays;
            cell.samples += mine.samples;
            *counters += mine;
        }
    }

    /// One sample of each pixel of a group, which is the mean of as many paths as the survey wants.
    #[allow(clippy::too_many_arguments)]
    fn render_group<I: Integrator>(
        &self,
        integrator: &I,
        tile: &mut Tile,
        desk: &mut Desk<'s>,
        partition: &Partition,
        sampler: &Sampler,
        Number { group, index, paths }: Number,
        counters: &mut Counters,
    ) {
        let (scene, film, area) = (self.scene, &self.scene.film, tile.area);
        let in_area = |p: &Place| (area.x0..area.x1).contains(&p.x) && (area.y0..area.y1).contains(&p.y);
        let at = |p: &Place| ((p.y - area.y0) * area.width() + p.x - area.x0) as usize;
        let Desk { places, seats, weights, sums, room } = desk;
        // Members beyond the crop take part, so that a crop has the bits of the whole.
        places.clear();
        places.extend(partition.places(group).filter(|p| p.x < film.width && p.y < film.height));
        if !places.iter().any(in_area) {
            return;
        }
        sums.clear();
        sums.resize(places.len(), Vec3::ZERO);
        for path in 0..paths {
            let index = index.wrapping_mul(paths).wrapping_add(path);
            let joint = partition.sampler(sampler, group, index);
            seats.clear();
            weights.clear();
            for p in &*places {
                let (seat, weight) = Seat::at(scene, sampler, &joint, index, p);
                seats.push(seat);
                weights.push(weight);
            }
            match &mut seats[..] {
                [s] => s.radiance = integrator.radiance(scene, &self.survey, s.ray, &s.own, &mut s.lambda, counters),
                seats => integrator.group(scene, &self.survey, seats, room, counters),
            }
            for ((sum, seat), weight) in sums.iter_mut().zip(&*seats).zip(&*weights) {
                let mut l = seat.radiance * film.imaging_ratio;
                if film.max_component.is_finite() {
                    let m = l.max_element();
                    if m > film.max_component {
                        l *= film.max_component / m;
                    }
                }
                *sum += color::to_rgb(l, &seat.lambda, scene.mode) * *weight;
            }
            if self.plan.features {
                for (p, seat) in places.iter().zip(&*seats).filter(|(p, _)| in_area(p)) {
                    let hit: FirstHit = features::first_hit(scene, seat.ray, &seat.lambda);
                    tile.features[at(p)].add(&hit);
                }
            }
        }
        for (p, sum) in places.iter().zip(&*sums).filter(|(p, _)| in_area(p)) {
            counters.samples += 1;
            if !tile.pixels[at(p)].add(*sum / paths as f32) {
                counters.nonfinite += 1;
            }
        }
    }
}

/// Whether a cell of the tile that an area lies in has pixels of it. Others lie beyond the crop, or beyond the frame.
fn meets(cell: usize, area: &Crop) -> bool {
    let cell = cell as u32;
    let [x, y] = [area.x0 / TILE * TILE + cell % CELLS * CELL, area.y0 / TILE * TILE + cell / CELLS * CELL];
    x < area.x1 && x + CELL > area.x0 && y < area.y1 && y + CELL > area.y0
}

/// A thread that panicked leaves whole samples behind: the data is sound.
fn lock<T>(m: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    m.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
}
