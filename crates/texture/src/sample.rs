//! Samples of texels as they are stored, and their linear values.

use half::f16;
use std::sync::Arc;
use steradian_image::{Encoding, TexelData};

/// Storage format of one sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Kind {
    /// 8 bits, code / 255.
    U8,
    /// 16 bits, code / 65535.
    U16,
    /// Half float.
    F16,
    /// Float.
    F32,
}

impl Kind {
    /// The kind of these samples.
    pub fn of(data: &TexelData) -> Self {
        match data {
            TexelData::U8(_) => Self::U8,
            TexelData::U16(_) => Self::U16,
            TexelData::F16(_) => Self::F16,
            TexelData::F32(_) => Self::F32,
        }
    }

    /// Bytes of one sample.
    pub fn bytes(self) -> usize {
        match self {
            Self::U8 => 1,
            Self::U16 | Self::F16 => 2,
            Self::F32 => 4,
        }
    }
}

/// The linear values of stored samples.
#[derive(Clone, Debug)]
pub struct Decoder {
    encoding: Encoding,
    /// Linear values of 8-bit codes.
    table: Arc<[f32; 256]>,
}

impl Decoder {
    /// For an encoding.
    pub fn new(encoding: Encoding) -> Self {
        Self { encoding, table: Arc::new(encoding.table8()) }
    }

    /// The encoding.
    pub fn encoding(&self) -> Encoding {
        self.encoding
    }

    /// Linear value of an 8-bit code.
    #[inline]
    pub fn u8(&self, code: u8) -> f32 {
        self.table[code as usize]
    }

    /// Linear value of any other stored value.
    #[inline]
    pub fn stored(&self, value: f32) -> f32 {
        if self.encoding == Encoding::Linear { value } else { self.curved(value) }
    }

    #[cold]
    #[inline(never)]
    fn curved(&self, value: f32) -> f32 {
        self.encoding.decode(value)
    }
}

/// A sample as it is stored.
pub trait Sample: Sized {
    /// Its linear value.
    fn linear(&self, decoder: &Decoder) -> f32;

    /// The samples of a picture, if they are such.
    fn of(data: &TexelData) -> Option<&[Self]>;
}

impl Sample for u8 {
    #[inline(always)]
    fn linear(&self, decoder: &Decoder) -> f32 {
        decoder.u8(*self)
    }

    #[inline(always)]
    fn of(data: &TexelData) -> Option<&[Self]> {
        if let TexelData::U8(data) = data { Some(data) } else { None }
    }
}

impl Sample for u16 {
    #[inline(always)]
    fn linear(&self, decoder: &Decoder) -> f32 {
        decoder.stored(f32::from(*self) / 65535.0)
    }

    #[inline(always)]
    fn of(data: &TexelData) -> Option<&[Self]> {
        if let TexelData::U16(data) = data { Some(data) } else { None }
    }
}

impl Sample for f16 {
    #[inline(always)]
    fn linear(&self, decoder: &Decoder) -> f32 {
        decoder.stored(from_half(*self))
    }

    #[inline(always)]
    fn of(data: &TexelData) -> Option<&[Self]> {
        if let TexelData::F16(data) = data { Some(data) } else { None }
    }
}

impl Sample for f32 {
    #[inline(always)]
    fn linear(&self, decoder: &Decoder) -> f32 {
        decoder.stored(*self)
    }

    #[inline(always)]
    fn of(data: &TexelData) -> Option<&[Self]> {
        if let TexelData::F32(data) = data { Some(data) } else { None }
    }
}

/// A half float as a float, without the call that finds out whether the processor has an instruction for it.
#[inline(always)]
pub(super) fn from_half(half: f16) -> f32 {
    let bits = u32::from(half.to_bits());
    // The exponent is moved by a multiplication, which is right for denormal numbers too.
    let magnitude = (f32::from_bits((bits & 0x7fff) << 13) * 2_f32.powi(112)).to_bits();
    let special = if bits & 0x7c00 == 0x7c00 { 0x7f80_0000 } else { 0 };
    f32::from_bits(magnitude | special | (bits & 0x8000) << 16)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_half_float_has_its_value() {
        for bits in 0..=u16::MAX {
            let half = f16::from_bits(bits);
            let (seen, wanted) = (from_half(half), half.to_f32());
            assert!(seen.to_bits() == wanted.to_bits() || seen.is_nan() && wanted.is_nan(), "{bits:04x}");
        }
    }
}
