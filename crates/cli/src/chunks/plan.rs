//! `steradian plan`: the job of a render in chunks.

use super::job_file::{JobFile, MOST_CHUNKS, version};
use crate::{
    args::RenderArgs,
    failure::{self, Failure, Outcome},
    frames, open, output,
    render::Started,
    sequence_state::SequenceState,
    terminal::{self, Terminal},
};
use clap::{ArgAction, ArgMatches, Args, Command, parser::ValueSource};
use serde::Serialize;
use std::path::{Path, PathBuf};
use steradian::Layer;

/// `steradian plan`.
#[derive(Args, Debug)]
#[command(
    mut_arg("output", |arg| arg.value_name("JOB").required(true).help("Folder of the job").long_help(None::<&str>)),
    after_help = "The picture has the bits of `steradian render` with the same options: \
    steradian chunk JOB K for each K from 0 to N-1, on any machines, then steradian merge JOB -o OUT.exr"
)]
pub struct PlanArgs {
    /// Number of chunks
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=MOST_CHUNKS as i64))]
    pub chunks: u32,
    /// The render.
    #[command(flatten)]
    pub render: RenderArgs,
}

/// Options of `render` that belong to no job, by the names of their arguments, and why.
const REFUSED: [(&str, &str); 11] = [
    ("turntable", "each side is a job of its own: -D azimuth=DEGREES"),
    ("resume", "every chunk keeps its own state"),
    ("watch", "the picture is there when it is merged"),
    ("time", "where it ended would depend on the machines"),
    ("error", "the error is that of the whole picture, which no chunk knows"),
    ("adaptive", "needs are told from the whole picture, which no chunk has"),
    ("temporal", "frames are denoised with those before"),
    ("format", "standard input can be read once only"),
    ("estimate", "steradian render --estimate tells it"),
    ("memory_limit", "it is that of one machine"),
    ("threads", "each chunk has its own: steradian chunk JOB K --threads N"),
];

/// Summary of a plan, as `--json` prints it.
#[derive(Serialize)]
struct Summary<'a> {
    schema: u32,
    job: &'a Path,
    chunks: u32,
    pieces: u32,
    frames: u32,
}

/// Plans the render, writes the job, and says what comes next.
pub fn run(args: &PlanArgs, terminal: Terminal) -> Outcome {
    let planned = plan(args, PlanArgs::augment_args(Command::new("plan")), &[], terminal)?;
    let (folder, last) = (&args.render.output[0], args.chunks - 1);
    let name = folder.display();
    terminal.say(&format!("next: steradian chunk {name} K for each K from 0 to {last}, then steradian merge {name}"));
    if args.render.json {
        let Planned { pieces, frames } = planned;
        terminal::json(&Summary { schema: 1, job: folder, chunks: args.chunks, pieces, frames })?;
    }
    Ok(failure::DONE)
}

/// Size of a planned render.
pub struct Planned {
    /// Number of pieces of a frame.
    pub pieces: u32,
    /// Number of frames.
    pub frames: u32,
}

