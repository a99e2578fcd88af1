//! Reads an EXR header just far enough to know what the pixels would cost, and refuses what cannot be decoded.
//!
//! Layout (OpenEXR file layout document): magic, version and flags; then per part a list of attributes (name, type,
//! size, value) that ends with an empty name; in a multi-part file an empty header ends the list of parts. The decoder
//! behind this check allocates what a header declares, so that every count is compared here with the limits and with
//! the length of the file.

use crate::limits::{check_metadata, within};
use crate::{Error, FileKind, Limits, Result};
use std::borrow::Cow;

const KIND: FileKind = FileKind::Exr;
const FLAG_TILED: u32 = 0x200;
const FLAG_DEEP: u32 = 0x800;
const FLAG_MULTIPART: u32 = 0x1000;

/// Most decoded bytes that one stored byte can stand for (deflate: 1032; the others are below, short runs of constant
/// blocks aside).
const MAX_RATIO: u64 = 4096;

/// One attribute of a part, by its place in the file.
pub(super) struct Attribute<'a> {
    pub name: &'a [u8],
    pub value: &'a [u8],
    /// All bytes of the attribute, name included.
    pub span: std::ops::Range<usize>,
}

/// The attributes of every part, and where the headers end.
pub(super) fn attributes(bytes: &[u8]) -> Result<Vec<Vec<Attribute<'_>>>> {
    let mut cursor = Cursor { bytes, at: 4 };
    let multipart = cursor.u32()? & FLAG_MULTIPART != 0;
    let mut parts = Vec::new();
    loop {
        let mut part = Vec::new();
        loop {
            let start = cursor.at;
            let name = cursor.text()?;
            if name.is_empty() {
                break;
            }
            let _type_name = cursor.text()?;
            let size = cursor.u32()? as usize;
            let value = cursor.take(size)?;
            part.push(Attribute { name, value, span: start..cursor.at });
        }
        if part.is_empty() && multipart && !parts.is_empty() {
            return Ok(parts);
        }
        parts.push(part);
        if !multipart {
            return Ok(parts);
        }
    }
}

/// Checks everything that the header declares.
pub(super) fn check(bytes: &[u8], limits: &Limits) -> Result<()> {
    let version = Cursor { bytes, at: 4 }.u32()?;
    if version & 0xff != 2 {
        return Err(Error::unsupported(KIND, format!("file version {}", version & 0xff)));
    }
    if version & FLAG_DEEP != 0 {
        return Err(Error::unsupported(KIND, "deep data"));
    }
    let (mut pixels, mut decoded, mut channels, mut blocks) = (0u64, 0u64, 0u64, 0u64);
    for part in attributes(bytes)? {
        check_metadata(part.len())?;
        let cost = PartCost::of(&part, version)?;
        pixels = pixels.saturating_add(cost.pixels);
        decoded = decoded.saturating_add(cost.decoded_bytes);
        channels = channels.saturating_add(cost.channels);
        blocks = blocks.saturating_add(cost.blocks);
        let file = bytes.len() as u64;
        // Each block has an 8-byte entry in the offset table and a header of at least 8 bytes.
        let too_short = blocks.saturating_mul(16) > file || cost.stored_bytes > file.saturating_mul(cost.max_ratio);
        within("the number of pixels", pixels, limits.pixels)?;
        within("the decoded size in bytes", decoded, limits.bytes)?;
        within("the size of a block in bytes", cost.block_bytes, limits.bytes)?;
        within("the number of channels", channels, limits.channels)?;
        if too_short {
            return Err(Error::TooShort { kind: KIND, width: cost.width, height: cost.height, bytes: file });
        }
    }
    Ok(())
}

/// A file that was made acceptable to the decoder.
pub(super) struct Normalized<'a> {
    pub bytes: Cow<'a, [u8]>,
    /// Sampling steps in x and y, per part and channel.
    pub steps: Vec<Vec<[u32; 2]>>,
}

