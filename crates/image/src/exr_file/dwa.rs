//! The counters at the head of a DWAA or DWAB block, checked before the decoder takes its word for them and allocates.
//!
//! Layout (OpenEXR, DWA compressor): eleven 64-bit numbers: version; bytes of the deflated raw section before and after
//! compression; compressed bytes of the AC, DC and run-length sections; bytes of the run-length section after
//! inflating, and after expanding the runs; numbers of AC and DC coefficients; how the AC section is coded.

use super::decode::block_lines;
use crate::{Error, FileKind, Result};
use exr::meta::attribute::IntegerBounds;
use exr::meta::header::Header;

/// Refuses a block whose counters exceed what its pixels and its bytes allow.
pub(super) fn check(stored: &[u8], rect: &IntegerBounds, header: &Header) -> Result<()> {
    let (counters, _) = stored.as_chunks::<8>();
    let Some(counters) = counters.first_chunk::<11>() else {
        // Too short for its counters: empty, or refused by the decoder.
        return Ok(());
    };
    let [_, raw, raw_stored, ac_stored, dc_stored, runs_stored, runs, runs_raw, ac, dc, _] =
        counters.map(u64::from_le_bytes);
    // Coefficients come in 8×8 blocks of each channel, the last ones padded.
    let (width, height) = (rect.size.x() as u64, rect.size.y() as u64);
    let blocks = width.div_ceil(8) * height.div_ceil(8) * header.channels.list.len() as u64;
    let bytes: u64 = block_lines(rect, header).map(|line| line.bytes as u64).sum();
    let length = stored.len() as u64;
    let plausible = [raw_stored, ac_stored, dc_stored, runs_stored].iter().all(|&section| section <= length)
        && raw <= bytes
        && runs_raw <= bytes
        && runs <= 2 * bytes + 2
        && ac <= 64 * blocks
        && dc <= blocks;
    if plausible { Ok(()) } else { Err(Error::malformed(FileKind::Exr, "a DWA block declares more than its pixels")) }
}
