//! `steradian render`: from a scene to pictures.

use crate::{
    args::RenderArgs,
    brightness,
    checkpoint::Checkpoint,
    denoise::Filter,
    estimate,
    failure::{self, Failure, Outcome},
    job::{Job, OpenedScene, Planned},
    open::{self, Ready},
    output,
    progress::Progress,
    rendered::{ImageMaker, RenderedImage},
    report::Report,
    sequence_state::SequenceState,
    signals::{self, Signals},
    solving::{self, Effort},
    terminal::{self, Terminal},
    watch::{self, Due, Stop},
};
use std::time::Instant;
use steradian::{ColorMode, Session, film::LayerInputs, image::WriteOptions, resume::Recipe};

/// Renders, saves, reports.
pub fn run(args: &RenderArgs, terminal: Terminal) -> Outcome {
    run_after(args, terminal, &mut SequenceState::default())
}

/// As [`run`], after another picture of a sequence; `before` is what that left, and then what this one leaves.
pub fn run_after(args: &RenderArgs, terminal: Terminal, before: &mut SequenceState) -> Outcome {
    let (started, mut session) = Started::new(args, terminal, before)?;
    started.tell();
    if args.estimate {
        return estimate::tell(&started.job, &started.planned, &started.ready, &started.signals, session);
    }
    let checkpoint = args.resume.as_deref().zip(started.recipe.clone());
    let checkpoint = checkpoint.map(|(path, recipe)| Checkpoint { path, recipe, terminal });
    let Planned { spp, pixels, planned, .. } = started.planned;
    let takes_none = started.job.takes_none();
    if let (Some(checkpoint), Some(state)) = (&checkpoint, &started.job.state) {
        checkpoint.restore(&mut *session, state, (pixels, (!takes_none).then_some(spp)))?;
    }
    let making = started.making();
    let on_the_way = |session: &mut dyn Session, due: Due| {
        if let Some(checkpoint) = checkpoint.as_ref().filter(|_| due.state) {
            checkpoint.keep(session);
        }
        if due.picture && session.counters().samples > 0 {
            let RenderedImage { picture, empty_pixels, .. } = making.picture(session);
            let mut options = started.write_options.clone();
            brightness::expose(&mut options, started.exposure(&picture), None);
            match output::save(&started.job.outputs, &picture, &options, empty_pixels == 0) {
                Ok(written) => terminal.say(&format!("wrote {} on the way", output::listed(&written))),
                Err(failure) => terminal.warn(&failure.message),
            }
        }
    };
    let limits = (args.time, args.watch);
    let progress = || Progress::new(terminal);
    let stop = match takes_none {
        true => None,
        false => watch::render(&mut *session, (pixels, planned), limits, &started.signals, progress, on_the_way),
    };
    started.finish(session, stop, checkpoint.as_ref(), before)
}

/// A render that is ready to take samples, or to be given those that others took.
pub struct Started<'a> {
    pub job: Job<'a>,
    pub ready: Ready,
    pub write_options: WriteOptions,
    is_model: bool,
    pub planned: Planned,
    filter: Option<Filter>,
    pub signals: Signals,
    effort: Effort,
    /// Recipe of its state, where one is kept.
    pub recipe: Option<Recipe>,
}

impl<'a> Started<'a> {
    /// Opens the scene and plans its render, after another picture of a sequence.
    pub fn new(
        args: &'a RenderArgs,
        terminal: Terminal,
        before: &mut SequenceState,
    ) -> Result<(Self, Box<dyn Session>), Failure> {
        let mut job = Job::new(args, terminal)?;
        let OpenedScene { ready, write_options, is_model, fingerprint, lit } = job.open()?;
        let scene = &ready.scene;
        job.place_outputs(&ready)?;
        let mut planned = job.plan(scene)?;
        let filter = |name| Filter::new(name, args.oidn.as_deref(), 1.0, args.scene_options.threads);
        let filter = job.denoiser.map(filter).transpose()?;
        let render = &mut planned.render;
        before.begin(args.temporal, render);
        let signals = Signals::watch();
        let solution = job.solution.as_deref().zip(lit);
        let (mut session, effort) = solving::session(scene, render, solution, &signals, terminal)?;
        before.history.iter().for_each(|history| session.follow(history));
        let recipe = fingerprint.map(|fingerprint| {
            let options = open::compile_options(&args.scene_options, job.quality.spp);
            Recipe::new(scene, fingerprint, &options, render)
        });
        Ok((Self { job, ready, write_options, is_model, planned, filter, signals, effort, recipe }, session))
    }

    /// Tells what is rendered.
    pub fn tell(&self) {
        let (crop, integrator) = (&self.ready.scene.film().crop, self.planned.render.name);
        let (width, height) = (crop.width(), crop.height());
        self.job.terminal.say(&format!("rendering {} with {integrator}, {width} x {height}", self.job.name));
    }

