//! `steradian render --estimate`: the time and memory that a render will take, from a short trial of it.

use crate::{
    failure::{self, Failure, Outcome},
    job::{Job, Planned},
    memory,
    open::Ready,
    progress::{clock, rate},
    signals::Signals,
    terminal,
};
use serde::Serialize;
use std::time::Duration;
use steradian::{Control, Session};

/// Time for which samples are taken, if each pixel has one by then.
const TRIAL: Duration = Duration::from_secs(2);

/// Estimate of a render, as `--json` prints it. Times are in seconds.
#[derive(Debug, Serialize)]
struct Estimate<'a> {
    schema: u32,
    scene: &'a str,
    integrator: &'a str,
    width: u32,
    height: u32,
    spp: u32,
    threads: usize,
    /// Reading the scene, and building the hierarchy.
    load_seconds: f64,
    build_seconds: f64,
    /// Preparation by the method, before the first sample.
    prepare_seconds: f64,
    /// Samples of the whole plan.
    sample_seconds: f64,
    /// All of these.
    seconds: f64,
    samples_per_second: f64,
    /// Samples of the trial.
    trial_samples: u64,
    /// Hierarchy and geometry.
    geometry_bytes: usize,
    /// Textures, media, measured materials and other tables.
    table_bytes: usize,
    film_bytes: u64,
    /// Largest size of the process so far, which the render hardly exceeds; null where the system does not tell.
    peak_rss_bytes: Option<u64>,
}

/// Takes samples for a short time, and tells what all of them will take. No picture is written.
pub fn tell(
    job: &Job<'_>,
    planned: &Planned,
    ready: &Ready,
    signals: &Signals,
    mut session: Box<dyn Session>,
) -> Outcome {
    let scene = &ready.scene;
    let control = Control::default();
    // Preparation, then sample by sample of the whole picture, so that no part of it stands for another.
    session.step(0, &control);
    let prepared = session.wall();
    while !session.is_done() && session.wall() - prepared < TRIAL {
        session.step(1, &control);
        if let Some(signal) = signals.came() {
            return Ok(128 + signal);
        }
    }
    let (taken, wall) = (session.counters().samples, (session.wall() - prepared).as_secs_f64());
    if taken == 0 {
        return Err(Failure::failed("there was no sample in the trial"));
    }
    let samples_per_second = taken as f64 / wall.max(1e-9);
    let sample_seconds = match job.args.time {
        Some(time) => time.as_secs_f64().min(planned.planned as f64 / samples_per_second),
        None => planned.planned as f64 / samples_per_second,
    };
    let [load_seconds, build_seconds, prepare_seconds] =
        [ready.load, ready.build, prepared].map(|time| time.as_secs_f64());
    let crop = &scene.film().crop;
    let estimate = Estimate {
        schema: 1,
        scene: &job.name,
        integrator: planned.render.name,
        width: crop.width(),
        height: crop.height(),
        spp: planned.spp,
        threads: session.threads(),
        load_seconds,
        build_seconds,
        prepare_seconds,
        sample_seconds,
        seconds: load_seconds + build_seconds + prepare_seconds + sample_seconds,
        samples_per_second,
        trial_samples: taken,
        geometry_bytes: scene.geometry_bytes(),
        table_bytes: scene.tables().iter().map(|table| table.bytes).sum(),
        film_bytes: planned.render.film_bytes(scene, job.quality.layers.len()),
        peak_rss_bytes: memory::peak(),
    };
    if job.args.json {
        terminal::json(&estimate)?;
    } else {
        terminal::data(estimate.text().as_bytes())?;
    }
    Ok(failure::DONE)
}

impl Estimate<'_> {
    fn text(&self) -> String {
        let time = |seconds: f64| match seconds {
            s if s < 60.0 => format!("{s:.1} s"),
            s => clock(Duration::try_from_secs_f64(s).unwrap_or(Duration::MAX)),
        };
        format!(
            "time    {}: load {}, build {}, prepare {}, {} samples per pixel {} ({} on {} threads)\n\
             memory  {}: geometry {}, tables {}, film {}\n",
            time(self.seconds),
            time(self.load_seconds),
            time(self.build_seconds),
            time(self.prepare_seconds),
            self.spp,
            time(self.sample_seconds),
            rate(self.samples_per_second),
            self.threads,
            self.peak_rss_bytes.map_or("unknown".into(), memory::readable),
            memory::readable(self.geometry_bytes as u64),
            memory::readable(self.table_bytes as u64),
            memory::readable(self.film_bytes),
        )
    }
}
