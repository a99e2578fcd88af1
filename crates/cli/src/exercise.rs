//! `steradian exercise`: tasks in rendering, done in Python or Rust and checked by the program.

use crate::{
    failure::{self, Failure, Outcome},
    html::quoted,
    signals::{self, Signals},
    terminal,
};
use clap::{Args, Subcommand, builder::PossibleValuesParser};
use serde::Serialize;
use std::{path::PathBuf, time::Duration};
use steradian_exercises::{EXERCISES, Fault, Language, check, find, start};

/// `steradian exercise`.
#[derive(Args, Debug)]
pub struct ExerciseArgs {
    /// Command
    #[command(subcommand)]
    pub command: ExerciseCommand,
}

/// Commands about exercises.
#[derive(Debug, Subcommand)]
pub enum ExerciseCommand {
    /// List all exercises
    List {
        /// Print one line of JSON to stdout
        #[arg(long)]
        json: bool,
    },
    /// Write the folder of an exercise: a task, a gap to fill, the file that asks the answer
    Start {
        /// Name of the exercise
        name: String,
        /// Folder to write; default: ./NAME
        #[arg(short, long, value_name = "FOLDER")]
        output: Option<PathBuf>,
        /// Language of the answer
        #[arg(long, value_name = "NAME", default_value = "python",
              value_parser = PossibleValuesParser::new(Language::ALL.map(Language::name)))]
        language: String,
        /// Write the solution in place of the gap
        #[arg(long)]
        solution: bool,
    },
    /// Build and run the answer in a folder, and say in words what is wrong; exit code 4 if something is
    Check {
        /// Folder of the exercise
        #[arg(default_value = ".")]
        folder: PathBuf,
        /// Seconds that the program may take
        #[arg(long, value_name = "SECONDS", default_value_t = 60,
              value_parser = clap::value_parser!(u32).range(1..=86400))]
        timeout: u32,
        /// Print one line of JSON to stdout
        #[arg(long)]
        json: bool,
    },
}

#[derive(Serialize)]
struct Row {
    name: &'static str,
    chapter: u8,
    title: &'static str,
}

/// Lists, writes or checks.
pub fn run(args: &ExerciseArgs) -> Outcome {
    match &args.command {
        ExerciseCommand::List { json } => {
            let rows = EXERCISES.iter().map(|e| Row { name: e.name, chapter: e.chapter, title: e.title });
            if *json {
                terminal::json(&rows.collect::<Vec<_>>())?;
            } else {
                let lines = rows.map(|r| format!("{:<26} chapter {:>2}  {}\n", r.name, r.chapter, r.title));
                terminal::data(lines.collect::<String>().as_bytes())?;
            }
            Ok(failure::DONE)
        }
        ExerciseCommand::Start { name, output, language, solution } => {
            let exercise = find(name).map_err(failed)?;
            let language = Language::named(language).unwrap_or(Language::Python);
            let folder = output.clone().unwrap_or_else(|| PathBuf::from(exercise.name));
            start(exercise, language, &folder, *solution).map_err(failed)?;
            let readme = folder.join("README.md");
            let word = quoted(&folder.to_string_lossy());
            let text = format!(
                "{}: the task is in {}; `steradian exercise check {word}` checks the answer\n",
                folder.display(),
                readme.display()
            );
            terminal::data(text.as_bytes())?;
            Ok(failure::DONE)
        }
        ExerciseCommand::Check { folder, timeout, json } => {
            let signals = Signals::watch();
            let checked = check(folder, Duration::from_secs((*timeout).into()), &|| signals.came().is_some());
            if let (Err(Fault::Stopped), Some(signal)) = (&checked, signals.came()) {
                let message = format!("stopped by {}", signals::name(signal));
                return Err(Failure { code: 128 + signal, message });
            }
            let report = checked.map_err(failed)?;
            if *json {
                terminal::json(&report)?;
            } else {
                terminal::data(format!("{report}\n").as_bytes())?;
            }
            Ok(if report.passed { failure::DONE } else { failure::DIFFERENT })
        }
    }
}

fn failed(fault: Fault) -> Failure {
    let code = if fault.is_bad_input() { failure::BAD_INPUT } else { failure::FAILED };
    Failure { code, message: fault.to_string() }
}
