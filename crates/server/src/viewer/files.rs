//! Files of the scene that change while it is looked at.

use super::{Invalidates, Viewer, WATCH_EVERY};
use crate::protocol::{Severity, told};
use std::time::Instant;

impl Viewer {
    /// True if files of the scene were changed, and nobody is writing them any more.
    pub(super) fn files_changed(&mut self) -> bool {
        if self.watched.elapsed() < WATCH_EVERY {
            return false;
        }
        self.watched = Instant::now();
        let before = std::mem::replace(&mut self.seen, self.document.stamps());
        // Edits may name further files.
        for (path, stamp) in &self.seen {
            self.stamps.entry(path.clone()).or_insert(*stamp);
        }
        let is_changed = self.seen.iter().any(|(path, stamp)| self.stamps.get(path) != Some(stamp));
        is_changed && self.seen == before
    }

    /// Tells which edits could not be made again, and why.
    pub(super) fn tell_lost(&self, lost: Vec<String>) {
        lost.into_iter().for_each(|why| self.say(Severity::Warning, format!("an edit does not fit any more: {why}")));
    }

    /// Shows the scene as its files have it now; the camera, settings and edits stay.
    pub(super) fn reload(&mut self) -> Invalidates {
        self.stamps.clone_from(&self.seen);
        let (fresh, lost) = match self.document.reloaded() {
            Ok(read) => read,
            Err(diagnostics) => {
                self.say(Severity::Error, told(&diagnostics));
                return Invalidates::Nothing;
            }
        };
        let old = std::mem::replace(&mut self.document, fresh);
        self.look.moving = false;
        if let Err(why) = self.remake() {
            self.document = old;
            self.say(Severity::Error, why);
            return Invalidates::Nothing;
        }
        self.tell_lost(lost);
        self.say(Severity::Note, "the scene's files have changed: they were read again".into());
        self.stamps = self.document.stamps();
        Invalidates::Scene
    }
}
