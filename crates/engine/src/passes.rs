//! Pictures that are the mean of passes: methods that start at lights, or whose paths land on other pixels than their
//! own.
//!
//! A pass is an estimate of the whole picture that is a function of scene, plan and its number alone, independent of
//! all others. So the mean over passes converges, their spread tells the variance of every pixel, a render goes on from
//! sums and a count, and nothing depends on threads. A pass that is cancelled counts for nothing.
//!
//! Passes are summed in blocks, and those in order (`blocks`): blocks can be computed apart and joined (`state`).

use crate::{
    Control, Counters, Doubt, FIRST_LOOK, History, Plan, Session, Stop, cpu_time, dimension,
    estimate::Sum,
    first_hit,
    pieces::{Indivisible, within},
    session::Earlier,
};
use blocks::{Blocks, Shape};
use std::{
    fmt::Debug,
    io::{self, Read, Write},
    ops::Range,
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicUsize, Ordering},
    },
    time::{Duration, Instant},
};
use steradian_core::{
    Scene,
    film::{Film, FirstHit, LayerInputs, PassFilm},
    sampler::{PixelSampler, Sampler},
};
use steradian_math::{Ray, Spectrum, Vec2, Vec3, spectra::Wavelengths};

mod blocks;
mod state;
mod sums;
#[cfg(test)]
mod tests;

/// A method whose pictures are means of passes: estimates of the whole picture that are functions of scene, plan and
/// their number alone, independent of each other.
pub trait Pass: Debug + Send + Sync {
    /// Samples per pixel that a pass counts for.
    fn samples_per_pass(&self) -> u32 {
        1
    }

    /// Finds out what all passes need, before the first one and again after a restore; `None` where that was cancelled.
    fn prepare(&mut self, _run: &Run<'_>) -> Option<()> {
        Some(())
    }

    /// Adds the pass of a number to a black film: an estimate of the whole picture. Counts rays and the samples of a
    /// pass; `None` where it was cancelled.
    fn pass(&self, run: &Run<'_>, number: u32, film: &mut PassFilm<'_>) -> Option<Counters>;

    /// The ray by which layers of a pass see a pixel, and its wavelengths and moment.
    fn first_ray(&self, run: &Run<'_>, [x, y]: [u32; 2], number: u32) -> (Ray, Wavelengths) {
        let sample = run.camera_sample(x, y, number);
        (sample.ray, sample.lambda)
    }

    /// Hands over what the next picture of a sequence can go on from.
    fn take_history(&mut self, _scene: &Arc<Scene>) -> Option<History> {
        None
    }

    /// Goes on from the picture before; before the first pass.
    fn follow(&mut self, _history: &History) {}

    /// Notes on the picture so far.
    fn notes(&self) -> Vec<String> {
        Vec::new()
    }

    /// Reason why passes are not independent of each other after all, if so.
    fn indivisible(&self) -> Option<Indivisible> {
        None
    }

    /// Reason why no more passes can be taken, if so.
    fn failure(&self) -> Option<String> {
        None
    }
}

/// Inputs of a pass.
#[derive(Clone, Copy, Debug)]
pub struct Run<'s> {
    /// The scene.
    pub scene: &'s Scene,
    /// Random numbers; its `spp` is the number of passes.
    pub sampler: Sampler,
    /// Threads that work.
    pub threads: usize,
    /// Whoever watches.
    pub control: &'s Control,
}

impl<'s> Run<'s> {
    /// True if the work is to end.
    pub fn is_cancelled(&self) -> bool {
        self.control.cancel.load(Ordering::Relaxed)
    }

    /// Does pieces of work on all threads; what they found, in the order of the pieces, and what was counted. `None`
    /// where it was cancelled: what was asked for meanwhile counts for nothing, so that work may break off anywhere.
    pub fn in_order<T: Send>(
        &self,
        pieces: usize,
        work: impl Fn(usize, &mut Counters) -> T + Sync,
    ) -> Option<(Vec<T>, Counters)> {
        let next = AtomicUsize::new(0);
        let all = Mutex::new((Vec::with_capacity(pieces), Counters::default()));
        let run = || {
            let (mut found, mut counters) = (Vec::new(), Counters::default());
            while !self.is_cancelled() {
                let piece = next.fetch_add(1, Ordering::Relaxed);
                if piece >= pieces {
                    break;
                }
                let mut mine = Counters::until(&Stop::by(&self.control.cancel));
                let one = work(piece, &mut mine);
                if self.is_cancelled() {
                    break;
                }
                found.push((piece, one));
                self.control.rays.fetch_add(mine.rays, Ordering::Relaxed);
                self.control.samples.fetch_add(mine.samples, Ordering::Relaxed);
                counters += &mine;
            }
            let mut all = all.lock().unwrap_or_else(PoisonError::into_inner);
            all.0.append(&mut found);
            all.1 += &counters;
        };
        std::thread::scope(|scope| {
            for _ in 1..self.threads.min(pieces) {
                scope.spawn(run);
            }
            run();
        });
        let (mut found, counters) = all.into_inner().unwrap_or_else(PoisonError::into_inner);
        found.sort_unstable_by_key(|f| f.0);
        (found.len() == pieces).then(|| (found.into_iter().map(|f| f.1).collect(), counters))
    }

