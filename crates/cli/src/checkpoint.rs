//! The file that keeps a render, to go on with, and the one before it, for the case that the file is damaged.

use crate::{failure::Failure, terminal::Terminal};
use std::path::Path;
use steradian::{
    Session,
    resume::{Recipe, StateError},
};

/// Refuses what a render cannot be kept in.
pub fn check_state(state: &Path) -> Result<(), Failure> {
    // To open a pipe waits for someone to write.
    match std::fs::metadata(state) {
        Ok(there) if !there.is_file() => {
            let why = "it is not a regular file, and a render cannot be kept in it";
            Err(Failure::bad_input(format!("--resume '{}': {why}", state.display())))
        }
        _ => Ok(()),
    }
}

pub fn unusable(state: &Path, why: &StateError) -> Failure {
    Failure::bad_input(format!("{} {why}; without that file the render begins anew", state.display()))
}

/// Keeps a session in a file.
pub struct Checkpoint<'a> {
    pub path: &'a Path,
    pub recipe: Recipe,
    pub terminal: Terminal,
}

impl Checkpoint<'_> {
    /// Lets a session go on from the [`source`] of the state, to `total` samples per pixel.
    pub fn restore(
        &self,
        session: &mut dyn Session,
        path: &Path,
        (pixels, total): (u64, Option<u32>),
    ) -> Result<(), Failure> {
        self.recipe.restore(session, path).map_err(|e| unusable(path, &e))?;
        if path != self.path {
            let (state, before) = (self.path.display(), path.display());
            self.terminal.warn(&format!("{state} is damaged; the state before it is taken, {before}"));
            // In the place of the damaged one: the next is kept beside it.
            let failed = |e| Failure::failed(format!("cannot rename '{before}' to '{state}': {e}"));
            std::fs::rename(path, self.path).map_err(failed)?;
        }
        if let Some(spp) = total.filter(|spp| !session.extend(*spp)) {
            let why = format!("was to have more than {spp} samples per pixel");
            return Err(unusable(path, &StateError::OtherSettings(why)));
        }
        let spp = session.counters().samples as f64 / pixels as f64;
        self.terminal.say(&format!("going on from {} at {spp:.1} samples per pixel", path.display()));
        Ok(())
    }

    /// Saves the session. The state before gets a name of its own first.
    pub fn save(&self, session: &mut dyn Session) -> Result<(), String> {
        self.recipe.keep(session, self.path).map_err(|e| format!("the render cannot be kept: {e}"))
    }

    /// Saves on the way: what fails now may go well later.
    pub fn keep(&self, session: &mut dyn Session) {
        if let Err(message) = self.save(session) {
            self.terminal.warn(&message);
        }
    }
}
