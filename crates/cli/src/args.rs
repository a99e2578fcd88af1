//! The command line.

use crate::bench::BenchArgs;
use crate::experiment::ExperimentArgs;
use crate::values::{self, Frames, Layers, MAX_SPP, Rectangle, Size, Threshold};
use clap::{ArgAction, Args, Parser, Subcommand, ValueEnum, builder::PossibleValuesParser};
use std::{path::PathBuf, time::Duration};
use steradian::image::{
    Compression, Precision, WriteOptions,
    block::{BlockFormat, WRITABLE},
    signal::Prefilter,
    tone::Tone,
};

/// A physically based renderer for pbrt-v4 and Mitsuba scenes.
#[derive(Debug, Parser)]
#[command(
    name = "steradian",
    version,
    about,
    propagate_version = true,
    subcommand_required = true,
    arg_required_else_help = true
)]
#[command(
    after_help = "Exit codes: 0 done, 1 failed, 2 bad command line or scene, 4 pictures differ (compare), 130/143 stopped."
)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Render a scene into pictures; without SCENE, the built-in Cornell box
    Render(Box<RenderArgs>),
    /// Render a scene by every integrator that can, and test whether they agree
    Verify(VerifyArgs),
    /// Tell what is in a scene, and what of it was approximated or dropped
    Info(InfoArgs),
    /// List what is there by name: integrators, materials, tones, layers, …
    List(ListArgs),
    /// Measure a material: values, albedo, gloss, polar plot, a picture of a ball
    Material(Box<MaterialArgs>),
    /// Measure how far pictures are apart
    Compare(CompareArgs),
    /// Convert a picture to another format, or a scene to Steradian's own
    Convert(ConvertArgs),
    /// Measure the speed of single parts
    Bench(BenchArgs),
    /// Tell what waves a picture holds, and where they would appear if it were sampled more coarsely
    Signal(SignalArgs),
    /// Run an experiment of optics: diffraction, interference, prisms, rainbows, thermal light, …
    Optics(Box<ExperimentArgs>),
    /// Run an experiment of vision: chromaticity, cones, colour deficiencies, contrast, glare, …
    Vision(Box<ExperimentArgs>),
    /// Run an experiment of Monte Carlo integration: error against samples, importance, branching, …
    Estimate(Box<ExperimentArgs>),
    /// Print the completions of a shell
    Completions {
        /// The shell.
        shell: clap_complete::Shell,
    },
}

impl Command {
    /// Whether only errors are to be told.
    pub fn is_quiet(&self) -> bool {
        matches!(self, Self::Render(args) if args.quiet)
    }
}

/// Which scene, and how to read it.
#[derive(Args, Clone, Debug, Default)]
pub struct SceneOptions {
    /// Format of a scene that is read from standard input, instead of what its beginning looks like
    #[arg(long, value_name = "NAME", value_parser = PossibleValuesParser::new(steradian::load::EXTENSIONS.iter().map(|e| e.0)), help_heading = "Scene")]
    pub format: Option<String>,
    /// Frame size in pixels instead of the scene's
    #[arg(long, value_name = "WxH", help_heading = "Scene")]
    pub size: Option<Size>,
    /// Pixels to render, from the top left, the last ones exclusive
    #[arg(long, value_name = "X0,Y0,X1,Y1", help_heading = "Scene")]
    pub crop: Option<Rectangle>,
    /// Camera by name, or by number from 0, instead of the first
    #[arg(long, value_name = "NAME|N", help_heading = "Scene")]
    pub camera: Option<String>,
    /// Colour: the format's way (pbrt is spectral, others RGB), or always one of both
    #[arg(long, value_enum, default_value_t, help_heading = "Scene")]
    pub color: Color,
    /// Structure that rays go through (see `steradian list accelerators`); the picture has the same bits with any
    #[arg(long, value_name = "NAME", value_parser = accelerator_names(), default_value = "bvh", help_heading = "Scene")]
    pub accelerator: String,
    /// Memory for textures (512MiB, 2GiB, …); what is beyond waits in a temporary file. The picture has the same bits
    #[arg(long, value_name = "BYTES", value_parser = values::bytes, help_heading = "Scene")]
    pub texture_limit: Option<usize>,
    /// Look pictures up by one texel drawn at random, whose mean is the value of the filter
    #[arg(long, help_heading = "Scene")]
    pub stochastic_textures: bool,
    /// Set a parameter ($NAME) of a Mitsuba scene, or `at` (seconds), `animation`, `variant`, `scene` of a glTF scene,
    /// or `ground=false` of a model; may be repeated
    #[arg(short = 'D', value_name = "NAME=VALUE", value_parser = values::definition, help_heading = "Scene")]
    pub define: Vec<(String, String)>,
    /// Refuse scenes of which something would be approximated, dropped, or not used (a mistyped parameter)
    #[arg(long, help_heading = "Scene")]
    pub strict: bool,
    /// Threads; 0 for one per processor. The picture has the same bits for any number
    #[arg(long, alias = "nthreads", value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u16).range(0..=1024))]
    pub threads: u16,
}

