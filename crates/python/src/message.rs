//! Messages of reading and compiling.

use crate::SceneError;
use pyo3::{exceptions::PyUserWarning, prelude::*};
use std::ffi::CString;
use steradian::scene::{Diagnostic, Diagnostics, Severity};

/// One thing that reading or compiling had to say.
#[pyclass(frozen, get_all, module = "steradian")]
#[derive(Clone)]
pub struct Message {
    /// `error`, `warning`, `note`, or what was lost: `approximated`, `dropped`, `unused`.
    kind: &'static str,
    /// One sentence.
    message: String,
    /// The file, if it has a place in one.
    path: Option<String>,
    /// From 1.
    line: Option<u32>,
    /// From 1, in characters.
    column: Option<u32>,
    /// Suggested remedy.
    help: Option<String>,
    /// All of it, with the line and carets.
    text: String,
}

#[pymethods]
impl Message {
    fn __str__(&self) -> &str {
        &self.text
    }

    fn __repr__(&self) -> String {
        format!("<steradian.Message {}: {}>", self.kind, self.message)
    }
}

impl From<&Diagnostic> for Message {
    fn from(d: &Diagnostic) -> Self {
        let at = d.location.as_ref();
        Self {
            kind: d.kind(),
            message: d.message.clone(),
            path: at.map(|l| l.path.clone()),
            line: at.map(|l| l.line),
            column: at.map(|l| l.column),
            help: d.help.clone(),
            text: d.to_string(),
        }
    }
}

/// The exception for messages among which are errors.
pub fn error(diagnostics: &Diagnostics) -> PyErr {
    let texts: Vec<String> =
        diagnostics.iter().filter(|d| d.severity == Severity::Error).map(ToString::to_string).collect();
    SceneError::new_err(texts.join("\n"))
}

/// Warns the caller of the package's function.
pub fn warn(py: Python<'_>, what: &str) -> PyResult<()> {
    let text = CString::new(what.replace('\0', " "))?;
    PyErr::warn(py, &py.get_type::<PyUserWarning>(), &text, 2)
}
