//! `steradian convert` for scenes: any format that is read into those that are written.

use crate::{
    args::ConvertArgs,
    diagnostics,
    failure::{self, Failure, Outcome},
    open, output,
    terminal::Terminal,
};
use std::{
    collections::{BTreeMap, HashSet},
    fmt::Write,
    path::Path,
    sync::Arc,
};
use steradian::{
    ColorMode, CompileOptions, Inputs, Loaded, Quality, SensorNoise,
    formats::{Options, write},
    image::{self, Image, metrics},
    scene::{Diagnostic, Diagnostics, Fidelity, Location, Node, SceneDesc, Severity},
};

/// Pixels of the pictures that are compared, and their samples per pixel.
const CHECKED: (f64, u32) = (6144.0, 16);

/// True if a name stands for a scene: by its extension, as a built-in one, or as standard input.
pub fn is_scene(path: &Path) -> bool {
    let name = path.to_string_lossy().to_ascii_lowercase();
    if open::is_stdin(path) || name.starts_with("builtin:") {
        return true;
    }
    let name = name.strip_suffix(".gz").unwrap_or(&name);
    let extension = Path::new(name).extension().and_then(|e| e.to_str());
    extension.is_some_and(|e| steradian::load::extensions().any(|known| known.0 == e))
}

/// Reads, writes, reports, compares.
pub fn run(args: &ConvertArgs, terminal: Terminal) -> Outcome {
    if args.sensor.is_some() {
        return Err(Failure::bad_input("--sensor is for pictures; the film of a scene has 'full_well'"));
    }
    if args.false_color.is_some() {
        return Err(Failure::bad_input("--false-color is for pictures"));
    }
    if !write::EXTENSIONS.iter().any(|known| args.output.extension().is_some_and(|e| e.eq_ignore_ascii_case(known.0))) {
        let known = write::EXTENSIONS.iter().map(|(e, what)| format!(".{e} ({what})")).collect::<Vec<_>>().join(", ");
        let what = format!("'{}': scenes are written as {known}", args.output.display());
        return Err(Failure::bad_input(format!("{what}; other formats are read only")));
    }
    let outputs = || [args.output.as_path()].into_iter().chain(args.report.as_deref());
    output::claim(outputs(), &Inputs::of([args.input.as_path()]))?;
    let Loaded { desc, diagnostics, .. } =
        open::load(&args.input, args.format.as_deref(), &open::reading(&args.define, None));
    let (desc, diagnostics) = (&desc, told(&diagnostics, args, terminal)?);
    let written = write::write(desc, &args.output).map_err(Failure::failed)?;
    let losses = told(&written.diagnostics, args, terminal)?;
    output::save_scene(&args.output, &written, outputs(), Inputs::of(desc.files()))?;
    let beside = match written.files.len() {
        0 => String::new(),
        n => format!(" and {n} file{} beside it", if n == 1 { "" } else { "s" }),
    };
    terminal.say(&format!("wrote {}{beside}", args.output.display()));
    let check = if args.check { Some(check(desc, &args.output)?) } else { None };
    if let Some(check) = &check {
        terminal.say(check);
    }
    if let Some(path) = &args.report {
        let messages: Vec<&Diagnostic> = diagnostics.iter().chain(losses.iter()).collect();
        let text = report(args, desc, &messages, check.as_deref());
        image::write_whole(path, text.as_bytes()).map_err(|e| Failure::failed(e.to_string()))?;
        terminal.say(&format!("wrote {}", path.display()));
    }
    Ok(failure::DONE)
}

/// Tells messages; with `--strict` losses are errors, and errors end it before anything is written.
fn told(diagnostics: &Diagnostics, args: &ConvertArgs, terminal: Terminal) -> Result<Diagnostics, Failure> {
    let diagnostics = if args.strict { diagnostics::refuse_losses(diagnostics) } else { diagnostics.clone() };
    diagnostics::tell(&diagnostics, terminal);
    if diagnostics.has_errors() {
        return Err(Failure::bad_input(format!("'{}' has errors; nothing is written", open::shown(&args.input))));
    }
    Ok(diagnostics)
}

/// Renders both small, and says how far they are apart. Both in the colour mode of what was read.
fn check(desc: &SceneDesc, output: &Path) -> Result<String, Failure> {
    let again = steradian::load(output, &Options::default());
    if let Some(fault) = again.diagnostics.iter().find(|d| d.severity == Severity::Error) {
        return Err(Failure::failed(format!("what was written cannot be read: {fault}")));
    }
    let size = small(desc);
    let (before, mode) = picture(desc, size, None)?;
    let (after, _) = picture(&again.desc, size, Some(mode))?;
    let c = metrics::compare(&after, &before).map_err(|e| Failure::failed(e.to_string()))?;
    let ((width, height), spp) = (size, CHECKED.1);
    let ratio = c.ratio.map(|r| format!("{r:.6}")).join(" ");
    Ok(format!(
        "check at {width} x {height}, {spp} spp: ratio of means (R G B) {ratio}, relMSE {:.3e}, largest difference {:.3e}",
        c.rel_mse, c.max_abs
    ))
}

