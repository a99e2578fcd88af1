//! Reading speed of files.

use crate::{
    clock::{median, timed},
    generate,
    report::{Report, Table},
};
use serde_json::json;
use std::{error::Error, path::Path};
use steradian::formats::Options;

/// Reads generated files several times.
pub fn measure(folder: &Path, report: &mut Report) -> Result<(), Box<dyn Error>> {
    let mesh = generate::bumpy_sphere(2_000_000);
    let mut table = Table::new("Loading", &["file", "MB", "CPU s", "MB per CPU s", "wall s"]);
    for (name, label) in [("loading.pbrt", "pbrt text"), ("loading.ply", "binary PLY")] {
        let path = folder.join(name);
        if name.ends_with("ply") {
            generate::ply(&path, &mesh)?
        } else {
            generate::pbrt(&path, &mesh)?
        }
        let megabytes = std::fs::metadata(&path)?.len() as f64 / 1e6;
        let (mut cpu, mut wall) = (Vec::new(), Vec::new());
        for _ in 0..5 {
            let start = std::time::Instant::now();
            let (errors, seconds) = timed(|| {
                let loaded = steradian::load(&path, &Options::default());
                loaded.diagnostics.error_count()
            });
            if errors > 0 {
                return Err(format!("{name} cannot be read").into());
            }
            cpu.push(seconds);
            wall.push(start.elapsed().as_secs_f64());
        }
        let (cpu, wall) = (median(cpu), median(wall));
        table.row(vec![json!(label), json!(megabytes), json!(cpu), json!(megabytes / cpu), json!(wall)]);
        std::fs::remove_file(&path)?;
    }
    table.note("From the file to a description of the scene, page cache warm; medians of five.");
    report.add(table);
    Ok(())
}
