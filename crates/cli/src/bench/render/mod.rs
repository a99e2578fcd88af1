//! `steradian bench render`: error against time, of several integrators on several scenes.

mod errors;
mod measure;
mod names;
mod page;
mod table;

use self::{measure::Snapshot, names::Names};
use crate::{
    args::SceneOptions,
    failure::{self, Failure, Outcome},
    job,
    open::{self, Ready},
    output,
    terminal::{self, Terminal},
    values::{self, MAX_SPP},
};
use clap::Args;
use serde::Serialize;
use std::{
    path::{Path, PathBuf},
    sync::Arc,
    time::Duration,
};
use steradian::{
    Control, Inputs, Quality, Render, Scene, SensorNoise,
    image::{self, Image, Limits, metrics},
};

/// Distance of the reference's seed from the one that is given.
const REFERENCE_SEED: u64 = 1_000_003;

/// `steradian bench render`.
#[derive(Args, Debug)]
#[command(after_help = "Snapshots are taken at 0.25 s of rendering, 0.5 s, 1 s, … and at the end. Efficiency is\n\
    1 / (relMSE · CPU s), of single pixels and of means over squares of 4, 8 and 16 pixels. Noise of the\n\
    reference counts as error: give it many samples.")]
pub struct RenderBenchArgs {
    /// Scene files, or builtin:NAME
    #[arg(value_name = "SCENE", required = true)]
    pub scenes: Vec<PathBuf>,
    /// Integrators to compare; options of one go on after a comma: path,bdpt:max_depth=5,rr_depth=3,sppm
    #[arg(short, long, value_name = "NAME[:key=value,…],…", default_value = "path")]
    pub integrators: Names,
    /// Time of each render
    #[arg(long, value_name = "DURATION", value_parser = values::duration, default_value = "10s")]
    pub time: Duration,
    /// Reference picture, of one scene; one of another size is resampled by area. Default: rendered by path first
    #[arg(long, value_name = "FILE", conflicts_with = "reference_spp")]
    pub reference: Option<PathBuf>,
    /// Samples per pixel of a reference that is rendered, with another seed; 1k is 1000
    #[arg(long, value_name = "N", value_parser = values::spp, default_value_t = 4096)]
    pub reference_spp: u32,
    /// Number of renders by each integrator, with a seed each
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub repeat: u32,
    /// Random seed of the first one
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// Write a page with curves, tables, and pictures with maps of FLIP errors; one file, which fetches nothing
    #[arg(long, value_name = "FILE")]
    pub html: Option<PathBuf>,
    /// Write all snapshots as a table of comma-separated values
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
    /// Print one line of JSON to stdout
    #[arg(long)]
    pub json: bool,
    /// The scene.
    #[command(flatten)]
    pub scene_options: SceneOptions,
}

#[derive(Debug, Serialize)]
struct Answer<'a> {
    schema: u32,
    /// Edges in pixels of the squares that errors and efficiencies are of.
    box_edges: [usize; errors::EDGES.len()],
    scenes: &'a [Measured],
}

/// Everything about a scene.
#[derive(Debug, Serialize)]
struct Measured {
    scene: String,
    width: usize,
    height: usize,
    reference: String,
    integrators: Vec<Curve>,
    /// The reference at the size of the pictures.
    #[serde(skip)]
    truth: Image,
}

/// An integrator on a scene.
#[derive(Debug, Serialize)]
struct Curve {
    integrator: String,
    /// Reason why there is nothing else.
    cannot: Option<String>,
    runs: Vec<Run>,
    /// Last picture of the first run.
    #[serde(skip)]
    picture: Option<Image>,
}

/// A render.
#[derive(Debug, Serialize)]
struct Run {
    seed: u64,
    snapshots: Vec<Snapshot>,
}

/// Renders, measures, prints and writes.
pub fn run(args: &RenderBenchArgs, terminal: Terminal) -> Outcome {
    if args.reference.is_some() && args.scenes.len() > 1 {
        return Err(Failure::bad_input(format!(
            "--reference is of one scene, and {} are given; leave it out to have references rendered",
            args.scenes.len()
        )));
    }
    open::limit_threads(args.scene_options.threads);
    let outputs = || [&args.html, &args.csv].into_iter().flatten().map(PathBuf::as_path);
    let inputs = args.scenes.iter().chain(&args.reference).map(PathBuf::as_path);
    output::claim(outputs(), &Inputs::of(inputs))?;
    let options = SceneOptions { sensor_noise: SensorNoise::Off, ..args.scene_options.clone() };
    let mut scenes = Vec::new();
    for path in &args.scenes {
        let opened = open::open(path, &options, None);
        let Ready { scene, inputs, .. } = open::ready(opened, path, options.strict, terminal)?;
        output::claim(outputs(), &inputs)?;
        scenes.push(measured(args, path, &scene, terminal)?);
    }
    let write = |path: &Path, text: String| {
        image::write_whole(path, text.as_bytes()).map_err(|e| Failure::failed(e.to_string()))
    };
    args.csv.as_ref().map_or(Ok(()), |path| write(path, table::csv(&scenes)))?;
    if let Some(path) = &args.html {
        write(path, page::page(args, &scenes).map_err(|e| Failure::failed(e.to_string()))?)?;
    }
    if args.json {
        terminal::json(&Answer { schema: 1, box_edges: errors::EDGES, scenes: &scenes })?;
    } else {
        terminal::data(table::text(&scenes).as_bytes())?;
    }
    Ok(failure::DONE)
}

