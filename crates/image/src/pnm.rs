//! PGM and PPM: `P2` `P3` as text, `P5` `P6` as bytes, up to 16 bits (big endian), with comments.
//!
//! A comment `#MAX=<real>` in the header makes the file hold linear radiance: a sample stands for
//! `code · MAX / maximum`, where the maximum is the number after the size. Without it samples are display values, taken
//! as sRGB encoded.

use crate::{Encoding, Error, FileKind, Limits, Result, TexelData, Texels, Value};
use std::io::{self, Write};

const KIND: FileKind = FileKind::Pnm;

pub(crate) fn decode(bytes: &[u8], limits: &Limits) -> Result<Texels> {
    let mut words = Words::new(bytes, KIND);
    let (channels, plain) = match words.word()? {
        "P2" => (1, true),
        "P3" => (3, true),
        "P5" => (1, false),
        "P6" => (3, false),
        other @ ("P1" | "P4" | "P7") => return Err(Error::unsupported(KIND, format!("`{other}` bitmaps"))),
        other => return Err(Error::malformed(KIND, format!("magic `{other}`"))),
    };
    let (width, height): (u64, u64) = (words.number("width")?, words.number("height")?);
    let maximum: u32 = words.number("maximum")?;
    if maximum == 0 || (!plain && maximum > 65535) {
        return Err(Error::malformed(KIND, format!("maximum {maximum} (1 to 65535)")));
    }
    let radiance = words.radiance_maximum()?;
    let wide = maximum > 255;
    let sample_bytes = if radiance.is_some() || maximum > 65535 { 4 } else { 1 + usize::from(wide) };
    let pixels = limits.check(KIND, width, height, (sample_bytes * channels) as u64)?;
    let samples = pixels * channels;
    // Every sample takes a digit and a separator as text, or one or two bytes.
    let needed = if plain { 2 * samples - 1 } else { samples * (1 + usize::from(wide)) };
    if words.rest().len() < needed {
        return Err(Error::TooShort { kind: KIND, width, height, bytes: words.rest().len() as u64 });
    }

    let codes: Vec<u32> = if plain {
        (0..samples).map(|_| words.number("sample")).collect::<Result<_>>()?
    } else if wide {
        words.rest()[..needed].as_chunks::<2>().0.iter().map(|b| u16::from_be_bytes(*b).into()).collect()
    } else {
        words.rest()[..needed].iter().map(|&b| b.into()).collect()
    };
    if let Some(code) = codes.iter().find(|&&code| code > maximum) {
        return Err(Error::malformed(KIND, format!("sample {code} above the maximum {maximum}")));
    }
    let scaled = |code: u32, full: f64| (f64::from(code) * full / f64::from(maximum)).round();
    let (data, encoding) = match radiance {
        Some(max) => {
            let values = codes.iter().map(|&code| (f64::from(code) * max / f64::from(maximum)) as f32);
            (TexelData::F32(values.collect()), Encoding::Linear)
        }
        None if wide => (TexelData::U16(codes.iter().map(|&c| scaled(c, 65535.0) as u16).collect()), Encoding::Srgb),
        None => (TexelData::U8(codes.iter().map(|&c| scaled(c, 255.0) as u8).collect()), Encoding::Srgb),
    };
    let mut texels = Texels::new(width as usize, height as usize, channels, data, encoding);
    if let Some(max) = radiance {
        texels.metadata.set("MAX", Value::Float(max as f32));
    }
    Ok(texels)
}

/// Whitespace-separated words of a text header, without comments.
pub(crate) struct Words<'a> {
    bytes: &'a [u8],
    at: usize,
    kind: FileKind,
}

impl<'a> Words<'a> {
    pub(crate) fn new(bytes: &'a [u8], kind: FileKind) -> Self {
        Self { bytes, at: 0, kind }
    }