    /// The camera sample of a pixel in a pass.
    pub fn camera_sample(&self, x: u32, y: u32, number: u32) -> CameraSample {
        let (scene, film) = (self.scene, self.scene.film());
        let sampler = self.sampler.pixel(x, y, number);
        let (offset, weight) = film.filter.sample(sampler.get_2d(dimension::FILM));
        let at = Vec2::new(x as f32 + 0.5, y as f32 + 0.5) + offset;
        let lens = sampler.get_2d(dimension::LENS);
        let ray = scene.camera().ray(film, at, if scene.camera().lens_radius > 0.0 { lens } else { Vec2::splat(0.5) });
        let lambda = self.wavelengths(&sampler);
        CameraSample { at, ray, sampler, lambda, weight }
    }

    /// Wavelengths and moment of a path.
    pub fn wavelengths(&self, sampler: &PixelSampler) -> Wavelengths {
        let lambda = self.scene.mode().wavelengths(|| sampler.get_1d(dimension::WAVELENGTH));
        if self.scene.is_timed() { lambda.at_time(sampler.get_1d(dimension::TIME)) } else { lambda }
    }

    /// Radiance as the film has it.
    pub fn developed(&self, radiance: Spectrum, lambda: &Wavelengths) -> Vec3 {
        self.scene.film().developed(radiance, lambda, self.scene.mode())
    }
}

/// A camera ray, and what its path starts with.
#[derive(Clone, Copy, Debug)]
pub struct CameraSample {
    /// Place on the full frame, pixels.
    pub at: Vec2,
    /// The ray.
    pub ray: Ray,
    /// The path's random numbers.
    pub sampler: PixelSampler,
    /// Its wavelengths and moment.
    pub lambda: Wavelengths,
    /// Weight in the pixel: filter over density.
    pub weight: f32,
}

/// A render by passes, under way.
#[derive(Debug)]
pub struct Passes<P> {
    scene: Arc<Scene>,
    /// Scene of the frame before, where layers show how things have moved.
    before: Option<Arc<Scene>>,
    plan: Plan,
    integrator: P,
    is_prepared: bool,
    blocks: Blocks,
    /// Samples per pixel of the whole render: those of the plan, or more.
    total: u32,
    /// Passes at which the error is looked at next.
    look: u32,
    is_good_enough: bool,
    counters: Counters,
    time: [Duration; 2],
}

impl<P: Pass> Passes<P> {
    /// Starts with an empty film. Of the plan counts all but `adaptive`: passes are of the whole picture.
    pub fn new(scene: Arc<Scene>, integrator: P, plan: Plan) -> Self {
        let n = scene.film().crop.width() as usize * scene.film().crop.height() as usize;
        let groups = if plan.has(LayerInputs::LIGHT_GROUPS) { scene.light_groups().names.len() } else { 0 };
        let shape = Shape { pixels: n, groups, inputs: plan.inputs };
        let passes = plan.sampler.spp.div_ceil(integrator.samples_per_pass().max(1));
        Self {
            total: plan.sampler.spp,
            scene,
            before: None,
            plan,
            integrator,
            is_prepared: false,
            blocks: Blocks::new(shape, passes),
            look: FIRST_LOOK,
            is_good_enough: false,
            counters: Counters::default(),
            time: [Duration::ZERO; 2],
        }
    }

    /// Takes passes until there are `samples` per pixel or more.
    fn advance(&mut self, samples: u32, control: &Control) -> Option<()> {
        let (per_pass, threads) = (self.integrator.samples_per_pass().max(1), self.plan.threads());
        let sampler = Sampler { spp: self.plan.sampler.spp.div_ceil(per_pass), ..self.plan.sampler };
        let scene = Arc::clone(&self.scene);
        let mut run = Run { scene: &scene, sampler, threads, control };
        if !self.is_prepared {
            self.integrator.prepare(&run)?;
            self.is_prepared = true;
        }
        while self.samples() < samples && !self.is_good_enough {
            let (pass, groups) = (self.blocks.next(), self.blocks.shape.groups);
            let has_halves = self.plan.has(LayerInputs::HALVES);
            let number = if has_halves { pass / 2 } else { pass };
            if has_halves {
                run.sampler = sampler.half(pass);
            }
            let mut film = PassFilm::new(scene.film(), groups);
            let done = self.integrator.pass(&run, number, &mut film)?;
            let hits = self.first_hits(&run, number)?;
            self.counters += &done;
            self.counters.nonfinite += film.nonfinite();
            self.blocks.add(&film, &hits);
            let passes = self.blocks.passes();
            if let Some(error) = self.plan.error.filter(|_| passes >= self.look) {
                self.is_good_enough = self.error().is_some_and(|e| e <= error) && self.doubt().is_none();
                self.look = self.look.saturating_add(self.look / 4);
            }
        }
        Some(())
    }

