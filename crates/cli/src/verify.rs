//! `steradian verify`: whether integrators agree on a scene.

mod page;

use crate::{
    args::{Color, VerifyArgs},
    failure::{self, Failure, Outcome},
    open, output,
    terminal::{self, Terminal},
};
use serde::Serialize;
use std::{
    fmt::Write,
    path::{Path, PathBuf},
};
use steradian::{
    Control, Film, Inputs, Layer, Quality, Scene, SensorNoise,
    image::{self, WriteOptions},
    scene::Family,
    verify::{self, Difference, Verdict},
};

#[derive(Debug, Serialize)]
struct Answer<'a> {
    schema: u32,
    scene: &'a Path,
    reference: &'a str,
    /// Light that no reference finds; nothing is decided then.
    reference_lacks: Option<&'a str>,
    integrators: Vec<Row<'a>>,
    /// True if all were decided, and none differs.
    agrees: bool,
}

#[derive(Debug, Serialize)]
struct Row<'a> {
    integrator: &'a str,
    /// Unsupported feature of the scene; nothing else is known then.
    cannot: Option<&'a str>,
    /// `agrees`, `converges` (biased, and the limit of small radii or patches agrees), `undecided` or `differs`.
    verdict: Option<&'static str>,
    mean_ratio: Option<f64>,
    /// The smallest difference of `mean_ratio` from 1 that is told from noise.
    detectable_difference: Option<f64>,
    difference: Option<f64>,
    noise: Option<f64>,
    /// By how much `mean_ratio` changed when the radius or the edges of patches were halved.
    change: Option<f64>,
    largest_z: Option<f64>,
    allowed_z: Option<f64>,
    spp: Option<u32>,
    cpu_seconds: Option<f64>,
}

/// Renders, compares, tells.
pub fn run(args: &VerifyArgs, terminal: Terminal) -> Outcome {
    open::limit_threads(args.scene_options.threads);
    let mut options = args.scene_options.clone();
    // Of spectra all paths of a pass share the wavelengths in some methods: noise that says nothing of how light is
    // found.
    if options.color == Color::Auto {
        options.color = Color::Rgb;
    }
    // Noise that a sensor adds says nothing of the light.
    options.sensor_noise = SensorNoise::Off;
    let opened = open::open(&args.scene, &options, Some(args.spp));
    let ready = open::ready(opened, &args.scene, args.scene_options.strict, terminal)?;
    let mut scene = ready.scene;
    let mut paths = Vec::from_iter(args.html.clone());
    if let Some(folder) = &args.output {
        std::fs::create_dir_all(folder)
            .map_err(|e| Failure::failed(format!("cannot make the folder {}: {e}", folder.display())))?;
        // What is written has the names of integrators.
        paths.extend(Family::Integrator.kinds().flat_map(|i| files(folder, i)));
    }
    let mut taken = ready.inputs;
    output::claim(paths.iter().map(PathBuf::as_path), &taken)?;
    args.html.iter().for_each(|path| drop(taken.add(path)));
    let quality = Quality {
        spp: Some(args.spp),
        seed: Some(args.seed),
        threads: usize::from(args.scene_options.threads),
        ..Quality::default()
    };
    let told = |name: &str| terminal.say(&format!("rendering with {name}"));
    let report = verify::verify(&mut scene, &quality, &args.integrator, &Control::default(), told)
        .map_err(|e| Failure::bad_input(e.to_string()))?;
    if let Some(folder) = &args.output {
        save(&scene, &report, folder, taken)?;
    }
    let rows: Vec<Row<'_>> = report.verified.iter().map(row).collect();
    if let Some(path) = &args.html {
        image::stream_whole(path, |out| page::write(out, args, &scene, &report, &rows))
            .map_err(|e| Failure::failed(e.to_string()))?;
    }
    if args.json {
        let (scene, reference) = (args.scene.as_path(), report.reference.as_str());
        terminal::json(&Answer {
            schema: 1,
            scene,
            reference,
            reference_lacks: report.incomplete.as_deref(),
            integrators: rows,
            agrees: report.with(Verdict::Differs).is_empty() && report.with(Verdict::Undecided).is_empty(),
        })?;
    } else {
        terminal::data(table(&report.reference, &rows).as_bytes())?;
    }
    let (unsure, wrong) = (report.with(Verdict::Undecided), report.with(Verdict::Differs));
    if let Some(what) = &report.incomplete {
        terminal.warn(&format!("nothing is decided: no method with a known error finds {what}"));
    } else if !unsure.is_empty() {
        terminal.warn(&format!(
            "not decided for {} with {} times the samples and more: noise may hide differences of {} % and more of the mean; a higher --spp tells",
            unsure.join(", "),
            verify::BUDGET,
            100.0 * verify::POWER
        ));
    }
    match (wrong.is_empty(), unsure.is_empty()) {
        (false, _) => {
            let message =
                format!("{} and {} do not agree on {}", report.reference, wrong.join(", "), args.scene.display());
            Err(Failure { code: failure::DIFFERENT, message })
        }
        (true, false) => Ok(failure::UNDECIDED),
        (true, true) => Ok(failure::DONE),
    }
}

