//! Files that appear whole or not at all.

use crate::{Error, Result};
use std::io::Write;
use std::path::{Path, PathBuf};

/// Writes `bytes` to `path`: into a temporary file beside it, synced to the disk, then renamed over the old file, if any. When
/// anything fails (full disk, missing directory, no permission) the old file is untouched and no partial one is left. A path that
/// is a device or a pipe is written to directly.
///
/// # Errors
/// [`Error::File`] with the path and the system's answer.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<()> {
    place(path, bytes).map_err(|e| e.at(path))
}

fn place(path: &Path, bytes: &[u8]) -> Result<()> {
    let io = |action| move |error| Error::Io { action, error };
    // A link keeps pointing to the file that is replaced.
    let target = match std::fs::canonicalize(path) {
        Ok(existing) => existing,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => path.to_owned(),
        Err(error) => return Err(Error::Io { action: "open", error }),
    };
    if let Ok(existing) = std::fs::metadata(&target) {
        if existing.is_dir() {
            return Err(Error::Io { action: "write", error: std::io::ErrorKind::IsADirectory.into() });
        }
        if !existing.is_file() {
            let mut file = std::fs::OpenOptions::new().write(true).open(&target).map_err(io("open"))?;
            return file.write_all(bytes).and_then(|()| file.flush()).map_err(io("write"));
        }
        if existing.permissions().readonly() {
            return Err(Error::Io { action: "replace", error: std::io::ErrorKind::PermissionDenied.into() });
        }
    }
    let directory = match target.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent.to_owned(),
        _ => PathBuf::from("."),
    };
    let mut builder = tempfile::Builder::new();
    builder.prefix(".steradian-").suffix(".part");
    #[cfg(unix)]
    {
        // The usual permissions of a new file (less the umask), not the private ones of a temporary file.
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    let mut file = builder.tempfile_in(&directory).map_err(io("create a file in its directory"))?;
    file.write_all(bytes).map_err(io("write"))?;
    file.flush().map_err(io("write"))?;
    file.as_file().sync_all().map_err(io("write"))?;
    file.persist(&target).map_err(|failed| Error::Io { action: "rename the finished file", error: failed.error })?;
    Ok(())
}
