//! Pictures sample by sample: a session advances a film on any number of threads, with the same bits for any of them.
//!
//! The frame is cut into tiles. A pixel's samples are added in the order of their index, whatever the number of steps
//! they come in, so sums do not depend on threads, tiles or steps. Where paths share, groups of pixels lie across
//! tiles, otherwise for every index: what is done is cut by the tile in which groups begin, and is added to the film
//! when all about it has come as far. What depends on the picture so far, namely how many samples a cell gets
//! ([`crate::adaptive`]) and whether the error is small enough, is decided between steps, at numbers of samples that
//! are fixed.
//!
//! Tiles are 16 pixels wide and aligned to the frame rather than to the crop, so that a crop has the bits of the whole;
//! with adaptive sampling, where needs are decided by the pixels present, it does not. A session is saved and restored
//! between steps (`state`). Tiles of a render without such decisions are computed apart and joined (`pieces`).

mod alone;
mod pieces;
mod scales;
mod state;
mod state_checks;
mod tile;
mod work;

use crate::{
    Control, Counters, Doubt, FIRST_LOOK, GroupIntegrator, History, Indivisible, Integrator, OneByOne, Plan, Session,
    Stop,
    adaptive::{self, Need, Round},
    cpu_time,
    estimate::{FEWEST_FINDS, Sum},
    partition::{CELLS, TILE},
    pieces::{invalid, within},
    session::Earlier,
};
pub use scales::SCALES;
use std::{
    io::{self, Read, Write},
    ops::Range,
    sync::{
        Arc, Mutex,
        atomic::{AtomicU32, Ordering},
    },
    time::{Duration, Instant},
};
use steradian_core::{
    Scene,
    film::{Bands, Crop, Film, Half, LayerInputs, LayerSums, Pixel, bounce_parts},
};
use tile::Tile;
use work::Work;

/// Samples are spread unevenly from this [`adaptive::gain`] on: it is told from few samples.
const WORTH: f64 = 1.25;

/// A render by an integrator, under way.
#[derive(Debug)]
pub struct Tiles<G: GroupIntegrator> {
    frame: Frame,
    integrator: G,
    prepared: G::Prepared,
    is_prepared: bool,
}

/// A render by an integrator whose samples know nothing of each other.
pub type PerPixel<I> = Tiles<OneByOne<I>>;

impl<I: Integrator> PerPixel<I> {
    /// Starts with an empty film.
    pub fn per_pixel(scene: Arc<Scene>, integrator: I, plan: Plan) -> Self {
        Self::new(scene, OneByOne(integrator), plan)
    }
}

impl<G: GroupIntegrator> Tiles<G> {
    /// Starts with an empty film.
    pub fn new(scene: Arc<Scene>, integrator: G, plan: Plan) -> Self {
        Self {
            frame: Frame::new(scene, plan, &integrator),
            integrator,
            prepared: G::Prepared::default(),
            is_prepared: false,
        }
    }

    /// Starts with an empty film, and with what is known of the scene already.
    pub fn prepared(scene: Arc<Scene>, integrator: G, plan: Plan, prepared: G::Prepared) -> Self {
        Self { frame: Frame::new(scene, plan, &integrator), integrator, prepared, is_prepared: true }
    }

    /// Prepares the integrator for the scene, before the first step; true if that came to an end.
    fn prepare(&mut self, control: &Control) -> bool {
        if self.is_prepared {
            return true;
        }
        let (start, cpu) = (Instant::now(), cpu_time());
        let Frame { scene, plan, .. } = &self.frame;
        control.trials.store(true, Ordering::Relaxed);
        let stop = Stop::by(&control.cancel);
        let prepare = || self.integrator.prepare(scene, plan, &stop);
        // On as many threads as a step has; where the system gives no more of them, on those there are.
        let pool = rayon::ThreadPoolBuilder::new().num_threads(plan.threads()).build();
        let prepared = pool.map_or_else(|_| prepare(), |pool| pool.install(prepare));
        control.trials.store(false, Ordering::Relaxed);
        self.is_prepared = !stop.is_asked();
        if self.is_prepared {
            self.prepared = prepared;
        }
        self.frame.spent(start, cpu);
        self.is_prepared
    }

