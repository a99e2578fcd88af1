//! Preparation of renders by the pipeline before their first pass, and the fault that ended them.

use crate::{Error, draw_list::DrawList};
use std::sync::{Mutex, PoisonError};
use steradian_engine::Run;

/// Draw list and thread pool, once they are there, and the fault that ended the render.
#[derive(Debug, Default)]
pub struct Preparation {
    made: Option<(DrawList, rayon::ThreadPool)>,
    failure: Mutex<Option<String>>,
}

impl Preparation {
    /// Makes both; `None` where the system gives no threads.
    pub fn make(&mut self, run: &Run<'_>) -> Option<()> {
        match rayon::ThreadPoolBuilder::new().num_threads(run.threads).build() {
            Ok(pool) => self.made = Some((DrawList::new(run.scene), pool)),
            Err(e) => self.fail(format!("the system gives no threads: {e}")),
        }
        self.made.is_some().then_some(())
    }

    /// Draw list and thread pool, once they are made.
    pub fn get(&self) -> Option<&(DrawList, rayon::ThreadPool)> {
        self.made.as_ref()
    }

    /// Result of a pass; a fault is kept, and ends the render.
    pub fn outcome<T>(&self, found: Result<Option<T>, Error>) -> Option<T> {
        found.unwrap_or_else(|e| {
            self.fail(e.to_string());
            None
        })
    }

    /// Why no more passes can be taken, where that is so.
    pub fn failure(&self) -> Option<String> {
        self.failure.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    fn fail(&self, why: String) {
        *self.failure.lock().unwrap_or_else(PoisonError::into_inner) = Some(why);
    }
}