/// How colours are computed with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Color {
    /// As the scene's format has it.
    #[default]
    Auto,
    /// Linear Rec.709.
    Rgb,
    /// Wavelengths.
    Spectral,
}

/// `steradian render`.
#[derive(Args, Clone, Debug)]
#[command(
    after_help = "Options of integrators are written --integrator path:max_depth=5,hide_emitters=true. `steradian list` knows all names."
)]
pub struct RenderArgs {
    /// Scene file (.pbrt .pbrt.gz .xml .gltf .glb .obj .ply), - for standard input, or builtin:NAME (see
    /// `steradian list scenes`)
    pub scene: Option<PathBuf>,
    /// Output file, its format by extension: .exr .png .hdr .pfm .ppm .jpg; may be repeated. Without it SCENE's name
    /// with .exr and .png in the current folder
    #[arg(short, long = "output", alias = "outfile", value_name = "OUT")]
    pub output: Vec<PathBuf>,
    /// How light is followed, instead of the scene's way
    #[arg(long, value_name = "NAME[:key=value,…]", value_parser = values::integrator, help_heading = "Quality")]
    pub integrator: Option<String>,
    /// Samples per pixel; 1k is 1000
    #[arg(long, value_name = "N", value_parser = values::spp, allow_hyphen_values = true, help_heading = "Quality")]
    pub spp: Option<u32>,
    /// Time of rendering (10s, 2m, 1h30m) after which to stop; without --spp as many samples are taken as it allows
    #[arg(long, value_name = "DURATION", value_parser = values::duration, help_heading = "Quality")]
    pub time: Option<Duration>,
    /// Estimated relative error of the picture (0.05, or 5%) at which to stop; without --spp as many samples are taken
    /// as it needs
    #[arg(long, value_name = "E", value_parser = values::error, help_heading = "Quality")]
    pub error: Option<f64>,
    /// Give parts of the picture that err more more of the samples, where that pays; --spp is the mean then
    #[arg(long, help_heading = "Quality")]
    pub adaptive: bool,
    /// Chooses among statistically equal pictures
    #[arg(long, value_name = "N", help_heading = "Quality")]
    pub seed: Option<u64>,
    /// Most scattering events on a path; -1 for no limit
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = clap::value_parser!(i64).range(-1..=i64::from(u32::MAX)), help_heading = "Quality")]
    pub max_depth: Option<i64>,
    /// Random numbers (see `steradian list samplers`); `scene` for those that the file names
    #[arg(long, value_name = "NAME", value_parser = sampler_names(), help_heading = "Quality")]
    pub sampler: Option<String>,
    /// Keep the render in FILE, every half minute and at its end, and go on from it if it is there: the picture has the
    /// bits of a render that was never stopped
    #[arg(long, value_name = "FILE")]
    pub resume: Option<PathBuf>,
    /// Render frames A to B of a glTF animation, both included, into NAME.0000.exr and so on
    #[arg(long, value_name = "A..B", value_parser = values::frames)]
    pub frames: Option<Frames>,
    /// Frames per second of --frames
    #[arg(long, value_name = "N", default_value_t = 24.0, value_parser = values::rate)]
    pub fps: f64,
    /// Leave what lies behind all surfaces out of the picture; write coverage as alpha (premultiplied in .exr, straight
    /// in .png)
    #[arg(long)]
    pub transparent: bool,
    /// Layers to add to .exr files (a comma-separated list of `steradian list layers`, or `all`)
    #[arg(long, value_name = "LIST")]
    pub aov: Vec<Layers>,
    /// The scene.
    #[command(flatten)]
    pub scene_options: SceneOptions,
    /// Files.
    #[command(flatten)]
    pub files: FileOptions,
    /// Say nothing but errors
    #[arg(short, long)]
    pub quiet: bool,
    /// Print one line of JSON about the render to stdout
    #[arg(long)]
    pub json: bool,
}

fn accelerator_names() -> PossibleValuesParser {
    PossibleValuesParser::new(steradian::Accelerator::ALL.map(|a| a.about().0))
}

