//! Pictures that lie, break off, or hold numbers that no picture should, as textures and as lights.

use crate::case::{Case, Expect};
use Expect::{Either, Picture, Refused};
use steradian::image::{FileKind, Image, WriteOptions, encode};

/// A square picture of one value.
fn uniform(size: usize, value: f32) -> Image {
    Image::from_rgb(size, size, &vec![[value; 3]; size * size]).expect("the size is right")
}

/// Its bytes.
fn bytes(kind: FileKind, image: &Image) -> Vec<u8> {
    encode(kind, image, &WriteOptions::default()).expect("it can be encoded")
}

/// A picture of ones with one texel changed.
fn spotted(value: f32) -> Image {
    let mut pixels = vec![[1.0; 3]; 64];
    pixels[27] = [value; 3];
    Image::from_rgb(8, 8, &pixels).expect("the size is right")
}

/// A picture in all places where scenes hold pictures.
fn everywhere(name: &str, file: &str, content: &[u8], expect: Expect) -> Vec<Case> {
    let pbrt = [
        (
            "texture",
            format!(
                "Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"{file}\"\nMaterial \"diffuse\" \"texture reflectance\" \"t\"\nShape \"sphere\""
            ),
        ),
        (
            "texture with levels",
            format!(
                "Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"{file}\" \"string filter\" \"EWA\"\nMaterial \"diffuse\" \"texture reflectance\" \"t\"\nShape \"sphere\""
            ),
        ),
        (
            "roughness",
            format!(
                "Texture \"t\" \"float\" \"imagemap\" \"string filename\" \"{file}\"\nMaterial \"conductor\" \"texture roughness\" \"t\"\nShape \"sphere\""
            ),
        ),
        (
            "alpha",
            format!(
                "Texture \"t\" \"float\" \"imagemap\" \"string filename\" \"{file}\"\nShape \"sphere\" \"texture alpha\" \"t\""
            ),
        ),
        ("environment", format!("LightSource \"infinite\" \"string filename\" \"{file}\"\nShape \"sphere\"")),
        ("goniometer", format!("LightSource \"goniometric\" \"string filename\" \"{file}\"\nShape \"sphere\"")),
        (
            "slide",
            format!("LightSource \"projection\" \"string filename\" \"{file}\" \"float fov\" 60\nShape \"sphere\""),
        ),
        (
            "light",
            format!(
                "AreaLightSource \"diffuse\" \"string filename\" \"{file}\"\nShape \"disk\"\nTranslate 0 0 -2 Shape \"sphere\" \"float radius\" 0.5"
            ),
        ),
    ];
    let mitsuba = [
        (
            "texture",
            format!(
                "<shape type='rectangle'><bsdf type='diffuse'><texture type='bitmap' name='reflectance'><string name='filename' value='{file}'/></texture></bsdf></shape>"
            ),
        ),
        (
            "opacity",
            format!(
                "<shape type='rectangle'><bsdf type='mask'><texture type='bitmap' name='opacity'><string name='filename' value='{file}'/></texture><bsdf type='diffuse'/></bsdf></shape>"
            ),
        ),
        (
            "environment",
            format!("<emitter type='envmap'><string name='filename' value='{file}'/></emitter><shape type='sphere'/>"),
        ),
        (
            "light",
            format!(
                "<shape type='rectangle'><emitter type='area'><texture type='bitmap' name='radiance'><string name='filename' value='{file}'/></texture></emitter></shape><shape type='sphere'/>"
            ),
        ),
        (
            "slide",
            format!(
                "<emitter type='projector'><texture type='bitmap' name='irradiance'><string name='filename' value='{file}'/></texture></emitter><shape type='sphere'/>"
            ),
        ),
    ];
    let pbrt = pbrt.into_iter().map(|(place, world)| Case::pbrt(format!("pbrt {place}, {name}"), world, expect));
    let mitsuba =
        mitsuba.into_iter().map(|(place, body)| Case::mitsuba(format!("Mitsuba {place}, {name}"), body, expect));
    pbrt.chain(mitsuba).map(|c| c.with(file, content)).collect()
}

/// A PNG file whose header claims a size, with the right checksum.
fn png_of(width: u32, height: u32) -> Vec<u8> {
    let mut png = bytes(FileKind::Png, &uniform(4, 0.5));
    png[16..20].copy_from_slice(&width.to_be_bytes());
    png[20..24].copy_from_slice(&height.to_be_bytes());
    let mut crc = flate2::Crc::new();
    crc.update(&png[12..29]);
    png[29..33].copy_from_slice(&crc.sum().to_be_bytes());
    png
}

