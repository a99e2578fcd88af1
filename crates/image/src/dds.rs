//! DDS (DirectDraw Surface), with the extended header or without. Of a file with several levels the largest is read.

use crate::block::BlockFormat;
use crate::container::{self, Layout, u32_at};
use crate::{Error, FileKind, Limits, Result, Texels};

const KIND: FileKind = FileKind::Dds;

/// Numbers of DXGI formats, their layout, and whether they are sRGB-encoded.
const DXGI: [(u32, Layout, bool); 25] = [
    (2, Layout::Floats(4), false),
    (6, Layout::Floats(3), false),
    (10, Layout::Halves(4), false),
    (11, Layout::Sixteen(4), false),
    (28, Layout::Codes(4), false),
    (29, Layout::Codes(4), true),
    (34, Layout::Halves(2), false),
    (41, Layout::Floats(1), false),
    (49, Layout::Codes(2), false),
    (54, Layout::Halves(1), false),
    (56, Layout::Sixteen(1), false),
    (61, Layout::Codes(1), false),
    (71, Layout::Blocks(BlockFormat::Bc1, false), false),
    (72, Layout::Blocks(BlockFormat::Bc1, false), true),
    (74, Layout::Blocks(BlockFormat::Bc2, false), false),
    (75, Layout::Blocks(BlockFormat::Bc2, false), true),
    (77, Layout::Blocks(BlockFormat::Bc3, false), false),
    (78, Layout::Blocks(BlockFormat::Bc3, false), true),
    (80, Layout::Blocks(BlockFormat::Bc4, false), false),
    (81, Layout::Blocks(BlockFormat::Bc4, true), false),
    (83, Layout::Blocks(BlockFormat::Bc5, false), false),
    (84, Layout::Blocks(BlockFormat::Bc5, true), false),
    (87, Layout::Bgr(4), false),
    (88, Layout::Bgrx, false),
    (91, Layout::Bgr(4), true),
];

/// Formats with numbers above 91.
const DXGI_LATE: [(u32, Layout, bool); 5] = [
    (93, Layout::Bgrx, true),
    (95, Layout::Blocks(BlockFormat::Bc6h, false), false),
    (96, Layout::Blocks(BlockFormat::Bc6h, true), false),
    (98, Layout::Blocks(BlockFormat::Bc7, false), false),
    (99, Layout::Blocks(BlockFormat::Bc7, false), true),
];

/// Formats without the extended header. Colours are taken to be sRGB-encoded, as in other 8-bit files.
const FOUR_CC: [(&[u8; 4], Layout, bool); 12] = [
    (b"DXT1", Layout::Blocks(BlockFormat::Bc1, false), true),
    (b"DXT2", Layout::Blocks(BlockFormat::Bc2, false), true),
    (b"DXT3", Layout::Blocks(BlockFormat::Bc2, false), true),
    (b"DXT4", Layout::Blocks(BlockFormat::Bc3, false), true),
    (b"DXT5", Layout::Blocks(BlockFormat::Bc3, false), true),
    (b"ATI1", Layout::Blocks(BlockFormat::Bc4, false), false),
    (b"BC4U", Layout::Blocks(BlockFormat::Bc4, false), false),
    (b"BC4S", Layout::Blocks(BlockFormat::Bc4, true), false),
    (b"ATI2", Layout::Blocks(BlockFormat::Bc5, false), false),
    (b"BC5U", Layout::Blocks(BlockFormat::Bc5, false), false),
    (b"BC5S", Layout::Blocks(BlockFormat::Bc5, true), false),
    (&[113, 0, 0, 0], Layout::Halves(4), false),
];

