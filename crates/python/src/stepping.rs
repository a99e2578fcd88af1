//! Sessions of renders: begun, stepped until they are done, and developed.

use crate::{own, settings::Settings};
use pyo3::{exceptions::PyValueError, prelude::*};
use std::sync::{Arc, atomic::Ordering};
use steradian::{
    Control, Layer, Render, Scene, Session,
    image::{Image, Value, Window},
};

/// The plan of a scene's render; refuses one that is to be denoised and cannot be.
pub fn plan(settings: &Settings, scene: &Scene) -> PyResult<Render> {
    let Settings { quality, is_denoised, .. } = settings;
    let render = own::registry().plan(scene, quality).map_err(|e| PyValueError::new_err(e.to_string()))?;
    match render.not_denoisable(scene).filter(|_| *is_denoised) {
        Some(why) => Err(PyValueError::new_err(format!("denoise is not for '{}' here: {why}", render.name))),
        None => Ok(render),
    }
}

/// A session before its first step.
pub fn session(render: &Render, scene: &Arc<Scene>) -> PyResult<Box<dyn Session>> {
    render.session(scene).map_err(|e| PyValueError::new_err(e.to_string()))
}

/// Passes of growing size, small enough that a stop is answered soon, each followed by something else.
pub fn passes(session: &mut dyn Session, control: &Control, mut after: impl FnMut(&mut dyn Session)) {
    let mut samples = 1;
    while !session.is_done() && !control.cancel.load(Ordering::Relaxed) {
        session.step(samples, control);
        samples = (2 * samples).min(1024);
        after(session);
    }
}

/// The picture of a session, with what filters and comparisons ask of it: its place in the frame, and its samples.
pub fn develop(scene: &Scene, session: &dyn Session, layers: &[Layer]) -> Image {
    let film = session.film();
    let mut picture = steradian::develop(scene, &film, layers);
    let spp = session.counters().samples as f64 / film.pixels.len().max(1) as f64;
    let is_whole = spp.fract() == 0.0 && spp < f64::from(i32::MAX);
    let samples = if is_whole { Value::Int(spp as i32) } else { Value::Float(spp as f32) };
    picture.metadata.set("samplesPerPixel", samples);
    let (crop, [width, height]) = (film.crop, [scene.film().width, scene.film().height]);
    if (crop.width(), crop.height()) != (width, height) {
        picture.offset = [crop.x0 as i32, crop.y0 as i32];
        picture.frame = Some(Window { min: [0, 0], max: [width as i32, height as i32] });
    }
    picture
}
