//! Runs a table of cases in child processes of this test, bounds the memory of each, and tells which took longest. A
//! verdict depends on time only where a case does not end at all.
//!
//! The child prints a line when it begins a case and one when it ends it. A child that dies or goes silent has failed
//! the case it was at; another one goes on with the next.

use crate::{
    TABLES,
    case::Case,
    pipeline::{self, Outcome},
};
use std::{
    io::{BufRead, BufReader, Write},
    panic::{AssertUnwindSafe, catch_unwind},
    path::Path,
    process::{Command, Stdio},
    sync::mpsc,
    time::Duration,
};

/// Most memory of a case, KiB.
const MEMORY: u64 = 512 << 10;
/// Wall time after which a child counts as hung: only what never ends is meant to meet it.
const HUNG: Duration = Duration::from_secs(600);
/// Names the table to the child, and the case where it starts.
const TABLE: &str = "STERADIAN_HOSTILE_TABLE";
const FIRST: &str = "STERADIAN_HOSTILE_FIRST";

/// Runs a table; panics with all its faults.
pub fn check(table: &str) {
    let (mut faults, mut next, mut done) = (Vec::new(), 0, false);
    let (mut costs, mut pictures, mut dropped) = (Vec::new(), 0, Vec::new());
    while !done {
        let mut child = Command::new(std::env::current_exe().expect("this test is a file"))
            .args(["child", "--exact", "--ignored", "--nocapture", "--test-threads=1"])
            .env(TABLE, table)
            .env(FIRST, next.to_string())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .expect("a child process can be started");
        let (sender, lines) = mpsc::channel();
        let output = BufReader::new(child.stdout.take().expect("it is piped"));
        let reader = std::thread::spawn(move || output.lines().map_while(Result::ok).try_for_each(|l| sender.send(l)));
        let (mut current, before) = (None, next);
        loop {
            let line = match lines.recv_timeout(HUNG) {
                Ok(line) => line,
                Err(mpsc::RecvTimeoutError::Timeout) => {
                    let _ = child.kill();
                    faults.push(format!("{}: hung", current.take().unwrap_or_default()));
                    break;
                }
                Err(mpsc::RecvTimeoutError::Disconnected) => break,
            };
            // The test harness of the child may have left a line open before ours.
            let Some(at) = line.find('@') else { continue };
            let words: Vec<&str> = line[at..].splitn(4, '\t').collect();
            match words[..] {
                ["@begin", name] => {
                    next += 1;
                    current = Some(name.to_string());
                }
                ["@end", cpu, memory, verdict] => {
                    let name = current.take().unwrap_or_default();
                    let (cpu, memory) =
                        (cpu.parse::<u64>().unwrap_or(u64::MAX), memory.parse::<u64>().unwrap_or(u64::MAX));
                    costs.push((cpu, memory >> 10, name.clone()));
                    match verdict {
                        "refused" => {}
                        "picture" => pictures += 1,
                        "picture, with samples that are not finite" => {
                            pictures += 1;
                            dropped.push(name.clone());
                        }
                        fault => faults.push(format!("{name}: {}", fault.replace('\u{b}', "\n    "))),
                    }
                    if memory > MEMORY {
                        faults.push(format!("{name}: took {} MiB", memory >> 10));
                    }
                }
                ["@done"] => done = true,
                _ => {}
            }
        }
        let status = child.wait();
        let _ = reader.join();
        if let Some(name) = current {
            faults.push(format!("{name}: the process ended with {status:?}"));
        } else if !done && next == before {
            faults.push(format!("the child ended early with {status:?}"));
            break;
        }
    }
    println!("{table}: {next} cases, {pictures} of them pictures");
    costs.sort_by(|a, b| b.cmp(a));
    for (cpu, memory, name) in costs.iter().take(5).chain(costs.iter().max_by_key(|c| c.1)) {
        println!("  {cpu} ms, {memory} MiB: {name}");
    }
    if !dropped.is_empty() {
        println!("samples were not finite, and dropped, in {} cases:\n{}", dropped.len(), dropped.join("\n"));
    }
    assert!(faults.is_empty(), "{} of {next} cases failed:\n{}", faults.len(), faults.join("\n"));
}

/// The child: runs the cases of a table from one on.
pub fn child() {
    let Ok(name) = std::env::var(TABLE) else { return };
    let first = std::env::var(FIRST).ok().and_then(|f| f.parse().ok()).unwrap_or(0);
    let cases = TABLES.iter().find(|t| t.0 == name).expect("the table exists").1();
    let say = |line: String| {
        let mut out = std::io::stdout().lock();
        let _ = writeln!(out, "{line}").and_then(|()| out.flush());
    };
    for case in cases.skip(first) {
        let folder = tempfile::tempdir().expect("a folder can be made");
        say(format!("@begin\t{}", case.name));
        let held = memory::forget_peak();
        let start = cpu_time();
        let verdict = verdict_of(&case, folder.path());
        let cpu = (cpu_time() - start).as_millis();
        // One line: what breaks lines is put back by the parent.
        let verdict = verdict.replace('\n', "\u{b}").replace('\t', " ");
        let peak = memory::kib("VmHWM:").saturating_sub(held);
        say(format!("@end\t{cpu}\t{peak}\t{verdict}"));
        // What the allocator keeps would count against the next case: that one gets a fresh process.
        if peak > MEMORY / 8 {
            return;
        }
    }
    say("@done".into());
}

/// Runs a case once: a word for how it ended as it must, or the fault.
fn verdict_of(case: &Case, folder: &Path) -> String {
    let result = catch_unwind(AssertUnwindSafe(|| {
        let outcome = pipeline::run(case, folder)?;
        pipeline::judge(&outcome, case.expect).map(|()| outcome)
    }));
    match result {
        Ok(Ok(Outcome::Picture(_, dropped))) if dropped > 0 => "picture, with samples that are not finite".into(),
        Ok(Ok(Outcome::Picture(..))) => "picture".into(),
        Ok(Ok(Outcome::Refused(_))) => "refused".to_string(),
        Ok(Err(fault)) => fault,
        Err(panic) => {
            let text = panic.downcast_ref::<String>().cloned();
            let text = text.or_else(|| panic.downcast_ref::<&str>().map(ToString::to_string));
            format!("panicked: {}", text.unwrap_or_default())
        }
    }
}

/// Processor time of this process.
fn cpu_time() -> Duration {
    let t = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    Duration::new(t.tv_sec as u64, t.tv_nsec as u32)
}

/// The peak of resident memory, where the system tells it (Linux).
mod memory {
    /// Starts a new measurement; gives what is held already, in KiB (the cases themselves).
    pub fn forget_peak() -> u64 {
        let _ = std::fs::write("/proc/self/clear_refs", "5");
        kib("VmRSS:")
    }

    /// A figure of the process in KiB; zero where it is not known.
    pub fn kib(name: &str) -> u64 {
        let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
        let line = status.lines().find_map(|l| l.strip_prefix(name));
        line.and_then(|l| l.split_whitespace().next()?.parse().ok()).unwrap_or(0)
    }
}