pub(crate) fn decode(bytes: &[u8], limits: &Limits) -> Result<Texels> {
    let at = |offset| u32_at(KIND, bytes, offset);
    if bytes.first_chunk::<4>() != Some(b"DDS ") || at(4)? != 124 {
        return Err(Error::malformed(KIND, "the header is not a DDS header"));
    }
    let (height, width) = (u64::from(at(12)?), u64::from(at(16)?));
    // DDSCAPS2: cube maps and volumes.
    let caps2 = at(112)?;
    let mut is_cube = caps2 & 0x200 != 0;
    if is_cube && caps2 & 0xfc00 != 0xfc00 {
        return Err(Error::unsupported(KIND, "cube maps without all six faces"));
    }
    if caps2 & 0x20_0000 != 0 {
        return Err(Error::unsupported(KIND, "volumes"));
    }
    let four_cc = at(84)?.to_le_bytes();
    let (mut layout, mut srgb, mut start) = (None, true, 128);
    if at(80)? & 4 != 0 {
        if &four_cc == b"DX10" {
            let number = at(128)?;
            if at(132)? != 3 {
                return Err(Error::unsupported(KIND, "what is not a flat picture"));
            }
            is_cube |= at(136)? & 4 != 0;
            start = 148;
            let known = DXGI.iter().chain(&DXGI_LATE).find(|f| f.0 == number);
            let Some(known) = known else { return Err(Error::unsupported(KIND, format!("DXGI format {number}"))) };
            (layout, srgb) = (Some(known.1), known.2);
        } else if let Some(known) = FOUR_CC.iter().find(|f| *f.0 == four_cc) {
            (layout, srgb) = (Some(known.1), known.2);
        }
        let Some(layout) = layout else {
            let name = String::from_utf8_lossy(&four_cc).escape_default().to_string();
            return Err(Error::unsupported(KIND, format!("the format '{name}'")));
        };
        return pixels(bytes, (layout, srgb), (width, height), (start, is_cube), limits);
    }
    // Plain pixels, told by masks: bits per pixel, then red, green, blue, alpha.
    let [bits, red, green, blue, alpha] = [at(88)?, at(92)?, at(96)?, at(100)?, at(104)?];
    let layout = match (bits, red, green, blue, alpha) {
        (32, 0xff, 0xff00, 0xff_0000, 0xff00_0000) => Layout::Codes(4),
        (32, 0xff_0000, 0xff00, 0xff, 0xff00_0000) => Layout::Bgr(4),
        (32, 0xff_0000, 0xff00, 0xff, 0) => Layout::Bgrx,
        (24, 0xff_0000, 0xff00, 0xff, _) => Layout::Bgr(3),
        (24, 0xff, 0xff00, 0xff_0000, _) => Layout::Codes(3),
        (8, 0xff, ..) => Layout::Codes(1),
        _ => return Err(Error::unsupported(KIND, format!("{bits} bits per pixel with these masks"))),
    };
    pixels(bytes, (layout, srgb), (width, height), (start, is_cube), limits)
}

/// The largest level of the picture, or of all faces of a cube map, each of which is followed by its smaller levels.
fn pixels(
    bytes: &[u8],
    (layout, srgb): (Layout, bool),
    (width, height): (u64, u64),
    (start, is_cube): (usize, bool),
    limits: &Limits,
) -> Result<Texels> {
    let data = bytes.get(start..).unwrap_or(&[]);
    if !is_cube {
        return container::decode(KIND, layout, srgb, (width, height), data, limits);
    }
    let levels = u64::from(u32_at(KIND, bytes, 28)?.clamp(1, 32));
    let level = |i: u64| layout.bytes((width >> i).max(1), (height >> i).max(1)).unwrap_or(u64::MAX);
    let stride = (0..levels).fold(0, |sum: u64, i| sum.saturating_add(level(i)));
    container::decode_faces(KIND, (layout, srgb), (width, height), (data, stride), limits)
}

/// A file with the extended header that holds one level of blocks.
pub(crate) fn encode(width: u32, height: u32, format: BlockFormat, blocks: &[u8]) -> Vec<u8> {
    let srgb = format.is_colour();
    let wanted = |f: &&(u32, Layout, bool)| f.1 == Layout::Blocks(format, false) && f.2 == srgb;
    let number = DXGI.iter().chain(&DXGI_LATE).find(wanted).map_or(0, |f| f.0);
    let mut words = [0_u32; 37];
    words[0] = u32::from_le_bytes(*b"DDS ");
    words[1] = 124;
    // Caps, height, width, pixel format, and the size of the blocks are given.
    words[2] = 0x1 | 0x2 | 0x4 | 0x1000 | 0x8_0000;
    (words[3], words[4], words[5]) = (height, width, blocks.len() as u32);
    words[19] = 32;
    words[20] = 4;
    words[21] = u32::from_le_bytes(*b"DX10");
    words[27] = 0x1000;
    // Format, two dimensions, nothing special, one picture, no word on alpha.
    (words[32], words[33], words[35]) = (number, 3, 1);
    let mut bytes: Vec<u8> = words.iter().flat_map(|w| w.to_le_bytes()).collect();
    bytes.extend_from_slice(blocks);
    bytes
}
