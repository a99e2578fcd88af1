//! Files that appear whole or not at all.

use crate::{
    Error, Result,
    failpoint::{self, attempt},
};
use std::collections::BTreeSet;
use std::fs::{self, File, Metadata, Permissions};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::{
    Mutex, MutexGuard, PoisonError,
    atomic::{AtomicU64, Ordering},
};
use tempfile::{NamedTempFile, TempDir};

const PREFIX: &str = ".steradian-";
const SUFFIX: &str = ".part";
const FOLDER_SUFFIX: &str = ".parts";

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
    place_after(path, write, || Ok(()))
}

/// [`place`], with something to be done just before the file gets its name.
pub(crate) fn place_after(
    path: &Path,
    write: impl FnOnce(&mut dyn Write) -> Result<()>,
    settle: impl FnOnce() -> Result<()>,
) -> Result<()> {
    let fill = |target: Target| match target {
        Target::Stream(file) => {
            let mut out = BufWriter::new(file);
            write(&mut out)?;
            out.flush().map_err(io("write"))?;
            settle()
        }
        Target::File { path, old, draft, listed: _listed } => {
            let mut out = BufWriter::new(Draft(draft));
            write(&mut out)?;
            let Draft(draft) = out.into_inner().map_err(|failed| io("write")(failed.into_error()))?;
            if let Some(old) = old {
                attempt(|| draft.as_file().set_permissions(old)).map_err(io("keep the permissions"))?;
            }
            attempt(|| draft.as_file().sync_all()).map_err(io("write"))?;
            let _naming = drafts();
            settle()?;
            attempt(|| Ok(draft.persist(&path)?)).map_err(io("rename the finished file"))?;
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

/// The temporary files and folders that this process has now. Files get their names while it is locked.
fn drafts() -> MutexGuard<'static, Vec<PathBuf>> {
    static DRAFTS: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());
    DRAFTS.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A place among the [`drafts`] for as long as this is there.
#[derive(Debug)]
pub(crate) struct Listed(PathBuf);

impl Listed {
    /// Makes a temporary file or folder that is among the drafts from its first moment.
    pub fn new<T>(make: impl FnOnce() -> io::Result<T>, path: fn(&T) -> &Path) -> io::Result<(T, Self)> {
        let mut drafts = drafts();
        let made = make()?;
        let path = path(&made).to_path_buf();
        drafts.push(path.clone());
        Ok((made, Self(path)))
    }
}

impl Drop for Listed {
    fn drop(&mut self) {
        drafts().retain(|path| *path != self.0);
    }
}

/// Removes all temporary files and folders of this process, which is about to end. As long as what this returns lives,
/// no file gets its name.
pub fn discard_drafts() -> impl Sized {
    let drafts = drafts();
    for path in drafts.iter() {
        let _ = if path.is_dir() { fs::remove_dir_all(path) } else { fs::remove_file(path) };
    }
    drafts
}

/// Calls of the system under way that open a device or pipe or write to it, and those that have ended.
static CALLS: [AtomicU64; 2] = [AtomicU64::new(0), AtomicU64::new(0)];

/// The number of calls of the system that have ended, where one is under way that opens a device or a pipe or writes to
/// it. It stands still where a pipe has no reader.
pub fn stream_progress() -> Option<u64> {
    let [under_way, ended] = &CALLS;
    (under_way.load(Ordering::SeqCst) > 0).then(|| ended.load(Ordering::SeqCst))
}

/// Makes such a call.
fn call<T>(make: impl FnOnce() -> io::Result<T>) -> io::Result<T> {
    CALLS[0].fetch_add(1, Ordering::SeqCst);
    let made = make();
    CALLS[1].fetch_add(1, Ordering::SeqCst);
    CALLS[0].fetch_sub(1, Ordering::SeqCst);
    made
}

/// A device or a pipe that is written to.
struct Stream(File);

impl Stream {
    fn open(path: &Path) -> io::Result<Self> {
        call(|| fs::OpenOptions::new().write(true).open(path)).map(Self)
    }
}

impl Write for Stream {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        call(|| self.0.write(bytes))
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.flush()
    }
}

/// A file on its way.
struct Draft(NamedTempFile);

impl Write for Draft {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        // Its file by itself: the draft's name is nothing to tell.
        attempt(|| self.0.as_file_mut().write(failpoint::part(bytes)))
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.flush()
    }
}

