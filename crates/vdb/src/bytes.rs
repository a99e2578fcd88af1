//! Little-endian numbers at checked places.

use crate::Error;

/// Bytes and a noun for what they are, for messages.
#[derive(Clone, Copy)]
pub(crate) struct Bytes<'a> {
    pub all: &'a [u8],
    pub what: &'static str,
}

impl<'a> Bytes<'a> {
    /// A part of the bytes.
    pub fn part(&self, at: u64, count: u64) -> Result<&'a [u8], Error> {
        let end = at.checked_add(count).filter(|end| *end <= self.all.len() as u64);
        end.map(|end| &self.all[at as usize..end as usize]).ok_or(Error::Short(self.what))
    }

    fn array<const N: usize>(&self, at: u64) -> Result<[u8; N], Error> {
        let part = self.part(at, N as u64)?;
        Ok(std::array::from_fn(|i| part[i]))
    }

    pub fn u16(&self, at: u64) -> Result<u16, Error> {
        self.array(at).map(u16::from_le_bytes)
    }

    pub fn u32(&self, at: u64) -> Result<u32, Error> {
        self.array(at).map(u32::from_le_bytes)
    }

    pub fn i32(&self, at: u64) -> Result<i32, Error> {
        self.array(at).map(i32::from_le_bytes)
    }

    pub fn u64(&self, at: u64) -> Result<u64, Error> {
        self.array(at).map(u64::from_le_bytes)
    }

    pub fn f32(&self, at: u64) -> Result<f32, Error> {
        self.array(at).map(f32::from_le_bytes)
    }

    pub fn f64(&self, at: u64) -> Result<f64, Error> {
        self.array(at).map(f64::from_le_bytes)
    }
}

/// A bit of a mask, counted from the lowest of the first byte.
pub(crate) fn bit(mask: &[u8], n: usize) -> bool {
    mask[n / 8] >> (n % 8) & 1 == 1
}
