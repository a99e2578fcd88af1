//! `steradian chunk`: computes chunks of a job.

use super::job_file::{JobFile, Part, state_of};
use crate::{
    args::RenderArgs,
    checkpoint::Checkpoint,
    failure::{self, Failure, Outcome},
    frames, open,
    progress::Progress,
    render::Started,
    sequence_state::SequenceState,
    terminal::{self, Talk, Terminal},
    values::{self, Chunks},
    watch::{self, Stop},
};
use clap::Args;
use serde::Serialize;
use std::{
    io,
    path::{Path, PathBuf},
};
use steradian::{
    Session,
    math::DVec3,
    quality::MAX_THREADS,
    resume::{self, Recipe},
};

/// `steradian chunk`.
#[derive(Args, Debug)]
#[command(after_help = "A chunk whose result is there already ends at once, and one that was stopped goes on. \
    Exit codes: 0 the result is there, 75 stopped or not written, try again; others are final.")]
pub struct ChunkArgs {
    /// Folder of the job
    pub job: PathBuf,
    /// Number of the chunk, from 0; or the first and the last of several, 0..9; or - for numbers from standard input,
    /// one a line, each answered on standard output when it is done: {"chunk":3,"code":0}
    #[arg(value_name = "K|A..B|-", value_parser = values::chunks, allow_hyphen_values = true)]
    pub chunks: Chunks,
    /// The scene, where it lies elsewhere on this machine
    #[arg(long, value_name = "FILE")]
    pub scene: Option<PathBuf>,
    /// Number of threads; 0 is one per processor. Does not change the picture
    #[arg(long, value_name = "N", default_value_t = 0)]
    #[arg(value_parser = clap::value_parser!(u16).range(0..=MAX_THREADS as i64))]
    pub threads: u16,
    /// Messages.
    #[command(flatten)]
    pub talk: Talk,
}

/// Answer to a number on standard input.
#[derive(Serialize)]
struct Answer {
    chunk: u32,
    code: u8,
}

/// Computes the chunks that are not there yet, one after the other.
pub fn run(args: &ChunkArgs, terminal: Terminal) -> Outcome {
    let job = JobFile::read(&args.job)?;
    let mut render = job.render_args(&args.job, args.scene.as_deref())?;
    render.scene_options.threads = args.threads;
    let framing = render.frames.and_then(|all| frames::framing(&render, all));
    let mut worker = Worker { job: &job, folder: &args.job, render, framing, terminal, answers: false };
    match &args.chunks {
        Chunks::Range(range) => {
            job.check(*range.end())?;
            worker.compute(range.clone().map(Ok))
        }
        Chunks::FromInput => {
            worker.answers = true;
            let number = |line: io::Result<String>| {
                let line = line.map_err(|e| Failure::failed(format!("cannot read {}: {e}", open::STDIN)))?;
                let wrong = |_| Failure::bad_input(format!("'{line}' on {} is no number of a chunk", open::STDIN));
                let chunk = line.trim().parse().map_err(wrong)?;
                job.check(chunk).map(|()| chunk)
            };
            worker.compute(io::stdin().lines().map(number))
        }
    }
}

/// A process that computes chunks of a job.
struct Worker<'a> {
    job: &'a JobFile,
    folder: &'a Path,
    /// The render of all frames, and the box that cameras show in them.
    render: RenderArgs,
    framing: Option<[DVec3; 2]>,
    terminal: Terminal,
    /// True if chunks are answered on standard output.
    answers: bool,
}

/// A frame whose scene was read, with the session that computes its parts.
struct OpenFrame<'a> {
    started: Started<'a>,
    session: Box<dyn Session>,
    recipe: Recipe,
}

