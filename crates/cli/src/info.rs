//! `steradian info`: what is in a scene.

use crate::{
    args::InfoArgs,
    diagnostics::{self, Counts},
    failure::{self, Failure, Outcome},
    memory, open, output, picture,
    terminal::{self, Terminal},
};
use serde::Serialize;
use std::{
    collections::{BTreeMap, HashSet},
    fmt::Write,
    path::{Path, PathBuf},
    sync::Arc,
};
use steradian::{
    ColorMode, CompileOptions, Inputs, LoadedScene, Quality, Scene, image, method_of,
    scene::{Animation, Diagnostic, Family, Format, NodeId, SceneDesc, Value},
};

/// Pixels of the longer side of a thumbnail.
const THUMBNAIL: u32 = 256;

/// Information about a scene.
#[derive(Debug, Serialize)]
struct Info {
    schema: u32,
    scene: String,
    format: Format,
    files: Vec<PathBuf>,
    counts: Counted,
    cameras: Vec<Named>,
    animations: Vec<Animation>,
    film: Option<Film>,
    settings: Option<Settings>,
    bounds: Option<[[f32; 3]; 2]>,
    memory: Memory,
    load_seconds: f64,
    build_seconds: f64,
    diagnostics: Counts,
    messages: Vec<Diagnostic>,
}

/// Counts of a scene's parts.
#[derive(Debug, Serialize)]
struct Counted {
    /// Models by family and kind; names in Steradian's vocabulary.
    models: BTreeMap<&'static str, BTreeMap<String, usize>>,
    shapes: usize,
    groups: usize,
    instances: usize,
    /// Triangles of meshes as they are stored, before subdivision.
    triangles: u64,
    patches: u64,
    /// Triangles and patches, instances counted each time they are placed.
    faces_placed: u64,
    lights: usize,
    emitting_shapes: usize,
    /// Files that textures and lights are made of, each once, and their bytes as they are stored.
    pictures: usize,
    picture_bytes: u64,
}

#[derive(Debug, Serialize)]
struct Named {
    kind: String,
    name: Option<String>,
}

#[derive(Debug, Serialize)]
struct Film {
    width: u32,
    height: u32,
    crop: [u32; 4],
}

#[derive(Debug, Serialize)]
struct Settings {
    integrator: String,
    /// The one that renders use, and the one that the file names.
    sampler: &'static str,
    named_sampler: Option<String>,
    filter: Option<String>,
    color: &'static str,
    spp: u32,
    seed: u64,
    /// Null for no limit.
    max_depth: Option<u32>,
}

/// A table of the compiled scene.
#[derive(Debug, Serialize)]
struct Table {
    name: &'static str,
    count: usize,
    bytes: usize,
}

/// Bytes.
#[derive(Debug, Serialize)]
struct Memory {
    /// Hierarchy and geometry.
    geometry_bytes: Option<usize>,
    /// Contents of the compiled scene, table by table.
    tables: Vec<Table>,
    /// Film of a render without layers.
    film_bytes: Option<u64>,
    /// The whole process while it opened the scene, images too; null where the system does not tell.
    peak_rss_bytes: Option<u64>,
}

/// Opens a scene and tells about it, whether it can be rendered or not.
pub fn run(args: &InfoArgs, terminal: Terminal) -> Outcome {
    if let Some(path) = &args.thumbnail {
        output::kind(path)?;
        output::claim([path.as_path()], &Inputs::of([args.scene.as_path()]))?;
    }
    open::limit_threads(args.scene_options.threads);
    let name = open::shown(&args.scene);
    if let Some(kind) = picture::kind(&args.scene) {
        return picture::tell(&args.scene, kind, args.json);
    }
    if image::FileKind::from_extension(&args.scene).is_some() && !args.scene.exists() {
        return Err(Failure::bad_input(format!("there is no picture '{name}'")));
    }
    let mut opened = open::open(&args.scene, &args.scene_options, None);
    if args.scene_options.strict {
        opened.diagnostics = diagnostics::refuse_losses(&opened.diagnostics);
    }
    // Limits of the scene's own integrator.
    let render = opened.scene.as_ref().and_then(|scene| Some((Quality::default().render(scene).ok()?, scene)));
    if let Some((render, scene)) = render
        && let Some(left_out) = render.left_out(scene)
    {
        opened.diagnostics.warn(&opened.desc.sources, None, left_out.of(render.name));
    }
    if let Some(path) = &args.thumbnail {
        output::claim([path.as_path()], &opened.inputs())?;
    }
    let info = Info::of(&name, &opened);
    if args.json {
        terminal::json(&info)?;
    } else {
        // Of a file that could not be opened there is nothing to tell but why.
        if !opened.desc.nodes.is_empty() {
            terminal::data(info.text().as_bytes())?;
        }
        diagnostics::tell(&opened.diagnostics, terminal);
    }
    match info.diagnostics.errors {
        0 => args.thumbnail.as_deref().map_or(Ok(failure::DONE), |path| thumbnail(path, args, &opened, terminal)),
        n => Err(Failure::bad_input(format!("'{name}' has {n} error{}", if n == 1 { "" } else { "s" }))),
    }
}

