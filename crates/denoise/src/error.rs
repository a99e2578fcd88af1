//! Errors of the filters.

use std::fmt;

/// Why nothing is filtered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Error {
    /// An image does not have the size of the frame, in pixels.
    Size {
        /// Which image.
        what: &'static str,
        /// Its width and height.
        found: [u32; 2],
        /// Width and height of the frame.
        expected: [u32; 2],
    },
    /// The number of values is not that of the pixels.
    Values {
        /// Number of values.
        found: usize,
        /// Width and height of the image.
        size: [u32; 2],
    },
    /// There is no pixel.
    Empty,
    /// A setting is outside its range.
    Setting {
        /// Which.
        what: &'static str,
        /// Allowed values.
        range: &'static str,
    },
}

/// Result of this crate's functions.
pub type Result<T> = std::result::Result<T, Error>;

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Size { what, found: [w, h], expected: [x, y] } => {
                write!(f, "{what} has {w}×{h} pixels; the frame has {x}×{y}")
            }
            Self::Values { found, size: [w, h] } => write!(f, "{found} values for an image of {w}×{h}"),
            Self::Empty => write!(f, "the frame has no pixels"),
            Self::Setting { what, range } => write!(f, "{what} is not {range}"),
        }
    }
}

impl std::error::Error for Error {}
