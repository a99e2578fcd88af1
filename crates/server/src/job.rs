//! A render under way.

use crate::{frame::Shown, protocol::FrameKind};
use std::{
    sync::{
        Arc, Condvar, Mutex, PoisonError,
        atomic::{AtomicUsize, Ordering},
    },
    thread,
    time::{Duration, Instant},
};
use steradian::{Control, Quality, Scene, Session};

/// Interval between looks for another task.
const LOOK_EVERY: Duration = Duration::from_millis(4);

/// Progress of a render: its samples, and whether it is done. Renders of the same progress show the same picture.
pub type Progress = (u64, bool);

/// A render under way.
pub struct Job {
    scene: Arc<Scene>,
    session: Box<dyn Session>,
    spp: u32,
    pixels: u64,
    /// Factor on the time of a step, for methods that lose what they break off.
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

    /// Renders to the end, or until tasks wait once a time is over; whether to the end.
    pub fn run(&mut self, time: Duration, waiting: &Waiting) -> bool {
        self.step(u32::MAX, |elapsed, _| elapsed >= time && waiting.is_any());
        self.is_done()
    }

    /// Renders for a time, or until tasks wait. The first step of a method that counts nothing until it is whole takes
    /// longer.
    pub fn advance(&mut self, time: Duration, waiting: &Waiting) {
        let time = time * self.patience;
        let before = self.session.counters().samples;
        let per_second = before as f64 / self.session.wall().as_secs_f64().max(1e-3);
        let samples = (per_second * time.as_secs_f64() / self.pixels.max(1) as f64).clamp(1.0, 65536.0);
        // Trials that are broken off begin anew.
        self.step(samples as u32, |elapsed, is_trying| (elapsed >= time && !is_trying) || waiting.is_any());
        let is_stuck = self.session.counters().samples == before && !waiting.is_any();
        self.patience = if is_stuck { self.patience.saturating_mul(2).min(1 << 12) } else { self.patience };
    }

    /// Takes samples until it is to stop, which is asked with the time so far and whether trials are under way.
    fn step(&mut self, samples: u32, stop: impl Fn(Duration, bool) -> bool + Sync) {
        let control = Control::default();
        let ended = Ended::default();
        thread::scope(|scope| {
            let (cancel, trials, ended, stop) = (&control.cancel, &control.trials, &ended, &stop);
            scope.spawn(move || {
                let start = Instant::now();
                while !ended.within(LOOK_EVERY) {
                    if stop(start.elapsed(), trials.load(Ordering::Relaxed)) {
                        cancel.store(true, Ordering::Relaxed);
                        return;
                    }
                }
            });
            self.session.step(samples, &control);
            ended.tell();
        });
    }

    /// Takes samples of each pixel.
    #[cfg(test)]
    pub fn take(&mut self, samples: u32, control: &Control) {
        self.session.step(samples, control);
    }

    /// Progress.
    pub fn progress(&self) -> Progress {
        (self.session.counters().samples, self.is_done())
    }

    /// True if the render is done.
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
    pub fn shown(&self, generation: u32, crop: [u32; 4], kind: FrameKind) -> Shown {
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

/// Number of tasks that wait for the thread that renders.
#[derive(Clone, Debug, Default)]
pub struct Waiting(Arc<AtomicUsize>);

impl Waiting {
    /// One more is about to be sent.
    pub fn add(&self) {
        self.0.fetch_add(1, Ordering::SeqCst);
    }

    /// One was received.
    pub fn remove(&self) {
        self.0.fetch_sub(1, Ordering::SeqCst);
    }

    /// True if a task waits.
    pub fn is_any(&self) -> bool {
        self.0.load(Ordering::SeqCst) > 0
    }
}

/// Signal that a step has ended.
#[derive(Default)]
struct Ended(Mutex<bool>, Condvar);

impl Ended {
    fn tell(&self) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = true;
        self.1.notify_all();
    }

    /// Waits for the end for a time at most; true if it came.
    fn within(&self, time: Duration) -> bool {
        let ended = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let waited = self.1.wait_timeout_while(ended, time, |ended| !*ended);
        *waited.unwrap_or_else(PoisonError::into_inner).0
    }
}
