//! A scene in the browser while it renders.

use pyo3::{exceptions::PyOSError, prelude::*};
use std::{
    path::PathBuf,
    sync::{Arc, Mutex, PoisonError},
};
use steradian::{formats::Options, scene::SceneDesc};
use steradian_server::{Error, Options as ViewOptions, SettingsChange, Source};

/// A page that shows a scene as it was when the view began; it ends when it is closed, or goes away.
#[pyclass(frozen, module = "steradian")]
pub struct View {
    /// Its address, which holds a secret.
    #[pyo3(get)]
    url: String,
    server: Mutex<Option<steradian_server::View>>,
}

impl View {
    /// Shows a scene.
    ///
    /// # Errors
    /// Where the scene cannot be rendered, or no port can be had.
    pub fn start(
        py: Python<'_>,
        scene: Arc<SceneDesc>,
        reading: Options,
        (settings, bind, port): (SettingsChange, String, u16),
    ) -> PyResult<Self> {
        let name = scene.path.clone().unwrap_or_else(|| PathBuf::from("scene"));
        let source = Source { name, reading, scene: Some(scene), ..Source::default() };
        let options = ViewOptions { source, settings, bind, port, ..ViewOptions::of("") };
        let server = py.detach(|| steradian_server::View::start(&options)).map_err(|e| match e {
            Error::Scene(messages) => crate::message::error(&messages),
            other => PyOSError::new_err(other.to_string()),
        })?;
        Ok(Self { url: server.url().to_owned(), server: Mutex::new(Some(server)) })
    }
}

#[pymethods]
impl View {
    /// Ends it; once more does nothing.
    fn close(&self, py: Python<'_>) {
        let server = self.server.lock().unwrap_or_else(PoisonError::into_inner).take();
        py.detach(|| drop(server));
    }

    fn __enter__(this: Py<Self>) -> Py<Self> {
        this
    }

    #[pyo3(signature = (*_exception))]
    fn __exit__(&self, py: Python<'_>, _exception: &Bound<'_, pyo3::types::PyTuple>) {
        self.close(py);
    }

    /// HTML shown by notebooks: the page in a frame.
    fn _repr_html_(&self) -> String {
        format!(
            r#"<iframe src="{}" width="100%" height="640" style="border:0" title="Steradian view"></iframe>"#,
            self.url
        )
    }

    fn __repr__(&self) -> String {
        format!("<steradian.View at {}>", self.url)
    }
}