    /// Exposure of a picture in stops, and its reason.
    fn exposure(&self, picture: &steradian::image::Image) -> (f32, &'static str) {
        brightness::automatic(picture, &self.job.outputs, self.job.args.files.exposure, self.is_model)
    }

    fn making(&self) -> ImageMaker<'_> {
        let (scene, render) = (&self.ready.scene, &self.planned.render);
        let color = if scene.mode() == ColorMode::Spectral { "spectral" } else { "rgb" };
        let (name, integrator, seed) = (&*self.job.name, render.name, render.plan.sampler.seed);
        ImageMaker { scene, name, integrator, color, seed, layers: &self.job.quality.layers }
    }

    /// Keeps the state, writes the pictures, and reports.
    pub fn finish(
        self,
        mut session: Box<dyn Session>,
        stop: Option<Stop>,
        checkpoint: Option<&Checkpoint<'_>>,
        before: &mut SequenceState,
    ) -> Outcome {
        let (args, terminal) = (self.job.args, self.job.terminal);
        // The picture may fail to be saved for reasons of its own.
        let kept = checkpoint.map_or(Ok(()), |checkpoint| checkpoint.save(&mut *session));
        if let Some(why) = session.failure() {
            return Err(Failure::failed(why));
        }
        if self.ready.scene.texture_pages().as_ref().is_some_and(|pages| pages.has_failed()) {
            terminal.warn("some textures could not be read back from the temporary file; they are black in places");
        }
        if session.counters().samples == 0 {
            // Nothing that would be worth an older picture.
            kept.map_err(Failure::failed)?;
            return without_a_sample(stop, terminal);
        }
        let saving = Instant::now();
        let making = self.making();
        let mut made = making.picture(&*session);
        if self.planned.render.plan.has(LayerInputs::HALVES) && !made.has_halves() {
            terminal.warn("the layer 'halves' is left out: it takes two samples of each pixel or more");
        }
        // A picture that cannot be denoised is worth writing as it is.
        let noisy = self.filter.as_ref().and_then(|filter| made.denoise(filter, before, terminal).err());
        let outputs = &self.job.outputs;
        // Pictures of a sequence have one exposure, that of the first.
        let exposure = *before.exposure.get_or_insert_with(|| self.exposure(&made.picture));
        let mut options = self.write_options.clone();
        brightness::expose(&mut options, exposure, Some(terminal));
        let options = &options;
        let written =
            output::save(outputs, &made.picture, options, made.empty_pixels == 0).map_err(|mut failure| {
                match (checkpoint, &kept) {
                    (_, Err(why)) => failure.message += &format!("\n{why}"),
                    (Some(checkpoint), Ok(())) => {
                        let path = checkpoint.path.display();
                        failure.message +=
                            &format!("\nthe render is kept in '{path}': the same command goes on from it");
                    }
                    (None, Ok(())) => {}
                }
                failure
            })?;
        output::clamped(&written, &made.picture, options).iter().for_each(|cut| terminal.warn(cut));
        let missing_light = steradian::missing_light(&self.planned.render, &self.ready.scene, &session.film());
        let times = [self.ready.load, self.ready.build, saving.elapsed()];
        let mut report = making.report(&*session, &made, times, stop);
        (report.missing_light, report.outputs, report.diagnostics) = (missing_light, &written, self.ready.counts);
        self.effort.add_to(&mut report.render_seconds, &mut report.rays);
        session.notes().iter().for_each(|note| terminal.say(note));
        tell(&report, stop, brightness::is_black(&made.picture), terminal);
        kept.map_err(Failure::failed)?;
        if let (Some(checkpoint), Some(_)) = (checkpoint, stop) {
            terminal.say(&format!("the same command goes on from {}", checkpoint.path.display()));
        }
        if written != *outputs {
            let outputs = output::listed(outputs);
            terminal.warn(&format!("{outputs} stays as it was, for this picture is not whole"));
        }
        terminal.say(&format!("wrote {}", output::listed(&written)));
        let is_exposed = exposure.0 != 0.0;
        if let Some(hint) = brightness::hint(&made.picture, &written, args.files.exposure).filter(|_| !is_exposed) {
            terminal.say(&hint);
        }
        if args.json {
            terminal::json(&report)?;
        }
        before.history = session.take_history();
        if let Some(failure) = noisy {
            let message = format!("{}\nthe picture is not denoised", failure.message);
            return Err(Failure { message, ..failure });
        }
        Ok(match stop {
            Some(Stop::Signal(signal)) => 128 + signal,
            _ => failure::DONE,
        })
    }
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

/// The summary and what is remarkable about it.
pub fn tell(report: &Report<'_>, stop: Option<Stop>, is_black: bool, terminal: Terminal) {
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
    if is_black && report.integrator == "ao" {
        terminal.say("all is black: no direction is free within the scene; ao:distance=D counts what is nearer than D");
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
