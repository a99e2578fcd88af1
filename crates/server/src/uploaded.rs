//! Files of the last upload.

use std::path::Path;
use steradian::{archive::UnpackedScene, image::TemporaryFolder};

/// Files that came, in folders that go away with it.
pub struct Upload {
    /// The files as they came.
    pub folder: TemporaryFolder,
    /// The files of the archive that came.
    pub unpacked: Option<UnpackedScene>,
}

impl Upload {
    /// The folder that the scene is in.
    pub fn path(&self) -> &Path {
        self.unpacked.as_ref().map_or_else(|| self.folder.path(), |unpacked| unpacked.folder.path())
    }
}