/// All integrators on a scene.
fn measured(args: &RenderBenchArgs, path: &Path, scene: &Arc<Scene>, terminal: Terminal) -> Result<Measured, Failure> {
    let name = open::shown(path).to_string();
    let crop = scene.film().crop;
    let (width, height) = (crop.width() as usize, crop.height() as usize);
    let (truth, reference) = match &args.reference {
        Some(path) => read_reference(path, (width, height), terminal)?,
        None => render_reference(args, scene, &name, terminal)?,
    };
    let mut integrators = Vec::new();
    for integrator in &args.integrators.0 {
        let mut curve = Curve { integrator: integrator.clone(), cannot: None, runs: Vec::new(), picture: None };
        for seed in (0..args.repeat).map(|k| args.seed.wrapping_add(k.into())) {
            let render = match quality(args, integrator, MAX_SPP, seed).render(scene) {
                Ok(render) => render,
                Err(why) => {
                    curve.cannot = Some(why.to_string());
                    break;
                }
            };
            terminal.say(&format!("measuring {integrator} on {name}, seed {seed}"));
            if let Some(left_out) = render.left_out(scene).filter(|_| seed == args.seed) {
                terminal.warn(&left_out.of(render.name));
            }
            job::check_memory(scene, render.film_bytes(scene, 0))?;
            let (snapshots, picture) = measure::measure(scene, &render, &truth, args.time)?;
            if snapshots.is_empty() {
                terminal
                    .warn(&format!("the time was up before every pixel had a sample: {integrator} has no snapshot"));
            }
            curve.picture = curve.picture.or(picture);
            curve.runs.push(Run { seed, snapshots });
        }
        integrators.push(curve);
    }
    Ok(Measured { scene: name, width, height, reference, integrators, truth })
}

fn quality(args: &RenderBenchArgs, integrator: &str, spp: u32, seed: u64) -> Quality {
    let threads = usize::from(args.scene_options.threads);
    Quality { integrator: Some(integrator.into()), spp: Some(spp), seed: Some(seed), threads, ..Quality::default() }
}

/// A reference from a file, and words for it.
fn read_reference(path: &Path, size: (usize, usize), terminal: Terminal) -> Result<(Image, String), Failure> {
    let bad = |e: image::Error| Failure::bad_input(e.to_string());
    let truth = image::read(path, &Limits::default()).map_err(bad)?;
    let name = path.display();
    let (width, height) = (truth.width(), truth.height());
    if (width, height) == size {
        return Ok((truth, name.to_string()));
    }
    let resampled =
        metrics::resampled(&truth, size.0, size.1).map_err(|e| Failure::bad_input(format!("'{name}': {e}")))?;
    let about = format!("{width}x{height} pixels, resampled by area to {}x{}", size.0, size.1);
    terminal.say(&format!("note: '{name}' has {about}"));
    Ok((resampled, format!("{name}, {about}")))
}

/// A reference by path, and words for it.
fn render_reference(
    args: &RenderBenchArgs,
    scene: &Arc<Scene>,
    name: &str,
    terminal: Terminal,
) -> Result<(Image, String), Failure> {
    let (spp, seed) = (args.reference_spp, args.seed.wrapping_add(REFERENCE_SEED));
    let bad = |e: steradian::Error| Failure::bad_input(e.to_string());
    let render: Render = quality(args, "path", spp, seed).render(scene).map_err(bad)?;
    let about = format!("path, {spp} spp, seed {seed}");
    terminal.say(&format!("rendering the reference of {name}: {about}"));
    if let Some(left_out) = render.left_out(scene) {
        terminal.warn(&format!("the reference is not whole: {}", left_out.of(render.name)));
    }
    let mut session = render.session(scene).map_err(|e| Failure::bad_input(e.to_string()))?;
    let control = Control::default();
    while !session.is_done() {
        session.step(64, &control);
    }
    if let Some(why) = session.failure() {
        return Err(Failure::failed(why));
    }
    let film = session.film();
    if let Some(share) = steradian::missing_light(&render, scene, &film) {
        terminal
            .warn(&format!("about {:.0} % of the light is missing in the reference; give --reference", 100.0 * share));
    }
    Ok((steradian::develop(scene, &film, &[]), about))
}
