//! Parts common to DDS and KTX2 files: a table of pixel formats, and the first level of a picture in one of them.

use crate::block::{self, BlockFormat, Decoded};
use crate::{Encoding, Error, FileKind, Limits, Result, TexelData, Texels};
use half::f16;

/// Layout of the pixels in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Layout {
    /// Blocks of 4 × 4; whether they are signed.
    Blocks(BlockFormat, bool),
    /// Interleaved 8-bit codes of so many channels.
    Codes(usize),
    /// Interleaved 8-bit codes in the order blue, green, red, and a fourth that is alpha or unused.
    Bgr(usize),
    /// Interleaved 8-bit codes in the order blue, green, red, and a fourth that is unused.
    Bgrx,
    /// Interleaved 16-bit codes.
    Sixteen(usize),
    /// Interleaved half floats.
    Halves(usize),
    /// Interleaved floats.
    Floats(usize),
}

impl Layout {
    /// Bytes of a picture; `None` beyond all numbers.
    pub(crate) fn bytes(self, width: u64, height: u64) -> Option<u64> {
        let per_pixel = match self {
            Self::Blocks(format, _) => {
                return width.div_ceil(4).checked_mul(height.div_ceil(4))?.checked_mul(format.block_bytes() as u64);
            }
            Self::Codes(n) | Self::Bgr(n) => n,
            Self::Bgrx => 4,
            Self::Sixteen(n) | Self::Halves(n) => 2 * n,
            Self::Floats(n) => 4 * n,
        };
        width.checked_mul(height)?.checked_mul(per_pixel as u64)
    }
}

/// Decodes a picture that begins with `data`; the file's size is checked before anything is allocated.
pub(crate) fn decode(
    kind: FileKind,
    layout: Layout,
    srgb: bool,
    (width, height): (u64, u64),
    data: &[u8],
    limits: &Limits,
) -> Result<Texels> {
    limits.check(kind, width, height, 8)?;
    let bytes = layout.bytes(width, height).filter(|&n| n <= data.len() as u64);
    let Some(bytes) = bytes else {
        return Err(Error::TooShort { kind, width, height, bytes: data.len() as u64 });
    };
    let data = &data[..bytes as usize];
    let (w, h) = (width as usize, height as usize);
    let encoding = if srgb { Encoding::Srgb } else { Encoding::Linear };
    let codes = |data: Vec<u8>, n: usize| two_channels_as_three(w, h, n, TexelData::U8(data), encoding);
    Ok(match layout {
        Layout::Blocks(format, signed) => match block::decode(format, signed, data, w, h) {
            Some(Decoded::Codes(data, n)) => Texels::new(w, h, n, TexelData::U8(data), encoding),
            Some(Decoded::Halves(data, n)) => Texels::new(w, h, n, TexelData::F16(data), Encoding::Linear),
            None => return Err(Error::TooShort { kind, width, height, bytes: data.len() as u64 }),
        },
        Layout::Codes(n) => codes(data.to_vec(), n),
        Layout::Bgr(n) => {
            let mut data = data.to_vec();
            data.chunks_exact_mut(n).for_each(|t| t.swap(0, 2));
            codes(data, n)
        }
        Layout::Bgrx => codes(data.chunks_exact(4).flat_map(|t| [t[2], t[1], t[0]]).collect(), 3),
        Layout::Sixteen(n) => {
            let data = data.as_chunks::<2>().0.iter().map(|b| u16::from_le_bytes(*b)).collect();
            two_channels_as_three(w, h, n, TexelData::U16(data), encoding)
        }
        Layout::Halves(n) => {
            let data = data.as_chunks::<2>().0.iter().map(|b| f16::from_le_bytes(*b)).collect();
            two_channels_as_three(w, h, n, TexelData::F16(data), Encoding::Linear)
        }
        Layout::Floats(n) => {
            let data = data.as_chunks::<4>().0.iter().map(|b| f32::from_le_bytes(*b)).collect();
            two_channels_as_three(w, h, n, TexelData::F32(data), Encoding::Linear)
        }
    })
}

/// Decodes the six faces of a cube map below each other, +x, −x, +y, −y, +z, −z; `stride` is the distance in bytes from
/// face to face.
pub(crate) fn decode_faces(
    kind: FileKind,
    (layout, srgb): (Layout, bool),
    (width, height): (u64, u64),
    (data, stride): (&[u8], u64),
    limits: &Limits,
) -> Result<Texels> {
    if width != height {
        return Err(Error::malformed(kind, "the faces of a cube map are squares"));
    }
    limits.check(kind, width, height.saturating_mul(6), 8)?;
    let face = |k: u64| {
        let start = k.saturating_mul(stride).min(data.len() as u64) as usize;
        decode(kind, layout, srgb, (width, height), &data[start..], limits)
    };
    let faces = (0..6).map(face).collect::<Result<Vec<_>>>()?;
    // Blocks whose alpha is one everywhere came without it.
    let channels = faces.iter().map(|f| f.channels).min().unwrap_or(0);
    fn join<'t, T: Copy + 't>(faces: impl Iterator<Item = (&'t Vec<T>, usize)>, channels: usize) -> Vec<T> {
        faces.flat_map(|(data, n)| data.chunks_exact(n).flat_map(move |texel| &texel[..channels])).copied().collect()
    }
    macro_rules! joined {
        ($kind:ident) => {
            TexelData::$kind(join(
                faces.iter().filter_map(|f| match &f.data {
                    TexelData::$kind(data) => Some((data, f.channels)),
                    _ => None,
                }),
                channels,
            ))
        };
    }
    let data = match faces.first().map(|f| &f.data) {
        Some(TexelData::U16(_)) => joined!(U16),
        Some(TexelData::F16(_)) => joined!(F16),
        Some(TexelData::F32(_)) => joined!(F32),
        _ => joined!(U8),
    };
    let encoding = faces.first().map_or(Encoding::Linear, |f| f.encoding);
    Ok(Texels::new(width as usize, 6 * height as usize, channels, data, encoding))
}

/// Two channels are red and green in these files, not grey and alpha: blue is zero.
fn two_channels_as_three(w: usize, h: usize, channels: usize, data: TexelData, encoding: Encoding) -> Texels {
    fn widen<T: Copy + Default>(v: &[T]) -> Vec<T> {
        v.chunks_exact(2).flat_map(|t| [t[0], t[1], T::default()]).collect()
    }
    if channels != 2 {
        return Texels::new(w, h, channels, data, encoding);
    }
    let data = match data {
        TexelData::U8(v) => TexelData::U8(widen(&v)),
        TexelData::U16(v) => TexelData::U16(widen(&v)),
        TexelData::F16(v) => TexelData::F16(widen(&v)),
        TexelData::F32(v) => TexelData::F32(widen(&v)),
    };
    Texels::new(w, h, 3, data, encoding)
}

/// The little-endian number at an offset.
pub(crate) fn u32_at(kind: FileKind, bytes: &[u8], at: usize) -> Result<u32> {
    let four = at.checked_add(4).and_then(|end| bytes.get(at..end)).and_then(|b| b.first_chunk());
    four.map(|b| u32::from_le_bytes(*b)).ok_or_else(|| Error::malformed(kind, "the file ends in its header"))
}

/// The little-endian number at an offset.
pub(crate) fn u64_at(kind: FileKind, bytes: &[u8], at: usize) -> Result<u64> {
    Ok(u64::from(u32_at(kind, bytes, at)?) | u64::from(u32_at(kind, bytes, at + 4)?) << 32)
}
