//! Values of nodes: a byte of their form, what inactive ones are, and a packed list of the others.

use crate::{
    Error, blosc,
    bytes::{Stream, bit},
    unpack,
};
use half::f16;
use std::borrow::Cow;

/// Flags of packing: by zlib, of active values alone, by Blosc.
const ZIP: u32 = 1;
const ACTIVE_ONLY: u32 = 2;
const BLOSC: u32 = 4;
/// Last of the forms, in which all values are listed.
const ALL: u8 = 6;

/// A stream of values and how they are stored.
#[derive(Clone, Copy)]
pub(super) struct Values<'a> {
    pub stream: Stream<'a>,
    pub packing: u32,
    pub is_half: bool,
    pub background: f32,
}

impl<'a> Values<'a> {
    /// Values of a node, one for each bit of the mask of the active ones; none if they are only passed over.
    pub fn node(&mut self, active: &[u8], is_wanted: bool) -> Result<Vec<f32>, Error> {
        let form = self.stream.u8()?;
        if form > ALL {
            return Err(Error::Malformed(format!("values of form {form} are not known")));
        }
        // Inactive values are of two kinds at most: the background, or those that are named, chosen by a mask.
        let mut inactive = [if form == 0 { self.background } else { -self.background }, self.background];
        if matches!(form, 2 | 4 | 5) {
            inactive[0] = self.stream.f32()?;
        }
        if form == 5 {
            inactive[1] = self.stream.f32()?;
        }
        let choice = if matches!(form, 3..=5) { Some(self.stream.take(active.len() as u64)?) } else { None };
        let is_whole = form == ALL || self.packing & ACTIVE_ONLY == 0;
        let count =
            if is_whole { 8 * active.len() as u64 } else { active.iter().map(|b| u64::from(b.count_ones())).sum() };
        let Some(listed) = self.list(count, is_wanted)? else { return Ok(Vec::new()) };
        let mut listed = listed.chunks_exact(self.width() as usize).map(|bytes| match *bytes {
            [a, b] => f16::from_le_bytes([a, b]).to_f32(),
            [a, b, c, d] => f32::from_le_bytes([a, b, c, d]),
            _ => 0.0,
        });
        let value = |n: usize| match is_whole || bit(active, n) {
            true => listed.next().unwrap_or_default(),
            false => inactive[usize::from(choice.is_some_and(|mask| bit(mask, n)))],
        };
        Ok((0..8 * active.len()).map(value).collect())
    }

    /// Bytes of a number.
    fn width(&self) -> u64 {
        if self.is_half { 2 } else { 4 }
    }

    /// Bytes of so many numbers, unpacked; none if they are only passed over.
    fn list(&mut self, count: u64, is_wanted: bool) -> Result<Option<Cow<'a, [u8]>>, Error> {
        let size = count * self.width();
        let is_packed = self.packing & (ZIP | BLOSC) != 0 && !(self.is_half && size == 0);
        let length = if is_packed { self.stream.u64()? as i64 } else { 0 };
        // Lists that would not get shorter stand as they are, behind their length below zero.
        if length > 0 {
            let packed = self.stream.take(length as u64)?;
            let unpack = if self.packing & BLOSC != 0 { blosc::unpack } else { unpack::inflate };
            return if is_wanted { unpack(packed, size).map(|all| Some(all.into())) } else { Ok(None) };
        }
        if is_packed && length.unsigned_abs() != size {
            let found = length.unsigned_abs();
            return Err(Error::Malformed(format!("a list of values has {found} bytes, not {size}")));
        }
        let all = self.stream.take(size)?;
        Ok(is_wanted.then_some(all.into()))
    }
}