    /// The next word. Stops right behind it; [`Words::rest`] is what follows the one white space after it.
    pub(crate) fn word(&mut self) -> Result<&'a str> {
        loop {
            match self.bytes.get(self.at) {
                Some(b'#') => {
                    let line = self.bytes[self.at..].iter().position(|&b| b == b'\n' || b == b'\r');
                    self.at = line.map_or(self.bytes.len(), |n| self.at + n);
                }
                Some(b) if b.is_ascii_whitespace() => self.at += 1,
                Some(_) => break,
                None => return Err(Error::malformed(self.kind, "the file ends early")),
            }
        }
        let rest = &self.bytes[self.at..];
        let length = rest.iter().take(64).take_while(|b| !b.is_ascii_whitespace() && **b != b'#').count();
        self.at += length;
        std::str::from_utf8(&rest[..length]).map_err(|_| Error::malformed(self.kind, "the header is not text"))
    }

    pub(crate) fn number<T: std::str::FromStr>(&mut self, what: &str) -> Result<T> {
        let word = self.word()?;
        word.parse().map_err(|_| Error::malformed(self.kind, format!("{what} `{word}` is not a number in range")))
    }

    /// Bytes after the single white space that follows the last word.
    pub(crate) fn rest(&self) -> &'a [u8] {
        self.bytes.get(self.at + 1..).unwrap_or_default()
    }

    /// The value of a `#MAX=` comment in the header read so far.
    fn radiance_maximum(&self) -> Result<Option<f64>> {
        let header = String::from_utf8_lossy(&self.bytes[..self.at]);
        let Some(text) = header.lines().find_map(|line| line.trim_start().strip_prefix("#MAX=")) else {
            return Ok(None);
        };
        let max: Option<f64> = text.trim().parse().ok();
        match max.filter(|m| m.is_finite() && *m >= 0.0) {
            Some(max) => Ok(Some(max)),
            None => Err(Error::malformed(KIND, format!("`#MAX={}` is not a number", text.trim()))),
        }
    }
}

/// Layout of a PPM file that is written.
#[derive(Clone, Copy)]
pub(crate) struct Layout {
    /// `P3` instead of `P6`.
    pub plain: bool,
    /// The largest code, 255 or 65535.
    pub maximum: u16,
}

/// Writes a PPM file of linear values with a `#MAX=` comment: the largest value of the picture (1 for a black one).
/// Negative values and NaN become 0. `at` gives pixels by index.
pub(crate) fn encode_radiance(
    width: usize,
    height: usize,
    at: impl Fn(usize) -> [f32; 3],
    layout: Layout,
    out: &mut dyn Write,
) -> io::Result<()> {
    let finite = (0..width * height).flat_map(&at).filter(|v| v.is_finite());
    let max = finite.fold(0.0f32, f32::max);
    let max = if max > 0.0 { max } else { 1.0 };
    let scale = f64::from(layout.maximum) / f64::from(max);
    let code = |v: f32| (f64::from(v) * scale).round().clamp(0.0, f64::from(layout.maximum)) as u16;
    begin(width, height, &format!("#MAX={max}\n"), layout, out)?;
    (0..height).try_for_each(|y| pixels((y * width..(y + 1) * width).map(|i| at(i).map(code)), layout, out))
}

/// Writes the header of a PPM file.
pub(crate) fn begin(width: usize, height: usize, comment: &str, layout: Layout, out: &mut dyn Write) -> io::Result<()> {
    let magic = if layout.plain { "P3" } else { "P6" };
    write!(out, "{magic}\n{comment}{width} {height}\n{}\n", layout.maximum)
}

/// Writes the pixels that come next.
pub(crate) fn pixels(pixels: impl Iterator<Item = [u16; 3]>, layout: Layout, out: &mut dyn Write) -> io::Result<()> {
    let mut bytes = Vec::new();
    for [r, g, b] in pixels {
        if layout.plain {
            bytes.extend_from_slice(format!("{r} {g} {b}\n").as_bytes());
        } else if layout.maximum > 255 {
            bytes.extend([r, g, b].iter().flat_map(|v| v.to_be_bytes()));
        } else {
            bytes.extend([r, g, b].map(|v| v as u8));
        }
    }
    out.write_all(&bytes)
}
