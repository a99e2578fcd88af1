//! Rays against Embree: its measurement writes the rays that it traces, and `steradian bench rays` traces the very same ones.

use crate::{
    Bench,
    report::{Report, Table},
};
use serde_json::{Value, json};
use std::{error::Error, path::Path, process::Command};

/// Scenes of the measurement: their name, the cells of the sphere along an edge, and how many instances there are.
const SCENES: [(&str, &str, u32); 3] = [("mesh_1M", "289", 0), ("mesh_10k", "29", 0), ("inst_1000x10k", "29", 1000)];
/// Kinds of rays, and views.
const RAYS: [&str; 3] = ["primary", "bounce1", "shadow"];
const VIEWS: [&str; 2] = ["outside", "inside"];

/// Runs both programs, if the first one is named.
pub fn measure(bench: &Bench, report: &mut Report) -> Result<(), Box<dyn Error>> {
    let Some(program) = &bench.embree_bench else { return Ok(()) };
    let folder = bench.out.join("rays");
    std::fs::create_dir_all(&folder)?;
    let json_path = bench.out.join("embree.json");
    let mut command = Command::new(program);
    command.args(&bench.embree_arguments).arg("--json").arg(&json_path).arg("--dump-rays").arg(&folder);
    let text = output(&mut command)?;
    std::fs::write(bench.out.join("embree.txt"), text)?;
    let embree: Vec<Value> = serde_json::from_slice(&std::fs::read(&json_path)?)?;
    let mut table = Table::new(
        "Rays against Embree",
        &[
            "scene",
            "rays",
            "query",
            "ratio, single",
            "Mrays/s",
            "Embree",
            "ratio, robust",
            "ratio, many",
            "Mrays/s, many",
            "Embree, best width",
        ],
    );
    let mut builds = Table::new("Building against Embree", &["scene", "CPU s", "Embree", "MB", "Embree MB"]);
    for (scene, cells, instances) in SCENES {
        let mesh = folder.join(format!("{scene}.ply"));
        output(Command::new(program).args(["--dump-ply", cells]).arg(&mesh))?;
        let mut built = None;
        for (view, kind) in VIEWS.iter().flat_map(|view| RAYS.map(|kind| (view, kind))) {
            let rays = folder.join(format!("{scene}_{kind}-{view}.rays"));
            for query in ["closest", "occluded"].into_iter().filter(|_| rays.exists()) {
                let trace = |mode: &str| trace(bench, [&mesh, &rays], [query, mode], instances);
                let (single, packet, stream) = (trace("single")?, trace("packet")?, trace("stream")?);
                let rate = |measured: &Value| measured["mrays_per_cpu_second"].as_f64().unwrap_or(f64::NAN);
                let many = rate(&packet).max(rate(&stream));
                let name = format!("{kind}-{view}");
                let of = |scene: &str, width: Option<u32>| best(&embree, scene, &name, query, width);
                let one = of(scene, Some(1));
                let [widest, robust] = [of(scene, None), of(&format!("{scene}/robust"), Some(1))];
                let numbers =
                    [rate(&single) / one, rate(&single), one, rate(&single) / robust, many / widest, many, widest];
                // What Embree's program does not measure is left empty.
                let cells = numbers.map(|x| if x.is_finite() { json!(x) } else { json!("") });
                let [ratio, rate, one, robust, ratio_many, many, widest] = cells;
                let row = [json!(scene), json!(name), json!(query), ratio, rate, one, robust, ratio_many, many, widest];
                table.row(row.to_vec());
                built = Some(single);
            }
        }
        let theirs = embree.iter().find(|row| {
            row["scene"] == scene && row["what"] == "build" && row["mode"] == "medium" && row["threads"] == 1
        });
        if let (Some(ours), Some(theirs)) = (built, theirs) {
            let bytes = |row: &Value| row["bytes"].as_f64().unwrap_or(f64::NAN);
            builds.row(vec![
                json!(scene),
                ours["build_cpu_seconds"].clone(),
                theirs["base_cpu_s"].clone(),
                json!(bytes(&ours) / 1e6),
                json!((bytes(theirs) - theirs["input_bytes"].as_f64().unwrap_or(0.0)) / 1e6),
            ]);
        }
    }
    table.note(
        "One thread, millions of rays in a second of the processor; ratio first. Here tests are always watertight; Embree's are where \
         it says robust. Many: the better of packets and sorted streams, against Embree's best of widths 1, 4, 8 and 16.",
    );
    builds.note("Medium quality; Embree's memory without its copy of the mesh.");
    report.add(table);
    report.add(builds);
    Ok(())
}

/// What a program prints.
fn output(command: &mut Command) -> Result<Vec<u8>, Box<dyn Error>> {
    let run = command.output().map_err(|e| format!("{command:?}: {e}"))?;
    if run.status.success() {
        Ok(run.stdout)
    } else {
        Err(format!("{command:?} failed: {}", String::from_utf8_lossy(&run.stderr)).into())
    }
}

/// Our measurement.
fn trace(
    bench: &Bench,
    [mesh, rays]: [&Path; 2],
    [query, mode]: [&str; 2],
    instances: u32,
) -> Result<Value, Box<dyn Error>> {
    let mut command = Command::new(&bench.steradian);
    command.args(["bench", "rays"]).args([mesh, rays]).args(["--query", query, "--mode", mode, "--json"]);
    command.args(["--repeat", "3", "--instances", &instances.to_string()]);
    Ok(serde_json::from_slice(&output(&mut command)?)?)
}

/// Embree's best rate for some rays on one thread, of one width or of all.
fn best(embree: &[Value], scene: &str, rays: &str, query: &str, width: Option<u32>) -> f64 {
    let query = if query == "closest" { "intersect" } else { "occluded" };
    let is_wanted = |row: &&Value| {
        let mode = row["mode"].as_str().unwrap_or_default();
        let Some(of_width) = mode.strip_prefix(query).and_then(|mode| mode.strip_suffix(" x1")) else { return false };
        let of_width = of_width.trim_end_matches('c').parse().ok();
        row["scene"] == scene && row["what"] == rays && (width.is_none() || width == of_width)
    };
    embree.iter().filter(is_wanted).filter_map(|row| row["mrays_s"].as_f64()).fold(f64::NAN, f64::max)
}
