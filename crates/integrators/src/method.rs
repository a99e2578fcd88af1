//! The boundary of sessions: what a session runs, whatever computes the picture.

use crate::{
    Control, Counters, Doubt, Film, IntegratorKind, Plan, Precomputed, SCALES, passes::Passes,
    session::Session as Tiles,
};
use std::{
    fmt::Debug,
    io::{self, Read, Write},
    time::Duration,
};
use steradian_core::Scene;

/// A way to compute a picture, under way: it advances in steps, tells of its progress, stops when asked, and can be
/// saved and gone on with. What it computes does not depend on the number of threads, nor on the steps.
pub trait Method: Debug + Send {
    /// Takes further samples of every pixel, up to those of the plan; fewer where `control` cancels.
    fn step(&mut self, samples: u32, control: &Control);

    /// Does without trials that did not come to an end. `false`, and nothing is changed, where there are none, or none
    /// that can be left out.
    fn skip_trials(&mut self) -> bool {
        false
    }

    /// Goes on to more samples per pixel than the plan has. `false`, and nothing is changed, where that cannot be, or
    /// where there are to be more already.
    fn extend(&mut self, _samples: u32) -> bool {
        false
    }

    /// Threads that a step uses.
    fn threads(&self) -> usize;

    /// Samples that a pixel has, in the mean, when the steps so far are complete.
    fn samples(&self) -> u32;

    /// Whether the plan is carried out.
    fn is_done(&self) -> bool;

    /// Whether the plan's error was reached.
    fn is_good_enough(&self) -> bool;

    /// Whether parts of the picture get more samples than others.
    fn is_uneven(&self) -> bool {
        false
    }

    /// Whether photons guide paths towards caustics.
    fn asks_photons(&self) -> bool {
        false
    }

    /// How many paths of neighbouring pixels share what they find.
    fn sharing(&self) -> u32 {
        1
    }

    /// The estimated relative error of the picture ([`Session::error`]).
    fn error(&self) -> Option<f64>;

    /// Why that error is not to be trusted ([`Session::doubt`]), if so.
    fn doubt(&self) -> Option<Doubt> {
        None
    }

    /// Errors of means over pixels ([`Session::errors_of_means`]), where they are watched.
    fn errors_of_means(&self) -> Option<[f64; SCALES.len()]> {
        None
    }

    /// What was done so far.
    fn counters(&self) -> Counters;

    /// Wall and CPU time spent in steps.
    fn time(&self) -> [Duration; 2];

    /// The film as it is.
    fn film(&self) -> Film;

    /// Writes what it takes to go on later.
    ///
    /// # Errors
    /// Those of the writer.
    fn save(&mut self, out: &mut dyn Write) -> io::Result<()>;

    /// Goes on from what another one of the same scene and plan saved.
    ///
    /// # Errors
    /// Those of the reader, and [`io::ErrorKind::InvalidData`] where no such state can have been.
    fn restore(&mut self, from: &mut dyn Read) -> io::Result<()>;
}

impl Method for Tiles<'_> {
    fn step(&mut self, samples: u32, control: &Control) {
        self.step(samples, control);
    }

    fn skip_trials(&mut self) -> bool {
        self.skip_trials()
    }

    fn extend(&mut self, samples: u32) -> bool {
        self.extend(samples)
    }

    fn threads(&self) -> usize {
        self.threads()
    }

    fn samples(&self) -> u32 {
        self.samples()
    }

    fn is_done(&self) -> bool {
        self.is_done()
    }

    fn is_good_enough(&self) -> bool {
        self.is_good_enough()
    }

    fn is_uneven(&self) -> bool {
        self.is_uneven()
    }

    fn asks_photons(&self) -> bool {
        self.asks_photons()
    }

    fn sharing(&self) -> u32 {
        self.sharing()
    }

    fn error(&self) -> Option<f64> {
        self.error()
    }

    fn doubt(&self) -> Option<Doubt> {
        self.doubt()
    }

    fn errors_of_means(&self) -> Option<[f64; SCALES.len()]> {
        self.errors_of_means()
    }

    fn counters(&self) -> Counters {
        self.counters()
    }

    fn time(&self) -> [Duration; 2] {
        [self.wall(), self.cpu()]
    }

    fn film(&self) -> Film {
        self.film()
    }

    fn save(&mut self, out: &mut dyn Write) -> io::Result<()> {
        self.save(out)
    }

    fn restore(&mut self, from: &mut dyn Read) -> io::Result<()> {
        self.restore(from)
    }
}

/// A render in progress, by whatever method.
#[derive(Debug)]
pub struct Session<'s>(Box<dyn Method + 's>);

