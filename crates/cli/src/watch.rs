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

/// Interval between looks of the watcher.
const LOOK_EVERY: Duration = Duration::from_millis(50);
/// Interval between saves of the state.
const KEEP_EVERY: Duration = Duration::from_secs(30);
/// Longest time of a thread for a tile, seconds: the render ends at the next one.
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

/// Tasks due between steps.
#[derive(Clone, Copy, Debug, Default)]
pub struct Due {
    /// The state is to be saved.
    pub state: bool,
    /// The picture is to be written as it is.
    pub picture: bool,
}

/// The part of the budget that trials may take; the rest is for a picture without them.
const TRIALS: f64 = 0.5;

/// Takes all samples of the plan, or those that the time and the user allow. Between steps `on_the_way` does what is
/// due: to save the state every half minute, and to write the picture at intervals of `every` or when SIGUSR1 came.
/// Trials that take half of the time are broken off, for a picture without them.
pub fn render(
    session: &mut dyn Session,
    (pixels, planned): (u64, u64),
    (budget, every): (Option<Duration>, Option<Duration>),
    signals: &Signals,
    progress: impl Fn() -> Progress,
    mut on_the_way: impl FnMut(&mut dyn Session, Due),
) -> Option<Stop> {
    let start = Instant::now();
    let mut passes = |session: &mut dyn Session, control: &Control| {
        steps(session, control, (pixels, every), signals, &mut on_the_way);
    };
    let stop = samples(session, (pixels, planned), budget, signals, progress(), &mut passes);
    let is_empty = session.counters().samples == 0;
    if !(is_empty && matches!(stop, Some(Stop::Time)) && session.skip_trials()) {
        return stop;
    }
    let left = budget.map(|budget| budget.saturating_sub(start.elapsed()));
    samples(session, (pixels, planned), left, signals, progress(), &mut passes)
}

fn samples(
    session: &mut dyn Session,
    (pixels, planned): (u64, u64),
    budget: Option<Duration>,
    signals: &Signals,
    progress: Progress,
    passes: &mut impl FnMut(&mut dyn Session, &Control),
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
                let is_trying = control.trials.load(Ordering::Relaxed);
                let allowed = budget.map(|budget| if is_trying { budget.mul_f64(TRIALS) } else { budget });
                let reason = match signals.came() {
                    Some(signal) => Some(Stop::Signal(signal)),
                    None => allowed.filter(|b| elapsed >= *b).map(|_| Stop::Time),
                };
                if let Some(reason) = reason {
                    let _ = stop.set(reason);
                    control.cancel.store(true, Ordering::Relaxed);
                }
                let (samples, rays) = (control.samples.load(Ordering::Relaxed), control.rays.load(Ordering::Relaxed));
                progress.show(&Snapshot { is_trying, before, samples, rays, planned, pixels, elapsed, budget });
                let until_budget = allowed.map_or(LOOK_EVERY, |b| b.saturating_sub(elapsed));
                thread::park_timeout(LOOK_EVERY.min(until_budget.max(Duration::from_millis(1))));
            }
            progress.finish();
        });
        // Also when rendering panics the watcher must end, for the scope waits for it.
        let _ended = Ended(&done, watcher.thread().clone());
        passes(session, control);
    });
    if session.is_done() {
        // Asked to stop after the last tile: nothing is missing.
        return session.is_good_enough().then_some(Stop::Error);
    }
    stop.get().copied()
}

/// Steps of growing size, small enough that a tile does not take long, nor a step much longer than pictures are apart.
fn steps(
    session: &mut dyn Session,
    control: &Control,
    (pixels, every): (u64, Option<Duration>),
    signals: &Signals,
    on_the_way: &mut impl FnMut(&mut dyn Session, Due),
) {
    let mut samples = 1;
    let (mut kept, mut shown) = (Instant::now(), Instant::now());
    while !session.is_done() && !control.cancel.load(Ordering::Relaxed) {
        session.step(samples, control);
        let busy = session.wall().as_secs_f64() * session.threads() as f64;
        let per_thread = session.counters().samples as f64 / busy.max(1e-9);
        let longest = (per_thread * TILE_SECONDS / TILE_PIXELS).clamp(1.0, 65536.0) as u32;
        samples = (2 * samples).min(longest).max(1);
        if let Some(every) = every {
            let per_second = session.counters().samples as f64 / session.wall().as_secs_f64().max(1e-9);
            samples = samples.min((per_second * every.as_secs_f64() / pixels.max(1) as f64) as u32).max(1);
        }
        let due = Due {
            state: kept.elapsed() >= KEEP_EVERY,
            picture: signals.wants_picture() || every.is_some_and(|every| shown.elapsed() >= every),
        };
        // What comes after the end writes both.
        if session.is_done() || !(due.state || due.picture) {
            continue;
        }
        on_the_way(session, due);
        kept = if due.state { Instant::now() } else { kept };
        shown = if due.picture { Instant::now() } else { shown };
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