    /// Brings all tiles to where the steps are.
    fn advance(&mut self, control: &Control) {
        let (start, cpu) = (Instant::now(), cpu_time());
        let work = Work::new(&self.frame, &self.integrator, &self.prepared, control);
        std::thread::scope(|scope| {
            for _ in 1..self.frame.plan.threads().min(work.most_threads()) {
                scope.spawn(|| work.run());
            }
            work.run();
        });
        let (counters, is_complete) = work.end();
        self.frame.is_complete = is_complete;
        self.frame.counters += &counters;
        self.frame.spent(start, cpu);
    }
}

impl<G: GroupIntegrator> Session for Tiles<G> {
    fn step(&mut self, samples: u32, control: &Control) {
        let is_idle = self.frame.is_joining() || self.frame.is_joined() && self.is_done();
        if is_idle || !self.prepare(control) {
            return;
        }
        let goal = self.frame.next.saturating_add(samples).min(self.frame.total);
        let rarest_path_probability = self.integrator.rarest_path_probability(&self.prepared);
        loop {
            if !self.frame.is_complete {
                self.advance(control);
                if !self.frame.is_complete {
                    return;
                }
                self.frame.decide(rarest_path_probability);
            }
            let frame = &mut self.frame;
            if frame.next >= goal || frame.is_good_enough {
                return;
            }
            let look = if frame.plan.error.is_some() { frame.look } else { u32::MAX };
            frame.next = goal.min(frame.round.end).min(look);
            frame.is_complete = false;
        }
    }

    fn skip_trials(&mut self) -> bool {
        self.is_prepared |= self.integrator.works_unprepared();
        self.integrator.works_unprepared()
    }

    fn extend(&mut self, samples: u32) -> bool {
        let is_more = samples >= self.frame.total && !self.frame.is_part();
        if !is_more {
            return false;
        }
        self.frame.total = samples;
        true
    }

    fn threads(&self) -> usize {
        self.frame.plan.threads()
    }

    fn samples(&self) -> u32 {
        self.frame.next
    }

    fn is_done(&self) -> bool {
        self.frame.is_complete && (self.frame.next >= self.frame.total || self.frame.is_good_enough)
    }

    fn is_good_enough(&self) -> bool {
        self.frame.is_good_enough
    }

    fn is_uneven(&self) -> bool {
        self.frame.round.number > 0 && self.frame.plan.adaptive
    }

    fn asks_photons(&self) -> bool {
        self.integrator.asks_photons(&self.prepared)
    }

    fn sharing(&self) -> u32 {
        self.integrator.group_size(&self.prepared)
    }

    fn error(&self) -> Option<f64> {
        self.frame.error()
    }

    fn doubt(&self) -> Option<Doubt> {
        self.frame.doubt(self.integrator.rarest_path_probability(&self.prepared))
    }

    fn errors_of_means(&self) -> Option<[f64; SCALES.len()]> {
        self.frame.errors_of_means()
    }

    fn counters(&self) -> Counters {
        self.frame.counters.clone()
    }

    fn time(&self) -> [Duration; 2] {
        self.frame.time
    }

    fn take_history(&mut self) -> Option<History> {
        let Frame { scene, plan, .. } = &self.frame;
        plan.has(LayerInputs::MOTION).then(|| History(Arc::new(Earlier { scene: Arc::clone(scene), own: None })))
    }

    fn follow(&mut self, history: &History) {
        let Frame { scene, plan, before, .. } = &mut self.frame;
        let earlier = Earlier::of(history, scene).filter(|_| plan.has(LayerInputs::MOTION));
        *before = earlier.map(|earlier| Arc::clone(&earlier.scene));
    }

    fn film(&self) -> Film {
        self.frame.film()
    }

    fn save(&mut self, out: &mut dyn Write) -> io::Result<()> {
        self.frame.save(out)
    }