impl<'s> Session<'s> {
    /// Starts with an empty film.
    pub fn new(scene: &'s Scene, plan: Plan) -> Self {
        match &plan.integrator {
            IntegratorKind::Passes(kind) => Self::of(Passes::new(scene, kind.integrator(), plan)),
            _ => Self::of(Tiles::new(scene, plan)),
        }
    }

    /// Starts with an empty film, and with what is known of the scene already; methods that work by passes find out for
    /// themselves.
    pub fn with_precomputed(scene: &'s Scene, plan: Plan, precomputed: Precomputed) -> Self {
        match &plan.integrator {
            IntegratorKind::Passes(_) => Self::new(scene, plan),
            _ => Self::of(Tiles::with_precomputed(scene, plan, precomputed)),
        }
    }

    /// Of a method that is not in the registry.
    pub fn of(method: impl Method + 's) -> Self {
        Self(Box::new(method))
    }

    /// Threads that a step uses.
    pub fn threads(&self) -> usize {
        self.0.threads()
    }

    /// Takes further samples of every pixel, up to the plan's number or error; fewer where `control` cancels. What a
    /// cancelled step did not reach is caught up by the next one.
    pub fn step(&mut self, samples: u32, control: &Control) {
        self.0.step(samples, control);
    }

    /// Does without trials that a cancelled step did not finish, so that the next one takes samples at once; they may
    /// be noisier. `false`, and nothing is changed, where there are none that can be left out.
    pub fn skip_trials(&mut self) -> bool {
        self.0.skip_trials()
    }

    /// Goes on to more samples per pixel than the plan has; those that are there stay, and the further ones are
    /// independent of them. `false`, and nothing is changed, where there are to be more already.
    pub fn extend(&mut self, samples: u32) -> bool {
        self.0.extend(samples)
    }

    /// Samples that a pixel has, in the mean, when the steps so far are complete.
    pub fn samples(&self) -> u32 {
        self.0.samples()
    }

    /// Whether the plan is carried out: all samples are taken, or the error is small enough.
    pub fn is_done(&self) -> bool {
        self.0.is_done()
    }

    /// Whether the plan's error was reached.
    pub fn is_good_enough(&self) -> bool {
        self.0.is_good_enough()
    }

    /// Whether parts of the picture get more samples than others, as the plan's `adaptive` allows.
    pub fn is_uneven(&self) -> bool {
        self.0.is_uneven()
    }

    /// Whether photons guide paths towards caustics.
    pub fn asks_photons(&self) -> bool {
        self.0.asks_photons()
    }

    /// The estimated relative error of the picture: the square root of the mean, over pixels and channels, of the
    /// variance of the pixel over `I² + 0.01`, which is the root of what the metric relMSE expects. Variances are those
    /// of independent samples: with a sampler that spreads them well the true error is smaller. `None` before all
    /// pixels have two samples.
    pub fn error(&self) -> Option<f64> {
        self.0.error()
    }

    /// Why [`Self::error`] is not to be trusted, if so: light arrives by paths that are hardly ever found.
    pub fn doubt(&self) -> Option<Doubt> {
        self.0.doubt()
    }

    /// How many paths of neighbouring pixels share what they find.
    pub fn sharing(&self) -> u32 {
        self.0.sharing()
    }

    /// The estimated relative errors of means over squares of pixels, of the edges [`SCALES`]; `None` where they are
    /// not watched.
    pub fn errors_of_means(&self) -> Option<[f64; SCALES.len()]> {
        self.0.errors_of_means()
    }

    /// What was done so far.
    pub fn counters(&self) -> Counters {
        self.0.counters()
    }

    /// Wall time spent in steps.
    pub fn wall(&self) -> Duration {
        self.0.time()[0]
    }

    /// CPU time spent in steps.
    pub fn cpu(&self) -> Duration {
        self.0.time()[1]
    }

    /// The film as it is.
    pub fn film(&self) -> Film {
        self.0.film()
    }

    /// Writes what it takes to go on later. Not while a step is under way, which `&mut` sees to.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn save(&mut self, out: &mut dyn Write) -> io::Result<()> {
        self.0.save(out)
    }

    /// Goes on from what another session of the same scene and plan [saved](Self::save); the picture then has the bits
    /// of one that was never left. How many threads there are may differ.
    ///
    /// # Errors
    /// Those of the reader, and [`io::ErrorKind::InvalidData`] where no such session can have been; the session is of
    /// no use then.
    pub fn restore(&mut self, from: &mut dyn Read) -> io::Result<()> {
        self.0.restore(from)
    }
}