/// A verdict in JSON.
fn named(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Agrees => "agrees",
        Verdict::Converges => "converges",
        Verdict::Undecided => "undecided",
        Verdict::Differs => "differs",
    }
}

fn row(v: &verify::Verified) -> Row<'_> {
    let (cannot, c) = match &v.outcome {
        verify::Outcome::Compared(c) => (None, Some(c)),
        verify::Outcome::Cannot(what) => (Some(what.as_str()), None),
    };
    let of = |f: fn(&Difference) -> f64| c.map(|c| f(&c.difference));
    Row {
        integrator: &v.integrator,
        cannot,
        verdict: c.map(|c| named(c.difference.verdict)),
        mean_ratio: of(|d| d.ratio),
        detectable_difference: of(|d| d.detects),
        difference: of(|d| d.difference),
        noise: of(|d| d.noise),
        change: c.and_then(|c| c.difference.change),
        largest_z: of(|d| d.largest),
        allowed_z: of(|d| d.allowed),
        spp: c.map(|c| c.spp),
        cpu_seconds: c.map(|c| c.seconds),
    }
}

/// Columns of the table between integrator and answer, with their widths.
const COLUMNS: [(&str, usize); 9] = [
    ("mean", 9),
    ("detects", 9),
    ("difference", 12),
    ("noise", 9),
    ("change", 10),
    ("largest z", 9),
    ("allowed z", 9),
    ("spp", 6),
    ("CPU s", 8),
];

impl Row<'_> {
    /// The numbers of [`COLUMNS`]. Differences are root mean squares over blocks, as parts of the picture's mean.
    fn cells(&self) -> [String; COLUMNS.len()] {
        let percent = |v: Option<f64>| v.map_or("-".into(), |v| format!("{:.3} %", 100.0 * v));
        let fixed = |v: Option<f64>, digits: usize| format!("{:.digits$}", v.unwrap_or(f64::NAN));
        [
            fixed(self.mean_ratio, 4),
            percent(self.detectable_difference),
            percent(self.difference),
            percent(self.noise),
            percent(self.change),
            fixed(self.largest_z, 2),
            fixed(self.allowed_z, 2),
            self.spp.unwrap_or(0).to_string(),
            fixed(self.cpu_seconds, 2),
        ]
    }

    /// In words, whether it agrees with the reference.
    fn answer(&self) -> &'static str {
        match self.verdict {
            Some("agrees") => "yes",
            Some("converges") => "yes, in the limit",
            Some("undecided") => "not decided",
            _ => "NO",
        }
    }
}

fn table(reference: &str, rows: &[Row<'_>]) -> String {
    let aligned = |cells: [&str; COLUMNS.len()]| -> String {
        cells.iter().zip(COLUMNS).map(|(cell, (_, width))| format!("{cell:>width$} ")).collect()
    };
    let mut out = format!("{:<14} {} agrees with {reference}\n", "integrator", aligned(COLUMNS.map(|c| c.0)));
    for r in rows {
        let line = match r.cannot {
            None => format!("{} {}", aligned(r.cells().each_ref().map(String::as_str)), r.answer()),
            Some(what) => format!("cannot do {what}"),
        };
        let _ = writeln!(out, "{:<14} {line}", r.integrator);
    }
    out
}

/// The picture of an integrator, and what it is more or less than the reference.
fn files(folder: &Path, integrator: &str) -> [PathBuf; 2] {
    [folder.join(format!("{integrator}.exr")), folder.join(format!("{integrator}-difference.exr"))]
}

/// Files for an integrator that none of `taken` is; with a number where it comes with other options again.
fn free_files(folder: &Path, integrator: &str, taken: &mut Inputs) -> [PathBuf; 2] {
    let name = integrator.split(':').next().unwrap_or(integrator);
    let mut free = files(folder, name);
    for n in 2.. {
        if free.iter().all(|path| taken.find(path).is_none()) {
            break;
        }
        free = files(folder, &format!("{name}-{n}"));
    }
    free.iter().for_each(|path| drop(taken.add(path)));
    free
}

/// Saves the pictures, and what they are more or less than the reference.
fn save(scene: &Scene, report: &verify::Report, folder: &Path, mut taken: Inputs) -> Result<(), Failure> {
    let write = |path: PathBuf, film: &Film| {
        output::save(&[path], &steradian::develop(scene, film, &[Layer::VARIANCE]), &WriteOptions::default(), true)
    };
    let [path, _] = free_files(folder, &report.reference, &mut taken);
    write(path, &report.film)?;
    for v in &report.verified {
        let verify::Outcome::Compared(c) = &v.outcome else { continue };
        let [path, path_of_difference] = free_files(folder, &v.integrator, &mut taken);
        write(path, &c.film)?;
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
        write(path_of_difference, &difference)?;
    }
    Ok(())
}
