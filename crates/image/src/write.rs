//! Writing pictures: the format follows from the file's extension.

use crate::block::{self, BlockFormat};
use crate::encoding::{quantize8, quantize16};
use crate::tone::Tone;
use crate::{Error, FileKind, Image, Result, png_file, pnm};
use std::path::Path;

/// Sample type of EXR files.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Precision {
    /// 16-bit floats; finite values beyond ±65504 are clamped to it. Depth, position, id, count and variance layers stay 32 bit.
    Half,
    /// 32-bit floats.
    #[default]
    Float,
}

/// Compression of EXR files; all are lossless.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Compression {
    /// Stored as is.
    None,
    /// Deflate over blocks of 16 rows.
    #[default]
    Zip,
    /// Wavelets and Huffman coding; smaller for noisy pictures.
    Piz,
}

/// How [`write()`] stores a picture. Each format uses what concerns it.
#[derive(Clone, Debug, PartialEq)]
pub struct WriteOptions {
    /// EXR: sample type.
    pub exr_precision: Precision,
    /// EXR: compression.
    pub exr_compression: Compression,
    /// PNG and PPM: 16 bits per sample instead of 8.
    pub sixteen_bit: bool,
    /// JPEG: quality, 1 to 100.
    pub jpeg_quality: u8,
    /// PPM: `P3` (text) instead of `P6` (bytes).
    pub ppm_plain: bool,
    /// PPM: linear values scaled by the picture's maximum, with a `#MAX=` comment, instead of tone-mapped display values.
    pub ppm_radiance: bool,
    /// DDS and KTX2: how blocks are compressed; BC1, BC3, BC4, BC5 or BC7.
    pub block: BlockFormat,
    /// PNG, JPEG, PPM, and colours of DDS and KTX2: from linear radiance to display values.
    pub tone: Tone,
}

impl Default for WriteOptions {
    /// EXR float with zip, PNG with 8 bits, JPEG quality 90, PPM `P6` with linear values and `#MAX=`, BC7 blocks, plain
    /// sRGB encoding.
    fn default() -> Self {
        Self {
            exr_precision: Precision::Float,
            exr_compression: Compression::Zip,
            sixteen_bit: false,
            jpeg_quality: 90,
            ppm_plain: false,
            ppm_radiance: true,
            block: BlockFormat::Bc7,
            tone: Tone::default(),
        }
    }
}

/// Writes a picture of linear Rec.709 values; the extension chooses the format (`.exr .png .jpg .jpeg .hdr .pfm .ppm .dds .ktx2`). EXR keeps
/// all channels and metadata; PNG keeps colour, alpha and metadata; the others keep the colour. The file appears whole or not at all.
///
/// # Errors
/// [`Error::UnknownExtension`]; [`Error::MissingChannels`] when there is no colour; [`Error::Unsupported`] when the format cannot
/// hold the picture; [`Error::Io`]. All inside [`Error::File`] with the path.
pub fn write(path: &Path, image: &Image, options: &WriteOptions) -> Result<()> {
    let bytes = FileKind::from_extension(path)
        .ok_or(Error::UnknownExtension)
        .and_then(|kind| encode(kind, image, options))
        .map_err(|e| e.at(path))?;
    crate::write_whole(path, &bytes)
}

