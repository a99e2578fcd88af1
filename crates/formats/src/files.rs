//! Finding and reading files.

use crate::{
    Limits, Options,
    limits::{MOST_OF_TEXT, unpacked},
};
use std::{
    collections::HashMap,
    io::{ErrorKind, Read},
    path::{Path, PathBuf},
    sync::Arc,
};
use steradian_image::read_regular;

/// Why a file could not be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FileError {
    /// Not there; the places searched are listed.
    #[error("cannot find '{name}' (searched {})", .searched.iter().map(|p| format!("'{}'", p.display())).collect::<Vec<_>>().join(", "))]
    NotFound {
        /// As written in the scene.
        name: String,
        /// Full paths tried.
        searched: Vec<PathBuf>,
    },
    /// Not in the one folder that may be read.
    #[error("'{name}' is outside the scene's folder, and is not read")]
    Outside {
        /// As written in the scene.
        name: String,
    },
    /// The system refused.
    #[error("cannot read '{}': {cause}", .path.display())]
    Io {
        /// Which file.
        path: PathBuf,
        /// Error reported by the operating system.
        cause: std::io::Error,
    },
    /// A compressed file that is nearly empty.
    #[error("'{}' unpacks to more than {MOST_OF_TEXT} times its size; it is not read", .path.display())]
    Bomb {
        /// Which file.
        path: PathBuf,
    },
    /// Repeated inclusion of files beyond the limit on bytes.
    #[error("'{}' is included so often that its repetitions (with those of others) come to more than {limit} bytes", .path.display())]
    Repeated {
        /// Which file.
        path: PathBuf,
        /// The limit.
        limit: u64,
    },
    /// For which [`Limits::memory`] leaves no room.
    #[error(
        "'{}' holds {size} bytes; reading it takes about {needed} bytes of memory, and {there_is} are available",
        .path.display()
    )]
    Memory {
        /// Which file.
        path: PathBuf,
        /// Its bytes, unpacked as far as it was.
        size: u64,
        /// Bytes of memory that reading it takes.
        needed: u64,
        /// Bytes of memory that there are.
        there_is: u64,
    },
    /// Over [`Limits::file_bytes`].
    #[error("'{}' holds more than the {limit} bytes allowed", .path.display())]
    TooLarge {
        /// Which file.
        path: PathBuf,
        /// The limit.
        limit: u64,
    },
}

/// Search folders for the files that a scene names.
#[derive(Clone, Debug, Default)]
pub struct SearchPath {
    /// Folders in order.
    pub folders: Vec<PathBuf>,
    /// The folder that files must be in, links followed; anywhere without.
    pub within: Option<PathBuf>,
}

impl SearchPath {
    /// A document's folder, then those of the options.
    pub fn new(folder: Option<&Path>, options: &Options) -> Self {
        let folders = folder.map(Path::to_path_buf).into_iter().chain(options.search.iter().cloned());
        Self { folders: folders.collect(), within: options.within.clone() }
    }

    /// Finds a file: as it is when absolute, else in each folder in turn. Backslashes count as slashes where the name
    /// as written is not found.
    ///
    /// # Errors
    /// [`FileError::NotFound`] with every place searched; [`FileError::Outside`].
    pub fn find(&self, name: &str) -> Result<PathBuf, FileError> {
        let mut searched = Vec::new();
        let slashed = name.replace('\\', "/");
        for spelling in [name, slashed.as_str()] {
            let relative = Path::new(spelling);
            let places: Vec<PathBuf> = if relative.is_absolute() {
                vec![relative.to_path_buf()]
            } else {
                self.folders.iter().map(|f| f.join(relative)).collect()
            };
            for place in places {
                if place.is_file() {
                    return self.admit(name, place);
                }
                if !searched.contains(&place) {
                    searched.push(place);
                }
            }
        }
        Err(FileError::NotFound { name: name.into(), searched })
    }

    /// A file, where it is one that may be read.
    fn admit(&self, name: &str, place: PathBuf) -> Result<PathBuf, FileError> {
        let Some(within) = &self.within else { return Ok(place) };
        match (place.canonicalize(), within.canonicalize()) {
            (Ok(whole), Ok(folder)) if whole.starts_with(&folder) => Ok(place),
            _ => Err(FileError::Outside { name: name.into() }),
        }
    }
}

/// Refuses a text of so many bytes, `held` of them in memory, where there is no room for it twice: whatever becomes of
/// it stands beside it for a while.
fn room(path: &Path, size: u64, held: u64, limits: &Limits) -> Result<(), FileError> {
    let needed = size.saturating_mul(2);
    match limits.shortage(needed - held) {
        Some(there_is) => Err(FileError::Memory { path: path.into(), size, needed: needed - held, there_is }),
        None => Ok(()),
    }
}

/// Reads a whole file; one that starts as gzip is unpacked. Never holds more than [`Limits::file_bytes`].
///
/// # Errors
/// [`FileError::Io`] (also for what is not a regular file), [`FileError::TooLarge`], [`FileError::Memory`] or
/// [`FileError::Bomb`].
pub fn read(path: &Path, limits: &Limits) -> Result<Vec<u8>, FileError> {
    // What is larger than allowed is told as that.
    let size = std::fs::metadata(path).map_or(0, |meta| if meta.is_file() { meta.len() } else { 0 });
    if size <= limits.file_bytes {
        room(path, size, 0, limits)?;
    }
    let fault = |cause: std::io::Error| match cause.kind() {
        ErrorKind::FileTooLarge => FileError::TooLarge { path: path.into(), limit: limits.file_bytes },
        _ => FileError::Io { path: path.into(), cause },
    };
    inflated(path, read_regular(path, limits.file_bytes).map_err(fault)?, limits)
}

