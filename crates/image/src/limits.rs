//! Size limits of pictures, checked before a decoder allocates.

use crate::{Error, FileKind, Result};

/// Upper bounds on what an image file may declare.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Pixels of one picture (width × height; all parts of a multi-part file together).
    pub pixels: u64,
    /// Bytes of decoded samples; also the largest file that is read.
    pub bytes: u64,
    /// Channels of one picture, over all layers.
    pub channels: u64,
}

/// Name of the quantity that [`Limits::pixels`] bounds, in messages.
pub(crate) const PIXELS: &str = "the number of pixels";

impl Default for Limits {
    /// 2²⁸ pixels (16384²), 2 GiB, 1024 channels.
    fn default() -> Self {
        Self { pixels: 1 << 28, bytes: 2 << 30, channels: 1024 }
    }
}

impl Limits {
    /// Checks a declared size, with `bytes_per_pixel` of decoded storage; returns width × height.
    ///
    /// # Errors
    /// [`Error::Limit`] naming the exceeded bound, [`Error::Malformed`] for an empty picture.
    pub(crate) fn check(&self, kind: FileKind, width: u64, height: u64, bytes_per_pixel: u64) -> Result<usize> {
        if width == 0 || height == 0 {
            return Err(Error::malformed(kind, format!("the picture is empty ({width}x{height})")));
        }
        let pixels = width.saturating_mul(height);
        within(PIXELS, pixels, self.pixels)?;
        within("the decoded size in bytes", pixels.saturating_mul(bytes_per_pixel), self.bytes)?;
        usize::try_from(pixels).map_err(|_| Error::Limit { what: PIXELS, declared: pixels, limit: usize::MAX as u64 })
    }

    /// Checks a size as [`Limits::check`] does, and refuses sizes that need more than the `available` bytes when each
    /// byte of the file can stand for at most `pixels_per_byte` pixels.
    pub(crate) fn check_against(
        &self,
        kind: FileKind,
        (width, height): (u64, u64),
        bytes_per_pixel: u64,
        available: usize,
        pixels_per_byte: f64,
    ) -> Result<usize> {
        let pixels = self.check(kind, width, height, bytes_per_pixel)?;
        if pixels as f64 > available as f64 * pixels_per_byte {
            return Err(Error::TooShort { kind, width, height, bytes: available as u64 });
        }
        Ok(pixels)
    }
}

/// Deflate packs at most so many bytes into one (RFC 1951: a match of 258 bytes in two bits).
pub(crate) const MOST_DEFLATED: u64 = 1032;

/// Most metadata entries of a file; far more than any real one has.
const METADATA_ENTRIES: u64 = 4096;

/// Most bytes of metadata of a file as they are stored.
pub(crate) const METADATA_BYTES: usize = 64 << 20;

/// Most bytes of all metadata of a file that are packed in it, once they are unpacked. Entries beyond it are left out.
pub(crate) const METADATA_INFLATED: usize = 4 << 20;

/// Refuses files that are made of metadata.
pub(crate) fn check_metadata(entries: usize) -> Result<()> {
    within("the number of metadata entries", entries as u64, METADATA_ENTRIES)
}

/// `Ok` when `declared` does not exceed `limit`.
pub(crate) fn within(what: &'static str, declared: u64, limit: u64) -> Result<()> {
    if declared > limit { Err(Error::Limit { what, declared, limit }) } else { Ok(()) }
}

/// An empty list with room for so many values, if there is memory for them.
pub(crate) fn with_room<T>(count: usize) -> Result<Vec<T>> {
    let mut list = Vec::new();
    let bytes = (count as u64).saturating_mul(size_of::<T>() as u64);
    list.try_reserve_exact(count).map_err(|_| Error::OutOfMemory { bytes })?;
    Ok(list)
}

/// List of `count` zeros, if there is memory for them.
pub(crate) fn zeros<T: Copy + Default>(count: usize) -> Result<Vec<T>> {
    let mut list = with_room(count)?;
    list.resize(count, T::default());
    Ok(list)
}
