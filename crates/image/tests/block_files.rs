//! DDS and KTX2 files: round trips, plain pixels, and files that lie.

use std::io::Write;
use steradian_image::block::{BlockFormat, Decoded, WRITABLE, decode};
use steradian_image::{
    Encoding, Error, FileKind, Image, Limits, TexelData, WriteOptions, encode, read_bytes, read_texels_bytes,
};

fn ramp(width: usize, height: usize, alpha: bool) -> Image {
    let at = |i: usize| {
        let (x, y) = ((i % width) as f32 / width as f32, (i / width) as f32 / height as f32);
        // Channels that go together, as four colours on a line can show.
        let v = 0.5 * (x + y);
        [0.1 + 0.8 * v, 0.9 - 0.7 * v, 0.5]
    };
    let pixels: Vec<[f32; 3]> = (0..width * height).map(at).collect();
    let mut image = Image::from_rgb(width, height, &pixels).unwrap();
    if alpha {
        image.push("A", pixels.iter().map(|p| p[0]).collect()).unwrap();
    }
    image
}

fn file(kind: FileKind, block: BlockFormat) -> Vec<u8> {
    let options = WriteOptions { block, ..WriteOptions::default() };
    encode(kind, &ramp(30, 22, true), &options).unwrap()
}

#[test]
fn pictures_come_back_from_both_containers() {
    for (name, block) in WRITABLE {
        let both = [FileKind::Dds, FileKind::Ktx2].map(|kind| {
            let bytes = file(kind, block);
            assert_eq!(FileKind::from_content(&bytes), Some(kind));
            let texels = read_texels_bytes(&bytes, None, &Limits::default()).unwrap();
            let is_half = block == BlockFormat::Bc6h;
            assert!(is_half == matches!(texels.data, TexelData::F16(_)), "8 bits stay 8 bits, halves stay halves");
            assert_eq!(texels.encoding, if block.is_colour() { Encoding::Srgb } else { Encoding::Linear });
            let image = read_bytes(&bytes, None, &Limits::default()).unwrap();
            assert_eq!((image.width(), image.height()), (30, 22));
            let (seen, wanted) = (image.to_rgb().unwrap(), ramp(30, 22, true).to_rgb().unwrap());
            let lanes = match block {
                BlockFormat::Bc4 => 1,
                BlockFormat::Bc5 => 2,
                _ => 3,
            };
            for (a, b) in seen.iter().zip(&wanted) {
                (0..lanes).for_each(|c| assert!((a[c] - b[c]).abs() < 0.04, "{name} {kind}: {a:?} {b:?}"));
            }
            let alpha = image.channel("A").map(|a| a[40]);
            match block {
                BlockFormat::Bc3 | BlockFormat::Bc7 => assert!((alpha.unwrap() - wanted[40][0]).abs() < 0.02),
                // Four bits: half a step of a fifteenth.
                BlockFormat::Bc2 => assert!((alpha.unwrap() - wanted[40][0]).abs() < 0.035),
                _ => assert_eq!(alpha, None),
            }
            texels.data
        });
        assert_eq!(both[0], both[1], "{name}: the same blocks");
    }
}

#[test]
fn plain_pixels_are_read() {
    // 2 × 1, 32 bits, blue first.
    let mut dds = vec![0_u8; 128];
    dds[..8].copy_from_slice(b"DDS \x7c\0\0\0");
    for (at, value) in [
        (12, 1_u32),
        (16, 2),
        (76, 32),
        (80, 0x41),
        (88, 32),
        (92, 0xff_0000),
        (96, 0xff00),
        (100, 0xff),
        (104, 0xff00_0000),
    ] {
        dds[at..at + 4].copy_from_slice(&value.to_le_bytes());
    }
    dds.extend([1, 2, 3, 4, 5, 6, 7, 8]);
    let texels = read_texels_bytes(&dds, None, &Limits::default()).unwrap();
    assert_eq!((texels.channels, texels.data), (4, TexelData::U8(vec![3, 2, 1, 4, 7, 6, 5, 8])));
}

/// A KTX2 file of half floats, deflated or not, lowest row first or not.
fn halves(scheme: u32, up: bool, inflated: u64) -> Vec<u8> {
    let texels: Vec<u8> = [1.0, 2.0, 4.0, 0.5].iter().flat_map(|v| half::f16::from_f32(*v).to_le_bytes()).collect();
    let stored = if scheme == 3 {
        let mut z = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::best());
        z.write_all(&texels).unwrap();
        z.finish().unwrap()
    } else {
        texels
    };
    let key = if up { &b"KTXorientation\0ru\0"[..] } else { &[] };
    let mut bytes = [&[0xab][..], b"KTX 20", &[0xbb], b"\r\n\x1a\n"].concat();
    let start = 104 + key.len();
    for word in [76_u32, 2, 2, 2, 0, 0, 1, 1, scheme, 0, 0, 104, key.len() as u32] {
        bytes.extend(word.to_le_bytes());
    }
    for long in [0, 0, start as u64, stored.len() as u64, inflated] {
        bytes.extend(long.to_le_bytes());
    }
    [&bytes[..], key, &stored].concat()
}

