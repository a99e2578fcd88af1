//! Every picture of the shared assets is read, or refused by name.

use half::f16;
use std::path::{Path, PathBuf};
use steradian_image::{
    Error, FileKind, Image, Limits, TexelData, Value, WriteOptions, encode, metrics, read, read_bytes, read_texels,
};

/// The folder with real pictures, where there is one.
fn assets(sub: &str) -> Option<PathBuf> {
    steradian_testkit::asset(sub)
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_none_or(|e| e != "rst" && e != "txt" && e != "md") {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

fn load(path: &Path) -> Image {
    read(path, &Limits::default()).unwrap_or_else(|e| panic!("{e}"))
}

#[test]
fn everything_is_read_or_refused_by_name() {
    let mut count = 0;
    for sub in ["png", "exr", "image", "envmap"] {
        let Some(folder) = assets(sub) else { return };
        for path in files(&folder) {
            let deep = path.components().any(|c| c.as_os_str() == "deep-multipart");
            match read(&path, &Limits::default()) {
                Ok(image) => {
                    assert!(!deep && image.pixel_count() > 0 && !image.channels().is_empty(), "{}", path.display());
                    let again =
                        encode(FileKind::Exr, &image, &WriteOptions::default()).unwrap_or_else(|e| panic!("{e}"));
                    let again = read_bytes(&again, None, &Limits::default()).unwrap();
                    assert_eq!(again.channels().len(), image.channels().len());
                    let texels = read_texels(&path, &Limits::default());
                    match texels {
                        Ok(mut texels) => {
                            // Colours of other primaries are converted where they are used as colours.
                            texels.to_rec709();
                            assert_eq!((texels.width, texels.height), (image.width(), image.height()));
                            let rgb = image.rgb().unwrap();
                            let last = image.pixel_count() - 1;
                            let seen = texels.linear(texels.width - 1, texels.height - 1, 0);
                            assert!(seen == rgb.at(last)[0] || seen.is_nan(), "{}", path.display());
                        }
                        Err(e) => assert!(image.rgb().is_none(), "{e}"),
                    }
                }
                Err(Error::File { error, .. }) => match *error {
                    Error::Unsupported { what, .. } => assert!(deep, "{}: {what}", path.display()),
                    // This one is cut off in its first tile.
                    Error::Malformed { .. } if path.ends_with("openexr-src/tiled.exr") => {}
                    error => panic!("{}: {error}", path.display()),
                },
                Err(error) => panic!("{}: {error}", path.display()),
            }
            count += 1;
        }
    }
    assert!(count > 100);
}

/// RGBA of each pixel in 16 bits: grey is repeated, and pixels without alpha are opaque.
fn rgba16(path: &Path) -> (usize, usize, Vec<u8>) {
    let texels = read_texels(path, &Limits::default()).unwrap_or_else(|e| panic!("{e}"));
    let code = |i: usize| ((texels.data.stored(i) * 65535.0).round() as u16).to_be_bytes();
    let mut bytes = Vec::with_capacity(texels.width * texels.height * 8);
    for first in (0..texels.data.len()).step_by(texels.channels) {
        for lane in 0..3 {
            bytes.extend(code(first + if texels.channels < 3 { 0 } else { lane }));
        }
        bytes.extend(texels.alpha().map_or([255; 2], |a| code(first + a)));
    }
    (texels.width, texels.height, bytes)
}

fn checksum(bytes: &[u8]) -> String {
    let mut crc = flate2::Crc::new();
    crc.update(bytes);
    format!("{:08x}", crc.sum())
}

/// Every picture of PngSuite, the pixmaps, and what OpenEXR files keep without loss, against what the libraries of
/// these formats read: `decoded.txt` has the checksums.
#[test]
fn pictures_decode_to_their_truths() {
    let Some(folder) = assets("png") else { return };
    let folder = folder.parent().unwrap();
    let mut known = std::collections::BTreeSet::new();
    for line in include_str!("decoded.txt").lines().filter(|l| !l.starts_with('#')) {
        let mut words = line.split(' ');
        let [name, width, height] = std::array::from_fn(|_| words.next().unwrap());
        let path = folder.join(name);
        let size = |w: usize, h: usize| assert_eq!([w, h].map(|n| n.to_string()), [width, height], "{name}");
        if name.ends_with(".exr") {
            let image = load(&path);
            size(image.width(), image.height());
            for (channel, truth) in words.map(|w| w.split_once(':').unwrap()) {
                let plain = |v: &f32| if v.is_nan() { 0x7fc0_0000 } else { v.to_bits() }.to_le_bytes();
                let data: Vec<u8> = image
                    .channel(channel)
                    .unwrap_or_else(|| panic!("{name}: no channel {channel}"))
                    .iter()
                    .flat_map(plain)
                    .collect();
                assert_eq!(checksum(&data), truth, "{name} {channel}");
            }
        } else {
            let (w, h, data) = rgba16(&path);
            size(w, h);
            assert_eq!(checksum(&data), words.next().unwrap(), "{name}");
        }
        known.insert(path);
    }
    // None of the two suites is left out; of OpenEXR the lossy, subsampled and broken ones have tests of their own.
    for path in ["png", "image/pnm"].into_iter().flat_map(|sub| files(&folder.join(sub))) {
        assert!(known.contains(&path), "{} has no truth", path.display());
    }
}

#[test]
fn pictures_of_the_scenes_are_read() {
    let mut kinds = std::collections::BTreeMap::new();
    for sub in ["pbrt", "mitsuba", "gltf", "obj"] {
        let Some(folder) = assets(sub) else { return };
        for path in files(&folder) {
            let Some(kind) = FileKind::from_extension(&path) else { continue };
            let texels = read_texels(&path, &Limits::default()).unwrap_or_else(|e| panic!("{e}"));
            assert_eq!(texels.data.len(), texels.width * texels.height * texels.channels);
            *kinds.entry(kind.to_string()).or_insert(0) += 1;
        }
    }
    for kind in ["EXR", "PNG", "JPEG", "TGA", "BMP", "PFM"] {
        assert!(kinds.get(kind).is_some_and(|&n| n > 0), "no {kind} in {kinds:?}");
    }
}

#[test]
fn mitsuba_references_pass_their_own_test() {
    let Some(folder) = assets("mitsuba/tests/scenes") else { return };
    let mut count = 0;
    for variance in files(&folder).iter().filter(|p| p.to_string_lossy().ends_with("_rgb_var.exr")) {
        let mean = PathBuf::from(variance.to_string_lossy().replace("_var.exr", ".exr"));
        let (mean, variance) = (load(&mean), load(variance));
        let same = metrics::z_test(&mean, &mean, &variance, 64.0).unwrap();
        assert!(same.passes && same.min_p == 1.0);
        let mut brighter = mean.clone();
        brighter.channel_mut("G").unwrap().iter_mut().for_each(|v| *v = *v * 1.5 + 0.1);
        assert!(!metrics::z_test(&brighter, &mean, &variance, 1e4).unwrap().passes);
        count += 1;
    }
    assert!(count > 3);
}

/// Largest difference over all channels, relative to the magnitude where that is above 1.
fn difference(a: &Image, b: &Image) -> f32 {
    assert_eq!((a.width(), a.height(), a.channel_names()), (b.width(), b.height(), b.channel_names()));
    let pairs = a.channels().iter().zip(b.channels()).flat_map(|(a, b)| a.data.iter().zip(&b.data));
    pairs
        .filter(|(x, y)| x.to_bits() != y.to_bits() && !(x.is_nan() && y.is_nan()))
        .map(|(x, y)| (x - y).abs() / y.abs().max(1.0))
        .fold(0.0, f32::max)
}

#[test]
fn lossless_codecs_agree_bit_for_bit() {
    let Some(folder) = assets("exr/codec-truth-f16") else { return };
    let truth = load(&folder.join("uncompressed.exr"));
    // PXR24 keeps halves exactly.
    for codec in ["rle", "zip", "zips", "piz", "pxr24"] {
        assert_eq!(difference(&load(&folder.join(format!("{codec}.exr"))), &truth), 0.0, "{codec}");
    }
}

#[test]
fn lossy_codecs_give_the_true_pixels() {
    let Some(folder) = assets("exr/codec-truth-f16") else { return };
    for codec in ["b44", "b44a", "pxr24", "dwaa", "dwab"] {
        let truth = load(&folder.join(format!("decompressed_{codec}.exr")));
        let seen = difference(&load(&folder.join(format!("{codec}.exr"))), &truth);
        // The cosine transform of DWA may round its last half bit differently.
        let tolerance = if codec.starts_with("dwa") { 4e-3 } else { 0.0 };
        assert!(seen <= tolerance, "{codec}: {seen}");
    }
}

#[test]
fn dwa_colour_transforms_give_the_true_pixels() {
    let Some(folder) = assets("exr/dwa_csc") else { return };
    for name in ["rgb_plus_y_dwaa", "y_ry_by_dwaa"] {
        let truth = load(&folder.join(format!("{name}_ground_truth.exr")));
        let seen = difference(&load(&folder.join(format!("{name}.exr"))), &truth);
        assert!(seen <= 4e-3, "{name}: {seen}");
    }
}

#[test]
fn line_orders_and_wrong_types_do_not_matter() {
    let Some(folder) = assets("exr/openexr-src") else { return };
    let increasing = load(&folder.join("lineOrder_increasing.exr"));
    assert_eq!(difference(&load(&folder.join("lineOrder_decreasing.exr")), &increasing), 0.0);
    // A tile flag on a scan-line image and the reverse, and headers full of unusual attributes.
    for (name, channels) in [
        ("scanline_with_tiledimage_type.exr", "A, B, G, R"),
        ("tiled_with_scanlineimage_type.exr", "A, B, G, R"),
        ("v1.7.test.interleaved.exr", "R, Z"),
        ("v1.7.test.planar.exr", "B, G, R, Z"),
    ] {
        assert_eq!(load(&folder.join(name)).channel_names(), channels, "{name}");
    }
    let attributes = load(&folder.join("v1.7.test.planar.exr")).metadata;
    assert_eq!(attributes.get("a4"), Some(&Value::Int(17)));
    assert_eq!(attributes.get("a11"), Some(&Value::Text("37.5 38.5 39.5".into())));
}

#[test]
fn all_half_values_come_through() {
    let Some(folder) = assets("exr/TestImages") else { return };
    let texels = read_texels(&folder.join("AllHalfValues.exr"), &Limits::default()).unwrap();
    let TexelData::F16(values) = &texels.data else { panic!("halves expected") };
    let mut seen = vec![false; 65536];
    values.iter().for_each(|v| seen[usize::from(v.to_bits())] = true);
    assert!(seen.iter().all(|&s| s));
    let image = load(&folder.join("AllHalfValues.exr"));
    let bits = |v: f32| f16::from_f32(v);
    let red = image.channel("R").unwrap();
    for (v, half) in red.iter().zip(values.iter().step_by(texels.channels)) {
        assert!(bits(*v) == *half || v.is_nan() && half.is_nan());
    }
}

#[test]
fn nan_and_infinity_are_kept() {
    let Some(folder) = assets("exr/TestImages") else { return };
    let image = load(&folder.join("BrightRingsNanInf.exr"));
    let values = || image.channels().iter().flat_map(|c| &c.data);
    assert!(values().any(|v| v.is_nan()) && values().any(|v| v.is_infinite()));
}

#[test]
fn windows_are_reported() {
    let Some(folder) = assets("exr/DisplayWindow") else { return };
    let inside = load(&folder.join("t01.exr"));
    assert_eq!((inside.width(), inside.height(), inside.frame), (400, 300, None));
    let shifted = files(&folder).into_iter().map(|p| load(&p)).filter(|i| i.frame.is_some()).count();
    assert!(shifted >= 5, "{shifted}");
}

#[test]
fn luminance_chroma_matches_expected_colours() {
    let Some(folder) = assets("exr/Chromaticities") else { return };
    let rec709 = load(&folder.join("Rec709_YC.exr"));
    let rgb = rec709.to_rgb().unwrap();
    let mean = |lane: usize| rgb.iter().map(|p| f64::from(p[lane])).sum::<f64>() / rgb.len() as f64;
    // The same photograph in XYZ primaries, brought to Rec.709.
    let xyz = load(&folder.join("XYZ_YC.exr"));
    let xyz = xyz.to_rgb().unwrap();
    for lane in 0..3 {
        let converted = xyz.iter().map(|p| f64::from(p[lane])).sum::<f64>() / xyz.len() as f64;
        assert!((converted / mean(lane) - 1.0).abs() < 0.02, "lane {lane}: {converted} {}", mean(lane));
    }
}

#[test]
fn exr_and_hdr_of_one_picture_agree() {
    let Some(folder) = assets("image/exr-vs-hdr") else { return };
    let exr = load(&folder.join("overexposed gradient - data window equals display window.exr"));
    let hdr = load(&folder.join("overexposed gradient.hdr"));
    let (a, b) = (exr.to_rgb().unwrap(), hdr.to_rgb().unwrap());
    assert_eq!(a.len(), b.len());
    for (a, b) in a.iter().zip(&b) {
        let largest = a[0].max(a[1]).max(a[2]);
        // RGBE shares one exponent: half a step, or a whole one where the writer truncated.
        assert!(a.iter().zip(b).all(|(x, y)| (x - y).abs() <= largest / 100.0 + 1e-6), "{a:?} {b:?}");
    }
}

#[test]
fn png_colour_types_give_known_pixels() {
    let Some(folder) = assets("png/pngsuite") else { return };
    // Interlaced and plain versions hold the same picture, 16-bit samples stay 16 bit.
    for name in ["0g16", "2c16", "4a16", "6a16"] {
        let [plain, interlaced] = ["basn", "basi"]
            .map(|kind| read_texels(&folder.join(format!("16bit/{kind}{name}.png")), &Limits::default()).unwrap());
        assert!(matches!(plain.data, TexelData::U16(_)));
        assert_eq!(plain.data, interlaced.data, "{name}");
    }
    for name in ["0g01", "0g02", "0g04", "0g08", "2c08", "3p01", "3p02", "3p04", "3p08", "4a08", "6a08"] {
        let [plain, interlaced] = ["basn", "basi"]
            .map(|kind| read_texels(&folder.join(format!("primary/{kind}{name}.png")), &Limits::default()).unwrap());
        assert_eq!(plain.data, interlaced.data, "{name}");
    }
    let transparent = read_texels(&folder.join("primary/tbbn3p08.png"), &Limits::default()).unwrap();
    assert_eq!(transparent.channels, 4);
}

#[test]
fn old_run_lengths_decode() {
    let Some(folder) = assets("image/hdr") else { return };
    let image = load(&folder.join("old-rle.hdr"));
    assert!(image.to_rgb().unwrap().as_flattened().iter().all(|v| v.is_finite()));
}

/// Makes the checksums of a PNG file's chunks right again, so that damage reaches the decoder behind them.
fn repair_checksums(bytes: &mut [u8]) {
    if !bytes.starts_with(b"\x89PNG") {
        return;
    }
    let mut at = 8;
    while let Some(length) = bytes.get(at..at + 4) {
        let length = u32::from_be_bytes([length[0], length[1], length[2], length[3]]) as usize;
        let end = at + 8 + length;
        let Some(chunk) = bytes.get(at + 4..end).filter(|_| end + 4 <= bytes.len()) else { return };
        let mut crc = flate2::Crc::new();
        crc.update(chunk);
        bytes[end..end + 4].copy_from_slice(&crc.sum().to_be_bytes());
        at = end + 4;
    }
}

#[test]
fn mutations_never_panic() {
    let mut rng = steradian_math::hash::HashRng::new(3);
    let mut tried = 0;
    for sub in [
        "png/pngsuite/primary",
        "exr/codec-truth-f16",
        "exr/dwa_csc",
        "exr/openexr-src",
        "exr/MultiResolution",
        "image",
    ] {
        let Some(folder) = assets(sub) else { return };
        for path in files(&folder) {
            let bytes = std::fs::read(&path).unwrap();
            let rounds = if bytes.len() < 40_000 { 60 } else { 6 };
            for round in 0..rounds {
                let mut damaged = bytes.clone();
                let mut below = |n: usize| (rng.next_u64() % n.max(1) as u64) as usize;
                if round % 3 == 0 {
                    damaged.truncate(below(bytes.len()));
                } else {
                    // Headers are where sizes are: half of the flips go there.
                    let reach = if round % 2 == 0 { bytes.len().min(400) } else { bytes.len() };
                    for _ in 0..=round % 5 {
                        damaged[below(reach)] = below(256) as u8;
                    }
                    repair_checksums(&mut damaged);
                }
                if let Ok(image) = read_bytes(&damaged, Some(&path), &Limits { bytes: 1 << 28, ..Limits::default() }) {
                    assert!(image.channels().iter().all(|c| c.data.len() == image.pixel_count()));
                }
                tried += 1;
            }
        }
    }
    assert!(tried > 1000);
}
