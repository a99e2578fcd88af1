//! A rendering session: advances a film by samples, on any number of threads, with the same bits for any of them.
//!
//! The frame is cut into tiles. A pixel's samples are added in the order of their index, whatever the number of steps
//! they come in, so sums do not depend on threads, tiles or steps. Where paths share, groups of pixels lie across
//! tiles, otherwise for every index: what is done is cut by the tile in which groups begin, and is added to the film
//! when all about it has come as far. What depends on the picture so far, namely how many samples a cell gets
//! ([`crate::adaptive`]) and whether the error is small enough, is decided between steps, at numbers of samples that
//! are fixed.

pub(crate) mod estimate;
mod scales;
#[cfg(test)]
mod sizes_tests;
pub(crate) mod sound;
pub(crate) mod state;
#[cfg(test)]
mod stop_tests;
mod tile;
mod work;

use crate::{
    Counters, Integrator, IntegratorKind, Stop,
    adaptive::{self, Need, Round},
    partition::{CELLS, TILE},
    precomputed::Precomputed,
};
pub use estimate::Doubt;
pub use scales::SCALES;
use std::{
    sync::{
        Arc, Mutex,
        atomic::{AtomicBool, AtomicU32, AtomicU64, Ordering},
    },
    time::{Duration, Instant},
};
use steradian_core::{
    Scene,
    film::{Crop, Film, FirstHitSums, MatteSums, Pixel},
    sampler::Sampler,
};
use tile::Tile;
use work::Work;

/// The error is looked at when there are this many samples per pixel, and then whenever they have grown by a quarter.
pub(crate) const FIRST_LOOK: u32 = 16;

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
    /// Whether the things that cover pixels are counted for mattes.
    pub mattes: bool,
    /// Whether the light of each group of lights is kept for itself; by path tracers whose paths share nothing.
    pub by_light: bool,
    /// Whether samples whose camera rays meet no surface are black: what lies behind everything is not in the picture.
    pub transparent: bool,
    /// Whether cells that err more get more samples, where the first ones tell that it pays; `spp` is the mean then.
    pub adaptive: bool,
    /// The relative error of the picture ([`Session::error`]) at which to stop, unless it is in doubt.
    pub error: Option<f64>,
}

/// Shared with whoever watches a step: progress, and the wish to stop.
#[derive(Debug, Default)]
pub struct Control {
    /// Samples (of all pixels) taken so far.
    pub samples: AtomicU64,
    /// Rays traced so far.
    pub rays: AtomicU64,
    /// Whether trials of the scene are under way, before the first sample.
    pub trials: AtomicBool,
    /// Set to stop, wherever paths are.
    pub cancel: Arc<AtomicBool>,
}

/// A render in progress.
#[derive(Debug)]
pub struct Session<'s> {
    scene: &'s Scene,
    plan: Plan,
    precomputed: Precomputed,
    is_prepared: bool,
    tiles: Vec<Mutex<Tile>>,
    /// Cells of a row of tiles.
    columns: usize,
    /// Samples that cells get in the round, by rows of cells, and the most of them.
    targets: Vec<u32>,
    ticks: u32,
    /// Ticks of the round that are done, by tiles in which groups begin ([`work`]).
    done: Vec<AtomicU32>,
    round: Round,
    /// Samples per pixel, in the mean, of the whole render: those of the plan, or more ([`Self::extend`]).
    total: u32,
    /// Samples per pixel, in the mean, that the steps so far were to reach, and whether all tiles have.
    next: u32,
    is_complete: bool,
    /// When the error is looked at next.
    look: u32,
    is_good_enough: bool,
    /// Of means over pixels, when the first of several rounds was complete.
    errors_of_first_round: Option<[f64; SCALES.len()]>,
    counters: Counters,
    wall: Duration,
    cpu: Duration,
}

/// CPU time of all threads of this process.
pub(crate) fn cpu_time() -> Duration {
    let t = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    Duration::new(t.tv_sec as u64, t.tv_nsec as u32)
}

