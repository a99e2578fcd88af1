//! `steradian render`: from a scene to pictures.

use crate::{
    args::{Color, Denoiser, RenderArgs, SceneOptions},
    brightness,
    denoise::{self, Filter, guides},
    diagnostics::Counts,
    failure::{self, Failure, Outcome},
    memory,
    open::{self, Ready},
    output::{self, Provenance},
    picture,
    progress::Progress,
    report::{self, Report},
    signals::{self, Signals},
    solving,
    terminal::{self, Terminal},
    values::MAX_SPP,
    watch::{self, Due, Stop},
};
use std::{
    borrow::Cow,
    collections::BTreeMap,
    path::{Path, PathBuf},
    time::{Duration, Instant},
};
use steradian::{
    ColorMode, History, Inputs, Layer, LeftOut, Quality, Render, Scene, SensorNoise, Session,
    denoise::{Outcome as Denoised, Sequence},
    engine::{Feature, Support},
    film::LayerInputs,
    image::{FileKind, Image, WriteOptions},
    integrators::{Doubt, SCALES},
    radiosity,
    resume::{self, Recipe, StateError},
    suited_mode,
};

/// The scene that is rendered when none is named.
const DEFAULT_SCENE: &str = "builtin:cornell-box";

/// Renders, saves, reports.
pub fn run(args: &RenderArgs, terminal: Terminal) -> Outcome {
    run_after(args, terminal, &mut Before::default())
}

/// State that a picture of a sequence leaves to the next one.
#[derive(Debug, Default)]
pub struct Before {
    /// History of its method.
    history: Option<History>,
    /// State of its denoiser, and the number of frames that this has seen.
    denoiser: Option<(Sequence, u64)>,
}

impl Before {
    /// Begins a picture, which is to be denoised with those before where it `is_temporal`: their noise is to differ.
    fn begin(&mut self, is_temporal: bool, render: &mut Render) {
        if is_temporal {
            let (_, frames) = self.denoiser.get_or_insert_default();
            render.plan.sampler.seed = render.plan.sampler.seed.wrapping_add(*frames);
        }
    }

    /// A picture without its noise, by a filter, or with what is known of those before.
    fn denoised(&mut self, noisy: &Image, filter: &Filter) -> Result<Denoised, steradian::Error> {
        match &mut self.denoiser {
            Some((sequence, frames)) => {
                *frames += 1;
                sequence.picture(noisy)
            }
            None => filter.picture(noisy, None),
        }
    }
}

