//! Arguments of the subcommands.

use crate::{
    brightness::Exposure,
    terminal::Talk,
    values::{self, Frames, Layers, Rectangle, Size, Threshold},
};
use clap::{ArgAction, Args, ValueEnum, builder::PossibleValuesParser};
use std::{path::PathBuf, time::Duration};
use steradian::image::{
    Compression, FalseColor, Precision, Sensor, WriteOptions,
    block::{BlockFormat, WRITABLE},
    signal::Prefilter,
    tone::Tone,
};
use steradian::{SensorNoise, Viewpoint, math::DVec3, quality::MAX_THREADS};

/// Which scene, and how to read it.
#[derive(Args, Clone, Debug, Default)]
pub struct SceneOptions {
    /// Format of a scene on standard input; default: detected from its first bytes
    #[arg(long, value_name = "NAME", value_parser = PossibleValuesParser::new(steradian::load::extensions().map(|e| e.0)), help_heading = "Scene")]
    pub format: Option<String>,
    /// Size of the frame in pixels; overrides the scene's
    #[arg(long, value_name = "WxH", help_heading = "Scene")]
    pub size: Option<Size>,
    /// Part of the frame to render: pixels from the top left, X1 and Y1 exclusive
    #[arg(long, value_name = "X0,Y0,X1,Y1", help_heading = "Scene")]
    pub crop: Option<Rectangle>,
    /// Camera to use, by name or by number from 0; default: the first
    #[arg(long, value_name = "NAME|N", help_heading = "Scene")]
    pub camera: Option<String>,
    /// Camera position, a point it looks at, and the direction that is up, in the world; it keeps its lens
    #[arg(long, value_name = "EX,EY,EZ,TX,TY,TZ,UX,UY,UZ", value_parser = values::viewpoint)]
    #[arg(allow_hyphen_values = true, help_heading = "Scene")]
    pub look_at: Option<Viewpoint>,
    /// Colour arithmetic; auto is spectral for pbrt scenes and RGB for others
    #[arg(long, value_enum, default_value_t, help_heading = "Scene")]
    pub color: Color,
    /// Acceleration structure (`steradian list accelerators`); does not change the picture
    #[arg(long, value_name = "NAME", value_parser = accelerator_names(), default_value = "bvh", help_heading = "Scene")]
    pub accelerator: String,
    /// Memory for textures (512MiB, 2GiB, …); the rest is kept in a temporary file. Does not change the picture
    #[arg(long, value_name = "BYTES", value_parser = values::bytes, help_heading = "Scene")]
    pub texture_limit: Option<usize>,
    /// Memory that the program may take (512MiB, 2GiB, …): what would need more is refused before it begins
    #[arg(long, value_name = "BYTES", value_parser = values::bytes, help_heading = "Scene")]
    pub memory_limit: Option<usize>,
    /// Look up one random texel instead of filtering; the expected value is the same
    #[arg(long, help_heading = "Scene")]
    pub stochastic_textures: bool,
    /// Set a $parameter of a Mitsuba scene; at=SECONDS, animation, variant, scene of a glTF scene; of a model
    /// azimuth=DEG, elevation=DEG, sky=studio, outdoor, overcast, none or FILE, or sky=clear or sky=atmosphere with
    /// sun=DEG, turn=DEG and strength=X of the sky, background=gradient, none or #rrggbb, ground=false, and
    /// material=gold (clay, glass, …), up=z, front=-y, handedness=left, crease=DEG of an OBJ or PLY. Repeatable
    #[arg(short = 'D', value_name = "NAME=VALUE", value_parser = values::definition, help_heading = "Scene")]
    pub define: Vec<(String, String)>,
    /// The box that the camera of a model without one shows, over all frames of a sequence
    #[arg(skip)]
    pub framing: Option<[DVec3; 2]>,
    /// Noise of the film's sensor
    #[arg(skip)]
    pub sensor_noise: SensorNoise,
    /// Refuse a scene if anything is approximated, dropped, or unused (such as a mistyped parameter)
    #[arg(long, help_heading = "Scene")]
    pub strict: bool,
    /// Number of threads; 0 is one per processor. Does not change the picture
    #[arg(long, alias = "nthreads", value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u16).range(0..=MAX_THREADS as i64))]
    pub threads: u16,
}

