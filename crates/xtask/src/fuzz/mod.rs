//! Fuzzing on stable Rust: readers of scenes, meshes, pictures, states and archives get damaged inputs, and must answer
//! with a result or an error.
//!
//! An execution is named by its target and number, on which alone its input depends: `--replay TARGET:NUMBER` makes a
//! fault happen again, and `--show` gives its input. Executions run in child processes, so that an abort, too, is a
//! fault of one of them.

mod child;
mod mutate;
mod seeds;
mod targets;

use child::Fault;
use std::{error::Error, io::Write, time::Instant};
use targets::{TARGETS, Target};

/// Arguments of `fuzz`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Targets; default: all
    targets: Vec<String>,
    /// Executions of each target
    #[arg(long, default_value_t = 10_000)]
    runs: u64,
    /// Number of the first
    #[arg(long, default_value_t = 0)]
    first: u64,
    /// Run one execution in this process: TARGET:NUMBER
    #[arg(long, value_name = "TARGET:NUMBER")]
    replay: Option<String>,
    /// Write the input of one execution to standard output
    #[arg(long, value_name = "TARGET:NUMBER")]
    show: Option<String>,
    /// Run as a child process that counts its executions in a file
    #[arg(long, hide = true)]
    counter: Option<std::path::PathBuf>,
}

/// Runs executions; an error where some had faults.
pub fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    if let Some(name) = &arguments.show {
        let (target, number) = parse(name)?;
        return Ok(std::io::stdout().write_all(&target.input(number))?);
    }
    if let Some(name) = &arguments.replay {
        let (target, number) = parse(name)?;
        target.execute(&target.input(number));
        println!("{name} ends well");
        return Ok(());
    }
    let wanted: Vec<&Target> = match &*arguments.targets {
        [] => TARGETS.iter().collect(),
        names => names.iter().map(|name| find(name)).collect::<Result<_, _>>()?,
    };
    let numbers = arguments.first..arguments.first.saturating_add(arguments.runs);
    if let (Some(counter), [target]) = (&arguments.counter, &*wanted) {
        return Ok(child::count(target, numbers, counter)?);
    }
    let mut faults = 0;
    for target in wanted {
        let start = Instant::now();
        let found = child::watch(target.name, numbers.clone())?;
        println!("{:<12} {} executions, {:.1} s", target.name, arguments.runs, start.elapsed().as_secs_f64());
        for Fault { number, why } in &found {
            println!("  {}:{number} {why}", target.name);
        }
        faults += found.len();
    }
    if faults == 0 { Ok(()) } else { Err(format!("{faults} executions had faults").into()) }
}

fn find(name: &str) -> Result<&'static Target, String> {
    let names = || TARGETS.iter().map(|target| target.name).collect::<Vec<_>>().join(", ");
    TARGETS.iter().find(|target| target.name == name).ok_or_else(|| format!("no target '{name}'; known: {}", names()))
}

/// Target and number of an execution.
fn parse(name: &str) -> Result<(&'static Target, u64), Box<dyn Error>> {
    let (target, number) = name.split_once(':').ok_or_else(|| format!("'{name}' is not TARGET:NUMBER"))?;
    Ok((find(target)?, number.parse()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Executions of each target in the tests, and the first of them, to be raised for others.
    const RUNS: u64 = 2000;

    /// Seeds are sound, and what they become is an answer or an error: no panic, abort or overflow.
    #[test]
    fn damaged_inputs_are_answered() {
        let mut faults = Vec::new();
        for target in TARGETS.iter() {
            assert!(target.seeds().iter().all(|seed| (target.run)(seed)), "a seed of {} is refused", target.name);
            for number in 0..RUNS {
                let input = target.input(number);
                if let Err(why) = child::caught(|| target.execute(&input)) {
                    faults.push(format!("{}:{number} {why}", target.name));
                }
            }
        }
        assert!(faults.is_empty(), "{}", faults.join("\n"));
    }

    #[test]
    fn inputs_depend_on_their_number_alone() {
        for target in TARGETS.iter() {
            assert_eq!(target.input(17), target.input(17));
            assert!((0..20).any(|i| target.input(i) != target.input(i + 1)));
        }
        assert!(
            parse("png:3").is_ok() && parse("png").is_err() && parse("nothing:3").is_err() && parse("png:x").is_err()
        );
    }
}
