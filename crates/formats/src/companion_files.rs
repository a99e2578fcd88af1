//! The files that a document names: those that are there already, and those that are written beside it.

use std::{
    collections::BTreeMap,
    path::{Component, Path, PathBuf},
};
use steradian_scene::SceneDesc;

/// Digits of a hash in a name.
const HASH_DIGITS: usize = 16;

/// Names files as seen from a document that is about to be written, and collects those that go beside it.
#[derive(Debug)]
pub(crate) struct Beside<'a> {
    desc: &'a SceneDesc,
    base: PathBuf,
    /// The document's name without its extension.
    pub stem: String,
    embedded: BTreeMap<PathBuf, String>,
    files: BTreeMap<PathBuf, Vec<u8>>,
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
            files: BTreeMap::new(),
            fault: None,
        }
    }

    /// Adds a file in one of the document's folders (`meshes`, `pictures`); its name for the document. The name holds
    /// the hash of the bytes, so no file with other bytes, of this document or of another, has it.
    pub fn add(&mut self, folder: &str, wanted: &str, bytes: Vec<u8>) -> String {
        let (stem, extension) = wanted.rsplit_once('.').unwrap_or((wanted, ""));
        let hash = &blake3::hash(&bytes).to_hex()[..HASH_DIGITS];
        let dot = if extension.is_empty() { "" } else { "." };
        let name = format!("{}.{folder}/{stem}-{hash}{dot}{extension}", self.stem);
        self.files.entry(name.clone().into()).or_insert(bytes);
        name
    }

    /// Takes the files to be written beside the document: relative path and contents.
    pub fn take_files(&mut self) -> Vec<(PathBuf, Vec<u8>)> {
        std::mem::take(&mut self.files).into_iter().collect()
    }

    /// A file of the scene as seen from the document. What is in memory only is written beside it.
    pub fn path(&mut self, path: &Path) -> String {
        if let Some(bytes) = self.desc.embedded.get(path) {
            if let Some(name) = self.embedded.get(path) {
                return name.clone();
            }
            let last = path.file_name().map(|n| n.to_string_lossy().replace(['#', ':'], "-")).unwrap_or_default();
            let name = self.add("pictures", &last, bytes.to_vec());
            self.embedded.insert(path.into(), name.clone());
            return name;
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