/// As [`run`], after another picture of a sequence; `before` is what that left, and then what this one leaves.
pub fn run_after(args: &RenderArgs, terminal: Terminal, before: &mut Before) -> Outcome {
    let mut job = Job::new(args, terminal)?;
    let Opening { ready, write_options, fingerprint, lit } = job.open()?;
    let scene = &ready.scene;
    job.place_outputs(&ready)?;
    let Planned { mut render, spp, pixels, planned } = job.plan(scene)?;
    let filter = |name| Filter::new(name, args.oidn.as_deref(), 1.0, args.scene_options.threads);
    let filter = args.denoise.map(filter).transpose()?;
    before.begin(args.temporal, &mut render);
    let integrator = render.name;
    let signals = Signals::watch();
    let (width, height) = (scene.film().crop.width(), scene.film().crop.height());
    terminal.say(&format!("rendering {} with {integrator}, {width} x {height}", job.name));
    let solution = job.solution.as_deref().zip(lit);
    let (mut session, effort) = solving::session(scene, &render, solution, &signals, terminal)?;
    before.history.iter().for_each(|history| session.follow(history));
    let keeper = args.resume.as_deref().zip(fingerprint).map(|(path, fingerprint)| {
        let options = open::compile_options(&args.scene_options, job.quality.spp);
        Keeper { path, recipe: Recipe::new(scene, fingerprint, &options, &render), terminal }
    });
    if let Some(keeper) = &keeper {
        keeper.restore(&mut *session, pixels, (!job.takes_none()).then_some(spp))?;
    }
    let color = if scene.mode() == ColorMode::Spectral { "spectral" } else { "rgb" };
    let (name, seed, layers) = (&*job.name, render.plan.sampler.seed, &job.quality.layers);
    let making = Making { scene, name, integrator, color, seed, layers };
    let on_the_way = |session: &mut dyn Session, due: Due| {
        if let Some(keeper) = keeper.as_ref().filter(|_| due.state) {
            keeper.keep(session);
        }
        if due.picture && session.counters().samples > 0 {
            let Made { picture, empty_pixels, .. } = making.picture(session);
            match output::save(&job.outputs, &picture, &write_options, empty_pixels == 0) {
                Ok(written) => terminal.say(&format!("wrote {} on the way", output::listed(&written))),
                Err(failure) => terminal.warn(&failure.message),
            }
        }
    };
    let limits = (args.time, args.watch);
    let progress = || Progress::new(terminal);
    let stop = match job.takes_none() {
        true => None,
        false => watch::render(&mut *session, (pixels, planned), limits, &signals, progress, on_the_way),
    };
    // Before the picture, which may fail to be saved for reasons of its own.
    let kept = keeper.as_ref().map_or(Ok(()), |keeper| keeper.save(&mut *session));
    if let Some(why) = session.failure() {
        return Err(Failure::failed(why));
    }
    if scene.texture_pages().as_ref().is_some_and(|pages| pages.has_failed()) {
        terminal.warn("some textures could not be read back from the temporary file; they are black in places");
    }
    if session.counters().samples == 0 {
        // Nothing that would be worth an older picture.
        kept.map_err(Failure::failed)?;
        return without_a_sample(stop, terminal);
    }
    let saving = Instant::now();
    let mut made = making.picture(&*session);
    if render.plan.has(LayerInputs::HALVES) && !made.has_halves() {
        terminal.warn("the layer 'halves' is left out: it takes two samples of each pixel or more");
    }
    filter.as_ref().map_or(Ok(()), |filter| made.denoise(filter, before, terminal))?;
    let written =
        output::save(&job.outputs, &made.picture, &write_options, made.empty_pixels == 0).map_err(|mut failure| {
            if let (Some(keeper), Ok(())) = (&keeper, &kept) {
                let path = keeper.path.display();
                failure.message += &format!("\nthe render is kept in '{path}': the same command goes on from it");
            }
            failure
        })?;
    output::clamped(&written, &made.picture, &write_options).iter().for_each(|cut| terminal.warn(cut));
    before.history = session.take_history();
    let missing_light = steradian::missing_light(&render, scene, &session.film());
    let times = [ready.load, ready.build, saving.elapsed()];
    let mut report = making.report(&*session, &made, times, stop);
    (report.missing_light, report.outputs, report.diagnostics) = (missing_light, &written, ready.counts);
    effort.add_to(&mut report.render_seconds, &mut report.rays);
    session.notes().iter().for_each(|note| terminal.say(note));
    tell(&report, stop, terminal);
    kept.map_err(Failure::failed)?;
    if let (Some(keeper), Some(_)) = (&keeper, stop) {
        terminal.say(&format!("the same command goes on from {}", keeper.path.display()));
    }
    if written != job.outputs {
        let outputs = output::listed(&job.outputs);
        terminal.warn(&format!("{outputs} stays as it was, for this picture is not whole"));
    }
    terminal.say(&format!("wrote {}", output::listed(&written)));
    if let Some(hint) = brightness::hint(&made.picture, &written, args.files.exposure) {
        terminal.say(&hint);
    }
    if args.json {
        terminal::json(&report)?;
    }
    Ok(match stop {
        Some(Stop::Signal(signal)) => 128 + signal,
        _ => failure::DONE,
    })
}

/// Outcome of a render that has no sample.
fn without_a_sample(stop: Option<Stop>, terminal: Terminal) -> Outcome {
    match stop {
        Some(Stop::Signal(signal)) => {
            let name = signals::name(signal);
            terminal.warn(&format!("stopped by {name} before the first sample: no picture was written"));
            Ok(128 + signal)
        }
        _ => Err(Failure::failed("the time was up before the first sample: no picture was written")),
    }
}

/// Request of a render.
struct Job<'a> {
    args: &'a RenderArgs,
    terminal: Terminal,
    path: &'a Path,
    /// Name of the scene in messages.
    name: Cow<'a, str>,
    quality: Quality,
    /// The file of a solution of radiosity.
    solution: Option<PathBuf>,
    outputs: Vec<PathBuf>,
    kinds: Vec<FileKind>,
}

