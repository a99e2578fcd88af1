//! Progress of renders.

use crate::{image::Image, parts::Parts};
use pyo3::prelude::*;

/// Progress of a render.
#[pyclass(frozen, module = "steradian")]
pub struct Progress {
    /// Fraction of all samples, from 0 to 1.
    #[pyo3(get)]
    pub fraction: f64,
    /// Samples per pixel so far.
    #[pyo3(get)]
    pub spp: f64,
    /// Seconds so far.
    #[pyo3(get)]
    pub seconds: f64,
    /// The render in parts, if it is one.
    pub parts: Option<Py<Parts>>,
}

#[pymethods]
impl Progress {
    /// Progress of a render in parts.
    #[staticmethod]
    fn of(parts: &Bound<'_, Parts>) -> Self {
        let [fraction, spp, seconds] = parts.get().progress(parts.py());
        Self { fraction, spp, seconds, parts: Some(parts.clone().unbind()) }
    }

    /// The picture so far of a render on other machines; `None` before the first part of it, and of renders here.
    #[getter]
    fn image(&self, py: Python<'_>) -> PyResult<Option<Image>> {
        self.parts.as_ref().map_or(Ok(None), |parts| parts.get().image(py, None))
    }
}