impl Worker<'_> {
    /// Computes chunks as their numbers come. The scene of a frame is read once for all parts of it that follow each
    /// other, and no number is asked for before the last one is done.
    fn compute(&self, chunks: impl Iterator<Item = Result<u32, Failure>>) -> Outcome {
        let parts = chunks.flat_map(|chunk| match chunk {
            Ok(chunk) => self.job.parts(chunk).into_iter().map(|part| Ok((chunk, part))).collect(),
            Err(failure) => vec![Err(failure)],
        });
        let mut parts = parts.peekable();
        let (mut asked, mut computed) = (0, 0);
        while let Some(next) = parts.peek() {
            let frame = next.as_ref().ok().and_then(|(_, part)| part.frame);
            let args = self.args_of(frame);
            let mut open = None;
            while let Some(next) = parts.next_if(|next| next.as_ref().is_ok_and(|(_, part)| part.frame == frame)) {
                let (chunk, part) = next?;
                asked += 1;
                if !self.is_there(chunk, &part) {
                    let open = match &mut open {
                        Some(open) => open,
                        None => open.insert(self.open(&args, &part)?),
                    };
                    let code = self.part(open, chunk, &part)?;
                    if code != failure::DONE {
                        return Ok(code);
                    }
                    computed += 1;
                }
                if self.answers && self.job.parts(chunk).last() == Some(&part) {
                    terminal::json(&Answer { chunk, code: failure::DONE })?;
                }
            }
            if let Some(Err(_)) = parts.peek() {
                return parts.next().map_or(Ok(failure::DONE), |failed| failed.map(|_| failure::DONE));
            }
        }
        if asked > 0 && computed == 0 {
            self.terminal.say("all of it is there already");
        }
        Ok(failure::DONE)
    }

    /// True if the result of a part is in its file.
    fn is_there(&self, chunk: u32, part: &Part) -> bool {
        resume::state_file(&state_of(self.folder, chunk, part))
            .is_ok_and(|there| there.is_finished && part.is_kept_in(&there, self.job))
    }

    /// The render of a frame.
    fn args_of(&self, frame: Option<u32>) -> RenderArgs {
        let mut args =
            frame.map_or_else(|| self.render.clone(), |frame| frames::one(&self.render, frame, self.framing));
        args.output = super::plan::pictures_in(self.folder, &args);
        args.is_of_job = true;
        args
    }

    /// Reads the scene of a part, if it is that of the job.
    fn open<'a>(&self, args: &'a RenderArgs, part: &Part) -> Result<OpenFrame<'a>, Failure> {
        let (started, session) = Started::new(args, self.terminal, &mut SequenceState::default())?;
        let recipe = started.recipe.clone().ok_or_else(|| Failure::failed("the scene has no fingerprint"))?;
        if !part.may_be_of(&recipe.scene(), self.job) {
            let why = "belongs to another scene, or the scene's files have changed since it was planned";
            return Err(Failure::bad_input(format!("'{}' {why}", self.folder.display())));
        }
        started.tell();
        Ok(OpenFrame { started, session, recipe })
    }

    /// Computes a part of a chunk.
    fn part(&self, open: &mut OpenFrame<'_>, chunk: u32, part: &Part) -> Outcome {
        let Self { job, folder, terminal, .. } = *self;
        let OpenFrame { started, session, recipe } = open;
        let begin = |session: &mut dyn Session| {
            session.restrict(part.pieces.clone()).map_err(|why| Failure::bad_input(why.to_string()))
        };
        begin(&mut **session)?;
        let path = state_of(folder, chunk, part);
        let checkpoint =
            Checkpoint { path: &path, recipe: recipe.clone().of_pieces(&part.pieces, job.pieces), terminal };
        if path.exists() {
            match checkpoint.recipe.restore(&mut **session, &path) {
                Ok(()) => terminal.say(&format!("going on from {}", path.display())),
                // No state is worth a chunk that can never be computed.
                Err(why) => {
                    terminal.warn(&format!("{} {why}; the chunk begins anew", path.display()));
                    begin(&mut **session)?;
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
        let stop = watch::render(&mut **session, amount.into(), limits, &started.signals, progress, on_the_way);
        if let Some(why) = session.failure() {
            return Err(Failure::failed(why));
        }
        checkpoint.save(&mut **session).map_err(|message| Failure { code: failure::TRY_AGAIN, message })?;
        if let Some(Stop::Signal(_)) = stop {
            terminal.warn(&format!("chunk {chunk} was stopped; the same command goes on from {}", path.display()));
            return Ok(failure::TRY_AGAIN);
        }
        terminal.say(&format!("chunk {chunk} of {} is there", job.chunks));
        Ok(failure::DONE)
    }
}
