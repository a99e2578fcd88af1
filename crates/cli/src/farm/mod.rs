//! `steradian farm`: a render in chunks, by worker processes of this machine or by an engine that deals chunks out to
//! many machines.

mod counting;
mod engines;
mod local;
mod quote;
mod submitted;

use crate::{
    chunks::{
        job_file::JobFile,
        merge::{self, MergeArgs},
        plan::{self, PlanArgs},
    },
    failure::{self, Failure, Outcome},
    open, output,
    pack::{self, PackArgs},
    signals,
    terminal::{self, Terminal},
};
use clap::{Args, Command};
use engines::{Engine, KUBERNETES_CHUNKS, Planned, in_container};
use serde::Serialize;
use std::{
    path::{Path, PathBuf},
    thread,
};
use steradian::{Inputs, archive};

/// Processors for each worker process.
const PROCESSORS: u32 = 8;
/// The scene in the folder of a job of containers.
const SCENE: &str = "scene.zip";

/// `steradian farm`.
#[derive(Args, Debug)]
#[command(
    after_help = "The picture has the bits of `steradian render` with the same options. The same command goes on \
    with a job that was stopped. Except for local, it writes the engine's files into the folder of the job, and says \
    the command that submits them."
)]
pub struct FarmArgs {
    /// The plan.
    #[command(flatten)]
    pub plan: PlanArgs,
    /// Engine that deals out the chunks
    #[arg(long, value_enum, default_value = "local", value_name = "NAME", help_heading = "Farm")]
    pub engine: Engine,
    /// Number of workers, of those engines that are told; default of local: one for each 8 processors
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=65536), help_heading = "Farm")]
    pub workers: Option<u32>,
    /// The merged picture. Repeatable. Default: SCENE.exr and SCENE.png in the current folder
    #[arg(long, value_name = "OUT", help_heading = "Farm")]
    pub picture: Vec<PathBuf>,
    /// Submit the job to the engine by its own program, and wait until all chunks are there
    #[arg(long, help_heading = "Farm")]
    pub submit: bool,
    /// Image of the containers, with `steradian` and `sh` on its PATH (kubernetes)
    #[arg(long, value_name = "NAME", default_value = "steradian", help_heading = "Farm")]
    pub image: String,
    /// PersistentVolumeClaim to the volume that holds the folder of the job (kubernetes)
    #[arg(long, value_name = "NAME", default_value = "steradian-job", help_heading = "Farm")]
    pub claim: String,
}

/// Summary of a job for an engine, as `--json` prints it.
#[derive(Serialize)]
struct Summary<'a> {
    schema: u32,
    job: &'a str,
    chunks: u32,
    files: Vec<&'a str>,
    next: &'a str,
}

/// Plans, then computes and merges, or writes what the engine reads.
pub fn run(args: &FarmArgs, terminal: Terminal) -> Outcome {
    let PlanArgs { chunks, render } = &args.plan;
    let (chunks, folder) = (*chunks, &*render.output[0]);
    args.picture.iter().try_for_each(|picture| output::kind(picture).map(drop))?;
    if args.engine == Engine::Kubernetes && chunks > KUBERNETES_CHUNKS {
        return Err(Failure::bad_input(format!("--chunks {chunks}: kubernetes takes at most {KUBERNETES_CHUNKS}")));
    }
    let whole = whole(folder)?;
    let submission =
        (args.submit && args.engine != Engine::Local).then(|| submitted::check(args.engine, &whole)).transpose()?;
    plan::plan(&args.plan, FarmArgs::augment_args(Command::new("farm")), &args.picture, terminal)?;
    let job = JobFile::read(folder)?;
    let processors = thread::available_parallelism().map_or(1, |n| n.get() as u32);
    let local_workers = (processors / PROCESSORS).max(1);
    if args.engine == Engine::Local {
        let workers = args.workers.unwrap_or(local_workers);
        return local(args, &job, (workers, (processors / workers).max(1)), terminal);
    }
    let planned = Planned {
        folder: whole,
        chunks,
        workers: args.workers,
        local_workers,
        pictures: pictures(args)?,
        image: args.image.clone(),
        claim: args.claim.clone(),
        scene: if args.engine == Engine::Kubernetes { carried(args, terminal)? } else { None },
    };
    let files = args.engine.files(&planned);
    for (name, text) in &files {
        let path = folder.join(name);
        steradian::image::write_whole(&path, text.as_bytes()).map_err(|e| Failure::failed(e.to_string()))?;
    }
    let names: Vec<&str> = files.iter().map(|file| file.0).collect();
    terminal.say(&format!("wrote {} in {}", names.join(", "), folder.display()));
    let next = args.engine.next(&planned.folder);
    if let Some(words) = submission {
        return submitted::run(&words, &job, folder, terminal);
    }
    terminal.say(&format!("next: {next}"));
    if render.json {
        terminal::json(&Summary { schema: 1, job: &planned.folder, chunks, files: names, next: &next })?;
    }
    Ok(failure::DONE)
}

/// Computes the chunks here and merges them.
fn local(args: &FarmArgs, job: &JobFile, workers: (u32, u32), terminal: Terminal) -> Outcome {
    let render = &args.plan.render;
    if let Some(signal) = local::compute(job, &render.output[0], workers, terminal)? {
        terminal.warn(&format!("stopped by {}; the same command goes on", signals::name(signal)));
        return Ok(128 + signal);
    }
    let (parts, output) = (vec![render.output[0].clone()], args.picture.clone());
    merge::run(&MergeArgs { parts, output, scene: None, talk: render.talk, json: render.json }, terminal)
}

/// A path from the root on, as generated files can hold it.
fn whole(path: &Path) -> Result<String, Failure> {
    let whole = std::path::absolute(path)?;
    let text = whole.to_str().ok_or_else(|| {
        Failure::bad_input(format!("a job cannot hold '{}', which is no UTF-8", path.to_string_lossy()))
    })?;
    // A slash at the end is none of the folder's name.
    Ok(text.trim_end_matches('/').to_owned())
}

/// The merged pictures, from the root on.
fn pictures(args: &FarmArgs) -> Result<Vec<String>, Failure> {
    let scene = args.plan.render.scene.as_deref().unwrap_or(Path::new("builtin:cornell-box"));
    let default = || output::free_names(output::default_names(scene), &Inputs::of([scene]));
    let pictures = if args.picture.is_empty() { default() } else { args.picture.clone() };
    pictures.iter().map(|picture| whole(picture)).collect()
}

/// The scene as containers see it, which have only the folder of the job: packed, if it is a file.
fn carried(args: &FarmArgs, terminal: Terminal) -> Result<Option<String>, Failure> {
    let render = &args.plan.render;
    let Some(scene) = render.scene.as_deref().filter(|scene| open::is_file(scene)) else { return Ok(None) };
    let packed = render.output[0].join(SCENE);
    let inside = match archive::split(scene) {
        Some((from, inside)) => {
            std::fs::copy(from, &packed)
                .map_err(|e| Failure::failed(format!("cannot write '{}': {e}", packed.display())))?;
            inside
        }
        None => {
            let (scene, define) = (scene.to_path_buf(), render.scene_options.define.clone());
            pack::run(&PackArgs { scene, output: packed, define, json: false }, terminal)?;
            Path::new("")
        }
    };
    let inside = inside.to_str().filter(|inside| !inside.is_empty()).map(|inside| format!("/{inside}"));
    Ok(Some(in_container(SCENE) + &inside.unwrap_or_default()))
}
