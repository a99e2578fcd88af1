//! Pictures that are the mean of passes: methods that start at lights, or whose paths land on other pixels than their
//! own.
//!
//! A pass is an estimate of the whole picture that is a function of scene, plan and its number alone, independent of
//! all others. So the mean over passes converges, their spread tells the variance of every pixel, a render goes on from
//! sums and a count, and nothing depends on threads. A pass that is cancelled counts for nothing.

use crate::{
    Control, Counters, Doubt, FIRST_LOOK, History, Plan, Session, Stop, cpu_time, dimension,
    estimate::Sum,
    first_hit,
    session::Earlier,
    state::{Codec, In, Out, State},
    state_checks,
};
use std::{
    fmt::Debug,
    io::{self, Error, ErrorKind, Read, Write},
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicUsize, Ordering},
    },
    time::{Duration, Instant},
};
use steradian_core::{
    Scene,
    film::{Film, Half, LayerInputs, LayerSums, PassFilm, Pixel},
    sampler::{PixelSampler, Sampler},
};
use steradian_math::{Ray, Spectrum, Vec2, Vec3, spectra::Wavelengths};

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
    pixels: Vec<Pixel>,
    layers: LayerSums,
    /// Sums of passes of even number, by pixels; empty where they are not kept.
    even: Vec<[f64; 3]>,
    /// Samples per pixel of the whole render: those of the plan, or more.
    total: u32,
    /// Passes that are in the film.
    passes: u32,
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
        Self {
            total: plan.sampler.spp,
            scene,
            before: None,
            plan,
            integrator,
            is_prepared: false,
            pixels: vec![Pixel::default(); n],
            layers: LayerSums::new(plan.inputs, n, groups),
            even: vec![[0.0; 3]; if plan.has(LayerInputs::HALVES) { n } else { 0 }],
            passes: 0,
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
            let has_halves = self.plan.has(LayerInputs::HALVES);
            let number = if has_halves { self.passes / 2 } else { self.passes };
            if has_halves {
                run.sampler = sampler.half(self.passes);
            }
            let mut film = PassFilm::new(scene.film(), self.layers.by_light.len() / self.pixels.len().max(1));
            let done = self.integrator.pass(&run, number, &mut film)?;
            self.first_hits(&run, number)?;
            self.counters += &done;
            self.counters.nonfinite += film.nonfinite();
            for (pixel, sum) in self.pixels.iter_mut().zip(film.sums()) {
                pixel.add_value(*sum);
            }
            if self.passes.is_multiple_of(2) {
                for (even, sum) in self.even.iter_mut().zip(film.sums()) {
                    *even = std::array::from_fn(|c| even[c] + sum[c]);
                }
            }
            for (sum, light) in self.layers.by_light.iter_mut().zip(film.by_light()) {
                *sum = std::array::from_fn(|c| sum[c] + light[c]);
            }
            self.passes += 1;
            if let Some(error) = self.plan.error.filter(|_| self.passes >= self.look) {
                self.is_good_enough = self.error().is_some_and(|e| e <= error) && self.doubt().is_none();
                self.look = self.look.saturating_add(self.look / 4);
            }
        }
        Some(())
    }

    /// Adds what the pass's camera rays see first.
    fn first_hits(&mut self, run: &Run<'_>, number: u32) -> Option<()> {
        if self.layers.ignore_hits() {
            return Some(());
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
        rows.iter().flatten().enumerate().for_each(|(at, hit)| self.layers.add_hit(at, hit));
        Some(())
    }

    fn pass_state(&mut self, codec: &mut impl Codec) -> io::Result<()> {
        self.total.pass(codec)?;
        self.passes.pass(codec)?;
        self.look.pass(codec)?;
        self.is_good_enough.pass(codec)?;
        self.counters.pass(codec)?;
        self.time.pass(codec)?;
        self.pixels.pass(codec)?;
        self.layers.pass(codec)?;
        self.even.pass(codec)
    }
}

impl<P: Pass> Passes<P> {
    fn squared_errors(&self) -> Option<Sum> {
        let width = self.scene.film().crop.width() as usize;
        if self.passes < 2 { None } else { Sum::of_rows(&self.pixels, width) }
    }
}

impl<P: Pass> Session for Passes<P> {
    fn step(&mut self, samples: u32, control: &Control) {
        let (start, cpu) = (Instant::now(), cpu_time());
        let goal = self.samples().saturating_add(samples).min(self.total);
        // What was cancelled is done anew by the next step.
        let _complete = self.advance(goal, control);
        self.time[0] += start.elapsed();
        self.time[1] += cpu_time().saturating_sub(cpu);
    }

    fn threads(&self) -> usize {
        self.plan.threads()
    }

    fn extend(&mut self, samples: u32) -> bool {
        let is_more = samples >= self.total;
        self.total = self.total.max(samples);
        is_more
    }

    fn samples(&self) -> u32 {
        self.passes.saturating_mul(self.integrator.samples_per_pass().max(1))
    }

    fn is_done(&self) -> bool {
        self.samples() >= self.total || self.is_good_enough || self.integrator.failure().is_some()
    }

    fn is_good_enough(&self) -> bool {
        self.is_good_enough
    }

    fn error(&self) -> Option<f64> {
        self.squared_errors().map(|sum| sum.relative(self.pixels.len()))
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
        Film {
            crop: self.scene.film().crop,
            pixels: self.pixels.clone(),
            layers: self.layers.clone(),
            halves: self
                .even
                .iter()
                .zip(&self.pixels)
                .map(|(sum, p)| Half::of(*sum, p.samples.div_ceil(2), p))
                .collect(),
            bins: 0,
        }
    }

    fn save(&mut self, out: &mut dyn Write) -> io::Result<()> {
        self.pass_state(&mut Out(out))
    }

    fn restore(&mut self, from: &mut dyn Read) -> io::Result<()> {
        self.pass_state(&mut In(from))?;
        let (plan, passes) = (&self.plan, self.passes);
        let is_sound = state_checks::is_total(self.total, plan.sampler.spp)
            && passes <= self.total.div_ceil(self.integrator.samples_per_pass().max(1))
            && state_checks::is_look(self.look, passes, plan.error)
            && !(self.is_good_enough && plan.error.is_none())
            && state_checks::are_counters(&self.counters)
            && self.pixels.iter().all(|p| p.samples == passes && state_checks::is_pixel(p))
            && self.layers.features.iter().all(|sums| sums.samples == passes && state_checks::are_hits(sums))
            && self.layers.mattes.iter().all(|sums| sums.samples == passes && state_checks::are_mattes(sums))
            && self.even.iter().flatten().all(|sum| sum.abs() <= f64::from(passes) * f64::from(f32::MAX))
            && self.layers.by_light.iter().flatten().all(|sum| sum.abs() <= f64::from(passes) * f64::from(f32::MAX));
        if is_sound { Ok(()) } else { Err(Error::from(ErrorKind::InvalidData)) }
    }
}
