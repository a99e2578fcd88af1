//! Instructions that traversal and shading take, counted by valgrind's callgrind. Counts do not depend on what else the
//! machine does, so that small changes show. They are those of AVX2, which is as far as valgrind goes, and of one
//! compiler: after an upgrade of either the baseline is written anew.

use crate::generate::bumpy_sphere;
use serde_json::Value;
use std::{collections::BTreeMap, error::Error, hint::black_box, path::PathBuf, process::Command, sync::Arc};
use steradian::{Accelerator, CompileOptions, Control, Quality, Scene, bench};
use steradian_accel::{Accel, Geometry};
use steradian_math::{Ray, Vec3, hash::HashRng};

/// Arguments of `instructions`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Counts to compare with
    #[arg(long, default_value = concat!(env!("CARGO_MANIFEST_DIR"), "/instructions.json"))]
    baseline: PathBuf,
    /// Write the counts there instead
    #[arg(long)]
    update: bool,
    /// Runs one of the things that are counted, for valgrind
    #[arg(long, hide = true)]
    only: Option<String>,
}

/// Counted functions, by name.
const WORK: [(&str, fn()); 3] = [("closest", closest), ("occluded", occluded), ("shading", shading)];

/// Growth beyond which there is a warning.
const ALLOWED: f64 = 1.05;

/// Counts and compares.
pub fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    if let Some(name) = &arguments.only {
        let (_, work) = WORK.iter().find(|w| w.0 == name).ok_or("unknown work")?;
        work();
        return Ok(());
    }
    if Command::new("valgrind").arg("--version").output().is_err() {
        println!("skipped: valgrind is not there");
        return Ok(());
    }
    let mut counts: BTreeMap<String, u64> = BTreeMap::new();
    for (name, _) in WORK {
        match count(name) {
            Ok(n) => {
                counts.insert(name.to_owned(), n);
            }
            Err(e) => println!("warning: {e}"),
        }
    }
    if arguments.update {
        std::fs::write(&arguments.baseline, serde_json::to_string_pretty(&counts)? + "\n")?;
        println!("wrote {}", arguments.baseline.display());
        return Ok(());
    }
    let baseline: BTreeMap<String, Value> = match std::fs::read(&arguments.baseline) {
        Ok(bytes) => serde_json::from_slice(&bytes)?,
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => BTreeMap::new(),
        Err(e) => return Err(e.into()),
    };
    for (name, &now) in &counts {
        let Some(then) = baseline.get(name).and_then(Value::as_f64) else {
            println!("{name}: {now} instructions, and none to compare with");
            continue;
        };
        let ratio = now as f64 / then;
        println!("{name}: {now} instructions, {:+.2} % against {then}", 100.0 * (ratio - 1.0));
        if ratio > ALLOWED {
            println!("warning: {name} takes more than {:.0} % more instructions", 100.0 * (ALLOWED - 1.0));
        }
    }
    Ok(())
}

/// The instructions of one kind of work, without its preparation.
fn count(name: &str) -> Result<u64, Box<dyn Error>> {
    let counted = format!("--toggle-collect=*instructions::counted_{name}*");
    let run = Command::new("valgrind")
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null", &counted])
        .arg(std::env::current_exe()?)
        .args(["instructions", "--only", name])
        .output()?;
    let said = String::from_utf8_lossy(&run.stderr);
    let collected =
        said.lines().find_map(|line| line.split_once("Collected : ")).and_then(|(_, n)| n.trim().parse().ok());
    match collected {
        Some(n) if n > 0 && run.status.success() => Ok(n),
        _ => Err(format!("valgrind did not count '{name}': {said}").into()),
    }
}

/// A mesh, and rays through it.
fn traversal() -> (Accel, Vec<Ray>) {
    let (positions, indices) = bumpy_sphere(40_000);
    let accel = Accel::build(Accelerator::Bvh, &[Geometry::triangles(&positions, &indices)], Vec::new(), &[]);
    let mut rng = HashRng::new(1);
    let mut point = || Vec3::new(rng.next_f32(), rng.next_f32(), rng.next_f32()) * 2.0 - 1.0;
    let mut ray = || {
        let origin = point() * 1.5;
        Ray::new(origin, point() - origin)
    };
    let rays = (0..20_000).map(|_| ray()).collect();
    (accel.unwrap_or_else(|e| panic!("a small mesh: {e}")), rays)
}

fn closest() {
    let (accel, rays) = traversal();
    black_box(counted_closest(&accel, &rays));
}

#[inline(never)]
fn counted_closest(accel: &Accel, rays: &[Ray]) -> f32 {
    rays.iter().filter_map(|ray| accel.intersect(ray, &())).map(|hit| hit.t).sum()
}

fn occluded() {
    let (accel, rays) = traversal();
    black_box(counted_occluded(&accel, &rays));
}

#[inline(never)]
fn counted_occluded(accel: &Accel, rays: &[Ray]) -> usize {
    rays.iter().filter(|ray| accel.occluded(ray, &())).count()
}

/// Paths in the Cornell box, in waves: a kernel that the compiler no longer makes vector instructions of shows here.
fn shading() {
    let Some(desc) = steradian::cornell::builtin("cornell-box-area") else { return };
    let options = CompileOptions { size: Some((64, 64)), ..CompileOptions::default() };
    let Some(scene) = steradian::compile(&desc, &options).scene else { return };
    black_box(bench::ray_sets(&scene, 1));
    counted_shading(&Arc::new(scene));
}

#[inline(never)]
fn counted_shading(scene: &Arc<Scene>) {
    let quality = Quality { spp: Some(8), threads: 1, ..Quality::default() };
    if let Ok(mut session) = quality.render(scene).and_then(|render| render.session(scene)) {
        session.step(8, &Control::default());
        black_box(session.counters());
    }
}
