//! KTX2 (Khronos Texture 2.0): block-compressed and plain pixels, also deflated, and Basis Universal. Of a file with
//! several levels the largest is read; Zstandard is read with Basis Universal only, and else refused by name.

use crate::block::BlockFormat;
use crate::container::{self, Layout, u32_at, u64_at};
use crate::limits::{MOST_DEFLATED, within};
use crate::{Error, FileKind, Limits, Result, TexelData, Texels, kind};
use std::io::Read;

const KIND: FileKind = FileKind::Ktx2;

/// Numbers of Vulkan formats, their layout, and whether they are sRGB-encoded.
const FORMATS: [(u32, Layout, bool); 36] = [
    (9, Layout::Codes(1), false),
    (15, Layout::Codes(1), true),
    (16, Layout::Codes(2), false),
    (22, Layout::Codes(2), true),
    (23, Layout::Codes(3), false),
    (29, Layout::Codes(3), true),
    (30, Layout::Bgr(3), false),
    (36, Layout::Bgr(3), true),
    (37, Layout::Codes(4), false),
    (43, Layout::Codes(4), true),
    (44, Layout::Bgr(4), false),
    (50, Layout::Bgr(4), true),
    (70, Layout::Sixteen(1), false),
    (76, Layout::Halves(1), false),
    (83, Layout::Halves(2), false),
    (84, Layout::Sixteen(3), false),
    (90, Layout::Halves(3), false),
    (91, Layout::Sixteen(4), false),
    (97, Layout::Halves(4), false),
    (100, Layout::Floats(1), false),
    (103, Layout::Floats(2), false),
    (106, Layout::Floats(3), false),
    (109, Layout::Floats(4), false),
    (131, Layout::Blocks(BlockFormat::Bc1, false), false),
    (132, Layout::Blocks(BlockFormat::Bc1, false), true),
    (133, Layout::Blocks(BlockFormat::Bc1, false), false),
    (134, Layout::Blocks(BlockFormat::Bc1, false), true),
    (135, Layout::Blocks(BlockFormat::Bc2, false), false),
    (136, Layout::Blocks(BlockFormat::Bc2, false), true),
    (137, Layout::Blocks(BlockFormat::Bc3, false), false),
    (138, Layout::Blocks(BlockFormat::Bc3, false), true),
    (139, Layout::Blocks(BlockFormat::Bc4, false), false),
    (140, Layout::Blocks(BlockFormat::Bc4, true), false),
    (141, Layout::Blocks(BlockFormat::Bc5, false), false),
    (142, Layout::Blocks(BlockFormat::Bc5, true), false),
    (143, Layout::Blocks(BlockFormat::Bc6h, false), false),
];

/// The rest of them.
const LATE: [(u32, Layout, bool); 3] = [
    (144, Layout::Blocks(BlockFormat::Bc6h, true), false),
    (145, Layout::Blocks(BlockFormat::Bc7, false), false),
    (146, Layout::Blocks(BlockFormat::Bc7, false), true),
];

pub(crate) fn decode(bytes: &[u8], limits: &Limits) -> Result<Texels> {
    let at = |offset| u32_at(KIND, bytes, offset);
    if !bytes.starts_with(&kind::KTX2) {
        return Err(Error::malformed(KIND, "the header is not a KTX2 header"));
    }
    let (number, width, height) = (at(12)?, u64::from(at(20)?), u64::from(at(24)?));
    let (depth, layers, faces, scheme) = (at(28)?, at(32)?, at(36)?, at(44)?);
    if depth > 0 {
        return Err(Error::unsupported(KIND, "volumes"));
    }
    if layers > 1 || !matches!(faces, 1 | 6) {
        return Err(Error::unsupported(KIND, "arrays"));
    }
    // A height of zero stands for one row.
    let size = (width, height.max(1));
    if number == 0 {
        if faces == 6 {
            return Err(Error::unsupported(KIND, "cube maps of Basis Universal"));
        }
        let mut texels = crate::basis::decode(bytes, size, limits)?;
        if is_bottom_up(bytes) {
            flip(&mut texels);
        }
        return Ok(texels);
    }
    let known = FORMATS.iter().chain(&LATE).find(|f| f.0 == number);
    let Some(&(_, layout, srgb)) = known else {
        return Err(Error::unsupported(KIND, format!("Vulkan format {number}")));
    };
    // The first level's place, from the index that follows the header.
    let (offset, length, inflated) = (u64_at(KIND, bytes, 80)?, u64_at(KIND, bytes, 88)?, u64_at(KIND, bytes, 96)?);
    let end = offset.checked_add(length).filter(|&end| end <= bytes.len() as u64);
    let Some(end) = end else {
        return Err(Error::TooShort { kind: KIND, width, height, bytes: bytes.len() as u64 });
    };
    let data = &bytes[offset as usize..end as usize];
    // The faces of a level follow each other.
    let decode = |data: &[u8]| match faces {
        6 => {
            let stride = layout.bytes(size.0, size.1).unwrap_or(u64::MAX);
            container::decode_faces(KIND, (layout, srgb), size, (data, stride), limits)
        }
        _ => container::decode(KIND, layout, srgb, size, data, limits),
    };
    let mut texels = match scheme {
        0 => decode(data)?,
        3 => {
            limits.check(KIND, size.0, size.1, 8)?;
            let most = (data.len() as u64).saturating_mul(MOST_DEFLATED);
            let needed = layout.bytes(size.0, size.1).and_then(|n| n.checked_mul(u64::from(faces)));
            let needed = needed.filter(|&n| n <= most && n <= inflated);
            let Some(needed) = needed else {
                return Err(Error::TooShort { kind: KIND, width, height, bytes: data.len() as u64 });
            };
            within("the decoded size in bytes", needed, limits.bytes)?;
            let mut plain = Vec::new();
            let done = flate2::read::ZlibDecoder::new(data).take(needed + 1).read_to_end(&mut plain);
            done.map_err(|e| Error::malformed(KIND, format!("its deflated data are damaged: {e}")))?;
            if plain.len() as u64 > needed {
                return Err(Error::malformed(KIND, "its deflated data are longer than its pixels"));
            }
            decode(&plain)?
        }
        1 => return Err(Error::unsupported(KIND, "Basis Universal")),
        2 => return Err(Error::unsupported(KIND, "Zstandard")),
        n => return Err(Error::unsupported(KIND, format!("supercompression scheme {n}"))),
    };
    // Cube maps have one orientation.
    if faces == 1 && is_bottom_up(bytes) {
        flip(&mut texels);
    }
    Ok(texels)
}

