//! `steradian render --integrator raster`: a picture at once, without progress and stopping.

use crate::{
    args::{Color, RenderArgs, SceneOptions},
    diagnostics::Counts,
    failure::{self, Failure, Outcome},
    memory,
    output::{self, Provenance},
    render,
    report::{self, Report},
    terminal::{self, Terminal},
};
use std::{
    path::PathBuf,
    time::{Duration, Instant},
};
use steradian::{
    ColorMode, Quality, Scene,
    image::{FileKind, WriteOptions},
    raster,
};

/// An opened scene and where its picture goes.
pub struct Job<'a> {
    /// As named on the command line.
    pub name: &'a str,
    /// The scene.
    pub scene: &'a Scene,
    /// What is asked of the render.
    pub quality: &'a Quality,
    /// Files to write.
    pub outputs: &'a [PathBuf],
    /// Their kinds.
    pub kinds: &'a [FileKind],
    /// How they are written.
    pub write_options: &'a WriteOptions,
    /// Messages of reading.
    pub counts: Counts,
    /// Time of reading.
    pub load: Duration,
    /// Time of building.
    pub build: Duration,
}

/// How the scene is opened: in RGB unless something else is asked for, since one sample of wavelengths would be noise.
///
/// # Errors
/// [`Failure`] for options that the pipeline does not have.
pub fn scene_options(args: &RenderArgs) -> Result<SceneOptions, Failure> {
    let mut options = args.scene_options.clone();
    let asked = args.integrator.as_deref().map(|asked| asked.split_once(':').map_or(asked, |(name, _)| name));
    if asked != Some(raster::RASTER.0) {
        return Ok(options);
    }
    let given = [
        (!args.aov.is_empty(), "--aov"),
        (args.resume.is_some(), "--resume"),
        (args.adaptive, "--adaptive"),
        (args.transparent, "--transparent"),
        (args.error.is_some(), "--error"),
        (args.time.is_some(), "--time"),
        (args.sampler.is_some(), "--sampler"),
        (args.seed.is_some(), "--seed"),
        (args.max_depth.is_some(), "--max-depth"),
    ];
    if let Some((_, option)) = given.into_iter().find(|(given, _)| *given) {
        return Err(Failure::bad_input(format!("the integrator raster has no {option}")));
    }
    if matches!(options.color, Color::Auto) {
        options.color = Color::Rgb;
    }
    Ok(options)
}

/// Renders, saves, reports.
pub fn run(args: &RenderArgs, job: &Job<'_>, options: &raster::Options, terminal: Terminal) -> Outcome {
    let Job { name, scene, quality, outputs, .. } = job;
    let (width, height) = (scene.film.crop.width(), scene.film.crop.height());
    outputs.iter().zip(job.kinds).try_for_each(|(path, kind)| output::check_size(path, *kind, (width, height)))?;
    render::check_memory(scene, 2)?;
    let integrator = raster::RASTER.0;
    terminal.say(&format!("rendering {name} with {integrator}, {width} x {height}"));
    let done = raster::render(scene, quality, options).map_err(|e| Failure::bad_input(e.to_string()))?;
    if job.scene.moves() {
        terminal.say("note: raster shows the moment at which the shutter opens; things move in this scene");
    }
    done.notes.iter().for_each(|note| terminal.say(note));
    let saving = Instant::now();
    let color = if scene.mode == ColorMode::Spectral { "spectral" } else { "rgb" };
    let mut picture = steradian::develop(scene, &done.film, &[]);
    let (spp, seed) = (f64::from(done.spp), scene.settings.seed);
    let provenance = Provenance {
        scene: name,
        integrator,
        spp,
        seed,
        seconds: done.wall.as_secs_f64(),
        nonfinite: done.nonfinite,
        color,
        error: None,
        doubt: None,
        adaptive: false,
        caustics: false,
        sharing: 1,
        of_means: None,
    };
    output::label(&mut picture, scene, &provenance);
    let written = output::save(outputs, &picture, job.write_options, true)?;
    let report = Report {
        schema: 1,
        software: concat!("Steradian ", env!("CARGO_PKG_VERSION")),
        scene: name,
        integrator,
        color,
        seed,
        spp: report::number(spp),
        adaptive: false,
        caustics: false,
        sharing: 1,
        relative_error: None,
        unreliable: None,
        relative_error_of_means: None,
        missing_light: None,
        width,
        height,
        threads: rayon::current_num_threads(),
        samples: u64::from(done.spp) * u64::from(width) * u64::from(height),
        rays: done.rays,
        load_seconds: job.load.as_secs_f64(),
        build_seconds: job.build.as_secs_f64(),
        render_seconds: done.wall.as_secs_f64(),
        cpu_seconds: done.cpu.as_secs_f64(),
        save_seconds: saving.elapsed().as_secs_f64(),
        peak_rss_bytes: memory::peak(),
        nonfinite_dropped: done.nonfinite,
        empty_pixels: 0,
        stopped: None,
        outputs: &written,
        diagnostics: job.counts,
    };
    render::tell(&report, None, terminal);
    terminal.say(&format!("wrote {}", output::listed(&written)));
    if args.json {
        terminal::json(&report)?;
    }
    Ok(failure::DONE)
}
