//! The graphics pipeline beside lavapipe, Mesa's driver of Vulkan for processors. A package outside the workspace draws
//! with both, since it needs wgpu: `benchmarks/lavapipe`.

use crate::{
    arguments::Bench,
    generate::Mesh,
    rays::{displaced_sphere, read_mesh},
    report::{Report, Table},
};
use serde_json::{Value, json};
use std::{
    error::Error,
    io::Write,
    path::Path,
    process::{Command, Stdio},
};

/// Squares along each side of the six faces of the generated mesh, which has 101 568 triangles.
const SQUARES: i32 = 92;
/// Threads of either side.
const THREADS: &str = "2";

/// Measures each kind of frame, by both; the first mesh that was named takes the place of the generated one.
pub fn measure(bench: &Bench, report: &mut Report) -> Result<(), Box<dyn Error>> {
    let mesh = match bench.mesh.first() {
        Some(file) => read_mesh(file)?,
        None => displaced_sphere(SQUARES),
    };
    let measured = run(&mesh)?;
    let columns = ["row", "ratio", "Steradian, frames per CPU s", "lavapipe's", "pixels that differ, %"];
    let mut table = Table::new("Graphics pipeline against lavapipe, 1920 x 1080", &columns);
    let number = |row: &Value, name: &str| row[name].as_f64().ok_or(format!("no '{name}' of a row"));
    for row in measured["rows"].as_array().ok_or("no rows")? {
        let (ours, theirs) = (number(row, "ours")?, number(row, "theirs")?);
        let different = 100.0 * number(row, "differing")?;
        let numbers = [theirs / ours, 1.0 / ours, 1.0 / theirs, different].map(|x| json!(x));
        table.row([row["row"].clone()].into_iter().chain(numbers).collect());
    }
    table.note(format!(
        "Medians of five turns, clearing and resolving of samples included, CPU time of all threads, {THREADS} of \
         either side. The mesh has {} triangles. A pixel differs where a channel or the depth does by more than \
         2/255. Driver: {}.",
        measured["triangles"],
        measured["driver"].as_str().unwrap_or_default()
    ));
    report.add(table);
    Ok(())
}

/// Builds the package, and gives it the mesh as it expects it.
fn run(mesh: &Mesh) -> Result<Value, Box<dyn Error>> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut program = Command::new(env!("CARGO"))
        .args(["run", "--release", "--quiet", "--manifest-path"])
        .arg(root.join("benchmarks/lavapipe/Cargo.toml"))
        .arg("--target-dir")
        .arg(root.join("target"))
        .envs([("RAYON_NUM_THREADS", THREADS), ("LP_NUM_THREADS", THREADS)])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()?;
    let counts = [mesh.0.len() as u32, mesh.1.len() as u32];
    let points = mesh.0.iter().flat_map(|p| p.to_array().map(f32::to_bits));
    let words = counts.into_iter().chain(points).chain(mesh.1.iter().flatten().copied());
    let bytes: Vec<u8> = words.flat_map(u32::to_le_bytes).collect();
    // Where it ends early, its own message says why.
    let sent = program.stdin.take().map(|mut input| input.write_all(&bytes));
    let output = program.wait_with_output()?;
    if !output.status.success() {
        return Err("the comparison with lavapipe failed, see the message above".into());
    }
    sent.transpose()?;
    Ok(serde_json::from_slice(&output.stdout)?)
}
