//! The thread that renders what pages look at: it takes requests, makes a picture at once, then a better one, and shows
//! it as it grows.

use crate::{
    document::{Document, Purpose, Source, View, told},
    frame::{self, Backdrop, Frame, Shown},
    job::Job,
    protocol::{Message, Request, SettingsChange},
    state,
};
use std::{
    path::PathBuf,
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicBool, Ordering},
        mpsc::{Receiver, Sender, channel},
    },
    thread,
    time::{Duration, Instant},
};
use steradian::{
    ColorMode, CompileOptions, Layer, Quality, Scene,
    scene::{Diagnostics, Format},
};
use tokio::sync::{oneshot, watch};

/// Pixels of the largest picture that is shown.
pub const MOST_PIXELS: u64 = 1 << 24;
/// Longest edge of a picture: tiles count with 16 bits.
const LONGEST_EDGE: u32 = 1 << 15;
/// Pixels of the first preview, before it is known how long they take.
const FIRST_PREVIEW: f64 = 30_000.0;
/// How long a preview may take while the camera moves, and before paths begin.
const PREVIEW_SECONDS: f64 = 0.045;
/// Previews are at most this much smaller than the picture, on each side.
const SMALLEST_PREVIEW: u32 = 16;
/// How long first paths may take, before the render itself begins.
const FIRST_PATHS: Duration = Duration::from_millis(250);
/// Options of path tracers that begin at once.
const PLAIN: &str = "reuse=1,effort=even,caustics=false";
/// Pictures that grow are shown after these times at first, and at last.
const SHOW_EVERY: [f64; 2] = [0.12, 1.0];

/// What the thread is asked.
pub enum Task {
    /// By a page, with an answer for it: what is wrong.
    Page(Request, oneshot::Sender<Result<(), String>>),
    /// Another scene.
    Open(Box<Source>, oneshot::Sender<Result<(), Vec<String>>>),
    /// Something about the scene as it is.
    Ask(Box<dyn FnOnce(&Document, &Look) + Send>),
}

/// How the scene is looked at.
#[derive(Clone, Debug, Default)]
pub struct Look {
    /// The camera that was chosen.
    pub camera: Option<String>,
    /// Where it was moved.
    pub view: Option<View>,
    /// The part that is rendered.
    pub region: Option<[u32; 4]>,
    /// Layers that are sent along.
    pub layers: Vec<Layer>,
    /// What was chosen.
    pub settings: SettingsChange,
    /// Whether nothing goes on.
    pub paused: bool,
    /// Whether a hand is on the camera.
    moving: bool,
}

/// What others see of the thread.
#[derive(Clone)]
pub struct Handle {
    tasks: Sender<Task>,
    interrupt: Arc<AtomicBool>,
    /// The last frame.
    pub frames: watch::Receiver<Arc<Frame>>,
    /// What pages know, as JSON.
    pub states: watch::Receiver<Arc<str>>,
    shown: Arc<Mutex<Option<Arc<Shown>>>>,
}

