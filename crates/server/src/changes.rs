//! Changes of the scene and its view by requests.

use crate::{
    document::Document,
    edits::{Edit, What},
    frame, groups,
    look::{Purpose, View, bytes, check_memory, options, quality, set},
    protocol::{Request, told},
    state,
    viewer::{Invalidates, Viewer, compile},
};
use std::sync::Arc;

impl Viewer {
    /// Carries out what a page asks for.
    pub fn request(&mut self, request: Request) -> Result<Invalidates, String> {
        let before = self.look.clone();
        let revert: fn(&mut Document) = match request {
            Request::Edit { .. } => Document::take_back,
            Request::Undo => |document| _ = document.redo(),
            Request::Redo => |document| _ = document.undo(),
            _ => |_| {},
        };
        let invalid = self.change(request)?;
        if invalid >= Invalidates::Scene
            && let Err(why) = self.remake()
        {
            self.look = before;
            revert(&mut self.document);
            return Err(why);
        }
        Ok(invalid)
    }

    /// Compiles the scene as it is to be looked at, and sees whether it can be rendered so.
    pub fn remake(&mut self) -> Result<(), String> {
        if self.look.moving {
            return Ok(());
        }
        let scene = compile(&mut self.document, &self.look, Purpose::Render).map_err(|d| told(&d))?;
        let render = quality(&self.look).render(&scene).map_err(|e| e.to_string())?;
        let needed = bytes(&render, &scene, &self.look);
        let there_is = self.document.source.memory.and_then(|there_is| there_is());
        check_memory(needed, self.held, there_is)?;
        let denoiser = self.look.settings.denoise.flatten();
        if let Some(denoiser) = denoiser {
            if let Some(why) = render.not_denoisable(&scene) {
                return Err(format!("noise cannot be removed here: {why}"));
            }
            denoiser.check(&self.library)?;
        }
        if self.look.settings.light_groups == Some(true) {
            if denoiser.is_some() {
                return Err("a picture without its noise has no light groups: only one of both can be on".into());
            }
            groups::check(&scene)?;
        }
        (self.scene, self.held) = (scene, needed);
        Ok(())
    }

    /// Lights the scene by an environment map.
    pub fn set_environment(&mut self, name: String, picture: Arc<[u8]>) -> Result<(), String> {
        let to_world = state::environment_to_world(&self.document, &self.look, &self.scene);
        let options = options(&self.look, self.document.desc.format, Purpose::Render);
        let edit = Edit { what: What::Environment { name, picture, to_world }, moving: false };
        self.document.edit(edit, &options)?;
        self.look.moving = false;
        let remade = self.remake();
        if remade.is_err() {
            self.document.take_back();
        }
        remade
    }

    fn change(&mut self, request: Request) -> Result<Invalidates, String> {
        let Self { document, look, job, .. } = self;
        match request {
            Request::Camera { eye, target, up, fov, moving } => {
                let point = steradian::Viewpoint { eye: eye.into(), target: target.into(), up: up.into() };
                if !point.is_sound() {
                    return Err("the camera cannot stand in what it looks at, nor have 'up' along its view".into());
                }
                if !state::is_movable(document, look) {
                    return Err("this camera cannot be moved".into());
                }
                if fov.is_some_and(|fov| !(fov > 0.0 && fov < 180.0)) {
                    return Err("a field of view is above 0 and below 180 degrees".into());
                }
                look.view = Some(View { point, fov: fov.or(look.view.and_then(|v| v.fov)) });
                look.moving = moving;
                Ok(Invalidates::Scene)
            }
            Request::CameraName { name } => {
                let Some(_) = document.desc.camera(Some(&name)) else {
                    return Err(format!("there is no camera '{name}'"));
                };
                (look.camera, look.view, look.moving) = (Some(name), None, false);
                Ok(Invalidates::Scene)
            }
            Request::CameraReset => {
                (look.view, look.moving) = (None, false);
                Ok(Invalidates::Scene)
            }
            Request::Settings(change) => {
                set(&mut look.settings, change)?;
                (look.region, look.moving) = (None, false);
                Ok(Invalidates::Scene)
            }
            Request::Region { pixels } => {
                (look.region, look.moving) = (pixels, false);
                Ok(Invalidates::Scene)
            }
            Request::Layers { names } => {
                look.layers = names.iter().map(|name| frame::layer(name)).collect::<Result<_, _>>()?;
                Ok(Invalidates::Layers)
            }
            Request::Edit { node, parameter, value, moving } => {
                let purpose = if moving { Purpose::Preview } else { Purpose::Render };
                let options = options(look, document.desc.format, purpose);
                let what = What::Parameter { node, parameter, value };
                document.edit(Edit { what, moving }, &options)?;
                look.moving = moving;
                Ok(Invalidates::Scene)
            }
            Request::Undo => {
                look.moving = false;
                document.undo().then_some(Invalidates::Scene).ok_or_else(|| "there is nothing to undo".into())
            }
            Request::Redo => {
                look.moving = false;
                document.redo().then_some(Invalidates::Scene).ok_or_else(|| "there is nothing to redo".into())
            }
            Request::Pause { on } => {
                look.paused = on;
                Ok(if on || job.is_some() { Invalidates::State } else { Invalidates::Picture })
            }
        }
    }
}
