//! Writing pictures: the format follows from the file's extension.

use crate::block::{self, BlockFormat};
use crate::encoding::{quantize8, quantize16};
use crate::tone::Tone;
use crate::{Error, FileKind, Image, Result, WriteOptions, atomic::io, png_file, pnm};
use rayon::prelude::*;
use std::io::Write;
use std::path::Path;

/// Writes a picture of linear Rec.709 values; the extension chooses the format
/// (`.exr .png .jpg .jpeg .hdr .pfm .ppm .dds .ktx2`). EXR keeps all channels and metadata; PNG keeps colour, alpha and
/// metadata; the others keep the colour. The file appears whole or not at all.
///
/// # Errors
/// [`Error::UnknownExtension`]; [`Error::MissingChannels`] when there is no colour; [`Error::Unsupported`] when the
/// format cannot hold the picture; [`Error::Io`]. All inside [`Error::File`] with the path.
pub fn write(path: &Path, image: &Image, options: &WriteOptions) -> Result<()> {
    let kind = FileKind::from_extension(path).ok_or_else(|| Error::UnknownExtension.at(path))?;
    crate::atomic::place(path, |out| encode_to(kind, image, options, out))
}

/// The bytes of the file that [`write()`] would write. The same picture and options give the same bytes.
///
/// # Errors
/// As [`write()`], without the path.
pub fn encode(kind: FileKind, image: &Image, options: &WriteOptions) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    encode_to(kind, image, options, &mut bytes)?;
    Ok(bytes)
}

/// Display values of a picture after exposure and tone curve: R, G, B from 0 to 255 of each pixel, rows from the top.
///
/// # Errors
/// [`Error::MissingChannels`] where it has no colours, and what a tone curve refuses.
pub fn display8(image: &Image, options: &WriteOptions) -> Result<Vec<u8>> {
    let mut samples = Vec::with_capacity(3 * image.pixel_count());
    display(image, options, false, |band| {
        samples.extend(band.as_flattened().iter().map(|&v| quantize8(v)));
        Ok(())
    })?;
    Ok(samples)
}

/// Writes the bytes of a file, some rows at a time: beside the picture there are at most 12 bytes for each of its
/// pixels.
fn encode_to(kind: FileKind, image: &Image, options: &WriteOptions, out: &mut dyn Write) -> Result<()> {
    let (width, height) = (image.width(), image.height());
    if width == 0 || height == 0 {
        return Err(Error::unsupported(kind, format!("an empty picture ({width}x{height})")));
    }
    match kind {
        FileKind::Exr => out.write_all(&crate::exr_file::encode(image, options)?).map_err(io("write")),
        FileKind::Hdr => {
            let planes = image.require_rgb()?;
            crate::hdr::encode(width, height, |i| planes.at(i), out).map_err(io("write"))
        }
        FileKind::Pfm => match image.channels() {
            [grey] => crate::pfm::encode(width, height, |i| [grey.data[i]], out).map_err(io("write")),
            _ => {
                let planes = image.require_rgb()?;
                crate::pfm::encode(width, height, |i| planes.at(i), out).map_err(io("write"))
            }
        },
        FileKind::Png => encode_png(image, options, out),
        FileKind::Jpeg => {
            let [w, h] = side_lengths(kind, image, 65535)?;
            let samples = display8(image, options)?;
            crate::photo::encode_jpeg(w, h, 3, &samples, options.jpeg_quality, out)
        }
        FileKind::Pnm => {
            let layout =
                pnm::Layout { plain: options.ppm_plain, maximum: if options.sixteen_bit { 65535 } else { 255 } };
            if options.ppm_radiance {
                let planes = image.require_rgb()?;
                return pnm::encode_radiance(width, height, |i| planes.at(i), layout, out).map_err(io("write"));
            }
            let code = |v: f32| if options.sixteen_bit { quantize16(v) } else { quantize8(v).into() };
            pnm::begin(width, height, "", layout, out).map_err(io("write"))?;
            display(image, options, false, |band| {
                pnm::pixels(band.iter().map(|p| p.map(code)), layout, out).map_err(io("write"))
            })
        }
        FileKind::Dds | FileKind::Ktx2 => {
            let [w, h] = side_lengths(kind, image, 16384)?;
            let blocks = if options.block == BlockFormat::Bc6h {
                let planes = image.require_rgb()?;
                block::encode_linear(width, height, |i| planes.at(i))
            } else {
                block::encode(options.block, &block_samples(image, options)?, width, height)
                    .ok_or_else(|| Error::unsupported(kind, format!("writing {:?}", options.block)))?
            };
            let file = if kind == FileKind::Dds { crate::dds::encode } else { crate::ktx2::encode };
            out.write_all(&file(w, h, options.block, &blocks)).map_err(io("write"))
        }
        FileKind::Tga | FileKind::Bmp | FileKind::WebP => Err(Error::unsupported(kind, "writing")),
    }
}

