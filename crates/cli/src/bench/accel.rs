//! `steradian bench accel`: one table of all structures.

use crate::{
    args::SceneOptions,
    failure::{self, Failure, Outcome},
    memory,
    open::{self, Ready},
    terminal::{self, Terminal},
};
use clap::Args;
use serde::Serialize;
use std::{fmt::Write, path::PathBuf, time::Duration};
use steradian::{
    Accelerator,
    bench::{self, Measured, RaySet},
};

/// `steradian bench accel`.
#[derive(Args, Debug)]
#[command(
    after_help = "Rays go through the middles of pixels (primary), on from what these meet by the cosine (bounce), and from there to \
    lights (shadow).\nRates are for one thread. With structure `none` every ray tests every primitive: leave it out of large scenes."
)]
pub struct AccelArgs {
    /// Scene file, - for standard input, or builtin:NAME
    pub scene: PathBuf,
    /// Structures to compare, a comma-separated list of `steradian list accelerators`; by default all, but `none` in
    /// scenes of more than 20000 faces
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    pub structures: Vec<String>,
    /// Most rays of each kind
    #[arg(long, value_name = "N", default_value_t = 262_144, value_parser = clap::value_parser!(u32).range(1..=100_000_000))]
    pub rays: u32,
    /// Time for each kind of rays
    #[arg(long, value_name = "DURATION", value_parser = crate::values::duration, default_value = "0.3s")]
    pub each: Duration,
    /// The scene.
    #[command(flatten)]
    pub scene_options: SceneOptions,
    /// Print one line of JSON to stdout
    #[arg(long)]
    pub json: bool,
}

/// The whole table.
#[derive(Debug, Serialize)]
struct Table<'a> {
    schema: u32,
    scene: &'a str,
    faces: u64,
    rays: Vec<(&'static str, usize)>,
    structures: Vec<Row>,
}

/// A structure.
#[derive(Debug, Serialize)]
struct Row {
    structure: &'static str,
    build_seconds: f64,
    /// The structure with its copy of the primitives.
    bytes: usize,
    /// By kind of rays.
    kinds: Vec<Kind>,
}

/// Speed on rays of a kind.
#[derive(Debug, Serialize)]
struct Kind {
    rays: &'static str,
    mrays_per_cpu_second: f64,
    steps_per_ray: f64,
    tests_per_ray: f64,
    hit_share: f64,
    /// True if every bit of the hits is that of the first structure of the table.
    agrees: bool,
}

/// Without being asked, `none` is left out of larger scenes.
const MOST_FACES_FOR_NONE: u64 = 20_000;

/// Measures and prints.
pub fn run(args: &AccelArgs, terminal: Terminal) -> Outcome {
    open::limit_threads(args.scene_options.threads);
    let mut opened = open::open(&args.scene, &args.scene_options, None);
    let faces = opened.desc.face_count();
    let structures = structures(&args.structures, faces)?;
    let desc = std::mem::take(&mut opened.desc);
    let Ready { scene, .. } = open::ready(opened, &args.scene, args.scene_options.strict, terminal)?;
    let sets = bench::ray_sets(&scene, args.rays as usize);
    drop(scene);
    let mut rows: Vec<Row> = Vec::new();
    let mut first: Vec<u64> = Vec::new();
    for accelerator in structures {
        let name = accelerator.about().0;
        terminal.say(&format!("measuring {name}"));
        let options = SceneOptions { accelerator: name.into(), ..args.scene_options.clone() };
        let options = open::compile_options(&options, None);
        let compiled = steradian::compile(&desc, &options);
        let Some(scene) = compiled.scene else {
            return Err(Failure::failed(format!(
                "'{}' cannot be compiled with structure '{name}'",
                args.scene.display()
            )));
        };
        let measured: Vec<(&RaySet, Measured)> =
            sets.iter().filter_map(|set| Some((set, bench::measure(&scene, set, args.each)?))).collect();
        if first.is_empty() {
            first = measured.iter().map(|m| m.1.found).collect();
        }
        let kind = |((set, m), first): (&(&RaySet, Measured), &u64)| Kind {
            rays: set.name,
            mrays_per_cpu_second: m.mrays_per_cpu_second,
            steps_per_ray: m.steps,
            tests_per_ray: m.tests,
            hit_share: m.hits,
            agrees: m.found == *first,
        };
        rows.push(Row {
            structure: name,
            build_seconds: compiled.build_time.as_secs_f64(),
            bytes: scene.accel().bytes(),
            kinds: measured.iter().zip(&first).map(kind).collect(),
        });
    }
    let rays = sets.iter().map(|set| (set.name, set.rays.len())).collect();
    let table = Table { schema: 1, scene: &open::shown(&args.scene), faces, rays, structures: rows };
    if args.json {
        terminal::json(&table)?;
    } else {
        terminal::data(table.text().as_bytes())?;
    }
    match table.structures.iter().find(|row| row.kinds.iter().any(|kind| !kind.agrees)) {
        Some(row) => Err(Failure::failed(format!("'{}' finds something else than the first structure", row.structure))),
        None => Ok(failure::DONE),
    }
}

/// Which structures are compared.
fn structures(wanted: &[String], faces: u64) -> Result<Vec<Accelerator>, Failure> {
    if wanted.is_empty() {
        let is_wanted = |a: &Accelerator| *a != Accelerator::None || faces <= MOST_FACES_FOR_NONE;
        return Ok(Accelerator::ALL.into_iter().filter(is_wanted).collect());
    }
    let names = Accelerator::ALL.map(|a| a.about().0);
    let known = |name: &String| {
        let name = crate::values::known_name(name, "structure", names.into_iter()).map_err(Failure::bad_input)?;
        Ok(Accelerator::by_name(name).unwrap_or_default())
    };
    wanted.iter().map(known).collect()
}

impl Table<'_> {
    fn text(&self) -> String {
        let mut out = String::new();
        let sets: Vec<String> = self.rays.iter().map(|(name, n)| format!("{n} {name}")).collect();
        let _ = writeln!(out, "{}: {} faces; {} rays", self.scene, self.faces, sets.join(", "));
        let _ = write!(out, "{:<14} {:>9} {:>9}", "structure", "build s", "memory");
        let kinds = self.rays.iter().filter(|(_, n)| *n > 0).map(|(name, _)| name);
        kinds.clone().for_each(|name| {
            let _ = write!(out, "  {:>26}", name);
        });
        let _ = write!(out, "\n{:<14} {:>9} {:>9}", "", "", "");
        kinds.for_each(|_| {
            let _ = write!(out, "  {:>8} {:>8} {:>8}", "Mrays/s", "steps", "tests");
        });
        out.push('\n');
        for row in &self.structures {
            let _ = write!(
                out,
                "{:<14} {:>9.3} {:>9}",
                row.structure,
                row.build_seconds,
                memory::readable(row.bytes as u64)
            );
            for k in &row.kinds {
                let _ =
                    write!(out, "  {:>8.3} {:>8.1} {:>8.1}", k.mrays_per_cpu_second, k.steps_per_ray, k.tests_per_ray);
            }
            out.push('\n');
        }
        out
    }
}
