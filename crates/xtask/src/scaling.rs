//! Scaling of cost: growth with triangles, fall with threads.

use crate::{
    clock::median,
    generate,
    plot::{self, Series},
    report::{Report, Table},
    structures::{compile, load},
};
use serde_json::json;
use std::{error::Error, path::Path, sync::Arc};
use steradian::{CompileOptions, Control, Quality, Scene};

/// Edge of the pictures.
const SIZE: u32 = 192;

/// CPU and wall seconds of a render.
fn render(scene: &Arc<Scene>, spp: u32, threads: usize) -> Result<[f64; 2], Box<dyn Error>> {
    let quality = Quality { spp: Some(spp), threads, ..Quality::default() };
    let mut session = quality.render(scene)?.session(scene)?;
    session.step(spp, &Control::default());
    Ok([session.cpu().as_secs_f64(), session.wall().as_secs_f64()])
}

/// The cost of a sample and the memory of a triangle, for meshes from a thousand triangles on.
pub fn triangles(folder: &Path, most: usize, report: &mut Report) -> Result<(), Box<dyn Error>> {
    let mut table = Table::new(
        "Cost against triangles",
        &["triangles", "load s", "build s", "structure bytes per triangle", "all bytes per triangle", "µs per sample"],
    );
    let spp = 8;
    let mut points = Vec::new();
    for n in (6..=14).map(|k| 10_f64.powf(f64::from(k) / 2.0).round() as usize).filter(|&n| n <= most) {
        let path = folder.join(format!("mesh_{n}.xml"));
        generate::scene(&path, &generate::bumpy_sphere(n), SIZE)?;
        let start = std::time::Instant::now();
        let desc = load(&path)?;
        let load = start.elapsed().as_secs_f64();
        let faces = desc.face_count() as f64;
        let (scene, build) = compile(&desc, &CompileOptions::default())?;
        drop(desc);
        let cpu = (0..3).map(|_| Ok(render(&scene, spp, 1)?[0])).collect::<Result<Vec<f64>, Box<dyn Error>>>()?;
        let each = median(cpu) / f64::from(SIZE * SIZE * spp) * 1e6;
        points.push([faces, each]);
        table.row(vec![
            json!(faces as u64),
            json!(load),
            json!(build),
            json!(scene.accel().bytes() as f64 / faces),
            json!(scene.geometry_bytes() as f64 / faces),
            json!(each),
        ]);
        // Large meshes are written anew each time.
        std::fs::remove_file(path.with_extension("ply"))?;
        std::fs::remove_file(&path)?;
    }
    // The slope against log n, in the lower and the upper half: logarithmic growth keeps it.
    let slope = |points: &[[f64; 2]]| match (points.first(), points.last()) {
        (Some(a), Some(b)) if a[0] < b[0] => (b[1] - a[1]) / (b[0] / a[0]).log10(),
        _ => f64::NAN,
    };
    let (low, high) = points.split_at(points.len().div_ceil(2));
    table.note(format!(
        "µs per sample and decade of triangles: {:.3} over the lower sizes, {:.3} over the upper ones. See scaling.svg.",
        slope(low),
        slope(high)
    ));
    report.add(table);
    let series = [Series { name: "µs of one thread per sample", points }];
    std::fs::write(
        folder.join("scaling.svg"),
        plot::log_x("Cost of a sample against triangles", "triangles", "µs", &series),
    )?;
    Ok(())
}

/// One thread against two, and as many as there are.
pub fn threads(folder: &Path, most: usize, report: &mut Report) -> Result<(), Box<dyn Error>> {
    let path = folder.join("threads.xml");
    generate::scene(&path, &generate::bumpy_sphere(most.min(100_000)), 256)?;
    let (scene, _) = compile(&load(&path)?, &CompileOptions::default())?;
    let all = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    let mut counts = vec![1, 2, all];
    counts.dedup();
    let mut seconds = vec![Vec::new(); counts.len()];
    // In turns, so that whatever else the machine does falls on all of them.
    for _ in 0..5 {
        for (threads, seconds) in counts.iter().zip(&mut seconds) {
            seconds.push(render(&scene, 16, *threads)?);
        }
    }
    let mut table = Table::new("Threads", &["threads", "wall s", "CPU s", "speed-up"]);
    let wall = |runs: &[[f64; 2]]| median(runs.iter().map(|run| run[1]).collect());
    for (threads, runs) in counts.iter().zip(&seconds) {
        let cpu = median(runs.iter().map(|run| run[0]).collect());
        table.row(vec![json!(threads), json!(wall(runs)), json!(cpu), json!(wall(&seconds[0]) / wall(runs))]);
    }
    report.add(table);
    Ok(())
}
