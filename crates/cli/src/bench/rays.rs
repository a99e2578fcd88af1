//! `steradian bench rays`: the rays of a file, traced in one of several ways.

use super::{cpu_time, median, placement, ray_file};
use crate::{
    failure::{self, Failure, Outcome},
    terminal,
};
use clap::{ArgAction, Args, ValueEnum};
use rustix::time::ClockId;
use serde::Serialize;
use std::{
    path::{Path, PathBuf},
    time::{Duration, Instant},
};
use steradian::accel::{Bvh, Geometry, Hit, Instance, Isa, TopLevel};
use steradian::math::{Ray, Vec3};

/// Rays that a thread hands over at once, where they are not sorted.
const BATCH: usize = 1 << 8;
/// A repeat lasts at least so long.
const LEAST: Duration = Duration::from_millis(250);

/// `steradian bench rays`.
#[derive(Args, Debug)]
pub struct RaysArgs {
    /// The mesh
    #[arg(value_name = "MESH.ply")]
    pub mesh: PathBuf,
    /// The rays: a little-endian u64 count, then 7 f32 for each: origin, direction, t_max
    #[arg(value_name = "RAYS.bin")]
    pub rays: PathBuf,
    /// Query of each ray
    #[arg(long, value_enum, default_value_t)]
    pub query: Query,
    /// Ask for watertight tests. There are no others here, so that this changes nothing
    #[arg(long, action = ArgAction::SetTrue)]
    pub robust: bool,
    /// Order of rays: one by one, in slices as they come, or in slices that are sorted first
    #[arg(long, value_enum, default_value_t)]
    pub mode: Mode,
    /// Most rays of a packet; no more than two registers have lanes
    #[arg(long, value_name = "N", value_parser = ["4", "8", "16", "32"])]
    pub width: Option<String>,
    /// Threads that trace. The hierarchy is built by all processors
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: u16,
    /// Place the mesh so many times in a lattice, as instances; 0 for the mesh itself
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u32).range(0..=10_000_000))]
    pub instances: u32,
    /// Number of measurements
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub repeat: u32,
    /// Instruction set instead of the best one that this machine has; the answers are the same
    #[arg(long, value_enum)]
    pub isa: Option<Level>,
    /// Print one line of JSON to stdout
    #[arg(long, action = ArgAction::SetTrue)]
    pub json: bool,
}

/// Query of a ray.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum Query {
    /// The nearest hit.
    #[default]
    Closest,
    /// Any hit.
    Occluded,
}

/// Order in which rays are handed over.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum Mode {
    /// One by one.
    #[default]
    Single,
    /// In slices, as they come.
    Packet,
    /// In slices that are sorted.
    Stream,
}

/// Instruction sets.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Level {
    /// Instructions that every processor has.
    Baseline,
    /// AVX2.
    Avx2,
    /// AVX-512.
    Avx512,
}

impl From<Level> for Isa {
    fn from(level: Level) -> Self {
        match level {
            Level::Baseline => Self::Baseline,
            Level::Avx2 => Self::Avx2,
            Level::Avx512 => Self::Avx512,
        }
    }
}

/// Result of the measurement.
#[derive(Debug, Serialize)]
struct Measured {
    schema: u32,
    query: Query,
    mode: Mode,
    /// Tests are always watertight.
    robust: bool,
    isa: String,
    /// Most rays of a packet.
    width: usize,
    threads: u16,
    triangles: usize,
    instances: u32,
    build_seconds: f64,
    build_cpu_seconds: f64,
    bytes: usize,
    rays: usize,
    hits: usize,
    /// Sum of the distances of nearest hits.
    sum_t: f64,
    mrays_per_cpu_second: f64,
    mrays_per_second: f64,
}

/// Hits of the rays.
#[derive(Clone, Copy, Debug, Default)]
struct Sum {
    hits: usize,
    t: f64,
}

impl Sum {
    /// Sum over hits at given distances.
    #[inline(always)]
    fn of(distances: impl Iterator<Item = f32>) -> Self {
        let (mut hits, mut t) = (0, 0.0);
        for distance in distances {
            hits += 1;
            t += f64::from(distance);
        }
        Self { hits, t }
    }
}

impl std::iter::Sum for Sum {
    fn sum<I: Iterator<Item = Self>>(sums: I) -> Self {
        sums.fold(Self::default(), |a, b| Self { hits: a.hits + b.hits, t: a.t + b.t })
    }
}

