//! Errors of a picture or its file.

use crate::FileKind;
use std::path::PathBuf;

/// Result with this crate's [`Error`].
pub type Result<T> = std::result::Result<T, Error>;

/// Error of reading, writing, mapping or comparing pictures.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Error in the named file; the inner error describes it.
    #[error("{}: {error}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// Inner error.
        error: Box<Error>,
    },
    /// The operating system refused.
    #[error("cannot {action}: {error}")]
    Io {
        /// Action that failed (`open`, `read`, `write`, `create a file beside it`, …).
        action: &'static str,
        /// The system's answer.
        error: std::io::Error,
    },
    /// Neither the content nor the file's extension is a known image format.
    #[error("not a known image format (known: EXR, PNG, JPEG, TGA, BMP, Radiance HDR, PFM, PPM/PGM, DDS, KTX2, WebP)")]
    UnknownFormat,
    /// The file is no grid of voxels.
    #[error("malformed volume file: {0}")]
    VoxelGrid(String),
    /// The file's extension names no format that can be written.
    #[error(
        "cannot tell the image format from the name: the extension must be one of .exr .png .jpg .jpeg .hdr .pfm .ppm .dds .ktx2"
    )]
    UnknownExtension,
    /// The file breaks its format.
    #[error("malformed {kind} file: {message}")]
    Malformed {
        /// The format.
        kind: FileKind,
        /// Fault in the file.
        message: String,
    },
    /// The file is valid but uses something that is not read, or the picture holds something the format cannot store.
    #[error("unsupported in {kind} files: {what}")]
    Unsupported {
        /// The format.
        kind: FileKind,
        /// The thing that is not supported.
        what: String,
    },
    /// The file declares more than the reader's [`crate::Limits`] allow.
    #[error("{what} is {declared}, above the limit of {limit}")]
    Limit {
        /// The limited quantity.
        what: &'static str,
        /// Declared value.
        declared: u64,
        /// Allowed value.
        limit: u64,
    },
    /// The system does not give the memory that a picture needs.
    #[error("there is no memory for the picture: {bytes} bytes cannot be had")]
    OutOfMemory {
        /// Requested bytes.
        bytes: u64,
    },
    /// The file declares more pixels than its bytes can hold.
    #[error("the {kind} file declares {width}x{height} pixels, more than its {bytes} bytes can hold")]
    TooShort {
        /// The format.
        kind: FileKind,
        /// Declared width in pixels.
        width: u64,
        /// Declared height in pixels.
        height: u64,
        /// Bytes that are there.
        bytes: u64,
    },
    /// Two pictures, or a picture and a plane, that must have the same size do not.
    #[error("sizes differ: {left} and {right}")]
    SizeMismatch {
        /// The first size.
        left: String,
        /// The second size.
        right: String,
    },
    /// A picture lacks channels that the operation needs.
    #[error("the image has no {wanted} channels (it has: {present})")]
    MissingChannels {
        /// Channels that are needed.
        wanted: String,
        /// Comma-separated names that exist.
        present: String,
    },
    /// Two channels of one picture have the same name.
    #[error("channel `{0}` exists already")]
    DuplicateChannel(String),
    /// No tone curve has this name.
    #[error(
        "unknown tone curve `{name}`{} (known: {})",
        suggestion.map(|s| format!("; did you mean `{s}`?")).unwrap_or_default(),
        known.join(", ")
    )]
    UnknownTone {
        /// The name asked for.
        name: String,
        /// The nearest known name, if one is near.
        suggestion: Option<&'static str>,
        /// All names of tone curves.
        known: Vec<&'static str>,
    },
    /// A tone curve's parameter is unknown or out of range.
    #[error("tone curve `{curve}`: {message}")]
    ToneParameter {
        /// The curve.
        curve: &'static str,
        /// Fault in the data.
        message: String,
    },
    /// A number given to an operation is out of its range.
    #[error("{0}")]
    Invalid(String),
}

impl Error {
    pub(crate) fn malformed(kind: FileKind, message: impl Into<String>) -> Self {
        Self::Malformed { kind, message: message.into() }
    }

    pub(crate) fn unsupported(kind: FileKind, what: impl Into<String>) -> Self {
        Self::Unsupported { kind, what: what.into() }
    }

    pub(crate) fn at(self, path: &std::path::Path) -> Self {
        Self::File { path: path.to_owned(), error: Box::new(self) }
    }
}
