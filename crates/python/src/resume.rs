//! The file that keeps a render, to go on from, as `--resume` of the command line does.

use crate::{message::warn, settings::Settings};
use pyo3::{exceptions::PyValueError, prelude::*};
use std::path::{Path, PathBuf};
use steradian::{
    Render, Scene, Session,
    resume::{self, Recipe, StateError},
};

/// A file that keeps a render.
pub struct Kept<'a> {
    path: &'a Path,
    recipe: Recipe,
    /// The file to go on from.
    source: Option<PathBuf>,
    /// Samples per pixel in all, those that are kept included.
    spp: u32,
}

fn unusable(state: &Path, why: &StateError) -> PyErr {
    PyValueError::new_err(format!("{} {why}; without that file the render begins anew", state.display()))
}

impl<'a> Kept<'a> {
    /// The file for a plan, which then begins as the one that was kept did.
    pub fn new(
        path: &'a Path,
        fingerprint: [u8; 32],
        scene: &Scene,
        settings: &Settings,
        render: &mut Render,
    ) -> PyResult<Self> {
        if std::fs::metadata(path).is_ok_and(|there| !there.is_file()) {
            let why = "is not a regular file, and a render cannot be kept in it";
            return Err(PyValueError::new_err(format!("resume: '{}' {why}", path.display())));
        }
        let (source, spp) = (resume::source(path), render.plan.sampler.spp);
        if let Some(source) = &source {
            // What was planned first counts for the bits; the rest comes on top.
            render.plan.sampler.spp = resume::samples(source).map_err(|e| unusable(source, &e))?.min(spp);
        }
        Ok(Self { path, recipe: Recipe::new(scene, fingerprint, &settings.options, render), source, spp })
    }

    /// Lets a session go on from the file, where it is there.
    pub fn restore(&self, py: Python<'_>, session: &mut dyn Session) -> PyResult<()> {
        let Some(source) = &self.source else { return Ok(()) };
        py.detach(|| self.recipe.restore(session, source)).map_err(|e| unusable(source, &e))?;
        if source != self.path {
            let (state, before) = (self.path.display(), source.display());
            warn(py, &format!("{state} is damaged; the state before it is taken, {before}"))?;
            // In the place of the damaged one: the next is kept beside it.
            std::fs::rename(source, self.path)?;
        }
        if session.extend(self.spp) {
            return Ok(());
        }
        let why = format!("was to have more than {} samples per pixel", self.spp);
        Err(unusable(source, &StateError::OtherSettings(why)))
    }

    /// Saves the session; the state before keeps a file of its own.
    pub fn save(&self, session: &mut dyn Session) -> Result<(), String> {
        self.recipe.keep(session, self.path).map_err(|e| format!("the render cannot be kept: {e}"))
    }
}
