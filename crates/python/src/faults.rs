//! Exceptions of functions of Python, told to the renders and measurements that may have called them.

use pyo3::prelude::*;
use std::{
    collections::BTreeSet,
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicUsize, Ordering},
    },
};
use steradian::scene::SceneDesc;

/// Renders and measurements that go on.
static WATCHES: Mutex<Vec<Arc<Watched>>> = Mutex::new(Vec::new());
/// Number of those that met an exception.
static ENDING: AtomicUsize = AtomicUsize::new(0);

/// Names of models that a scene has, among them those of the program's own.
pub type Models = Arc<[String]>;

/// Names of the models of a scene, each once.
pub fn models(desc: &SceneDesc) -> Models {
    let kinds: BTreeSet<&str> = desc.nodes.iter().map(|node| node.kind.as_str()).collect();
    kinds.into_iter().map(str::to_owned).collect()
}

/// Names of models, and one more.
pub fn models_and(models: &Models, more: &str) -> Models {
    models.iter().map(String::as_str).chain([more]).map(str::to_owned).collect()
}

#[derive(Debug)]
struct Watched {
    models: Models,
    fault: Mutex<Option<PyErr>>,
}

/// A render or measurement that goes on, and the first exception of a function of one of its models.
#[derive(Debug)]
pub struct Watch(Arc<Watched>);

impl Watch {
    /// Begins to watch.
    pub fn begin(models: &Models) -> Self {
        let watched = Arc::new(Watched { models: models.clone(), fault: Mutex::default() });
        lock(&WATCHES).push(watched.clone());
        Self(watched)
    }

    /// True if a function raised.
    pub fn has_fault(&self) -> bool {
        ENDING.load(Ordering::Acquire) > 0 && lock(&self.0.fault).is_some()
    }

    /// The exception, if a function raised one.
    pub fn fault(&self) -> PyResult<()> {
        match &*lock(&self.0.fault) {
            Some(why) => Err(Python::attach(|py| why.clone_ref(py))),
            None => Ok(()),
        }
    }
}

impl Drop for Watch {
    fn drop(&mut self) {
        lock(&WATCHES).retain(|watched| !Arc::ptr_eq(watched, &self.0));
        if lock(&self.0.fault).is_some() {
            ENDING.fetch_sub(1, Ordering::AcqRel);
        }
    }
}

/// All that go on with a model.
fn watches(model: &str) -> Vec<Arc<Watched>> {
    lock(&WATCHES).iter().filter(|watched| watched.models.iter().any(|name| name == model)).cloned().collect()
}

/// Tells an exception to all that go on with this model. Where nothing does, it is printed.
pub fn raise(py: Python<'_>, model: &str, why: &PyErr) {
    let watches = watches(model);
    for watched in &watches {
        let mut fault = lock(&watched.fault);
        if fault.is_none() {
            *fault = Some(why.clone_ref(py));
            ENDING.fetch_add(1, Ordering::AcqRel);
        }
    }
    if watches.is_empty() {
        why.clone_ref(py).write_unraisable(py, None);
    }
}

/// True if all that goes on with this model has met an exception: nobody needs more of its values.
pub fn is_over(model: &str) -> bool {
    if ENDING.load(Ordering::Acquire) == 0 {
        return false;
    }
    let watches = watches(model);
    !watches.is_empty() && watches.iter().all(|watched| lock(&watched.fault).is_some())
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