/// A PNG file that really holds a square of black pixels.
pub fn true_png(size: u32) -> Vec<u8> {
    // One packed row, again and again: a zlib stream is put together from it.
    let row = vec![0; size as usize * 3 + 1];
    let mut packer = flate2::Compress::new(flate2::Compression::fast(), false);
    let mut packed = Vec::with_capacity(1 << 16);
    packer.compress_vec(&row, &mut packed, flate2::FlushCompress::Full).expect("memory can be written");
    let mut data = vec![0x78, 0x01];
    (0..size).for_each(|_| data.extend(&packed));
    // An empty last block, and the checksum of that many zeros.
    data.extend([0x03, 0x00]);
    let zeros = row.len() as u64 * u64::from(size);
    data.extend((((zeros % 65521) as u32) << 16 | 1).to_be_bytes());
    let mut png = b"\x89PNG\r\n\x1a\n".to_vec();
    let mut chunk = |name: &[u8; 4], content: &[u8]| {
        let body = [&name[..], content].concat();
        let mut crc = flate2::Crc::new();
        crc.update(&body);
        png.extend((content.len() as u32).to_be_bytes());
        png.extend(body);
        png.extend(crc.sum().to_be_bytes());
    };
    chunk(b"IHDR", &[&size.to_be_bytes()[..], &size.to_be_bytes(), &[8, 2, 0, 0, 0]].concat());
    chunk(b"IDAT", &data);
    chunk(b"IEND", &[]);
    png
}

/// An EXR file whose data window is replaced.
fn exr_of(window: [i32; 4]) -> Vec<u8> {
    let mut exr = bytes(FileKind::Exr, &uniform(4, 0.5));
    let key = b"dataWindow\0box2i\0";
    let at = exr.windows(key.len()).position(|w| w == key).expect("it has a data window") + key.len() + 4;
    window.iter().enumerate().for_each(|(i, v)| exr[at + 4 * i..at + 4 * i + 4].copy_from_slice(&v.to_le_bytes()));
    exr
}

/// Headers of formats without checksums that claim 30000² pixels in two thousand bytes, or nothing.
fn claims() -> Vec<(&'static str, &'static str, Vec<u8>)> {
    let tga = |side: u16| {
        let mut header = vec![0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0];
        header.extend([side.to_le_bytes(), side.to_le_bytes()].concat());
        header.extend([24, 0]);
        header
    };
    let words = |start: &[u8], words: &[u32]| {
        let mut header = start.to_vec();
        words.iter().for_each(|w| header.extend(w.to_le_bytes()));
        header
    };
    let bmp = |side| words(b"BM", &[2054, 0, 54, 40, side, side, 1 | 24 << 16, 0, 0, 2835, 2835, 0, 0]);
    let dds = |side, code: &[u8; 4]| {
        let mut header = vec![124, 0x1007, side, side, 0, 0, 0];
        header.extend([0; 11]);
        header.extend([32, 4, u32::from_le_bytes(*code), 0, 0, 0, 0, 0, 0x1000, 0, 0, 0, 0]);
        words(b"DDS ", &header)
    };
    // BC7, one level.
    let identifier = [0xab, b'K', b'T', b'X', b' ', b'2', b'0', 0xbb, 13, 10, 0x1a, 10];
    let level = [104, 0, 2000, 0, 2000, 0];
    let ktx = |side| {
        let header = [145, 1, side, side, 0, 0, 1, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0];
        words(&identifier, &[&header[..], &level[..]].concat())
    };
    let ppm = |side: u32| format!("P6 {side} {side} 255\n").into_bytes();
    let all = vec![
        ("TGA of 30000²", "i.tga", tga(30_000)),
        ("TGA of nothing", "i.tga", tga(0)),
        ("BMP of 30000²", "i.bmp", bmp(30_000)),
        ("BMP of nothing", "i.bmp", bmp(0)),
        ("DDS of 30000², BC1", "i.dds", dds(30_000, b"DXT1")),
        ("DDS of 30000², of another kind", "i.dds", dds(30_000, b"DX10")),
        ("DDS of nothing", "i.dds", dds(0, b"DXT1")),
        ("KTX2 of 30000²", "i.ktx2", ktx(30_000)),
        ("KTX2 of nothing", "i.ktx2", ktx(0)),
        ("PPM of 30000²", "i.ppm", ppm(30_000)),
        ("PPM of nothing", "i.ppm", ppm(0)),
    ];
    all.into_iter().map(|(name, file, header)| (name, file, [&header[..], &[77; 2000]].concat())).collect()
}

/// An EXR file whose list of channels names 65536 of them.
fn exr_of_channels() -> Vec<u8> {
    let sound = bytes(FileKind::Exr, &uniform(4, 0.5));
    let key = b"channels\0chlist\0";
    let at = sound.windows(key.len()).position(|w| w == key).expect("it has channels") + key.len();
    let size = u32::from_le_bytes(sound[at..at + 4].try_into().expect("four bytes")) as usize;
    let mut list = Vec::new();
    for i in 0..65_536 {
        list.extend(format!("c{i:05}\0").into_bytes());
        [1_u32, 0, 1, 1].iter().for_each(|v| list.extend(v.to_le_bytes()));
    }
    list.push(0);
    [&sound[..at], &(list.len() as u32).to_le_bytes(), &list, &sound[at + 4 + size..]].concat()
}

