//! `steradian verify`: whether integrators agree on a scene.

use crate::{
    args::VerifyArgs,
    failure::{self, Failure, Outcome},
    open, output,
    terminal::{self, Terminal},
};
use serde::Serialize;
use std::{fmt::Write, path::Path};
use steradian::{
    Control, Film, Layer, Quality, Scene,
    image::WriteOptions,
    verify::{self, Comparison},
};

#[derive(Debug, Serialize)]
struct Answer<'a> {
    schema: u32,
    scene: &'a Path,
    reference: &'a str,
    integrators: Vec<Row<'a>>,
    agrees: bool,
}

#[derive(Debug, Serialize)]
struct Row<'a> {
    integrator: &'a str,
    /// What of the scene it cannot do; nothing else is known then.
    cannot: Option<&'a str>,
    agrees: Option<bool>,
    mean_ratio: Option<f64>,
    difference: Option<f64>,
    noise: Option<f64>,
    coarser_difference: Option<f64>,
    largest_z: Option<f64>,
    allowed_z: Option<f64>,
    cpu_seconds: Option<f64>,
}

/// Renders, compares, tells.
pub fn run(args: &VerifyArgs, terminal: Terminal) -> Outcome {
    open::limit_threads(args.scene_options.threads);
    let opened = open::open(&args.scene, &args.scene_options, Some(args.spp));
    let ready = opened.into_scene(&args.scene, args.scene_options.strict, terminal)?;
    let scene = ready.scene;
    if let Some(folder) = &args.output {
        std::fs::create_dir_all(folder)
            .map_err(|e| Failure::failed(format!("cannot make the folder {}: {e}", folder.display())))?;
    }
    let quality = Quality {
        spp: Some(args.spp),
        seed: Some(args.seed),
        threads: usize::from(args.scene_options.threads),
        ..Quality::default()
    };
    let told = |name: &str| terminal.say(&format!("rendering with {name}"));
    let report = verify::verify(&scene, &quality, &args.integrator, &Control::default(), told)
        .map_err(|e| Failure::bad_input(e.to_string()))?;
    if let Some(folder) = &args.output {
        save(&scene, &report, folder)?;
    }
    let rows: Vec<Row<'_>> = report.verified.iter().map(row).collect();
    if args.json {
        let (scene, reference) = (args.scene.as_path(), report.reference.as_str());
        terminal::json(&Answer { schema: 1, scene, reference, integrators: rows, agrees: report.agrees() })?;
    } else {
        terminal::data(table(&report.reference, &rows).as_bytes())?;
    }
    if report.agrees() {
        return Ok(failure::DONE);
    }
    let wrong: Vec<&str> = report.verified.iter().filter(|v| !agrees(v)).map(|v| v.integrator.as_str()).collect();
    let message = format!("{} and {} do not agree on {}", report.reference, wrong.join(", "), args.scene.display());
    Err(Failure { code: failure::DIFFERENT, message })
}

fn agrees(v: &verify::Verified) -> bool {
    match &v.outcome {
        verify::Outcome::Compared(c) => c.agrees,
        verify::Outcome::Cannot(_) => true,
    }
}

fn row(v: &verify::Verified) -> Row<'_> {
    let (cannot, c) = match &v.outcome {
        verify::Outcome::Compared(c) => (None, Some(c)),
        verify::Outcome::Cannot(what) => (Some(what.as_str()), None),
    };
    let of = |f: fn(&Comparison) -> f64| c.map(f);
    Row {
        integrator: &v.integrator,
        cannot,
        agrees: c.map(|c| c.agrees),
        mean_ratio: of(|c| c.ratio),
        difference: of(|c| c.difference),
        noise: of(|c| c.noise),
        coarser_difference: c.and_then(|c| c.wider),
        largest_z: of(|c| c.largest),
        allowed_z: of(|c| c.allowed),
        cpu_seconds: of(|c| c.seconds),
    }
}

/// Differences are root mean squares over blocks, as parts of the picture's mean.
fn table(reference: &str, rows: &[Row<'_>]) -> String {
    let mut out = format!(
        "{:<14} {:>9} {:>12} {:>9} {:>13} {:>9} {:>8}  agrees with {reference}\n",
        "integrator", "mean", "difference", "noise", "coarser", "largest z", "CPU s"
    );
    for r in rows {
        let line = match (r.cannot, r.mean_ratio, r.difference, r.noise, r.largest_z, r.cpu_seconds) {
            (None, Some(mean), Some(difference), Some(noise), Some(z), Some(seconds)) => {
                let wider = r.coarser_difference.map_or("-".into(), |w| format!("{:.3} %", 100.0 * w));
                let verdict = if r.agrees == Some(true) { "yes" } else { "NO" };
                format!(
                    "{mean:>9.4} {:>10.3} % {:>7.3} % {wider:>13} {z:>9.2} {seconds:>8.2}  {verdict}",
                    100.0 * difference,
                    100.0 * noise
                )
            }
            (what, ..) => format!("cannot do {}", what.unwrap_or_default()),
        };
        let _ = writeln!(out, "{:<14} {line}", r.integrator);
    }
    out
}

/// Saves the pictures, and what they are more or less than the reference.
fn save(scene: &Scene, report: &verify::Report, folder: &Path) -> Result<(), Failure> {
    let write = |name: &str, film: &Film| {
        let name = name.split(':').next().unwrap_or(name);
        let path = folder.join(format!("{name}.exr"));
        output::save(&[path], &steradian::develop(scene, film, &[Layer::Variance]), &WriteOptions::default(), true)
    };
    write(&report.reference, &report.film)?;
    for v in &report.verified {
        let verify::Outcome::Compared(c) = &v.outcome else { continue };
        write(&v.integrator, &c.film)?;
        let mut difference = c.film.clone();
        for (ours, theirs) in difference.pixels.iter_mut().zip(&report.film.pixels) {
            let (a, b, v, w) = (ours.mean(), theirs.mean(), ours.variance_of_mean(), theirs.variance_of_mean());
            let samples = ours.samples.min(theirs.samples);
            *ours = steradian::Pixel::of(
                std::array::from_fn(|c| a[c] - b[c]),
                std::array::from_fn(|c| v[c] + w[c]),
                samples,
            );
        }
        write(&format!("{}-difference", v.integrator.split(':').next().unwrap_or_default()), &difference)?;
    }
    Ok(())
}