impl<'s> Session<'s> {
    /// Starts with an empty film, and with what is known of the scene already.
    pub fn with_precomputed(scene: &'s Scene, plan: Plan, precomputed: Precomputed) -> Self {
        Self { precomputed, is_prepared: true, ..Self::new(scene, plan) }
    }

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
                tiles.push(Mutex::new(Tile::new(area, &plan, scene.light_groups.names.len(), round.length())));
            }
        }
        let (columns, rows) = (columns.len(), tiles.len() / columns.len().max(1));
        let mut session = Self {
            scene,
            plan,
            precomputed: Precomputed::default(),
            is_prepared: false,
            tiles,
            columns: columns * CELLS as usize,
            targets: Vec::new(),
            ticks: 0,
            done: (0..(columns + 1) * (rows + 1)).map(|_| AtomicU32::new(0)).collect(),
            round,
            total: plan.sampler.spp,
            next: 0,
            is_complete: true,
            look: FIRST_LOOK,
            is_good_enough: false,
            errors_of_first_round: None,
            counters: Counters::default(),
            wall: Duration::ZERO,
            cpu: Duration::ZERO,
        };
        session.aim();
        session.watch_scales();
        session
    }

    /// Threads that a step uses.
    pub fn threads(&self) -> usize {
        match self.plan.threads {
            0 => std::thread::available_parallelism().map_or(1, |n| n.get()),
            n => n,
        }
    }

    /// What trials find out about the scene, before the first step; whether they came to an end.
    fn look_about(&mut self, control: &Control) -> bool {
        if self.is_prepared {
            return true;
        }
        let (start, cpu) = (Instant::now(), cpu_time());
        control.trials.store(true, Ordering::Relaxed);
        let stop = Stop::by(&control.cancel);
        let precomputed = || self.plan.integrator.precomputed(self.scene, &self.plan, &stop);
        // On as many threads as a step has; where the system gives no more of them, on those there are.
        let pool = rayon::ThreadPoolBuilder::new().num_threads(self.threads()).build();
        let precomputed = pool.map_or_else(|_| precomputed(), |pool| pool.install(precomputed));
        control.trials.store(false, Ordering::Relaxed);
        self.is_prepared = !stop.is_asked();
        if self.is_prepared {
            self.precomputed = precomputed;
        }
        self.wall += start.elapsed();
        self.cpu += cpu_time().saturating_sub(cpu);
        self.is_prepared
    }

    /// Does without trials that did not come to an end: paths then share nothing and follow the same rules everywhere.
    /// `false`, and nothing is changed, where the integrator needs what they compute.
    pub fn skip_trials(&mut self) -> bool {
        let can_do_without = !matches!(self.plan.integrator, IntegratorKind::Radiosity(_));
        self.is_prepared |= can_do_without;
        can_do_without
    }

    /// Takes further samples of every pixel, up to the plan's number or error; fewer where `control` cancels. What a
    /// cancelled step did not reach is caught up by the next one.
    pub fn step(&mut self, samples: u32, control: &Control) {
        if !self.look_about(control) {
            return;
        }
        self.precomputed.stop = Stop::by(&control.cancel);
        let goal = self.next.saturating_add(samples).min(self.total);
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
        let (counters, is_complete) = match &self.plan.integrator {
            IntegratorKind::Path(i) => self.run(i, control),
            IntegratorKind::VolPath(i) => self.run(i, control),
            IntegratorKind::Whitted(i) => self.run(i, control),
            IntegratorKind::Raycast(i) => self.run(i, control),
            IntegratorKind::PathRecursive(i) => self.run(i, control),
            IntegratorKind::Stokes(i) => self.run(i, control),
            IntegratorKind::AmbientOcclusion(i) => self.run(i, control),
            IntegratorKind::Radiosity(i) => self.run(i, control),
            // A session by passes renders these ([`crate::Session::new`]).
            IntegratorKind::Passes(_) => (Counters::default(), true),
        };
        self.is_complete = is_complete;
        self.counters += &counters;
        self.wall += start.elapsed();
        self.cpu += cpu_time().saturating_sub(cpu);
    }

    /// What the picture decides, when all tiles are where the steps are.
    fn decide(&mut self) {
        if let Some(error) = self.plan.error.filter(|_| self.next >= self.look) {
            self.is_good_enough = self.error().is_some_and(|e| e <= error) && self.doubt().is_none();
            self.look = self.look.saturating_add(self.look / 4);
        }
        if self.next == self.round.end && self.next < self.total && !self.is_good_enough {
            let is_even = !self.plan.adaptive || (self.round.number == 0 && self.next >= self.plan.sampler.spp);
            let mut needs = vec![Need::default(); self.tiles.len() * (CELLS * CELLS) as usize];
            for (t, tile) in self.tiles.iter().enumerate() {
                for (c, need) in lock(tile).needs(self.round).into_iter().enumerate() {
                    needs[self.cell(t, c)] = need;
                }
            }
            let round = if is_even { self.round.even(self.total) } else { self.round.next(self.total) };
            let counts = if is_even {
                vec![round.length(); needs.len()]
            } else {
                adaptive::allocate(&needs, self.columns, round.length())
            };
            if !is_even && self.round.number == 0 && adaptive::gain(&needs, &counts, self.round, round) < WORTH {
                // As if nothing else had been asked for.
                self.round = Round::first(self.plan.sampler.spp, false);
                for tile in &self.tiles {
                    lock(tile).cells.iter_mut().for_each(|cell| cell.target = self.round.length());
                }
                self.aim();
                return;
            }
            if self.round.number == 0 {
                self.errors_of_first_round = self.errors_of_means();
            }
            for (t, tile) in self.tiles.iter().enumerate() {
                let mut tile = lock(tile);
                tile.close(self.round);
                for (c, cell) in tile.cells.iter_mut().enumerate() {
                    cell.target = counts[self.cell(t, c)];
                }
            }
            self.done.iter_mut().for_each(|done| *done.get_mut() = 0);
            self.round = round;
            self.aim();
        }
    }

    /// The place of a tile's cell among those of the picture, by rows.
    fn cell(&self, tile: usize, cell: usize) -> usize {
        let (cells, across) = (CELLS as usize, self.columns / CELLS as usize);
        (tile / across * cells + cell / cells) * self.columns + tile % across * cells + cell % cells
    }

    /// Notes what the tiles' cells are to get in the round.
    fn aim(&mut self) {
        self.targets = vec![0; self.tiles.len() * (CELLS * CELLS) as usize];
        for (t, tile) in self.tiles.iter().enumerate() {
            for (c, cell) in lock(tile).cells.iter().enumerate() {
                let at = self.cell(t, c);
                self.targets[at] = cell.target;
            }
        }
        self.ticks = self.targets.iter().copied().max().unwrap_or(0);
    }

    /// Goes on to more samples than the plan has: a further round, with random numbers of its own. `false`, and nothing
    /// is changed, where there are to be more already.
    pub fn extend(&mut self, samples: u32) -> bool {
        let is_more = samples >= self.total;
        self.total = self.total.max(samples);
        is_more
    }

    /// Samples that a pixel has, in the mean, when the steps so far are complete.
    pub fn samples(&self) -> u32 {
        self.next
    }

    /// Whether the plan is carried out: all samples are taken, or the error is small enough.
    pub fn is_done(&self) -> bool {
        self.is_complete && (self.next >= self.total || self.is_good_enough)
    }

    /// Whether the plan's error was reached.
    pub fn is_good_enough(&self) -> bool {
        self.is_good_enough
    }

    /// Whether parts of the picture get more samples than others, as the plan's `adaptive` allows.
    pub fn is_uneven(&self) -> bool {
        self.round.number > 0 && self.plan.adaptive
    }

    /// Whether photons tell where light comes from behind mirrors and glass.
    pub fn asks_photons(&self) -> bool {
        self.precomputed.caustics.is_some()
    }

    /// How many paths of pixels near each other share what they find; 1 where none do, and before the first step.
    pub fn sharing(&self) -> u32 {
        self.precomputed.reuse()
    }

    /// What was done so far.
    pub fn counters(&self) -> Counters {
        self.counters.clone()
    }

    /// Wall time spent in steps.
    pub fn wall(&self) -> Duration {
        self.wall
    }

    /// CPU time spent in steps.
    pub fn cpu(&self) -> Duration {
        self.cpu
    }

    /// Groups of lights that are kept apart.
    fn light_groups(&self) -> usize {
        if self.plan.by_light { self.scene.light_groups.names.len() } else { 0 }
    }

    /// The film as it is.
    pub fn film(&self) -> Film {
        let crop = self.scene.film.crop;
        let n = crop.width() as usize * crop.height() as usize;
        let mut film = Film {
            crop,
            pixels: vec![Pixel::default(); n],
            features: vec![FirstHitSums::default(); if self.plan.features { n } else { 0 }],
            mattes: vec![MatteSums::default(); if self.plan.mattes { n } else { 0 }],
            by_light: vec![[0.0; 3]; n * self.light_groups()],
        };
        for tile in &self.tiles {
            let tile = lock(tile);
            let w = tile.area.width() as usize;
            let pixels: Vec<Pixel> = tile.film(self.round).collect();
            for (row, y) in (tile.area.y0..tile.area.y1).enumerate() {
                let to = (y - crop.y0) as usize * crop.width() as usize + (tile.area.x0 - crop.x0) as usize;
                film.pixels[to..to + w].copy_from_slice(&pixels[row * w..(row + 1) * w]);
                let groups = self.light_groups();
                let by_light = &tile.by_light[row * w * groups..(row + 1) * w * groups];
                film.by_light[to * groups..(to + w) * groups].copy_from_slice(by_light);
                let row = row * w..(row + 1) * w;
                if self.plan.features {
                    film.features[to..to + w].copy_from_slice(&tile.features[row.clone()]);
                }
                if self.plan.mattes {
                    film.mattes[to..to + w].copy_from_slice(&tile.mattes[row]);
                }
            }
        }
        film
    }

    /// Brings the film to where the steps are; what was done, and whether nothing is missing.
    fn run<I: Integrator>(&self, integrator: &I, control: &Control) -> (Counters, bool) {
        let work = Work::new(self, integrator, control);
        std::thread::scope(|scope| {
            for _ in 1..self.threads().min(work.most_threads()) {
                scope.spawn(|| work.run());
            }
            work.run();
        });
        work.end()
    }
}

/// A thread that panicked leaves whole samples behind: the data is sound.
fn lock<T>(m: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    m.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
}