fn sampler_names() -> PossibleValuesParser {
    let family = steradian::registry().into_iter().find(|f| f.0 == "samplers");
    PossibleValuesParser::new(family.into_iter().flat_map(|f| f.1).map(|s| s.0).chain(["scene"]))
}

/// How pictures are stored.
#[derive(Args, Clone, Debug)]
pub struct FileOptions {
    /// Tone curve of .png, .jpg and .ppm (`steradian list tones`); `none` is plain sRGB. Default: `none`, and
    /// `pbr-neutral` for models and glTF. A .ppm without it keeps linear values, scaled by the #MAX= in its comment
    #[arg(long, value_name = "NAME[:key=value,…]", value_parser = values::tone, help_heading = "Files")]
    pub tonemap: Option<Tone>,
    /// Exposure of .png, .jpg and .ppm in stops, -64 to 64
    #[arg(long, value_name = "EV", allow_negative_numbers = true, help_heading = "Files")]
    pub exposure: Option<f32>,
    /// Precision of .exr
    #[arg(long, value_enum, default_value_t, help_heading = "Files")]
    pub exr: ExrPrecision,
    /// Compression of .exr; all are lossless
    #[arg(long, value_enum, default_value_t, help_heading = "Files")]
    pub compression: ExrCompression,
    /// Block compression of .dds and .ktx2: bc1 and bc3 without and with alpha, bc4 one channel, bc5 two, bc7 colour
    /// and alpha
    #[arg(long, value_name = "NAME", default_value = "bc7", value_parser = PossibleValuesParser::new(WRITABLE.map(|w| w.0)), help_heading = "Files")]
    pub block: String,
}

/// Sample type of EXR files.
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
pub enum ExrPrecision {
    /// 16 bits; depth, positions, ids and counts stay 32.
    Half,
    /// 32 bits.
    #[default]
    Float,
}

/// Compression of EXR files.
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
pub enum ExrCompression {
    /// As it is.
    None,
    /// Deflate.
    #[default]
    Zip,
    /// Wavelets.
    Piz,
}

impl FileOptions {
    /// What the image library is told.
    ///
    /// # Errors
    /// An exposure out of range.
    pub fn write_options(&self) -> Result<WriteOptions, String> {
        self.write_options_or(Tone::default())
    }

    /// [`write_options`](Self::write_options) with another tone curve where the command line names none.
    ///
    /// # Errors
    /// An exposure out of range.
    pub fn write_options_or(&self, tone: Tone) -> Result<WriteOptions, String> {
        let mut tone = self.tonemap.clone().unwrap_or(tone);
        if let Some(ev) = self.exposure {
            tone = tone.with_exposure(ev).map_err(|e| e.to_string())?;
        }
        Ok(WriteOptions {
            exr_precision: match self.exr {
                ExrPrecision::Half => Precision::Half,
                ExrPrecision::Float => Precision::Float,
            },
            exr_compression: match self.compression {
                ExrCompression::None => Compression::None,
                ExrCompression::Zip => Compression::Zip,
                ExrCompression::Piz => Compression::Piz,
            },
            block: WRITABLE.iter().find(|w| w.0 == self.block).map_or(BlockFormat::Bc7, |w| w.1),
            ppm_radiance: self.tonemap.is_none() && self.exposure.is_none(),
            tone,
            ..WriteOptions::default()
        })
    }
}

/// `steradian info`.
#[derive(Args, Debug)]
pub struct InfoArgs {
    /// Scene file, - for standard input, or builtin:NAME
    pub scene: PathBuf,
    /// The scene.
    #[command(flatten)]
    pub scene_options: SceneOptions,
    /// Print one line of JSON to stdout
    #[arg(long)]
    pub json: bool,
    /// Render a small picture of the scene into this file, its format by extension
    #[arg(long, value_name = "OUT.png")]
    pub thumbnail: Option<PathBuf>,
}

/// `steradian list`.
#[derive(Args, Debug)]
pub struct ListArgs {
    /// Which kind of thing (integrators, materials, tones, …); all without it
    pub family: Option<String>,
    /// Print the page of documentation of the materials
    #[arg(long, conflicts_with = "json")]
    pub markdown: bool,
    /// Print one line of JSON to stdout
    #[arg(long)]
    pub json: bool,
}

