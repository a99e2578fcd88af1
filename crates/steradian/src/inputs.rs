//! The files that are read or written, so that none of them is overwritten.

use std::{
    collections::HashMap,
    path::{Path, PathBuf},
};

/// Identity of a file, whatever its name: links and spellings of one file are equal.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
enum Identity {
    /// Device and number on it.
    #[cfg(unix)]
    Node(u64, u64),
    /// Path without links, of one that is not there yet as well.
    Place(PathBuf),
}

impl Identity {
    fn of(path: &Path) -> Self {
        #[cfg(unix)]
        if let Ok(there) = std::fs::metadata(path) {
            use std::os::unix::fs::MetadataExt;
            return Self::Node(there.dev(), there.ino());
        }
        if let Ok(whole) = path.canonicalize() {
            return Self::Place(whole);
        }
        let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let folder = folder.canonicalize().unwrap_or_else(|_| folder.into());
        Self::Place(folder.join(path.file_name().unwrap_or_default()))
    }
}

/// True if two paths are of one file, or would be.
pub fn is_same_file(a: &Path, b: &Path) -> bool {
    Identity::of(a) == Identity::of(b)
}

/// Files that something reads, or writes.
#[derive(Clone, Debug, Default)]
pub struct Inputs(HashMap<Identity, PathBuf>);

impl Inputs {
    /// Set of files; missing files count too.
    pub fn of<'a>(paths: impl IntoIterator<Item = &'a Path>) -> Self {
        Self(paths.into_iter().map(|path| (Identity::of(path), path.to_path_buf())).collect())
    }

    /// Adds a file; what it is called already, if it is one of these files.
    pub fn add(&mut self, path: &Path) -> Option<PathBuf> {
        self.0.insert(Identity::of(path), path.to_path_buf())
    }

    /// Name of a file among those that are read, if it is one of them.
    pub fn find(&self, path: &Path) -> Option<&Path> {
        self.0.get(&Identity::of(path)).map(PathBuf::as_path)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_told_apart_by_what_they_are() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        std::fs::create_dir(at("sub")).unwrap();
        std::fs::write(at("a.png"), b"a").unwrap();
        let inputs = Inputs::of([at("a.png").as_path(), &at("missing.png")]);
        for same in ["a.png", "./a.png", "sub/../a.png", "missing.png", "sub/../missing.png"] {
            assert!(inputs.find(&at(same)).is_some(), "{same}");
        }
        assert_eq!(inputs.find(&at("sub/../a.png")), Some(at("a.png").as_path()));
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink(at("a.png"), at("link.png")).unwrap();
            std::fs::hard_link(at("a.png"), at("hard.png")).unwrap();
            assert!(inputs.find(&at("link.png")).is_some() && inputs.find(&at("hard.png")).is_some());
        }
        std::fs::write(at("b.png"), b"a").unwrap();
        assert!(inputs.find(&at("b.png")).is_none() && inputs.find(&at("sub/a.png")).is_none());
        assert!(is_same_file(&at("new.exr"), &at("sub/../new.exr")) && !is_same_file(&at("a.png"), &at("b.png")));
    }
}
