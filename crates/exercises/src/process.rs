//! A learner's program under questions: bounded in time and memory, whatever it does.

use crate::protocol::{Question, Reply};
use std::{
    io::{BufRead, BufReader, Read, Write},
    process::{Child, Command, Output, Stdio},
    sync::{Arc, Mutex, mpsc},
    thread,
    time::{Duration, Instant},
};

/// Most bytes of a reply.
const LINE: u64 = 1 << 16;
/// Most bytes that are kept of what a program prints for its author.
const PRINTED: usize = 1 << 14;
/// Replies that may wait between the threads.
const WAITING: usize = 256;
/// Time that a program has to end after its last answer.
const FAREWELL: Duration = Duration::from_secs(2);
/// Longest wait for a line, a byte or an end until a wish to stop is answered.
const LOOK_EVERY: Duration = Duration::from_millis(50);

/// Replies to the first questions, and why there are no more.
#[derive(Debug)]
pub(crate) struct Asked {
    pub replies: Vec<Reply>,
    pub stop: Option<Stop>,
    /// Output on stderr, its beginning.
    pub printed: String,
}

/// A reason for which a program gave no more replies.
#[derive(Debug, PartialEq)]
pub(crate) enum Stop {
    /// It ended, in these words.
    Ended(String),
    Timeout,
    /// A line that is no reply, its beginning.
    NoReply(String),
    /// A line without end.
    Flood,
    /// The file with the functions cannot be loaded.
    Broken(String),
    /// The check itself is to stop.
    Asked,
}

/// Ends a program that is no longer needed, with all that it started.
struct Guard(Child);

impl Guard {
    /// Starts a program in a process group of its own, which signals of the terminal do not reach.
    fn spawn(command: &mut Command) -> std::io::Result<Self> {
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(command, 0);
        command.spawn().map(Self)
    }
}

impl Drop for Guard {
    fn drop(&mut self) {
        #[cfg(unix)]
        let _ = Command::new("sh")
            .args(["-c", "kill -KILL \"-$0\"", &self.0.id().to_string()])
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .status();
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Request to stop a check: true if there is one.
pub(crate) type Stopping<'a> = &'a dyn Fn() -> bool;

/// Output of a tool until it ends; `None` if the check is to stop before.
///
/// # Errors
/// The system's, if the tool cannot be started.
pub(crate) fn output(command: &mut Command, stopping: Stopping<'_>) -> std::io::Result<Option<Output>> {
    let mut tool = Guard::spawn(command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped()))?;
    let (stdout, stderr) = (all_of(tool.0.stdout.take()), all_of(tool.0.stderr.take()));
    while !stopping() {
        if let Some(status) = wait(&mut tool.0, Instant::now() + LOOK_EVERY) {
            drop(tool);
            let text = |read: mpsc::Receiver<Vec<u8>>| read.recv().unwrap_or_default();
            return Ok(Some(Output { status, stdout: text(stdout), stderr: text(stderr) }));
        }
    }
    Ok(None)
}

/// Reads to the end in a thread.
fn all_of(from: Option<impl Read + Send + 'static>) -> mpsc::Receiver<Vec<u8>> {
    let (sender, read) = mpsc::channel();
    if let Some(mut from) = from {
        thread::spawn(move || {
            let mut all = Vec::new();
            let _ = from.read_to_end(&mut all);
            let _ = sender.send(all);
        });
    }
    read
}

/// Asks a program all questions in one go.
///
/// # Errors
/// The system's, if the program cannot be started.
pub(crate) fn ask(
    command: &mut Command,
    questions: &[Question],
    timeout: Duration,
    stopping: Stopping<'_>,
) -> std::io::Result<Asked> {
    let deadline = Instant::now() + timeout;
    let mut child = Guard::spawn(command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()))?;
    if let Some(mut stdin) = child.0.stdin.take() {
        let lines: Vec<String> = questions.iter().map(Question::line).collect();
        // A program that ended is told of by the other side.
        thread::spawn(move || lines.iter().try_for_each(|line| stdin.write_all(line.as_bytes())));
    }
    let printed = Arc::new(Mutex::new(Vec::new()));
    // Closed when all is read that the program prints.
    let (reading, all_read) = mpsc::channel::<()>();
    if let Some(stderr) = child.0.stderr.take() {
        let printed = printed.clone();
        thread::spawn(move || {
            keep_beginning(stderr, &printed);
            drop(reading);
        });
    }
    let (sender, lines) = mpsc::sync_channel(WAITING);
    if let Some(stdout) = child.0.stdout.take() {
        thread::spawn(move || send_lines(stdout, &sender));
    }
    let (mut replies, mut stop) = (Vec::with_capacity(questions.len()), None);
    while replies.len() < questions.len() && stop.is_none() {
        match lines.recv_timeout(deadline.saturating_duration_since(Instant::now()).min(LOOK_EVERY)) {
            Ok(line) => match read(&line) {
                Ok(reply) => replies.push(reply),
                Err(reason) => stop = Some(reason),
            },
            Err(mpsc::RecvTimeoutError::Timeout) if stopping() => stop = Some(Stop::Asked),
            Err(mpsc::RecvTimeoutError::Timeout) if Instant::now() < deadline => (),
            Err(mpsc::RecvTimeoutError::Timeout) => stop = Some(Stop::Timeout),
            Err(mpsc::RecvTimeoutError::Disconnected) => stop = Some(Stop::Ended(ending(&mut child.0, deadline))),
        }
    }
    // Its end, by itself if it can: what it prints last is read then.
    let patience = if stop.is_none() { FAREWELL } else { Duration::ZERO };
    let _ = wait(&mut child.0, (Instant::now() + patience).min(deadline));
    drop(child);
    let _ = all_read.recv_timeout(FAREWELL);
    let printed = printed.lock().map(|bytes| String::from_utf8_lossy(&bytes).into_owned()).unwrap_or_default();
    Ok(Asked { replies, stop, printed })
}