/// A scene that is to be rendered, and what its state and solution are kept for.
struct Opening {
    ready: Ready,
    write_options: WriteOptions,
    fingerprint: Option<[u8; 32]>,
    lit: Option<[u8; 32]>,
}

/// Plan of the render, with its number of samples.
struct Planned {
    render: Render,
    /// Samples per pixel in all, those of a kept render included.
    spp: u32,
    pixels: u64,
    /// Samples of all pixels.
    planned: u64,
}

impl<'a> Job<'a> {
    /// Everything that can be wrong with the command line is found before anything takes long.
    fn new(args: &'a RenderArgs, terminal: Terminal) -> Result<Self, Failure> {
        let path = args.scene.as_deref().unwrap_or(Path::new(DEFAULT_SCENE));
        let outputs = if args.output.is_empty() { output::default_names(path) } else { args.output.clone() };
        let kinds = outputs.iter().map(|o| output::kind(o)).collect::<Result<Vec<_>, _>>()?;
        let quality = quality(args);
        if !args.aov.is_empty() && !kinds.contains(&FileKind::Exr) {
            return Err(Failure::bad_input("layers (--aov) are kept by .exr files only; give one with -o"));
        }
        let is_nlm = matches!(args.denoise, Some(None | Some(Denoiser::Nlm))) && args.oidn.is_none();
        if args.temporal && !is_nlm {
            return Err(Failure::bad_input("--temporal is of the denoiser nlm"));
        }
        if args.frames.is_none() && quality.layers.contains(&Layer::MOTION) {
            return Err(Failure::bad_input(
                "the layer 'motion' tells what has moved since the frame before: it takes --frames A..B",
            ));
        }
        args.files.write_options().map_err(Failure::bad_input)?;
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
        let job = Self { args, terminal, path, name: open::shown(path), quality, solution, outputs, kinds };
        output::claim(job.outputs.iter().map(PathBuf::as_path).chain(job.kept()), &Inputs::of([path]))?;
        args.resume.as_deref().map_or(Ok(()), check_state)?;
        Ok(job)
    }

    /// Files that are read and written.
    fn kept(&self) -> impl Iterator<Item = &Path> {
        self.args.resume.iter().chain(&self.solution).map(PathBuf::as_path)
    }

    /// True if no sample is to be taken: a picture of a kept render.
    fn takes_none(&self) -> bool {
        self.args.time.is_some_and(|time| time.is_zero())
    }

    fn open(&self) -> Result<Opening, Failure> {
        let Self { args, path, .. } = self;
        open::limit_threads(args.scene_options.threads);
        let opened = open::open(path, &scene_options(args), self.quality.spp);
        let write_options = args.files.write_options_or(opened.tone()).map_err(Failure::bad_input)?;
        let write_options = WriteOptions { premultiplied: args.transparent, ..write_options };
        let unreadable = |e| Failure::failed(format!("cannot read the scene's files again: {e}"));
        let fingerprint = args.resume.as_ref().map(|_| resume::fingerprint(&opened.desc)).transpose();
        let fingerprint = fingerprint.map_err(unreadable)?;
        let lit = self.solution.as_ref().map(|_| radiosity::fingerprint(&opened.desc)).transpose();
        let lit = lit.map_err(unreadable)?;
        let ready = open::ready(opened, path, args.scene_options.strict, self.terminal)?;
        Ok(Opening { ready, write_options, fingerprint, lit })
    }

    /// Finds names for pictures that nothing is read from.
    fn place_outputs(&mut self, Ready { scene, inputs, .. }: &Ready) -> Result<(), Failure> {
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
        output::claim(self.outputs.iter().chain(&partial).map(PathBuf::as_path).chain(self.kept()), inputs)?;
        let size = (scene.film().crop.width(), scene.film().crop.height());
        self.outputs.iter().zip(&self.kinds).try_for_each(|(path, kind)| output::check_size(path, *kind, size))
    }

