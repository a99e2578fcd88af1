//! Little-endian numbers at checked places.

use crate::Error;

/// Longest name, in bytes.
const LONGEST: u32 = 1 << 12;

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

/// Bytes that are read one after the other.
#[derive(Clone, Copy)]
pub(crate) struct Stream<'a> {
    pub bytes: Bytes<'a>,
    pub at: u64,
}

impl<'a> Stream<'a> {
    pub fn new(all: &'a [u8], what: &'static str) -> Self {
        Self { bytes: Bytes { all, what }, at: 0 }
    }

    pub fn take(&mut self, count: u64) -> Result<&'a [u8], Error> {
        let part = self.bytes.part(self.at, count)?;
        self.at += count;
        Ok(part)
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], Error> {
        let part = self.take(N as u64)?;
        Ok(std::array::from_fn(|i| part[i]))
    }

    pub fn u8(&mut self) -> Result<u8, Error> {
        self.array().map(|[byte]| byte)
    }

    pub fn u32(&mut self) -> Result<u32, Error> {
        self.array().map(u32::from_le_bytes)
    }

    pub fn i32(&mut self) -> Result<i32, Error> {
        self.array().map(i32::from_le_bytes)
    }

    pub fn u64(&mut self) -> Result<u64, Error> {
        self.array().map(u64::from_le_bytes)
    }

    pub fn f32(&mut self) -> Result<f32, Error> {
        self.array().map(f32::from_le_bytes)
    }

    pub fn f64(&mut self) -> Result<f64, Error> {
        self.array().map(f64::from_le_bytes)
    }

    /// A text behind its length of 32 bits, at most [`LONGEST`].
    pub fn text(&mut self) -> Result<String, Error> {
        let length = self.u32()?;
        if length > LONGEST {
            return Err(Error::Malformed(format!("a name of {length} bytes is longer than {LONGEST}")));
        }
        self.take(length.into()).map(|text| String::from_utf8_lossy(text).into_owned())
    }
}

/// A bit of a mask, counted from the lowest of the first byte.
pub(crate) fn bit(mask: &[u8], n: usize) -> bool {
    mask[n / 8] >> (n % 8) & 1 == 1
}