/// Reads, builds, traces and prints.
pub fn run(args: &RaysArgs) -> Outcome {
    let mesh = in_file(&args.mesh, |bytes| {
        steradian::formats::mesh::ply::read(bytes, &Default::default()).map_err(|e| e.to_string())
    })?;
    let rays = in_file(&args.rays, ray_file::read)?;
    let isa = args.isa.map_or(Isa::best(), Isa::from);
    if !isa.is_supported() {
        return Err(Failure::bad_input(format!("this machine does not have {isa:?}")));
    }
    let positions: Vec<Vec3> = mesh.mesh.positions.iter().map(|&p| Vec3::from_array(p)).collect();
    let geometry = [Geometry::triangles(&positions, &mesh.mesh.triangles)];
    let (start, cpu) = (Instant::now(), cpu_time(ClockId::ProcessCPUTime));
    let top = build(&geometry, args.instances).map_err(|e| Failure::bad_input(e.to_string()))?.with_isa(isa);
    let width = args.width.as_ref().and_then(|width| width.parse().ok()).unwrap_or(32);
    let top = top.with_packet_width(width);
    let (build_seconds, build_cpu) = (start.elapsed().as_secs_f64(), cpu_time(ClockId::ProcessCPUTime) - cpu);
    let (sum, rate, wall_rate) = measure(&top, &rays, args)?;
    let measured = Measured {
        schema: 1,
        query: args.query,
        mode: args.mode,
        robust: true,
        isa: format!("{:?}", top.isa()).to_lowercase(),
        width,
        threads: args.threads,
        triangles: mesh.mesh.triangles.len(),
        instances: args.instances,
        build_seconds,
        build_cpu_seconds: build_cpu.as_secs_f64(),
        bytes: top.bytes(),
        rays: rays.len(),
        hits: sum.hits,
        sum_t: sum.t,
        mrays_per_cpu_second: rate,
        mrays_per_second: wall_rate,
    };
    if args.json {
        terminal::json(&measured)?;
    } else {
        let text = format!(
            "{:.2} Mrays per CPU second ({:.2} per second), {} of {} rays hit; built in {:.3} s, {:.1} MB\n",
            rate,
            wall_rate,
            sum.hits,
            rays.len(),
            build_seconds,
            measured.bytes as f64 / 1e6
        );
        terminal::data(text.as_bytes())?;
    }
    Ok(failure::DONE)
}

/// Reads a file; errors name it.
fn in_file<T>(path: &Path, read: impl Fn(&[u8]) -> Result<T, String>) -> Result<T, Failure> {
    let located = |e: String| Failure::bad_input(format!("{}: {e}", path.display()));
    let bytes = steradian::image::read_regular(path, 8 << 30).map_err(|e| located(e.to_string()))?;
    read(&bytes).map_err(located)
}

/// The mesh in the world, or instances of it.
fn build(geometry: &[Geometry], instances: u32) -> Result<TopLevel, steradian::accel::Error> {
    if instances == 0 {
        return TopLevel::build(geometry, Vec::new(), &[]);
    }
    let place = |world_from_object| Instance::new(0, world_from_object);
    let instances: Vec<_> = placement::lattice(instances).into_iter().map(place).collect();
    TopLevel::build(&[], vec![Bvh::build(geometry)?], &instances)
}

/// Traces the rays again and again: what they found, and millions of rays in a second of the processors and of the
/// clock.
fn measure(top: &TopLevel, rays: &[Ray], args: &RaysArgs) -> Result<(Sum, f64, f64), Failure> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(args.threads.into()).build();
    let pool = pool.map_err(|e| Failure::failed(format!("cannot start {} threads: {e}", args.threads)))?;
    let share = rays.len().div_ceil(args.threads.into()).max(1);
    let once = || {
        let traced: Vec<(Sum, Duration)> = pool.broadcast(|thread| {
            let begin = (thread.index() * share).min(rays.len());
            let end = (begin + share).min(rays.len());
            let cpu = cpu_time(ClockId::ThreadCPUTime);
            let sum = trace(top, &rays[begin..end], args);
            (sum, cpu_time(ClockId::ThreadCPUTime) - cpu)
        });
        let (sums, times): (Vec<_>, Vec<_>) = traced.into_iter().unzip();
        (sums.into_iter().sum::<Sum>(), times.into_iter().sum::<Duration>())
    };
    let (sum, _) = once();
    let (mut rates, mut wall_rates) = (Vec::new(), Vec::new());
    for _ in 0..args.repeat {
        let start = Instant::now();
        let (mut cpu, mut traced) = (Duration::ZERO, 0);
        while traced == 0 || start.elapsed() < LEAST {
            cpu += once().1;
            traced += rays.len().max(1);
        }
        rates.push(traced as f64 * 1e-6 / cpu.as_secs_f64().max(1e-9));
        wall_rates.push(traced as f64 * 1e-6 / start.elapsed().as_secs_f64());
    }
    Ok((sum, median(rates), median(wall_rates)))
}

/// Traces rays once.
fn trace(top: &TopLevel, rays: &[Ray], args: &RaysArgs) -> Sum {
    let single = args.mode == Mode::Single;
    // What is sorted is sorted as a whole.
    let batch = if args.mode == Mode::Stream { rays.len().max(1) } else { BATCH };
    match args.query {
        Query::Closest if single => Sum::of(rays.iter().filter_map(|r| top.intersect(r, &())).map(|h| h.t)),
        Query::Occluded if single => Sum { hits: rays.iter().filter(|r| top.occluded(r, &())).count(), t: 0.0 },
        Query::Closest => {
            let mut hits: Vec<Option<Hit>> = vec![None; rays.len().min(batch)];
            let sums = rays.chunks(batch).map(|rays| {
                let hits = &mut hits[..rays.len()];
                match args.mode {
                    Mode::Stream => top.intersect_stream(rays, &(), hits),
                    _ => top.intersect_batch(rays, &(), hits),
                }
                Sum::of(hits.iter().flatten().map(|hit| hit.t))
            });
            sums.sum()
        }
        Query::Occluded => {
            let mut occluded = vec![false; rays.len().min(batch)];
            let count = rays.chunks(batch).map(|rays| {
                let occluded = &mut occluded[..rays.len()];
                match args.mode {
                    Mode::Stream => top.occluded_stream(rays, &(), occluded),
                    _ => top.occluded_batch(rays, &(), occluded),
                }
                occluded.iter().filter(|&&o| o).count()
            });
            Sum { hits: count.sum(), t: 0.0 }
        }
    }
}
