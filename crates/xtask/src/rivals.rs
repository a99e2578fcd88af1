//! Whole pictures against Mitsuba: efficiency, 1/(relMSE × CPU seconds), of both on the same scenes.

use crate::{
    arguments::Bench,
    generate,
    report::{Report, Table},
    structures::{compile, load},
};
use serde_json::json;
use std::{
    error::Error,
    path::{Path, PathBuf},
    process::Command,
};
use steradian::{CompileOptions, Control, Quality};

/// Renders a scene with Mitsuba: one picture to compile the kernels, then as many as are asked for, each with another
/// seed, whose pixels are written one after the other as floats; prints the CPU seconds of each.
const MITSUBA: &str = "\
import sys, time
import drjit as dr, mitsuba as mi, numpy as np
scene, variant, spp, frames, out = sys.argv[1], sys.argv[2], int(sys.argv[3]), int(sys.argv[4]), sys.argv[5]
mi.set_variant(variant)
# Scenes that leave the sampler open get the better one.
scene = mi.load_file(scene, **({'sampler': 'multijitter'} if '$sampler' in open(scene).read() else {}))
with open(out, 'wb') as file:
    for seed in range(frames + 1):
        start = time.process_time()
        image = mi.render(scene, spp=spp, seed=seed)
        if 'llvm' in variant: dr.eval(image); dr.sync_thread()
        if seed > 0:
            print(time.process_time() - start)
            np.array(image, dtype='<f4')[..., :3].tofile(file)
";

/// Samples for each pixel.
const SPP: u32 = 16;
/// Samples of the picture that errors are relative to. That of the measured ones would not do: where one of them met
/// something rare and bright, it would be its own excuse.
const LEVEL_SPP: u32 = 256;
/// Pictures of each renderer.
const FRAMES: usize = 5;
/// Added to squares of pixels, to which errors are relative.
const FLOOR: f64 = 0.01;

/// Frames of a scene by one renderer.
struct Frames {
    /// Values, three to a pixel.
    values: Vec<Vec<f64>>,
    /// CPU seconds of each.
    cpu: Vec<f64>,
}

impl Frames {
    /// Mean over frames of each value.
    fn mean(&self) -> Vec<f64> {
        let n = self.values.len() as f64;
        (0..self.values[0].len()).map(|i| self.values.iter().map(|v| v[i]).sum::<f64>() / n).collect()
    }

    /// The mean of half the squared difference of two frames, over `I² + 0.01`.
    fn relative_error(&self, level: &[f64]) -> f64 {
        let mean = self.mean();
        let squares = |i: usize| self.values.iter().map(|v| (v[i] - mean[i]).powi(2)).sum::<f64>();
        let sum: f64 = level.iter().enumerate().map(|(i, l)| squares(i) / (l * l + FLOOR)).sum();
        sum / ((self.values.len() - 1) * level.len()) as f64
    }

    /// The median of the CPU seconds.
    fn seconds(&self) -> f64 {
        let mut cpu = self.cpu.clone();
        cpu.sort_by(f64::total_cmp);
        cpu[cpu.len() / 2]
    }
}

/// Measures the scenes that were named, or else a generated one.
pub fn measure(bench: &Bench, report: &mut Report) -> Result<(), Box<dyn Error>> {
    let Some(python) = &bench.mitsuba_python else { return Ok(()) };
    let mut scenes = bench.scene.clone();
    if scenes.is_empty() {
        let path = bench.out.join("rivals.xml");
        generate::scene(&path, &generate::bumpy_sphere(100_000), 256)?;
        scenes.push(path);
    }
    let columns =
        ["scene", "ratio", "efficiency", "relMSE", "CPU s", "Mitsuba", "its relMSE", "its CPU s", "ratio of means"];
    let mut table = Table::new("Whole pictures against Mitsuba", &columns);
    for path in &scenes {
        let ours = render(path, SPP, FRAMES)?;
        let theirs = mitsuba(python, path, &bench.out.join("mitsuba.f32"))?;
        if ours.values[0].len() != theirs.values[0].len() {
            return Err(format!("{}: the two pictures differ in size", path.display()).into());
        }
        let means = [ours.mean(), theirs.mean()];
        let level = render(path, LEVEL_SPP, 1)?.mean();
        let [a, b] = [&ours, &theirs].map(|frames| (frames.relative_error(&level), frames.seconds()));
        let [x, y] = [a, b].map(|(error, seconds)| 1.0 / (error * seconds));
        let total = |values: &[f64]| values.iter().sum::<f64>();
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        let of_means = total(&means[0]) / total(&means[1]);
        table.row(
            [json!(name)].into_iter().chain([x / y, x, a.0, a.1, y, b.0, b.1, of_means].map(|v| json!(v))).collect(),
        );
    }
    table.note(format!(
        "Efficiency is 1/(relMSE × CPU seconds), of {FRAMES} pictures of {SPP} samples per pixel; relMSE is noise alone, half the squared \
         difference of two pictures of one renderer over I² + {FLOOR}, with I from {LEVEL_SPP} samples of ours. Mitsuba's variant is {VARIANT}, with the sampler that the scene names, or multijitter where it leaves that open."
    ));
    report.add(table);
    Ok(())
}

/// So many pictures with this program.
fn render(path: &Path, spp: u32, frames: usize) -> Result<Frames, Box<dyn Error>> {
    let (scene, _) = compile(&load(path)?, &CompileOptions::default())?;
    let mut made = Frames { values: Vec::new(), cpu: Vec::new() };
    for seed in 1..=frames as u64 {
        let quality = Quality { spp: Some(spp), seed: Some(seed), ..Quality::default() };
        let mut session = quality.render(&scene)?.session(&scene)?;
        session.step(spp, &Control::default());
        made.values.push(session.film().pixels.iter().flat_map(|p| p.mean()).collect());
        made.cpu.push(session.cpu().as_secs_f64());
    }
    Ok(made)
}

/// Mitsuba's variant.
const VARIANT: &str = "llvm_ad_rgb";

/// With Mitsuba.
fn mitsuba(python: &Path, scene: &Path, out: &PathBuf) -> Result<Frames, Box<dyn Error>> {
    let numbers = [SPP.to_string(), FRAMES.to_string()];
    let run = Command::new(python).args(["-c", MITSUBA]).arg(scene).arg(VARIANT).args(numbers).arg(out).output()?;
    let cpu: Vec<f64> =
        String::from_utf8_lossy(&run.stdout).split_whitespace().filter_map(|x| x.parse().ok()).collect();
    if cpu.len() != FRAMES {
        return Err(format!("{VARIANT} could not be measured: {}", String::from_utf8_lossy(&run.stderr)).into());
    }
    let bytes = std::fs::read(out)?;
    std::fs::remove_file(out)?;
    let values: Vec<f64> =
        bytes.chunks_exact(4).map(|b| f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]]))).collect();
    Ok(Frames { values: values.chunks(values.len() / FRAMES).map(<[f64]>::to_vec).collect(), cpu })
}
