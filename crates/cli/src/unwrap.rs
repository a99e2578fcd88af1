//! `steradian unwrap`: meshes over a texture atlas.

use crate::{
    args::FileOptions,
    diagnostics,
    failure::{self, Failure, Outcome},
    open, output,
    terminal::{self, Terminal},
};
use clap::{Args, ValueEnum};
use serde::Serialize;
use std::path::{Path, PathBuf};
use steradian::{
    Inputs,
    formats::write::{self, MESH_EXTENSIONS, Written},
    scene::{Format, SceneDesc},
    unwrap::{self, Metrics, Options, Settings, Unwrapped},
};

/// Origin of the seams.
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
pub enum Seams {
    /// Edges at which the surface turns by more than --seam-angle.
    #[default]
    Angle,
    /// Edges at which the mesh's own texture coordinates jump.
    Keep,
}

/// `steradian unwrap`.
#[derive(Args, Debug)]
#[command(after_help = "Prints the number of charts, stretch (1 is none) and how much of the atlas is used.")]
pub struct UnwrapArgs {
    /// Mesh (.obj .ply .gltf .glb, or a scene)
    pub mesh: PathBuf,
    /// Output file (.ply .obj .gltf .glb), with texture coordinates in the unit square
    #[arg(short, long, value_name = "OUT")]
    pub output: PathBuf,
    /// Origin of the seams; charts end elsewhere too, where they would stretch or overlap
    #[arg(long, value_enum, default_value_t)]
    pub seams: Seams,
    /// Angle between neighbouring triangles from which their edge is a seam, degrees
    #[arg(long, value_name = "DEG", default_value_t = 60.0)]
    pub seam_angle: f64,
    /// Half the angle of a cone that holds the normals of a chart, degrees: less means more charts with less stretch
    #[arg(long, value_name = "DEG", default_value_t = 90.0)]
    pub cone: f64,
    /// Texels along a side of the atlas
    #[arg(long, value_name = "N", default_value_t = 1024)]
    pub resolution: u32,
    /// Texels between charts
    #[arg(long, value_name = "N", default_value_t = 4)]
    pub padding: u32,
    /// Keep the mesh's texture coordinates, and add those of the atlas as a second set (.gltf .glb)
    #[arg(long)]
    pub second: bool,
    /// Output file of a picture: the charts, and beside them the stretch of the triangles
    #[arg(long, value_name = "OUT")]
    pub picture: Option<PathBuf>,
    /// Print the measures as JSON
    #[arg(long)]
    pub json: bool,
    /// Files.
    #[command(flatten)]
    pub files: FileOptions,
}

/// Most texels along a side of each half of the picture.
const MOST_OF_PICTURE: u32 = 2048;

/// Reads, unwraps, writes, tells measures.
pub fn run(args: &UnwrapArgs, terminal: Terminal) -> Outcome {
    let extension = args.output.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
    let is_gltf = ["gltf", "glb"].contains(&extension.as_str());
    if !is_gltf && !MESH_EXTENSIONS.contains(&extension.as_str()) {
        let name = args.output.display();
        return Err(Failure::bad_input(format!("'{name}': meshes are written as .ply, .obj, .gltf and .glb")));
    }
    if args.second && !is_gltf {
        return Err(Failure::bad_input("--second needs a .gltf or .glb: other files hold one set of coordinates"));
    }
    args.picture.iter().try_for_each(|path| output::kind(path).map(|_| ()))?;
    let options = args.files.write_options().map_err(Failure::bad_input)?;
    let outputs = || [args.output.as_path()].into_iter().chain(args.picture.as_deref());
    output::claim(outputs(), &Inputs::of([args.mesh.as_path()]))?;
    let desc = opened(&args.mesh, terminal)?;
    output::claim(outputs(), &Inputs::of(desc.files()))?;
    let settings = Settings {
        options: Options {
            seam_angle: args.seam_angle.to_radians(),
            cone: args.cone.to_radians(),
            resolution: args.resolution,
            padding: args.padding,
        },
        seams: match args.seams {
            Seams::Angle => unwrap::Seams::Angle,
            Seams::Keep => unwrap::Seams::Keep,
        },
        is_second: args.second,
        from_top: is_gltf,
    };
    let refused = |e: steradian::Error| Failure::bad_input(format!("'{}': {e}", open::shown(&args.mesh)));
    let unwrapped = unwrap::unwrap(&desc, &settings).map_err(refused)?;
    if unwrapped.left_out > 0 {
        let what = "shapes are no meshes and have no place in the atlas";
        terminal.warn(&format!("{} {what}", unwrapped.left_out));
    }
    let document = document(&unwrapped, args, &extension).map_err(refused)?;
    diagnostics::tell(&document.diagnostics, terminal);
    output::save_scene(&args.output, &document, outputs(), Inputs::of(desc.files()))?;
    let mut written = vec![args.output.clone()];
    if let Some(path) = &args.picture {
        let size = args.resolution.min(MOST_OF_PICTURE) as usize;
        let picture = unwrapped.picture(size).map_err(|e| Failure::failed(e.to_string()))?;
        written.extend(output::save(std::slice::from_ref(path), &picture, &options, true)?);
    }
    let metrics = &unwrapped.atlas.metrics;
    match args.json {
        true => terminal::json(&Answer::of(metrics, unwrapped.atlas.triangles.len()))?,
        false => terminal::data(text(metrics).as_bytes())?,
    }
    terminal.say(&format!("wrote {}", output::listed(&written)));
    Ok(failure::DONE)
}