#[test]
fn ktx2_rows_and_deflated_data() {
    for scheme in [0, 3] {
        for (up, wanted) in [(false, [1.0, 2.0, 4.0, 0.5]), (true, [4.0, 0.5, 1.0, 2.0])] {
            let texels = read_texels_bytes(&halves(scheme, up, 8), None, &Limits::default()).unwrap();
            assert_eq!(texels.data, TexelData::F16(wanted.map(half::f16::from_f32).to_vec()));
        }
    }
    let fault = |bytes: &[u8]| read_texels_bytes(bytes, None, &Limits::default()).unwrap_err().to_string();
    assert!(fault(&halves(2, false, 8)).contains("Zstandard"));
    assert!(fault(&halves(1, false, 8)).contains("Basis"));
    let mut cut = halves(3, false, 8);
    cut.truncate(cut.len() - 3);
    assert!(matches!(read_texels_bytes(&cut, None, &Limits::default()), Err(Error::TooShort { .. })));
    let mut damaged = halves(3, false, 8);
    let n = damaged.len();
    damaged[n - 6..].fill(0xff);
    assert!(read_texels_bytes(&damaged, None, &Limits::default()).is_err());
}

#[test]
fn files_that_declare_too_much_are_refused() {
    for (kind, width, height) in [(FileKind::Dds, 16, 12), (FileKind::Ktx2, 20, 24)] {
        let whole = file(kind, BlockFormat::Bc7);
        for (w, h) in [(30_000_u32, 30_000_u32), (u32::MAX, u32::MAX), (0, 5), (64, 64)] {
            let mut bytes = whole.clone();
            bytes[width..width + 4].copy_from_slice(&w.to_le_bytes());
            bytes[height..height + 4].copy_from_slice(&h.to_le_bytes());
            assert!(read_texels_bytes(&bytes, None, &Limits::default()).is_err(), "{kind} {w}x{h}");
        }
        for length in 0..whole.len().min(200) {
            assert!(
                read_texels_bytes(&whole[..length], Some(std::path::Path::new("a.dds")), &Limits::default()).is_err()
            );
        }
        // Whatever single byte of the header is damaged, it is read or refused.
        for at in 0..150 {
            for value in [0, 1, 0x7f, 0xff] {
                let mut bytes = whole.clone();
                bytes[at] = value;
                let _ = read_texels_bytes(&bytes, None, &Limits::default());
            }
        }
    }
}

/// Random blocks of every format and mode against what another decoder makes of them. Pillow cuts thirds and sevenths
/// where others round, so one code is allowed but for BC7, which has no such freedom; half floats are compared as
/// codes.
#[test]
fn blocks_decode_as_with_another_decoder() {
    let bytes = |hex: &str| -> Vec<u8> {
        (0..hex.len() / 2).map(|i| u8::from_str_radix(&hex[2 * i..2 * i + 2], 16).unwrap()).collect()
    };
    let mut seen = 0;
    for line in include_str!("block_decodes.txt").lines().filter(|l| !l.starts_with('#')) {
        let [name, block, texels] = line.split(' ').collect::<Vec<_>>()[..] else { panic!("{line}") };
        let (format, stride, allowed) = match name {
            "bc1" => (BlockFormat::Bc1, 4, 1),
            "bc2" => (BlockFormat::Bc2, 4, 1),
            "bc3" => (BlockFormat::Bc3, 4, 1),
            "bc4" => (BlockFormat::Bc4, 1, 1),
            "bc5" => (BlockFormat::Bc5, 3, 1),
            "bc6h" => (BlockFormat::Bc6h, 3, 1),
            "bc7" => (BlockFormat::Bc7, 4, 0),
            other => panic!("{other}"),
        };
        let (codes, channels): (Vec<u8>, usize) = match decode(format, false, &bytes(block), 4, 4).unwrap() {
            Decoded::Codes(codes, n) => (codes, n),
            Decoded::Halves(halves, n) => {
                (halves.iter().map(|h| (h.to_f32().clamp(0.0, 1.0) * 255.0).round() as u8).collect(), n)
            }
        };
        for (i, (ours, theirs)) in codes.chunks_exact(channels).zip(bytes(texels).chunks_exact(stride)).enumerate() {
            let opaque = if channels == 3 && stride == 4 { theirs[3] == 255 } else { true };
            let close = ours.iter().zip(theirs).all(|(a, b)| a.abs_diff(*b) <= allowed);
            assert!(close && opaque, "{name} {block}, texel {i}: {ours:?} {theirs:?}");
        }
        seen += 1;
    }
    assert_eq!(seen, 52);
}
