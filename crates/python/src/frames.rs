//! State that the frames of an animation hand on.

use pyo3::prelude::*;
use std::sync::{Mutex, PoisonError};
use steradian::{History, Session};

/// State that each frame of an animation leaves to the next one.
#[pyclass(frozen, module = "steradian")]
#[derive(Default)]
pub struct Frames(Mutex<Option<History>>);

impl Frames {
    /// Lets a session go on from the frame before.
    pub fn begin(&self, session: &mut dyn Session) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).iter().for_each(|history| session.follow(history));
    }

    /// Keeps what a session leaves.
    pub fn end(&self, session: &mut dyn Session) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = session.take_history();
    }
}

#[pymethods]
impl Frames {
    #[new]
    fn new() -> Self {
        Self::default()
    }
}