impl Handle {
    /// Asks for something. What is being rendered is broken off for it.
    pub fn send(&self, task: Task) {
        let _ = self.tasks.send(task);
        self.interrupt.store(true, Ordering::Relaxed);
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
pub fn start(source: Source, settings: SettingsChange) -> Result<Handle, Diagnostics> {
    let document = Document::open(source)?;
    let mut look = Look { settings, ..Look::default() };
    let mut document = document;
    let scene = compile(&mut document, &look, Purpose::Render)?;
    look.settings.integrator.get_or_insert_with(|| Quality::default().integrator_name(&scene).to_owned());
    let (tasks, from_pages) = channel();
    let (frame, frames) = watch::channel(Arc::new(Frame::default()));
    let (state, states) = watch::channel(Arc::from(""));
    let (interrupt, shown) = (Arc::new(AtomicBool::new(false)), Arc::new(Mutex::new(None)));
    let mut viewer = Viewer {
        document,
        look,
        scene,
        generation: 0,
        pixels_per_second: FIRST_PREVIEW / PREVIEW_SECONDS,
        backdrop: None,
        job: None,
        tasks: from_pages,
        interrupt: Arc::clone(&interrupt),
        frame,
        state,
        shown: Arc::clone(&shown),
    };
    thread::Builder::new().name("viewer".into()).spawn(move || viewer.run()).map_err(|e| {
        let mut diagnostics = Diagnostics::default();
        diagnostics.error(&Default::default(), None, format!("no thread can be started: {e}"));
        diagnostics
    })?;
    Ok(Handle { tasks, interrupt, frames, states, shown })
}

/// How far a change reaches.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Reach {
    Nothing,
    /// What is sent of the picture.
    Sent,
    /// The picture.
    Picture,
    /// The scene.
    Scene,
}

struct Viewer {
    document: Document,
    look: Look,
    /// As it is rendered.
    scene: Arc<Scene>,
    generation: u32,
    /// Speed of previews.
    pixels_per_second: f64,
    /// What shows where the render has no samples yet.
    backdrop: Option<Backdrop>,
    job: Option<Job>,
    tasks: Receiver<Task>,
    interrupt: Arc<AtomicBool>,
    frame: watch::Sender<Arc<Frame>>,
    state: watch::Sender<Arc<str>>,
    shown: Arc<Mutex<Option<Arc<Shown>>>>,
}

/// How the scene is compiled.
pub fn options(look: &Look, format: Format, purpose: Purpose) -> CompileOptions {
    let settings = &look.settings;
    let is_raster = settings.integrator.as_deref().is_some_and(|i| i.split(':').next() == Some("raster"));
    let mode = match settings.color.as_deref() {
        Some("rgb") => Some(ColorMode::Rgb),
        Some("spectral") => Some(ColorMode::Spectral),
        // One sample of wavelengths would be noise.
        _ if is_raster || purpose == Purpose::Preview => Some(ColorMode::Rgb),
        _ if format == Format::Pbrt => Some(ColorMode::Spectral),
        _ => Some(ColorMode::Rgb),
    };
    CompileOptions {
        mode,
        size: settings.width.zip(settings.height),
        crop: look.region,
        camera: look.camera.clone(),
        spp: settings.spp.flatten(),
        ..CompileOptions::default()
    }
}

fn compile(document: &mut Document, look: &Look, purpose: Purpose) -> Result<Arc<Scene>, Diagnostics> {
    let options = options(look, document.desc.format, purpose);
    document.compile(purpose, &options, look.view.as_ref())
}

/// What the session is asked for.
pub fn quality(look: &Look) -> Quality {
    let s = &look.settings;
    Quality {
        integrator: s.integrator.clone(),
        spp: s.spp.flatten(),
        seed: s.seed.flatten(),
        max_depth: s.max_depth.flatten(),
        sampler: s.sampler.clone().flatten(),
        // What the inspector tells.
        layers: frame::LAYERS.to_vec(),
        ..Quality::default()
    }
}

impl Viewer {
    fn run(&mut self) {
        let mut reach = Reach::Scene;
        loop {
            if reach > Reach::Nothing {
                self.show_change(reach);
            }
            let is_idle = self.look.paused || self.job.as_ref().is_none_or(Job::is_done);
            let first = match is_idle {
                true => match self.tasks.recv() {
                    Ok(task) => Some(task),
                    Err(_) => return,
                },
                false => self.tasks.try_recv().ok(),
            };
            self.interrupt.store(false, Ordering::Relaxed);
            reach = Reach::Nothing;
            let mut next = first;
            while let Some(task) = next {
                reach = reach.max(self.take(task));
                next = self.tasks.try_recv().ok();
            }
            if reach == Reach::Nothing && !self.look.paused {
                self.advance();
            }
        }
    }

    /// Carries a task out; how far what it changed reaches.
    fn take(&mut self, task: Task) -> Reach {
        match task {
            Task::Page(request, answer) => {
                let done = self.request(request);
                let reach = *done.as_ref().unwrap_or(&Reach::Nothing);
                let _ = answer.send(done.map(|_| ()));
                reach
            }
            Task::Open(source, answer) => {
                let opened = self.open(*source);
                let reach = if opened.is_ok() { Reach::Scene } else { Reach::Nothing };
                let _ = answer.send(opened);
                reach
            }
            Task::Ask(ask) => {
                ask(&self.document, &self.look);
                Reach::Nothing
            }
        }
    }

    fn open(&mut self, source: Source) -> Result<(), Vec<String>> {
        let lines = |d: Diagnostics| vec![told(&d)];
        let mut document = Document::open(source).map_err(lines)?;
        let settings = SettingsChange { color: self.look.settings.color.clone(), ..SettingsChange::default() };
        let mut look = Look { layers: self.look.layers.clone(), settings, ..Look::default() };
        let scene = compile(&mut document, &look, Purpose::Render).map_err(lines)?;
        look.settings.integrator = Some(Quality::default().integrator_name(&scene).to_owned());
        (self.document, self.look, self.scene) = (document, look, scene);
        self.pixels_per_second = FIRST_PREVIEW / PREVIEW_SECONDS;
        Ok(())
    }

    /// Carries out what a page asks for.
    fn request(&mut self, request: Request) -> Result<Reach, String> {
        let before = self.look.clone();
        let reach = self.change(request)?;
        if reach >= Reach::Scene
            && let Err(why) = self.remake()
        {
            self.look = before;
            return Err(why);
        }
        Ok(reach)
    }

