//! The thread that renders what pages look at: it takes requests, makes a picture at once, then a better one, and shows
//! it as it grows.
//!
//! The thread owns the description, its compiled scene, and the session. A request comes with a place for its answer
//! and breaks off the step under way; all requests that wait are carried out before anything is rendered. The answer
//! follows the state that knows of the request; until then the page keeps the changes in its fields (`takeFields` in
//! `web/src/main.ts`). Then come a preview as coarse as its time allows, first paths of a coarse picture, and the
//! session, in steps of 0.1 to 1 s.
//!
//! Each picture is encoded once (`tile`: half floats) and handed to all sockets by a `watch` channel, so that a slow
//! page misses frames and holds up none. Where the session has no samples yet, the picture before shows (`Backdrop`).
//! Edits (`edits`) are parameters of nodes and places, set by texts in Steradian's own language, or an environment map;
//! they are undone, made again after files have changed, and compiled with what the last compilation kept. Light groups
//! are further planes of a frame, weighed by the page (`groups`). The path of one sample (`path`) is traced beside the
//! render by the path tracer itself, with a `Sink` that keeps its steps. Readers hold files of uploads and edits to a
//! folder (`Options::within`).

use crate::{
    denoiser::Library,
    document::{Document, Source, Stamps},
    frame::{Backdrop, Frame, Shown},
    job::{Job, Progress, Waiting},
    look::{Look, Purpose, bytes, check_memory, check_size, options, quality},
    protocol::{Denoiser, FrameKind, Message, Request, ServerMessage, SettingsChange, Severity, told},
    state,
};
use std::{
    panic::{AssertUnwindSafe, catch_unwind},
    sync::{
        Arc, Mutex, PoisonError,
        mpsc::{Receiver, RecvTimeoutError, Sender, channel},
    },
    thread,
    time::{Duration, Instant},
};
use steradian::{Quality, Scene, method_of, scene::Diagnostics};
use tokio::sync::{broadcast, oneshot, watch};

/// Pixels of the first preview, before it is known how long they take.
const FIRST_PREVIEW: f64 = 10_000.0;
/// Longest time of a preview while the camera moves, and before paths begin; seconds.
const PREVIEW_SECONDS: f64 = 0.04;
/// Time for which a preview goes on while tasks wait, the first time; so pictures come while something is dragged.
const PATIENCE: Duration = Duration::from_millis(200);
/// Most times that a preview is begun, with twice the patience each time, before paths begin without it.
const MOST_PREVIEWS: u32 = 3;
/// First pictures are at most this much smaller than the whole, on each side.
const COARSEST: u32 = 16;
/// Time that first paths should take, before the render itself begins; they end after twice that.
const FIRST_PATHS: Duration = Duration::from_millis(200);
/// Paths per second, before it is known.
const FIRST_SPEED: f64 = 100_000.0;
/// Messages that wait for a page to read them.
const MOST_MESSAGES: usize = 64;
/// Interval between looks for changed files.
const WATCH_EVERY: Duration = Duration::from_millis(400);
/// On the way pictures are rendered for so many times as long as it takes to remove their noise.
const DENOISING: f64 = 4.0;
/// Options of path tracers that begin at once.
const PLAIN: &str = "reuse=1,effort=even,caustics=false";
/// Pictures that grow are shown after these times at first, and at last.
const SHOW_EVERY: [f64; 2] = [0.12, 1.0];

/// A question about the scene as it is.
type Question = Box<dyn FnOnce(&Document, &Look) + Send>;

/// Result of a request; an error says what is wrong with it.
type Done = Result<(), String>;

/// Task of the thread.
pub enum Task {
    /// By a page, with an answer for it: what is wrong. Pages are told the state with the change first.
    Page(Request, oneshot::Sender<Done>),
    /// Another scene.
    Open(Box<Source>, oneshot::Sender<Result<(), Vec<String>>>),
    /// An environment map, by its name and bytes.
    Environment(String, Arc<[u8]>, oneshot::Sender<Done>),
    /// Something about the scene as it is.
    Ask(Question),
}

/// Subject of the render; the picture that is shown may still be a coarser one of it.
pub struct Subject {
    /// Generation of the view's state.
    pub generation: u32,
    /// The scene.
    pub scene: Arc<Scene>,
    /// Quality of the render.
    pub quality: Quality,
}