    /// First hits of the pass's camera rays, by rows; none where no layer depends on them.
    fn first_hits(&self, run: &Run<'_>, number: u32) -> Option<Vec<Vec<FirstHit>>> {
        if !self.blocks.shape.has_hits() {
            return Some(Vec::new());
        }
        let (crop, sight) = (self.scene.film().crop, self.plan.sight());
        let before = self.before.as_deref();
        let (rows, _) = run.in_order(crop.height() as usize, |row, _| {
            let hit = |x| {
                let (ray, lambda) = self.integrator.first_ray(run, [x, crop.y0 + row as u32], number);
                first_hit(run.scene, ray, &lambda, sight, before)
            };
            (crop.x0..crop.x1).map(hit).collect::<Vec<_>>()
        })?;
        Some(rows)
    }

    fn squared_errors(&self) -> Option<Sum> {
        let width = self.scene.film().crop.width() as usize;
        if self.blocks.passes() < 2 { None } else { Sum::of_rows(&self.blocks.pixels(), width) }
    }

    /// Passes that the session takes.
    fn all_passes(&self) -> u32 {
        let all = self.total.div_ceil(self.integrator.samples_per_pass().max(1));
        self.blocks.part().map_or(all, |part| part.len() as u32)
    }
}

impl<P: Pass> Session for Passes<P> {
    fn step(&mut self, samples: u32, control: &Control) {
        if self.blocks.is_joining() || self.blocks.is_joined() && self.is_done() {
            return;
        }
        let (start, cpu) = (Instant::now(), cpu_time());
        let all = self.all_passes().saturating_mul(self.integrator.samples_per_pass().max(1));
        let goal = self.samples().saturating_add(samples).min(all);
        // What was cancelled is done anew by the next step.
        let _complete = self.advance(goal, control);
        self.time[0] += start.elapsed();
        self.time[1] += cpu_time().saturating_sub(cpu);
    }

    fn threads(&self) -> usize {
        self.plan.threads()
    }

    fn extend(&mut self, samples: u32) -> bool {
        let is_more = samples >= self.total && self.blocks.part().is_none();
        if is_more {
            self.total = samples;
        }
        is_more
    }

    fn samples(&self) -> u32 {
        self.blocks.passes().saturating_mul(self.integrator.samples_per_pass().max(1))
    }

    fn is_done(&self) -> bool {
        self.blocks.passes() >= self.all_passes() || self.is_good_enough || self.integrator.failure().is_some()
    }

    fn is_good_enough(&self) -> bool {
        self.is_good_enough
    }

    fn error(&self) -> Option<f64> {
        self.squared_errors().map(|sum| sum.relative(self.blocks.shape.pixels))
    }

    fn doubt(&self) -> Option<Doubt> {
        self.squared_errors().and_then(|sum| sum.doubt())
    }

    fn counters(&self) -> Counters {
        let mut counters = Counters::default();
        counters += &self.counters;
        counters
    }

    fn time(&self) -> [Duration; 2] {
        self.time
    }

    fn take_history(&mut self) -> Option<History> {
        let own = self.integrator.take_history(&self.scene);
        match self.plan.has(LayerInputs::MOTION) {
            true => Some(History(Arc::new(Earlier { scene: Arc::clone(&self.scene), own }))),
            false => own,
        }
    }

    fn follow(&mut self, history: &History) {
        let earlier = Earlier::of(history, &self.scene).filter(|_| self.plan.has(LayerInputs::MOTION));
        self.before = earlier.as_ref().map(|earlier| Arc::clone(&earlier.scene));
        match &earlier {
            Some(earlier) => earlier.own.iter().for_each(|own| self.integrator.follow(own)),
            None => self.integrator.follow(history),
        }
    }

    fn notes(&self) -> Vec<String> {
        self.integrator.notes()
    }

    fn failure(&self) -> Option<String> {
        self.integrator.failure()
    }

    fn film(&self) -> Film {
        self.blocks.film(self.scene.film().crop)
    }

    fn save(&mut self, out: &mut dyn Write) -> io::Result<()> {
        self.save_state(out)
    }

    fn restore(&mut self, from: &mut dyn Read) -> io::Result<()> {
        self.restore_state(from)
    }

    fn pieces(&self) -> Result<u32, Indivisible> {
        match self.integrator.indivisible() {
            _ if self.plan.error.is_some() => Err(Indivisible::Error),
            Some(why) => Err(why),
            None => Ok(self.blocks.count()),
        }
    }

    fn restrict(&mut self, pieces: Range<u32>) -> Result<(), Indivisible> {
        within(&pieces, self.pieces()?)?;
        self.blocks.restrict(pieces);
        (self.total, self.look, self.is_good_enough) = (self.plan.sampler.spp, FIRST_LOOK, false);
        (self.counters, self.time) = (Counters::default(), [Duration::ZERO; 2]);
        Ok(())
    }

    fn join(&mut self, from: &mut dyn Read, pieces: Range<u32>) -> io::Result<()> {
        self.join_state(from, pieces)
    }
}