    /// Compiles the scene as it is to be looked at, and sees whether it can be rendered so.
    fn remake(&mut self) -> Result<(), String> {
        if self.look.moving {
            return Ok(());
        }
        let scene = compile(&mut self.document, &self.look, Purpose::Render).map_err(|d| told(&d))?;
        quality(&self.look).render(&scene).map_err(|e| e.to_string())?;
        self.scene = scene;
        Ok(())
    }

    fn change(&mut self, request: Request) -> Result<Reach, String> {
        let Self { document, look, job, .. } = self;
        match request {
            Request::Camera { eye, target, up, fov, moving } => {
                let point = steradian::Viewpoint { eye: eye.into(), target: target.into(), up: up.into() };
                if !point.is_sound() {
                    return Err("the camera cannot stand in what it looks at, nor have 'up' along its view".into());
                }
                if !state::is_movable(document, look) {
                    return Err("this camera cannot be moved".into());
                }
                if fov.is_some_and(|fov| !(fov > 0.0 && fov < 180.0)) {
                    return Err("a field of view is above 0 and below 180 degrees".into());
                }
                look.view = Some(View { point, fov: fov.or(look.view.and_then(|v| v.fov)) });
                look.moving = moving;
                Ok(Reach::Scene)
            }
            Request::CameraName { name } => {
                let Some(_) = document.desc.camera(Some(&name)) else {
                    return Err(format!("there is no camera '{name}'"));
                };
                (look.camera, look.view, look.moving) = (Some(name), None, false);
                Ok(Reach::Scene)
            }
            Request::CameraReset => {
                (look.view, look.moving) = (None, false);
                Ok(Reach::Scene)
            }
            Request::Settings(change) => {
                set(&mut look.settings, change)?;
                look.region = None;
                Ok(Reach::Scene)
            }
            Request::Region { pixels } => {
                look.region = pixels;
                Ok(Reach::Scene)
            }
            Request::Layers { names } => {
                look.layers = names.iter().map(|name| frame::layer(name)).collect::<Result<_, _>>()?;
                Ok(Reach::Sent)
            }
            Request::Edit { node, parameter, value } => {
                let options = options(look, document.desc.format, Purpose::Render);
                let within = folder(document);
                document.edit([&node, &parameter], value.as_deref(), &within, &options)?;
                Ok(Reach::Scene)
            }
            Request::Undo => document.undo().then_some(Reach::Scene).ok_or_else(|| "there is nothing to undo".into()),
            Request::Redo => document.redo().then_some(Reach::Scene).ok_or_else(|| "there is nothing to redo".into()),
            Request::Pause { on } => {
                look.paused = on;
                Ok(if on || job.is_some() { Reach::Sent } else { Reach::Picture })
            }
        }
    }

    /// Shows what has changed: the state, a preview, and the beginning of a render.
    fn show_change(&mut self, reach: Reach) {
        if reach >= Reach::Picture {
            self.generation += 1;
            self.job = None;
        }
        let state = state::of(self.generation, &self.document, &self.look, &self.scene);
        self.state.send_replace(state);
        if reach < Reach::Picture {
            self.publish();
            return;
        }
        self.preview();
        if self.look.moving || self.look.paused {
            return;
        }
        self.first_paths();
        match Job::new(&self.scene, &quality(&self.look)) {
            Ok(job) => self.job = Some(job),
            Err(why) => self.say("error", why),
        }
    }

    /// A picture at once, as fine as there is time for.
    fn preview(&mut self) {
        let film = self.scene.film();
        let full = [film.width, film.height];
        let pixels = f64::from(full[0]) * f64::from(full[1]);
        let shrink = (pixels / (self.pixels_per_second * PREVIEW_SECONDS)).sqrt().ceil().max(1.0);
        let shrink = (shrink as u32).min(SMALLEST_PREVIEW);
        let size = full.map(|n| n.div_ceil(shrink));
        let mut look = self.look.clone();
        (look.settings.width, look.settings.height) = (Some(size[0]), Some(size[1]));
        look.region =
            look.region.map(|[x0, y0, x1, y1]| [x0 / shrink, y0 / shrink, x1.div_ceil(shrink), y1.div_ceil(shrink)]);
        let Ok(scene) = compile(&mut self.document, &look, Purpose::Preview) else { return };
        let start = Instant::now();
        let raster = Quality::of("raster");
        let plain = Quality { max_depth: Some(2), ..Quality::of(&format!("path:{PLAIN}")) }.spp(1);
        let job = Job::new(&scene, &raster).or_else(|_| Job::new(&scene, &plain));
        let mut job = match job {
            Ok(job) => job,
            Err(why) => return self.say("error", why),
        };
        job.run();
        let seconds = start.elapsed().as_secs_f64().max(1e-4);
        self.pixels_per_second = f64::from(size[0]) * f64::from(size[1]) / seconds;
        let shown = job.shown(self.generation, self.full_crop(), "preview");
        self.backdrop = Some(Backdrop::new(&shown, None));
        self.show(Arc::new(shown));
    }

