//! Free viewpoints.

use crate::message;
use pyo3::{exceptions::PyValueError, prelude::*};
use std::sync::Arc;
use steradian::{
    Viewpoint,
    formats::{Options, native},
    scene::SceneDesc,
};

/// Viewpoint to which a scene's camera is moved, and its angle of view, degrees.
#[derive(Clone, Debug)]
pub struct Look {
    view: Viewpoint,
    fov: Option<f64>,
}

impl Look {
    /// Viewpoint by eye, target, and the direction that is up.
    pub fn new([eye, target, up]: [[f64; 3]; 3], fov: Option<f64>) -> PyResult<Self> {
        let view = Viewpoint { eye: eye.into(), target: target.into(), up: up.into() };
        if !view.is_sound() {
            let what = "look_at takes a target apart from the origin, and a direction up that is not along the view";
            return Err(PyValueError::new_err(format!("{what}, not {eye:?}, {target:?} and {up:?}")));
        }
        if let Some(fov) = fov.filter(|fov| !(*fov > 0.0 && *fov < 180.0)) {
            return Err(PyValueError::new_err(format!("fov is an angle above 0 and below 180 degrees, not {fov}")));
        }
        Ok(Self { view, fov })
    }

    /// The description with its camera, by name or the first, moved.
    pub fn place(&self, desc: &Arc<SceneDesc>, camera: Option<&str>, options: &Options) -> PyResult<Arc<SceneDesc>> {
        let fault = |what: &str| PyValueError::new_err(what.to_owned());
        let camera = desc.camera(camera).ok_or_else(|| fault("the scene has no camera that look_at could move"))?;
        let mut desc = SceneDesc::clone(desc);
        if !self.view.place(&mut desc, camera) {
            return Err(fault("look_at cannot move the camera, whose own transform is singular"));
        }
        if let Some(fov) = self.fov {
            native::set(&mut desc, camera, "fov", &format!("{fov:?}"), options).map_err(|e| message::error(&e))?;
        }
        Ok(Arc::new(desc))
    }
}
