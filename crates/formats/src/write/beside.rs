//! The files that a document names: those that are there already, and those that are written beside it.

use std::{
    collections::BTreeMap,
    path::{Component, Path, PathBuf},
};
use steradian_scene::SceneDesc;

/// Names files as seen from a document that is about to be written, and collects those that go beside it.
#[derive(Debug)]
pub(crate) struct Beside<'a> {
    desc: &'a SceneDesc,
    base: PathBuf,
    /// The document's name without its extension.
    pub stem: String,
    embedded: BTreeMap<PathBuf, String>,
    /// What is written beside the document.
    pub files: Vec<(PathBuf, Vec<u8>)>,
    /// The first name that the document cannot hold.
    pub fault: Option<String>,
}

impl<'a> Beside<'a> {
    /// For a document at `path`.
    pub fn new(desc: &'a SceneDesc, path: &Path) -> Self {
        let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let folder = std::path::absolute(folder).unwrap_or_else(|_| folder.into());
        Self {
            desc,
            base: folder.canonicalize().unwrap_or(folder),
            stem: path.file_stem().and_then(|s| s.to_str()).unwrap_or("scene").to_owned(),
            embedded: BTreeMap::new(),
            files: Vec::new(),
            fault: None,
        }
    }

    /// Adds a file; its name for the document.
    pub fn add(&mut self, name: String, bytes: Vec<u8>) -> String {
        self.files.push((name.clone().into(), bytes));
        name
    }

    /// A file of the scene as seen from the document. What is in memory only is written beside it.
    pub fn path(&mut self, path: &Path) -> String {
        if let Some(bytes) = self.desc.embedded.get(path) {
            if let Some(name) = self.embedded.get(path) {
                return name.clone();
            }
            let last = path.file_name().map(|n| n.to_string_lossy().replace(['#', ':'], "-")).unwrap_or_default();
            let name = format!("{}.pictures/{}-{last}", self.stem, self.embedded.len());
            self.embedded.insert(path.into(), name.clone());
            return self.add(name, bytes.to_vec());
        }
        let full = path.canonicalize().or_else(|_| std::path::absolute(path)).unwrap_or_else(|_| path.into());
        match relative(&full, &self.base).to_str() {
            Some(text) => text.replace('\\', "/"),
            None => {
                self.fault = Some(format!("the path '{}' is not UTF-8", path.display()));
                String::new()
            }
        }
    }
}

/// `path` from the folder `base`; both absolute.
fn relative(path: &Path, base: &Path) -> PathBuf {
    let shared = path.components().zip(base.components()).take_while(|(a, b)| a == b).count();
    if shared == 0 {
        return path.into();
    }
    let up = base.components().skip(shared).map(|_| Component::ParentDir);
    up.chain(path.components().skip(shared)).collect()
}
