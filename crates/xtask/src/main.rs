//! `cargo xtask`: benchmarks, generators of what they measure, whether pictures are the same, and counts of what is
//! untidy in the code.
//!
//! No figure of time makes a command fail.
#![expect(clippy::print_stdout, clippy::print_stderr, reason = "output of the program")]

mod arguments;
mod bench;
mod clock;
mod fuzz;
mod generate;
mod instructions;
mod loading;
mod plot;
mod raster;
mod rays;
mod report;
mod rivals;
mod same;
mod scaling;
mod structures;
mod tidy;

use clap::{Parser, Subcommand};
use std::process::ExitCode;

/// Benchmarks of Steradian.
#[derive(Debug, Parser)]
#[command(name = "cargo xtask")]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Measure everything, and write tables (Markdown, JSON) and plots (SVG) to a folder
    Bench(arguments::Bench),
    /// Count the instructions of traversal and shading with valgrind, and warn where they grew
    Instructions(instructions::Arguments),
    /// Hash small pictures of every integrator, and count their instructions, before and after a change
    Same(same::Arguments),
    /// Count what is untidy in the code, against ceilings that only fall
    Tidy(tidy::Arguments),
    /// Give damaged inputs to readers of scenes, pictures, states and archives
    Fuzz(fuzz::Arguments),
    /// Write a scene or mesh to measure with
    Generate(generate::Arguments),
}

fn main() -> ExitCode {
    let result = match Cli::parse().command {
        Command::Bench(arguments) => bench::run(&arguments),
        Command::Instructions(arguments) => instructions::run(&arguments),
        Command::Same(arguments) => same::run(&arguments),
        Command::Fuzz(arguments) => fuzz::run(&arguments),
        Command::Tidy(arguments) => tidy::run(&arguments),
        Command::Generate(arguments) => generate::run(&arguments),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(e) => {
            eprintln!("error: {e}");
            ExitCode::FAILURE
        }
    }
}
