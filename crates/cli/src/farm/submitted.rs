//! A job that an engine computes, followed by the files that appear in its folder.

use super::{counting::Counting, engines::Engine, local::terminate};
use crate::{
    chunks::job_file::JobFile,
    failure::{self, Failure, Outcome},
    signals::{self, Signals},
    terminal::Terminal,
};
use std::{
    path::{Path, PathBuf},
    process::{Child, Command, Stdio},
    thread,
    time::{Duration, Instant},
};

/// Interval between looks at signals and at the command that submits.
const LOOK_EVERY: Duration = Duration::from_millis(50);
/// Interval between looks at the folder, which may lie far away.
const COUNT_EVERY: Duration = Duration::from_secs(2);

/// The command that submits to an engine, which can be run.
///
/// # Errors
/// Engines without one; tools that are not there.
pub fn check(engine: Engine, folder: &str) -> Result<Vec<String>, Failure> {
    let Some((tool, words)) = engine.submission(folder) else {
        return Err(Failure::bad_input("--submit cannot submit to flamenco, whose manager has to be told by hand"));
    };
    if on_path(tool).is_none() {
        return Err(Failure::bad_input(format!("--submit takes the program '{tool}', which is not on PATH")));
    }
    Ok(words)
}

/// Submits the job and waits until all chunks are there.
///
/// # Errors
/// A command that cannot be run or fails.
pub fn run(words: &[String], job: &JobFile, folder: &Path, terminal: Terminal) -> Outcome {
    let [program, arguments @ ..] = words else { return Ok(failure::DONE) };
    let failed = |why: String| Failure::failed(format!("{program}: {why}"));
    let mut command = Command::new(program);
    // Standard output is for data.
    command.args(arguments).stdin(Stdio::null()).stdout(std::io::stderr());
    #[cfg(unix)]
    std::os::unix::process::CommandExt::process_group(&mut command, 0);
    let signals = Signals::watch();
    let mut child = command.spawn().map_err(|e| failed(e.to_string()))?;
    let mut left: Vec<u32> = (0..job.chunks).filter(|chunk| !job.has(folder, *chunk)).collect();
    let mut counting = Counting::new(job.chunks, job.chunks - left.len() as u32, terminal);
    let mut counted = Instant::now();
    let end = loop {
        if let Some(signal) = signals.came() {
            break stopped(&mut child, signal, terminal);
        }
        let status = child.try_wait()?;
        if let Some(status) = status.filter(|status| !status.success()) {
            break Err(failed(status.to_string()));
        }
        if counted.elapsed() >= COUNT_EVERY || status.is_some() {
            left.retain(|chunk| !job.has(folder, *chunk));
            counted = Instant::now();
        }
        counting.show(job.chunks - left.len() as u32);
        if status.is_some() && left.is_empty() {
            break Ok(failure::DONE);
        }
        thread::sleep(if status.is_some() { COUNT_EVERY.min(LOOK_EVERY * 10) } else { LOOK_EVERY });
    };
    counting.finish();
    if matches!(end, Ok(failure::DONE)) {
        terminal.say("all chunks are there; the engine's last step merges them");
    }
    end
}

/// Ends the command that submits, if it is still there; what was submitted goes on.
fn stopped(child: &mut Child, signal: u8, terminal: Terminal) -> Outcome {
    if child.try_wait()?.is_none() {
        terminate(child);
        child.wait()?;
    }
    terminal.warn(&format!("stopped by {}; what was submitted goes on", signals::name(signal)));
    Ok(128 + signal)
}

/// The file of a program, if it is on PATH.
fn on_path(program: &str) -> Option<PathBuf> {
    let path = std::env::var_os("PATH")?;
    let file = format!("{program}{}", std::env::consts::EXE_SUFFIX);
    std::env::split_paths(&path).map(|folder| folder.join(&file)).find(|file| file.is_file())
}
