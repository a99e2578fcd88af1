//! The session of a render; radiosity before it: solved, or taken from the file that keeps it.

use crate::{failure::Failure, signals::Signals, terminal::Terminal};
use std::{path::Path, sync::Arc, time::Instant};
use steradian::{
    Render, Scene, Session,
    integrators::IntegratorKind,
    radiosity::{self, Report, Watcher},
};

/// A render with an empty film, of which all is known that it has to know beforehand.
///
/// # Errors
/// Where the file is of no use or cannot be written, or a signal came.
pub fn session(
    scene: &Arc<Scene>,
    render: &Render,
    file: Option<(&Path, [u8; 32])>,
    signals: &Signals,
    terminal: Terminal,
) -> Result<Box<dyn Session>, Failure> {
    let Some(IntegratorKind::Radiosity(view)) = render.integrator() else {
        return render.session(scene).map_err(|e| Failure::bad_input(e.to_string()));
    };
    if let Some((path, fingerprint)) = file.filter(|f| f.0.exists()) {
        let solution = radiosity::load(scene, &fingerprint, &view.settings, path)
            .map_err(|e| Failure::bad_input(format!("'{}' {e}", path.display())))?;
        terminal.say(&format!("light of {} patches from {}", solution.report.patches, path.display()));
        return Ok(view.session(scene, render.plan, Arc::new(solution)));
    }
    let start = Instant::now();
    let solved = radiosity::solve(scene, &view.settings, &Watch { signals, terminal })
        .map_err(|e| Failure::bad_input(e.to_string()))?;
    let Some(solution) = solved else {
        let signal = signals.came().unwrap_or_default();
        return Err(Failure { code: 128 + signal, message: "stopped before the light was solved".into() });
    };
    tell(&solution.report, start.elapsed().as_secs_f64(), terminal);
    if let Some((path, fingerprint)) = file {
        radiosity::keep(scene, &fingerprint, &view.settings, &solution, path)
            .map_err(|e| Failure::failed(e.to_string()))?;
        terminal.say(&format!("kept the light in {}", path.display()));
    }
    Ok(view.session(scene, render.plan, Arc::new(solution)))
}

/// What was solved, and what takes no part or in part only.
fn tell(report: &Report, seconds: f64, terminal: Terminal) {
    let patches = report.patches;
    let rays = report.rays as f64 * 1e-6;
    terminal.say(&format!("radiosity: {patches} patches, {} steps, {rays:.2} Mray, {seconds:.2} s", report.steps));
    if !report.impure.is_empty() {
        let names = report.impure.join("', '");
        terminal.warn(&format!("of materials '{names}' only the Lambertian part exchanges light"));
    }
    if !report.left_out.is_empty() {
        let names = report.left_out.join(", ");
        terminal.warn(&format!("{names} are no patches: they cast shadows, but exchange no light"));
    }
}

/// Stops at a signal.
struct Watch<'a> {
    signals: &'a Signals,
    terminal: Terminal,
}

impl Watcher for Watch<'_> {
    fn begins(&self, phase: &'static str, parts: u64) {
        if parts > 1 {
            self.terminal.say(&format!("radiosity: {phase} of {parts} patches"));
        }
    }

    fn advances(&self, _: u64) -> bool {
        self.signals.came().is_none()
    }
}
