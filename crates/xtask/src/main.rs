//! `cargo xtask`: benchmarks, generators of what they measure, whether pictures are the same, and counts of what is
//! untidy in the code.
//!
//! Nothing here is a test: no figure of time makes a command fail.
#![allow(clippy::print_stdout, clippy::print_stderr)]

mod clock;
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
use report::Report;
use std::{error::Error, path::PathBuf, process::ExitCode};

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
    Bench(Bench),
    /// Count the instructions of traversal and shading with valgrind, and warn where they grew
    Instructions(instructions::Arguments),
    /// Hash small pictures of every integrator, and count their instructions, before and after a change
    Same(same::Arguments),
    /// Count what is untidy in the code, against ceilings that only fall
    Tidy(tidy::Arguments),
    /// Write a scene or mesh to measure with
    Generate(generate::Arguments),
}

/// Arguments of `bench`.
#[derive(Debug, clap::Args)]
struct Bench {
    /// Folder for results
    #[arg(long, default_value = "target/bench")]
    out: PathBuf,
    /// Only these parts: structures, scaling, threads, loading, rays, building, builders, raster, rivals
    #[arg(long, value_delimiter = ',')]
    only: Vec<String>,
    /// Largest mesh, in triangles
    #[arg(long, default_value_t = 10_000_000)]
    triangles: usize,
    /// A Python that has Mitsuba 3, to render the same scenes with it
    #[arg(long)]
    mitsuba_python: Option<PathBuf>,
    /// A scene to render with both, instead of a generated one; may be given several times
    #[arg(long, value_name = "FILE.xml")]
    scene: Vec<PathBuf>,
    /// The shared library of Embree 4, to trace the same rays with it
    #[arg(long, value_name = "LIBRARY")]
    embree: Option<PathBuf>,
    /// One more mesh to trace rays through; may be given several times
    #[arg(long, value_name = "FILE.ply")]
    mesh: Vec<PathBuf>,
    /// Only rays whose scene, name or query has each of these words, such as mesh_10k,bounce1,closest
    #[arg(long, value_name = "WORD", value_delimiter = ',')]
    rays: Vec<String>,
}

fn main() -> ExitCode {
    let result = match Cli::parse().command {
        Command::Bench(bench) => bench.run(),
        Command::Instructions(arguments) => instructions::run(&arguments),
        Command::Same(arguments) => same::run(&arguments),
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

impl Bench {
    fn run(&self) -> Result<(), Box<dyn Error>> {
        std::fs::create_dir_all(&self.out)?;
        let is_wanted = |part: &str| self.only.is_empty() || self.only.iter().any(|p| p == part);
        let mut report = Report::default();
        if is_wanted("structures") {
            structures::measure(&self.out, self.triangles, &mut report)?;
        }
        if is_wanted("scaling") {
            scaling::triangles(&self.out, self.triangles, &mut report)?;
        }
        if is_wanted("threads") {
            scaling::threads(&self.out, self.triangles, &mut report)?;
        }
        if is_wanted("loading") {
            loading::measure(&self.out, &mut report)?;
        }
        if is_wanted("rays") {
            rays::measure(self, &mut report)?;
        }
        if is_wanted("building") {
            rays::builds(self, &mut report)?;
        }
        if is_wanted("builders") {
            rays::builders(&mut report)?;
        }
        if is_wanted("raster") {
            raster::measure(&mut report)?;
        }
        if is_wanted("rivals") {
            rivals::measure(self, &mut report)?;
        }
        report.write(&self.out)
    }
}
