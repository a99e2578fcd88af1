//! Radiance HDR (`.hdr`, `.pic`): text header, resolution line, then RGBE pixels, flat or in one of two run-length
//! codings.
//!
//! Source: G. Ward, "Real Pixels", Graphics Gems II (1991), and the file format chapter of the Radiance documentation.
//! A pixel is `mantissa · 2^(e − 136)`, zero when e = 0; the half that Radiance adds to a mantissa is left out, as in
//! pbrt-v4 and Mitsuba 3. `EXPOSURE` lines are reported as metadata and not applied, as there. `32-bit_rle_xyze` pixels
//! are turned into Rec.709.

use crate::limits::{check_metadata, zeros};
use crate::{Encoding, Error, FileKind, Limits, Metadata, Result, TexelData, Texels, Value};
use std::io::Write;

const KIND: FileKind = FileKind::Hdr;

/// In the new coding four runs of 127 values are eight bytes. In the old one a scan line has a pixel of four bytes at
/// least.
const MAX_PIXELS_PER_BYTE: f64 = 127.0 / 8.0;

/// CIE XYZ to linear Rec.709 (IEC 61966-2-1), scaled so that equal-energy white stays as Radiance's own conversion has
/// it.
const REC709_FROM_XYZ: [[f32; 3]; 3] =
    [[3.240_97, -1.537_383, -0.498_611], [-0.969_244, 1.875_968, 0.041_555], [0.055_63, -0.203_977, 1.056_972]];

pub(crate) fn decode(bytes: &[u8], limits: &Limits) -> Result<Texels> {
    let mut lines = Lines { bytes, at: 0 };
    let first = lines.next()?;
    if !first.starts_with("#?") {
        return Err(Error::malformed(KIND, "the first line is not `#?RADIANCE` or `#?RGBE`"));
    }
    let (metadata, xyz) = header(&mut lines)?;
    let resolution = Resolution::parse(&lines.next()?)?;
    let data = &bytes[lines.at..];
    let (rows, row) = (resolution.rows, resolution.row);
    let density = if starts_new_style(data, row) { MAX_PIXELS_PER_BYTE } else { row as f64 / 4.0 };
    let pixels = limits.check_against(KIND, (row as u64, rows as u64), 12, data.len(), density)?;

    let mut stored = Stored { bytes: data, at: 0 };
    let mut scanline = vec![[0u8; 4]; row];
    let mut colours: Vec<f32> = zeros(pixels * 3)?;
    for j in 0..rows {
        stored.scanline(&mut scanline)?;
        for (i, &pixel) in scanline.iter().enumerate() {
            let rgb = if xyz { rec709(rgbe_decode(pixel)) } else { rgbe_decode(pixel) };
            let at = 3 * resolution.index(i, j);
            colours[at..at + 3].copy_from_slice(&rgb);
        }
    }
    let (width, height) = resolution.size();
    let mut texels = Texels::new(width, height, 3, TexelData::F32(colours), Encoding::Linear);
    texels.metadata = metadata;
    Ok(texels)
}

/// Reads variables up to the empty line; tells whether pixels are XYZE.
fn header(lines: &mut Lines<'_>) -> Result<(Metadata, bool)> {
    let (mut metadata, mut xyz) = (Metadata::default(), false);
    loop {
        let line = lines.next()?;
        check_metadata(metadata.entries.len())?;
        if line.is_empty() {
            return Ok((metadata, xyz));
        }
        let Some((name, value)) = line.split_once('=').filter(|_| !line.starts_with('#')) else { continue };
        match (name, value.trim()) {
            ("FORMAT", "32-bit_rle_rgbe") => xyz = false,
            ("FORMAT", "32-bit_rle_xyze") => xyz = true,
            ("FORMAT", other) => return Err(Error::unsupported(KIND, format!("pixel format `{other}`"))),
            (name, value) => metadata.set(name, value.parse().map_or_else(|_| Value::Text(value.into()), Value::Float)),
        }
    }
}

/// The resolution line: which axis the scan lines follow, and in which directions.
struct Resolution {
    rows: usize,
    row: usize,
    /// Scan lines are columns (`±X … ±Y …`).
    columns_first: bool,
    flip_x: bool,
    flip_y: bool,
}

