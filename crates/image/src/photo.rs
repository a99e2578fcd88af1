//! JPEG, TGA and BMP: decoded by the `image` crate under our limits. Nothing but decoding is applied: no EXIF rotation,
//! no profile.

use crate::limits::zeros;
use crate::{Encoding, Error, FileKind, Limits, Result, TexelData, Texels, atomic::io};
use image::{ColorType, ImageDecoder, ImageError};
use std::io::{Cursor, Write};

/// The largest number of pixels that a byte of such a file can stand for. Run lengths of TGA cover 128 pixels of 2
/// bytes, those of BMP 255 pixels in 2 bytes; a JPEG of one colour can need less than a bit per 8×8 block in its
/// progressive form.
const MAX_PIXELS_PER_BYTE: f64 = 4096.0;

pub(crate) fn decode(kind: FileKind, bytes: &[u8], limits: &Limits) -> Result<Texels> {
    let cursor = Cursor::new(bytes);
    let explain = |error| explain(kind, error);
    match kind {
        FileKind::Jpeg => {
            check_jpeg(bytes, limits)?;
            decode_with(kind, image::codecs::jpeg::JpegDecoder::new(cursor).map_err(explain)?, bytes.len(), limits)
        }
        FileKind::Tga => {
            check_tga_header(bytes, limits)?;
            decode_with(kind, image::codecs::tga::TgaDecoder::new(cursor).map_err(explain)?, bytes.len(), limits)
        }
        _ => decode_with(kind, image::codecs::bmp::BmpDecoder::new(cursor).map_err(explain)?, bytes.len(), limits),
    }
}

fn decode_with(kind: FileKind, decoder: impl ImageDecoder, available: usize, limits: &Limits) -> Result<Texels> {
    let (width, height) = decoder.dimensions();
    let colour = decoder.color_type();
    let (channels, sixteen) = match colour {
        ColorType::L8 => (1, false),
        ColorType::La8 => (2, false),
        ColorType::Rgb8 => (3, false),
        ColorType::Rgba8 => (4, false),
        ColorType::L16 => (1, true),
        ColorType::Rgb16 => (3, true),
        other => return Err(Error::unsupported(kind, format!("{other:?} pixels"))),
    };
    let bytes_per_pixel = u64::from(colour.bytes_per_pixel());
    let size = (u64::from(width), u64::from(height));
    let pixels = limits.check_against(kind, size, bytes_per_pixel, available, MAX_PIXELS_PER_BYTE)?;
    let mut buffer = zeros(pixels * bytes_per_pixel as usize)?;
    if decoder.total_bytes() != buffer.len() as u64 {
        return Err(Error::malformed(kind, "the decoded size is wrong"));
    }
    decoder.read_image(&mut buffer).map_err(|error| explain(kind, error))?;
    let data = if sixteen {
        TexelData::U16(buffer.as_chunks::<2>().0.iter().map(|b| u16::from_ne_bytes(*b)).collect())
    } else {
        TexelData::U8(buffer)
    };
    Ok(Texels::new(width as usize, height as usize, channels, data, Encoding::Srgb))
}

/// Walks the segments up to the first scan: checks the size in the frame header (SOF0 to SOF2), refuses the lossless,
/// hierarchical and arithmetic variants by name, and files that are cut off: those the decoder would fill up with grey.
fn check_jpeg(bytes: &[u8], limits: &Limits) -> Result<()> {
    const KIND: FileKind = FileKind::Jpeg;
    let missing = || Error::malformed(KIND, "no frame header before the first scan");
    let (mut at, mut framed) = (2, false);
    loop {
        let marker = match bytes.get(at..at + 2).ok_or_else(missing)? {
            [0xff, 0xff] => {
                at += 1;
                continue;
            }
            [0xff, marker] => *marker,
            _ => return Err(missing()),
        };
        let body = bytes.get(at + 2..).ok_or_else(missing)?;
        match marker {
            0xc0..=0xc2 => {
                let frame = body.get(..8).ok_or_else(missing)?;
                let [height, width] = [[frame[3], frame[4]], [frame[5], frame[6]]].map(u16::from_be_bytes);
                if frame[2] != 8 {
                    return Err(Error::unsupported(KIND, format!("{}-bit samples", frame[2])));
                }
                let size = (width.into(), height.into());
                limits.check_against(KIND, size, 4, bytes.len(), MAX_PIXELS_PER_BYTE)?;
                framed = true;
            }
            0xc3 | 0xc5..=0xc7 | 0xc9..=0xcb | 0xcd..=0xcf => {
                return Err(Error::unsupported(KIND, "lossless, hierarchical or arithmetic coding"));
            }
            // Start of scan; inside scans 0xff is followed by 0, a restart or a true marker.
            0xda if framed && body.windows(2).any(|w| w == [0xff, 0xd9]) => return Ok(()),
            0xda if framed => return Err(Error::malformed(KIND, "the file ends early (no end marker)")),
            0xd9 | 0xda => return Err(missing()),
            0x01 | 0xd0..=0xd8 => {
                at += 2;
                continue;
            }
            _ => {}
        }
        let length = body.get(..2).ok_or_else(missing)?;
        at += 2 + usize::from(u16::from_be_bytes([length[0], length[1]])).max(2);
    }
}

fn check_tga_header(bytes: &[u8], limits: &Limits) -> Result<()> {
    let header = bytes.get(..18).ok_or_else(|| Error::malformed(FileKind::Tga, "the header ends early"))?;
    let [width, height] = [[header[12], header[13]], [header[14], header[15]]].map(u16::from_le_bytes);
    limits.check_against(FileKind::Tga, (width.into(), height.into()), 4, bytes.len(), MAX_PIXELS_PER_BYTE)?;
    Ok(())
}

fn explain(kind: FileKind, error: ImageError) -> Error {
    match error {
        ImageError::Unsupported(what) => Error::unsupported(kind, what.to_string()),
        ImageError::IoError(error) => Error::malformed(kind, format!("the file ends early ({error})")),
        other => Error::malformed(kind, other.to_string()),
    }
}

/// Writes the bytes of a JPEG file; `quality` 1 to 100, interleaved 8-bit grey (1) or RGB (3).
pub(crate) fn encode_jpeg(
    width: u32,
    height: u32,
    channels: usize,
    samples: &[u8],
    quality: u8,
    out: &mut dyn Write,
) -> Result<()> {
    let colour = if channels == 1 { image::ExtendedColorType::L8 } else { image::ExtendedColorType::Rgb8 };
    image::codecs::jpeg::JpegEncoder::new_with_quality(out, quality.clamp(1, 100))
        .encode(samples, width, height, colour)
        .map_err(|error| match error {
            ImageError::IoError(error) => io("write")(error),
            other => explain(FileKind::Jpeg, other),
        })
}