/// Handle of the thread for others.
#[derive(Clone)]
pub struct Handle {
    tasks: Sender<Task>,
    waiting: Waiting,
    /// The last frame.
    pub frames: watch::Receiver<Arc<Frame>>,
    /// State for pages, as JSON.
    pub states: watch::Receiver<Arc<str>>,
    /// Messages to all pages, as JSON.
    pub messages: broadcast::Sender<String>,
    shown: Arc<Mutex<Option<Arc<Shown>>>>,
    subjects: watch::Receiver<Arc<Subject>>,
}

impl Handle {
    /// Asks for something. What is being rendered is broken off for it.
    pub fn send(&self, task: Task) {
        self.waiting.add();
        let _ = self.tasks.send(task);
    }

    /// Subject of the render.
    pub fn subject(&self) -> Arc<Subject> {
        self.subjects.borrow().clone()
    }

    /// The picture that is shown; `None` before there is one.
    pub fn shown(&self) -> Option<Arc<Shown>> {
        self.shown.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}

/// Opens a scene and starts the thread.
///
/// # Errors
/// All that is wrong with the scene.
pub fn start(source: Source, settings: SettingsChange, library: Library) -> Result<Handle, Diagnostics> {
    let (mut viewer, handle) = open(source, settings, library)?;
    let run = move || {
        // What fails inside ends what was being done, not the view.
        while catch_unwind(AssertUnwindSafe(|| viewer.run())).is_err() {
            (viewer.job, viewer.owed) = (None, false);
            viewer.say(
                Severity::Error,
                "the render failed by a fault of the program; the next change begins anew".into(),
            );
        }
    };
    let thread = thread::Builder::new().name("viewer".into()).spawn(run);
    thread.map_err(|e| refusal(format!("no thread can be started: {e}")))?;
    Ok(handle)
}

/// Name of the integrator that renders a scene where none is asked for.
fn default_name(scene: &Scene) -> String {
    Quality::default().render(scene).map_or_else(|_| method_of(scene).name(), |render| render.name).to_owned()
}

/// Opens a scene.
fn open(source: Source, settings: SettingsChange, library: Library) -> Result<(Viewer, Handle), Diagnostics> {
    let document = Document::open(source)?;
    let mut look = Look { settings, ..Look::default() };
    let mut document = document;
    quality(&look).request().map_err(|e| refusal(e.to_string()))?;
    let scene = compile(&mut document, &look, Purpose::Render)?;
    look.settings.integrator.get_or_insert_with(|| default_name(&scene));
    let held = held(&document, &look, &scene, 0).map_err(refusal)?;
    let (tasks, from_pages) = channel();
    let (frame, frames) = watch::channel(Arc::new(Frame::default()));
    let (state, states) = watch::channel(Arc::from(""));
    let first = Subject { generation: 0, scene: Arc::clone(&scene), quality: quality(&look) };
    let (subject, subjects) = watch::channel(Arc::new(first));
    let (messages, _) = broadcast::channel(MOST_MESSAGES);
    let (waiting, shown) = (Waiting::default(), Arc::new(Mutex::new(None)));
    let stamps = document.stamps();
    let viewer = Viewer {
        seen: stamps.clone(),
        stamps,
        watched: Instant::now(),
        document,
        look,
        scene,
        held,
        drawn: None,
        generation: 0,
        pixels_per_second: FIRST_PREVIEW / PREVIEW_SECONDS,
        paths_per_second: FIRST_SPEED,
        backdrop: None,
        library,
        denoising: 0.0,
        job: None,
        published: None,
        tasks: from_pages,
        answers: Vec::new(),
        waiting: waiting.clone(),
        broken_off: 0,
        owed: false,
        frame,
        state,
        messages: messages.clone(),
        shown: Arc::clone(&shown),
        subject,
    };
    Ok((viewer, Handle { tasks, waiting, frames, states, messages, shown, subjects }))
}

/// Part of the view that a change invalidates; each includes those before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Invalidates {
    /// Nowhere.
    Nothing,
    /// State that pages are told.
    State,
    /// Part of the picture that is sent.
    Layers,
    /// The picture.
    Picture,
    /// The scene.
    Scene,
}

