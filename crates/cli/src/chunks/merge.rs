//! `steradian merge`: puts the chunks of a job together, or pictures of several seeds and parts of a frame.

use super::job_file::{JobFile, Part, state_of};
use crate::{
    failure::{self, Failure, Outcome},
    frames, output,
    render::Started,
    sequence_state::SequenceState,
    terminal::{self, Talk, Terminal},
};
use clap::Args;
use serde::Serialize;
use std::path::{Path, PathBuf};
use steradian::{
    Inputs,
    image::{Limits, WriteOptions},
    merge, resume,
};

/// `steradian merge`.
#[derive(Args, Debug)]
#[command(after_help = "Exit codes: 0 the picture is written, 75 chunks are missing or not done; others are final.")]
pub struct MergeArgs {
    /// Folder of a job (`steradian plan`). Or, with --output, pictures of one view: renders with different --seed,
    /// which are averaged by their samples, and with different --crop, which are put in their places
    #[arg(required = true, value_name = "JOB|PART")]
    pub parts: Vec<PathBuf>,
    /// Output file (.exr .png .hdr .pfm .ppm .jpg .dds .ktx2). Repeatable. Default of a job: SCENE.exr and SCENE.png in
    /// the current folder
    #[arg(short, long, value_name = "OUT")]
    pub output: Vec<PathBuf>,
    /// The scene, where it lies elsewhere on this machine
    #[arg(long, value_name = "FILE")]
    pub scene: Option<PathBuf>,
    /// Messages.
    #[command(flatten)]
    pub talk: Talk,
    /// Print one line of JSON about each picture to stdout
    #[arg(long)]
    pub json: bool,
}

/// Joins all chunks of each frame, and writes its picture.
pub fn run(args: &MergeArgs, terminal: Terminal) -> Outcome {
    let folder = match &*args.parts {
        [folder] if folder.is_dir() => folder,
        parts => return merge_pictures(parts, args, terminal),
    };
    let job = JobFile::read(folder)?;
    check(&job, folder)?;
    let mut render = job.render_args(folder, args.scene.as_deref())?;
    (render.output, render.json, render.talk) = (args.output.clone(), args.json, args.talk);
    let framing = render.frames.and_then(|all| frames::framing(&render, all));
    let mut before = SequenceState::default();
    for frame in job.all_frames() {
        let mut one = frame.map_or_else(|| render.clone(), |frame| frames::one(&render, frame, framing));
        one.is_of_job = true;
        let parts = job.parts_of(frame);
        let (started, mut session) = Started::new(&one, terminal, &mut SequenceState::default())?;
        let recipe = started.recipe.clone().ok_or_else(|| Failure::failed("the scene has no fingerprint"))?;
        for (chunk, part) in &parts {
            let path = state_of(folder, *chunk, part);
            recipe
                .join(&mut *session, &path)
                .map_err(|why| Failure::bad_input(format!("chunk {chunk}: {} {why}", path.display())))?;
        }
        let code = started.finish(session, None, None, &mut before)?;
        if code != failure::DONE {
            return Ok(code);
        }
    }
    Ok(failure::DONE)
}

/// Merges pictures.
fn merge_pictures(parts: &[PathBuf], args: &MergeArgs, terminal: Terminal) -> Outcome {
    if let Some(folder) = parts.iter().find(|part| part.is_dir()) {
        return Err(Failure::bad_input(format!("'{}' is a folder; a job is merged alone", folder.display())));
    }
    if args.output.is_empty() {
        return Err(Failure::bad_input("to merge pictures takes an output: steradian merge A.exr B.exr -o OUT.exr"));
    }
    if args.scene.is_some() {
        return Err(Failure::bad_input("--scene is of jobs; pictures are merged without their scene"));
    }
    args.output.iter().try_for_each(|output| output::kind(output).map(drop))?;
    let inputs = Inputs::of(parts.iter().map(PathBuf::as_path));
    output::claim(args.output.iter().map(PathBuf::as_path), &inputs)?;
    let read = |path: &PathBuf| {
        let read = steradian::image::read(path, &Limits::default()).map_err(|e| Failure::bad_input(e.to_string()))?;
        Ok((path.display().to_string(), read))
    };
    let pictures = parts.iter().map(read).collect::<Result<Vec<_>, Failure>>()?;
    let count = pictures.len();
    let merged = merge::merge(pictures).map_err(|why| Failure::bad_input(why.to_string()))?;
    let written = output::save(&args.output, &merged, &WriteOptions::default(), true)?;
    let (width, height) = (merged.width(), merged.height());
    terminal.say(&format!("merged {count} pictures: {width} x {height}"));
    terminal.say(&format!("wrote {}", output::listed(&written)));
    if args.json {
        terminal::json(&Summary { schema: 1, parts: count, width, height, outputs: &written })?;
    }
    Ok(failure::DONE)
}

/// Summary of merged pictures, as `--json` prints it.
#[derive(Serialize)]
struct Summary<'a> {
    schema: u32,
    parts: usize,
    width: usize,
    height: usize,
    outputs: &'a [PathBuf],
}

/// Refuses jobs whose parts are not all there, by the numbers of their chunks.
fn check(job: &JobFile, folder: &Path) -> Result<(), Failure> {
    let (mut missing, mut undone) = (Vec::new(), Vec::new());
    for chunk in 0..job.chunks {
        let states: Vec<_> = job.parts(chunk).iter().map(|part| state(job, folder, chunk, part)).collect();
        for state in states {
            match state? {
                Progress::Done => {}
                Progress::Begun if undone.last() != Some(&chunk) => undone.push(chunk),
                Progress::Missing if missing.last() != Some(&chunk) => missing.push(chunk),
                _ => {}
            }
        }
    }
    if missing.is_empty() && undone.is_empty() {
        return Ok(());
    }
    let of = |chunks: &[u32], what: &str| (!chunks.is_empty()).then(|| format!("{what}: {}", ranges(chunks)));
    let faults: Vec<String> = of(&missing, "missing").into_iter().chain(of(&undone, "not done")).collect();
    let message = format!("of {} chunks some are not there: {}", job.chunks, faults.join("; "));
    Err(Failure { code: failure::TRY_AGAIN, message })
}

/// Progress of a part.
enum Progress {
    Missing,
    Begun,
    Done,
}

fn state(job: &JobFile, folder: &Path, chunk: u32, part: &Part) -> Result<Progress, Failure> {
    let path = state_of(folder, chunk, part);
    if !path.exists() {
        return Ok(Progress::Missing);
    }
    let refuse = |why: String| Failure::bad_input(format!("chunk {chunk}: {} {why}", path.display()));
    let there = resume::state_file(&path).map_err(|why| refuse(why.to_string()))?;
    if !part.is_kept_in(&there, job) {
        return Err(refuse("is of another job".into()));
    }
    Ok(if there.is_finished { Progress::Done } else { Progress::Begun })
}

/// `3, 7-9`.
fn ranges(numbers: &[u32]) -> String {
    let runs = numbers.chunk_by(|a, b| a + 1 == *b).map(|run| match run {
        [one] => one.to_string(),
        [first, .., last] => format!("{first}-{last}"),
        [] => String::new(),
    });
    runs.collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::ranges;

    #[test]
    fn numbers_in_a_row_are_a_range() {
        assert_eq!(ranges(&[3, 7, 8, 9, 12]), "3, 7-9, 12");
        assert_eq!(ranges(&[0]), "0");
    }
}