/// Colour arithmetic.
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
    /// Scene file (.pbrt .pbrt.gz .xml .gltf .glb .usd .usda .usdc .usdz .mtlx .obj .ply .stl .bpt), - for standard
    /// input, or builtin:NAME (see `steradian list scenes`)
    pub scene: Option<PathBuf>,
    /// Output file (.exr .png .hdr .pfm .ppm .jpg .dds .ktx2). Repeatable. Default: SCENE.exr and SCENE.png in the
    /// current folder
    #[arg(short, long = "output", alias = "outfile", value_name = "OUT")]
    pub output: Vec<PathBuf>,
    /// Override the scene's integrator (`steradian list integrators`); auto: the best of some by a trial
    #[arg(long, value_name = "NAME[:key=value,…]", value_parser = values::integrator_or_auto, help_heading = "Quality")]
    pub integrator: Option<String>,
    /// Samples per pixel; 1k is 1000
    #[arg(long, value_name = "N", value_parser = values::spp, allow_hyphen_values = true, help_heading = "Quality")]
    pub spp: Option<u32>,
    /// Stop after this time of rendering (10s, 2m, 1h30m); without --spp the number of samples is unlimited. 0 takes no
    /// samples and makes a picture of what --resume keeps
    #[arg(long, value_name = "DURATION", value_parser = values::time, help_heading = "Quality")]
    pub time: Option<Duration>,
    /// Stop at this estimated relative error (0.05, or 5%); without --spp the number of samples is unlimited
    #[arg(long, value_name = "E", value_parser = values::error, help_heading = "Quality")]
    pub error: Option<f64>,
    /// Spend more samples on noisy regions; --spp becomes the average
    #[arg(long, help_heading = "Quality")]
    pub adaptive: bool,
    /// Random seed
    #[arg(long, value_name = "N", help_heading = "Quality")]
    pub seed: Option<u64>,
    /// Maximum number of scattering events of a path; -1 for no limit
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = clap::value_parser!(i64).range(-1..=i64::from(u32::MAX)), help_heading = "Quality")]
    pub max_depth: Option<i64>,
    /// Remove the noise when done, by nlm unless another denoiser is named; an .exr keeps the noisy picture as the
    /// layer raw, and the layers that guided. With --aov halves nlm estimates the error that remains. For path,
    /// volpath, direct, whitted, ao, raycast and bdpt
    #[arg(long, value_name = "NAME", value_enum, num_args = 0..=1, require_equals = true, help_heading = "Quality")]
    pub denoise: Option<Option<Denoiser>>,
    /// Denoise frames (--frames) with what those before saw, by nlm; each takes a seed of its own
    #[arg(long, requires = "denoise", requires = "frames", help_heading = "Quality")]
    pub temporal: bool,
    /// The library of Open Image Denoise 2, or a folder that has it; --denoise then uses it
    #[arg(long, value_name = "PATH", requires = "denoise", help_heading = "Quality")]
    pub oidn: Option<PathBuf>,
    /// Sampler (`steradian list samplers`); `scene` uses the one that the file names
    #[arg(long, value_name = "NAME", value_parser = sampler_names(), help_heading = "Quality")]
    pub sampler: Option<String>,
    /// Save the state in FILE every 30 s and at the end; continue from FILE if it exists. The picture has the bits of
    /// an uninterrupted render. A finished render continues with a larger --spp
    #[arg(long, value_name = "FILE")]
    pub resume: Option<PathBuf>,
    /// Print the time and memory that the render will take, from a trial of two seconds, and write no picture
    #[arg(long, conflicts_with_all = ["resume", "watch", "frames", "error"])]
    pub estimate: bool,
    /// Write the outputs at these intervals while rendering (10s, 2m); SIGUSR1 writes them at once
    #[arg(long, value_name = "DURATION", value_parser = values::duration)]
    pub watch: Option<Duration>,
    /// Render frames A to B of a glTF animation, both included, into NAME.0000.exr and so on, or films: -o with .apng,
    /// .gif, or by ffmpeg .mp4, .webm, .webp
    #[arg(long, value_name = "A..B", value_parser = values::frames)]
    pub frames: Option<Frames>,
    /// Turn a model or glTF scene once around in N frames, as --frames does
    #[arg(long, value_name = "N", conflicts_with = "frames")]
    #[arg(value_parser = clap::value_parser!(u32).range(2..=100_000))]
    pub turntable: Option<u32>,
    /// Which of them this is.
    #[arg(skip)]
    pub frame: u32,
    /// True for a render of a job, which is held against the scene's fingerprint.
    #[arg(skip)]
    pub is_of_job: bool,
    /// Frames per second
    #[arg(long, value_name = "N", default_value_t = 24.0, value_parser = values::rate)]
    pub fps: f64,
    /// Transparent background: write coverage as alpha (premultiplied in .exr, straight in .png)
    #[arg(long)]
    pub transparent: bool,
    /// Extra layers in .exr files: names of `steradian list layers`, separated by commas, or `all`
    #[arg(long, value_name = "LIST")]
    pub aov: Vec<Layers>,
    /// The scene.
    #[command(flatten)]
    pub scene_options: SceneOptions,
    /// Files.
    #[command(flatten)]
    pub files: FileOptions,
    /// Messages.
    #[command(flatten)]
    pub talk: Talk,
    /// Print one line of JSON about the render to stdout
    #[arg(long)]
    pub json: bool,
}

