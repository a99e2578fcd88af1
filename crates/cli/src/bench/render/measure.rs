//! A render that is looked at on the way: its errors at doubling times.

use super::errors::{self, EDGES};
use crate::failure::Failure;
use serde::Serialize;
use std::{
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    thread,
    time::{Duration, Instant},
};
use steradian::{
    Control, Render, Scene, Session,
    image::{Image, metrics},
};

/// Wall time of rendering at the first snapshot.
const FIRST: Duration = Duration::from_millis(250);
/// Interval between looks at a step.
const LOOK_EVERY: Duration = Duration::from_millis(20);
/// Most samples of a step.
const MOST: f64 = 65536.0;

/// Errors of a render at one time.
#[derive(Clone, Debug, Serialize)]
pub struct Snapshot {
    /// Wall time of rendering.
    pub wall_seconds: f64,
    /// CPU time of rendering.
    pub cpu_seconds: f64,
    /// Mean samples per pixel.
    pub spp: f64,
    /// relMSE of means over squares of [`EDGES`].
    pub relmse: [f64; EDGES.len()],
    /// 1 / (relMSE · CPU s) of each.
    pub efficiency: [f64; EDGES.len()],
    /// Mean FLIP error.
    pub flip: f64,
}

/// Most steps after the end of the time, of a method that gives no pixel a sample.
const MOST_STEPS: u32 = 3;

/// Renders for a time, with snapshots at doubling times and at the end; the last picture with them. Trials of a method
/// count, and may take half of the time. Snapshots where pixels have no sample yet are left out.
///
/// # Errors
/// [`Failure`] where the method cannot render the scene, or breaks down.
pub fn measure(
    scene: &Arc<Scene>,
    render: &Render,
    reference: &Image,
    budget: Duration,
) -> Result<(Vec<Snapshot>, Option<Image>), Failure> {
    let mut session = render.session(scene).map_err(|e| Failure::bad_input(e.to_string()))?;
    let (mut snapshots, mut picture) = (Vec::new(), None);
    let (mut next, mut samples) = (FIRST, 1);
    loop {
        let left = budget.saturating_sub(session.wall());
        let is_cut = step(&mut *session, samples, left);
        if let Some(why) = session.failure() {
            return Err(Failure::failed(why));
        }
        let (wall, has_none) = (session.wall(), session.counters().samples == 0);
        let is_over = wall >= budget || session.is_done() || is_cut && !(has_none && session.skip_trials());
        if is_over {
            finish_first_pass(&mut *session);
        }
        if wall >= next || is_over {
            if let Some((snapshot, image)) = snapshot(scene, &*session, reference)? {
                snapshots.push(snapshot);
                picture = Some(image);
            }
            while next <= wall {
                next *= 2;
            }
        }
        if is_over {
            return Ok((snapshots, picture));
        }
        // As many as fit before the next snapshot at the rate so far, and no more than four times as many as there are.
        let each = wall.as_secs_f64() / f64::from(session.samples().max(1));
        let fitting = (next.min(budget) - wall).as_secs_f64() / each.max(1e-9);
        samples = fitting.min(4.0 * f64::from(session.samples())).clamp(1.0, MOST) as u32;
    }
}

/// A step that ends when the time is up; true if it was broken off.
fn step(session: &mut dyn Session, samples: u32, left: Duration) -> bool {
    let (control, is_finished) = (Control::default(), AtomicBool::new(false));
    thread::scope(|scope| {
        let watcher = scope.spawn(|| {
            let start = Instant::now();
            while !is_finished.load(Ordering::Acquire) {
                let allowed = if control.trials.load(Ordering::Relaxed) { left / 2 } else { left };
                let Some(rest) = allowed.checked_sub(start.elapsed()).filter(|rest| !rest.is_zero()) else {
                    control.cancel.store(true, Ordering::Relaxed);
                    break;
                };
                thread::park_timeout(rest.min(LOOK_EVERY));
            }
        });
        session.step(samples, &control);
        is_finished.store(true, Ordering::Release);
        watcher.thread().unpark();
    });
    control.cancel.load(Ordering::Relaxed)
}

/// Takes the first sample of each pixel that has none, whatever the time: without it there is nothing to measure.
fn finish_first_pass(session: &mut dyn Session) {
    for _ in 0..MOST_STEPS {
        let has_gaps = session.film().pixels.iter().any(|pixel| pixel.samples == 0);
        if !has_gaps || session.is_done() || session.failure().is_some() {
            break;
        }
        step(session, 1, Duration::MAX);
    }
}

/// The picture as it is, and its errors; `None` where pixels have no sample.
fn snapshot(scene: &Scene, session: &dyn Session, reference: &Image) -> Result<Option<(Snapshot, Image)>, Failure> {
    let film = session.film();
    if film.pixels.iter().any(|pixel| pixel.samples == 0) {
        return Ok(None);
    }
    let image = steradian::develop(scene, &film, &[]);
    let fault = |e: steradian::image::Error| Failure::failed(e.to_string());
    let relmse = errors::relmse(&image, reference).map_err(fault)?;
    let cpu = session.cpu().as_secs_f64();
    let snapshot = Snapshot {
        wall_seconds: session.wall().as_secs_f64(),
        cpu_seconds: cpu,
        spp: session.counters().samples as f64 / image.pixel_count().max(1) as f64,
        relmse,
        efficiency: relmse.map(|error| 1.0 / (error * cpu)),
        flip: metrics::flip(&image, reference, metrics::DEFAULT_PIXELS_PER_DEGREE).map_err(fault)?,
    };
    Ok(Some((snapshot, image)))
}
