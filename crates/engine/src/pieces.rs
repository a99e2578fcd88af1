//! Pieces of the work of a render: what several machines compute apart and one joins, with the bits of one run.

use std::{
    io::{Error, ErrorKind},
    ops::Range,
};

/// Reason why a render does not fall into pieces that can be computed apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Indivisible {
    /// The method is not made of parts that know nothing of each other.
    #[error("the method keeps one state for the whole picture")]
    OneState,
    /// Samples are spread by needs that are compared over the picture.
    #[error("adaptive sampling decides over the whole picture")]
    Adaptive,
    /// The render ends at an error, which is one of the whole picture.
    #[error("a stop at an error looks at the whole picture")]
    Error,
    /// Groups of paths lie across tiles.
    #[error("paths of neighbouring pixels share what they find (reuse)")]
    Sharing,
    /// Passes depend on a picture before them.
    #[error("the method goes on from its own picture")]
    Follows,
    /// Something else than pieces of this render was asked for.
    #[error("the render has no such pieces")]
    NoSuchPieces,
}

/// The reason, if there is one, why so many pieces do not have these among them.
pub(crate) fn within(pieces: &Range<u32>, of: u32) -> Result<(), Indivisible> {
    if pieces.start < pieces.end && pieces.end <= of { Ok(()) } else { Err(Indivisible::NoSuchPieces) }
}

/// Error of data that no session can have saved.
pub(crate) fn invalid() -> Error {
    Error::from(ErrorKind::InvalidData)
}

/// Error of pieces that are there already.
pub(crate) fn already_there() -> Error {
    Error::from(ErrorKind::AlreadyExists)
}

/// Error of a session that is to be saved or to go on while pieces of it are missing.
pub(crate) fn incomplete() -> Error {
    Error::other("pieces of the picture are missing")
}