    /// Plans the render; tells what is left out.
    fn plan(&self, scene: &Scene) -> Result<Planned, Failure> {
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
        if let Some(LeftOut { what, instead }) = &render.replaced {
            terminal.warn(&format!("the scene's integrator '{instead}' cannot do {what}; '{integrator}' renders it"));
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
        if let Some(state) = args.resume.as_deref().filter(|state| state.exists()) {
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
fn scene_options(args: &RenderArgs) -> SceneOptions {
    let mut options = args.scene_options.clone();
    let suited = args.integrator.as_deref().and_then(suited_mode);
    if let (Some(ColorMode::Rgb), Color::Auto) = (suited, options.color) {
        options.color = Color::Rgb;
    }
    options.sensor_noise = SensorNoise::OfFrame(args.frame);
    options
}

/// Metadata of a picture beside those that its session knows.
struct Making<'a> {
    scene: &'a Scene,
    name: &'a str,
    integrator: &'a str,
    color: &'static str,
    seed: u64,
    layers: &'a [Layer],
}

/// A picture with its metadata.
struct Made {
    picture: Image,
    /// Pixels without a sample.
    empty_pixels: u64,
    /// Mean samples per pixel.
    spp: f64,
    error: Option<f64>,
    doubt: Option<Doubt>,
    /// Error that remains where the picture was denoised.
    denoised_error: Option<f64>,
    /// By the edges of squares.
    of_means: Option<BTreeMap<u32, f64>>,
}

impl Made {
    /// True if it has the layer of halves: each pixel has a sample in both.
    fn has_halves(&self) -> bool {
        self.picture.channel(&format!("{}.R", Layer::HALVES.prefix())).is_some()
    }

    /// Removes the noise, and says how long that took and how much error remains.
    fn denoise(&mut self, filter: &Filter, before: &mut Before, terminal: Terminal) -> Result<(), Failure> {
        let start = Instant::now();
        let denoised = before.denoised(&self.picture, filter).map_err(|e| Failure::failed(e.to_string()))?;
        filter.tell(start.elapsed().as_secs_f64(), terminal);
        denoise::tell_error(denoised.error, terminal);
        (self.picture, self.denoised_error) = (denoised.picture, denoised.error);
        Ok(())
    }
}

impl Making<'_> {
    /// The picture as it is.
    fn picture(&self, session: &dyn Session) -> Made {
        let film = session.film();
        let mut picture = steradian::develop(self.scene, &film, self.layers);
        let empty_pixels = film.pixels.iter().filter(|p| p.samples == 0).count() as u64;
        let done = session.counters();
        let spp = done.samples as f64 / film.pixels.len().max(1) as f64;
        drop(film);
        let (error, doubt) = (session.error(), session.doubt());
        let of_means = session.errors_of_means().map(|errors| SCALES.into_iter().zip(errors).collect());
        let provenance = Provenance {
            scene: self.name,
            integrator: self.integrator,
            spp,
            seed: self.seed,
            seconds: session.wall().as_secs_f64(),
            nonfinite: done.nonfinite,
            color: self.color,
            error,
            doubt,
            adaptive: session.is_uneven(),
            caustics: session.asks_photons(),
            sharing: session.sharing(),
            of_means: of_means.as_ref(),
        };
        output::label(&mut picture, self.scene, &provenance);
        Made { picture, empty_pixels, spp, error, doubt, denoised_error: None, of_means }
    }

    /// The summary of a session, by the times of loading, building and saving; what else is known of the scene is left
    /// empty.
    fn report(
        &self,
        session: &dyn Session,
        made: &Made,
        [load, build, save]: [Duration; 3],
        stop: Option<Stop>,
    ) -> Report<'_> {
        let (done, crop) = (session.counters(), &self.scene.film().crop);
        Report {
            schema: 1,
            software: concat!("Steradian ", env!("CARGO_PKG_VERSION")),
            scene: self.name,
            integrator: self.integrator,
            color: self.color,
            seed: self.seed,
            spp: report::number(made.spp),
            adaptive: session.is_uneven(),
            caustics: session.asks_photons(),
            sharing: session.sharing(),
            relative_error: made.error,
            unreliable: made.doubt.map(|d| d.to_string()),
            relative_error_of_means: made.of_means.clone(),
            denoised_relative_error: made.denoised_error,
            missing_light: None,
            width: crop.width(),
            height: crop.height(),
            threads: session.threads(),
            samples: done.samples,
            rays: done.rays,
            load_seconds: load.as_secs_f64(),
            build_seconds: build.as_secs_f64(),
            render_seconds: session.wall().as_secs_f64(),
            cpu_seconds: session.cpu().as_secs_f64(),
            save_seconds: save.as_secs_f64(),
            peak_rss_bytes: memory::peak(),
            nonfinite_dropped: done.nonfinite,
            empty_pixels: made.empty_pixels,
            stopped: stop.map(|s| match s {
                Stop::Time => "time",
                Stop::Error => "error",
                Stop::Signal(signal) => signals::name(signal),
            }),
            outputs: &[],
            diagnostics: Counts::default(),
        }
    }
}

/// Refuses what a render cannot be kept in.
fn check_state(state: &Path) -> Result<(), Failure> {
    // To open a pipe waits for someone to write.
    match std::fs::metadata(state) {
        Ok(there) if !there.is_file() => {
            let why = "it is not a regular file, and a render cannot be kept in it";
            Err(Failure::bad_input(format!("--resume '{}': {why}", state.display())))
        }
        _ => Ok(()),
    }
}

fn unusable(state: &Path, why: &StateError) -> Failure {
    Failure::bad_input(format!("{} {why}; without that file the render begins anew", state.display()))
}

/// Keeps a session in a file.
struct Keeper<'a> {
    path: &'a Path,
    recipe: Recipe,
    terminal: Terminal,
}

