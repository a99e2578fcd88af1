//! Pictures: a preview as coarse as its time allows, first paths of a coarse picture, and the render in steps.

use super::{Viewer, compile};
use crate::{
    frame::{Backdrop, Frame, Shown},
    job::Job,
    look::{Look, Purpose, quality},
    protocol::{Denoiser, FrameKind, Severity},
};
use std::{
    sync::{Arc, PoisonError},
    time::{Duration, Instant},
};
use steradian::Quality;

/// Pixels of the first preview, before it is known how long they take.
pub(super) const FIRST_PREVIEW: f64 = 10_000.0;
/// Longest time of a preview while the camera moves, and before paths begin; seconds.
pub(super) const PREVIEW_SECONDS: f64 = 0.04;
/// Time for which a preview goes on while tasks wait, the first time; so pictures come while something is dragged.
const PATIENCE: Duration = Duration::from_millis(200);
/// Most times that a preview is begun, with twice the patience each time, before paths begin without it.
const MOST_PREVIEWS: u32 = 3;
/// First pictures are at most this much smaller than the whole, on each side.
const COARSEST: u32 = 16;
/// Time that first paths should take, before the render itself begins; they end after twice that.
const FIRST_PATHS: Duration = Duration::from_millis(200);
/// Paths per second, before it is known.
pub(super) const FIRST_SPEED: f64 = 100_000.0;
/// On the way pictures are rendered for so many times as long as it takes to remove their noise.
const DENOISING: f64 = 4.0;
/// Options of path tracers that begin at once.
const PLAIN: &str = "reuse=1,effort=even,caustics=false";
/// Pictures that grow are shown after these times at first, and at last.
const SHOW_EVERY: [f64; 2] = [0.12, 1.0];

impl Viewer {
    /// Begins the picture: a preview, first paths and a render. Where tasks wait and the preview is slow, they come
    /// first.
    pub(super) fn show_picture(&mut self) {
        if self.broken_off < MOST_PREVIEWS && !self.preview() {
            self.broken_off += 1;
            return;
        }
        self.owed = false;
        if self.look.moving || self.look.paused {
            return;
        }
        self.first_paths();
        match Job::new(&self.scene, &quality(&self.look)) {
            Ok(job) => self.job = Some(job),
            Err(why) => self.say(Severity::Error, why),
        }
    }

    /// A picture at once, as fine as there is time for; `false` where it was broken off.
    fn preview(&mut self) -> bool {
        let scene = match self.drawn.clone() {
            Some(scene) => scene,
            None => {
                let look = self.preview_look();
                let Ok(scene) = compile(&mut self.document, &look, Purpose::Preview) else { return true };
                scene
            }
        };
        let start = Instant::now();
        let raster = Quality::of("raster");
        let plain = Quality { max_depth: Some(2), ..Quality::of(&format!("path:{PLAIN}")) }.spp(1);
        let job = Job::new(&scene, &raster).or_else(|_| Job::new(&scene, &plain));
        let mut job = match job {
            Ok(job) => job,
            Err(why) => {
                self.say(Severity::Error, why);
                return true;
            }
        };
        if !job.run(PATIENCE * (1 << self.broken_off), &self.waiting) {
            return false;
        }
        let seconds = start.elapsed().as_secs_f64().max(1e-4);
        let shown = job.shown(self.generation, self.full_crop(), FrameKind::Preview);
        self.pixels_per_second = shown.film.pixels.len() as f64 / seconds;
        self.backdrop = Some(Backdrop::new(&shown, None));
        self.show(Arc::new(shown));
        true
    }

    /// First paths, of a coarser picture and without the trials that come before a render.
    fn first_paths(&mut self) {
        let name = self.look.settings.integrator.as_deref().and_then(|i| i.split(':').next());
        let Some(name @ ("path" | "volpath")) = name else { return };
        let integrator = Some(format!("{name}:{PLAIN}"));
        let plain = Quality { integrator, spp: Some(1), ..quality(&self.look) };
        let look = self.coarse(self.paths_per_second * FIRST_PATHS.as_secs_f64());
        let Ok(scene) = compile(&mut self.document, &look, Purpose::Render) else { return };
        let Ok(mut job) = Job::new(&scene, &plain) else { return };
        job.advance(2 * FIRST_PATHS, &self.waiting);
        let target = quality(&self.look).spp.unwrap_or(self.scene.settings().spp);
        let mut shown =
            Shown { is_done: false, target, ..job.shown(self.generation, self.full_crop(), FrameKind::Render) };
        self.denoise(&mut shown);
        if shown.samples > 0.0 {
            self.paths_per_second = shown.film.pixels.len() as f64 * shown.samples / shown.seconds.max(1e-3);
            let behind = self.backdrop.take();
            self.backdrop = Some(Backdrop::new(&shown, behind.as_ref()));
            self.show(Arc::new(shown));
        }
    }

