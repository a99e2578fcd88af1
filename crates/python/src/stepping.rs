//! Sessions of renders: begun, and stepped until they are done.

use pyo3::{exceptions::PyValueError, prelude::*};
use std::sync::{Arc, atomic::Ordering};
use steradian::{Control, Quality, Render, Scene, Session};

/// The render of a scene, and a session of it before its first step.
pub fn begin(quality: &Quality, scene: &Arc<Scene>) -> PyResult<(Render, Box<dyn Session>)> {
    let fault = |e: steradian::Error| PyValueError::new_err(e.to_string());
    let render = quality.render(scene).map_err(fault)?;
    let session = render.session(scene).map_err(fault)?;
    Ok((render, session))
}

/// Passes of growing size, small enough that a stop is answered soon.
pub fn passes(session: &mut dyn Session, control: &Control) {
    let mut samples = 1;
    while !session.is_done() && !control.cancel.load(Ordering::Relaxed) {
        session.step(samples, control);
        samples = (2 * samples).min(1024);
    }
}