/// The thread.
pub struct Viewer {
    /// The scene as it is described.
    pub document: Document,
    /// View of the scene.
    pub look: Look,
    /// As it is rendered.
    pub scene: Arc<Scene>,
    /// Bytes that its pictures take.
    pub held: u64,
    /// Scene of the preview, where an edit was checked with it.
    pub drawn: Option<Arc<Scene>>,
    generation: u32,
    /// Speed of previews.
    pixels_per_second: f64,
    /// Speed of first paths.
    paths_per_second: f64,
    /// Picture that shows where the render has no samples yet.
    backdrop: Option<Backdrop>,
    /// Stamps of the files that the scene was read from, and the stamps seen last.
    stamps: Stamps,
    seen: Stamps,
    /// When they were looked at.
    watched: Instant,
    /// Library of Open Image Denoise.
    pub library: Library,
    /// Time of the last denoising on the way, seconds.
    denoising: f64,
    /// The render under way.
    pub job: Option<Job>,
    /// Progress of the render when it was shown last.
    published: Option<Progress>,
    tasks: Receiver<Task>,
    /// Answers to pages, sent once the state is told.
    answers: Vec<(oneshot::Sender<Done>, Done)>,
    waiting: Waiting,
    /// Number of times that the preview of this state was broken off for tasks.
    broken_off: u32,
    /// True if the picture of this state has not begun.
    owed: bool,
    frame: watch::Sender<Arc<Frame>>,
    state: watch::Sender<Arc<str>>,
    messages: broadcast::Sender<String>,
    shown: Arc<Mutex<Option<Arc<Shown>>>>,
    subject: watch::Sender<Arc<Subject>>,
}

/// Compiles the scene as it is looked at.
///
/// # Errors
/// All that is wrong with it.
pub fn compile(document: &mut Document, look: &Look, purpose: Purpose) -> Result<Arc<Scene>, Diagnostics> {
    let options = options(look, document.desc.format, purpose);
    let scene = document.compile(&options, look.view.as_ref())?;
    fits(&scene)?;
    Ok(scene)
}

/// The bytes that a picture takes, if there is memory for them beside those that are `held` now. What cannot be
/// rendered takes none: it is told elsewhere.
fn held(document: &Document, look: &Look, scene: &Scene, held: u64) -> Result<u64, String> {
    let Ok(render) = quality(look).render(scene) else { return Ok(0) };
    let needed = bytes(&render, scene, look);
    check_memory(needed, held, document.source.memory.and_then(|there_is| there_is()))?;
    Ok(needed)
}

/// A message alone.
fn refusal(why: String) -> Diagnostics {
    let mut diagnostics = Diagnostics::default();
    diagnostics.error(&Default::default(), None, why);
    diagnostics
}

/// Refuses pictures that are too large to be shown.
fn fits(scene: &Scene) -> Result<(), Diagnostics> {
    let film = scene.film();
    let fits = check_size(film.width, film.height);
    fits.map_err(|why| refusal(format!("{why}; another size can be chosen (--size WxH)")))
}

impl Viewer {
    fn run(&mut self) {
        let mut invalid = if self.generation == 0 { Invalidates::Scene } else { Invalidates::Nothing };
        loop {
            if invalid > Invalidates::Nothing {
                self.tell_state(invalid);
            }
            for (answer, done) in self.answers.drain(..) {
                // Its page may be gone.
                let _ = answer.send(done);
            }
            if invalid > Invalidates::Nothing {
                self.show_change(invalid);
            }
            let is_idle = !self.owed && (self.look.paused || self.job.as_ref().is_none_or(Job::is_done));
            let first = match is_idle {
                true => match self.tasks.recv_timeout(WATCH_EVERY) {
                    Ok(task) => Some(task),
                    Err(RecvTimeoutError::Timeout) => None,
                    Err(RecvTimeoutError::Disconnected) => return,
                },
                false => self.tasks.try_recv().ok(),
            };
            invalid = Invalidates::Nothing;
            let mut next = first;
            while let Some(task) = next {
                self.waiting.remove();
                invalid = invalid.max(self.take(task));
                next = self.tasks.try_recv().ok();
            }
            if self.files_changed() {
                invalid = invalid.max(self.reload());
            }
            if invalid == Invalidates::Nothing && self.owed {
                self.show_picture();
            } else if invalid == Invalidates::Nothing && !self.look.paused {
                self.advance();
            }
        }
    }

    /// Carries a task out; how far what it changed reaches.
    fn take(&mut self, task: Task) -> Invalidates {
        match task {
            Task::Page(request, answer) => {
                let done = self.request(request);
                let invalid = *done.as_ref().unwrap_or(&Invalidates::Nothing);
                self.answers.push((answer, done.map(|_| ())));
                invalid
            }
            Task::Open(source, answer) => {
                let opened = self.open(*source);
                let invalid = if opened.is_ok() { Invalidates::Scene } else { Invalidates::Nothing };
                let _ = answer.send(opened);
                invalid
            }
            Task::Environment(name, picture, answer) => {
                let done = self.set_environment(name, picture);
                let invalid = if done.is_ok() { Invalidates::Scene } else { Invalidates::Nothing };
                let _ = answer.send(done);
                invalid
            }
            Task::Ask(ask) => {
                ask(&self.document, &self.look);
                Invalidates::Nothing
            }
        }
    }