/// The bytes of the file that [`write()`] would write. The same picture and options give the same bytes.
///
/// # Errors
/// As [`write()`], without the path.
pub fn encode(kind: FileKind, image: &Image, options: &WriteOptions) -> Result<Vec<u8>> {
    let (width, height) = (image.width(), image.height());
    if width == 0 || height == 0 {
        return Err(Error::unsupported(kind, format!("an empty picture ({width}x{height})")));
    }
    match kind {
        FileKind::Exr => crate::exr_file::encode(image, options),
        FileKind::Hdr => {
            let planes = image.require_rgb()?;
            Ok(crate::hdr::encode(width, height, (0..image.pixel_count()).map(|i| planes.at(i))))
        }
        FileKind::Pfm => match image.channels() {
            [grey] => Ok(crate::pfm::encode(width, height, 1, &grey.data)),
            _ => Ok(crate::pfm::encode(width, height, 3, image.to_rgb()?.as_flattened())),
        },
        FileKind::Png => encode_png(image, options),
        FileKind::Jpeg => {
            let display = options.tone.map_image(image)?;
            let samples: Vec<u8> = display.as_flattened().iter().map(|&v| quantize8(v)).collect();
            let [w, h] = side_lengths(kind, image, 65535)?;
            crate::photo::encode_jpeg(w, h, 3, &samples, options.jpeg_quality)
        }
        FileKind::Pnm => {
            let layout =
                pnm::Layout { plain: options.ppm_plain, maximum: if options.sixteen_bit { 65535 } else { 255 } };
            if options.ppm_radiance {
                return Ok(pnm::encode_radiance(width, height, &image.to_rgb()?, layout));
            }
            let display = options.tone.map_image(image)?;
            let code = |v: f32| if options.sixteen_bit { quantize16(v) } else { quantize8(v).into() };
            Ok(pnm::encode_display(width, height, display.iter().map(|p| p.map(code)), layout))
        }
        FileKind::Dds | FileKind::Ktx2 => {
            let [w, h] = side_lengths(kind, image, 16384)?;
            let codes = block_samples(image, options)?;
            let blocks = block::encode(options.block, &codes, width, height)
                .ok_or_else(|| Error::unsupported(kind, format!("writing {:?}", options.block)))?;
            let file = if kind == FileKind::Dds { crate::dds::encode } else { crate::ktx2::encode };
            Ok(file(w, h, options.block, &blocks))
        }
        FileKind::Tga | FileKind::Bmp => Err(Error::unsupported(kind, "writing")),
    }
}

/// Colour and, where the picture has a channel `A`, alpha (stored as it is, not divided out).
fn encode_png(image: &Image, options: &WriteOptions) -> Result<Vec<u8>> {
    let display = options.tone.map_image(image)?;
    let [w, h] = side_lengths(FileKind::Png, image, i32::MAX as u32)?;
    let alpha = image.channel("A");
    let lanes = if alpha.is_some() { 4 } else { 3 };
    let mut samples = Vec::with_capacity(display.len() * lanes);
    for (i, pixel) in display.iter().enumerate() {
        samples.extend_from_slice(pixel);
        samples.extend(alpha.map(|a| a[i]));
    }
    if options.sixteen_bit {
        let codes: Vec<u16> = samples.iter().map(|&v| quantize16(v)).collect();
        png_file::encode(w, h, lanes, &png_file::Samples::Sixteen(&codes), &image.metadata)
    } else {
        let codes: Vec<u8> = samples.iter().map(|&v| quantize8(v)).collect();
        png_file::encode(w, h, lanes, &png_file::Samples::Eight(&codes), &image.metadata)
    }
}

/// RGBA codes for blocks: display values where the format has colours, linear values where it has one or two channels of numbers.
fn block_samples(image: &Image, options: &WriteOptions) -> Result<Vec<u8>> {
    let pixels = if options.block.is_colour() { options.tone.map_image(image)? } else { image.to_rgb()? };
    let alpha = image.channel("A");
    let texel = |(i, p): (usize, &[f32; 3])| {
        let [r, g, b] = p.map(quantize8);
        [r, g, b, alpha.map_or(255, |a| quantize8(a[i]))]
    };
    Ok(pixels.iter().enumerate().flat_map(texel).collect())
}

fn side_lengths(kind: FileKind, image: &Image, most: u32) -> Result<[u32; 2]> {
    let side = |n: usize| {
        u32::try_from(n)
            .ok()
            .filter(|&n| n <= most)
            .ok_or_else(|| Error::unsupported(kind, format!("sides above {most} pixels")))
    };
    Ok([side(image.width())?, side(image.height())?])
}
