//! Volumes of NanoVDB's and OpenVDB's files (`.nvdb`, `.vdb`) as dense grids of numbers.
//!
//! 1. The file is recognised by its first bytes (`read`), and its grid of the name asked for is found and unpacked
//!    (`nano::file`, `open::file`, `blosc`).
//! 2. Its tree of 32³, 16³ and 8³ children is walked, and voxels and tiles within the box of the active ones are copied
//!    into a dense grid (`nano::tree`, `open::tree`, `dense`).
//! 3. The grid's map from indices to its world goes with it.
//!
//! Each offset and count of a file is held against the bytes there are, and the dense grid against [`Limits`] before
//! there is memory for it. Each part of the box is written at most once, so that time is bounded as well.

mod blosc;
mod bytes;
mod dense;
mod error;
mod limits;
mod nano;
mod open;
mod unpack;

pub use dense::Volume;
pub use error::Error;
pub use limits::Limits;

/// Reads the first grid of a name from the bytes of a file; an empty name is that of any grid.
///
/// # Errors
/// [`Error`] for bytes that are no such file, are damaged or incomplete, or have no such grid, and for a grid that is
/// not of densities, is of a type that is not read, has no active voxels, or exceeds the limits.
pub fn read(bytes: &[u8], name: &str, limits: &Limits) -> Result<Volume, Error> {
    if nano::is_one(bytes) {
        return nano::read(bytes, name, limits);
    }
    if open::is_one(bytes) {
        return open::read(bytes, name, limits);
    }
    Err(Error::Unknown)
}
