//! Shared parts of serialised formats: a header with a version, and reading that never goes beyond the end.

use crate::bottom_level::{BuildOptions, Preference};
use crate::error::LoadError;
use steradian_math::Vec3;

/// Header of serialised bytes.
pub(crate) struct Header {
    /// Noun of the content, for messages.
    pub what: &'static str,
    pub magic: [u8; 8],
    /// The version that is written, and the one that is read.
    pub version: u32,
}

impl Header {
    /// The header as bytes.
    pub fn written(&self) -> Vec<u8> {
        [&self.magic[..], &self.version.to_le_bytes()].concat()
    }

    /// Checks the header; returns a reader of the bytes after it.
    pub fn read<'a>(&self, bytes: &'a [u8]) -> Result<Reader<'a>, LoadError> {
        let mut rest = Reader(bytes);
        if rest.take()? != self.magic {
            return Err(LoadError::NoStructure { what: self.what });
        }
        match rest.u32()? {
            version if version == self.version => Ok(rest),
            version => Err(LoadError::Version { version, readable: self.version }),
        }
    }
}

/// Options as bytes.
pub(crate) fn option_bytes(options: BuildOptions) -> [u8; 3] {
    let preference = match options.preference {
        Preference::Balanced => 0,
        Preference::FastTrace => 1,
        Preference::FastBuild => 2,
    };
    [options.allow_update.into(), options.allow_compaction.into(), preference]
}

/// Adds bytes with their number.
pub(crate) fn put_slice(out: &mut Vec<u8>, bytes: &[u8]) {
    out.extend((bytes.len() as u64).to_le_bytes());
    out.extend(bytes);
}

/// Decodes a truth value, 0 or 1.
pub(crate) fn boolean(byte: u8) -> Result<bool, LoadError> {
    if byte <= 1 { Ok(byte == 1) } else { Err(LoadError::Invalid { what: "truth value" }) }
}

/// Bytes that have not been read.
pub(crate) struct Reader<'a>(&'a [u8]);

impl<'a> Reader<'a> {
    /// The next bytes.
    pub fn take<const N: usize>(&mut self) -> Result<[u8; N], LoadError> {
        let (taken, rest) = self.0.split_first_chunk().ok_or(LoadError::TooShort)?;
        self.0 = rest;
        Ok(*taken)
    }

    /// Primitives of `N` points each, as many as are said to be there; no more memory is taken than there are bytes.
    pub fn points<const N: usize>(&mut self) -> Result<Vec<[Vec3; N]>, LoadError> {
        let bytes = u64::from_le_bytes(self.take()?).checked_mul(12 * N as u64).ok_or(LoadError::TooShort)?;
        let taken = self.slice(bytes)?;
        let number = |b: &[u8]| f32::from_le_bytes(std::array::from_fn(|i| b[i]));
        let point = |b: &[u8]| Vec3::new(number(&b[..4]), number(&b[4..8]), number(&b[8..]));
        let primitive = |b: &[u8]| std::array::from_fn(|i| point(&b[12 * i..12 * i + 12]));
        Ok(taken.chunks_exact(12 * N).map(primitive).collect())
    }

    /// An integer.
    pub fn u32(&mut self) -> Result<u32, LoadError> {
        Ok(u32::from_le_bytes(self.take()?))
    }

    /// So many bytes.
    pub fn slice(&mut self, bytes: u64) -> Result<&'a [u8], LoadError> {
        let bytes = usize::try_from(bytes).map_err(|_| LoadError::TooShort)?;
        let (taken, rest) = self.0.split_at_checked(bytes).ok_or(LoadError::TooShort)?;
        self.0 = rest;
        Ok(taken)
    }

    /// Bytes that follow their number.
    pub fn counted(&mut self) -> Result<&'a [u8], LoadError> {
        let bytes = u64::from_le_bytes(self.take()?);
        self.slice(bytes)
    }

    /// As many things as a number says.
    pub fn list<T>(&mut self, one: impl Fn(&mut Self) -> Result<T, LoadError>) -> Result<Vec<T>, LoadError> {
        (0..self.u32()?).map(|_| one(self)).collect()
    }

    /// See [`option_bytes`].
    pub fn options(&mut self) -> Result<BuildOptions, LoadError> {
        let [update, compaction, preference] = self.take()?;
        let preference = match preference {
            0 => Preference::Balanced,
            1 => Preference::FastTrace,
            2 => Preference::FastBuild,
            _ => return Err(LoadError::Invalid { what: "preference" }),
        };
        Ok(BuildOptions { allow_update: boolean(update)?, allow_compaction: boolean(compaction)?, preference })
    }

    /// Checks that all bytes have been read.
    pub fn end(&self) -> Result<(), LoadError> {
        if self.0.is_empty() { Ok(()) } else { Err(LoadError::TooLong { bytes: self.0.len() }) }
    }
}
