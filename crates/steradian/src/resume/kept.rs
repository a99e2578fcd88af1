//! States that are kept in two files: the last, and the one before it, for the case that the last is damaged.

use super::{Recipe, StateError, state_file};
use crate::Session;
use std::path::{Path, PathBuf};

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
    let is_damaged = |path: &Path| matches!(state_file(path), Err(StateError::Damaged | StateError::NotAState));
    let before = before(state);
    Some(if is_damaged(state) && state_file(&before).is_ok() { before } else { state.to_path_buf() })
}

impl Recipe {
    /// Saves a session to a file, whose state before gets the name that [`before`] gives.
    ///
    /// # Errors
    /// The path and the system's answer.
    pub fn keep(&self, session: &mut dyn Session, state: &Path) -> Result<(), steradian_image::Error> {
        if state.exists() {
            let before = before(state);
            // A second name of the file: that of the state is never without a file. A draft that a killed process left
            // may be such a name, too: nothing is written into it.
            let draft = before.with_extension("draft");
            let _ = std::fs::remove_file(&draft);
            let linked = std::fs::hard_link(state, &draft).or_else(|_| std::fs::copy(state, &draft).map(drop));
            let _ = linked.and_then(|()| std::fs::rename(&draft, &before));
            // Where both are names of one file already, renaming leaves both.
            let _ = std::fs::remove_file(&draft);
        }
        self.save(session, state)
    }
}