/// A scene with its meshes; models without the light, the camera and the ground that they are looked at with.
fn opened(path: &Path, terminal: Terminal) -> Result<SceneDesc, Failure> {
    let loaded = open::load(path, None, &open::reading(&open::bare(path), None));
    diagnostics::tell(&loaded.diagnostics, terminal);
    if loaded.diagnostics.has_errors() {
        return Err(Failure::bad_input(format!("'{}' has errors; nothing is written", open::shown(path))));
    }
    let mut desc = loaded.desc;
    if desc.format == Format::Model {
        desc.lights.clear();
        desc.cameras.clear();
        (desc.film, desc.integrator, desc.sampler) = (None, None, None);
    }
    Ok(desc)
}

/// The file of an extension: scenes as they are, or all meshes as one.
fn document(unwrapped: &Unwrapped, args: &UnwrapArgs, extension: &str) -> Result<Written, steradian::Error> {
    if !MESH_EXTENSIONS.contains(&extension) {
        return write::write(&unwrapped.desc, &args.output).map_err(steradian::Error::CannotUnwrap);
    }
    let mesh = unwrapped.merged()?;
    Ok(Written { bytes: write::write_mesh(&mesh, extension).unwrap_or_default(), ..Written::default() })
}

/// Measures as JSON.
#[derive(Serialize)]
struct Answer {
    schema: u32,
    triangles: usize,
    degenerate: usize,
    charts: usize,
    stretch_l2: f64,
    stretch_max: f64,
    conformal: f64,
    area: f64,
    seam_length: f64,
    utilisation: f64,
    texels_per_unit: f64,
}

impl Answer {
    fn of(m: &Metrics, triangles: usize) -> Self {
        Self {
            schema: 1,
            triangles,
            degenerate: m.degenerate,
            charts: m.charts,
            stretch_l2: m.stretch_l2,
            stretch_max: m.stretch_max,
            conformal: m.conformal,
            area: m.area,
            seam_length: m.seam_length,
            utilisation: m.utilisation,
            texels_per_unit: m.texels_per_unit,
        }
    }
}

/// Measures in words.
fn text(m: &Metrics) -> String {
    let mut text = format!(
        "charts         {}\nL2 stretch     {:.4}\nlargest        {:.4}\nconformal      {:.4}  (mean ratio of the singular values)\n\
         seams          {:.6}  (length)\nutilisation    {:.1} %\ntexels/unit    {:.6}\n",
        m.charts,
        m.stretch_l2,
        m.stretch_max,
        m.conformal,
        m.seam_length,
        100.0 * m.utilisation,
        m.texels_per_unit
    );
    if m.degenerate > 0 {
        text += &format!("degenerate     {}  (triangles without area)\n", m.degenerate);
    }
    text
}