/// Waits for the end of a program until a moment.
fn wait(child: &mut Child, deadline: Instant) -> Option<std::process::ExitStatus> {
    loop {
        match child.try_wait() {
            Ok(Some(status)) => return Some(status),
            Ok(None) if Instant::now() < deadline => thread::sleep(Duration::from_millis(2)),
            _ => return None,
        }
    }
}

/// The end of a program that closed its output, in words.
fn ending(child: &mut Child, deadline: Instant) -> String {
    match wait(child, deadline) {
        Some(status) => format!("ended early ({status})"),
        None => "closed its output".into(),
    }
}

/// A line as a reply.
fn read(line: &[u8]) -> Result<Reply, Stop> {
    if line.len() as u64 >= LINE {
        return Err(Stop::Flood);
    }
    let text = String::from_utf8_lossy(line);
    match Reply::parse(text.trim_end()) {
        Some(Reply::Broken(text)) => Err(Stop::Broken(text)),
        Some(reply) => Ok(reply),
        None => Err(Stop::NoReply(text.trim_end().chars().take(80).collect())),
    }
}

/// Sends lines, or their first [`LINE`] bytes, until nobody takes them.
fn send_lines(from: impl Read, to: &mpsc::SyncSender<Vec<u8>>) {
    let mut from = BufReader::new(from);
    loop {
        let mut line = Vec::new();
        let read = from.by_ref().take(LINE).read_until(b'\n', &mut line);
        if read.is_err() || line.is_empty() || to.send(line).is_err() {
            return;
        }
    }
}

/// Reads everything and keeps the beginning.
fn keep_beginning(mut from: impl Read, kept: &Mutex<Vec<u8>>) {
    let mut buffer = [0; 4096];
    while let Ok(count @ 1..) = from.read(&mut buffer) {
        let Ok(mut kept) = kept.lock() else { return };
        let room = PRINTED.saturating_sub(kept.len()).min(count);
        kept.extend_from_slice(buffer.get(..room).unwrap_or_default());
    }
}
