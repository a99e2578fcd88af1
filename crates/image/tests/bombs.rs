//! Small files that claim to be huge are refused at once, by name.

use steradian_image::{Error, FileKind, Image, Limits, Value, WriteOptions, encode, read_bytes, read_texels_bytes};

/// Expects a clean refusal because of size.
fn refused(what: &str, bytes: &[u8]) {
    for result in [
        read_bytes(bytes, None, &Limits::default()).map(|_| ()),
        read_texels_bytes(bytes, None, &Limits::default()).map(|_| ()),
    ] {
        match result {
            Err(Error::Limit { .. } | Error::TooShort { .. } | Error::Malformed { .. }) => {}
            other => panic!("{what}: {other:?}"),
        }
    }
}

/// A small EXR file with bytes of one attribute's value replaced.
fn exr_with(name: &str, at: usize, value: &[u8]) -> Vec<u8> {
    let image = Image::from_rgb(4, 4, &[[0.5; 3]; 16]).unwrap();
    let mut bytes = encode(FileKind::Exr, &image, &WriteOptions::default()).unwrap();
    let key = format!("{name}\0");
    let start = bytes.windows(key.len()).position(|w| w == key.as_bytes()).unwrap() + key.len();
    let type_length = bytes[start..].iter().position(|&b| b == 0).unwrap() + 1;
    let value_at = start + type_length + 4 + at;
    bytes[value_at..value_at + value.len()].copy_from_slice(value);
    bytes
}

#[test]
fn exr_windows() {
    let corner = |x: i32, y: i32| [x.to_le_bytes(), y.to_le_bytes()].concat();
    refused("2,000,000²", &exr_with("dataWindow", 8, &corner(1_999_999, 1_999_999)));
    refused("wide", &exr_with("dataWindow", 8, &corner(i32::MAX, 3)));
    refused("tall", &exr_with("dataWindow", 8, &corner(3, i32::MAX)));
    refused("10,000²", &exr_with("dataWindow", 8, &corner(9999, 9999)));
    refused("negative", &exr_with("dataWindow", 8, &corner(-5, -5)));
    refused(
        "whole range",
        &exr_with("dataWindow", 0, &[corner(i32::MIN, i32::MIN), corner(i32::MAX, i32::MAX)].concat()),
    );
    refused("sampling", &exr_with("channels", 2 + 8, &[0xff; 8]));
    refused("attribute size", &{
        let mut bytes = exr_with("dataWindow", 0, &[]);
        let at = bytes.windows(6).position(|w| w == b"chlist").unwrap() + 7;
        bytes[at..at + 4].copy_from_slice(&0x7fff_ffffu32.to_le_bytes());
        bytes
    });
}

#[test]
fn exr_compression_by_another_name() {
    for code in [10, 11, 12, 255] {
        let bytes = exr_with("compression", 0, &[code]);
        let result = read_bytes(&bytes, None, &Limits::default());
        assert!(matches!(result, Err(Error::Unsupported { .. } | Error::Malformed { .. })), "{code}");
    }
}

#[test]
fn exr_tiles() {
    // A scan-line file with the tile flag lacks its tile description.
    let mut bytes = exr_with("compression", 0, &[]);
    bytes[5] |= 2;
    assert!(read_bytes(&bytes, None, &Limits::default()).is_err());
}

#[test]
fn png_claims() {
    let image = Image::from_rgb(4, 4, &[[0.5; 3]; 16]).unwrap();
    let mut bytes = encode(FileKind::Png, &image, &WriteOptions::default()).unwrap();
    bytes[16..20].copy_from_slice(&100_000u32.to_be_bytes());
    bytes[20..24].copy_from_slice(&100_000u32.to_be_bytes());
    refused("wrong checksum", &bytes);
    let mut crc = flate2::Crc::new();
    crc.update(&bytes[12..29]);
    bytes[29..33].copy_from_slice(&crc.sum().to_be_bytes());
    refused("right checksum", &bytes);
}

