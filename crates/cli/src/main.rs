//! `steradian`, the command line: a thin shell over the library. Data goes to stdout, talk to stderr.
//!
//! Exit codes: 0 done; 1 the work failed (an output cannot be written); 2 bad command line or scene; 4
//! `compare --fail-above` says the pictures differ, or `exercise check` that an answer is wrong; 75 try again (chunk,
//! merge); 130 and 143 stopped by SIGINT and SIGTERM.

mod args;
mod bake;
mod bench;
mod brightness;
mod checkpoint;
mod chunks;
mod closed;
mod command;
mod compare;
mod convert;
mod convert_scene;
mod csv;
mod denoise;
mod diagnostics;
mod estimate;
mod exercise;
mod experiment;
mod failure;
mod farm;
mod film;
mod frames;
mod html;
mod info;
mod job;
mod lightmap;
mod list;
mod material;
mod material_summary;
mod memory;
mod meter;
mod new;
mod open;
mod output;
mod pack;
mod panics;
mod picture;
mod progress;
mod relief;
mod render;
mod rendered;
mod report;
mod sequence_state;
mod signal;
mod signals;
mod solving;
mod terminal;
mod unwrap;
mod usage_errors;
mod values;
mod verify;
mod view;
mod watch;

use chunks::{chunk, merge, plan};
use clap::{CommandFactory, Parser};
use command::{Cli, Command};
use failure::{Failure, Outcome};
use std::process::ExitCode;
use steradian::scene::names;
use terminal::{Event, Talk, Terminal};

fn main() -> ExitCode {
    signals::take_over();
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(answer) => return ExitCode::from(answered(&answer)),
    };
    let terminal = Terminal::new(cli.command.talk());
    signals::tell_on(terminal);
    panics::explain(terminal);
    let code = match panics::contain(|| run(&cli.command, terminal)) {
        Ok(Ok(code)) => code,
        Ok(Err(failure)) => {
            if !failure.message.is_empty() {
                terminal.error(&failure.message);
            }
            failure.code
        }
        Err(panics::Contained) => failure::FAILED,
    };
    terminal.event(&Event::End { code });
    ExitCode::from(code)
}

/// Prints what is wrong with a command line, or what `--help` and `--version` ask for, and gives the exit code.
fn answered(answer: &clap::Error) -> u8 {
    let terminal = Terminal::new(Talk::default());
    if answer.use_stderr() {
        // There is nobody to tell when it is closed.
        let _ = answer.print();
    } else if let Err(fault) = terminal::written(|| answer.print()) {
        let failure = Failure::from(fault);
        terminal.error(&failure.message);
        return failure.code;
    }
    if let Some(advice) = usage_errors::advice(answer) {
        terminal.say(&advice);
    }
    answer.exit_code() as u8
}

/// The manual page of the program or of one of its commands.
fn manual(name: Option<&str>) -> Outcome {
    let mut program = Cli::command();
    program.build();
    let page = match name {
        None => program,
        Some(name) => match program.find_subcommand(name) {
            Some(command) => command.clone(),
            None => {
                let known = program.get_subcommands().map(|c| c.get_name());
                let hint = names::did_you_mean(name, known).map(|h| format!("; {h}")).unwrap_or_default();
                return Err(Failure::bad_input(format!("there is no command '{name}'{hint}")));
            }
        },
    };
    let mut text = Vec::new();
    clap_mangen::Man::new(page).render(&mut text).map_err(Failure::from)?;
    terminal::data(&text).map(|()| failure::DONE).map_err(Failure::from)
}

fn run(command: &Command, terminal: Terminal) -> Outcome {
    match command {
        Command::Render(args) => match frames::of(args) {
            Some(range) => frames::run(args, range, terminal),
            None => render::run(args, terminal),
        },
        Command::Plan(args) => plan::run(args, terminal),
        Command::Chunk(args) => chunk::run(args, terminal),
        Command::Merge(args) => merge::run(args, terminal),
        Command::Farm(args) => farm::run(args, terminal),
        Command::New(args) => new::run(args),
        Command::Pack(args) => pack::run(args, terminal),
        Command::Optics(args) => experiment::run("optics", args, terminal),
        Command::Vision(args) => experiment::run("vision", args, terminal),
        Command::Estimate(args) => experiment::run("estimate", args, terminal),
        Command::Geometry(args) => experiment::run("geometry", args, terminal),
        Command::View(args) => view::run(args, terminal),
        Command::Verify(args) => verify::run(args, terminal),
        Command::Info(args) => info::run(args, terminal),
        Command::List(args) => list::run(args),
        Command::Material(args) => material::run(args, terminal),
        Command::Meter(args) => meter::run(args, terminal),
        Command::Compare(args) => compare::run(args, terminal),
        Command::Convert(args) => convert::run(args, terminal),
        Command::Denoise(args) => denoise::run(args, terminal),
        Command::Bake(args) => bake::run(args, terminal),
        Command::Unwrap(args) => unwrap::run(args, terminal),
        Command::Bench(args) => bench::run(args, terminal),
        Command::Signal(args) => signal::run(args, terminal),
        Command::Exercise(args) => exercise::run(args),
        Command::Completions { shell } => {
            let mut script = Vec::new();
            clap_complete::generate(*shell, &mut Cli::command(), "steradian", &mut script);
            terminal::data(&script).map(|()| failure::DONE).map_err(Failure::from)
        }
        Command::Man { command } => manual(command.as_deref()),
    }
}
