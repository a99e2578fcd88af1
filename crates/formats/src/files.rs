//! Finding and reading files.

use crate::Limits;
use std::{
    io::Read,
    path::{Path, PathBuf},
};

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
    /// The system refused.
    #[error("cannot read '{}': {cause}", .path.display())]
    Io {
        /// Which file.
        path: PathBuf,
        /// What the system said.
        cause: std::io::Error,
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

/// Where the files that a scene names are looked for.
#[derive(Clone, Debug, Default)]
pub struct SearchPath {
    /// Folders in order.
    pub folders: Vec<PathBuf>,
}

impl SearchPath {
    /// Finds a file: as it is when absolute, else in each folder in turn. Backslashes count as slashes where the name as written is
    /// not found.
    ///
    /// # Errors
    /// [`FileError::NotFound`] with every place searched.
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
                    return Ok(place);
                }
                if !searched.contains(&place) {
                    searched.push(place);
                }
            }
        }
        Err(FileError::NotFound { name: name.into(), searched })
    }
}

/// Reads a whole file; one that starts as gzip is unpacked. Never holds more than [`Limits::file_bytes`].
///
/// # Errors
/// [`FileError::Io`] or [`FileError::TooLarge`].
pub fn read(path: &Path, limits: &Limits) -> Result<Vec<u8>, FileError> {
    let io = |cause| FileError::Io { path: path.into(), cause };
    let too_large = || FileError::TooLarge { path: path.into(), limit: limits.file_bytes };
    let file = std::fs::File::open(path).map_err(io)?;
    let meta = file.metadata().map_err(io)?;
    if !meta.is_file() {
        return Err(io(std::io::Error::other("it is not a regular file")));
    }
    if meta.len() > limits.file_bytes {
        return Err(too_large());
    }
    let mut bytes = Vec::with_capacity(meta.len() as usize);
    file.take(limits.file_bytes + 1).read_to_end(&mut bytes).map_err(io)?;
    if bytes.starts_with(&[0x1f, 0x8b]) {
        let mut unpacked = Vec::new();
        flate2::read::MultiGzDecoder::new(bytes.as_slice())
            .take(limits.file_bytes + 1)
            .read_to_end(&mut unpacked)
            .map_err(io)?;
        bytes = unpacked;
    }
    if bytes.len() as u64 > limits.file_bytes {
        return Err(too_large());
    }
    Ok(bytes)
}
