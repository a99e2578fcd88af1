//! `steradian bake`: lightmaps, and the normals of a fine mesh as a picture over a coarse one.

use crate::{
    args::FileOptions,
    diagnostics,
    failure::{self, Failure, Outcome},
    lightmap::{self, LightArgs},
    open, output,
    terminal::Terminal,
    values::Size,
};
use clap::{Args, Subcommand, ValueEnum};
use std::path::{Path, PathBuf};
use steradian::{
    CompileOptions, LoadedScene,
    bake::{self, Settings},
    core::material::NormalSpace,
    formats::Options,
    image::{FileKind, Image, encoding::srgb_decode},
    quality::MAX_THREADS,
    scene::Value,
};

/// `steradian bake`.
#[derive(Args, Debug)]
pub struct BakeArgs {
    /// Kind of picture.
    #[command(subcommand)]
    pub what: Baking,
}

/// Pictures that can be baked.
#[derive(Debug, Subcommand)]
pub enum Baking {
    /// Bake the normals of a fine mesh into a normal map for a coarse one
    Normals(NormalsArgs),
    /// Bake the light that falls on the meshes of a scene into a lightmap over their texture atlas
    Light(Box<LightArgs>),
}

/// Space of normals.
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
pub enum Space {
    /// The tangent frame of the coarse mesh.
    #[default]
    Tangent,
    /// The space of its vertices: materials read it with normal_map_space = object.
    Object,
}

/// `steradian bake normals`.
#[derive(Args, Debug)]
#[command(after_help = "Materials read the map as a texture 'image' with raw = true (normal_map), whose edges are \
                        extended for filters.")]
pub struct NormalsArgs {
    /// Mesh that has the detail (.obj .ply .gltf .glb, or a scene)
    pub fine: PathBuf,
    /// Mesh that the map is for, with texture coordinates that do not overlap
    pub coarse: PathBuf,
    /// Output file of the normals, each component from -1 to 1 as 0 to 1
    #[arg(short, long, value_name = "MAP")]
    pub output: PathBuf,
    /// Output file of the distances along the normal: scene units in .exr, .pfm and .hdr; else from -D to D as 0 to 1
    #[arg(long, value_name = "OUT")]
    pub height: Option<PathBuf>,
    /// Size of the pictures
    #[arg(long, value_name = "WxH", default_value = "1024x1024")]
    pub size: Size,
    /// Samples along each side of a texel
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u8).range(1..=16))]
    pub samples: u8,
    /// Space of the normals
    #[arg(long, value_enum, default_value_t)]
    pub space: Space,
    /// Length of the rays to either side, scene units; default: a twentieth of the coarse mesh's diagonal
    #[arg(long, value_name = "D")]
    pub distance: Option<f32>,
    /// Texels by which the map goes on beyond the edges of charts
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = clap::value_parser!(u8).range(0..=64))]
    pub dilate: u8,
    /// Number of threads; 0 is one per processor. Does not change the picture
    #[arg(long, value_name = "N", default_value_t = 0)]
    #[arg(value_parser = clap::value_parser!(u16).range(0..=MAX_THREADS as i64))]
    pub threads: u16,
    /// Files.
    #[command(flatten)]
    pub files: FileOptions,
}

/// Bakes a picture of either kind.
pub fn run(args: &BakeArgs, terminal: Terminal) -> Outcome {
    match &args.what {
        Baking::Normals(args) => normals(args, terminal),
        Baking::Light(args) => lightmap::run(args, terminal),
    }
}