/// The file in the form that the decoder's own header check lets pass, and the true sampling steps per part and
/// channel: every channel is declared at full resolution, and a single part has no `type`, which would overrule the
/// flag that counts (files exist in which they contradict each other). The pixel data are as they were.
pub(super) fn normalized(bytes: &[u8]) -> Result<Normalized<'_>> {
    let mut patched = Cow::Borrowed(bytes);
    let mut steps = Vec::new();
    let multipart = Cursor { bytes, at: 4 }.u32()? & FLAG_MULTIPART != 0;
    for part in attributes(bytes)? {
        if let Some(kind) = part.iter().find(|a| a.name == b"type" && !multipart) {
            patched.to_mut()[kind.span.start..][..4].copy_from_slice(b"Type");
        }
        let Some(list) = part.iter().find(|a| a.name == b"channels") else { continue };
        let start = list.span.end - list.value.len();
        let channels = channel_list(list.value)?;
        for channel in channels.iter().filter(|c| c.step != [1, 1]) {
            let at = start + channel.step_at;
            patched.to_mut()[at..at + 8].copy_from_slice(&[1, 0, 0, 0, 1, 0, 0, 0]);
        }
        steps.push(channels.iter().map(|c| c.step).collect());
    }
    Ok(Normalized { bytes: patched, steps })
}

/// Cost of decoding a part.
struct PartCost {
    width: u64,
    height: u64,
    pixels: u64,
    channels: u64,
    /// Bytes of the full-resolution samples as stored, and as `f32`.
    stored_bytes: u64,
    decoded_bytes: u64,
    block_bytes: u64,
    blocks: u64,
    max_ratio: u64,
}