impl RenderArgs {
    /// True if the picture has no background, by `--transparent` or `-D background=none`.
    pub fn is_transparent(&self) -> bool {
        let none = |(name, value): &(String, String)| name == "background" && value == "none";
        self.transparent || self.scene_options.define.iter().any(none)
    }
}

fn accelerator_names() -> PossibleValuesParser {
    PossibleValuesParser::new(steradian::Accelerator::ALL.map(|a| a.about().0))
}

fn sampler_names() -> PossibleValuesParser {
    let family = steradian::registry().into_iter().find(|f| f.0 == "samplers");
    PossibleValuesParser::new(family.into_iter().flat_map(|f| f.1).map(|s| s.0).chain(["scene"]))
}

/// Options of picture files.
#[derive(Args, Clone, Debug)]
pub struct FileOptions {
    /// Tone curve of .png, .jpg and .ppm (`steradian list tones`); `none` is plain sRGB. Default: `none`, and
    /// `pbr-neutral` for models and glTF. A .ppm without it keeps linear values, scaled by the #MAX= in its comment
    #[arg(long, value_name = "NAME[:key=value,…]", value_parser = values::tone, help_heading = "Files")]
    pub tonemap: Option<Tone>,
    /// Exposure of .png, .jpg and .ppm in stops, -64 to 64; or auto: what is lit becomes grey on average. Default: 0;
    /// auto where a model or glTF scene would be white or black
    #[arg(long, value_name = "EV|auto", allow_negative_numbers = true, help_heading = "Files")]
    pub exposure: Option<Exposure>,
    /// Precision of .exr
    #[arg(long, value_enum, default_value_t, help_heading = "Files")]
    pub exr: ExrPrecision,
    /// Compression of .exr; all are lossless
    #[arg(long, value_enum, default_value_t, help_heading = "Files")]
    pub compression: ExrCompression,
    /// Block compression of .dds and .ktx2: bc1 colour, bc2 and bc3 with coarse and smooth alpha, bc4 one channel, bc5
    /// two, bc6h linear colour of any brightness, bc7 colour and alpha
    #[arg(long, value_name = "NAME", default_value = "bc7", value_parser = PossibleValuesParser::new(WRITABLE.map(|w| w.0)), help_heading = "Files")]
    pub block: String,
}

/// Sample type of EXR files.
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
pub enum ExrPrecision {
    /// 16 bits; depth, positions, ids and counts keep 32.
    Half,
    /// 32 bits.
    #[default]
    Float,
}

/// Compression of EXR files.
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
pub enum ExrCompression {
    /// Uncompressed.
    None,
    /// Deflate.
    #[default]
    Zip,
    /// Wavelets.
    Piz,
}

impl FileOptions {
    /// Options for the image library.
    ///
    /// # Errors
    /// An exposure out of range, or one that the picture is to tell.
    pub fn write_options(&self) -> Result<WriteOptions, String> {
        match self.exposure {
            Some(Exposure::Auto) => {
                Err("--exposure auto is for pictures that are rendered, converted or denoised: give stops".into())
            }
            _ => self.write_options_or(Tone::default()),
        }
    }

