//! Pictures: a preview as coarse as its time allows, then as fine as the film, and the render in steps, which is shown
//! once it is better.

use super::{Viewer, compile};
use crate::{
    frame::{Frame, Shown},
    job::Job,
    look::{Look, Purpose, quality},
    preview::Preview,
    protocol::{Denoiser, FrameKind, Severity, told},
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
/// Time of a fine preview of a part of the pixels, and longest time of one of all; seconds.
const FINE_SECONDS: f64 = 0.5;
const FINEST_SECONDS: f64 = 1.5;
/// Time of the chosen denoiser before it is known, seconds per pixel.
pub(super) const FIRST_DENOISING: f64 = 2e-6;
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
    /// Begins the picture: a preview, first paths where the pipeline cannot draw the scene, and a render. Where tasks
    /// wait and the preview is slow, they come first.
    pub(super) fn show_picture(&mut self) {
        if self.broken_off < MOST_PREVIEWS && !self.begin_preview() {
            self.broken_off += 1;
            return;
        }
        self.owed = false;
        if self.look.moving || self.look.paused {
            return;
        }
        if self.preview.as_ref().is_none_or(|preview| !preview.stands()) {
            self.first_paths();
        }
        match Job::new(&self.scene, &quality(&self.look)) {
            Ok(job) => self.job = Some(job),
            Err(why) => self.say(Severity::Error, why),
        }
    }

    /// A picture at once, as fine as there is time for; `false` where it was broken off.
    fn begin_preview(&mut self) -> bool {
        let scene = match self.drawn.clone() {
            Some(scene) => scene,
            None => {
                let look = self.preview_look();
                let Ok(scene) = compile(&mut self.document, &look, Purpose::Preview) else { return true };
                scene
            }
        };
        let plain = Quality { max_depth: Some(2), ..Quality::of(&format!("path:{PLAIN}")) }.spp(1);
        let raster = Job::new(&scene, &Quality::of("raster"));
        let stands = raster.is_ok();
        match raster.or_else(|_| Job::new(&scene, &plain)) {
            Ok(job) => self.preview(job, stands, PATIENCE * (1 << self.broken_off)),
            Err(why) => {
                self.say(Severity::Error, why);
                true
            }
        }
    }

    /// Draws a preview, which may be broken off for tasks after a time; `false` where it was.
    fn preview(&mut self, mut job: Job, stands: bool, patience: Duration) -> bool {
        let start = Instant::now();
        if !job.run(patience, &self.waiting) {
            return false;
        }
        let seconds = start.elapsed().as_secs_f64().max(1e-4);
        let shown = job.shown(self.generation, self.full_crop(), FrameKind::Preview);
        self.pixels_per_second = shown.film.pixels.len() as f64 / seconds;
        self.preview = Some(Preview::new(&shown, stands));
        self.show(Arc::new(shown));
        true
    }

    /// Draws a finer preview while nobody moves anything; true if it took its time for that.
    pub(super) fn refine(&mut self) -> bool {
        let Some(preview) = self.preview.as_ref().filter(|preview| preview.stands() && !self.is_fine) else {
            return false;
        };
        let pixels = preview.pixels();
        let crop = self.scene.film().crop;
        let full = f64::from(crop.width()) * f64::from(crop.height());
        let is_quick = full <= self.pixels_per_second * FINEST_SECONDS;
        let target = if is_quick { full } else { self.pixels_per_second * FINE_SECONDS };
        let look = self.coarse(target, pixels);
        let Some(look) = look else {
            self.is_fine = true;
            return false;
        };
        let job = compile(&mut self.document, &look, Purpose::Preview)
            .map_err(|d| told(&d))
            .and_then(|scene| Job::new(&scene, &Quality::of("raster")));
        match job {
            Ok(job) => _ = self.preview(job, true, Duration::ZERO),
            // The coarse one was drawn.
            Err(_) => self.is_fine = true,
        }
        true
    }

    /// First paths, of a coarser picture and without the trials that come before a render.
    fn first_paths(&mut self) {
        let name = self.look.settings.integrator.as_deref().and_then(|i| i.split(':').next());
        let Some(name @ ("path" | "volpath")) = name else { return };
        let integrator = Some(format!("{name}:{PLAIN}"));
        let plain = Quality { integrator, spp: Some(1), ..quality(&self.look) };
        let Some(look) = self.coarse(self.paths_per_second * FIRST_PATHS.as_secs_f64(), 0) else { return };
        let Ok(scene) = compile(&mut self.document, &look, Purpose::Render) else { return };
        let Ok(mut job) = Job::new(&scene, &plain) else { return };
        job.advance(2 * FIRST_PATHS, &self.waiting);
        let target = quality(&self.look).spp.unwrap_or(self.scene.settings().spp);
        let mut shown =
            Shown { is_done: false, target, ..job.shown(self.generation, self.full_crop(), FrameKind::Render) };
        if shown.samples > 0.0 {
            self.paths_per_second = shown.film.pixels.len() as f64 * shown.samples / shown.seconds.max(1e-3);
        }
        // Of a part of the pixels nothing is shown.
        if shown.samples >= 1.0 {
            self.denoise(&mut shown);
            self.preview = Some(Preview::new(&shown, false));
            self.show(Arc::new(shown));
        }
    }

    /// View for a preview.
    pub fn preview_look(&self) -> Look {
        self.coarse(self.pixels_per_second * PREVIEW_SECONDS, 0).unwrap_or_else(|| self.look.clone())
    }

    /// View for a picture of about so many pixels; `None` where it has no more than `least`.
    fn coarse(&self, pixels: f64, least: usize) -> Option<Look> {
        let film = self.scene.film();
        let full = [film.width, film.height];
        let shrink = (f64::from(full[0]) * f64::from(full[1]) / pixels.max(1.0)).sqrt().ceil().max(1.0);
        let shrink = (shrink as u32).min(COARSEST);
        let mut look = self.look.clone();
        (look.settings.width, look.settings.height) = (Some(full[0].div_ceil(shrink)), Some(full[1].div_ceil(shrink)));
        let part = |[x0, y0, x1, y1]: [u32; 4]| [x0 / shrink, y0 / shrink, x1.div_ceil(shrink), y1.div_ceil(shrink)];
        look.region = look.region.map(part);
        let [width, height] = full.map(|side| side.div_ceil(shrink));
        let [x0, y0, x1, y1] = look.region.unwrap_or([0, 0, width, height]);
        let there_are = u64::from(x1.saturating_sub(x0)) * u64::from(y1.saturating_sub(y0));
        (there_are > least as u64).then_some(look)
    }

    /// The part of the picture that is shown, in its pixels.
    fn full_crop(&self) -> [u32; 4] {
        let crop = self.scene.film().crop;
        [crop.x0, crop.y0, crop.x1, crop.y1]
    }

    /// Goes on with the preview, then with the render, for as long as a picture may stay.
    pub(super) fn advance(&mut self) {
        if !self.has_news() && self.job.as_ref().is_none_or(Job::is_done) || self.refine() {
            return;
        }
        let Some(job) = &mut self.job else { return };
        let mut shown_after = job.seconds().clamp(SHOW_EVERY[0], SHOW_EVERY[1]);
        if self.look.denoiser().is_some() && self.preview.is_none() {
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

    /// Shows the render as it is, once it is better than the preview.
    pub(super) fn publish(&mut self) {
        let Some(job) = &self.job else { return self.show_again() };
        let mut shown = job.shown(self.generation, self.full_crop(), FrameKind::Render);
        let failure = job.failure();
        self.published = Some(job.progress());
        if self.preview_stays(&mut shown) {
            let frame = self.frame.borrow().while_rendered(&shown);
            self.frame.send_replace(Arc::new(frame));
        } else {
            self.preview = None;
            self.denoise(&mut shown);
            self.show(Arc::new(shown));
        }
        if let Some(why) = failure {
            self.say(Severity::Error, why);
        }
    }

    /// True if the preview is the better picture.
    fn preview_stays(&mut self, shown: &mut Shown) -> bool {
        let Some(preview) = &self.preview else { return false };
        if shown.is_done || shown.samples < preview.next_test() {
            return !shown.is_done;
        }
        self.denoise(shown);
        self.preview.as_mut().is_some_and(|preview| !preview.is_beaten(shown))
    }

    /// Sends the picture that is shown with the layers that are asked for.
    pub(super) fn show_again(&mut self) {
        let shown = self.shown.lock().unwrap_or_else(PoisonError::into_inner).clone();
        if let Some(shown) = shown {
            self.show(shown);
        }
    }

    /// Removes the noise, if that is asked for: in the end by the chosen denoiser, on the way by a quick one.
    fn denoise(&mut self, shown: &mut Shown) {
        let Some(chosen) = self.look.denoiser().filter(|_| shown.denoised.is_none()) else { return };
        // Other layers may be asked for of a picture that is done.
        let before = self.shown.lock().unwrap_or_else(PoisonError::into_inner).clone();
        let before = before.filter(|b| shown.is_done && b.is_done && b.generation == shown.generation);
        shown.denoised = before.and_then(|before| before.denoised.clone());
        if shown.denoised.is_some() {
            return;
        }
        let pixels = shown.film.pixels.len() as f64;
        let is_quick = chosen == Denoiser::Oidn && shown.seconds > DENOISING * self.chosen_denoising * pixels;
        let denoiser = if shown.is_done || is_quick { chosen } else { Denoiser::Atrous };
        let start = Instant::now();
        match denoiser.picture(shown, &self.denoisers) {
            Ok(picture) => shown.denoised = Some(picture),
            Err(why) => self.say(Severity::Error, why),
        }
        let seconds = start.elapsed().as_secs_f64();
        if denoiser == chosen {
            self.chosen_denoising = seconds / pixels.max(1.0);
        }
        if !shown.is_done {
            self.denoising = seconds;
        }
    }

    fn show(&self, shown: Arc<Shown>) {
        let frame = Frame::new(&shown, &self.look.layers);
        *self.shown.lock().unwrap_or_else(PoisonError::into_inner) = Some(shown);
        self.frame.send_replace(Arc::new(frame));
    }
}
