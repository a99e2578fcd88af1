//! `steradian bake light`: the light that falls on the meshes of a scene as a picture over their texture atlas, or as a
//! scene that shows it.

use crate::{
    args::{FileOptions, SceneOptions},
    diagnostics,
    failure::{self, Failure, Outcome},
    memory, open, output,
    terminal::Terminal,
    values,
};
use clap::{Args, ValueEnum};
use std::path::PathBuf;
use steradian::{
    Inputs,
    formats::write,
    image::{self, FileKind, Image},
    integrators::Depth,
    lightmap::{self, Lightmap, Settings},
    scene::SceneDesc,
    unwrap::Options,
};

/// Part of the light.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Part {
    /// Irradiance.
    All,
    /// Irradiance straight from lights.
    Direct,
    /// Irradiance by way of other surfaces.
    Indirect,
    /// Ambient occlusion: the share of directions, weighted by their cosine, that meet nothing within --distance.
    Ao,
}

/// `steradian bake light`.
#[derive(Args, Debug)]
#[command(after_help = "The atlas is that of 'steradian unwrap SCENE --second' with the same --resolution and \
                        --padding, which writes the scene with it. Irradiance times albedo over π is the radiance of \
                        a diffuse surface: that is what .glb and .gltf files show.")]
pub struct LightArgs {
    /// Scene file, - for standard input, or builtin:NAME
    pub scene: PathBuf,
    /// Output file of linear light (.exr holds several --parts), or of the scene that shows the first (.glb .gltf)
    #[arg(short, long, value_name = "OUT")]
    pub output: PathBuf,
    /// Parts of the light: the first is the picture, others are layers of an .exr by their names
    #[arg(long, value_enum, value_delimiter = ',', default_value = "all")]
    pub parts: Vec<Part>,
    /// Samples of each texel; 1k is 1000
    #[arg(long, value_name = "N", default_value = "256", value_parser = values::spp, allow_hyphen_values = true)]
    pub spp: u32,
    /// Texels along a side
    #[arg(long, value_name = "N", default_value_t = 1024)]
    pub resolution: u32,
    /// Texels between charts, and about charts that have values too
    #[arg(long, value_name = "N", default_value_t = 4)]
    pub padding: u32,
    /// Length of the rays of ao, scene units; default: no end
    #[arg(long, value_name = "D", value_parser = values::radius, allow_hyphen_values = true)]
    pub distance: Option<f32>,
    /// Remove noise, chart by chart
    #[arg(long)]
    pub denoise: bool,
    /// Random seed
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub seed: u64,
    /// Maximum number of scattering events of a path, -1 for no limit; light straight from lights has none
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    #[arg(value_parser = clap::value_parser!(i64).range(-1..=i64::from(u32::MAX)))]
    pub max_depth: Option<i64>,
    /// The scene.
    #[command(flatten)]
    pub scene_options: SceneOptions,
    /// Files.
    #[command(flatten)]
    pub files: FileOptions,
}

/// Most texels along a side.
const MOST: u32 = 16384;

/// Reads, unwraps, bakes, tells what is amiss, writes.
pub fn run(args: &LightArgs, terminal: Terminal) -> Outcome {
    let scene_options = &args.scene_options;
    open::limit_threads(scene_options.threads);
    let kind = if open::is_gltf(&args.output) { None } else { Some(output::kind(&args.output)?) };
    check(args, kind)?;
    let options = args.files.write_options().map_err(Failure::bad_input)?;
    output::claim([args.output.as_path()], &Inputs::of([args.scene.as_path()]))?;
    let mut loaded = open::load_unseen(&args.scene, &bare(args));
    output::claim([args.output.as_path()], &Inputs::of(loaded.desc.files()))?;
    if !loaded.diagnostics.has_errors() {
        let atlas = Options { resolution: args.resolution, padding: args.padding, ..Options::default() };
        let laid_out = lightmap::laid_out(&loaded.desc, atlas).map_err(|e| refused(args, &e))?;
        if laid_out.1 > 0 {
            terminal.warn(&format!("{} shapes are no meshes and have no place in the lightmap", laid_out.1));
        }
        loaded.desc = laid_out.0;
    }
    let desc = kind.is_none().then(|| loaded.desc.clone());
    let opened = open::opened(loaded, scene_options, None);
    let open::Ready { scene, inputs, .. } = open::ready(opened, &args.scene, scene_options.strict, terminal)?;
    output::claim([args.output.as_path()], &inputs)?;
    let asked = scene.settings();
    let settings = Settings {
        resolution: args.resolution,
        padding: args.padding,
        parts: args.parts.iter().map(|p| p.baked()).collect(),
        samples: args.spp,
        seed: args.seed,
        media: scene.has_media(),
        depth: Depth {
            max: args.max_depth.map_or(asked.max_depth, |depth| u32::try_from(depth).unwrap_or(u32::MAX)),
            roulette_after: asked.rr_depth,
            hide_emitters: false,
        },
        distance: args.distance.unwrap_or(f32::INFINITY),
        denoise: args.denoise,
    };
    let baked = lightmap::bake(&scene, &settings).map_err(|e| refused(args, &e))?;
    if baked.nonfinite > 0 {
        terminal.warn(&format!("{} samples were not finite and count as black", baked.nonfinite));
    }
    let written = match desc {
        Some(desc) => save_scene(args, &desc, &baked, terminal)?,
        None => output::save(std::slice::from_ref(&args.output), &picture(args, &baked)?, &options, true)?,
    };
    terminal.say(&format!("light at {} texels; wrote {}", baked.measured, output::listed(&written)));
    Ok(failure::DONE)
}

