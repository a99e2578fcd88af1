//! A render under way.

use crate::frame::Shown;
use std::{
    sync::{
        Arc, Condvar, Mutex, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    thread,
    time::{Duration, Instant},
};
use steradian::{Control, Quality, Scene, Session};

/// How often it is looked whether something else was asked.
const LOOK_EVERY: Duration = Duration::from_millis(4);

/// A render under way.
pub struct Job {
    scene: Arc<Scene>,
    session: Box<dyn Session>,
    spp: u32,
    pixels: u64,
    /// How much longer than asked a step may take, where methods lose what they break off.
    patience: u32,
}

impl Job {
    /// Starts one.
    ///
    /// # Errors
    /// Why there is none.
    pub fn new(scene: &Arc<Scene>, quality: &Quality) -> Result<Self, String> {
        let render = quality.render(scene).map_err(|e| e.to_string())?;
        let session = render.session(scene).map_err(|e| e.to_string())?;
        let crop = scene.film().crop;
        let pixels = u64::from(crop.width()) * u64::from(crop.height());
        Ok(Self { scene: Arc::clone(scene), session, spp: render.plan.sampler.spp, pixels, patience: 1 })
    }

    /// Renders to the end.
    pub fn run(&mut self) {
        self.session.step(u32::MAX, &Control::default());
    }

    /// Renders for a time, or until it is interrupted. The first step of a method that counts nothing until it is whole
    /// takes longer.
    pub fn advance(&mut self, time: Duration, interrupt: &Arc<AtomicBool>) {
        let time = time * self.patience;
        let before = self.session.counters().samples;
        let per_second = before as f64 / self.session.wall().as_secs_f64().max(1e-3);
        let samples = (per_second * time.as_secs_f64() / self.pixels.max(1) as f64).clamp(1.0, 65536.0);
        let control = Control::default();
        let ended = Ended::default();
        thread::scope(|scope| {
            let (cancel, trials, ended) = (&control.cancel, &control.trials, &ended);
            scope.spawn(move || {
                let start = Instant::now();
                while !ended.within(LOOK_EVERY) {
                    // Trials that are broken off begin anew.
                    let is_up = start.elapsed() >= time && !trials.load(Ordering::Relaxed);
                    if is_up || interrupt.load(Ordering::Relaxed) {
                        cancel.store(true, Ordering::Relaxed);
                        return;
                    }
                }
            });
            self.session.step(samples as u32, &control);
            ended.tell();
        });
        let is_stuck = self.session.counters().samples == before && !interrupt.load(Ordering::Relaxed);
        self.patience = if is_stuck { self.patience.saturating_mul(2).min(1 << 12) } else { self.patience };
    }

    /// Whether all is done.
    pub fn is_done(&self) -> bool {
        self.session.is_done()
    }

    /// Why it does not go on.
    pub fn failure(&self) -> Option<String> {
        self.session.failure()
    }

    /// Time spent, seconds.
    pub fn seconds(&self) -> f64 {
        self.session.wall().as_secs_f64()
    }

    /// The picture as it is.
    pub fn shown(&self, generation: u32, crop: [u32; 4], kind: &'static str) -> Shown {
        let done = self.session.counters();
        Shown {
            generation,
            crop,
            kind,
            scene: Arc::clone(&self.scene),
            film: self.session.film(),
            samples: done.samples as f64 / self.pixels.max(1) as f64,
            target: self.spp,
            // Of a step that was broken off parts are missing.
            error: self.session.error().filter(|_| done.samples >= u64::from(self.session.samples()) * self.pixels),
            seconds: self.seconds(),
            is_done: self.is_done(),
            nonfinite: done.nonfinite,
            denoised: None,
        }
    }
}

/// That a step has ended.
#[derive(Default)]
struct Ended(Mutex<bool>, Condvar);

impl Ended {
    fn tell(&self) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = true;
        self.1.notify_all();
    }

    /// Whether it ends within a time.
    fn within(&self, time: Duration) -> bool {
        let ended = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let waited = self.1.wait_timeout_while(ended, time, |ended| !*ended);
        *waited.unwrap_or_else(PoisonError::into_inner).0
    }
}
