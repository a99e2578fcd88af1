//! A writer that keeps the hash of its output.

use std::io::{Result, Write};

/// A writer with the BLAKE3 hash of all that it passes on.
pub struct Hashing<W> {
    pub inner: W,
    pub hasher: blake3::Hasher,
}

impl<W: Write> Hashing<W> {
    pub fn new(inner: W) -> Self {
        Self { inner, hasher: blake3::Hasher::new() }
    }
}

impl<W: Write> Write for Hashing<W> {
    fn write(&mut self, bytes: &[u8]) -> Result<usize> {
        let written = self.inner.write(bytes)?;
        self.hasher.update(&bytes[..written]);
        Ok(written)
    }

    fn flush(&mut self) -> Result<()> {
        self.inner.flush()
    }
}
