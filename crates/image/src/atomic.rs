//! Files that appear whole or not at all.

use crate::{Error, Result};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// Writes `bytes` to `path`: into a temporary file beside it, synced to the disk, then renamed over the old file, if any. When
/// anything fails (full disk, missing directory, no permission) the old file is untouched and no partial one is left. A path that
/// is a device or a pipe is written to directly.
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
    place(path, write).map_err(|e| e.at(path))
}

fn place(path: &Path, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<()> {
    let io = |action| move |error| Error::Io { action, error };
    // A link keeps pointing to the file that is replaced.
    let target = match std::fs::canonicalize(path) {
        Ok(existing) => existing,
        Err(error) if error.kind() == io::ErrorKind::NotFound => path.to_owned(),
        Err(error) => return Err(Error::Io { action: "open", error }),
    };
    if let Ok(existing) = std::fs::metadata(&target) {
        if existing.is_dir() {
            return Err(Error::Io { action: "write", error: io::ErrorKind::IsADirectory.into() });
        }
        if !existing.is_file() {
            let mut file = BufWriter::new(std::fs::OpenOptions::new().write(true).open(&target).map_err(io("open"))?);
            return write(&mut file).and_then(|()| file.flush()).map_err(io("write"));
        }
        if existing.permissions().readonly() {
            return Err(Error::Io { action: "replace", error: io::ErrorKind::PermissionDenied.into() });
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
    let mut file = BufWriter::new(builder.tempfile_in(&directory).map_err(io("create a file in its directory"))?);
    write(&mut file).map_err(io("write"))?;
    let file = file.into_inner().map_err(|failed| Error::Io { action: "write", error: failed.into_error() })?;
    file.as_file().sync_all().map_err(io("write"))?;
    file.persist(&target).map_err(|failed| Error::Io { action: "rename the finished file", error: failed.error })?;
    Ok(())
}