pub fn table() -> Vec<Case> {
    let mut cases = Vec::new();
    let mut add =
        |name: &str, file: &str, content: &[u8], expect| cases.extend(everywhere(name, file, content, expect));
    for (file, kind) in [
        ("i.png", FileKind::Png),
        ("i.exr", FileKind::Exr),
        ("i.hdr", FileKind::Hdr),
        ("i.pfm", FileKind::Pfm),
        ("i.jpg", FileKind::Jpeg),
    ] {
        let sound = bytes(kind, &uniform(16, 0.5));
        add(&format!("sound {kind}"), file, &sound, Picture);
        add(&format!("half of {kind}"), file, &sound[..sound.len() / 2], Refused("i."));
        add(&format!("nothing of {kind}"), file, b"", Refused("i."));
        add(&format!("one {kind} pixel"), file, &bytes(kind, &uniform(1, 0.5)), Picture);
        add(&format!("black {kind}"), file, &bytes(kind, &uniform(8, 0.0)), Either);
    }
    for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -1.0, 3e38, 1e30, 1e-40, 7.0] {
        add(&format!("PFM texel {value:e}"), "i.pfm", &bytes(FileKind::Pfm, &spotted(value)), Either);
        add(&format!("PFM all {value:e}"), "i.pfm", &bytes(FileKind::Pfm, &uniform(8, value)), Either);
        add(&format!("EXR texel {value:e}"), "i.exr", &bytes(FileKind::Exr, &spotted(value)), Either);
    }
    for (name, size) in
        [("PNG of 100000²", [100_000, 100_000]), ("PNG of nothing", [0, 0]), ("PNG of 2³¹", [1 << 31, 1])]
    {
        cases.extend(everywhere(name, "i.png", &png_of(size[0], size[1]), Refused("i.png")));
    }
    for (file, kind) in [("i.dds", FileKind::Dds), ("i.ktx2", FileKind::Ktx2), ("i.ppm", FileKind::Pnm)] {
        // Sides that are no powers of two, and no multiples of a block.
        let pixels: Vec<[f32; 3]> = (0..13 * 7).map(|i| [i as f32 / 91.0; 3]).collect();
        let sound = bytes(kind, &Image::from_rgb(13, 7, &pixels).expect("the size is right"));
        cases.extend(everywhere(&format!("{kind} of 13 x 7"), file, &sound, Either));
        cases.extend(everywhere(&format!("half of {kind}"), file, &sound[..sound.len() / 2], Refused("i.")));
    }
    for (name, file, at) in [("TGA of 30000²", "i.tga", [12, 14]), ("BMP of 30000²", "i.bmp", [18, 22])] {
        // The same with a size of which a third of the pixels is there.
        let (_, _, mut content) = claims().into_iter().find(|c| c.0 == name).expect("it is in the list");
        at.iter().for_each(|at| content[*at..at + 2].copy_from_slice(&44_u16.to_le_bytes()));
        cases.extend(everywhere(&format!("third of {file}"), file, &content, Refused("i.")));
    }
    for (name, file, content) in claims() {
        cases.extend(everywhere(name, file, &content, Refused("i.")));
    }
    cases.extend(everywhere("PNG of 30000²", "i.png", &png_of(30_000, 30_000), Refused("i.png")));
    cases.extend(everywhere("EXR of 65536 channels", "i.exr", &exr_of_channels(), Refused("i.exr")));
    for (name, window) in [
        ("EXR of 2000000²", [0, 0, 1_999_999, 1_999_999]),
        ("EXR of the whole range", [i32::MIN, i32::MIN, i32::MAX, i32::MAX]),
        ("EXR of a negative size", [0, 0, -5, -5]),
        ("EXR of 10000²", [0, 0, 9999, 9999]),
    ] {
        cases.extend(everywhere(name, "i.exr", &exr_of(window), Refused("i.exr")));
    }
    for (name, text) in [
        ("HDR of 10¹²", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1000000 +X 1000000\n\x02\x02\x01\x01"),
        ("HDR cut off", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 64 +X 64\n"),
        ("HDR without a size", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n"),
    ] {
        cases.extend(everywhere(name, "i.hdr", text.as_bytes(), Refused("i.hdr")));
    }
    cases
}

/// A small float picture of one value.
pub fn pfm(value: f32) -> Vec<u8> {
    bytes(FileKind::Pfm, &uniform(2, value))
}