/// Pixels that are mapped at a time.
const BAND: usize = 1 << 18;

/// Maps a picture's colours to display values and passes them on in order, some whole rows at a time; divided by alpha
/// where the format keeps it straight.
fn display(
    image: &Image,
    options: &WriteOptions,
    keeps_alpha: bool,
    mut pass: impl FnMut(&[[f32; 3]]) -> Result<()>,
) -> Result<()> {
    let planes = image.require_rgb()?;
    let map = options.tone.mapper(Tone::maximum(planes));
    let alpha = image.channel("A").filter(|_| options.premultiplied && keeps_alpha);
    let straight = |i: usize| match alpha.map(|a| a[i]) {
        Some(a) if a > 0.0 => planes.at(i).map(|v| v / a),
        _ => planes.at(i),
    };
    let band = BAND.next_multiple_of(image.width());
    for start in (0..image.pixel_count()).step_by(band) {
        let end = (start + band).min(image.pixel_count());
        let values: Vec<[f32; 3]> = (start..end).into_par_iter().map(|i| map(straight(i))).collect();
        pass(&values)?;
    }
    Ok(())
}

/// Colour and, where the picture has a channel `A`, alpha.
fn encode_png(image: &Image, options: &WriteOptions, out: &mut dyn Write) -> Result<()> {
    let [w, h] = side_lengths(FileKind::Png, image, i32::MAX as u32)?;
    let alpha = image.channel("A");
    let form = png_file::Form { width: w, height: h, has_alpha: alpha.is_some(), is_sixteen: options.sixteen_bit };
    let mut done = 0;
    png_file::encode(&form, &image.metadata, out, |rows| {
        display(image, options, true, |band| {
            let mut bytes = Vec::with_capacity(band.len() * form.pixel_bytes());
            for pixel in band {
                for &v in pixel.iter().chain(alpha.map(|a| &a[done])) {
                    match options.sixteen_bit {
                        true => bytes.extend(quantize16(v).to_be_bytes()),
                        false => bytes.push(quantize8(v)),
                    }
                }
                done += 1;
            }
            rows.write_all(&bytes).map_err(io("write"))
        })
    })
}

/// RGBA codes for blocks: display values where the format has colours, linear values where it has one or two channels
/// of numbers.
fn block_samples(image: &Image, options: &WriteOptions) -> Result<Vec<u8>> {
    let alpha = image.channel("A");
    let mut codes = Vec::with_capacity(4 * image.pixel_count());
    let mut add = |pixel: [f32; 3]| {
        let a = alpha.map_or(255, |a| quantize8(a[codes.len() / 4]));
        let [r, g, b] = pixel.map(quantize8);
        codes.extend([r, g, b, a]);
    };
    if options.block.is_colour() {
        display(image, options, true, |band| {
            band.iter().copied().for_each(&mut add);
            Ok(())
        })?;
    } else {
        let planes = image.require_rgb()?;
        (0..image.pixel_count()).for_each(|i| add(planes.at(i)));
    }
    Ok(codes)
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
