//! WebP (RFC 9649): lossy and lossless stills, decoded by the `image-webp` crate under our limits. Nothing but decoding
//! is applied: no EXIF rotation, no profile.

use crate::limits::zeros;
use crate::{Encoding, Error, FileKind, Limits, Result, TexelData, Texels};
use image_webp::{DecodingError, WebPDecoder};
use std::io::Cursor;

const KIND: FileKind = FileKind::WebP;

/// Pixels that any file may have, and more only in proportion to its bytes: lossless pictures of one colour need none.
const ALWAYS: u64 = 1 << 24;
const MAX_PIXELS_PER_BYTE: f64 = 4096.0;

pub(crate) fn decode(bytes: &[u8], limits: &Limits) -> Result<Texels> {
    let (width, height) = size(bytes)?;
    if width * height > ALWAYS {
        limits.check_against(KIND, (width, height), 4, bytes.len(), MAX_PIXELS_PER_BYTE)?;
    } else {
        limits.check(KIND, width, height, 4)?;
    }
    // The decoder takes what lacks at the end for zeros.
    let declared = 8 + u64::from(word(bytes, 4)?);
    if declared > bytes.len() as u64 {
        return Err(Error::malformed(KIND, format!("the file ends early: it has {} of {declared} bytes", bytes.len())));
    }
    let mut decoder = WebPDecoder::new(Cursor::new(bytes)).map_err(explain)?;
    if decoder.is_animated() {
        return Err(Error::unsupported(KIND, "animations"));
    }
    if decoder.dimensions() != (width as u32, height as u32) {
        return Err(Error::malformed(KIND, "its headers declare different sizes"));
    }
    decoder.set_memory_limit(usize::try_from(limits.bytes).unwrap_or(usize::MAX));
    let channels = if decoder.has_alpha() { 4 } else { 3 };
    let mut data = zeros(width as usize * height as usize * channels)?;
    decoder.read_image(&mut data).map_err(explain)?;
    Ok(Texels::new(width as usize, height as usize, channels, TexelData::U8(data), Encoding::Srgb))
}

/// Width and height by the header of the first chunk.
fn size(bytes: &[u8]) -> Result<(u64, u64)> {
    let at = |offset: usize| bytes.get(offset).map(|b| u64::from(*b)).ok_or_else(cut_off);
    let three = |offset| Ok(at(offset)? | at(offset + 1)? << 8 | at(offset + 2)? << 16);
    match bytes.get(12..16).ok_or_else(cut_off)? {
        b"VP8X" => Ok((1 + three(24)?, 1 + three(27)?)),
        b"VP8L" => {
            let word = word(bytes, 21)?;
            Ok((u64::from(1 + (word & 0x3fff)), u64::from(1 + (word >> 14 & 0x3fff))))
        }
        b"VP8 " => Ok(((at(26)? | at(27)? << 8) & 0x3fff, (at(28)? | at(29)? << 8) & 0x3fff)),
        _ => Err(Error::malformed(KIND, "the first chunk is not one of a picture")),
    }
}

fn word(bytes: &[u8], at: usize) -> Result<u32> {
    bytes.get(at..).and_then(<[u8]>::first_chunk).map(|b| u32::from_le_bytes(*b)).ok_or_else(cut_off)
}

fn cut_off() -> Error {
    Error::malformed(KIND, "the header ends early")
}

fn explain(error: DecodingError) -> Error {
    Error::malformed(KIND, error.to_string())
}
