//! Rendering under watch: samples in passes, while another thread shows progress and ends it on time or on a signal.

use crate::{
    progress::{Progress, Snapshot},
    signals::Signals,
};
use std::{
    sync::{
        OnceLock,
        atomic::{AtomicBool, Ordering},
    },
    thread::{self, Thread},
    time::{Duration, Instant},
};
use steradian::{Control, Session};

/// How often the watcher looks.
const LOOK_EVERY: Duration = Duration::from_millis(50);
/// How often it is kept.
const KEEP_EVERY: Duration = Duration::from_secs(30);
/// How long a thread may take for a tile: the render ends at the next one.
const TILE_SECONDS: f64 = 0.1;
/// Pixels of a tile.
const TILE_PIXELS: f64 = 256.0;

/// Why a render ended before all samples were taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stop {
    /// The time was up.
    Time,
    /// The error is as small as asked for.
    Error,
    /// A signal came.
    Signal(u8),
}

/// Time beyond the budget for a picture without trials, where these took all of it.
const GRACE: Duration = Duration::from_secs(1);

/// Takes all samples of the plan, or those that the time and the user allow; lets it be kept on the way. Where the time
/// is up before the first sample, there is some more for a picture without trials.
pub fn render(
    session: &mut Session<'_>,
    (pixels, planned): (u64, u64),
    budget: Option<Duration>,
    signals: &Signals,
    progress: impl Fn() -> Progress,
    mut keep: impl FnMut(&mut Session<'_>),
) -> Option<Stop> {
    let stop = samples(session, (pixels, planned), budget, signals, progress(), &mut keep);
    let is_empty = session.counters().samples == 0;
    if !(is_empty && matches!(stop, Some(Stop::Time)) && session.skip_trials()) {
        return stop;
    }
    samples(session, (pixels, planned), Some(GRACE), signals, progress(), &mut keep)
}

fn samples(
    session: &mut Session<'_>,
    (pixels, planned): (u64, u64),
    budget: Option<Duration>,
    signals: &Signals,
    progress: Progress,
    keep: &mut impl FnMut(&mut Session<'_>),
) -> Option<Stop> {
    let before = session.counters().samples;
    let control = Control::default();
    let stop = OnceLock::new();
    let start = Instant::now();
    let done = AtomicBool::new(false);
    thread::scope(|scope| {
        let mut progress = progress;
        let (control, stop, finished) = (&control, &stop, &done);
        let watcher = scope.spawn(move || {
            while !finished.load(Ordering::Acquire) {
                let elapsed = start.elapsed();
                let reason = match signals.came() {
                    Some(signal) => Some(Stop::Signal(signal)),
                    None => budget.filter(|b| elapsed >= *b).map(|_| Stop::Time),
                };
                if let Some(reason) = reason {
                    let _ = stop.set(reason);
                    control.cancel.store(true, Ordering::Relaxed);
                }
                let (samples, rays) = (control.samples.load(Ordering::Relaxed), control.rays.load(Ordering::Relaxed));
                let is_trying = control.trials.load(Ordering::Relaxed);
                progress.show(&Snapshot { is_trying, before, samples, rays, planned, pixels, elapsed, budget });
                let until_budget = budget.map_or(LOOK_EVERY, |b| b.saturating_sub(elapsed));
                thread::park_timeout(LOOK_EVERY.min(until_budget.max(Duration::from_millis(1))));
            }
            progress.finish();
        });
        // Also when rendering panics the watcher must end, for the scope waits for it.
        let _ended = Ended(&done, watcher.thread().clone());
        passes(session, control, keep);
    });
    if session.is_done() {
        // Asked to stop after the last tile: nothing is missing.
        return session.is_good_enough().then_some(Stop::Error);
    }
    stop.get().copied()
}

/// Passes of growing size, small enough that a tile does not take long.
fn passes(session: &mut Session<'_>, control: &Control, keep: &mut impl FnMut(&mut Session<'_>)) {
    let mut samples = 1;
    let mut kept = Instant::now();
    while !session.is_done() && !control.cancel.load(Ordering::Relaxed) {
        session.step(samples, control);
        let busy = session.wall().as_secs_f64() * session.threads() as f64;
        let per_thread = session.counters().samples as f64 / busy.max(1e-9);
        let longest = (per_thread * TILE_SECONDS / TILE_PIXELS).clamp(1.0, 65536.0) as u32;
        samples = (2 * samples).min(longest).max(1);
        if kept.elapsed() >= KEEP_EVERY {
            keep(session);
            kept = Instant::now();
        }
    }
}

/// Tells the watcher, when it goes away, that there is nothing more to watch.
struct Ended<'a>(&'a AtomicBool, Thread);

impl Drop for Ended<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Release);
        self.1.unpark();
    }
}