    fn restore(&mut self, from: &mut dyn Read) -> io::Result<()> {
        self.frame.restore(from)
    }

    fn pieces(&self) -> Result<u32, Indivisible> {
        let Frame { plan, tiles, .. } = &self.frame;
        if plan.error.is_some() {
            return Err(Indivisible::Error);
        }
        if plan.adaptive && Round::first(plan.sampler.spp, true).end < plan.sampler.spp {
            return Err(Indivisible::Adaptive);
        }
        if self.integrator.may_share(plan) {
            return Err(Indivisible::Sharing);
        }
        u32::try_from(tiles.len()).map_err(|_| Indivisible::OneState)
    }

    fn restrict(&mut self, pieces: Range<u32>) -> Result<(), Indivisible> {
        within(&pieces, self.pieces()?)?;
        self.frame.restrict(pieces);
        Ok(())
    }

    fn join(&mut self, from: &mut dyn Read, pieces: Range<u32>) -> io::Result<()> {
        self.pieces().and_then(|of| within(&pieces, of)).map_err(|_| invalid())?;
        self.frame.join(from, pieces)
    }
}

/// State of a render, whatever the integrator.
#[derive(Debug)]
struct Frame {
    scene: Arc<Scene>,
    /// Scene of the frame before, where layers show how things have moved.
    before: Option<Arc<Scene>>,
    /// Parts that light is kept apart in: groups of lights, numbers of scattering events, or these intervals of its
    /// arrival.
    parts: usize,
    bins: u32,
    /// Bands of wavelengths, where they are kept.
    bands: Option<Arc<Bands>>,
    plan: Plan,
    tiles: Vec<Mutex<Tile>>,
    /// Tiles that are computed here; the others are hollow. All of them, unless the session was restricted.
    pieces: Range<u32>,
    /// True for those that were joined, by tiles; empty where none was.
    joined: Vec<bool>,
    /// Cells of a row of tiles.
    columns: usize,
    /// Samples that cells get in the round, by rows of cells, and the most of them.
    targets: Vec<u32>,
    ticks: u32,
    /// Ticks of the round that are done, by tiles in which groups begin ([`work`]).
    done: Vec<AtomicU32>,
    round: Round,
    /// Samples per pixel, in the mean, of the whole render: those of the plan, or more ([`Session::extend`]).
    total: u32,
    /// Samples per pixel, in the mean, that the steps so far were to reach, and whether all tiles have.
    next: u32,
    is_complete: bool,
    /// Samples per pixel at which the error is estimated next.
    look: u32,
    is_good_enough: bool,
    /// Errors of means over pixels, when the first of several rounds was complete.
    errors_of_first_round: Option<[f64; SCALES.len()]>,
    counters: Counters,
    /// Wall and CPU time.
    time: [Duration; 2],
}

