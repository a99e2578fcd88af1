//! Pictures of a session with their metadata, and the summary.

use crate::{
    denoise::{self, Filter},
    diagnostics::Counts,
    failure::Failure,
    memory,
    output::{self, Provenance},
    report::{self, Report},
    sequence_state::SequenceState,
    signals,
    terminal::Terminal,
    watch::Stop,
};
use std::{
    collections::BTreeMap,
    time::{Duration, Instant},
};
use steradian::{
    Layer, Scene, Session,
    image::Image,
    integrators::{Doubt, SCALES},
};

/// Metadata of a picture beside those that its session knows.
pub struct ImageMaker<'a> {
    pub scene: &'a Scene,
    pub name: &'a str,
    pub integrator: &'a str,
    pub color: &'static str,
    pub seed: u64,
    pub layers: &'a [Layer],
}

/// A picture with its metadata.
pub struct RenderedImage {
    pub picture: Image,
    /// Pixels without a sample.
    pub empty_pixels: u64,
    /// Mean samples per pixel.
    pub spp: f64,
    pub error: Option<f64>,
    pub doubt: Option<Doubt>,
    /// Error that remains where the picture was denoised.
    pub denoised_error: Option<f64>,
    /// By the edges of squares.
    pub of_means: Option<BTreeMap<u32, f64>>,
}

impl RenderedImage {
    /// True if it has the layer of halves: each pixel has a sample in both.
    pub fn has_halves(&self) -> bool {
        self.picture.channel(&format!("{}.R", Layer::HALVES.prefix())).is_some()
    }

    /// Removes the noise, and says how long that took and how much error remains.
    pub fn denoise(&mut self, filter: &Filter, before: &mut SequenceState, terminal: Terminal) -> Result<(), Failure> {
        let start = Instant::now();
        let denoised = before.denoised(&self.picture, filter).map_err(|e| Failure::failed(e.to_string()))?;
        filter.tell(start.elapsed().as_secs_f64(), terminal);
        denoise::tell_error(denoised.error, terminal);
        (self.picture, self.denoised_error) = (denoised.picture, denoised.error);
        Ok(())
    }
}

impl ImageMaker<'_> {
    /// The picture as it is.
    pub fn picture(&self, session: &dyn Session) -> RenderedImage {
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
        RenderedImage { picture, empty_pixels, spp, error, doubt, denoised_error: None, of_means }
    }

    /// The summary of a session, by the times of loading, building and saving; what else is known of the scene is left
    /// empty.
    pub fn report(
        &self,
        session: &dyn Session,
        made: &RenderedImage,
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
            notes: session.notes(),
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