/// A small picture of the scene.
fn thumbnail(path: &Path, args: &InfoArgs, opened: &LoadedScene, terminal: Terminal) -> Outcome {
    let Some(film) = opened.scene.as_ref().map(Scene::film) else { return Ok(failure::DONE) };
    let scale = f64::from(THUMBNAIL) / f64::from(film.width.max(film.height)).max(1.0);
    let side = |pixels: u32| ((f64::from(pixels) * scale).round() as u32).max(1);
    let size = Some((side(film.width), side(film.height)));
    let options = CompileOptions { size, crop: None, ..open::compile_options(&args.scene_options, None) };
    let scene = steradian::compile(&opened.desc, &options).scene;
    let scene = scene.ok_or_else(|| Failure::failed("the scene cannot be compiled for a small picture"))?;
    let quality = Quality { spp: Some(32), threads: usize::from(args.scene_options.threads), ..Quality::default() };
    let picture = steradian::render(&Arc::new(scene), &quality).map_err(|e| Failure::failed(e.to_string()))?;
    image::write(path, &picture, &image::WriteOptions::default()).map_err(|e| Failure::failed(e.to_string()))?;
    terminal.say(&format!("wrote {}", path.display()));
    Ok(failure::DONE)
}

impl Info {
    fn of(name: &str, opened: &LoadedScene) -> Self {
        let (desc, scene) = (&opened.desc, opened.scene.as_ref());
        let kind = |id: Option<NodeId>| id.map(|id| desc.node(id).kind.clone());
        let bounds = scene.map(Scene::bounds).map(|b| [b.min.to_array(), b.max.to_array()]);
        let film = scene.map(|s| {
            let c = s.film().crop;
            Film { width: s.film().width, height: s.film().height, crop: [c.x0, c.y0, c.x1, c.y1] }
        });
        let film_bytes = film.as_ref().map(|f| {
            let [x0, y0, x1, y1] = f.crop.map(u64::from);
            (x1 - x0) * (y1 - y0) * steradian::film_bytes_per_pixel(0)
        });
        let tables = scene.map(Scene::tables).unwrap_or_default().into_iter();
        let tables: Vec<_> = tables.map(|t| Table { name: t.name, count: t.count, bytes: t.bytes }).collect();
        let geometry_bytes = scene.map(Scene::geometry_bytes);
        Self {
            schema: 1,
            scene: name.into(),
            format: desc.format,
            files: desc.sources.paths().map(Path::to_path_buf).collect(),
            counts: Counted::of(desc),
            cameras: desc
                .cameras
                .iter()
                .map(|c| desc.node(*c))
                .map(|c| Named { kind: c.kind.clone(), name: c.name.clone() })
                .collect(),
            animations: desc.animations.clone(),
            film,
            settings: scene.map(|s| Settings {
                integrator: method_of(s).name().to_owned(),
                sampler: s.settings().sampler.name(),
                named_sampler: kind(desc.sampler),
                filter: kind(desc.filter),
                color: if s.mode() == ColorMode::Spectral { "spectral" } else { "rgb" },
                spp: s.settings().spp,
                seed: s.settings().seed,
                max_depth: Some(s.settings().max_depth).filter(|d| *d != u32::MAX),
            }),
            // A scene of infinite planes alone has no bounds.
            bounds: bounds.filter(|b| b.iter().flatten().all(|v| v.is_finite()) && b[0][0] <= b[1][0]),
            memory: Memory { geometry_bytes, tables, film_bytes, peak_rss_bytes: memory::peak() },
            load_seconds: opened.load.as_secs_f64(),
            build_seconds: opened.build.as_secs_f64(),
            diagnostics: Counts::of(&opened.diagnostics),
            messages: opened.diagnostics.iter().cloned().collect(),
        }
    }