impl Resolution {
    fn parse(line: &str) -> Result<Self> {
        let bad = || Error::malformed(KIND, format!("resolution line `{}`", line.chars().take(60).collect::<String>()));
        let words: Vec<&str> = line.split_ascii_whitespace().collect();
        let &[major, rows, minor, row] = &words[..] else { return Err(bad()) };
        let number = |s: &str| s.parse::<u32>().map(|n| n as usize).map_err(|_| bad());
        let (rows, row) = (number(rows)?, number(row)?);
        let columns_first = match (major, minor) {
            ("-Y" | "+Y", "-X" | "+X") => false,
            ("-X" | "+X", "-Y" | "+Y") => true,
            _ => return Err(bad()),
        };
        // The origin is bottom left; row 0 of a picture in memory is the top one.
        let has = |axis| major == axis || minor == axis;
        Ok(Self { rows, row, columns_first, flip_x: has("-X"), flip_y: has("+Y") })
    }

    fn size(&self) -> (usize, usize) {
        if self.columns_first { (self.rows, self.row) } else { (self.row, self.rows) }
    }

    /// Index in the picture of sample `i` of scan line `j`.
    fn index(&self, i: usize, j: usize) -> usize {
        let (width, height) = self.size();
        let (x, y) = if self.columns_first { (j, i) } else { (i, j) };
        let x = if self.flip_x { width - 1 - x } else { x };
        let y = if self.flip_y { height - 1 - y } else { y };
        y * width + x
    }
}

/// The stored pixels.
struct Stored<'a> {
    bytes: &'a [u8],
    at: usize,
}

/// True if the data begin as a scan line in the new coding does.
fn starts_new_style(data: &[u8], row: usize) -> bool {
    (8..=0x7fff).contains(&row)
        && matches!(data, [2, 2, high, low, ..] if usize::from(u16::from_be_bytes([*high, *low])) == row)
}

impl Stored<'_> {
    fn take<const N: usize>(&mut self) -> Result<[u8; N]> {
        let chunk = self.bytes.get(self.at..).and_then(|rest| rest.first_chunk::<N>());
        self.at += N;
        chunk.copied().ok_or_else(|| Error::malformed(KIND, "the pixels end early"))
    }

    fn scanline(&mut self, out: &mut [[u8; 4]]) -> Result<()> {
        if starts_new_style(self.bytes.get(self.at..).unwrap_or_default(), out.len()) {
            self.at += 4;
            self.separate_runs(out)
        } else {
            self.pixel_runs(out)
        }
    }

    /// New coding: the four components one after another, each in runs; a count above 128 repeats one byte count − 128
    /// times.
    fn separate_runs(&mut self, out: &mut [[u8; 4]]) -> Result<()> {
        for component in 0..4 {
            let mut x = 0;
            while x < out.len() {
                let [count] = self.take()?;
                let (length, repeated) =
                    if count > 128 { (usize::from(count - 128), true) } else { (usize::from(count), false) };
                if length == 0 || length > out.len() - x {
                    return Err(Error::malformed(KIND, "a run does not fit its scan line"));
                }
                if repeated {
                    let [value] = self.take()?;
                    out[x..x + length].iter_mut().for_each(|pixel| pixel[component] = value);
                } else {
                    for pixel in &mut out[x..x + length] {
                        [pixel[component]] = self.take()?;
                    }
                }
                x += length;
            }
        }
        Ok(())
    }

    /// Flat pixels and the old coding: a pixel (1, 1, 1, n) repeats the one before it n times; further ones count in
    /// base 256.
    fn pixel_runs(&mut self, out: &mut [[u8; 4]]) -> Result<()> {
        let (mut x, mut shift) = (0, 0u32);
        while x < out.len() {
            let pixel = self.take()?;
            if let [1, 1, 1, count] = pixel {
                let length = usize::from(count).checked_shl(shift).filter(|_| shift <= 16).unwrap_or(usize::MAX);
                if x == 0 || length > out.len() - x {
                    return Err(Error::malformed(KIND, "a run does not fit its scan line"));
                }
                let previous = out[x - 1];
                out[x..x + length].fill(previous);
                x += length;
                shift += 8;
            } else {
                out[x] = pixel;
                x += 1;
                shift = 0;
            }
        }
        Ok(())
    }
}