/// `steradian material`.
#[derive(Args, Debug)]
#[command(
    after_help = "Parameters of kinds: numbers are written 0.5, colours 0.8,0.2,0.1, spectra by name (metal-Au-eta), textures and measured data\n\
    as file names, materials as KIND or KIND(name=value;name=value), lists of them separated by |.\n\
    Directions are unit vectors away from the surface, z along the normal, x along the tangent."
)]
pub struct MaterialArgs {
    /// A kind of material (`steradian list materials`), or SCENE:NAME for one of a scene file
    pub material: String,
    /// Parameters of the kind; may be repeated
    #[arg(short, long, value_name = "NAME=VALUE", num_args = 1.., value_parser = values::definition)]
    pub params: Vec<(String, String)>,
    /// Write polar slices through the lobes as SVG
    #[arg(long, value_name = "OUT.svg")]
    pub plot: Option<PathBuf>,
    /// Write a picture of a ball of it (of the scene, for a material of one)
    #[arg(long, value_name = "OUT")]
    pub picture: Option<PathBuf>,
    /// Samples per pixel of the picture
    #[arg(long, value_name = "N", default_value_t = 256, value_parser = clap::value_parser!(u32).range(1..=i64::from(MAX_SPP)))]
    pub spp: u32,
    /// Table of the parts of light that are reflected and transmitted, by angle
    #[arg(long)]
    pub albedo: bool,
    /// Gloss units at 20°, 60° and 85° (ISO 2813)
    #[arg(long)]
    pub gloss: bool,
    /// Parameters of Ward's, Cook and Torrance's and the GGX model that come nearest to it
    #[arg(long)]
    pub fit: bool,
    /// Write a table of angles that the material 'measured' reads (isotropic, every 5° and 10° of azimuth)
    #[arg(long, value_name = "OUT.txt")]
    pub table: Option<PathBuf>,
    /// Measure a piece of geometry (up is +z) made of the kind, as if it were a material: --albedo and --table count
    /// the rays that its middle sends back
    #[arg(long, value_name = "MESH", conflicts_with_all = ["plot", "picture", "gloss", "fit", "eval", "microsurface"])]
    pub geometry: Option<String>,
    /// The same for a random Gaussian surface of this roughness α (Beckmann's), made of the kind
    #[arg(long, value_name = "ALPHA", value_parser = values::roughness, conflicts_with_all = ["plot", "picture", "gloss", "fit", "eval"])]
    pub microsurface: Option<f32>,
    /// Values and densities for pairs of directions from a JSON file: [{"wo": [x,y,z], "wi": [x,y,z]}, …]
    #[arg(long, value_name = "PAIRS.json")]
    pub eval: Option<PathBuf>,
    /// Evaluate for importance, as paths from lights do, rather than radiance
    #[arg(long)]
    pub importance: bool,
    /// Samples of each reading
    #[arg(long, value_name = "N", default_value_t = 65536, value_parser = clap::value_parser!(u32).range(1..=1 << 26))]
    pub samples: u32,
    /// Where textures are looked up
    #[arg(long, value_name = "U,V", value_parser = values::pair, default_value = "0.5,0.5")]
    pub uv: [f32; 2],
    /// Wavelengths in nm at which spectral scenes are measured
    #[arg(long, value_name = "A,B,C,D", value_parser = values::wavelengths)]
    pub wavelengths: Option<[f32; 4]>,
    /// The scene.
    #[command(flatten)]
    pub scene: SceneOptions,
    /// Files.
    #[command(flatten)]
    pub files: FileOptions,
    /// Print one line of JSON to stdout
    #[arg(long)]
    pub json: bool,
}

/// `steradian verify`.
#[derive(Args, Debug)]
#[command(
    after_help = "Every integrator is compared with 'path' ('volpath' where there are media), by z-tests of blocks of 4 x 4 pixels whose level is\n\
    divided among them (Sidak). Biased integrators may differ, if they differ less than with twice the radius. Exit code 4 if one disagrees."
)]
pub struct VerifyArgs {
    /// Scene file, or builtin:NAME
    pub scene: PathBuf,
    /// Integrators to verify, with options, instead of all; may be repeated
    #[arg(short, long, value_name = "NAME[:key=value,...]")]
    pub integrator: Vec<String>,
    /// Samples per pixel
    #[arg(long, value_name = "N", default_value_t = 64, value_parser = clap::value_parser!(u32).range(2..=i64::from(MAX_SPP)))]
    pub spp: u32,
    /// Random seed
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// Folder for the pictures and their differences (.exr)
    #[arg(short, long, value_name = "FOLDER")]
    pub output: Option<PathBuf>,
    /// Print one line of JSON to stdout instead of a table
    #[arg(long)]
    pub json: bool,
    /// The scene.
    #[command(flatten)]
    pub scene_options: SceneOptions,
}