#[test]
fn text_header_claims() {
    refused("ppm 10⁹", b"P6\n1000000000 1000000000\n255\nxxx");
    refused("ppm text", b"P3\n16000 16000\n255\n1 2 3");
    refused("ppm number", b"P6\n99999999999999999999999 1\n255\nxxx");
    refused("ppm max", b"P6\n#MAX=nan\n1 1\n255\nxxx");
    refused("pfm", b"PF\n1000000000 1000000000\n-1.0\n");
    refused("pfm small", b"PF\n10000 10000\n-1.0\n0000");
    refused("pfm scale", b"PF\n1 1\n0\n000000000000");
    refused("hdr", b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1000000 +X 1000000\n\x02\x02\x01\x01");
    refused("hdr flat", b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 16000 +X 16000\nabcd");
    refused("hdr runs", b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 10 +X 4\nabcd\x01\x01\x01\xff\x01\x01\x01\xff");
    refused("hdr zero run", b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 8\n\x02\x02\x00\x08\x00\x00\x00\x00");
    refused("hdr empty", b"#?RADIANCE\n\n-Y 0 +X 0\n");
}

/// A chunk of a PNG file.
fn png_chunk(kind: &[u8; 4], content: &[u8]) -> Vec<u8> {
    let body = [kind, content].concat();
    let mut crc = flate2::Crc::new();
    crc.update(&body);
    [&(content.len() as u32).to_be_bytes()[..], &body, &crc.sum().to_be_bytes()].concat()
}

/// So many zeros, packed.
fn packed_zeros(count: u64) -> Vec<u8> {
    use std::io::Read;
    let mut zip = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::best());
    std::io::copy(&mut std::io::repeat(b'0').take(count), &mut zip).unwrap();
    zip.finish().unwrap()
}

/// Texts and profiles that are packed in a PNG file: short ones are read, long ones are left out, and none of them is
/// unpacked without bound. The picture is read.
#[test]
fn packed_metadata_of_png() {
    let image = Image::from_rgb(2, 1, &[[0.5; 3]; 2]).unwrap();
    let png = encode(FileKind::Png, &image, &WriteOptions::default()).unwrap();
    let with = |chunks: &[Vec<u8>]| [&png[..33], &chunks.concat(), &png[33..]].concat();
    let text = |kind: &[u8; 4], key: &str, count: u64| {
        let flags: &[u8] = if kind == b"iTXt" { b"\0\x01\0\0\0" } else { b"\0\0" };
        png_chunk(kind, &[key.as_bytes(), flags, &packed_zeros(count)].concat())
    };
    let short = with(&[text(b"iTXt", "one", 9), text(b"zTXt", "two", 7), text(b"iCCP", "three", 100)]);
    let read = read_bytes(&short, None, &Limits::default()).unwrap();
    assert_eq!(read.metadata.get("one"), Some(&Value::Text("0".repeat(9))));
    assert_eq!(read.metadata.get("two"), Some(&Value::Text("0".repeat(7))));
    // 0.6 MB that stand for 0.6 GB.
    let large: Vec<Vec<u8>> =
        (0..6).map(|i| text([b"iTXt", b"zTXt", b"iCCP"][i % 3], &format!("k{i}"), 96 << 20)).collect();
    let before = peak_rss();
    for bomb in [with(&large[..1]), with(&large[1..2]), with(&large[2..3]), with(&[&large[..2], &large[3..5]].concat())]
    {
        let read = read_bytes(&bomb, None, &Limits::default()).unwrap();
        assert!(read.width() == 2 && read.metadata.entries.iter().all(|e| !e.0.starts_with('k')));
    }
    assert!(peak_rss() - before < 64 << 10, "{} KiB were taken", peak_rss() - before);
    // Those after the long ones are left out when the room is spent, not before.
    let after = with(&[text(b"zTXt", "k", 96 << 20), text(b"zTXt", "late", 5)]);
    assert!(read_bytes(&after, None, &Limits::default()).unwrap().metadata.get("late").is_some());
    let many: Vec<Vec<u8>> = (0..50).map(|i| text(b"zTXt", &format!("m{i}"), 1 << 20)).collect();
    let kept = read_bytes(&with(&many), None, &Limits::default()).unwrap().metadata.entries;
    assert_eq!(kept.iter().filter(|e| e.0.starts_with('m')).count(), 4);
}

/// The largest resident size of this process so far in KiB; zero where the system does not tell.
fn peak_rss() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"));
    line.and_then(|l| l.split_whitespace().next()?.parse().ok()).unwrap_or(0)
}

#[test]
fn metadata_by_the_thousand() {
    let mut hdr = b"#?RADIANCE\n".to_vec();
    (0..100_000).for_each(|i| hdr.extend(format!("V{i}=1\n").bytes()));
    refused("hdr", &[&hdr[..], b"\n-Y 1 +X 1\nabcd"].concat());

    let image = Image::from_rgb(1, 1, &[[0.5; 3]]).unwrap();
    let png = encode(FileKind::Png, &image, &WriteOptions::default()).unwrap();
    let mut many = png[..33].to_vec();
    for i in 0..100_000u32 {
        many.extend(png_chunk(b"tEXt", format!("{i:06}\0x").as_bytes()));
    }
    many.extend(&png[33..]);
    refused("png", &many);

    let exr = encode(FileKind::Exr, &image, &WriteOptions::default()).unwrap();
    let mut many = exr[..8].to_vec();
    (0..100_000).for_each(|i| many.extend(format!("a{i}\0int\0\x04\0\0\0\0\0\0\0").bytes()));
    many.extend(&exr[8..]);
    refused("exr", &many);
}

#[test]
fn cut_off_pictures_are_errors() {
    let pixels: Vec<_> = (0..4096).map(|i| [(i % 64) as f32 / 64.0, (i / 64) as f32 / 64.0, 0.5]).collect();
    let image = Image::from_rgb(64, 64, &pixels).unwrap();
    for kind in [FileKind::Exr, FileKind::Png, FileKind::Jpeg, FileKind::Hdr, FileKind::Pfm, FileKind::Pnm] {
        let bytes = encode(kind, &image, &WriteOptions::default()).unwrap();
        for part in [0.1, 0.5, 0.9, 0.95] {
            let cut = &bytes[..(bytes.len() as f64 * part) as usize];
            assert!(read_bytes(cut, None, &Limits::default()).is_err(), "{kind} cut to {part}");
        }
    }
}

/// Formats that are only read, put together by hand, and those with blocks and tiles: all but the whole file is
/// refused.
#[test]
fn other_cut_off_pictures_are_errors() {
    let side = 20_u8;
    let codes: Vec<u8> = (0..3 * 400_u32).map(|i| (i * 37 % 251) as u8).collect();
    let mut tga = vec![0; 18];
    (tga[2], tga[12], tga[14], tga[16]) = (2, side, side, 24);
    tga.extend(&codes);
    // Runs of one pixel.
    let mut tga_runs = tga[..18].to_vec();
    tga_runs[2] = 10;
    codes.chunks(3).for_each(|c| tga_runs.extend([0x80, c[0], c[1], c[2]]));
    let mut bmp = b"BM\0\0\0\0\0\0\0\0\x36\0\0\0\x28\0\0\0".to_vec();
    bmp.extend([side, 0, 0, 0, side, 0, 0, 0, 1, 0, 24, 0]);
    bmp.resize(54, 0);
    bmp.extend(&codes);
    let tiled = {
        use exr::prelude::*;
        let value = |p: Vec2<usize>| (p.x() as f32 / 20.0, p.y() as f32 / 20.0, 0.5_f32);
        let tiles = Encoding { blocks: Blocks::Tiles(Vec2(8, 8)), ..Encoding::SMALL_LOSSLESS };
        let channels = SpecificChannels::rgb(value);
        let layer = Layer::new((20, 20), LayerAttributes::default(), tiles, channels);
        let mut bytes = std::io::Cursor::new(Vec::new());
        Image::from_layer(layer).write().to_buffered(&mut bytes).unwrap();
        bytes.into_inner()
    };
    let image = Image::from_rgb(20, 20, &[[0.5, 0.25, 0.125]; 400]).unwrap();
    let of = |kind| encode(kind, &image, &WriteOptions::default()).unwrap();
    for (name, bytes) in [
        ("a.tga", tga),
        ("b.tga", tga_runs),
        ("a.bmp", bmp),
        ("tiled.exr", tiled),
        ("a.dds", of(FileKind::Dds)),
        ("a.ktx2", of(FileKind::Ktx2)),
    ] {
        let read = |bytes: &[u8]| read_texels_bytes(bytes, Some(name.as_ref()), &Limits::default()).map(|_| ());
        read(&bytes).unwrap_or_else(|e| panic!("{name}: {e}"));
        for part in [0.02, 0.1, 0.3, 0.5, 0.9, 0.98] {
            let cut = &bytes[..(bytes.len() as f64 * part) as usize];
            assert!(read(cut).is_err(), "{name} cut to {part}");
        }
    }
}

#[test]
fn photo_claims() {
    let image = Image::from_rgb(4, 4, &[[0.5; 3]; 16]).unwrap();
    let mut bytes = encode(FileKind::Jpeg, &image, &WriteOptions::default()).unwrap();
    let frame = bytes.windows(2).position(|w| w == [0xff, 0xc0]).unwrap();
    bytes[frame + 5..frame + 9].copy_from_slice(&[0xff; 4]);
    refused("jpeg", &bytes);

    let mut bmp = vec![0u8; 60];
    bmp[..2].copy_from_slice(b"BM");
    bmp[10] = 54;
    bmp[14] = 40;
    bmp[18..22].copy_from_slice(&1_000_000i32.to_le_bytes());
    bmp[22..26].copy_from_slice(&1_000_000i32.to_le_bytes());
    (bmp[26], bmp[28]) = (1, 24);
    refused("bmp", &bmp);

    let mut tga = vec![0u8; 18];
    tga[2] = 2;
    tga[12..16].fill(0xff);
    tga[16] = 24;
    let result = read_bytes(&tga, Some("a.tga".as_ref()), &Limits::default());
    assert!(matches!(result, Err(Error::TooShort { .. } | Error::Limit { .. })), "{result:?}");
}

#[test]
fn own_limits_are_obeyed() {
    let image = Image::from_rgb(64, 64, &[[0.5; 3]; 4096]).unwrap();
    for kind in [FileKind::Exr, FileKind::Png, FileKind::Jpeg, FileKind::Hdr, FileKind::Pfm, FileKind::Pnm] {
        let bytes = encode(kind, &image, &WriteOptions::default()).unwrap();
        assert!(read_bytes(&bytes, None, &Limits::default()).is_ok(), "{kind}");
        for limits in [Limits { pixels: 4095, ..Limits::default() }, Limits { bytes: 4096, ..Limits::default() }] {
            assert!(matches!(read_bytes(&bytes, None, &limits), Err(Error::Limit { .. })), "{kind} {limits:?}");
        }
    }
    let bytes = encode(FileKind::Exr, &image, &WriteOptions::default()).unwrap();
    let limits = Limits { channels: 2, ..Limits::default() };
    assert!(matches!(read_bytes(&bytes, None, &limits), Err(Error::Limit { .. })));
}

#[test]
fn nothing_and_nonsense() {
    for bytes in [&b""[..], b"P", b"#?", b"BM", b"\x89PNG\r\n\x1a\n", b"\x76\x2f\x31\x01", b"\xff\xd8\xff", b"hello"] {
        assert!(read_bytes(bytes, None, &Limits::default()).is_err());
        assert!(read_bytes(bytes, Some("x.tga".as_ref()), &Limits::default()).is_err());
    }
    let result = read_bytes(b"hello", Some("x.txt".as_ref()), &Limits::default());
    assert!(matches!(result, Err(Error::UnknownFormat)));
}