/// Plans the render and writes the job. The words of the render are those that the program's command line gives to
/// `command`, which has these arguments among others.
///
/// # Errors
/// Renders that fall into no pieces, or into fewer than there are to be chunks; what keeps the job from being written.
pub fn plan(args: &PlanArgs, command: Command, pictures: &[PathBuf], terminal: Terminal) -> Result<Planned, Failure> {
    // The words of the command line, after the name of the program.
    let matches = command.get_matches_from(std::env::args_os().skip(1));
    let folder = &args.render.output[0];
    for (name, why) in REFUSED {
        if matches.value_source(name) == Some(ValueSource::CommandLine) {
            let name = name.replace('_', "-");
            return Err(Failure::bad_input(format!("--{name} cannot be planned: {why}")));
        }
    }
    if args.render.aov.iter().any(|layers| layers.0.contains(&Layer::MOTION)) {
        return Err(Failure::bad_input("the layer 'motion' cannot be planned: it takes the frame before"));
    }
    std::fs::create_dir_all(folder)
        .map_err(|e| Failure::failed(format!("cannot make the folder '{}': {e}", folder.display())))?;
    // The render of the first frame, as a chunk begins it.
    let mut one = args.render.clone();
    one.output = if pictures.is_empty() { pictures_in(folder, &one) } else { pictures.to_vec() };
    if let Some(range) = one.frames {
        frames::check(&one)?;
        one = frames::one(&one, range.first, frames::framing(&one, range));
    }
    one.is_of_job = true;
    let (started, session) = Started::new(&one, terminal, &mut SequenceState::default())?;
    let pieces = session.pieces().map_err(|why| {
        let name = started.planned.render.name;
        Failure::bad_input(format!("this render cannot be computed in chunks by '{name}': {why}"))
    })?;
    let frames = args.render.frames.map(|range| [range.first, range.last]);
    let count = frames.map_or(1, |[first, last]| last - first + 1);
    if u64::from(args.chunks) > u64::from(pieces) * u64::from(count) {
        let all = u64::from(pieces) * u64::from(count);
        return Err(Failure::bad_input(format!("--chunks {}: the render falls into {all} pieces only", args.chunks)));
    }
    let Some(recipe) = &started.recipe else { return Err(Failure::failed("the scene has no fingerprint")) };
    let job = JobFile {
        steradian: version().into(),
        scene: recipe.scene(),
        arguments: words(&matches)?,
        frames,
        pieces,
        chunks: args.chunks,
    };
    job.write(folder)?;
    terminal.say(&format!("planned {count} x {pieces} pieces in {} chunks: {}", args.chunks, folder.display()));
    Ok(Planned { pieces, frames: count })
}

/// The default pictures of a render, in a folder.
pub fn pictures_in(folder: &Path, args: &RenderArgs) -> Vec<PathBuf> {
    let names = output::default_names(args.scene.as_deref().unwrap_or(Path::new("builtin:cornell-box")));
    names.iter().map(|name| folder.join(name)).collect()
}

/// The arguments that the command line gives to the render.
fn words(matches: &ArgMatches) -> Result<Vec<String>, Failure> {
    let (mut words, render) = (Vec::new(), RenderArgs::augment_args(Command::new("render")));
    for arg in render.get_arguments() {
        let id = arg.get_id().as_str();
        let is_given = matches.try_contains_id(id).unwrap_or(false);
        if !is_given
            || matches.value_source(id) != Some(ValueSource::CommandLine)
            || ["output", "json", "quiet", "progress"].contains(&id)
        {
            continue;
        }
        let name = match (arg.get_long(), arg.get_short()) {
            (Some(long), _) => format!("--{long}"),
            (None, Some(short)) => format!("-{short}"),
            (None, None) => String::new(),
        };
        if matches!(arg.get_action(), ArgAction::SetTrue) {
            words.push(name);
            continue;
        }
        for values in matches.get_raw_occurrences(id).into_iter().flatten() {
            let values: Result<Vec<&str>, _> = values.map(|value| value.to_str().ok_or(value)).collect();
            let values = values.map_err(|value| {
                Failure::bad_input(format!("a job cannot hold '{}', which is no UTF-8", value.to_string_lossy()))
            })?;
            match (&*name, &*values) {
                // The scene, by a name that holds in any folder.
                ("", [scene]) if open::is_file(Path::new(scene)) => {
                    words.push(std::path::absolute(scene)?.to_string_lossy().into_owned());
                }
                ("", values) => words.extend(values.iter().map(|value| (*value).to_owned())),
                (_, []) => words.push(name.clone()),
                (_, values) if name.starts_with("--") => words.push(format!("{name}={}", values.join(","))),
                (_, values) => words.extend(values.iter().flat_map(|value| [name.clone(), (*value).to_owned()])),
            }
        }
    }
    Ok(words)
}