/// True if the entry `KTXorientation` says that the first row is the lowest.
fn is_bottom_up(bytes: &[u8]) -> bool {
    const KEY: &[u8] = b"KTXorientation\0";
    let (Ok(start), Ok(length)) = (u32_at(KIND, bytes, 56), u32_at(KIND, bytes, 60)) else { return false };
    let end = (start as usize).saturating_add(length as usize).min(bytes.len());
    let Some(entries) = bytes.get(start as usize..end) else { return false };
    let found = entries.windows(KEY.len()).position(|w| w == KEY);
    found.and_then(|at| entries.get(at + KEY.len() + 1)) == Some(&b'u')
}

fn flip(texels: &mut Texels) {
    fn turn<T: Copy>(data: &mut [T], row: usize) {
        let n = data.len() / row;
        for y in 0..n / 2 {
            let (above, below) = data.split_at_mut((n - 1 - y) * row);
            above[y * row..(y + 1) * row].swap_with_slice(&mut below[..row]);
        }
    }
    let row = texels.width * texels.channels;
    match &mut texels.data {
        TexelData::U8(v) => turn(v, row),
        TexelData::U16(v) => turn(v, row),
        TexelData::F16(v) => turn(v, row),
        TexelData::F32(v) => turn(v, row),
    }
}

/// A file with one level of blocks and the descriptor of its format (Khronos Data Format 1.3).
pub(crate) fn encode(width: u32, height: u32, format: BlockFormat, blocks: &[u8]) -> Vec<u8> {
    let srgb = format.is_colour();
    let wanted = |f: &&(u32, Layout, bool)| f.1 == Layout::Blocks(format, false) && f.2 == srgb;
    let number = FORMATS.iter().chain(&LATE).find(wanted).map_or(0, |f| f.0);
    let descriptor = descriptor(format, srgb);
    // Header and index: 80 bytes, one entry of the level index: 24; then the descriptor, and blocks at a multiple of
    // 16.
    let start = (104 + descriptor.len()).next_multiple_of(16);
    let mut bytes = kind::KTX2.to_vec();
    for word in [number, 1, width, height, 0, 0, 1, 1, 0, 104, descriptor.len() as u32, 0, 0] {
        bytes.extend(word.to_le_bytes());
    }
    for long in [0, 0, start as u64, blocks.len() as u64, blocks.len() as u64] {
        bytes.extend(long.to_le_bytes());
    }
    bytes.extend(descriptor);
    bytes.resize(start, 0);
    bytes.extend_from_slice(blocks);
    bytes
}

fn descriptor(format: BlockFormat, srgb: bool) -> Vec<u8> {
    const ALPHA: u32 = 15;
    const LINEAR: u32 = 0x10;
    const FLOAT: u32 = 0x80;
    let all = format.block_bytes() as u32 * 8;
    // Colour model, and channels with first bit and number of bits.
    let (model, samples): (u32, Vec<(u32, u32, u32)>) = match format {
        BlockFormat::Bc1 => (128, vec![(0, 0, all)]),
        BlockFormat::Bc2 => (129, vec![(ALPHA | LINEAR, 0, 64), (0, 64, 64)]),
        BlockFormat::Bc3 => (130, vec![(ALPHA | LINEAR, 0, 64), (0, 64, 64)]),
        BlockFormat::Bc4 => (131, vec![(0, 0, all)]),
        BlockFormat::Bc5 => (132, vec![(0, 0, 64), (1, 64, 64)]),
        BlockFormat::Bc6h => (133, vec![(FLOAT, 0, all)]),
        BlockFormat::Bc7 => (134, vec![(0, 0, all)]),
    };
    let size = 24 + 16 * samples.len() as u32;
    let transfer = if srgb { 2 } else { 1 };
    let mut words = vec![size + 4, 0, 2 | size << 16, model | 1 << 8 | transfer << 16, 3 | 3 << 8, all / 8, 0];
    for (channel, first, bits) in samples {
        let most = if channel == FLOAT { 1f32.to_bits() } else { u32::MAX };
        words.extend([first | (bits - 1) << 16 | channel << 24, 0, 0, most]);
    }
    words.into_iter().flat_map(u32::to_le_bytes).collect()
}