    /// [`write_options`](Self::write_options) with another tone curve where the command line names none.
    ///
    /// # Errors
    /// An exposure out of range.
    pub fn write_options_or(&self, tone: Tone) -> Result<WriteOptions, String> {
        let mut tone = self.tonemap.clone().unwrap_or(tone);
        if let Some(Exposure::Stops(ev)) = self.exposure {
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
    /// Scene file, - for standard input, or builtin:NAME; or a picture (.exr .png .jpg .hdr …)
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
    /// Family of names (integrators, materials, tones, …), `limits` (features that integrators leave out or refuse), or
    /// the name of one thing (conductor, path, …); default: all
    pub family: Option<String>,
    /// Print the documentation of the materials as Markdown
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
    Without a reading asked for, the parameters and a summary are printed: steradian material plastic -p alpha_u=0.2\n\
    Directions are unit vectors away from the surface, z along the normal, x along the tangent."
)]
pub struct MaterialArgs {
    /// Kind of material (`steradian list materials`), or SCENE:NAME for a material of a scene file
    pub material: String,
    /// Parameter of the material. Repeatable
    #[arg(short, long, value_name = "NAME=VALUE", num_args = 1.., value_parser = values::definition)]
    pub params: Vec<(String, String)>,
    /// Write polar slices through the lobes as SVG
    #[arg(long, value_name = "OUT.svg")]
    pub plot: Option<PathBuf>,
    /// Radius of the plot: in proportion to the values, or by their logarithm over four decades, which shows what is
    /// weak beside a narrow lobe
    #[arg(long, value_enum, default_value_t, value_name = "SCALE", requires = "plot")]
    pub plot_scale: PlotScale,
    /// Render a ball of the material into this file (for SCENE:NAME, the scene)
    #[arg(long, value_name = "OUT")]
    pub picture: Option<PathBuf>,
    /// Samples per pixel of the picture; 1k is 1000
    #[arg(long, value_name = "N", default_value_t = 256, value_parser = values::spp, allow_hyphen_values = true)]
    pub spp: u32,
    /// Print reflected and transmitted albedo by angle of incidence; of a fibre what a white furnace shows of it, by
    /// the angle of the view from the plane across it
    #[arg(long)]
    pub albedo: bool,
    /// Print gloss units at 20°, 60° and 85° (ISO 2813)
    #[arg(long)]
    pub gloss: bool,
    /// Fit the three forms of Ward's model, that of Cook and Torrance, and GGX to the material, and name the nearest
    #[arg(long)]
    pub fit: bool,
    /// Hold the material to the laws of scattering: not negative, reciprocal, no energy gained, and directions drawn by
    /// a density that integrates to their share (χ² test), as a table with p-values
    #[arg(long)]
    pub laws: bool,
    /// Write a table of angles that the material 'measured' reads (isotropic, every 5° and 10° of azimuth)
    #[arg(long, value_name = "OUT.txt")]
    pub table: Option<PathBuf>,
    /// Measure a piece of geometry (up is +z) made of the kind, as if it were a material: --albedo and --table count
    /// the rays that its middle sends back
    #[arg(long, value_name = "MESH")]
    #[arg(conflicts_with_all = ["plot", "picture", "gloss", "fit", "laws", "eval", "microsurface"])]
    pub geometry: Option<String>,
    /// Measure a random Gaussian surface of this roughness α (Beckmann), made of the kind, as if it were a material
    #[arg(long, value_name = "ALPHA", value_parser = values::roughness)]
    #[arg(conflicts_with_all = ["plot", "picture", "gloss", "fit", "laws", "eval"])]
    pub microsurface: Option<f32>,
    /// Values and densities for pairs of directions from a JSON file: [{"wo": [x,y,z], "wi": [x,y,z]}, …]
    #[arg(long, value_name = "PAIRS.json")]
    pub eval: Option<PathBuf>,
    /// Evaluate for importance (paths from lights) instead of radiance
    #[arg(long)]
    pub importance: bool,
    /// Samples for each measurement
    #[arg(long, value_name = "N", default_value_t = 65536, value_parser = clap::value_parser!(u32).range(1..=1 << 26))]
    pub samples: u32,
    /// Texture coordinates at which to measure
    #[arg(long, value_name = "U,V", value_parser = values::pair, default_value = "0.5,0.5")]
    pub uv: [f32; 2],
    /// Wavelengths in nm at which to measure spectral scenes
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

/// Radius of the plot of a material.
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
pub enum PlotScale {
    /// In proportion to the values.
    #[default]
    Linear,
    /// By their logarithm.
    Log,
}

/// `steradian verify`.
#[derive(Args, Debug)]
#[command(
    after_help = "Every integrator is compared with the one that finds all light of the scene and errs least, path tracing or bdpt, by z-tests\n\
    of blocks of 4 x 4 pixels whose level is divided among them (Sidak), with up to 16 times the samples until differences of 1 % would\n\
    show. Biased integrators may differ by what their radius or patches explain. Exit code 4 if one differs, 5 if one is undecided."
)]
pub struct VerifyArgs {
    /// Scene file, - for standard input, or builtin:NAME
    pub scene: PathBuf,
    /// Integrator to verify, with options. Repeatable. Default: all
    #[arg(short, long, value_name = "NAME[:key=value,...]")]
    pub integrator: Vec<String>,
    /// Samples per pixel; 1k is 1000
    #[arg(long, value_name = "N", default_value_t = 64, value_parser = values::spp_with_variance, allow_hyphen_values = true)]
    pub spp: u32,
    /// Random seed
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// Folder for the pictures and their differences (.exr)
    #[arg(short, long, value_name = "FOLDER")]
    pub output: Option<PathBuf>,
    /// Report with pictures and maps of z, as one page
    #[arg(long, value_name = "REPORT.html")]
    pub html: Option<PathBuf>,
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
    `variance` layers and `samplesPerPixel` of their own are tested without being asked; both need them. With --variance the reference\n\
    counts as exact."
)]
pub struct CompareArgs {
    /// First picture
    pub a: PathBuf,
    /// Second picture; the reference, unless --reference is given. A reference of another size is resampled by area
    #[arg(required_unless_present = "reference")]
    pub b: Option<PathBuf>,
    /// Reference picture. Repeatable
    #[arg(short, long, value_name = "R")]
    pub reference: Vec<PathBuf>,
    /// Picture with the variance of one sample per pixel, for a z-test
    #[arg(long, value_name = "VAR")]
    pub variance: Option<PathBuf>,
    /// Samples per pixel of the tested pictures, for the z-test; default: from their metadata
    #[arg(long, value_name = "N", requires = "variance")]
    pub samples: Option<f64>,
    /// Write a picture of the differences: .png and .jpg show FLIP errors from black (0) to light yellow (1); .exr,
    /// .hdr and .pfm hold absolute differences
    #[arg(short, long, value_name = "OUT")]
    pub output: Option<PathBuf>,
    /// Write all metrics of all pairs as a table of comma-separated values
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
    /// Write a page with all metrics, and of each pair both pictures under a slider, FLIP errors, relative errors, and
    /// differences in standard errors where variances are known; one file, which fetches nothing
    #[arg(long, value_name = "FILE")]
    pub html: Option<PathBuf>,
    /// Exit with code 4 if a metric is above a value, or not a number. Repeatable
    #[arg(long, value_name = "METRIC=VALUE")]
    pub fail_above: Vec<Threshold>,
    /// Print one line of JSON to stdout; infinite numbers are null
    #[arg(long, action = ArgAction::SetTrue)]
    pub json: bool,
}