/// Reads both meshes, bakes, tells what is amiss, writes.
fn normals(args: &NormalsArgs, terminal: Terminal) -> Outcome {
    open::limit_threads(args.threads);
    let outputs: Vec<&Path> = std::iter::once(&args.output).chain(&args.height).map(PathBuf::as_path).collect();
    outputs.iter().try_for_each(|path| output::kind(path).map(|_| ()))?;
    let options = args.files.write_options().map_err(Failure::bad_input)?;
    if args.distance.is_some_and(|d| !(d > 0.0 && d.is_finite())) {
        return Err(Failure::bad_input("--distance is a length above zero"));
    }
    let Size(width, height) = args.size;
    if width.max(height) > MOST {
        return Err(Failure::bad_input(format!("--size has at most {MOST} texels a side")));
    }
    let (fine, coarse) = (opened(&args.fine, terminal)?, opened(&args.coarse, terminal)?);
    for scene in [&fine, &coarse] {
        output::claim(outputs.iter().copied(), &scene.inputs())?;
    }
    let settings = Settings {
        size: [width as usize, height as usize],
        samples: args.samples.into(),
        space: match args.space {
            Space::Tangent => NormalSpace::Tangent,
            Space::Object => NormalSpace::Object,
        },
        distance: args.distance,
        dilate: args.dilate.into(),
    };
    let detail = fine.scene.as_ref().ok_or_else(|| unusable(&args.fine))?;
    let baked = bake::normals(detail, &coarse, &settings);
    let baked = baked.map_err(|e| Failure::bad_input(format!("'{}': {e}", args.coarse.display())))?;
    let share = |n: usize| 100.0 * n as f64 / baked.covered as f64;
    if baked.overlapping > 0 {
        let what =
            "texels have triangles over each other: the texture coordinates overlap, and the first triangle counts";
        terminal.warn(&format!("{} {what}", baked.overlapping));
    }
    if baked.missed > 0 {
        let (missed, percent, d) = (baked.missed, share(baked.missed), baked.distance);
        let what = format!("{missed} texels ({percent:.1} %) met nothing within {d}, and are filled from beside them");
        terminal.warn(&format!("{what}: --distance reaches farther"));
    }
    let mut written = Vec::new();
    let mut save = |path: &Path, values: Vec<[f32; 3]>| {
        // Values are numbers, not light: files of display values are to hold them as they are.
        let is_linear = is_linear(path);
        let stored = |v: f32| if is_linear { v } else { srgb_decode(v.clamp(0.0, 1.0)) };
        let pixels: Vec<[f32; 3]> = values.iter().map(|texel| texel.map(stored)).collect();
        let image = Image::from_rgb(width as usize, height as usize, &pixels);
        let image = image.map_err(|e| Failure::failed(e.to_string()))?;
        written.extend(output::save(&[path.to_path_buf()], &image, &options, true)?);
        Ok::<(), Failure>(())
    };
    save(&args.output, baked.normals)?;
    if let Some(path) = &args.height {
        let d = baked.distance;
        let is_linear = is_linear(path);
        let of = |h: &f32| [if is_linear { *h } else { 0.5 + 0.5 * h / d }; 3];
        save(path, baked.heights.iter().map(of).collect())?;
        if !is_linear {
            terminal.say(&format!("heights from {} to {d} are 0 to 1 in '{}'", -d, path.display()));
        }
    }
    terminal.say(&format!("wrote {}", output::listed(&written)));
    Ok(failure::DONE)
}

/// Most texels along a side.
const MOST: u32 = 16384;

/// True for files that keep linear values.
fn is_linear(path: &Path) -> bool {
    matches!(FileKind::from_extension(path), Some(FileKind::Exr | FileKind::Hdr | FileKind::Pfm))
}

fn unusable(path: &Path) -> Failure {
    Failure::bad_input(format!("'{}' has errors, or no geometry", path.display()))
}

/// A compiled mesh without the ground that models get; meshes of glTF have the tangents that its materials would use.
fn opened(path: &Path, terminal: Terminal) -> Result<LoadedScene, Failure> {
    let defines = open::bare(path).into_iter().collect();
    let mut loaded = steradian::load(path, &Options { defines, ..Options::default() });
    if loaded.desc.format == steradian::scene::Format::Gltf {
        for shape in loaded.desc.shapes.clone() {
            let node = loaded.desc.node_mut(shape.node);
            if node.kind == "mesh" && node.get("tangents").is_none() {
                node.set("tangents", Value::from("mikktspace_down"), None);
            }
        }
    }
    let loaded = loaded.compile(&CompileOptions::default());
    diagnostics::tell(&loaded.diagnostics, terminal);
    if loaded.scene.as_ref().is_none_or(|scene| scene.geometries().is_empty()) {
        return Err(unusable(path));
    }
    Ok(loaded)
}
