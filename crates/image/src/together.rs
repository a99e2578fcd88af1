//! Files that appear together or not at all: a document and what lies beside it.

use crate::atomic::{self, io};
use crate::failpoint::attempt;
use crate::{Error, Result, read_regular};
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Writes `bytes` to `document`, and beside it files by their names relative to its folder. All are written into a
/// temporary folder first, then renamed, the document last. What fails leaves nothing of it behind. A file that
/// is there with the same bytes stays as it is.
///
/// # Errors
/// [`Error::File`] with the path and the system's answer, also where a file beside the document is there with other
/// bytes.
pub fn write_together(document: &Path, bytes: &[u8], beside: &[(PathBuf, Vec<u8>)]) -> Result<()> {
    let folder = document.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut missing = Vec::new();
    for (name, bytes) in beside {
        let path = folder.join(name);
        match read_regular(&path, bytes.len() as u64) {
            Ok(there) if there == *bytes => {}
            Err(_) if fs::symlink_metadata(&path).is_err() => missing.push((path, bytes)),
            _ => return Err(changed().at(&path)),
        }
    }
    if missing.is_empty() {
        return atomic::write_whole(document, bytes);
    }
    let staging = atomic::staging(folder).map_err(|e| io("create a folder in its directory")(e).at(document))?;
    let staged = |i: usize| staging.path().join(i.to_string());
    for (i, (path, bytes)) in missing.iter().enumerate() {
        atomic::write_synced(&staged(i), bytes).map_err(|e| e.at(path))?;
    }
    let mut placed = Placed::default();
    let write = |out: &mut dyn Write| out.write_all(bytes).map_err(io("write"));
    let settle = || {
        let mut each = missing.iter().enumerate();
        each.try_for_each(|(i, (path, _))| placed.rename(&staged(i), path).map_err(|e| e.at(path)))
    };
    atomic::place_after(document, write, settle)?;
    placed.keep();
    Ok(())
}

fn changed() -> Error {
    let what = "it was changed since it was written; give the document another name, or move the file away";
    io("replace")(std::io::Error::other(what))
}

/// Files and folders that are removed again unless all goes well.
#[derive(Default)]
struct Placed {
    files: Vec<PathBuf>,
    folders: Vec<PathBuf>,
}

impl Placed {
    fn rename(&mut self, from: &Path, to: &Path) -> Result<()> {
        if let Some(folder) = to.parent().filter(|folder| !folder.exists()) {
            attempt(|| fs::create_dir_all(folder)).map_err(io("create its folder"))?;
            self.folders.push(folder.into());
        }
        attempt(|| fs::rename(from, to)).map_err(io("rename the finished file"))?;
        self.files.push(to.into());
        Ok(())
    }

    fn keep(&mut self) {
        self.files.clear();
        self.folders.clear();
    }
}

impl Drop for Placed {
    fn drop(&mut self) {
        for file in &self.files {
            let _ = fs::remove_file(file);
        }
        for folder in self.folders.iter().rev() {
            let _ = fs::remove_dir(folder);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<PathBuf> {
        let mut names: Vec<PathBuf> = fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into()).collect();
        names.sort();
        names
    }

    fn beside() -> Vec<(PathBuf, Vec<u8>)> {
        vec![("a.meshes/1".into(), b"one".to_vec()), ("a.meshes/2".into(), b"two".to_vec())]
    }

    #[test]
    fn all_appear_or_none() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::create_dir(at("taken.pbrt")).unwrap();
        write_together(&at("taken.pbrt"), b"text", &beside()).unwrap_err();
        assert_eq!(names(folder.path()), [Path::new("taken.pbrt")]);
        // The second file has no place: the first one goes as well.
        let late = vec![("a.meshes/1".into(), b"one".to_vec()), ("a.meshes/1/2".into(), b"two".to_vec())];
        write_together(&at("a.pbrt"), b"text", &late).unwrap_err();
        assert_eq!(names(folder.path()), [Path::new("taken.pbrt")]);
        write_together(&at("a.pbrt"), b"text", &beside()).unwrap();
        assert_eq!(names(folder.path()), ["a.meshes", "a.pbrt", "taken.pbrt"].map(Path::new));
        assert_eq!(fs::read(at("a.meshes/2")).unwrap(), b"two");
    }

    #[test]
    fn files_that_were_changed_stay() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        write_together(&at("a.pbrt"), b"text", &beside()).unwrap();
        write_together(&at("b.pbrt"), b"text", &beside()).unwrap();
        fs::write(at("a.meshes/2"), b"by hand").unwrap();
        let refused = write_together(&at("a.pbrt"), b"new", &beside()).unwrap_err().to_string();
        assert!(refused.contains("changed") && refused.contains("a.meshes"), "{refused}");
        assert_eq!(
            (fs::read(at("a.meshes/2")).unwrap(), fs::read(at("a.pbrt")).unwrap()),
            (b"by hand".to_vec(), b"text".to_vec())
        );
    }

    #[cfg(unix)]
    #[test]
    fn folders_of_the_dead_go_and_those_of_the_living_stay() {
        let folder = tempfile::tempdir().unwrap();
        let dead = folder.path().join(".steradian-dead.parts");
        fs::create_dir(&dead).unwrap();
        fs::write(dead.join("0"), b"half").unwrap();
        let living = atomic::staging(folder.path()).unwrap();
        assert!(living.path().exists() && !dead.exists());
        write_together(&folder.path().join("a.pbrt"), b"text", &beside()).unwrap();
        assert!(living.path().exists());
        assert_eq!(names(folder.path()).len(), 3);
    }
}