/// `steradian convert`.
#[derive(Args, Debug)]
pub struct ConvertArgs {
    /// Picture to read: .exr .png .jpg .tga .bmp .hdr .pfm .ppm .pgm .dds .ktx2 .webp; or a scene: a file, - for
    /// standard input, or builtin:NAME
    pub input: PathBuf,
    /// Picture to write, its format by extension: .exr .png .hdr .pfm .ppm .jpg .dds .ktx2; of a scene: .steradian .xml
    /// .pbrt .gltf .glb
    pub output: PathBuf,
    /// Layer of the picture to write: a name of `steradian list layers`, or of channels in the file (N, diffuse, Z, …)
    #[arg(long, value_name = "NAME")]
    pub layer: Option<String>,
    /// Add the noise of a sensor: full_well=E, and read_noise, dark_current, bits, noise_seed, iso, exposure_time as of
    /// films (`steradian list films --markdown`). A value of 1 is where the converter ends, at any ISO
    #[arg(long, value_name = "full_well=E[,…]", value_parser = values::sensor)]
    pub sensor: Option<Sensor>,
    /// Show luminance as colours with a legend: scale=log|linear, min=, max= (cd/m², or 1% of the pixels), white=
    /// (luminance of a value of 1), unit=cd/m²|lx
    #[arg(long, alias = "false-colour", value_name = "key=value,…", num_args = 0..=1, require_equals = true)]
    #[arg(default_missing_value = "", value_parser = values::false_color, conflicts_with_all = ["tonemap", "exposure"])]
    pub false_color: Option<FalseColor>,
    /// Scenes: write a report of what was exact, approximated and dropped (Markdown)
    #[arg(long, value_name = "FILE.md")]
    pub report: Option<PathBuf>,
    /// Scenes: render both sides at a small size and print the difference
    #[arg(long)]
    pub check: bool,
    /// Scenes: write nothing if anything is approximated, dropped, or unused
    #[arg(long)]
    pub strict: bool,
    /// Scenes: set what -D sets in render. Repeatable
    #[arg(short = 'D', value_name = "NAME=VALUE", value_parser = values::definition)]
    pub define: Vec<(String, String)>,
    /// Scenes: format of standard input; default: detected from its first bytes
    #[arg(long, value_name = "NAME", value_parser = PossibleValuesParser::new(steradian::load::extensions().map(|e| e.0)))]
    pub format: Option<String>,
    /// Files.
    #[command(flatten)]
    pub files: FileOptions,
}