/// Bytes as they are, or unpacked if they start as gzip; `path` is named in errors.
///
/// # Errors
/// As [`read`].
pub fn inflated(path: &Path, mut bytes: Vec<u8>, limits: &Limits) -> Result<Vec<u8>, FileError> {
    if bytes.starts_with(&[0x1f, 0x8b]) {
        let plausible = unpacked(bytes.len(), MOST_OF_TEXT);
        let most = limits.file_bytes.min(plausible).saturating_add(1);
        bytes = unpack(path, &bytes, most, limits)?;
        if bytes.len() as u64 > plausible {
            return Err(FileError::Bomb { path: path.into() });
        }
    }
    if bytes.len() as u64 > limits.file_bytes {
        return Err(FileError::TooLarge { path: path.into(), limit: limits.file_bytes });
    }
    Ok(bytes)
}

/// At most so many bytes of what is packed.
fn unpack(path: &Path, packed: &[u8], most: u64, limits: &Limits) -> Result<Vec<u8>, FileError> {
    const PIECE: u64 = 64 << 20;
    let mut from = flate2::read::MultiGzDecoder::new(packed).take(most);
    let mut plain = Vec::new();
    loop {
        let before = plain.len() as u64;
        // Growing takes the place of what there is once more.
        room(path, before + PIECE.min(most), before, limits)?;
        let read = from.by_ref().take(PIECE).read_to_end(&mut plain);
        if read.map_err(|cause| FileError::Io { path: path.into(), cause })? == 0 {
            return Ok(plain);
        }
    }
}

/// Most bytes of repetitions over all files that a scene includes.
const REPEATED_MOST: u64 = 512 << 20;

/// The files that a scene includes: each is held once, however often it is included.
#[derive(Debug, Default)]
pub(crate) struct Included {
    texts: HashMap<PathBuf, Arc<[u8]>>,
    repeated: u64,
}

impl Included {
    /// Reads a file, or gives what was read before.
    ///
    /// # Errors
    /// As [`read`], and [`FileError::Repeated`].
    pub fn read(&mut self, path: &Path, limits: &Limits) -> Result<Arc<[u8]>, FileError> {
        let key = path.canonicalize().unwrap_or_else(|_| path.into());
        if let Some(text) = self.texts.get(&key) {
            self.repeated += text.len() as u64;
            if self.repeated > REPEATED_MOST {
                return Err(FileError::Repeated { path: path.into(), limit: REPEATED_MOST });
            }
            return Ok(text.clone());
        }
        let text: Arc<[u8]> = read(path, limits)?.into();
        self.texts.insert(key, text.clone());
        Ok(text)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;

    fn packed(count: usize, byte: impl Fn(usize) -> u8) -> Vec<u8> {
        let mut packer = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
        packer.write_all(&(0..count).map(byte).collect::<Vec<_>>()).unwrap();
        packer.finish().unwrap()
    }

    #[test]
    fn packed_files_are_unpacked_and_bombs_are_not() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("f.gz");
        std::fs::write(&path, packed(1 << 20, |i| (i % 7) as u8)).unwrap();
        assert_eq!(read(&path, &Limits::default()).unwrap().len(), 1 << 20);
        let small = Limits { file_bytes: 1 << 19, ..Limits::default() };
        assert!(matches!(read(&path, &small), Err(FileError::TooLarge { .. })));
        std::fs::write(&path, packed(20 << 20, |_| b' ')).unwrap();
        assert!(matches!(read(&path, &Limits::default()), Err(FileError::Bomb { .. })));
        assert!(matches!(read(folder.path(), &Limits::default()), Err(FileError::Io { .. })));
    }

    #[test]
    fn files_that_memory_has_no_room_for_are_refused_with_the_numbers() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("f");
        // Nothing of it is on the disk.
        std::fs::File::create(&path).unwrap().set_len(3 << 30).unwrap();
        let little = Limits { memory: Some(|| Some(4 << 30)), ..Limits::default() };
        let told = read(&path, &little).unwrap_err().to_string();
        let ending = "' holds 3221225472 bytes; reading it takes about 6442450944 bytes of memory, and 4294967296 are \
                      available";
        assert!(told.ends_with(ending), "{told}");
        let enough = Limits { memory: Some(|| Some(128 << 20)), ..Limits::default() };
        std::fs::File::create(&path).unwrap().set_len(50 << 20).unwrap();
        assert_eq!(read(&path, &enough).unwrap().len(), 50 << 20);
        // What is packed counts as it will be.
        let packed = packed(100 << 20, |i| ((i * i) >> 7) as u8);
        assert!(packed.len() < 50 << 20, "{}", packed.len());
        std::fs::write(&path, packed).unwrap();
        assert!(matches!(read(&path, &enough), Err(FileError::Memory { .. })));
    }

    #[test]
    fn included_files_are_held_once_and_not_repeated_without_end() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("f");
        std::fs::write(&path, vec![b' '; 100 << 20]).unwrap();
        let mut included = Included::default();
        let first = included.read(&path, &Limits::default()).unwrap();
        for _ in 0..5 {
            assert!(Arc::ptr_eq(&first, &included.read(&path, &Limits::default()).unwrap()));
        }
        assert!(matches!(included.read(&path, &Limits::default()), Err(FileError::Repeated { .. })));
    }
}