    /// First paths, without the trials that come before a render.
    fn first_paths(&mut self) {
        let look = &self.look;
        let name = look.settings.integrator.as_deref().and_then(|i| i.split(':').next());
        let Some(name @ ("path" | "volpath")) = name else { return };
        let plain = Quality { integrator: Some(format!("{name}:{PLAIN}")), spp: Some(1), ..quality(look) };
        let Ok(mut job) = Job::new(&self.scene, &plain) else { return };
        job.advance(FIRST_PATHS, &self.interrupt);
        let shown = job.shown(self.generation, self.full_crop(), "render");
        self.backdrop = Some(Backdrop::new(&shown, self.backdrop.as_ref()));
        let shown = Shown { is_done: false, target: quality(look).spp.unwrap_or(self.scene.settings().spp), ..shown };
        self.show(Arc::new(shown));
    }

    /// The part of the picture that is shown, in its pixels.
    fn full_crop(&self) -> [u32; 4] {
        let crop = self.scene.film().crop;
        [crop.x0, crop.y0, crop.x1, crop.y1]
    }

    /// Goes on rendering for as long as a picture may stay.
    fn advance(&mut self) {
        let Some(job) = &mut self.job else { return };
        let shown_after = job.seconds().clamp(SHOW_EVERY[0], SHOW_EVERY[1]);
        job.advance(Duration::from_secs_f64(shown_after), &self.interrupt);
        if self.interrupt.load(Ordering::Relaxed) && !job.is_done() {
            return;
        }
        self.publish();
    }

    /// Shows the render as it is.
    fn publish(&mut self) {
        let crop = self.full_crop();
        let Some(job) = &self.job else {
            let shown = self.shown.lock().unwrap_or_else(PoisonError::into_inner).clone();
            return shown.map_or((), |shown| self.show(shown));
        };
        let shown = Arc::new(job.shown(self.generation, crop, "render"));
        let failure = job.failure();
        self.show(shown);
        if let Some(why) = failure {
            self.say("error", why);
        }
    }

    fn show(&self, shown: Arc<Shown>) {
        let frame = Frame::new(&shown, self.backdrop.as_ref(), &self.look.layers);
        *self.shown.lock().unwrap_or_else(PoisonError::into_inner) = Some(shown);
        self.frame.send_replace(Arc::new(frame));
    }

    fn say(&self, severity: &'static str, text: String) {
        let message = Message { severity, text };
        self.frame.send_modify(|frame| {
            let mut said = Frame::clone(frame);
            said.messages.push(serde_json::to_string(&message).unwrap_or_default());
            *frame = Arc::new(said);
        });
    }
}

/// The folder of the scene's file; of built-in scenes the current one.
pub fn folder(document: &Document) -> PathBuf {
    let file = document.desc.path.as_deref();
    let folder = file.and_then(|f| f.parent()).filter(|f| !f.as_os_str().is_empty());
    folder.map_or_else(|| PathBuf::from("."), PathBuf::from)
}

/// Takes over what is given.
fn set(settings: &mut SettingsChange, change: SettingsChange) -> Result<(), String> {
    let SettingsChange { integrator, spp, sampler, color, seed, max_depth, width, height } = change;
    if let Some(color) = &color
        && !state::COLORS.contains(&color.as_str())
    {
        return Err(format!("there is no colour mode '{color}'; known are {}", state::COLORS.join(", ")));
    }
    let size = [width.or(settings.width), height.or(settings.height)];
    if let [Some(w), Some(h)] = size
        && (w == 0 || h == 0 || w.max(h) > LONGEST_EDGE || u64::from(w) * u64::from(h) > MOST_PIXELS)
    {
        return Err(format!("pictures of {w} x {h} pixels are not shown: at least 1, at most {MOST_PIXELS} in all"));
    }
    if width.is_some() != height.is_some() {
        return Err("'width' and 'height' are set together".into());
    }
    fn replace<T>(old: &mut Option<T>, new: Option<T>) {
        if new.is_some() {
            *old = new;
        }
    }
    replace(&mut settings.integrator, integrator);
    replace(&mut settings.spp, spp);
    replace(&mut settings.sampler, sampler);
    replace(&mut settings.color, color);
    replace(&mut settings.seed, seed);
    replace(&mut settings.max_depth, max_depth);
    (settings.width, settings.height) = (size[0], size[1]);
    Ok(())
}
