//! PNG files: every colour type and depth in, 8 or 16 bit RGB(A) or grey out.
//!
//! Stored values are taken as sRGB encoded, 16-bit ones too, as pbrt-v4 and Mitsuba 3 do. A `gAMA` chunk is not
//! applied; it is reported as metadata `gamma` (the file's exponent, e.g. 0.45455) for callers that want it.

use crate::limits::{METADATA_BYTES, METADATA_INFLATED, MOST_DEFLATED, check_metadata, within, zeros};
use crate::{Encoding, Error, FileKind, Limits, Metadata, Result, TexelData, Texels, Value, atomic::io};
use png::{BitDepth, ColorType, Transformations};
use std::io::Write;

const KIND: FileKind = FileKind::Png;

/// A pixel takes an eighth of a byte at least.
const MAX_PIXELS_PER_BYTE: f64 = MOST_DEFLATED as f64 * 8.0;

pub(crate) fn decode(bytes: &[u8], limits: &Limits) -> Result<Texels> {
    // Xcode's variant for iPhones has a chunk of its own first, turned channels and data that no other program unpacks.
    if bytes.get(12..16) == Some(b"CgBI") {
        let what = "pictures packed for iPhones (CgBI), which are no PNG; 'pngcrush -revert-iphone-optimizations' gives the original back";
        return Err(Error::unsupported(KIND, what));
    }
    let metadata = png::Limits { bytes: METADATA_BYTES.min(limits.bytes as usize) };
    let mut decoder = png::Decoder::new_with_limits(std::io::Cursor::new(bytes), metadata);
    // Profiles are not applied, so they are not unpacked.
    decoder.set_ignore_iccp_chunk(true);
    // Palettes, 1 to 4 bit samples and transparent colours become 8 bit samples and alpha.
    decoder.set_transformations(Transformations::EXPAND);
    let info = decoder.read_header_info().map_err(explain)?;
    let (width, height) = (info.width, info.height);
    limits.check_against(KIND, (width.into(), height.into()), 8, bytes.len(), MAX_PIXELS_PER_BYTE)?;
    let mut reader = decoder.read_info().map_err(explain)?;

    let size = reader.output_buffer_size().ok_or(Error::Limit {
        what: "the decoded size in bytes",
        declared: u64::MAX,
        limit: limits.bytes,
    })?;
    within("the decoded size in bytes", size as u64, limits.bytes)?;
    let mut buffer = zeros(size)?;
    let frame = reader.next_frame(&mut buffer).map_err(explain)?;
    buffer.truncate(frame.buffer_size());
    // Texts may follow the pixels; should the file be damaged only there, its picture is whole.
    let _ = reader.finish();

    let channels = match frame.color_type {
        ColorType::Grayscale => 1,
        ColorType::GrayscaleAlpha => 2,
        ColorType::Rgb => 3,
        ColorType::Rgba => 4,
        ColorType::Indexed => return Err(Error::malformed(KIND, "a palette image without palette")),
    };
    let data = match frame.bit_depth {
        BitDepth::Eight => TexelData::U8(buffer),
        BitDepth::Sixteen => TexelData::U16(buffer.as_chunks::<2>().0.iter().map(|b| u16::from_be_bytes(*b)).collect()),
        other => return Err(Error::unsupported(KIND, format!("{other:?} bit samples"))),
    };
    if data.len() != width as usize * height as usize * channels {
        return Err(Error::malformed(KIND, "the decoded size is wrong"));
    }
    let mut texels = Texels::new(width as usize, height as usize, channels, data, Encoding::Srgb);
    let info = reader.info();
    if let Some(gamma) = info.gama_chunk {
        texels.metadata.set("gamma", Value::Float(gamma.into_value()));
    }
    check_metadata(info.uncompressed_latin1_text.len() + info.compressed_latin1_text.len() + info.utf8_text.len())?;
    for chunk in &info.uncompressed_latin1_text {
        texels.metadata.set_text(chunk.keyword.clone(), chunk.text.clone());
    }
    // What is packed is unpacked within bounds; a text that is longer is left out.
    let mut room = METADATA_INFLATED;
    let mut spend = |keyword: &str, most: usize, text: Option<String>| {
        room -= text.as_ref().map_or(most, String::len).min(room);
        if let Some(text) = text {
            texels.metadata.set_text(keyword, text);
        }
        room.min(METADATA_INFLATED / 4)
    };
    let mut most = METADATA_INFLATED / 4;
    for chunk in &info.compressed_latin1_text {
        let mut chunk = chunk.clone();
        let text = chunk.decompress_text_with_limit(most).and_then(|()| chunk.get_text()).ok();
        most = spend(&chunk.keyword, most, text);
    }
    for chunk in &info.utf8_text {
        if chunk.compressed {
            let mut chunk = chunk.clone();
            let text = chunk.decompress_text_with_limit(most).and_then(|()| chunk.get_text()).ok();
            most = spend(&chunk.keyword, most, text);
        } else if let Ok(text) = chunk.get_text() {
            spend(&chunk.keyword, 0, Some(text));
        }
    }
    Ok(texels)
}