fn rgbe_decode([r, g, b, e]: [u8; 4]) -> [f32; 3] {
    if e == 0 {
        return [0.0; 3];
    }
    // 2^(e − 136), written as the bits of a double: 1023 is the bias of its exponent.
    let scale = f64::from_bits((u64::from(e) + 1023 - 136) << 52);
    [r, g, b].map(|m| (f64::from(m) * scale) as f32)
}

/// The RGBE pixel nearest to a colour. Negative values and NaN become 0, values beyond the format's range its largest.
pub(crate) fn rgbe_encode(rgb: [f32; 3]) -> [u8; 4] {
    let most = 255.0 * 119f64.exp2();
    let rgb = rgb.map(|v| if v > 0.0 { f64::from(v).min(most) } else { 0.0 });
    let largest = rgb[0].max(rgb[1]).max(rgb[2]);
    if largest < 1e-38 {
        return [0; 4];
    }
    // largest · 2^(136 − e) must round to at most 255.
    let mut exponent = largest.log2().floor() as i32 + 129;
    if (largest * f64::from(136 - exponent).exp2()).round() > 255.0 {
        exponent += 1;
    }
    let scale = f64::from(136 - exponent).exp2();
    let mantissa = |v: f64| (v * scale).round().clamp(0.0, 255.0) as u8;
    [mantissa(rgb[0]), mantissa(rgb[1]), mantissa(rgb[2]), exponent.clamp(1, 255) as u8]
}

fn rec709(xyz: [f32; 3]) -> [f32; 3] {
    REC709_FROM_XYZ.map(|row| row[0] * xyz[0] + row[1] * xyz[1] + row[2] * xyz[2])
}

/// The lines of the header.
struct Lines<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl Lines<'_> {
    fn next(&mut self) -> Result<String> {
        let rest = self.bytes.get(self.at..).unwrap_or_default();
        let length = rest.iter().take(1 << 16).position(|&b| b == b'\n');
        let length = length.ok_or_else(|| Error::malformed(KIND, "the header does not end"))?;
        self.at += length + 1;
        Ok(String::from_utf8_lossy(&rest[..length]).trim_end_matches('\r').to_owned())
    }
}

/// Writes the bytes of an HDR file, in the new run-length coding where the width allows it; `at` gives pixels by index.
pub(crate) fn encode(
    width: usize,
    height: usize,
    at: impl Fn(usize) -> [f32; 3],
    out: &mut dyn Write,
) -> std::io::Result<()> {
    write!(out, "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n")?;
    let mut bytes = Vec::new();
    for y in 0..height {
        let line: Vec<[u8; 4]> = (y * width..(y + 1) * width).map(|i| rgbe_encode(at(i))).collect();
        if !(8..=0x7fff).contains(&width) {
            out.write_all(line.as_flattened())?;
            continue;
        }
        bytes.clear();
        bytes.extend_from_slice(&[2, 2, (width >> 8) as u8, width as u8]);
        for component in 0..4 {
            let plane: Vec<u8> = line.iter().map(|pixel| pixel[component]).collect();
            encode_runs(&plane, &mut bytes);
        }
        out.write_all(&bytes)?;
    }
    Ok(())
}

/// Runs of at least four equal bytes as (128 + length, byte), the rest as (length, bytes …).
fn encode_runs(plane: &[u8], out: &mut Vec<u8>) {
    let run_at = |at: usize| plane[at..].iter().take(127).take_while(|&&b| b == plane[at]).count();
    let mut at = 0;
    while at < plane.len() {
        let run = run_at(at);
        if run >= 4 {
            out.extend_from_slice(&[128 + run as u8, plane[at]]);
            at += run;
            continue;
        }
        let start = at;
        while at < plane.len() && at - start < 128 && run_at(at) < 4 {
            at += 1;
        }
        out.push((at - start) as u8);
        out.extend_from_slice(&plane[start..at]);
    }
}
