//! `steradian bench`: measurements of single parts. Rates count processor time, so that a shared machine can be
//! measured on.

mod accel;
mod placement;
mod ray_file;
mod rays;
mod render;

use crate::{failure::Outcome, terminal::Terminal};
use clap::{Args, Subcommand};
use std::time::Duration;

/// `steradian bench`.
#[derive(Args, Debug)]
pub struct BenchArgs {
    /// Measurement.
    #[command(subcommand)]
    pub what: Measurement,
}

/// The measurements.
#[derive(Debug, Subcommand)]
pub enum Measurement {
    /// Compare all structures that rays can go through, on the rays of a scene
    Accel(Box<accel::AccelArgs>),
    /// Trace the rays of a file against a mesh: rays per second, build time and memory
    Rays(rays::RaysArgs),
    /// Render scenes by several integrators: error against time, efficiency
    Render(Box<render::RenderBenchArgs>),
}

/// Measures.
pub fn run(args: &BenchArgs, terminal: Terminal) -> Outcome {
    match &args.what {
        Measurement::Accel(args) => accel::run(args, terminal),
        Measurement::Rays(args) => rays::run(args),
        Measurement::Render(args) => render::run(args, terminal),
    }
}

/// Time that a clock of the processor has counted.
fn cpu_time(clock: rustix::time::ClockId) -> Duration {
    let t = rustix::time::clock_gettime(clock);
    Duration::new(t.tv_sec.max(0) as u64, t.tv_nsec.clamp(0, 999_999_999) as u32)
}

/// The middle of some numbers, the upper one of two.
fn median(mut numbers: Vec<f64>) -> f64 {
    numbers.sort_by(f64::total_cmp);
    numbers.get(numbers.len() / 2).copied().unwrap_or(f64::NAN)
}
