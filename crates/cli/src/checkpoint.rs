//! The file that keeps a render, to go on with, and the one before it, for the case that the file is damaged.

use crate::{failure::Failure, terminal::Terminal};
use std::path::{Path, PathBuf};
use steradian::{
    Session,
    resume::{self, Recipe, StateError},
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

/// The file of the state before that in `state`.
pub fn before(state: &Path) -> PathBuf {
    let mut name = state.as_os_str().to_owned();
    name.push(".before");
    name.into()
}

/// The file to go on from: that of a state, or of the one before where that is damaged. `None` where there is none.
pub fn source(state: &Path) -> Option<PathBuf> {
    if !state.exists() {
        return None;
    }
    let is_damaged = |path: &Path| matches!(resume::state_file(path), Err(StateError::Damaged | StateError::NotAState));
    let before = before(state);
    Some(if is_damaged(state) && resume::state_file(&before).is_ok() { before } else { state.to_path_buf() })
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
        if self.path.exists() {
            let before = before(self.path);
            // A second name of the file: that of the state is never without a file. A draft that a killed process left
            // may be such a name, too: nothing is written into it.
            let draft = before.with_extension("draft");
            let _ = std::fs::remove_file(&draft);
            let linked = std::fs::hard_link(self.path, &draft).or_else(|_| std::fs::copy(self.path, &draft).map(drop));
            let _ = linked.and_then(|()| std::fs::rename(&draft, &before));
            // Where both are names of one file already, renaming leaves both.
            let _ = std::fs::remove_file(&draft);
        }
        self.recipe.save(session, self.path).map_err(|e| format!("the render cannot be kept: {e}"))
    }

    /// Saves on the way: what fails now may go well later.
    pub fn keep(&self, session: &mut dyn Session) {
        if let Err(message) = self.save(session) {
            self.terminal.warn(&message);
        }
    }
}