impl Frame {
    /// Without samples.
    fn new(scene: Arc<Scene>, plan: Plan, integrator: &impl GroupIntegrator) -> Self {
        let crop = scene.film().crop;
        let round = Round::first(plan.sampler.spp, plan.adaptive);
        let bins = integrator.bins();
        let parts = if bins > 0 {
            bins as usize
        } else if plan.has(LayerInputs::BOUNCES) {
            bounce_parts(integrator.max_events())
        } else if plan.has(LayerInputs::LIGHT_GROUPS) {
            scene.light_groups().names.len()
        } else {
            0
        };
        let bands = scene.film().bands.clone().filter(|_| plan.has(LayerInputs::BANDS));
        let kept = [parts, bands.as_ref().map_or(0, |bands| bands.count())];
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
                tiles.push(Mutex::new(Tile::new(area, &plan, kept, round.length())));
            }
        }
        let (columns, rows) = (columns.len(), tiles.len() / columns.len().max(1));
        let mut frame = Self {
            scene,
            before: None,
            parts,
            bins,
            bands,
            plan,
            pieces: 0..tiles.len() as u32,
            joined: Vec::new(),
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
            time: [Duration::ZERO; 2],
        };
        frame.set_targets();
        frame.watch_scales();
        frame
    }

    /// Adds the time since a moment.
    fn spent(&mut self, start: Instant, cpu: Duration) {
        self.time[0] += start.elapsed();
        self.time[1] += cpu_time().saturating_sub(cpu);
    }

    /// Decides about the end of the render and the next round, when all tiles are where the steps are.
    fn decide(&mut self, rarest_path_probability: Option<f64>) {
        if let Some(error) = self.plan.error.filter(|_| self.next >= self.look) {
            self.is_good_enough =
                self.error().is_some_and(|e| e <= error) && self.doubt(rarest_path_probability).is_none();
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
                self.set_targets();
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
            self.set_targets();
        }
    }

    /// The place of a tile's cell among those of the picture, by rows.
    fn cell(&self, tile: usize, cell: usize) -> usize {
        let (cells, across) = (CELLS as usize, self.columns / CELLS as usize);
        (tile / across * cells + cell / cells) * self.columns + tile % across * cells + cell % cells
    }

    /// Notes what the tiles' cells are to get in the round.
    fn set_targets(&mut self) {
        self.targets = vec![0; self.tiles.len() * (CELLS * CELLS) as usize];
        for (t, tile) in self.tiles.iter().enumerate() {
            for (c, cell) in lock(tile).cells.iter().enumerate() {
                let at = self.cell(t, c);
                self.targets[at] = cell.target;
            }
        }
        self.ticks = self.targets.iter().copied().max().unwrap_or(0);
    }

    fn squared_errors(&self) -> Option<Sum> {
        let mut sum = Sum::default();
        for tile in &self.tiles {
            for pixels in lock(tile).by_cells(self.round) {
                sum = sum.plus(Sum::of(&pixels)?);
            }
        }
        Some(sum)
    }

    fn error(&self) -> Option<f64> {
        self.squared_errors().map(|sum| sum.relative(self.pixels()))
    }

    /// Reason not to trust the error, if there is one, for the probability that one path of the picture finds the
    /// rarest light.
    fn doubt(&self, rarest_path_probability: Option<f64>) -> Option<Doubt> {
        let paths = self.pixels() as f64 * f64::from(self.next);
        if rarest_path_probability.is_some_and(|probability| probability * paths < FEWEST_FINDS) {
            return Some(Doubt::HardlyFound);
        }
        self.squared_errors().and_then(|sum| sum.doubt())
    }

    /// Number of parts that light is kept apart in, and of bands.
    fn kept(&self) -> [usize; 2] {
        [self.parts, self.bands.as_ref().map_or(0, |bands| bands.count())]
    }

    /// The film as it is.
    fn film(&self) -> Film {
        let crop = self.scene.film().crop;
        let n = crop.width() as usize * crop.height() as usize;
        let kept = self.kept();
        let mut film = Film {
            crop,
            pixels: vec![Pixel::default(); n],
            layers: LayerSums::new(self.plan.inputs, n, kept[0], kept[1]),
            halves: vec![Half::default(); if self.plan.has(LayerInputs::HALVES) { n } else { 0 }],
            bins: self.bins,
            bands: self.bands.clone(),
        };
        for tile in &self.tiles {
            let tile = lock(tile);
            if tile.pixels.is_empty() {
                continue;
            }
            let w = tile.area.width() as usize;
            let pixels: Vec<Pixel> = tile.film(self.round).collect();
            let halves: Vec<Half> = tile.film_halves(self.round).collect();
            for (row, y) in (tile.area.y0..tile.area.y1).enumerate() {
                let to = (y - crop.y0) as usize * crop.width() as usize + (tile.area.x0 - crop.x0) as usize;
                film.pixels[to..to + w].copy_from_slice(&pixels[row * w..(row + 1) * w]);
                let row = row * w..(row + 1) * w;
                if !halves.is_empty() {
                    film.halves[to..to + w].copy_from_slice(&halves[row.clone()]);
                }
                film.layers.copy(to, &tile.layers, row, kept);
            }
        }
        film
    }
}

/// A thread that panicked leaves whole samples behind: the data is sound.
fn lock<T>(m: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    m.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
}