    /// True if files of the scene were changed, and nobody is writing them any more.
    fn files_changed(&mut self) -> bool {
        if self.watched.elapsed() < WATCH_EVERY {
            return false;
        }
        self.watched = Instant::now();
        let before = std::mem::replace(&mut self.seen, self.document.stamps());
        // Edits may name further files.
        for (path, stamp) in &self.seen {
            self.stamps.entry(path.clone()).or_insert(*stamp);
        }
        let is_changed = self.seen.iter().any(|(path, stamp)| self.stamps.get(path) != Some(stamp));
        is_changed && self.seen == before
    }

    /// Shows the scene as its files have it now; the camera, settings and edits stay.
    fn reload(&mut self) -> Invalidates {
        self.stamps.clone_from(&self.seen);
        let (fresh, lost) = match self.document.reloaded() {
            Ok(read) => read,
            Err(diagnostics) => {
                self.say(Severity::Error, told(&diagnostics));
                return Invalidates::Nothing;
            }
        };
        let old = std::mem::replace(&mut self.document, fresh);
        self.look.moving = false;
        if let Err(why) = self.remake() {
            self.document = old;
            self.say(Severity::Error, why);
            return Invalidates::Nothing;
        }
        lost.into_iter().for_each(|why| self.say(Severity::Warning, format!("an edit does not fit any more: {why}")));
        self.say(Severity::Note, "the scene's files have changed: they were read again".into());
        self.stamps = self.document.stamps();
        Invalidates::Scene
    }

    fn open(&mut self, source: Source) -> Result<(), Vec<String>> {
        let lines = |d: Diagnostics| vec![told(&d)];
        let source = Source { memory: self.document.source.memory, ..source };
        let mut document = Document::open(source).map_err(lines)?;
        let settings = SettingsChange { color: self.look.settings.color.clone(), ..SettingsChange::default() };
        let mut look = Look { layers: self.look.layers.clone(), settings, ..Look::default() };
        let scene = compile(&mut document, &look, Purpose::Render).map_err(lines)?;
        look.settings.integrator = Some(default_name(&scene));
        self.held = held(&document, &look, &scene, self.held).map_err(|why| vec![why])?;
        (self.document, self.look, self.scene, self.drawn) = (document, look, scene, None);
        self.stamps = self.document.stamps();
        self.seen.clone_from(&self.stamps);
        (self.pixels_per_second, self.paths_per_second) = (FIRST_PREVIEW / PREVIEW_SECONDS, FIRST_SPEED);
        Ok(())
    }

    /// Tells pages what has changed.
    fn tell_state(&mut self, invalid: Invalidates) {
        if invalid >= Invalidates::Picture {
            self.generation += 1;
            (self.job, self.published) = (None, None);
            (self.broken_off, self.owed) = (0, true);
            let (generation, scene) = (self.generation, Arc::clone(&self.scene));
            self.subject.send_replace(Arc::new(Subject { generation, scene, quality: quality(&self.look) }));
        }
        let state = state::of(self.generation, &self.document, &self.look, &self.scene, &self.library);
        self.state.send_replace(state);
    }

    /// Shows what has changed: a preview, and the beginning of a render.
    fn show_change(&mut self, invalid: Invalidates) {
        if invalid < Invalidates::Picture {
            // Other layers are sent of the same picture.
            if invalid == Invalidates::Layers || self.has_news() {
                self.publish();
            }
            return;
        }
        self.show_picture();
    }

    /// Begins the picture: a preview, first paths and a render. Where tasks wait and the preview is slow, they come
    /// first.
    fn show_picture(&mut self) {
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
    fn advance(&mut self) {
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
    fn has_news(&self) -> bool {
        self.job.as_ref().is_some_and(|job| self.published != Some(job.progress()))
    }

    /// Shows the render as it is.
    fn publish(&mut self) {
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

    fn say(&self, severity: Severity, text: String) {
        // Nobody may be there.
        let _ = self.messages.send(ServerMessage::Message(Message { severity, text }).text());
    }
}

#[cfg(test)]
mod tests;