/// The form of a PNG file of colours.
pub(crate) struct Form {
    pub width: u32,
    pub height: u32,
    pub has_alpha: bool,
    /// Samples of 16 bits.
    pub is_sixteen: bool,
}

impl Form {
    /// Bytes of a pixel.
    pub(crate) fn pixel_bytes(&self) -> usize {
        (3 + usize::from(self.has_alpha)) * if self.is_sixteen { 2 } else { 1 }
    }
}

/// Writes a PNG file with the sRGB chunk and the metadata as text chunks; `pixels` writes its interleaved display
/// values, the most significant bytes first.
pub(crate) fn encode(
    form: &Form,
    metadata: &Metadata,
    out: &mut dyn Write,
    pixels: impl FnOnce(&mut dyn Write) -> Result<()>,
) -> Result<()> {
    let mut encoder = png::Encoder::new(out, form.width, form.height);
    encoder.set_color(if form.has_alpha { ColorType::Rgba } else { ColorType::Rgb });
    encoder.set_depth(if form.is_sixteen { BitDepth::Sixteen } else { BitDepth::Eight });
    encoder.set_compression(png::Compression::Balanced);
    encoder.set_source_srgb(png::SrgbRenderingIntent::RelativeColorimetric);
    // What tells of layers has no place where there are none.
    for (name, value) in metadata.entries.iter().filter(|(name, _)| !name.starts_with("cryptomatte/")) {
        let text = match value {
            Value::Text(text) => text.clone(),
            Value::Float(x) => x.to_string(),
            Value::Int(i) => i.to_string(),
            Value::Matrix(m) => m.map(|x| x.to_string()).join(" "),
        };
        if !(1..=79).contains(&name.len()) || !name.is_ascii() {
            return Err(Error::unsupported(KIND, format!("the metadata name {name:?} (1 to 79 ASCII characters)")));
        }
        // International text chunks hold any text.
        if text.is_ascii() {
            encoder.add_text_chunk(name.clone(), text).map_err(refuse)?;
        } else {
            encoder.add_itxt_chunk(name.clone(), text).map_err(refuse)?;
        }
    }
    let mut writer = encoder.write_header().map_err(refuse)?;
    let mut rows = writer.stream_writer_with_size(1 << 16).map_err(refuse)?;
    pixels(&mut rows)?;
    rows.finish().map_err(refuse)?;
    writer.finish().map_err(refuse)
}

fn explain(error: png::DecodingError) -> Error {
    match error {
        png::DecodingError::LimitsExceeded => Error::malformed(KIND, "a chunk is above the size limit"),
        other => Error::malformed(KIND, other.to_string()),
    }
}

fn refuse(error: png::EncodingError) -> Error {
    if let png::EncodingError::IoError(error) = error {
        return io("write")(error);
    }
    Error::unsupported(KIND, error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Xcode puts a chunk of its own before the header.
    #[test]
    fn pictures_packed_for_iphones_are_named() {
        let mut bytes = b"\x89PNG\r\n\x1a\n\0\0\0\x04CgBI\x50\0\x20\x06\x2b\xd5\xb3\x7f".to_vec();
        bytes.extend(b"\0\0\0\x0dIHDR\0\0\0\x01\0\0\0\x01\x08\x06\0\0\0\x1f\x15\xc4\x89");
        let said = decode(&bytes, &Limits::default()).unwrap_err().to_string();
        assert!(said.contains("iPhones (CgBI)") && !said.contains('{'), "{said}");
    }
}
