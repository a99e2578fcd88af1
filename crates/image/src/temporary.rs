//! A temporary folder that goes away at every end of the program.

use crate::atomic::Listed;
use std::{io::Result, path::Path};
use tempfile::TempDir;

/// A folder in the system's temporary folder. It is removed with all it holds when this is dropped, and by
/// [`discard_drafts`](crate::discard_drafts) where a signal ends the program before.
#[derive(Debug)]
pub struct TemporaryFolder {
    folder: TempDir,
    _listed: Listed,
}

impl TemporaryFolder {
    /// Makes a folder that only this user can read, whose name begins with `prefix`.
    ///
    /// # Errors
    /// The system's answer.
    pub fn new(prefix: &str) -> Result<Self> {
        let mut builder = tempfile::Builder::new();
        builder.prefix(prefix);
        let (folder, listed) = Listed::new(|| builder.tempdir(), TempDir::path)?;
        Ok(Self { folder, _listed: listed })
    }

    /// Path of the folder.
    pub fn path(&self) -> &Path {
        self.folder.path()
    }
}
