//! The job of `steradian render`: what its command line asks for, found out before anything takes long.

use crate::{
    args::{Color, Denoiser, RenderArgs, SceneOptions},
    checkpoint::{check_state, unusable},
    denoise::{chosen, guides},
    failure::Failure,
    memory,
    open::{self, Ready},
    output, picture,
    terminal::Terminal,
    values::MAX_SPP,
};
use std::{
    borrow::Cow,
    path::{Path, PathBuf},
};
use steradian::{
    ColorMode, Inputs, Layer, Quality, Render, Scene, SensorNoise,
    engine::{Feature, Support},
    image::{FileKind, WriteOptions, tone::Tone},
    radiosity, resume,
    scene::Format,
    suited_mode,
};

/// The scene that is rendered when none is named.
const DEFAULT_SCENE: &str = "builtin:cornell-box";

/// Request of a render.
pub struct Job<'a> {
    pub args: &'a RenderArgs,
    pub terminal: Terminal,
    pub path: &'a Path,
    /// Name of the scene in messages.
    pub name: Cow<'a, str>,
    pub quality: Quality,
    pub denoiser: Option<Denoiser>,
    /// The file of a solution of radiosity.
    pub solution: Option<PathBuf>,
    /// The file of a state to go on from.
    pub state: Option<PathBuf>,
    pub outputs: Vec<PathBuf>,
    pub kinds: Vec<FileKind>,
}

/// A scene that is to be rendered, and what its state and solution are kept for.
pub struct OpenedScene {
    pub ready: Ready,
    pub write_options: WriteOptions,
    /// True for models and glTF scenes, whose lights have no brightness to rely on.
    pub is_model: bool,
    pub fingerprint: Option<[u8; 32]>,
    pub lit: Option<[u8; 32]>,
}

/// Plan of the render, with its number of samples.
pub struct Planned {
    pub render: Render,
    /// Samples per pixel in all, those of a kept render included.
    pub spp: u32,
    pub pixels: u64,
    /// Samples of all pixels.
    pub planned: u64,
}

impl<'a> Job<'a> {
    /// Everything that can be wrong with the command line is found before anything takes long.
    pub fn new(args: &'a RenderArgs, terminal: Terminal) -> Result<Self, Failure> {
        let path = args.scene.as_deref().unwrap_or(Path::new(DEFAULT_SCENE));
        let outputs = if args.output.is_empty() { output::default_names(path) } else { args.output.clone() };
        let kinds = outputs.iter().map(|o| output::kind(o)).collect::<Result<Vec<_>, _>>()?;
        let denoiser = denoiser(args);
        if args.oidn.is_some() && denoiser.is_some_and(|name| name != Denoiser::Oidn) {
            terminal.warn("--oidn has no effect: --denoise names another denoiser");
        }
        let quality = quality(args, denoiser);
        if !args.aov.is_empty() && !kinds.contains(&FileKind::Exr) {
            return Err(Failure::bad_input("layers (--aov) are kept by .exr files only; give one with -o"));
        }
        if args.temporal && denoiser != Some(Denoiser::Nlm) {
            return Err(Failure::bad_input("--temporal is of the denoiser nlm"));
        }
        if args.frames.is_none() && quality.layers.contains(&Layer::MOTION) {
            return Err(Failure::bad_input(
                "the layer 'motion' tells what has moved since the frame before: it takes --frames A..B",
            ));
        }
        args.files.write_options_or(Tone::default()).map_err(Failure::bad_input)?;
        let is_toned = args.files.tonemap.is_some() || args.files.exposure.is_some();
        if is_toned && !kinds.iter().any(|kind| kind.is_display()) {
            terminal.warn(
                "--tonemap and --exposure have no effect: no output (-o) has display values, as .png and .jpg have",
            );
        }
        let request = quality.request().map_err(|e| Failure::bad_input(e.to_string()))?;
        let solution = request.method.and_then(|method| method.file("solution"));
        if args.scene_options.format.is_none() && picture::kind(path).is_some() {
            let what =
                format!("'{}' is a picture, which `steradian info`, compare, convert and signal read", path.display());
            return Err(Failure::bad_input(format!(
                "{what}; render takes a scene, as in steradian render {DEFAULT_SCENE}"
            )));
        }
        let state = args.resume.as_deref().and_then(resume::source);
        let job =
            Self { args, terminal, path, name: open::shown(path), quality, denoiser, solution, state, outputs, kinds };
        output::claim(job.outputs.iter().chain(&job.kept()).map(PathBuf::as_path), &Inputs::of([path]))?;
        args.resume.as_deref().map_or(Ok(()), check_state)?;
        Ok(job)
    }

