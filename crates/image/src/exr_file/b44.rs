//! B44 and B44A blocks. Each half channel is cut into 4×4 pixels, packed into 14 bytes: the first value, a shift, and
//! fifteen 6-bit differences; or into 3 bytes when all are equal. Float and integer channels are stored as they are.
//!
//! Format: OpenEXR's B44 description. The `exr` crate decodes B44 too, but not with subsampled channels.

use super::decode::{Line, block_lines};
use crate::{Error, FileKind, Result};
use exr::meta::attribute::{IntegerBounds, SampleType};
use exr::meta::header::Header;
use half::f16;

/// Third byte from which on a block is one of three bytes.
const FLAT: u8 = 13 << 2;

/// Decompresses a block into lines of native-endian samples, in the order of an uncompressed block.
pub(super) fn decompress(stored: &[u8], rect: &IntegerBounds, header: &Header) -> Result<Vec<u8>> {
    let lines: Vec<Line> = block_lines(rect, header).collect();
    let mut starts = Vec::with_capacity(lines.len());
    let total = lines.iter().fold(0, |at, line| {
        starts.push(at);
        at + line.bytes
    });
    // A block that did not get smaller is stored as it is.
    if stored.len() == total {
        return Ok(native(stored, &lines, header));
    }
    let mut source = Source { bytes: stored };
    let mut out = vec![0; total];
    for (channel, description) in header.channels.list.iter().enumerate() {
        let own = || {
            lines.iter().zip(&starts).filter(|(line, _)| line.channel == channel).map(|(line, &at)| (at, line.bytes))
        };
        if description.sample_type == SampleType::F16 {
            let rows: Vec<(usize, usize)> = own().collect();
            for four in rows.chunks(4) {
                half_rows(&mut source, four, description.quantize_linearly, &mut out)?;
            }
        } else {
            for (at, bytes) in own() {
                let stored = source.take(bytes)?;
                out[at..at + bytes].copy_from_slice(stored);
                to_native(&mut out[at..at + bytes], 4);
            }
        }
    }
    Ok(out)
}

/// Decodes the blocks of up to four rows, given as (start in `out`, bytes).
fn half_rows(source: &mut Source<'_>, rows: &[(usize, usize)], logarithmic: bool, out: &mut [u8]) -> Result<()> {
    let width = rows.first().map_or(0, |row| row.1 / 2);
    for x in (0..width).step_by(4) {
        let mut values = source.block()?;
        if logarithmic {
            values = values.map(from_logarithm);
        }
        for (y, &(at, _)) in rows.iter().enumerate() {
            for (column, value) in values[4 * y..][..4].iter().enumerate().take(width - x) {
                let to = at + 2 * (x + column);
                out[to..to + 2].copy_from_slice(&value.to_ne_bytes());
            }
        }
    }
    Ok(())
}

/// The stored bytes that are left.
struct Source<'a> {
    bytes: &'a [u8],
}

impl<'a> Source<'a> {
    fn take(&mut self, count: usize) -> Result<&'a [u8]> {
        let (taken, rest) = self
            .bytes
            .split_at_checked(count)
            .ok_or_else(|| Error::malformed(FileKind::Exr, "a B44 block ends early"))?;
        self.bytes = rest;
        Ok(taken)
    }

    /// Sixteen halves, row by row.
    fn block(&mut self) -> Result<[u16; 16]> {
        let flat = self.bytes.get(2).is_some_and(|&b| b >= FLAT);
        let b = self.take(if flat { 3 } else { 14 })?;
        let first = u16::from_be_bytes([b[0], b[1]]);
        let mut values = [first; 16];
        if !flat {
            let shift = u32::from(b[2] >> 2);
            // The low 90 bits of the rest are the differences, the first one highest.
            let bits = b[2..14].iter().fold(0u128, |bits, &byte| bits << 8 | u128::from(byte));
            let difference = |k: u32| {
                let six = (bits >> (84 - 6 * k) & 0x3f) as i32 - 0x20;
                (six << shift) as u16
            };
            // First down the left column, then each column from the one on its left.
            for k in 0..3 {
                let above = values[4 * k];
                values[4 * k + 4] = above.wrapping_add(difference(k as u32));
            }
            for column in 1..4 {
                for row in 0..4 {
                    let left = values[4 * row + column - 1];
                    values[4 * row + column] = left.wrapping_add(difference((4 * column + row - 1) as u32));
                }
            }
        }
        // Values are ordered as integers; the sign bit is flipped back, and all bits of negative ones.
        Ok(values.map(|v| if v & 0x8000 != 0 { v & 0x7fff } else { !v }))
    }
}

/// `pLinear` channels were stored as exp(x / 8).
fn from_logarithm(bits: u16) -> u16 {
    let x = f16::from_bits(bits).to_f32();
    if x.is_finite() && x >= 0.0 { f16::from_f32(8.0 * x.ln()).to_bits() } else { 0 }
}

fn native(stored: &[u8], lines: &[Line], header: &Header) -> Vec<u8> {
    let mut out = stored.to_vec();
    let mut at = 0;
    for line in lines {
        let size = header.channels.list[line.channel].sample_type.bytes_per_sample();
        to_native(&mut out[at..at + line.bytes], size);
        at += line.bytes;
    }
    out
}

/// From little endian, as in files.
fn to_native(samples: &mut [u8], size: usize) {
    if cfg!(target_endian = "big") {
        samples.chunks_exact_mut(size).for_each(<[u8]>::reverse);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flat_and_packed_blocks() {
        let one = f16::ONE.to_bits();
        let [high, low] = (one | 0x8000).to_be_bytes();
        assert_eq!(Source { bytes: &[high, low, 0xfc] }.block().unwrap(), [one; 16]);
        // All differences at their bias of 32, no shift: the first value everywhere.
        let mut bytes = [0u8; 14];
        bytes[..2].copy_from_slice(&[high, low]);
        let bits = (0..15).fold(0u128, |bits, _| bits << 6 | 0x20);
        bytes[2..].copy_from_slice(&bits.to_be_bytes()[4..]);
        assert_eq!(Source { bytes: &bytes }.block().unwrap(), [one; 16]);
        assert!(Source { bytes: &bytes[..13] }.block().is_err());
    }
}