/// Denoiser.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Denoiser {
    /// First-order regression, built in.
    Nlm,
    /// A wavelet filter, built in: a small part of the time of nlm, for previews.
    Atrous,
    /// Open Image Denoise 2 by Intel, a library that --oidn, STERADIAN_OIDN or a usual place has.
    Oidn,
}

/// Denoiser of a view.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ViewDenoiser {
    /// Regression, built in.
    Nlm,
    /// A wavelet filter, built in.
    Atrous,
    /// Open Image Denoise.
    Oidn,
    /// None: pictures with their noise.
    Off,
}

/// `steradian denoise`.
#[derive(Args, Debug)]
#[command(
    after_help = "Layers of the picture guide it: steradian render SCENE --aov albedo,normal,depth,variance -o IN.exr"
)]
pub struct DenoiseArgs {
    /// Picture to read; an .exr has the layers that guide
    pub input: PathBuf,
    /// Output file (.exr .png .hdr .pfm .ppm .jpg .dds .ktx2). Repeatable. An .exr keeps all layers, and the noisy
    /// picture as the layer raw
    #[arg(short, long = "output", value_name = "OUT", required = true)]
    pub output: Vec<PathBuf>,
    /// Another render of the same view with as many samples and another --seed: each tells which pixels of the other to
    /// average, the result is the mean of both, and its error is estimated. Without it the layer halves of the input
    /// does so, where it has that
    #[arg(long, value_name = "OTHER.exr")]
    pub half: Option<PathBuf>,
    /// More removes more noise, and more detail [default: 1]
    #[arg(long, value_name = "S", value_parser = values::strength)]
    pub strength: Option<f32>,
    /// Denoiser [default: oidn where it is found or --oidn names it, else nlm]
    #[arg(long, value_name = "NAME", value_enum)]
    pub with: Option<Denoiser>,
    /// The library of Open Image Denoise 2, or a folder that has it: an archive of it, or where `pip install --target
    /// FOLDER pyoidn` put it. Its code runs as part of the program
    #[arg(long, value_name = "PATH")]
    pub oidn: Option<PathBuf>,
    /// Number of threads; 0 is one per processor. Does not change the picture
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u16).range(0..=MAX_THREADS as i64))]
    pub threads: u16,
    /// Files.
    #[command(flatten)]
    pub files: FileOptions,
}

/// `steradian view`.
#[derive(Args, Debug)]
#[command(after_help = "Examples: steradian view builtin:cornell-box, steradian view A.exr B.exr FOLDER\n\n\
                  The address that is printed holds a secret: who knows it may look at the scene, edit it, and save \
                  pictures into its folder. Of options, pictures take --tonemap, --exposure and those of the server.")]