    /// Files that are read and written.
    fn kept(&self) -> Vec<PathBuf> {
        let states = self.args.resume.iter().flat_map(|state| {
            // A process that was killed as it saved may have left both as names of one file.
            let before = Some(resume::before(state)).filter(|b| Inputs::of([&**state]).find(b).is_none());
            [state.clone()].into_iter().chain(before)
        });
        states.chain(self.solution.clone()).collect()
    }

    /// True if no sample is to be taken: a picture of a kept render.
    pub fn takes_none(&self) -> bool {
        self.args.time.is_some_and(|time| time.is_zero())
    }

    pub fn open(&self) -> Result<OpenedScene, Failure> {
        let Self { args, path, .. } = self;
        open::limit_threads(args.scene_options.threads);
        let opened = open::open(path, &scene_options(args, path), self.quality.spp);
        let write_options = args.files.write_options_or(opened.tone()).map_err(Failure::bad_input)?;
        let write_options = WriteOptions { premultiplied: args.is_transparent(), ..write_options };
        let is_model = matches!(opened.desc.format, Format::Model | Format::Gltf);
        let unreadable = |e| Failure::failed(format!("cannot read the scene's files again: {e}"));
        let is_kept = args.resume.is_some() || args.is_of_job;
        let fingerprint = is_kept.then(|| resume::fingerprint(&opened.desc)).transpose();
        let fingerprint = fingerprint.map_err(unreadable)?;
        let lit = self.solution.as_ref().map(|_| radiosity::fingerprint(&opened.desc)).transpose();
        let lit = lit.map_err(unreadable)?;
        let ready = open::ready(opened, path, args.scene_options.strict, self.terminal)?;
        Ok(OpenedScene { ready, write_options, is_model, fingerprint, lit })
    }

    /// Finds names for pictures that nothing is read from.
    pub fn place_outputs(&mut self, Ready { scene, inputs, .. }: &Ready) -> Result<(), Failure> {
        if self.args.output.is_empty() {
            let free = output::free_names(self.outputs.clone(), inputs);
            if free != self.outputs {
                let read = self.outputs.iter().find(|o| inputs.find(o).is_some()).unwrap_or(&self.outputs[0]);
                let free = output::listed(&free);
                self.terminal.say(&format!("the scene reads '{}': the picture goes to {free}", read.display()));
            }
            self.outputs = free;
        }
        let partial: Vec<PathBuf> = self.outputs.iter().map(|output| output::partial(output)).collect();
        output::claim(self.outputs.iter().chain(&partial).chain(&self.kept()).map(PathBuf::as_path), inputs)?;
        let size = (scene.film().crop.width(), scene.film().crop.height());
        self.outputs.iter().zip(&self.kinds).try_for_each(|(path, kind)| output::check_size(path, *kind, size))
    }

