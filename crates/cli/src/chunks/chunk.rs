//! `steradian chunk`: computes chunks of a job.

use super::job_file::{JobFile, Part, state_of};
use crate::{
    args::RenderArgs,
    checkpoint::Checkpoint,
    failure::{self, Failure, Outcome},
    frames,
    progress::Progress,
    render::Started,
    sequence_state::SequenceState,
    terminal::Terminal,
    values,
    watch::{self, Stop},
};
use clap::Args;
use std::{
    ops::RangeInclusive,
    path::{Path, PathBuf},
};
use steradian::{Session, quality::MAX_THREADS, resume};

/// `steradian chunk`.
#[derive(Args, Debug)]
#[command(after_help = "A chunk whose result is there already ends at once, and one that was stopped goes on. \
    Exit codes: 0 the result is there, 75 stopped or not written, try again; others are final.")]
pub struct ChunkArgs {
    /// Folder of the job
    pub job: PathBuf,
    /// Number of the chunk, from 0, or the first and the last of several: 0..9
    #[arg(value_name = "K|A..B", value_parser = values::chunks)]
    pub chunks: RangeInclusive<u32>,
    /// The scene, where it lies elsewhere on this machine
    #[arg(long, value_name = "FILE")]
    pub scene: Option<PathBuf>,
    /// Number of threads; 0 is one per processor. Does not change the picture
    #[arg(long, value_name = "N", default_value_t = 0)]
    #[arg(value_parser = clap::value_parser!(u16).range(0..=MAX_THREADS as i64))]
    pub threads: u16,
    /// Print errors only
    #[arg(short, long)]
    pub quiet: bool,
}

/// Computes the chunks that are not there yet, one after the other.
pub fn run(args: &ChunkArgs, terminal: Terminal) -> Outcome {
    let job = JobFile::read(&args.job)?;
    let (first, last) = (*args.chunks.start(), *args.chunks.end());
    if last >= job.chunks {
        let of = job.chunks - 1;
        return Err(Failure::bad_input(format!("there is no chunk {last}: those of this job are 0 to {of}")));
    }
    let mut render = job.render_args(&args.job, args.scene.as_deref())?;
    render.scene_options.threads = args.threads;
    let of_chunk = |chunk| job.parts(chunk).into_iter().map(move |part| (chunk, part));
    let left = (first..=last).flat_map(of_chunk).filter(|(chunk, part)| !is_there(&job, &args.job, *chunk, part));
    let left: Vec<(u32, Part)> = left.collect();
    if left.is_empty() {
        terminal.say("all of it is there already");
        return Ok(failure::DONE);
    }
    let framing = render.frames.and_then(|all| frames::framing(&render, all));
    // The scene of a frame is read once for all parts of it.
    for parts in left.chunk_by(|a, b| a.1.frame == b.1.frame) {
        let mut one = parts[0].1.frame.map_or_else(|| render.clone(), |frame| frames::one(&render, frame, framing));
        one.output = super::plan::pictures_in(&args.job, &one);
        one.resume = Some(args.job.join("chunk.part"));
        let code = compute(&job, &args.job, &one, parts, terminal)?;
        if code != failure::DONE {
            return Ok(code);
        }
    }
    Ok(failure::DONE)
}

/// True if the result of a part is in its file.
fn is_there(job: &JobFile, folder: &Path, chunk: u32, part: &Part) -> bool {
    resume::state_file(&state_of(folder, chunk, part))
        .is_ok_and(|there| there.is_finished && part.is_kept_in(&there, job))
}

/// Computes parts of chunks, all of one frame.
fn compute(job: &JobFile, folder: &Path, args: &RenderArgs, parts: &[(u32, Part)], terminal: Terminal) -> Outcome {
    let (started, first) = Started::new(args, terminal, &mut SequenceState::default())?;
    let recipe = started.recipe.as_ref().ok_or_else(|| Failure::failed("the scene has no fingerprint"))?;
    if !parts[0].1.may_be_of(&recipe.scene(), job) {
        let why = "belongs to another scene, or the scene's files have changed since it was planned";
        return Err(Failure::bad_input(format!("'{}' {why}", folder.display())));
    }
    started.tell();
    let mut first = Some(first);
    for (chunk, part) in parts {
        let mut begin = || -> Result<Box<dyn Session>, Failure> {
            let mut session = first.take().map_or_else(|| started.session(), Ok)?;
            session.restrict(part.pieces.clone()).map_err(|why| Failure::bad_input(why.to_string()))?;
            Ok(session)
        };
        let mut session = begin()?;
        let path = state_of(folder, *chunk, part);
        let checkpoint =
            Checkpoint { path: &path, recipe: recipe.clone().of_pieces(&part.pieces, job.pieces), terminal };
        if path.exists() {
            match checkpoint.recipe.restore(&mut *session, &path) {
                Ok(()) => terminal.say(&format!("going on from {}", path.display())),
                // No state is worth a chunk that can never be computed.
                Err(why) => {
                    terminal.warn(&format!("{} {why}; the chunk begins anew", path.display()));
                    session = begin()?;
                }
            }
        }
        let share = f64::from(part.pieces.len() as u32) / f64::from(job.pieces);
        let amount = [started.planned.pixels, started.planned.planned].map(|all| (all as f64 * share) as u64);
        let on_the_way = |session: &mut dyn Session, due: watch::Due| {
            if due.state {
                checkpoint.keep(session);
            }
        };
        let (progress, limits) = (|| Progress::new(terminal), (None, None));
        let stop = watch::render(&mut *session, amount.into(), limits, &started.signals, progress, on_the_way);
        if let Some(why) = session.failure() {
            return Err(Failure::failed(why));
        }
        checkpoint.save(&mut *session).map_err(|message| Failure { code: failure::TRY_AGAIN, message })?;
        if let Some(Stop::Signal(_)) = stop {
            terminal.warn(&format!("chunk {chunk} was stopped; the same command goes on from {}", path.display()));
            return Ok(failure::TRY_AGAIN);
        }
        terminal.say(&format!("chunk {chunk} of {} is there", job.chunks));
    }
    Ok(failure::DONE)
}