/// Destination of the bytes.
enum Target {
    /// A device or a pipe.
    Stream(Stream),
    /// A file: the draft that will replace what is at the path.
    File { path: PathBuf, old: Option<Permissions>, draft: NamedTempFile, listed: Listed },
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
            return Ok(Target::Stream(Stream::open(&target).map_err(io("open"))?));
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
    let (draft, listed) = draft(&directory).map_err(io("create a file in its directory"))?;
    remove_dead(&directory, draft.path(), SUFFIX);
    Ok(Target::File { path: target, old: old.map(|old| old.permissions()), draft, listed })
}

/// A new temporary file in a folder, locked for as long as this process writes it.
fn draft(directory: &Path) -> io::Result<(NamedTempFile, Listed)> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(PREFIX).suffix(SUFFIX);
    #[cfg(unix)]
    {
        // The usual permissions of a new file (less the umask), not the private ones of a temporary file.
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(Permissions::from_mode(0o666));
    }
    loop {
        let (draft, listed) = Listed::new(|| attempt(|| builder.tempfile_in(directory)), NamedTempFile::path)?;
        match draft.as_file().lock() {
            // Another process may have taken it for a dead one before it was locked.
            Ok(()) if !draft.path().exists() => {}
            // File systems without locks have none that tell.
            _ => return Ok((draft, listed)),
        }
    }
}

/// A temporary folder in another one, for files that are to appear together; locked for as long as this process fills
/// it.
#[derive(Debug)]
pub(crate) struct Staging {
    folder: TempDir,
    _lock: Option<File>,
    _listed: Listed,
}

impl Staging {
    pub fn path(&self) -> &Path {
        self.folder.path()
    }
}

/// A new [`Staging`]. Those of processes that ended before they could remove them go.
pub(crate) fn staging(directory: &Path) -> io::Result<Staging> {
    loop {
        let mut builder = tempfile::Builder::new();
        builder.prefix(PREFIX).suffix(FOLDER_SUFFIX);
        let (folder, listed) = Listed::new(|| attempt(|| builder.tempdir_in(directory)), TempDir::path)?;
        // Not every system opens folders, and not every file system has locks.
        let lock = File::open(folder.path()).ok().filter(|lock| lock.lock().is_ok());
        // Another process may have taken it for a dead one before it was locked.
        if folder.path().exists() {
            remove_dead(directory, folder.path(), FOLDER_SUFFIX);
            return Ok(Staging { folder, _lock: lock, _listed: listed });
        }
    }
}

/// Writes a new file, and does not return before it is on the disk.
pub(crate) fn write_synced(path: &Path, bytes: &[u8]) -> Result<()> {
    let write = || -> io::Result<()> {
        let mut file = attempt(|| File::create_new(path))?;
        attempt(|| file.write_all(bytes))?;
        attempt(|| file.sync_all())
    };
    write().map_err(io("write"))
}

/// Removes the drafts, or the folders of them, of processes of this user that ended before they could: nobody has them
/// locked. What cannot be looked at stays. A process looks once in each folder.
fn remove_dead(directory: &Path, own: &Path, suffix: &'static str) {
    static SEEN: Mutex<BTreeSet<(PathBuf, &str)>> = Mutex::new(BTreeSet::new());
    let absolute = std::path::absolute(directory).unwrap_or_else(|_| directory.to_owned());
    if !SEEN.lock().unwrap_or_else(PoisonError::into_inner).insert((absolute, suffix)) {
        return;
    }
    let Ok(ours) = fs::metadata(own) else { return };
    for entry in fs::read_dir(directory).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let is_draft = name.to_str().is_some_and(|n| n.starts_with(PREFIX) && n.ends_with(suffix));
        let path = entry.path();
        if !is_draft || path.file_name() == own.file_name() {
            continue;
        }
        // Only a plain file, or a folder, is opened: no link and no pipe.
        let is_alike = |m: &Metadata| m.file_type() == ours.file_type() && has_same_owner(m, &ours);
        if !entry.metadata().is_ok_and(|m| is_alike(&m)) {
            continue;
        }
        if let Ok(file) = File::open(&path)
            && file.try_lock().is_ok()
        {
            let _ = if ours.is_dir() { fs::remove_dir_all(&path) } else { fs::remove_file(&path) };
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
        let (living, _listed) = draft(folder.path()).unwrap();
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
