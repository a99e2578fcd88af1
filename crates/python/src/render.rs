//! Rendering under watch: a thread takes the samples, while the calling one looks at signals and tells how far it is.

use crate::{
    batch,
    faults::{Models, Watch, models_and},
    frames::Frames,
    image::{Facts, Image},
    message::warn,
    own_method,
    progress::Progress,
    resume::Kept,
    settings::Settings,
    stepping::{develop, passes, plan, session},
};
use pyo3::{
    exceptions::{PyKeyboardInterrupt, PyValueError},
    prelude::*,
};
use std::{
    path::PathBuf,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    thread,
    time::{Duration, Instant},
};
use steradian::{Control, Scene, Session};

/// Interval at which the watcher looks.
const LOOK_EVERY: Duration = Duration::from_millis(50);
/// Interval at which the state of the render is kept.
const KEEP_EVERY: Duration = Duration::from_secs(30);

/// Scene to render, and settings.
pub struct Request<'a> {
    pub scene: &'a Arc<Scene>,
    /// All files that the scene is made of.
    pub files: &'a Arc<[PathBuf]>,
    /// Names of its models.
    pub models: &'a Models,
    pub settings: &'a Settings,
    /// Called with a [`Progress`]; `False` stops the render.
    pub progress: Option<&'a Py<PyAny>>,
    /// File that keeps the render, and the fingerprint of the scene's description.
    pub resume: Option<(PathBuf, [u8; 32])>,
    /// Frames before this one.
    pub before: Option<&'a Frames>,
}

/// Renders until all samples are taken, or something ends it.
pub fn run(py: Python<'_>, request: &Request<'_>) -> PyResult<Image> {
    let Request { scene, settings, resume, before, .. } = request;
    batch::refuse_inside("render")?;
    let mut render = plan(settings, scene)?;
    own_method::refuse_inside(render.name)?;
    let faults = Watch::begin(&models_and(request.models, render.name));
    let crop = scene.film().crop;
    let pixels = f64::from(crop.width()) * f64::from(crop.height());
    let planned = pixels * f64::from(render.plan.sampler.spp);
    let kept =
        resume.as_ref().map(|(path, print)| Kept::new(path, *print, scene, settings, &mut render)).transpose()?;
    let mut session = py.detach(|| session(&render, scene))?;
    before.iter().for_each(|before| before.begin(&mut *session));
    kept.as_ref().map_or(Ok(()), |kept| kept.restore(py, &mut *session))?;
    let (ended, fault) = py.detach(|| {
        let control = Control::default();
        let end = watch(&mut *session, &control, request, (kept.as_ref(), &faults), (pixels, planned));
        let fault = kept.as_ref().and_then(|kept| kept.save(&mut *session).err());
        let facts = Facts {
            spp: session.counters().samples as f64 / pixels,
            seconds: session.wall().as_secs_f64(),
            error: session.error(),
            files: request.files.clone(),
            stopped: match &end {
                _ if session.is_good_enough() => Some("error"),
                _ if session.is_done() => None,
                Some(End::Time) => Some("time"),
                Some(End::Asked) => Some("progress"),
                _ => Some("interrupt"),
            },
        };
        if let Some(why) = session.failure() {
            return ((Some(End::Raised(PyValueError::new_err(why))), facts, None), fault);
        }
        let picture = (facts.spp > 0.0).then(|| develop(scene, &*session, &settings.quality.layers));
        before.iter().for_each(|before| before.end(&mut *session));
        ((end, facts, picture), fault)
    });
    // Of functions that are called between the last look and the end.
    faults.fault()?;
    fault.map_or(Ok(()), |why| warn(py, &why))?;
    match ended {
        // Ctrl-C keeps the picture; what a callback raised goes on.
        (Some(End::Raised(e)), _, Some(_)) if !e.is_instance_of::<PyKeyboardInterrupt>(py) => Err(e),
        (_, facts, Some(picture)) => Image::new(py, picture, facts),
        (Some(End::Raised(e)), _, None) => Err(e),
        (_, _, None) => Err(PyValueError::new_err("the render ended before its first sample")),
    }
}

/// Why a render ended before all samples were taken.
enum End {
    Time,
    Asked,
    Raised(PyErr),
}

fn watch(
    session: &mut dyn Session,
    control: &Control,
    request: &Request<'_>,
    (kept, faults): (Option<&Kept<'_>>, &Watch),
    (pixels, planned): (f64, f64),
) -> Option<End> {
    let start = Instant::now();
    let before = session.counters().samples;
    let done = AtomicBool::new(false);
    let watcher = thread::current();
    let mut end = None;
    thread::scope(|scope| {
        let done = &done;
        scope.spawn(move || {
            // Also when rendering panics the watcher must learn of it.
            let _done = Done(done, watcher);
            let mut last = Instant::now();
            passes(session, control, |session| {
                if let Some(kept) = kept.filter(|_| last.elapsed() >= KEEP_EVERY) {
                    // What fails on the way may go well at the end, which tells of it.
                    let _ = kept.save(session);
                    last = Instant::now();
                }
            });
        });
        while !done.load(Ordering::Acquire) {
            thread::park_timeout(LOOK_EVERY);
            if end.is_some() {
                continue;
            }
            if faults.has_fault() {
                end = faults.fault().err().map(End::Raised);
                control.cancel.store(true, Ordering::Relaxed);
                continue;
            }
            let seconds = start.elapsed().as_secs_f64();
            let samples = (before + control.samples.load(Ordering::Relaxed)) as f64;
            let progress = Progress { fraction: samples / planned, spp: samples / pixels, seconds, parts: None };
            end = look(request, progress);
            if end.is_some() {
                control.cancel.store(true, Ordering::Relaxed);
            }
        }
    });
    end
}

fn look(request: &Request<'_>, progress: Progress) -> Option<End> {
    if request.settings.time.is_some_and(|t| progress.seconds >= t) {
        return Some(End::Time);
    }
    Python::attach(|py| {
        if let Err(e) = py.check_signals() {
            return Some(End::Raised(e));
        }
        match request.progress?.bind(py).call1((progress,)) {
            Ok(answer) if answer.extract::<bool>().is_ok_and(|goes_on| !goes_on) => Some(End::Asked),
            Ok(_) => None,
            Err(e) => Some(End::Raised(e)),
        }
    })
}

/// Tells the watcher, when it goes away, that there is nothing more to watch.
struct Done<'a>(&'a AtomicBool, thread::Thread);

impl Drop for Done<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Release);
        self.1.unpark();
    }
}