/// Writes the scene that shows the light without lights; the files that were written.
fn save_scene(
    args: &LightArgs,
    desc: &SceneDesc,
    baked: &Lightmap,
    terminal: Terminal,
) -> Result<Vec<PathBuf>, Failure> {
    let radiance = baked.reflected(0, args.parts[0].baked());
    let lit = lightmap::lit(desc, &radiance, args.resolution as usize).map_err(|e| Failure::failed(e.to_string()))?;
    let written = write::write(&lit, &args.output).map_err(Failure::failed)?;
    diagnostics::tell(&written.diagnostics, terminal);
    output::save_scene(&args.output, &written, [args.output.as_path()], Inputs::of(desc.files()))?;
    Ok(vec![args.output.clone()])
}

/// Refuses parts that a file (a scene, without `kind`) cannot hold, and what would not fit into memory.
fn check(args: &LightArgs, kind: Option<FileKind>) -> Result<(), Failure> {
    if args.parts.len() > 1 && kind != Some(FileKind::Exr) {
        let name = args.output.display();
        return Err(Failure::bad_input(format!("'{name}' holds one part of --parts; several are layers of an .exr")));
    }
    if (1..args.parts.len()).any(|k| args.parts[..k].contains(&args.parts[k])) {
        return Err(Failure::bad_input("--parts names a part twice"));
    }
    if args.resolution > MOST {
        return Err(Failure::bad_input(format!("--resolution is at most {MOST} texels a side")));
    }
    let side = args.resolution;
    let needed = u64::from(side).pow(2) * lightmap::bytes_per_texel(args.parts.len(), args.denoise);
    match memory::available() {
        Some(available) if needed > available => Err(Failure::bad_input(format!(
            "a lightmap of {side} x {side} texels needs about {} of memory, and {} are there; lower --resolution",
            memory::readable(needed),
            memory::readable(available)
        ))),
        _ => Ok(()),
    }
}

/// Options of reading by which models have no ground, unless it is asked for: it would take most of the atlas.
fn bare(args: &LightArgs) -> SceneOptions {
    let mut options = args.scene_options.clone();
    let extension = args.scene.extension().unwrap_or_default().to_ascii_lowercase();
    let is_model = ["obj", "ply", "gltf", "glb"].iter().any(|known| extension == *known);
    if is_model && !options.define.iter().any(|d| d.0 == "ground") {
        options.define.push(("ground".into(), "false".into()));
    }
    options
}

/// The parts as one picture with layers.
fn picture(args: &LightArgs, baked: &Lightmap) -> Result<Image, Failure> {
    let side = args.resolution as usize;
    let failed = |e: image::Error| Failure::failed(e.to_string());
    let mut parts = args.parts.iter().zip(&baked.parts);
    let first = parts.next().map_or(&[][..], |(_, pixels)| pixels);
    let mut image = Image::from_rgb(side, side, first).map_err(failed)?;
    for (part, pixels) in parts {
        image.push_layer(part.name(), ["R", "G", "B"], pixels).map_err(failed)?;
    }
    Ok(image)
}

fn refused(args: &LightArgs, e: &steradian::Error) -> Failure {
    Failure::bad_input(format!("'{}': {e}", open::shown(&args.scene)))
}

impl Part {
    fn baked(self) -> lightmap::Part {
        match self {
            Self::All => lightmap::Part::All,
            Self::Direct => lightmap::Part::Direct,
            Self::Indirect => lightmap::Part::Indirect,
            Self::Ao => lightmap::Part::Ao,
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::All => "all",
            Self::Direct => "direct",
            Self::Indirect => "indirect",
            Self::Ao => "ao",
        }
    }
}
