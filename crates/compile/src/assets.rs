//! Files that a scene is made of, as they were read, and the sizes of pictures that were made of them.

use std::{
    collections::{BTreeSet, HashMap, HashSet},
    path::{Path, PathBuf},
    sync::Arc,
};
use steradian_image::{Encoding, Stamp, Texels, VoxelGrid};
use steradian_scene::SceneDesc;
use steradian_texture::{
    levels::{Levels, Recipe},
    store::{Level, Pages},
};

/// An image file that was read.
#[derive(Clone, Debug)]
pub(super) struct Loaded<T> {
    pub texels: T,
    /// Number of its values that were infinite or NaN.
    pub faults: usize,
    /// Notes on guesses and omissions of reading it.
    pub notes: Vec<String>,
}

/// An image file that was read, or why not.
pub(super) type Image<T> = Result<Loaded<T>, String>;

/// Source of a file's bytes.
#[derive(Clone, Debug)]
pub(super) enum Source {
    /// Memory.
    Memory(Arc<[u8]>),
    /// A file as it was when it was read.
    File(Stamp),
}

impl Source {
    /// Source of a file that a description names.
    pub fn of(desc: &SceneDesc, path: &Path) -> Self {
        match desc.embedded.get(path) {
            Some(bytes) => Self::Memory(bytes.clone()),
            None => Self::File(Stamp::of(path)),
        }
    }

    /// True if the file is still the same.
    pub fn is_current(&self, desc: &SceneDesc, path: &Path) -> bool {
        match (self, desc.embedded.get(path)) {
            (Self::Memory(then), Some(now)) => Arc::ptr_eq(then, now),
            (Self::File(then), None) => *then == Stamp::of(path),
            _ => false,
        }
    }
}

/// All that was read.
#[derive(Debug, Default)]
pub(super) struct Assets {
    /// Sources of the files.
    pub sources: HashMap<PathBuf, Source>,
    pub images: HashMap<PathBuf, Image<Arc<Texels>>>,
    /// Images of textures that are kept in `pages`, where textures are limited.
    pub paged: HashMap<PathBuf, Image<Level>>,
    pub pages: Option<Arc<Pages>>,
    /// Sizes of images that were made, by file, encoding and recipe.
    pub levels: Vec<(PathBuf, Encoding, Recipe, Arc<Levels>)>,
    pub grids: HashMap<PathBuf, Arc<VoxelGrid>>,
}

impl Assets {
    /// Notes where files that are about to be read come from.
    pub fn sources_of(&mut self, desc: &SceneDesc, files: &BTreeSet<&Path>) {
        self.sources.extend(files.iter().map(|p| (p.to_path_buf(), Source::of(desc, p))));
    }

    /// Forgets files that have changed or that nothing names any more, and what was made of them.
    pub fn refresh(&mut self, desc: &SceneDesc) {
        let named: HashSet<&Path> = desc.files().collect();
        self.sources.retain(|path, source| named.contains(path.as_path()) && source.is_current(desc, path));
        let Self { sources, images, paged, levels, grids, .. } = self;
        images.retain(|path, image| image.is_ok() && sources.contains_key(path));
        paged.retain(|path, image| image.is_ok() && sources.contains_key(path));
        levels.retain(|(path, ..)| sources.contains_key(path));
        grids.retain(|path, _| sources.contains_key(path));
    }
}
