//! Reading the values of a PLY file one after another.

use super::header::{Element, Encoding, Header, Type};
use crate::mesh::{
    MeshError, MeshErrorKind as Kind,
    text::{double, float, integer, is_space, shown},
};

/// The lists of a record that are read.
#[derive(Default)]
pub(super) struct Lists {
    /// The property that has the vertices at the corners of a face.
    pub(super) corner_slot: Option<usize>,
    /// The property that has the texture coordinates at the corners, `u v` of each.
    pub(super) uv_slot: Option<usize>,
    /// Items of the first.
    pub(super) corners: Vec<i64>,
    /// Items of the second.
    pub(super) uvs: Vec<f32>,
}

/// A number type as it lies in a binary file.
pub(super) trait Stored: Copy {
    /// Reads the value that starts at `at`; the caller has checked that it is there.
    fn get(bytes: &[u8], at: usize, big: bool) -> Self;
    /// The value in single precision.
    fn f32(self) -> f32;
    /// The value in double precision.
    fn f64(self) -> f64;
}

/// A precision that numbers are read in.
pub(super) trait Real: Copy {
    /// A word of text as a number.
    fn parsed(word: &[u8]) -> Option<Self>;
    /// A number of a binary file.
    fn of(stored: impl Stored) -> Self;
}

impl Real for f32 {
    #[inline(always)]
    fn parsed(word: &[u8]) -> Option<Self> {
        float(word)
    }

    #[inline(always)]
    fn of(stored: impl Stored) -> Self {
        stored.f32()
    }
}

impl Real for f64 {
    fn parsed(word: &[u8]) -> Option<Self> {
        double(word).or_else(|| float(word).map(Self::from))
    }

    fn of(stored: impl Stored) -> Self {
        stored.f64()
    }
}

macro_rules! stored {
    ($($t:ty),*) => {$(
        impl Stored for $t {
            #[inline(always)]
            fn get(bytes: &[u8], at: usize, big: bool) -> Self {
                let mut raw = [0; size_of::<$t>()];
                raw.copy_from_slice(&bytes[at..at + size_of::<$t>()]);
                if big { Self::from_be_bytes(raw) } else { Self::from_le_bytes(raw) }
            }
            #[inline(always)]
            #[allow(trivial_numeric_casts, clippy::unnecessary_cast, reason = "for all types")]
            fn f32(self) -> f32 {
                self as f32
            }
            #[inline(always)]
            #[allow(trivial_numeric_casts, clippy::unnecessary_cast, clippy::cast_lossless, reason = "for all types")]
            fn f64(self) -> f64 {
                self as f64
            }
        }
    )*};
}
stored!(i8, u8, i16, u16, i32, u32, f32, f64);

/// A number that lies in binary data at an offset.
#[inline]
pub(super) fn stored<R: Real>(t: Type, raw: &[u8], at: usize, big: bool) -> R {
    match t {
        Type::I8 => R::of(i8::get(raw, at, big)),
        Type::U8 => R::of(u8::get(raw, at, big)),
        Type::I16 => R::of(i16::get(raw, at, big)),
        Type::U16 => R::of(u16::get(raw, at, big)),
        Type::I32 => R::of(i32::get(raw, at, big)),
        Type::U32 => R::of(u32::get(raw, at, big)),
        Type::F32 => R::of(f32::get(raw, at, big)),
        Type::F64 => R::of(f64::get(raw, at, big)),
    }
}

/// A place in the data.
#[derive(Clone)]
pub(super) struct Cursor<'a> {
    pub(super) bytes: &'a [u8],
    pub(super) at: usize,
    pub(super) encoding: Encoding,
}

impl<'a> Cursor<'a> {
    pub(super) fn new(bytes: &'a [u8], header: &Header) -> Self {
        Self { bytes, at: header.data, encoding: header.encoding }
    }

    /// Bytes not yet read.
    pub(super) fn left(&self) -> usize {
        self.bytes.len() - self.at
    }

    /// A fault at an offset: told by line in text, by byte in binary data.
    pub(super) fn fault(&self, kind: Kind, offset: usize, message: String) -> MeshError {
        match self.encoding {
            Encoding::Ascii => MeshError::in_text(kind, self.bytes, offset, message),
            _ => MeshError::at_byte(kind, offset, message),
        }
    }

    #[cold]
    fn ended(&self, what: &dyn Fn() -> String) -> MeshError {
        self.fault(Kind::Truncated, self.bytes.len(), format!("the file ends within {}", what()))
    }

