//! PFM (P. Debevec's portable float map): `PF` or `Pf`, width and height, a scale whose sign tells the byte order
//! (negative: little endian), then rows of floats from the bottom up. The scale's magnitude is applied when it is not
//! 1, as in pbrt-v4.

use crate::limits::with_room;
use crate::pnm::Words;
use crate::{Encoding, Error, FileKind, Limits, Result, TexelData, Texels};
use std::io::Write;

const KIND: FileKind = FileKind::Pfm;

pub(crate) fn decode(bytes: &[u8], limits: &Limits) -> Result<Texels> {
    let mut words = Words::new(bytes, KIND);
    let channels = match words.word()? {
        "PF" => 3,
        "Pf" => 1,
        other => return Err(Error::malformed(KIND, format!("magic `{other}`"))),
    };
    let (width, height): (u64, u64) = (words.number("width")?, words.number("height")?);
    let scale: f32 = words.number("scale")?;
    if !scale.is_finite() || scale == 0.0 {
        return Err(Error::malformed(KIND, format!("scale {scale}")));
    }
    let bytes_per_pixel = 4 * channels as u64;
    let pixels = limits.check(KIND, width, height, bytes_per_pixel)?;
    let needed = pixels * bytes_per_pixel as usize;
    let mut data = words.rest();
    // Headers with DOS line ends.
    if data.len() > needed && data.starts_with(b"\n") {
        data = &data[1..];
    }
    let Some(data) = data.get(..needed) else {
        return Err(Error::TooShort { kind: KIND, width, height, bytes: data.len() as u64 });
    };
    let (width, height) = (width as usize, height as usize);
    let parse = if scale < 0.0 { f32::from_le_bytes } else { f32::from_be_bytes };
    let factor = scale.abs();
    let mut samples = with_room(pixels * channels)?;
    for row in data.rchunks_exact(4 * channels * width) {
        samples
            .extend(row.as_chunks::<4>().0.iter().map(|b| if factor == 1.0 { parse(*b) } else { parse(*b) * factor }));
    }
    Ok(Texels::new(width, height, channels, TexelData::F32(samples), Encoding::Linear))
}

/// Writes the bytes of a little-endian PFM file of one or three channels; `at` gives pixels by index, rows from the
/// top.
pub(crate) fn encode<const N: usize>(
    width: usize,
    height: usize,
    at: impl Fn(usize) -> [f32; N],
    out: &mut dyn Write,
) -> std::io::Result<()> {
    let magic = if N == 1 { "Pf" } else { "PF" };
    write!(out, "{magic}\n{width} {height}\n-1.0\n")?;
    for y in (0..height).rev() {
        let row: Vec<u8> = (y * width..(y + 1) * width).flat_map(&at).flat_map(f32::to_le_bytes).collect();
        out.write_all(&row)?;
    }
    Ok(())
}