    fn text(&self) -> String {
        let mut out = String::new();
        let mut row = |name: &str, value: String| {
            let _ = writeln!(out, "{name:<14} {value}");
        };
        let format = match self.format {
            Format::Native => "Steradian",
            Format::Pbrt => "pbrt-v4",
            Format::Mitsuba => "Mitsuba",
            Format::Model => "model",
            Format::Gltf => "glTF",
        };
        row("scene", format!("{} ({format}, {} file{})", self.scene, self.files.len(), plural(self.files.len())));
        for (i, camera) in self.cameras.iter().enumerate() {
            let name = camera.name.as_ref().map(|n| format!(" '{n}'")).unwrap_or_default();
            row(if i == 0 { "cameras" } else { "" }, format!("{i}: {}{name}", camera.kind));
        }
        for (i, a) in self.animations.iter().enumerate() {
            let name = a.name.as_ref().map(|n| format!(" '{n}'")).unwrap_or_default();
            let times = format!("{} to {} s, {} channel{}", a.times[0], a.times[1], a.channels, plural(a.channels));
            row(if i == 0 { "animations" } else { "" }, format!("{i}:{name} {times}"));
        }
        if let Some(film) = &self.film {
            let [x0, y0, x1, y1] = film.crop;
            let whole = film.crop == [0, 0, film.width, film.height];
            let part = if whole { String::new() } else { format!(", pixels {x0},{y0} to {x1},{y1}") };
            row("film", format!("{} x {}{part}", film.width, film.height));
        }
        if let Some(s) = &self.settings {
            let depth = s.max_depth.map_or("no limit of depth".into(), |d| format!("depth {d}"));
            row("integrator", format!("{}, {depth}, {} colour", s.integrator, s.color));
            let or_default = |name: &Option<String>| name.clone().unwrap_or_else(|| "default".into());
            let other = s.named_sampler.as_ref().filter(|named| *named != s.sampler);
            let other = other.map(|named| format!("; --sampler scene uses the file's '{named}'")).unwrap_or_default();
            row("sampler", format!("{}, {} spp, seed {}{other}", s.sampler, s.spp, s.seed));
            row("filter", or_default(&s.filter));
        }
        let c = &self.counts;
        row("shapes", format!("{} in the file, {} emit light", c.shapes, c.emitting_shapes));
        row("faces", format!("{} triangles, {} patches; {} when placed", c.triangles, c.patches, c.faces_placed));
        if c.groups > 0 || c.instances > 0 {
            row("instances", format!("{} of {} groups", c.instances, c.groups));
        }
        row("lights", format!("{} besides emitting shapes", c.lights));
        if c.pictures > 0 {
            row(
                "pictures",
                format!("{} file{}, {}", c.pictures, plural(c.pictures), memory::readable(c.picture_bytes)),
            );
        }
        for (family, kinds) in &c.models {
            let kinds: Vec<String> = kinds.iter().map(|(kind, n)| format!("{n} {kind}")).collect();
            row(&format!("  {family}"), kinds.join(", "));
        }
        if let Some([low, high]) = self.bounds {
            let point = |p: [f32; 3]| p.map(|v| format!("{v}")).join(" ");
            row("bounds", format!("({}) to ({})", point(low), point(high)));
        }
        let bytes = |b: Option<u64>| b.map_or("unknown".into(), memory::readable);
        row(
            "memory",
            format!(
                "{} hierarchy and geometry, {} film, {} at most while opening",
                bytes(self.memory.geometry_bytes.map(|b| b as u64)),
                bytes(self.memory.film_bytes),
                bytes(self.memory.peak_rss_bytes),
            ),
        );
        let held: Vec<_> = self.memory.tables.iter().filter(|t| t.count > 0).collect();
        for (i, t) in held.iter().enumerate() {
            let what = if t.count == 1 { t.name.into() } else { format!("{} {}", t.count, t.name) };
            row(if i == 0 { "  tables" } else { "" }, format!("{what}: {}", memory::readable(t.bytes as u64)));
        }
        row("time", format!("load {:.2} s, build {:.2} s", self.load_seconds, self.build_seconds));
        let d = &self.diagnostics;
        row(
            "messages",
            format!(
                "{} errors, {} approximated, {} dropped, {} unused, {} warnings, {} notes",
                d.errors, d.approximated, d.dropped, d.unused, d.warnings, d.notes
            ),
        );
        out
    }
}

impl Counted {
    fn of(desc: &SceneDesc) -> Self {
        let mut models: BTreeMap<&str, BTreeMap<String, usize>> = BTreeMap::new();
        for node in &desc.nodes {
            *models.entry(node.family.noun()).or_default().entry(node.kind.clone()).or_default() += 1;
        }
        let shapes = || desc.shapes.iter().chain(desc.groups.iter().flat_map(|g| &g.shapes));
        // A mesh that many shapes share is stored once.
        let used: HashSet<usize> = shapes().filter_map(|s| s.mesh).collect();
        let with_files = desc.nodes.iter().filter(|n| matches!(n.family, Family::Texture | Family::Light));
        let files: HashSet<&Path> = with_files
            .flat_map(|n| &n.params)
            .filter_map(|p| match &p.value {
                Value::Path(path) => Some(path.as_path()),
                _ => None,
            })
            .collect();
        let bytes = |path: &&Path| match desc.embedded.get(*path) {
            Some(bytes) => bytes.len() as u64,
            None => std::fs::metadata(path).map_or(0, |m| m.len()),
        };
        let meshes = || used.iter().filter_map(|m| desc.meshes.get(*m));
        Self {
            models,
            shapes: shapes().count(),
            groups: desc.groups.len(),
            instances: desc.instances.len(),
            triangles: meshes().map(|m| m.triangles.len() as u64).sum(),
            patches: meshes().map(|m| m.patches.len() as u64).sum(),
            faces_placed: desc.face_count(),
            lights: desc.lights.len(),
            emitting_shapes: shapes().filter(|s| s.emission.is_some()).count(),
            pictures: files.len(),
            picture_bytes: files.iter().map(bytes).sum(),
        }
    }
}

fn plural(n: usize) -> &'static str {
    if n == 1 { "" } else { "s" }
}
