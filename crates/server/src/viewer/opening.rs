//! Opening of scenes: the first one with the thread, and others in its place.

use super::{
    Handle, Subject, Viewer,
    pictures::{FIRST_DENOISING, FIRST_PREVIEW, FIRST_SPEED, PREVIEW_SECONDS},
};
use crate::{
    denoiser::{Denoisers, Library},
    document::{Document, Source},
    frame::Frame,
    job::Waiting,
    look::{Look, Purpose, bytes, can_be_denoised, check_memory, check_size, options, quality},
    protocol::{SettingsChange, Severity, told},
    state,
};
use std::{
    panic::{AssertUnwindSafe, catch_unwind},
    sync::{Arc, Mutex, mpsc::channel},
    thread,
    time::Instant,
};
use steradian::{Quality, Scene, method_of, scene::Diagnostics};
use tokio::sync::{broadcast, watch};

/// Samples per pixel up to which a picture grows at least, whatever the scene says.
const FEWEST_SAMPLES: u32 = 256;
/// Messages that wait for a page to read them.
const MOST_MESSAGES: usize = 64;

/// Opens a scene and starts the thread.
///
/// # Errors
/// All that is wrong with the scene.
pub fn start(source: Source, look: Look, library: Library) -> Result<Handle, Diagnostics> {
    let (mut viewer, handle) = open(source, look, library)?;
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

/// Samples per pixel where none are asked for; `None` for those of the scene, if they are enough to go on looking.
fn usual_spp(scene: &Scene) -> Option<u32> {
    (scene.settings().spp < FEWEST_SAMPLES).then_some(FEWEST_SAMPLES)
}

/// Opens a scene.
pub(super) fn open(source: Source, mut look: Look, library: Library) -> Result<(Viewer, Handle), Diagnostics> {
    let mut document = Document::open(source)?;
    if look.view.is_some() && !state::is_movable(&document, &look) {
        return Err(refusal("this camera cannot be moved (--look-at)".into()));
    }
    quality(&look).request().map_err(|e| refusal(e.to_string()))?;
    let scene = compile(&mut document, &look, Purpose::Render)?;
    look.settings.integrator.get_or_insert_with(|| default_name(&scene));
    look.settings.spp.get_or_insert_with(|| usual_spp(&scene));
    let denoisers = Denoisers::new(library);
    look.choose_denoiser(&scene, denoisers.best);
    if let Some(denoiser) = look.settings.denoise.flatten() {
        denoiser.check(&denoisers).map_err(refusal)?;
        can_be_denoised(&look, &scene).map_err(refusal)?;
    }
    let held = held(&document, &look, &scene, 0).map_err(refusal)?;
    let (tasks, from_pages) = channel();
    let (frame, frames) = watch::channel(Arc::new(Frame::default()));
    let (state, states) = watch::channel(Arc::from(""));
    let (quality, names) = (quality(&look), document.names());
    let first = Subject { generation: 0, scene: Arc::clone(&scene), quality, names };
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
        preview: None,
        is_fine: false,
        denoisers,
        denoising: 0.0,
        chosen_denoising: FIRST_DENOISING,
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
    /// Opens another scene in place of this one.
    pub(super) fn open(&mut self, source: Source) -> Result<(), Vec<String>> {
        let lines = |d: Diagnostics| vec![told(&d)];
        let source = Source { memory: self.document.source.memory, ..source };
        let mut document = Document::open(source).map_err(lines)?;
        let SettingsChange { color, denoise, .. } = self.look.settings.clone();
        let settings = SettingsChange { color, denoise, ..SettingsChange::default() };
        let mut look = Look { layers: self.look.layers.clone(), settings, ..Look::default() };
        let scene = compile(&mut document, &look, Purpose::Render).map_err(lines)?;
        look.settings.integrator = Some(default_name(&scene));
        look.settings.spp = Some(usual_spp(&scene));
        look.choose_denoiser(&scene, self.denoisers.best);
        if can_be_denoised(&look, &scene).is_err() {
            look.settings.denoise = None;
        }
        self.held = held(&document, &look, &scene, self.held).map_err(|why| vec![why])?;
        (self.document, self.look, self.scene, self.drawn) = (document, look, scene, None);
        self.stamps = self.document.stamps();
        self.seen.clone_from(&self.stamps);
        (self.pixels_per_second, self.paths_per_second) = (FIRST_PREVIEW / PREVIEW_SECONDS, FIRST_SPEED);
        Ok(())
    }
}
