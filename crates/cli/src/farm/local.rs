//! Worker processes of this machine: each computes one chunk after the other, as long as there are some.

use super::{counting::Counting, engines::TRIES};
use crate::{
    chunks::job_file::JobFile,
    failure::{self, Failure},
    signals::Signals,
    terminal::Terminal,
};
use std::{
    collections::VecDeque,
    io::Read,
    path::Path,
    process::{Child, Command, Stdio},
    sync::{Mutex, MutexGuard, PoisonError, mpsc},
    thread,
    time::Duration,
};

/// Interval between looks at what the workers do.
const LOOK_EVERY: Duration = Duration::from_millis(50);

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
        loop {
            // The lock is not held while the chunk is computed.
            let taken = locked(&self.queue).pop_front();
            let Some((chunk, tries)) = taken else { return };
            let code = match self.chunk(worker, chunk) {
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

    /// Computes a chunk by a process, and gives its exit code; `None` if all are told to stop.
    fn chunk(&self, worker: usize, chunk: u32) -> std::io::Result<Option<Option<i32>>> {
        let mut stdout = {
            let mut processes = locked(&self.processes);
            let Some(processes) = &mut *processes else { return Ok(None) };
            let mut child = self.command(chunk)?.spawn()?;
            let stdout = child.stdout.take();
            processes[worker] = Some(child);
            stdout
        };
        // It ends when the process does. Until it is waited for, its number stays its own.
        if let Some(stdout) = &mut stdout {
            stdout.read_to_end(&mut Vec::new())?;
        }
        let child = locked(&self.processes).as_mut().and_then(|processes| processes[worker].take());
        child.map(|mut child| Ok(child.wait()?.code())).transpose()
    }

    fn command(&self, chunk: u32) -> std::io::Result<Command> {
        let mut command = Command::new(std::env::current_exe()?);
        command.arg("chunk").arg(self.folder).args([&chunk.to_string(), "--quiet"]);
        command.args(["--threads", &self.threads.to_string()]).stdin(Stdio::null()).stdout(Stdio::piped());
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
            let _ = child.wait();
        }
    }
}

/// Asks a process to end.
pub fn terminate(child: &mut Child) {
    #[cfg(unix)]
    let _ = rustix::process::kill_process(rustix::process::Pid::from_child(child), rustix::process::Signal::TERM);
    #[cfg(not(unix))]
    let _ = child.kill();
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
