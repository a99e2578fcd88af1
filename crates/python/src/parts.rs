//! Renders in parts: several processes compute them, and one joins them to the picture.

use crate::{
    batch,
    faults::{self, Models, Watch},
    image::{Facts, Image},
    settings::Settings,
    stepping::{develop, passes, plan, session},
};
use pyo3::{exceptions::PyValueError, prelude::*, types::PyBytes};
use std::{
    ops::Range,
    path::PathBuf,
    sync::{Arc, Mutex, MutexGuard, PoisonError, atomic::Ordering},
    time::Instant,
};
use steradian::{Control, Layer, Scene, Session, resume::Recipe};

/// A render in parts, each of which is a range of the pieces that the work falls into. Either parts are computed, or
/// those that others computed are joined.
#[pyclass(frozen, module = "steradian")]
pub struct Parts {
    scene: Arc<Scene>,
    /// All files that the scene is made of.
    files: Arc<[PathBuf]>,
    models: Models,
    layers: Vec<Layer>,
    recipe: Recipe,
    /// Number of pieces.
    #[pyo3(get)]
    pieces: u32,
    pixels: f64,
    control: Control,
    start: Instant,
    state: Mutex<State>,
}

/// Mutable state of a render in parts.
struct State {
    session: Box<dyn Session>,
    /// Number of pieces that are joined.
    joined: u32,
}

impl Parts {
    /// Begins a render in parts of a scene of that fingerprint.
    pub fn new(
        py: Python<'_>,
        scene: &Arc<Scene>,
        (files, models): (&Arc<[PathBuf]>, &Models),
        settings: &Settings,
        fingerprint: [u8; 32],
    ) -> PyResult<Self> {
        let Settings { quality, options, time, .. } = settings;
        if time.is_some() {
            let why = "a render up to a time cannot be computed in parts: where it ended would depend on the machines";
            return Err(PyValueError::new_err(why));
        }
        batch::refuse_inside("render")?;
        let (render, session) = py.detach(|| {
            let render = plan(settings, scene)?;
            let session = session(&render, scene)?;
            Ok::<_, PyErr>((render, session))
        })?;
        let pieces = session.pieces().map_err(|why| {
            PyValueError::new_err(format!("this render cannot be computed in parts by '{}': {why}", render.name))
        })?;
        let crop = scene.film().crop;
        Ok(Self {
            scene: scene.clone(),
            files: files.clone(),
            models: faults::models_and(models, render.name),
            layers: quality.layers.clone(),
            recipe: Recipe::new(scene, fingerprint, options, &render),
            pieces,
            pixels: f64::from(crop.width()) * f64::from(crop.height()),
            control: Control::default(),
            start: Instant::now(),
            state: Mutex::new(State { session, joined: 0 }),
        })
    }

    /// The state, for this thread alone. Pieces begin anew where a panic left them.
    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Fraction of the pieces that are joined, samples per pixel, and seconds.
    pub fn progress(&self, py: Python<'_>) -> [f64; 3] {
        let (joined, samples) = py.detach(|| {
            let state = self.state();
            (f64::from(state.joined), state.session.counters().samples as f64)
        });
        [joined / f64::from(self.pieces), samples / self.pixels, self.start.elapsed().as_secs_f64()]
    }

    /// As [`Self::compute`].
    fn part(&self, pieces: &Range<u32>) -> PyResult<Option<Vec<u8>>> {
        let session = &mut *self.state().session;
        session.restrict(pieces.clone()).map_err(|why| PyValueError::new_err(why.to_string()))?;
        passes(session, &self.control, |_| ());
        if let Some(why) = session.failure() {
            return Err(PyValueError::new_err(why));
        }
        if !session.is_done() {
            return Ok(None);
        }
        let mut part = Vec::new();
        let recipe = self.recipe.clone().of_pieces(pieces, self.pieces);
        recipe.write(session, &mut part)?;
        Ok(Some(part))
    }
}

#[pymethods]
impl Parts {
    /// Computes pieces, from the first up to the end, which is not among them; one call after the other. The bytes of
    /// the part, or `None` if it was stopped.
    fn compute<'py>(&self, py: Python<'py>, first: u32, end: u32) -> PyResult<Option<Bound<'py, PyBytes>>> {
        batch::refuse_inside("render")?;
        let faults = Watch::begin(&self.models);
        let part = py.detach(|| self.part(&(first..end)))?;
        faults.fault()?;
        Ok(part.map(|part| PyBytes::new(py, &part)))
    }

    /// Ends what is computed, now and later.
    fn stop(&self) {
        self.control.cancel.store(true, Ordering::Relaxed);
    }

    /// Joins a part that another process computed.
    fn join(&self, py: Python<'_>, part: &[u8]) -> PyResult<()> {
        py.detach(|| {
            let mut state = self.state();
            let joined = self.recipe.join_bytes(&mut *state.session, part);
            let pieces = joined.map_err(|why| PyValueError::new_err(format!("a part of the picture {why}")))?;
            state.joined += pieces.len() as u32;
            Ok(())
        })
    }

    /// True if all parts are joined.
    #[getter]
    fn is_done(&self, py: Python<'_>) -> bool {
        py.detach(|| self.state().joined == self.pieces)
    }

    /// The picture of the parts that are joined; `None` before the first. `stopped` is why others are missing.
    #[pyo3(signature = (stopped = None))]
    pub fn image(&self, py: Python<'_>, stopped: Option<&str>) -> PyResult<Option<Image>> {
        let developed = py.detach(|| {
            let state = self.state();
            let facts = Facts {
                spp: state.session.counters().samples as f64 / self.pixels,
                seconds: self.start.elapsed().as_secs_f64(),
                error: state.session.error(),
                stopped: stopped.and_then(Facts::end),
                files: self.files.clone(),
            };
            (state.joined > 0).then(|| (develop(&self.scene, &*state.session, &self.layers), facts))
        });
        developed.map(|(picture, facts)| Image::new(py, picture, facts)).transpose()
    }
}