    /// The next `n` bytes.
    #[inline]
    fn take(&mut self, n: usize, what: &dyn Fn() -> String) -> Result<&'a [u8], MeshError> {
        match self.bytes.get(self.at..self.at.saturating_add(n)) {
            Some(s) => {
                self.at += n;
                Ok(s)
            }
            None => Err(self.ended(what)),
        }
    }

    /// The next word of text.
    #[inline]
    fn word(&mut self, what: &dyn Fn() -> String) -> Result<&'a [u8], MeshError> {
        let bytes = self.bytes;
        let mut start = self.at;
        while start < bytes.len() && is_space(bytes[start]) {
            start += 1;
        }
        let mut end = start;
        while end < bytes.len() && !is_space(bytes[end]) {
            end += 1;
        }
        self.at = end;
        if start == end { Err(self.ended(what)) } else { Ok(&bytes[start..end]) }
    }

    #[cold]
    fn not_a_number(&self, word: &[u8], what: &dyn Fn() -> String) -> MeshError {
        self.fault(Kind::Syntax, self.at - word.len(), format!("{}: '{}' is not a number", what(), shown(word)))
    }

    /// The next number; `what` says in messages what it belongs to.
    #[inline]
    pub(super) fn number<R: Real>(&mut self, t: Type, what: &dyn Fn() -> String) -> Result<R, MeshError> {
        if self.encoding == Encoding::Ascii {
            let word = self.word(what)?;
            return match R::parsed(word) {
                Some(v) => Ok(v),
                None => Err(self.not_a_number(word, what)),
            };
        }
        let big = self.encoding == Encoding::Big;
        let raw = self.take(t.size(), what)?;
        Ok(stored(t, raw, 0, big))
    }

    /// The next number, which must be whole.
    #[inline]
    pub(super) fn whole(&mut self, t: Type, what: &dyn Fn() -> String) -> Result<i64, MeshError> {
        let at = self.at;
        let real = if self.encoding == Encoding::Ascii {
            let word = self.word(what)?;
            match integer(word) {
                Some(v) => return Ok(v),
                None => double(word).ok_or_else(|| self.not_a_number(word, what))?,
            }
        } else {
            let big = self.encoding == Encoding::Big;
            let raw = self.take(t.size(), what)?;
            match t {
                Type::I8 => return Ok(i8::get(raw, 0, big).into()),
                Type::U8 => return Ok(u8::get(raw, 0, big).into()),
                Type::I16 => return Ok(i16::get(raw, 0, big).into()),
                Type::U16 => return Ok(u16::get(raw, 0, big).into()),
                Type::I32 => return Ok(i32::get(raw, 0, big).into()),
                Type::U32 => return Ok(u32::get(raw, 0, big).into()),
                Type::F32 => f32::get(raw, 0, big).into(),
                Type::F64 => f64::get(raw, 0, big),
            }
        };
        if real.fract() == 0.0 && real.abs() < 9e15 {
            Ok(real as i64)
        } else {
            Err(self.fault(Kind::Syntax, at, format!("{}: {real} is not a whole number", what())))
        }
    }

    /// The next length of a list, which the bytes left can hold.
    #[inline]
    pub(super) fn length(&mut self, t: Type, item: Type, what: &dyn Fn() -> String) -> Result<usize, MeshError> {
        let at = self.at;
        let n = self.whole(t, what)?;
        let least = if self.encoding == Encoding::Ascii { 2 } else { item.size() };
        match usize::try_from(n) {
            Ok(n) if n.checked_mul(least).is_some_and(|need| need <= self.left() + 1) => Ok(n),
            Ok(n) => {
                let message = format!("{}: a list of {n} items, but only {} bytes are left", what(), self.left());
                Err(self.fault(Kind::Truncated, at, message))
            }
            Err(_) => Err(self.fault(Kind::Syntax, at, format!("{}: a list cannot have {n} items", what()))),
        }
    }

    /// Reads past all records of an element.
    pub(super) fn skip(&mut self, element: &Element) -> Result<(), MeshError> {
        if let Some(size) = element.fixed_record(self.encoding) {
            let what = || format!("element '{}'", element.name);
            self.take(size.saturating_mul(element.count), &what)?;
            return Ok(());
        }
        if element.properties.is_empty() {
            return Ok(());
        }
        for row in 0..element.count {
            let what = || format!("element '{}', record {row}", element.name);
            for p in &element.properties {
                match p.length {
                    None => self.skip_values(1, p.item, &what)?,
                    Some(length) => {
                        let n = self.length(length, p.item, &what)?;
                        self.skip_values(n, p.item, &what)?;
                    }
                }
            }
        }
        Ok(())
    }

    fn skip_values(&mut self, n: usize, item: Type, what: &dyn Fn() -> String) -> Result<(), MeshError> {
        if self.encoding == Encoding::Ascii {
            for _ in 0..n {
                self.word(what)?;
            }
            return Ok(());
        }
        self.take(n.saturating_mul(item.size()), what).map(|_| ())
    }

    /// Reads one record: its single numbers into `row` (one place per property), and the items of `lists`.
    pub(super) fn record<R: Real>(
        &mut self,
        element: &Element,
        index: usize,
        row: &mut [R],
        lists: &mut Lists,
    ) -> Result<(), MeshError> {
        lists.corners.clear();
        lists.uvs.clear();
        for (slot, p) in element.properties.iter().enumerate() {
            let what = || format!("{} {index}, property '{}'", element.name, p.name);
            match p.length {
                None => row[slot] = self.number(p.item, &what)?,
                Some(length) => {
                    let n = self.length(length, p.item, &what)?;
                    if lists.corner_slot == Some(slot) {
                        for _ in 0..n {
                            lists.corners.push(self.whole(p.item, &what)?);
                        }
                    } else if lists.uv_slot == Some(slot) {
                        for _ in 0..n {
                            lists.uvs.push(self.number(p.item, &what)?);
                        }
                    } else {
                        self.skip_values(n, p.item, &what)?;
                    }
                }
            }
        }
        Ok(())
    }
}