    /// Plans the render; tells what is left out.
    pub fn plan(&self, scene: &Scene) -> Result<Planned, Failure> {
        let Self { args, terminal, quality, .. } = self;
        let mut render = quality.render(scene).map_err(|e| Failure::bad_input(e.to_string()))?;
        if args.denoise.is_some()
            && let Some(why) = render.not_denoisable(scene)
        {
            let name = render.name;
            return Err(Failure::bad_input(format!("--denoise is not for '{name}' here: {why}")));
        }
        check_memory(scene, render.film_bytes(scene, quality.layers.len()))?;
        let integrator = render.name;
        if let Some(choice) = &render.choice {
            terminal.say(&format!("chose '{integrator}'; {choice}"));
        }
        if let Some((own, why)) = &render.replaced {
            terminal
                .warn(&format!("the scene's integrator '{own}' is not used, since {why}; '{integrator}' renders it"));
        }
        if let Some(left_out) = render.left_out(scene) {
            terminal.warn(&left_out.of(integrator));
        }
        let plan = &mut render.plan;
        if args.sampler.is_some() && render.method.supports(Feature::Samplers) != Support::Exact {
            terminal.warn(&format!("--sampler has no effect: '{integrator}' spreads samples in a way of its own"));
        }
        let crop = &scene.film().crop;
        let pixels = u64::from(crop.width()) * u64::from(crop.height());
        let spp = plan.sampler.spp;
        if let Some(state) = &self.state {
            // What was planned first counts for the bits; the rest comes on top.
            let first = resume::samples(state).map_err(|e| unusable(state, &e))?;
            plan.sampler.spp = if self.takes_none() { first } else { first.min(spp) };
        } else if self.takes_none() {
            return Err(Failure::bad_input(
                "--time 0 takes no samples: it makes a picture of what --resume FILE keeps",
            ));
        }
        if plan.adaptive && (crop.width(), crop.height()) != (scene.film().width, scene.film().height) {
            terminal.say(
                "note: with --adaptive a --crop is sampled by its own needs, so it is not bit for bit the part of the \
                 whole picture",
            );
        }
        Ok(Planned { render, spp, pixels, planned: pixels * u64::from(spp) })
    }
}

/// Options of opening the scene: in the colours that suit the integrator, unless others are asked for.
fn scene_options(args: &RenderArgs, path: &Path) -> SceneOptions {
    let mut options = args.scene_options.clone();
    let suited = args.integrator.as_deref().and_then(suited_mode);
    if let (Some(ColorMode::Rgb), Color::Auto) = (suited, options.color) {
        options.color = Color::Rgb;
    }
    options.sensor_noise = SensorNoise::OfFrame(args.frame);
    // The ground that models get is part of what is left out behind them.
    let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
    let is_model = ["obj", "ply", "stl", "bpt", "gltf", "glb", "usd", "usda", "usdc", "usdz", "mtlx"]
        .iter()
        .any(|known| extension == *known);
    if args.is_transparent() && is_model && !options.define.iter().any(|d| d.0 == "ground") {
        options.define.push(("ground".into(), "false".into()));
    }
    options
}

/// The denoiser that is asked for.
fn denoiser(args: &RenderArgs) -> Option<Denoiser> {
    let has_halves = args.aov.iter().any(|layers| layers.0.contains(&Layer::HALVES));
    args.denoise.map(|name| chosen(name, args.oidn.as_deref(), !args.temporal && !has_halves))
}

/// Quality from the command line.
fn quality(args: &RenderArgs, denoiser: Option<Denoiser>) -> Quality {
    let mut layers: Vec<Layer> = Vec::new();
    for &layer in args.aov.iter().flat_map(|l| &l.0) {
        if !layers.contains(&layer) {
            layers.push(layer);
        }
    }
    let needed = args.is_transparent().then_some(Layer::ALPHA).into_iter();
    let needed = needed.chain(args.temporal.then_some(Layer::MOTION));
    let is_oidn = denoiser == Some(Denoiser::Oidn);
    for layer in needed.chain(guides(is_oidn).iter().copied().filter(|_| args.denoise.is_some())) {
        if !layers.contains(&layer) {
            layers.push(layer);
        }
    }
    Quality {
        integrator: args.integrator.clone(),
        // Time or error alone end the render where they are all that is asked for.
        spp: args.spp.or((args.time.is_some() || args.error.is_some()).then_some(MAX_SPP)),
        adaptive: args.adaptive,
        error: args.error,
        seed: args.seed,
        threads: usize::from(args.scene_options.threads),
        max_depth: args.max_depth.map(|d| u32::try_from(d).unwrap_or(u32::MAX)),
        sampler: args.sampler.clone(),
        layers,
        transparent: args.is_transparent(),
        independent: args.denoise.is_some(),
    }
}

/// Refuses films that would not fit into memory, before the system ends the process for it.
pub fn check_memory(scene: &Scene, needed: u64) -> Result<(), Failure> {
    match memory::available() {
        Some(available) if needed > available => Err(Failure::bad_input(format!(
            "a picture of {} x {} pixels needs about {} of memory, and {} are there; a smaller --size or a --crop helps",
            scene.film().crop.width(),
            scene.film().crop.height(),
            memory::readable(needed),
            memory::readable(available),
        ))),
        _ => Ok(()),
    }
}