/// A small frame of the shape of the scene's film.
fn small(desc: &SceneDesc) -> (u32, u32) {
    let film = desc.film.map(|f| desc.node(f));
    let side = |name: &str, default: f64| film.and_then(|f| f.float(name)).filter(|v| *v >= 1.0).unwrap_or(default);
    let aspect = (side("width", 96.0) / side("height", 64.0)).clamp(1e-2, 1e2);
    let width = (CHECKED.0 * aspect).sqrt().round().max(1.0);
    (width as u32, (width / aspect).round().max(1.0) as u32)
}

fn picture(desc: &SceneDesc, size: (u32, u32), mode: Option<ColorMode>) -> Result<(Image, ColorMode), Failure> {
    let sensor_noise = SensorNoise::Off;
    let options = CompileOptions { size: Some(size), mode, sensor_noise, ..CompileOptions::default() };
    let scene = steradian::compile(desc, &options).scene;
    let none = || Failure::bad_input("the scene cannot be rendered, so it is not compared");
    let scene = Arc::new(scene.ok_or_else(none)?);
    let quality = Quality { spp: Some(CHECKED.1), ..Quality::default() };
    let picture = steradian::render(&scene, &quality).map_err(|e| Failure::failed(e.to_string()))?;
    Ok((picture, scene.mode()))
}

/// A place in a file, to be compared.
fn place(l: &Location) -> (&str, u32, u32) {
    (l.path.as_str(), l.line, l.column)
}

/// Report on the fate of each construct.
fn report(args: &ConvertArgs, desc: &SceneDesc, messages: &[&Diagnostic], check: Option<&str>) -> String {
    let mut out = format!("# {} → {}\n", open::shown(&args.input), args.output.display());
    let of = |fidelity| messages.iter().filter(move |d| d.fidelity == Some(fidelity));
    for (title, fidelity) in
        [("Approximated", Fidelity::Approximated), ("Dropped", Fidelity::Dropped), ("Without effect", Fidelity::Unused)]
    {
        let _ = writeln!(out, "\n## {title}\n");
        if of(fidelity).next().is_none() {
            out.push_str("Nothing.\n");
        }
        // Each message once, with its first place.
        let mut told: Vec<(&Diagnostic, usize)> = Vec::new();
        for d in of(fidelity) {
            match told.iter_mut().find(|(other, _)| other.message == d.message) {
                Some((_, count)) => *count += 1,
                None => told.push((d, 1)),
            }
        }
        for (d, count) in told {
            let place = d.location.as_ref().map(|l| format!(" ({}:{}:{}", l.path, l.line, l.column));
            let more = match count {
                1 => String::new(),
                2 => " and 1 more place".into(),
                n => format!(" and {} more places", n - 1),
            };
            let _ = writeln!(out, "- {}{}", d.message, place.map_or(String::new(), |place| format!("{place}{more})")));
        }
    }
    let lossy: HashSet<(&str, u32, u32)> =
        messages.iter().filter(|d| d.fidelity.is_some()).filter_map(|d| d.location.as_ref().map(place)).collect();
    let is_exact = |node: &Node| {
        let spans = node.params.iter().map(|p| p.span).chain([node.span]).flatten();
        let mut places = spans.filter_map(|span| desc.sources.locate(span));
        !places.any(|location| lossy.contains(&place(&location)))
    };
    let mut kinds: BTreeMap<(&str, &str), usize> = BTreeMap::new();
    for node in desc.nodes.iter().filter(|node| is_exact(node)) {
        *kinds.entry((node.family.noun(), node.kind.as_str())).or_default() += 1;
    }
    let triangles: usize = desc.meshes.iter().map(|m| m.triangles.len() + m.patches.len()).sum();
    out.push_str(
        "\n## Exact\n\nEverything that is read and not named above is written as it is. The table counts what no message is about.\n\n| what | kind | how many |\n|---|---|---|\n",
    );
    for ((family, kind), n) in kinds {
        let _ = writeln!(out, "| {family} | `{kind}` | {n} |");
    }
    let _ = writeln!(out, "| meshes | {triangles} faces | {} |", desc.meshes.len());
    let _ = writeln!(out, "| instances | of {} groups | {} |", desc.groups.len(), desc.instances.len());
    if let Some(check) = check {
        let _ = writeln!(out, "\n## Compared\n\n{check}");
    }
    out
}
