//! The session of a render; radiosity before it: solved, or taken from the file that keeps it.

use crate::{failure::Failure, signals::Signals, terminal::Terminal};
use std::{
    path::Path,
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicU64, Ordering},
    },
    time::{Duration, Instant},
};
use steradian::{
    Render, Scene, Session,
    radiosity::{self, Report, Watcher},
};

/// Cost of solving the light before the session.
#[derive(Clone, Copy, Debug, Default)]
pub struct Effort {
    /// Wall time.
    pub wall: Duration,
    /// Rays traced.
    pub rays: u64,
}

impl Effort {
    /// Counts it with the seconds and rays of rendering.
    pub fn add_to(&self, seconds: &mut f64, rays: &mut u64) {
        *seconds += self.wall.as_secs_f64();
        *rays += self.rays;
    }
}

/// A render with an empty film, of which all is known that it has to know beforehand, and what that took.
///
/// # Errors
/// Where the file is of no use or cannot be written, or a signal came.
pub fn session(
    scene: &Arc<Scene>,
    render: &Render,
    file: Option<(&Path, [u8; 32])>,
    signals: &Signals,
    terminal: Terminal,
) -> Result<(Box<dyn Session>, Effort), Failure> {
    let Some(view) = radiosity::view_of(render) else {
        let session = render.session(scene).map_err(|e| Failure::bad_input(e.to_string()))?;
        return Ok((session, Effort::default()));
    };
    if let Some((path, fingerprint)) = file.filter(|f| f.0.exists()) {
        let solution = radiosity::load(scene, &fingerprint, &view.settings, path)
            .map_err(|e| Failure::bad_input(format!("'{}' {e}", path.display())))?;
        terminal.say(&format!("light of {} patches from {}", solution.report.patches, path.display()));
        return Ok((view.session_of(scene, render.plan, Arc::new(solution)), Effort::default()));
    }
    let start = Instant::now();
    let solved = radiosity::solve(scene, &view.settings, &Watch::new(signals, terminal))
        .map_err(|e| Failure::bad_input(e.to_string()))?;
    let Some(solution) = solved else {
        let signal = signals.came().unwrap_or_default();
        return Err(Failure { code: 128 + signal, message: "stopped before the light was solved".into() });
    };
    let effort = Effort { wall: start.elapsed(), rays: solution.report.rays };
    tell(&solution.report, effort.wall.as_secs_f64(), terminal);
    if let Some((path, fingerprint)) = file {
        radiosity::keep(scene, &fingerprint, &view.settings, &solution, path)
            .map_err(|e| Failure::failed(e.to_string()))?;
        terminal.say(&format!("kept the light in {}", path.display()));
    }
    Ok((view.session_of(scene, render.plan, Arc::new(solution)), effort))
}

/// Patches, steps and rays of a solution.
fn tell(report: &Report, seconds: f64, terminal: Terminal) {
    let patches = report.patches;
    let rays = report.rays as f64 * 1e-6;
    terminal.say(&format!("radiosity: {patches} patches, {} steps, {rays:.2} Mray, {seconds:.2} s", report.steps));
    if let Some(clusters) = report.clusters {
        terminal.say(&format!(
            "radiosity: more pieces of surface than 'patches': they share the light of {clusters} clusters"
        ));
    }
}

/// Interval between lines on the phase where there is no terminal.
const LINE_EVERY: Duration = Duration::from_secs(2);

/// Stops at a signal, and tells how far the phase is.
struct Watch<'a> {
    signals: &'a Signals,
    terminal: Terminal,
    start: Instant,
    /// Parts of the phase that are done.
    done: AtomicU64,
    /// Time of the next line, in milliseconds since the start.
    due: AtomicU64,
    phase: Mutex<Phase>,
}

/// Phase of the solution.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Phase {
    name: &'static str,
    /// Parts that it has; 0 where nobody knows.
    parts: u64,
}

impl Phase {
    /// `radiosity: form factors of 200 patches, 42 %`.
    fn line(self, done: u64) -> String {
        let Self { name, parts } = self;
        match parts {
            0 | 1 => format!("radiosity: {name}"),
            _ => format!("radiosity: {name} of {parts} patches, {} %", 100 * done.min(parts) / parts),
        }
    }
}

impl<'a> Watch<'a> {
    fn new(signals: &'a Signals, terminal: Terminal) -> Self {
        let phase = Mutex::new(Phase { name: "patches", parts: 0 });
        let due = AtomicU64::new(LINE_EVERY.as_millis() as u64);
        Self { signals, terminal, start: Instant::now(), done: AtomicU64::new(0), due, phase }
    }

    fn phase(&self) -> MutexGuard<'_, Phase> {
        self.phase.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Watcher for Watch<'_> {
    fn begins(&self, name: &'static str, parts: u64) {
        *self.phase() = Phase { name, parts };
        self.done.store(0, Ordering::Relaxed);
    }

    fn advances(&self, parts: u64) -> bool {
        let done = self.done.fetch_add(parts, Ordering::Relaxed) + parts;
        let now = self.start.elapsed().as_millis() as u64;
        let due = self.due.load(Ordering::Relaxed);
        let next = now + LINE_EVERY.as_millis() as u64;
        // One thread writes the line.
        if now >= due && self.due.compare_exchange(due, next, Ordering::Relaxed, Ordering::Relaxed).is_ok() {
            self.terminal.say(&self.phase().line(done));
        }
        self.signals.came().is_none()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_have_the_share_that_is_done_where_it_is_known() {
        let phase = Phase { name: "form factors", parts: 200 };
        assert_eq!(phase.line(84), "radiosity: form factors of 200 patches, 42 %");
        assert_eq!(phase.line(900), "radiosity: form factors of 200 patches, 100 %");
        assert_eq!(Phase { name: "links", parts: 0 }.line(900), "radiosity: links");
    }
}
