//! The scene read with other definitions (`-D NAME=VALUE`).

use super::{Viewer, compile};
use crate::{
    look::{Purpose, View},
    protocol::told,
    state, surroundings,
};

impl Viewer {
    /// Reads the scene with another definition, or without it; while a hand is on it, previews alone are made. Where it
    /// fails the document stays, and the caller puts the look back.
    pub fn define(&mut self, name: String, value: Option<String>, moving: bool) -> Result<(), String> {
        surroundings::check(&self.document, &name, value.as_deref())?;
        let mut source = self.document.source.clone();
        // The camera of a scene without one would follow what moves.
        if name == "at" && self.look.view.is_none() {
            self.look.view =
                state::viewpoint(&self.document, &self.look, &self.scene).map(|point| View { point, fov: None });
        }
        match value {
            Some(value) => _ = source.reading.defines.insert(name, value),
            None => _ = source.reading.defines.remove(&name),
        }
        let (fresh, lost) = self.document.read_again(source).map_err(|d| told(&d))?;
        let old = self.document.replace(fresh);
        self.look.moving = moving;
        let coarse = self.preview_look();
        let done = match moving {
            true => compile(&mut self.document, &coarse, Purpose::Preview)
                .map(|scene| self.drawn = Some(scene))
                .map_err(|d| told(&d)),
            false => self.remake(),
        };
        match done {
            Ok(()) => self.tell_lost(lost),
            Err(_) => _ = self.document.replace(old),
        }
        done
    }
}
