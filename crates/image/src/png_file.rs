//! PNG files: every colour type and depth in, 8 or 16 bit RGB(A) or grey out.
//!
//! Stored values are taken as sRGB encoded, 16-bit ones too, as pbrt-v4 and Mitsuba 3 do. A `gAMA` chunk is not
//! applied; it is reported as metadata `gamma` (the file's exponent, e.g. 0.45455) for callers that want it.

use crate::limits::{METADATA_BYTES, METADATA_INFLATED, MOST_DEFLATED, check_metadata, with_room, within, zeros};
use crate::{Encoding, Error, FileKind, Limits, Metadata, Result, TakeBand, TexelData, Texels, Value, atomic::io};
use png::{BitDepth, ColorType, Transformations};
use std::io::{Cursor, Write};

const KIND: FileKind = FileKind::Png;

/// A pixel takes an eighth of a byte at least.
const MAX_PIXELS_PER_BYTE: f64 = MOST_DEFLATED as f64 * 8.0;

/// A reader behind the header, when what that declares is within the limits.
fn open<'b>(bytes: &'b [u8], limits: &Limits) -> Result<png::Reader<Cursor<&'b [u8]>>> {
    // Xcode's variant for iPhones has a chunk of its own first, turned channels and data that no other program unpacks.
    if bytes.get(12..16) == Some(b"CgBI") {
        let what = "pictures packed for iPhones (CgBI), which are no PNG; 'pngcrush -revert-iphone-optimizations' gives the original back";
        return Err(Error::unsupported(KIND, what));
    }
    let metadata = png::Limits { bytes: METADATA_BYTES.min(limits.bytes as usize) };
    let mut decoder = png::Decoder::new_with_limits(Cursor::new(bytes), metadata);
    // Profiles are not applied, so they are not unpacked.
    decoder.set_ignore_iccp_chunk(true);
    // Palettes, 1 to 4 bit samples and transparent colours become 8 bit samples and alpha.
    decoder.set_transformations(Transformations::EXPAND);
    let info = decoder.read_header_info().map_err(explain)?;
    let (width, height) = (info.width, info.height);
    limits.check_against(KIND, (width.into(), height.into()), 8, bytes.len(), MAX_PIXELS_PER_BYTE)?;
    let reader = decoder.read_info().map_err(explain)?;
    let size = reader.output_buffer_size().map_or(u64::MAX, |size| size as u64);
    within("the decoded size in bytes", size, limits.bytes)?;
    Ok(reader)
}

/// Texels of some rows of a picture.
fn texels(rows: Vec<u8>, reader: &png::Reader<Cursor<&[u8]>>, height: usize) -> Result<Texels> {
    let (color, depth) = reader.output_color_type();
    let channels = match color {
        ColorType::Grayscale => 1,
        ColorType::GrayscaleAlpha => 2,
        ColorType::Rgb => 3,
        ColorType::Rgba => 4,
        ColorType::Indexed => return Err(Error::malformed(KIND, "a palette image without palette")),
    };
    let data = match depth {
        BitDepth::Eight => TexelData::U8(rows),
        BitDepth::Sixteen => TexelData::U16(rows.as_chunks::<2>().0.iter().map(|b| u16::from_be_bytes(*b)).collect()),
        other => return Err(Error::unsupported(KIND, format!("{other:?} bit samples"))),
    };
    let width = reader.info().width as usize;
    if data.len() != width * height * channels {
        return Err(Error::malformed(KIND, "the decoded size is wrong"));
    }
    Ok(Texels::new(width, height, channels, data, Encoding::Srgb))
}

/// The rows of a picture, at most `height` at once; those of an interlaced one all at once. What texts say is not told.
pub(crate) fn bands(bytes: &[u8], limits: &Limits, height: usize, take: TakeBand<'_, Error>) -> Result<()> {
    let mut reader = open(bytes, limits)?;
    if reader.info().interlaced {
        drop(reader);
        let mut texels = decode(bytes, limits)?;
        return take((0, texels.height), &mut texels);
    }
    let rows = reader.info().height as usize;
    let row_bytes = reader.output_line_size(reader.info().width).unwrap_or(0);
    for y in (0..rows).step_by(height.max(1)) {
        let count = height.max(1).min(rows - y);
        let mut band = with_room(row_bytes * count)?;
        for _ in 0..count {
            let row = reader.next_row().map_err(explain)?;
            band.extend_from_slice(row.ok_or_else(|| Error::malformed(KIND, "rows are missing"))?.data());
        }
        take((y, rows), &mut texels(band, &reader, count)?)?;
    }
    Ok(())
}

pub(crate) fn decode(bytes: &[u8], limits: &Limits) -> Result<Texels> {
    let mut reader = open(bytes, limits)?;
    let mut buffer = zeros(reader.output_buffer_size().unwrap_or(usize::MAX))?;
    let frame = reader.next_frame(&mut buffer).map_err(explain)?;
    buffer.truncate(frame.buffer_size());
    // Texts may follow the pixels; should the file be damaged only there, its picture is whole.
    let _ = reader.finish();
    let mut texels = texels(buffer, &reader, frame.height as usize)?;
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

    /// Bands are the rows of the picture: of every colour type and depth, interlaced too.
    #[test]
    fn bands_are_the_picture() {
        let samples = |count: usize| -> Vec<u8> { (0..count).map(|i| (i * 37 + i / 91) as u8).collect() };
        for (color, depth, bytes) in [
            (ColorType::Grayscale, BitDepth::Eight, 1),
            (ColorType::GrayscaleAlpha, BitDepth::Sixteen, 4),
            (ColorType::Rgb, BitDepth::Eight, 3),
            (ColorType::Rgba, BitDepth::Sixteen, 8),
        ] {
            let mut file = Vec::new();
            let mut encoder = png::Encoder::new(&mut file, 13, 37);
            encoder.set_color(color);
            encoder.set_depth(depth);
            encoder.write_header().unwrap().write_image_data(&samples(13 * 37 * bytes)).unwrap();
            let whole = decode(&file, &Limits::default()).unwrap();
            for height in [1, 8, 16, 37, 100] {
                let (mut rows, mut next) = (Vec::new(), 0);
                bands(&file, &Limits::default(), height, &mut |(y, all), band| {
                    assert!(
                        y == next
                            && all == 37
                            && band.height <= height
                            && band.width == 13
                            && band.encoding == whole.encoding
                    );
                    next += band.height;
                    rows.extend((0..band.data.len()).map(|i| band.data.stored(i)));
                    Ok(())
                })
                .unwrap();
                assert!(rows.len() == whole.data.len(), "{color:?} {height}");
                assert!(rows.iter().enumerate().all(|(i, v)| *v == whole.data.stored(i)), "{color:?} {height}");
            }
            // Cut off files are refused.
            let cut = &file[..file.len() * 2 / 3];
            assert!(bands(cut, &Limits::default(), 8, &mut |_, _| Ok(())).is_err());
        }
    }

    /// Xcode puts a chunk of its own before the header.
    #[test]
    fn pictures_packed_for_iphones_are_named() {
        let mut bytes = b"\x89PNG\r\n\x1a\n\0\0\0\x04CgBI\x50\0\x20\x06\x2b\xd5\xb3\x7f".to_vec();
        bytes.extend(b"\0\0\0\x0dIHDR\0\0\0\x01\0\0\0\x01\x08\x06\0\0\0\x1f\x15\xc4\x89");
        let said = decode(&bytes, &Limits::default()).unwrap_err().to_string();
        assert!(said.contains("iPhones (CgBI)") && !said.contains('{'), "{said}");
    }
}