    /// View for a preview.
    pub fn preview_look(&self) -> Look {
        self.coarse(self.pixels_per_second * PREVIEW_SECONDS)
    }

    /// View for a picture of about so many pixels.
    fn coarse(&self, pixels: f64) -> Look {
        let film = self.scene.film();
        let full = [film.width, film.height];
        let shrink = (f64::from(full[0]) * f64::from(full[1]) / pixels.max(1.0)).sqrt().ceil().max(1.0);
        let shrink = (shrink as u32).min(COARSEST);
        let mut look = self.look.clone();
        (look.settings.width, look.settings.height) = (Some(full[0].div_ceil(shrink)), Some(full[1].div_ceil(shrink)));
        let part = |[x0, y0, x1, y1]: [u32; 4]| [x0 / shrink, y0 / shrink, x1.div_ceil(shrink), y1.div_ceil(shrink)];
        look.region = look.region.map(part);
        look
    }

    /// The part of the picture that is shown, in its pixels.
    fn full_crop(&self) -> [u32; 4] {
        let crop = self.scene.film().crop;
        [crop.x0, crop.y0, crop.x1, crop.y1]
    }

    /// Goes on rendering for as long as a picture may stay.
    pub(super) fn advance(&mut self) {
        if !self.has_news() && self.job.as_ref().is_none_or(Job::is_done) {
            return;
        }
        let Some(job) = &mut self.job else { return };
        let mut shown_after = job.seconds().clamp(SHOW_EVERY[0], SHOW_EVERY[1]);
        if self.look.settings.denoise.flatten().is_some() {
            shown_after = shown_after.max(DENOISING * self.denoising);
        }
        job.advance(Duration::from_secs_f64(shown_after), &self.waiting);
        if self.waiting.is_any() && !job.is_done() {
            return;
        }
        if self.has_news() {
            self.publish();
        }
    }

    /// True if the render is further than the picture that was shown of it.
    pub(super) fn has_news(&self) -> bool {
        self.job.as_ref().is_some_and(|job| self.published != Some(job.progress()))
    }

    /// Shows the render as it is.
    pub(super) fn publish(&mut self) {
        let crop = self.full_crop();
        let Some(job) = &self.job else {
            let shown = self.shown.lock().unwrap_or_else(PoisonError::into_inner).clone();
            return shown.map_or((), |shown| self.show(shown));
        };
        let mut shown = job.shown(self.generation, crop, FrameKind::Render);
        let failure = job.failure();
        self.published = Some(job.progress());
        self.denoise(&mut shown);
        self.show(Arc::new(shown));
        if let Some(why) = failure {
            self.say(Severity::Error, why);
        }
    }

    /// Removes the noise, if that is asked for: in the end by what was chosen, on the way by what is quick, once every
    /// pixel may have a sample.
    fn denoise(&mut self, shown: &mut Shown) {
        let Some(chosen) = self.look.settings.denoise.flatten() else { return };
        if !shown.is_done && shown.samples < 1.0 {
            return;
        }
        // Other layers may be asked for of a picture that is done.
        let before = self.shown.lock().unwrap_or_else(PoisonError::into_inner).clone();
        let before = before.filter(|b| shown.is_done && b.is_done && b.generation == shown.generation);
        shown.denoised = before.and_then(|before| before.denoised.clone());
        if shown.denoised.is_some() {
            return;
        }
        let denoiser = if shown.is_done { chosen } else { Denoiser::Atrous };
        let start = Instant::now();
        match denoiser.picture(shown, &self.library) {
            Ok(picture) => shown.denoised = Some(picture),
            Err(why) => self.say(Severity::Error, why),
        }
        if !shown.is_done {
            self.denoising = start.elapsed().as_secs_f64();
        }
    }

    fn show(&self, shown: Arc<Shown>) {
        let frame = Frame::new(&shown, self.backdrop.as_ref(), &self.look.layers);
        *self.shown.lock().unwrap_or_else(PoisonError::into_inner) = Some(shown);
        self.frame.send_replace(Arc::new(frame));
    }
}
