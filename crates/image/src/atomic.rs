//! Files that appear whole or not at all.

use crate::{Error, Result};
use std::fs::{self, File, Metadata, Permissions};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

const PREFIX: &str = ".steradian-";
const SUFFIX: &str = ".part";

/// Writes `bytes` to `path`: into a temporary file beside it, synced to the disk, then renamed over the old file, if
/// any, whose permissions it takes. When anything fails (full disk, missing directory, no permission) the old file is
/// untouched and no partial one is left. A path that is a device or a pipe is written to directly.
///
/// # Errors
/// [`Error::File`] with the path and the system's answer.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<()> {
    stream_whole(path, |out| out.write_all(bytes))
}

/// [`write_whole`] of what is written bit by bit.
///
/// # Errors
/// [`Error::File`] with the path and the system's answer.
pub fn stream_whole(path: &Path, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<()> {
    place(path, |out| write(out).map_err(io("write")))
}

/// [`stream_whole`] of what can fail for other reasons as well.
pub(crate) fn place(path: &Path, write: impl FnOnce(&mut dyn Write) -> Result<()>) -> Result<()> {
    let fill = |target: Target| match target {
        Target::Stream(file) => {
            let mut out = BufWriter::new(file);
            write(&mut out)?;
            out.flush().map_err(io("write"))
        }
        Target::File { path, old, draft } => {
            let mut out = BufWriter::new(draft);
            write(&mut out)?;
            let draft = out.into_inner().map_err(|failed| io("write")(failed.into_error()))?;
            if let Some(old) = old {
                draft.as_file().set_permissions(old).map_err(io("keep the permissions"))?;
            }
            draft.as_file().sync_all().map_err(io("write"))?;
            draft.persist(&path).map_err(|failed| io("rename the finished file")(failed.error))?;
            Ok(())
        }
    };
    open(path).and_then(fill).map_err(|e| e.at(path))
}

/// Finds out, before there is anything to write, whether [`write_whole`] can: makes the temporary file and removes it
/// again. Devices and pipes are not opened.
///
/// # Errors
/// As [`write_whole`].
pub fn check_place(path: &Path) -> Result<()> {
    match fs::metadata(path) {
        Ok(there) if !there.is_file() && !there.is_dir() => Ok(()),
        _ => open(path).map(drop).map_err(|e| e.at(path)),
    }
}

/// Where the bytes go.
enum Target {
    /// A device or a pipe.
    Stream(File),
    /// A file: the draft that will replace what is at the path.
    File { path: PathBuf, old: Option<Permissions>, draft: NamedTempFile },
}

/// The system's answer to something that was tried.
pub(crate) fn io(action: &'static str) -> impl FnOnce(io::Error) -> Error {
    move |error| Error::Io { action, error }
}

fn open(path: &Path) -> Result<Target> {
    // A link keeps pointing to the file that is replaced. Names that are too long and links in a loop end here.
    let target = match fs::canonicalize(path) {
        Ok(existing) => existing,
        Err(error) if error.kind() == io::ErrorKind::NotFound => path.to_owned(),
        Err(error) => return Err(io("open")(error)),
    };
    let old = fs::metadata(&target).ok();
    if let Some(old) = &old {
        if old.is_dir() {
            return Err(io("write")(io::ErrorKind::IsADirectory.into()));
        }
        if !old.is_file() {
            return Ok(Target::Stream(fs::OpenOptions::new().write(true).open(&target).map_err(io("open"))?));
        }
        if old.permissions().readonly() {
            return Err(io("replace")(io::ErrorKind::PermissionDenied.into()));
        }
    }
    let directory = match target.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent.to_owned(),
        _ => PathBuf::from("."),
    };
    if target.file_name().is_none() {
        return Err(io("write")(io::ErrorKind::IsADirectory.into()));
    }
    let draft = draft(&directory).map_err(io("create a file in its directory"))?;
    remove_dead(&directory, &draft);
    Ok(Target::File { path: target, old: old.map(|old| old.permissions()), draft })
}

/// A new temporary file in a folder, locked for as long as this process writes it.
fn draft(directory: &Path) -> io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(PREFIX).suffix(SUFFIX);
    #[cfg(unix)]
    {
        // The usual permissions of a new file (less the umask), not the private ones of a temporary file.
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(Permissions::from_mode(0o666));
    }
    loop {
        let draft = builder.tempfile_in(directory)?;
        match draft.as_file().lock() {
            // Another process may have taken it for a dead one before it was locked.
            Ok(()) if !draft.path().exists() => {}
            // File systems without locks have none that tell.
            _ => return Ok(draft),
        }
    }
}

/// Removes the drafts of processes of this user that ended before they could: nobody has them locked. What cannot be
/// looked at stays.
fn remove_dead(directory: &Path, own: &NamedTempFile) {
    let Ok(ours) = own.as_file().metadata() else { return };
    for entry in fs::read_dir(directory).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let is_draft = name.to_str().is_some_and(|n| n.starts_with(PREFIX) && n.ends_with(SUFFIX));
        let path = entry.path();
        if !is_draft || path.file_name() == own.path().file_name() {
            continue;
        }
        // Only a plain file is opened.
        if !entry.metadata().is_ok_and(|m| m.is_file() && has_same_owner(&m, &ours)) {
            continue;
        }
        if let Ok(file) = File::open(&path)
            && file.try_lock().is_ok()
        {
            let _ = fs::remove_file(&path);
        }
    }
}

#[cfg(unix)]
fn has_same_owner(a: &Metadata, b: &Metadata) -> bool {
    use std::os::unix::fs::MetadataExt;
    a.uid() == b.uid()
}

#[cfg(not(unix))]
fn has_same_owner(_: &Metadata, _: &Metadata) -> bool {
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect()
    }

    #[test]
    fn drafts_of_the_dead_go_and_those_of_the_living_stay() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::write(at(".steradian-dead.part"), b"half").unwrap();
        fs::write(at(".steradian-other"), b"not ours").unwrap();
        let living = draft(folder.path()).unwrap();
        write_whole(&at("a.exr"), b"whole").unwrap();
        assert!(living.path().exists() && at(".steradian-other").exists() && at("a.exr").exists());
        assert_eq!(names(folder.path()).len(), 3, "{:?}", names(folder.path()));
        drop(living);
        check_place(&at("b.exr")).unwrap();
        assert_eq!(names(folder.path()).len(), 2);
    }

    #[test]
    fn places_where_nothing_can_be_written_are_found_out_beforehand() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        assert!(check_place(&at("a.exr")).is_ok());
        assert!(names(folder.path()).is_empty());
        assert!(check_place(&at("none/a.exr")).is_err() && check_place(folder.path()).is_err());
        assert!(check_place(&at(&("x".repeat(300) + ".exr"))).is_err());
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink(at("loop.exr"), at("loop.exr")).unwrap();
            assert!(check_place(&at("loop.exr")).is_err());
        }
    }

    #[cfg(unix)]
    #[test]
    fn a_replaced_file_keeps_its_permissions() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        fs::write(&path, b"old").unwrap();
        fs::set_permissions(&path, Permissions::from_mode(0o640)).unwrap();
        write_whole(&path, b"new").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"new");
        assert_eq!(fs::metadata(&path).unwrap().permissions().mode() & 0o777, 0o640);
    }
}
