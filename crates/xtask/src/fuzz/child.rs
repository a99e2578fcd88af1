//! Executions in child processes, which write the number of each to a file before it begins.

use super::targets::Target;
use std::{
    fs::File,
    io::{self, BufRead, BufReader},
    ops::Range,
    os::unix::fs::FileExt,
    panic::{AssertUnwindSafe, catch_unwind},
    path::Path,
    process::{Command, Stdio},
};

/// An execution that did not end as it must.
#[derive(Debug)]
pub struct Fault {
    /// Its number.
    pub number: u64,
    /// Message of the panic, or the end of the process.
    pub why: String,
}

/// Most faults of a target before it is given up.
const MOST: usize = 20;

/// Runs executions in child processes, one after the other where they die.
pub fn watch(target: &str, numbers: Range<u64>) -> io::Result<Vec<Fault>> {
    let (mut faults, mut next) = (Vec::new(), numbers.start);
    let counter = std::env::temp_dir().join(format!("steradian-fuzz-{}", std::process::id()));
    while next < numbers.end && faults.len() < MOST {
        File::create(&counter)?.write_all_at(&next.to_le_bytes(), 0)?;
        let mut child = Command::new(std::env::current_exe()?)
            .args(["fuzz", target, "--first", &next.to_string(), "--runs", &(numbers.end - next).to_string()])
            .arg("--counter")
            .arg(&counter)
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()?;
        for line in BufReader::new(child.stdout.take().ok_or(io::ErrorKind::BrokenPipe)?).lines() {
            let line = line?;
            let Some((number, why)) = line.split_once('\t') else { continue };
            let number = number.parse().unwrap_or(next);
            faults.push(Fault { number, why: why.to_owned() });
        }
        let status = child.wait()?;
        if status.success() {
            break;
        }
        let mut number = [0; 8];
        File::open(&counter)?.read_exact_at(&mut number, 0)?;
        let number = u64::from_le_bytes(number);
        faults.push(Fault { number, why: format!("the process ended: {status}") });
        next = number + 1;
    }
    std::fs::remove_file(&counter)?;
    Ok(faults)
}

/// Runs executions in this process; prints those that panic.
pub fn count(target: &Target, numbers: Range<u64>, counter: &Path) -> io::Result<()> {
    let counter = File::options().write(true).open(counter)?;
    for number in numbers {
        counter.write_all_at(&number.to_le_bytes(), 0)?;
        let input = target.input(number);
        if let Err(why) = caught(|| target.execute(&input)) {
            println!("{number}\t{why}");
        }
    }
    Ok(())
}

/// Runs to the end, or to a panic, whose message is the error.
pub fn caught(run: impl FnOnce()) -> Result<(), String> {
    catch_unwind(AssertUnwindSafe(run)).map_err(|payload| {
        let text = payload.downcast_ref::<&str>().map(|s| (*s).to_owned());
        let text = text.or_else(|| payload.downcast_ref::<String>().cloned()).unwrap_or_default();
        format!("panicked: {}", text.replace('\n', " "))
    })
}