impl PartCost {
    fn of(part: &[Attribute<'_>], version: u32) -> Result<Self> {
        let find = |name: &str| part.iter().find(|a| a.name == name.as_bytes()).map(|a| a.value);
        let need =
            |name: &str| find(name).ok_or_else(|| Error::malformed(KIND, format!("attribute `{name}` is missing")));

        let kind = find("type").unwrap_or_default();
        if kind.starts_with(b"deep") {
            return Err(Error::unsupported(KIND, "deep data"));
        }
        let mut window = Cursor { bytes: need("dataWindow")?, at: 0 };
        let [x0, y0, x1, y1] = [window.i32()?, window.i32()?, window.i32()?, window.i32()?].map(i64::from);
        if x1 < x0 || y1 < y0 {
            return Err(Error::malformed(KIND, format!("the data window ({x0}, {y0}) to ({x1}, {y1}) is empty")));
        }
        let (width, height) = ((x1 - x0 + 1) as u64, (y1 - y0 + 1) as u64);
        let pixels = width.saturating_mul(height);

        let (rows_per_block, max_ratio) = compression(need("compression")?)?;
        let list = channel_list(need("channels")?)?;
        // Bytes of a pixel, in quarters and finer for subsampled channels: counted in f64, far from its limits.
        let pixel_bytes: f64 =
            list.iter().map(|c| c.bytes as f64 / (f64::from(c.step[0]) * f64::from(c.step[1]))).sum();
        let tiled = version & FLAG_TILED != 0 || (version & FLAG_MULTIPART != 0 && kind == b"tiledimage");
        let (block_pixels, blocks) = match find("tiles").filter(|_| tiled) {
            Some(value) => {
                let mut tiles = Cursor { bytes: value, at: 0 };
                let (w, h) = (u64::from(tiles.u32()?), u64::from(tiles.u32()?));
                if w == 0 || h == 0 || w > i32::MAX as u64 || h > i32::MAX as u64 {
                    return Err(Error::malformed(KIND, format!("tiles of {w}x{h} pixels")));
                }
                (w.saturating_mul(h), width.div_ceil(w).saturating_mul(height.div_ceil(h)))
            }
            None => (width.saturating_mul(rows_per_block), height.div_ceil(rows_per_block)),
        };
        if list.iter().any(|c| c.step != [1, 1]) && tiled {
            return Err(Error::malformed(KIND, "subsampled channels in a tiled image"));
        }
        let fits = |step: [u32; 2]| {
            let [sx, sy] = step.map(i64::from);
            x0 % sx == 0 && y0 % sy == 0 && (x1 - x0 + 1) % sx == 0 && (y1 - y0 + 1) % sy == 0
        };
        if !list.iter().all(|c| fits(c.step)) {
            return Err(Error::malformed(KIND, "the data window is not a multiple of a channel's sampling"));
        }
        Ok(Self {
            width,
            height,
            pixels,
            channels: list.len() as u64,
            stored_bytes: (pixels as f64 * pixel_bytes) as u64,
            decoded_bytes: pixels.saturating_mul(list.len() as u64).saturating_mul(4),
            block_bytes: (block_pixels as f64 * pixel_bytes) as u64,
            blocks,
            max_ratio,
        })
    }
}

/// A channel's sample size in bytes, its sampling steps, and where in the channel list these are.
struct ChannelCost {
    bytes: u32,
    step: [u32; 2],
    step_at: usize,
}

fn channel_list(value: &[u8]) -> Result<Vec<ChannelCost>> {
    let mut cursor = Cursor { bytes: value, at: 0 };
    let mut list = Vec::new();
    loop {
        if cursor.text()?.is_empty() {
            break;
        }
        let bytes = match cursor.u32()? {
            1 => 2,
            0 | 2 => 4,
            other => return Err(Error::malformed(KIND, format!("sample type {other}"))),
        };
        cursor.take(4)?;
        let step_at = cursor.at;
        let step = [cursor.u32()?, cursor.u32()?];
        if step.iter().any(|s| !(1..=1024).contains(s)) {
            return Err(Error::malformed(KIND, format!("channel sampling {}x{}", step[0], step[1])));
        }
        list.push(ChannelCost { bytes, step, step_at });
    }
    if list.is_empty() {
        return Err(Error::malformed(KIND, "no channels"));
    }
    Ok(list)
}

/// Rows of a scan-line block, and the largest plausible compression ratio.
fn compression(value: &[u8]) -> Result<(u64, u64)> {
    match value {
        [0] => Ok((1, 1)),
        [1] => Ok((1, 128)),
        [2] => Ok((1, MAX_RATIO)),
        [3 | 5] => Ok((16, MAX_RATIO)),
        [4] => Ok((32, MAX_RATIO)),
        // B44 stores float and integer channels as they are.
        [6 | 7] => Ok((32, 16)),
        [8] => Ok((32, MAX_RATIO)),
        [9] => Ok((256, MAX_RATIO)),
        [10 | 11] => Err(Error::unsupported(KIND, "HTJ2K compression")),
        other => Err(Error::malformed(KIND, format!("compression method {other:?}"))),
    }
}

/// Reads little-endian values, never beyond the end.
struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Cursor<'a> {
    fn take(&mut self, count: usize) -> Result<&'a [u8]> {
        let end = self.at.checked_add(count).filter(|&end| end <= self.bytes.len());
        let end = end.ok_or_else(|| Error::malformed(KIND, "the header ends early"))?;
        let taken = &self.bytes[self.at..end];
        self.at = end;
        Ok(taken)
    }

    fn u32(&mut self) -> Result<u32> {
        let b = self.take(4)?;
        Ok(u32::from_le_bytes([b[0], b[1], b[2], b[3]]))
    }

    fn i32(&mut self) -> Result<i32> {
        Ok(self.u32()? as i32)
    }

    /// A zero-terminated text of at most 255 bytes.
    fn text(&mut self) -> Result<&'a [u8]> {
        let rest = self.bytes.get(self.at..).unwrap_or_default();
        let length = rest.iter().take(256).position(|&b| b == 0);
        let length = length.ok_or_else(|| Error::malformed(KIND, "a name in the header does not end"))?;
        self.at += length + 1;
        Ok(&rest[..length])
    }
}
