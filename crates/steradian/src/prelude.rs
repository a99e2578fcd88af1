//! Names that most programs need: `use steradian::prelude::*`.
//!
//! ```no_run
//! use steradian::prelude::*;
//!
//! Scene::load("a.pbrt")?.render(&Quality::of("path").spp(64))?.save("a.exr")?;
//! # Ok::<(), steradian::Error>(())
//! ```

pub use crate::{Control, Error, Film, Layer, Quality, Scene, Session, open};

use crate::image::{Image, WriteOptions, write};
use std::{path::Path, sync::Arc};

/// Scenes from files.
pub trait LoadScene: Sized {
    /// Reads and compiles a scene; [`open`] gives the messages that are no errors, too.
    ///
    /// # Errors
    /// [`Error::Scene`] with all that is wrong, with files, lines and columns.
    fn load(name: impl AsRef<Path>) -> Result<Arc<Self>, Error>;
}

impl LoadScene for Scene {
    fn load(name: impl AsRef<Path>) -> Result<Arc<Self>, Error> {
        open(name).map(|(scene, _)| scene)
    }
}

/// Pictures of scenes.
pub trait RenderScene {
    /// Renders to the end, as [`crate::render`] does.
    ///
    /// # Errors
    /// Those of [`crate::render`].
    fn render(&self, quality: &Quality) -> Result<Picture, Error>;
}

impl RenderScene for Arc<Scene> {
    fn render(&self, quality: &Quality) -> Result<Picture, Error> {
        crate::render(self, quality).map(Picture)
    }
}

/// A picture that was rendered.
#[derive(Clone, Debug)]
pub struct Picture(pub Image);

impl Picture {
    /// Writes a file, which appears whole or not at all; its format is that of the extension, one that [`write()`]
    /// knows.
    ///
    /// # Errors
    /// [`Error::Image`].
    pub fn save(&self, path: impl AsRef<Path>) -> Result<(), Error> {
        Ok(write(path.as_ref(), &self.0, &WriteOptions::default())?)
    }
}
