//! Changes of the scene and its view by requests.

use crate::{
    denoiser::Denoisers,
    document::Document,
    edits::{Edit, What},
    frame, groups,
    look::{Look, Purpose, View, bytes, can_be_denoised, check_memory, quality, set},
    names::labels,
    protocol::{Request, told},
    state,
    viewer::{Invalidates, Viewer, compile},
};
use std::sync::Arc;
use steradian::{Scene, scene::NodeId};

/// Scene that can be rendered as it is looked at, and the bytes that its pictures take.
type Remade = (Arc<Scene>, u64);

/// Compiles the scene as it is to be looked at, and sees whether it can be rendered so. `held` are the bytes of the
/// picture before, which goes.
fn remade(document: &mut Document, look: &mut Look, held: u64, denoisers: &Denoisers) -> Result<Remade, String> {
    let scene = compile(document, look, Purpose::Render).map_err(|d| told(&d))?;
    look.choose_denoiser(&scene, denoisers.best);
    let render = quality(look).render(&scene).map_err(|e| e.to_string())?;
    let needed = bytes(&render, &scene, look);
    let there_is = document.source.memory.and_then(|there_is| there_is());
    check_memory(needed, held, there_is)?;
    // The usual denoiser is one that can be had, and none where it cannot be used.
    let chosen = look.settings.denoise.flatten();
    if let Some(denoiser) = chosen {
        can_be_denoised(look, &scene)?;
        denoiser.check(denoisers)?;
    }
    if look.settings.light_groups == Some(true) {
        if chosen.is_some() {
            return Err("a picture without its noise has no light groups: only one of both can be on".into());
        }
        groups::check(&scene)?;
    }
    Ok((scene, needed))
}

impl Viewer {
    /// Carries out what a page asks for.
    pub fn request(&mut self, request: Request) -> Result<Invalidates, String> {
        if let Request::Edit { node, parameter, value, moving } = request {
            self.edit(Edit { what: What::Parameter { node, parameter, value }, moving })?;
            return Ok(Invalidates::Scene);
        }
        if let Request::Define { name, value, moving } = request {
            let before = self.look.clone();
            self.define(name, value, moving).inspect_err(|_| self.look = before)?;
            return Ok(Invalidates::Scene);
        }
        let before = self.look.clone();
        let revert: fn(&mut Document) = match request {
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

    /// Compiles the scene as it is to be looked at; while a hand is on the camera, previews alone do.
    pub fn remake(&mut self) -> Result<(), String> {
        self.drawn = None;
        if !self.look.moving {
            (self.scene, self.held) = remade(&mut self.document, &mut self.look, self.held, &self.denoisers)?;
        }
        Ok(())
    }

    /// Makes an edit. The scene that is compiled to check it is the one that is shown: the preview's while a hand is
    /// on the parameter, otherwise the render's.
    fn edit(&mut self, edit: Edit) -> Result<(), String> {
        let moving = edit.moving;
        let mut look = Look { moving, ..self.look.clone() };
        if moving {
            let coarse = self.preview_look();
            let drawn = |document: &mut Document| compile(document, &coarse, Purpose::Preview).map_err(|d| told(&d));
            self.drawn = Some(self.document.edit(edit, drawn)?);
        } else {
            let (held, denoisers) = (self.held, &self.denoisers);
            let remade = self.document.edit(edit, |document| remade(document, &mut look, held, denoisers))?;
            (self.scene, self.held) = remade;
            self.drawn = None;
        }
        self.look = look;
        Ok(())
    }

    /// Lights the scene by an environment map.
    pub fn set_environment(&mut self, name: String, picture: Arc<[u8]>) -> Result<(), String> {
        let to_world = state::environment_to_world(&self.document, &self.look, &self.scene);
        self.edit(Edit { what: What::Environment { name, picture, to_world }, moving: false })
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
                // Those without a name of their own go by their number.
                let has_name = |k: &NodeId| document.desc.node(*k).name.as_ref() == Some(&name);
                let labels = labels(&document.desc);
                let nameless = |k: &NodeId| !has_name(k) && labels[k.0 as usize] == name;
                let number = document.desc.cameras.iter().position(nameless);
                let name = number.map_or(name, |k| k.to_string());
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
            Request::Undo => {
                look.moving = false;
                document.undo().then_some(Invalidates::Scene).ok_or_else(|| "there is nothing to undo".into())
            }
            Request::Redo => {
                look.moving = false;
                document.redo().then_some(Invalidates::Scene).ok_or_else(|| "there is nothing to redo".into())
            }
            // Made by `edit` and `define`.
            Request::Edit { .. } | Request::Define { .. } => Ok(Invalidates::Nothing),
            Request::Pause { on } => {
                look.paused = on;
                Ok(if on || job.is_some() { Invalidates::State } else { Invalidates::Picture })
            }
        }
    }
}