pub struct ViewArgs {
    /// Scene file (.pbrt .pbrt.gz .xml .gltf .glb .usd .usda .usdc .usdz .mtlx .obj .ply .stl .bpt .steradian), or
    /// builtin:NAME; default: built-in Cornell box. Or finished pictures (.exr .pfm .hdr .png and others) and folders
    /// of them
    #[arg(value_name = "SCENE|PICTURE|FOLDER")]
    pub files: Vec<PathBuf>,
    /// Override the scene's integrator (`steradian list integrators`)
    #[arg(long, value_name = "NAME[:key=value,…]", value_parser = values::integrator)]
    pub integrator: Option<String>,
    /// Samples per pixel; 1k is 1000
    #[arg(long, value_name = "N", value_parser = values::spp, allow_hyphen_values = true)]
    pub spp: Option<u32>,
    /// Size of the frame in pixels; overrides the scene's
    #[arg(long, value_name = "WxH")]
    pub size: Option<Size>,
    /// Camera to begin with, by name or by number from 0; default: the first
    #[arg(long, value_name = "NAME|N")]
    pub camera: Option<String>,
    /// Camera position, a point it looks at, and the direction that is up, in the world; it keeps its lens
    #[arg(long, value_name = "EX,EY,EZ,TX,TY,TZ,UX,UY,UZ", value_parser = values::viewpoint)]
    #[arg(allow_hyphen_values = true)]
    pub look_at: Option<Viewpoint>,
    /// Colour arithmetic; auto is spectral for pbrt scenes and RGB for others
    #[arg(long, value_enum, default_value_t)]
    pub color: Color,
    /// Sampler (`steradian list samplers`); `scene` uses the one that the file names
    #[arg(long, value_name = "NAME", value_parser = sampler_names())]
    pub sampler: Option<String>,
    /// Random seed
    #[arg(long, value_name = "N")]
    pub seed: Option<u64>,
    /// Maximum number of scattering events of a path; -1 for no limit
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = clap::value_parser!(i64).range(-1..=i64::from(u32::MAX)))]
    pub max_depth: Option<i64>,
    /// Denoiser of the pictures, or off; default: the best there is, where noise can be removed
    #[arg(long, value_name = "NAME", value_enum, num_args = 0..=1, require_equals = true)]
    pub denoise: Option<Option<ViewDenoiser>>,
    /// Tone curve to begin with (`steradian list tones`); default: that of `render`
    #[arg(long, value_name = "NAME[:key=value,…]", value_parser = values::tone_text)]
    pub tonemap: Option<String>,
    /// Exposure to begin with in stops, -64 to 64, or auto; default: 0, and auto where a model or glTF scene would be
    /// white or black
    #[arg(long, value_name = "EV|auto", allow_negative_numbers = true)]
    pub exposure: Option<Exposure>,
    /// Set a $parameter of a Mitsuba scene, or a choice of a glTF scene or model, as `render` does. Repeatable
    #[arg(short = 'D', value_name = "NAME=VALUE", value_parser = values::definition)]
    pub define: Vec<(String, String)>,
    /// The library of Open Image Denoise 2, or a folder that has it, for pages that choose the denoiser oidn
    #[arg(long, value_name = "PATH")]
    pub oidn: Option<PathBuf>,
    /// Open the page in the browser
    #[arg(long)]
    pub open: bool,
    /// Port of the page; 0 is a free one
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub port: u16,
    /// Address of this machine to listen at; others than 127.0.0.1 let other machines in, without encryption
    #[arg(long, value_name = "ADDRESS", default_value = "127.0.0.1")]
    pub bind: String,
    /// Number of threads; 0 is one per processor
    #[arg(long, value_name = "N", default_value_t = 0)]
    #[arg(value_parser = clap::value_parser!(u16).range(0..=MAX_THREADS as i64))]
    pub threads: u16,
}

/// `steradian signal`.
#[derive(Args, Debug)]
pub struct SignalArgs {
    /// A picture
    pub input: PathBuf,
    /// Sample every N-th pixel
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = clap::value_parser!(u32).range(1..=4096))]
    pub step: u32,
    /// Filter before sampling
    #[arg(long, value_name = "NAME", default_value = "box", value_parser = PossibleValuesParser::new(Prefilter::ALL.map(|f| f.0)))]
    pub prefilter: String,
    /// Number of strongest waves to print
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub waves: u32,
    /// Drawing; may be repeated. A picture: the signal, its spectrum, the spectrum after sampling, the samples, and the
    /// samples after the prefilter. A .svg: a plot of the spectrum
    #[arg(short, long, value_name = "OUT")]
    pub output: Vec<PathBuf>,
    /// Print one line of JSON to stdout
    #[arg(long)]
    pub json: bool,
}
