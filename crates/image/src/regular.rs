//! Regular files, which have an end. To open a pipe waits for someone to write, and devices may go on for ever.

use std::{
    fs::{File, Metadata},
    io::{Error, ErrorKind, Read, Result},
    path::Path,
    time::SystemTime,
};

/// Opens a file and tells its length.
///
/// # Errors
/// The system's answer, and for what is no regular file.
pub fn open_regular(path: &Path) -> Result<(File, u64)> {
    // Asked before it is opened.
    let meta = std::fs::metadata(path)?;
    if meta.is_file() { Ok((File::open(path)?, meta.len())) } else { Err(Error::other("it is not a regular file")) }
}

/// The length of a file, when it was last written, and on Unix which file it is and when that was last changed, which
/// programs cannot set. A file with the same stamp is taken for unchanged; one that is written again within a step of
/// the file system's clock, with as many bytes, is not noticed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stamp(Option<(u64, Option<SystemTime>, [i64; 4])>);

impl Stamp {
    /// Stamp of a file now; an empty one if the file cannot be queried.
    pub fn of(path: &Path) -> Self {
        Self(std::fs::metadata(path).ok().map(|meta| (meta.len(), meta.modified().ok(), identity(&meta))))
    }
}

/// Device, number and time of change of a file.
#[cfg(unix)]
fn identity(meta: &Metadata) -> [i64; 4] {
    use std::os::unix::fs::MetadataExt;
    [meta.dev().cast_signed(), meta.ino().cast_signed(), meta.ctime(), meta.ctime_nsec()]
}

#[cfg(not(unix))]
fn identity(_: &Metadata) -> [i64; 4] {
    [0; 4]
}

/// Reads a regular file of at most `most` bytes.
///
/// # Errors
/// As [`open_regular`], for a file of more than `most` bytes, and where there is no memory for it.
pub fn read_regular(path: &Path, most: u64) -> Result<Vec<u8>> {
    let too_large = || Error::new(ErrorKind::FileTooLarge, format!("it holds more than the {most} bytes allowed"));
    let (file, length) = open_regular(path)?;
    if length > most {
        return Err(too_large());
    }
    let mut bytes = Vec::new();
    bytes.try_reserve_exact(length as usize)?;
    // What the system makes up as it is read, and what grows, does not end where its metadata say.
    file.take(most.saturating_add(1)).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most { Err(too_large()) } else { Ok(bytes) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As many bytes, with the time of those before, are another file.
    #[cfg(unix)]
    #[test]
    fn a_change_that_keeps_size_and_time_shows_in_the_stamp() {
        use std::os::unix::fs::MetadataExt;
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        std::fs::write(&path, b"four").unwrap();
        let (before, written) = (Stamp::of(&path), std::fs::metadata(&path).unwrap());
        assert_eq!(before, Stamp::of(&path));
        let changed = |meta: &Metadata| (meta.ctime(), meta.ctime_nsec());
        // Until the file system's clock has gone on.
        while changed(&std::fs::metadata(&path).unwrap()) == changed(&written) {
            std::fs::write(&path, b"five").unwrap();
            File::options().write(true).open(&path).unwrap().set_modified(written.modified().unwrap()).unwrap();
        }
        let after = std::fs::metadata(&path).unwrap();
        assert_eq!((after.len(), after.modified().unwrap()), (written.len(), written.modified().unwrap()));
        assert_ne!(before, Stamp::of(&path));
    }

    #[test]
    fn only_regular_files_are_read_and_only_so_far() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        std::fs::write(&path, b"four").unwrap();
        assert_eq!(read_regular(&path, 4).unwrap(), b"four");
        assert_eq!(read_regular(&path, 3).unwrap_err().kind(), ErrorKind::FileTooLarge);
        let refused = |path: &Path| read_regular(path, 4).unwrap_err().to_string();
        assert_eq!(refused(folder.path()), "it is not a regular file");
        #[cfg(unix)]
        {
            assert_eq!(refused(Path::new("/dev/zero")), "it is not a regular file");
            // To open it would wait for ever.
            let pipe = folder.path().join("pipe");
            assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
            assert_eq!(refused(&pipe), "it is not a regular file");
        }
    }
}