impl Keeper<'_> {
    /// Lets a session go on from the file, if it is there, to `total` samples per pixel.
    fn restore(&self, session: &mut dyn Session, pixels: u64, total: Option<u32>) -> Result<(), Failure> {
        if !self.path.exists() {
            return Ok(());
        }
        self.recipe.restore(session, self.path).map_err(|e| unusable(self.path, &e))?;
        if let Some(spp) = total.filter(|spp| !session.extend(*spp)) {
            let why = format!("was to have more than {spp} samples per pixel");
            return Err(unusable(self.path, &StateError::OtherSettings(why)));
        }
        let spp = session.counters().samples as f64 / pixels as f64;
        self.terminal.say(&format!("going on from {} at {spp:.1} samples per pixel", self.path.display()));
        Ok(())
    }

    fn save(&self, session: &mut dyn Session) -> Result<(), String> {
        self.recipe.save(session, self.path).map_err(|e| format!("the render cannot be kept: {e}"))
    }

    /// Saves on the way: what fails now may go well later.
    fn keep(&self, session: &mut dyn Session) {
        if let Err(message) = self.save(session) {
            self.terminal.warn(&message);
        }
    }
}

/// Quality from the command line.
fn quality(args: &RenderArgs) -> Quality {
    let mut layers: Vec<Layer> = Vec::new();
    for &layer in args.aov.iter().flat_map(|l| &l.0) {
        if !layers.contains(&layer) {
            layers.push(layer);
        }
    }
    let needed = args.transparent.then_some(Layer::ALPHA).into_iter();
    let needed = needed.chain(args.temporal.then_some(Layer::MOTION));
    let is_oidn = args.oidn.is_some() || args.denoise == Some(Some(Denoiser::Oidn));
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
        transparent: args.transparent,
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

/// The summary and what is remarkable about it.
pub fn tell(report: &Report<'_>, stop: Option<Stop>, terminal: Terminal) {
    terminal.say(&report.line());
    match stop {
        Some(Stop::Signal(signal)) => {
            terminal.warn(&format!("stopped by {}: what there is was saved", signals::name(signal)))
        }
        Some(Stop::Time) => terminal.say("stopped when the time was up"),
        Some(Stop::Error) => {
            let error = report.relative_error.unwrap_or_default();
            terminal.say(&format!("stopped at an estimated relative error of {:.3} %", 100.0 * error))
        }
        None => {}
    }
    if let Some(doubt) = &report.unreliable {
        terminal.warn(&format!("the estimated error is unreliable: {doubt}"));
    }
    if let Some(share) = report.missing_light {
        terminal.warn(&format!(
            "about {:.0} % of the light is missing: '{}' finds no caustics of lights without size, as 'bdpt', 'vcm', 'sppm' and 'photon' do",
            100.0 * share,
            report.integrator
        ));
    }
    if report.empty_pixels > 0 {
        terminal.warn(&format!("{} pixels have no sample yet and are black", report.empty_pixels));
    }
    if report.nonfinite_dropped > 0 {
        terminal.warn(&format!(
            "{} of {} samples were not finite and count as black",
            report.nonfinite_dropped, report.samples
        ));
    }
}
