//! Building, and what is built.

use super::{
    case::{self, Case},
    embree::Embree,
    number,
};
use crate::{
    clock::{median, timed},
    report::{Report, Table},
};
use serde_json::{Value, json};
use std::{
    error::Error,
    time::{Duration, Instant},
};
use steradian_accel::{Accel, Builder};

/// Number of builds of each builder, in turn.
const ROUNDS: usize = 7;

/// The table that [`measure`] makes rows of.
pub fn table() -> Table {
    let mut table = Table::new(
        "Building against Embree",
        &[
            "scene",
            "triangles",
            "CPU s: ratio",
            "here",
            "Embree",
            "s on two threads: ratio",
            "here, two",
            "Embree, two",
            "bytes per triangle",
            "Embree's",
        ],
    );
    table.note(format!(
        "CPU seconds on one thread and seconds by the clock on two, {ROUNDS} turns of two, of which the second one counts, medians; ratios \
         above one are in our favour. Embree: medium quality; bytes without its copy of the mesh. Instances and what they are of together."
    ));
    table
}

/// Waits, awake, until other threads that have built before, and look for more to do, have gone to sleep.
fn rest() {
    let start = Instant::now();
    while start.elapsed() < Duration::from_millis(20) {
        std::hint::spin_loop();
    }
}

/// CPU seconds and seconds by the clock of some work.
fn seconds<T>(work: impl FnOnce() -> T) -> (T, [f64; 2]) {
    let start = Instant::now();
    let (done, cpu) = timed(work);
    (done, [cpu, start.elapsed().as_secs_f64()])
}

/// Time that counts: CPU seconds on one thread, wall-clock seconds on more.
fn counted([cpu, clock]: [f64; 2], threads: usize) -> f64 {
    if threads == 1 { cpu } else { clock }
}

/// A row: both build in turns on one thread and on two.
pub fn measure(case: &Case, embree: Option<&Embree>) -> Result<Vec<Value>, Box<dyn Error>> {
    let mut medians = Vec::new();
    for threads in [1, 2] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
        let (mut ours, mut theirs) = (Vec::new(), Vec::new());
        for _ in 0..ROUNDS {
            // Of two times the second one counts: its threads are awake, and those of the other side have gone to
            // sleep.
            let twice = || {
                rest();
                case.build()?;
                let (built, spent) = seconds(|| case.build());
                built.map(|_| counted(spent, threads))
            };
            // The thread that asks is one of those that build, on both sides.
            ours.push(pool.install(twice)?);
            if let Some(embree) = embree {
                rest();
                let build = || embree.build(&case.mesh, &case.places, false, threads);
                build()?;
                let built = build()?;
                theirs.push(counted([built.cpu_seconds, built.seconds], threads));
            }
        }
        let (ours, theirs) = (median(ours), if theirs.is_empty() { f64::NAN } else { median(theirs) });
        medians.extend([theirs / ours, ours, theirs].map(number));
    }
    let triangles = case.mesh.1.len();
    let bytes = match embree {
        Some(embree) => embree.build(&case.mesh, &case.places, false, 1)?.bytes() as f64,
        None => f64::NAN,
    };
    let mut row = vec![json!(case.name), json!(triangles)];
    row.append(&mut medians);
    row.extend([case.build()?.bytes() as f64, bytes].map(|bytes| number(bytes / triangles as f64)));
    Ok(row)
}

/// All builders on the large mesh: time, memory, and nodes and blocks that rays visit.
pub fn builders(report: &mut Report) -> Result<(), Box<dyn Error>> {
    let mut table = Table::new(
        "Builders",
        &[
            "builder",
            "CPU s",
            "bytes per triangle",
            "primary: nodes and blocks",
            "triangles",
            "bounce: nodes and blocks",
            "triangles, bounce",
        ],
    );
    let case = case::all(&[])?.swap_remove(0);
    for builder in Builder::ALL {
        let (top, cpu) = timed(|| case.build_by(builder));
        let top = top?;
        let mut row =
            vec![json!(format!("{builder:?}")), json!(cpu), json!(top.bytes() as f64 / case.mesh.1.len() as f64)];
        let sets = case.rays(&top);
        let accel = Accel::Bvh(top);
        for (_, rays) in &sets[..2] {
            let costs: Vec<_> = rays.iter().step_by(16).map(|ray| accel.intersect_cost(ray, &())).collect();
            let mean =
                |of: &dyn Fn(&steradian_accel::Steps) -> f64| costs.iter().map(of).sum::<f64>() / costs.len() as f64;
            row.extend([json!(mean(&|cost| cost.steps as f64)), json!(mean(&|cost| cost.tests as f64))]);
        }
        table.row(row);
    }
    table.note("mesh_1M, rays from outside. CPU seconds over all threads, once.");
    report.add(table);
    Ok(())
}
