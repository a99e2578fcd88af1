//! Errors of mesh files, and their position.

use std::fmt;

/// The sort of fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum MeshErrorKind {
    /// Not written as the format demands.
    Syntax,
    /// The file ends early, or declares more than it can hold.
    Truncated,
    /// An index points past what there is, or is negative.
    IndexOutOfRange,
    /// A coordinate is NaN, infinite, or outside the range of single precision.
    NotFinite,
    /// Something that a mesh must have is absent.
    Missing,
    /// Valid, but over what Steradian can hold.
    TooLarge,
    /// Valid, but of a kind or version that is not read.
    Unsupported,
}

/// Position of a fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// A line of text, from 1.
    Line(usize),
    /// An offset in bytes from the start of the file (of the unpacked data in compressed files).
    Byte(usize),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Line(n) => write!(f, "line {n}"),
            Self::Byte(n) => write!(f, "byte {n}"),
        }
    }
}

/// A fault of a mesh file.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{place}: {message}")]
#[non_exhaustive]
pub struct MeshError {
    /// The sort of fault.
    pub kind: MeshErrorKind,
    /// Position as a reader would look it up: line or byte.
    pub place: Place,
    /// Position in bytes from the start.
    pub offset: usize,
    /// Description of the fault, in one sentence that names the element.
    pub message: String,
}

impl MeshError {
    /// A fault in binary data.
    pub(crate) fn at_byte(kind: MeshErrorKind, offset: usize, message: impl Into<String>) -> Self {
        Self { kind, place: Place::Byte(offset), offset, message: message.into() }
    }

    /// A fault in text; the line is found by counting.
    pub(crate) fn in_text(kind: MeshErrorKind, bytes: &[u8], offset: usize, message: impl Into<String>) -> Self {
        let offset = offset.min(bytes.len());
        let line = bytes[..offset].iter().filter(|&&b| b == b'\n').count() + 1;
        Self { kind, place: Place::Line(line), offset, message: message.into() }
    }
}
