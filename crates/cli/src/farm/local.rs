//! Worker processes of this machine: each keeps its scene open and computes one chunk after the other, as long as there
//! are some.

use super::{counting::Counting, engines::TRIES};
use crate::{
    chunks::job_file::JobFile,
    failure::{self, Failure},
    signals::Signals,
    terminal::Terminal,
};
use serde::Deserialize;
use std::{
    collections::VecDeque,
    io::{self, BufRead, BufReader, Write},
    path::Path,
    process::{Child, ChildStdout, Command, Stdio},
    sync::{Mutex, MutexGuard, PoisonError, mpsc},
    thread,
    time::Duration,
};

/// Interval between looks at what the workers do.
const LOOK_EVERY: Duration = Duration::from_millis(50);

/// Answer of a worker.
#[derive(Deserialize)]
struct Answer {
    chunk: u32,
    code: u8,
}

/// State that the workers share.
struct Crew<'a> {
    folder: &'a Path,
    threads: u32,
    /// Chunks that nobody computes, with the number of times that each was tried.
    queue: Mutex<VecDeque<(u32, u32)>>,
    /// The processes, none where a worker has none; `None` once all are told to stop.
    processes: Mutex<Option<Vec<Option<Child>>>>,
    /// Why the job is given up.
    fault: Mutex<Option<Failure>>,
}

/// Computes the chunks that are not there yet. Gives the signal that ended it before.
///
/// # Errors
/// The first chunk that failed for good, or too often.
pub fn compute(
    job: &JobFile,
    folder: &Path,
    (workers, threads): (u32, u32),
    terminal: Terminal,
) -> Result<Option<u8>, Failure> {
    let queue: VecDeque<(u32, u32)> = (0..job.chunks).filter(|k| !job.has(folder, *k)).map(|k| (k, 0)).collect();
    let mut done = job.chunks - queue.len() as u32;
    let workers = (workers as usize).min(queue.len());
    let crew = Crew {
        folder,
        threads,
        queue: queue.into(),
        processes: Some((0..workers).map(|_| None).collect()).into(),
        fault: Mutex::default(),
    };
    let signals = Signals::watch();
    let mut counting = Counting::new(job.chunks, done, terminal);
    thread::scope(|scope| {
        let (sender, receiver) = mpsc::channel();
        for worker in 0..workers {
            let (crew, sender) = (&crew, sender.clone());
            scope.spawn(move || crew.work(worker, &sender));
        }
        drop(sender);
        loop {
            counting.show(done);
            match receiver.recv_timeout(LOOK_EVERY) {
                Ok(()) => done += 1,
                Err(mpsc::RecvTimeoutError::Disconnected) => break,
                Err(mpsc::RecvTimeoutError::Timeout) if signals.came().is_some() => crew.stop(),
                Err(mpsc::RecvTimeoutError::Timeout) => {}
            }
        }
    });
    counting.finish();
    if let Some(fault) = crew.fault.into_inner().unwrap_or_else(PoisonError::into_inner) {
        return Err(fault);
    }
    Ok(signals.came().filter(|_| done < job.chunks))
}

impl Crew<'_> {
    /// Takes chunks from the queue until it is empty; tells of each that is there.
    fn work(&self, worker: usize, done: &mpsc::Sender<()>) {
        let mut answers = None;
        loop {
            // The lock is not held while the chunk is computed.
            let taken = locked(&self.queue).pop_front();
            let Some((chunk, tries)) = taken else { return self.dismiss(worker) };
            let code = match self.chunk(worker, &mut answers, chunk) {
                Ok(Some(code)) => code,
                Ok(None) => return,
                Err(why) => return self.give_up(Failure::failed(format!("cannot start a worker: {why}"))),
            };
            match code {
                Some(0) => {
                    let _ = done.send(());
                }
                // A process without a code was killed.
                None | Some(75) if tries + 1 < TRIES => locked(&self.queue).push_back((chunk, tries + 1)),
                None | Some(75) => {
                    return self.give_up(Failure::failed(format!("chunk {chunk} was tried {TRIES} times in vain")));
                }
                Some(code) => {
                    let message = format!("chunk {chunk} failed with code {code}");
                    let code = if code == i32::from(failure::BAD_INPUT) { failure::BAD_INPUT } else { failure::FAILED };
                    return self.give_up(Failure { code, message });
                }
            }
        }
    }

    /// Has a chunk computed by the worker's process, which is started where there is none. Gives 0 when it answers, or
    /// the code with which it ends instead; `None` if all are told to stop.
    fn chunk(
        &self,
        worker: usize,
        answers: &mut Option<BufReader<ChildStdout>>,
        chunk: u32,
    ) -> io::Result<Option<Option<i32>>> {
        {
            let mut processes = locked(&self.processes);
            let Some(processes) = &mut *processes else { return Ok(None) };
            if processes[worker].is_none() {
                let child = processes[worker].insert(self.command()?.spawn()?);
                *answers = child.stdout.take().map(BufReader::new);
            }
            if let Some(stdin) = processes[worker].as_mut().and_then(|child| child.stdin.as_mut()) {
                // One that has ended does not answer, either.
                let _ = writeln!(stdin, "{chunk}");
            }
        }
        let mut line = String::new();
        if let Some(answers) = answers {
            answers.read_line(&mut line)?;
        }
        if serde_json::from_str(&line).is_ok_and(|answer: Answer| answer.chunk == chunk && answer.code == 0) {
            return Ok(Some(Some(0)));
        }
        // Until it is waited for, its number stays its own.
        let child = locked(&self.processes).as_mut().and_then(|processes| processes[worker].take());
        child.map(|mut child| Ok(child.wait()?.code().filter(|code| *code != 0))).transpose()
    }

    /// Lets the worker's process end: it has no more input.
    fn dismiss(&self, worker: usize) {
        let child = locked(&self.processes).as_mut().and_then(|processes| processes[worker].take());
        if let Some(mut child) = child {
            let _ = child.wait();
        }
    }

    fn command(&self) -> io::Result<Command> {
        let mut command = Command::new(std::env::current_exe()?);
        command.arg("chunk").arg(self.folder).args(["-", "--quiet", "--threads", &self.threads.to_string()]);
        command.stdin(Stdio::piped()).stdout(Stdio::piped());
        // Signals of the terminal come to the workers through this process, once.
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(&mut command, 0);
        Ok(command)
    }

    fn give_up(&self, why: Failure) {
        locked(&self.fault).get_or_insert(why);
        self.stop();
    }

    /// Tells all workers to stop; what they have they keep.
    fn stop(&self) {
        let processes = locked(&self.processes).take();
        let mut children: Vec<Child> = processes.into_iter().flatten().flatten().collect();
        children.iter_mut().for_each(terminate);
        for child in &mut children {
            // Its input ends here, for one that waits for a number.
            let _ = child.wait();
        }
    }
}

/// Asks a process to end.
pub fn terminate(child: &mut Child) {
    #[cfg(unix)]
    let _ = Command::new("sh").args(["-c", "kill -TERM \"$0\"", &child.id().to_string()]).status();
    #[cfg(not(unix))]
    let _ = child.kill();
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