/// `steradian compare`.
#[derive(Args, Debug)]
#[command(
    after_help = "Without --reference B is what A is compared to; with it, A and B are each compared to every reference.\n\
    The z-test needs the variance of one sample per pixel (as Mitsuba stores it) and the number of samples of A. Pictures that carry\n\
    `variance` layers and `samplesPerPixel` of their own are tested without being asked."
)]
pub struct CompareArgs {
    /// A picture
    pub a: PathBuf,
    /// Another, or what the first is compared to
    #[arg(required_unless_present = "reference")]
    pub b: Option<PathBuf>,
    /// What the pictures are compared to; may be repeated
    #[arg(short, long, value_name = "R")]
    pub reference: Vec<PathBuf>,
    /// Picture with the variance of one sample per pixel, for a z-test
    #[arg(long, value_name = "VAR")]
    pub variance: Option<PathBuf>,
    /// Samples per pixel of the tested pictures, for the z-test; by default what their metadata say
    #[arg(long, value_name = "N", requires = "variance")]
    pub samples: Option<f64>,
    /// Write a picture of the differences: of .png and .jpg the FLIP error of each pixel in colours from black (none)
    /// to light yellow (1), of .exr, .hdr and .pfm the absolute differences
    #[arg(short, long, value_name = "OUT")]
    pub output: Option<PathBuf>,
    /// Exit with code 4 when a metric of any pair is above a value (or not a number); may be repeated
    #[arg(long, value_name = "METRIC=VALUE")]
    pub fail_above: Vec<Threshold>,
    /// Print one line of JSON to stdout; infinite numbers are null
    #[arg(long, action = ArgAction::SetTrue)]
    pub json: bool,
}

/// `steradian convert`.
#[derive(Args, Debug)]
pub struct ConvertArgs {
    /// Picture to read: .exr .png .jpg .tga .bmp .hdr .pfm .ppm .pgm .dds .ktx2; or a scene
    pub input: PathBuf,
    /// Picture to write, its format by extension: .exr .png .hdr .pfm .ppm .jpg .dds .ktx2; of a scene: .steradian
    pub output: PathBuf,
    /// Layer of the picture to write: a name of `steradian list layers`, or of channels in the file (N, diffuse, Z, …)
    #[arg(long, value_name = "NAME")]
    pub layer: Option<String>,
    /// Scenes: what was exact, approximated and dropped, as Markdown
    #[arg(long, value_name = "FILE.md")]
    pub report: Option<PathBuf>,
    /// Scenes: render both sides small, and tell the difference in numbers
    #[arg(long)]
    pub check: bool,
    /// Files.
    #[command(flatten)]
    pub files: FileOptions,
}

/// `steradian signal`.
#[derive(Args, Debug)]
pub struct SignalArgs {
    /// A picture
    pub input: PathBuf,
    /// Sample at every N-th pixel
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = clap::value_parser!(u32).range(1..=4096))]
    pub step: u32,
    /// Filter before sampling
    #[arg(long, value_name = "NAME", default_value = "box", value_parser = PossibleValuesParser::new(Prefilter::ALL.map(|f| f.0)))]
    pub prefilter: String,
    /// How many of the strongest waves to tell
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub waves: u32,
    /// What to draw; may be repeated. A picture: the signal, its spectrum, the spectrum after sampling, the samples,
    /// and the samples after the prefilter. A .svg: a plot of the spectrum
    #[arg(short, long, value_name = "OUT")]
    pub output: Vec<PathBuf>,
    /// Print one line of JSON to stdout
    #[arg(long)]
    pub json: bool,
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_sound() {
        Cli::command().debug_assert();
    }

    #[test]
    fn spellings_of_pbrt_are_accepted() {
        let cli =
            Cli::parse_from(["steradian", "render", "a.pbrt", "--nthreads", "3", "--outfile", "x.exr", "--spp", "8"]);
        let Command::Render(args) = cli.command else { panic!("render was asked for") };
        assert_eq!((args.scene_options.threads, args.spp), (3, Some(8)));
        assert_eq!(args.output, [PathBuf::from("x.exr")]);
    }

    #[test]
    fn numbers_are_checked() {
        for bad in [
            &["--spp", "0"][..],
            &["--spp", "99999999"],
            &["--threads", "5000"],
            &["--max-depth", "-2"],
            &["--sampler", "sobl"],
            &["--accelerator", "bhv"],
            &["--size", "0x0"],
            &["--color", "cmyk"],
        ] {
            let line = ["steradian", "render"].iter().chain(bad);
            assert!(Cli::try_parse_from(line).is_err(), "{bad:?}");
        }
        for good in [&["--max-depth", "-1"][..], &["--exposure", "-2.5"], &["--time", "1.5s"]] {
            let line = ["steradian", "render"].iter().chain(good);
            assert!(Cli::try_parse_from(line).is_ok(), "{good:?}");
        }
    }
}
