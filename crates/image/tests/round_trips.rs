//! Written pictures are read back unchanged, the same bytes every time, and files appear whole or not at all.
#![expect(clippy::print_stdout, reason = "a skipped test says so")]

use steradian_image::{
    Compression, Error, FileKind, Image, Limits, Precision, TexelData, Texels, Value, Window, WriteOptions, encode,
    read, read_bytes, read_texels_bytes, tone::Tone, write,
};

/// A picture of smooth and random parts with values from 2⁻¹⁰ to 2⁹.
fn picture(width: usize, height: usize) -> Image {
    let mut rng = steradian_math::hash::HashRng::new(11);
    let pixels: Vec<[f32; 3]> = (0..width * height)
        .map(|i| {
            if i % width < width / 2 {
                [0.25, 1.0, i as f32 / 64.0]
            } else {
                [0; 3].map(|_| (rng.next_f32() * 19.0 - 10.0).exp2())
            }
        })
        .collect();
    Image::from_rgb(width, height, &pixels).unwrap()
}

fn again(kind: FileKind, image: &Image, options: &WriteOptions) -> Image {
    let bytes = encode(kind, image, options).unwrap();
    assert_eq!(bytes, encode(kind, image, options).unwrap(), "{kind} is not deterministic");
    read_bytes(&bytes, None, &Limits::default()).unwrap()
}

#[test]
fn exr_keeps_every_bit() {
    for (width, height) in [(1, 1), (3, 5), (37, 41), (64, 300)] {
        let mut image = picture(width, height);
        let odd: Vec<f32> = (0..width * height)
            .map(|i| [f32::NAN, f32::INFINITY, -f32::INFINITY, -0.0, f32::MIN_POSITIVE / 4.0, f32::MAX, 1e-30][i % 7])
            .collect();
        image.push("Z", odd).unwrap();
        image.push_layer("albedo", ["R", "G", "B"], &vec![[0.1, 0.2, 0.3]; width * height]).unwrap();
        for compression in [Compression::None, Compression::Zip, Compression::Piz] {
            let back =
                again(FileKind::Exr, &image, &WriteOptions { exr_compression: compression, ..WriteOptions::default() });
            assert_eq!(back.channels().len(), 7);
            for channel in image.channels() {
                let bits = |data: &[f32]| data.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
                assert_eq!(
                    bits(back.channel(&channel.name).unwrap()),
                    bits(&channel.data),
                    "{compression:?} {}",
                    channel.name
                );
            }
        }
    }
}

#[test]
fn exr_halves() {
    let mut image = picture(16, 16);
    image.channel_mut("R").unwrap()[0] = 1e9;
    image.push("Z", vec![100_000.5; 256]).unwrap();
    let options = WriteOptions { exr_precision: Precision::Half, ..WriteOptions::default() };
    let back = again(FileKind::Exr, &image, &options);
    assert_eq!(back.channel("R").unwrap()[0], 65504.0);
    assert_eq!(back.channel("Z").unwrap()[0], 100_000.5);
    for (a, b) in image.to_rgb().unwrap().iter().zip(back.to_rgb().unwrap()).skip(1) {
        assert!(a.iter().zip(b).all(|(x, y)| (x - y).abs() <= x / 2048.0));
    }
    let mut grey = Image::new(2, 1);
    grey.push("Y", vec![0.5, 2.0]).unwrap();
    let bytes = encode(FileKind::Exr, &grey, &options).unwrap();
    let texels = read_texels_bytes(&bytes, None, &Limits::default()).unwrap();
    assert!(texels.channels == 1 && matches!(texels.data, TexelData::F16(_)));
}

#[test]
fn exr_metadata_and_windows() {
    let mut image = picture(8, 4);
    image.offset = [-3, 7];
    image.frame = Some(Window { min: [-10, 0], max: [50, 20] });
    let entries = [
        ("software", Value::Text("Steradian".into())),
        ("samplesPerPixel", Value::Int(64)),
        ("renderTimeSeconds", Value::Float(1.5)),
        ("worldToCamera", Value::Matrix(std::array::from_fn(|i| i as f32))),
        ("steradian:scene", Value::Text("Küche – Ω".into())),
        ("a", Value::Int(-1)),
        ("another", Value::Float(-0.5)),
        ("a name of more than thirty-one characters", Value::Int(31)),
    ];
    for (name, value) in entries.clone() {
        image.metadata.set(name, value);
    }
    let back = again(FileKind::Exr, &image, &WriteOptions::default());
    assert_eq!((back.offset, back.frame), (image.offset, image.frame));
    for (name, value) in &entries {
        assert_eq!(back.metadata.get(name), Some(value));
    }
    assert_eq!(
        back.metadata.get("chromaticities"),
        Some(&Value::Text("0.64 0.33 0.3 0.6 0.15 0.06 0.3127 0.329".into()))
    );
    // What was read can be written again, with the same result.
    let third = again(FileKind::Exr, &back, &WriteOptions::default());
    assert_eq!(third, back);
    image.metadata.set("tiles", Value::Int(1));
    assert!(matches!(encode(FileKind::Exr, &image, &WriteOptions::default()), Err(Error::Unsupported { .. })));
}

/// Colours of other primaries are brought to Rec.709, of all layers that hold colours; texels when they are asked to,
/// in their precision, since they may be numbers.
#[test]
fn colours_of_other_primaries_become_rec709() {
    let acescg = [0.5405, 0.1062, 0.0665];
    let mut image = Image::from_rgb(1, 1, &[acescg]).unwrap();
    image.push_layer("diffuse", ["R", "G", "B"], &[acescg]).unwrap();
    image.push_layer("N", ["R", "G", "B"], &[acescg]).unwrap();
    let primaries = "0.713 0.293 0.165 0.83 0.128 0.044 0.32168 0.33767";
    image.metadata.set_text("chromaticities", primaries);
    let is_red = |c: [f32; 3]| c.iter().zip([0.85, 0.05, 0.05]).all(|(a, b)| (a - b).abs() < 1e-3);
    for exr_precision in [Precision::Half, Precision::Float] {
        let bytes = encode(FileKind::Exr, &image, &WriteOptions { exr_precision, ..Default::default() }).unwrap();
        let back = read_bytes(&bytes, None, &Limits::default()).unwrap();
        assert!(is_red(back.rgb().unwrap().at(0)) && is_red(back.layer_rgb("diffuse").unwrap().at(0)));
        let normal = back.layer_rgb("N").unwrap().at(0);
        assert!(normal.iter().zip(acescg).all(|(a, b)| (a - b).abs() < 1e-3), "{normal:?}");
        // What is written again is of Rec.709, and tells what it was.
        assert_eq!(again(FileKind::Exr, &back, &WriteOptions::default()), back);
        assert_eq!(back.metadata.get("sourceChromaticities"), Some(&Value::Text(primaries.into())));

        let mut texels = read_texels_bytes(&bytes, None, &Limits::default()).unwrap();
        let color = |t: &Texels| [0, 1, 2].map(|c| t.linear(0, 0, c));
        assert!((color(&texels)[0] - 0.5405).abs() < 1e-3);
        texels.to_rec709();
        assert!(is_red(color(&texels)), "{:?}", texels.data);
        assert_eq!(matches!(texels.data, TexelData::F16(_)), exr_precision == Precision::Half);
    }
    // Primaries on one line are not converted, which is told.
    image.metadata.set_text("chromaticities", "0.3 0.3 0.4 0.4 0.5 0.5 0.3127 0.329");
    let back = again(FileKind::Exr, &image, &WriteOptions::default());
    assert_eq!(back.rgb().unwrap().at(0), acescg);
    assert!(back.metadata.notes[0].contains("span no gamut"), "{:?}", back.metadata.notes);
}

/// PNG keeps numbers as texts; those that EXR has as numbers are numbers again.
#[test]
fn numbers_come_back_from_texts() {
    let mut image = picture(2, 2);
    image.metadata.set_text("whiteLuminance", "72983.26");
    image.metadata.set_text("software", "7");
    let png = again(FileKind::Png, &image, &WriteOptions::default());
    let back = again(FileKind::Exr, &png, &WriteOptions::default());
    assert_eq!(back.metadata.get("whiteLuminance"), Some(&Value::Float(72_983.26)));
    image.metadata.set_text("whiteLuminance", "bright");
    assert!(encode(FileKind::Exr, &image, &WriteOptions::default()).is_err());
}

#[test]
fn pfm_keeps_every_bit() {
    for (width, height) in [(1, 1), (5, 3)] {
        let image = picture(width, height);
        assert_eq!(again(FileKind::Pfm, &image, &WriteOptions::default()), image);
        let mut grey = Image::new(width, height);
        grey.push("Y", (0..width * height).map(|i| i as f32 - 2.5).collect()).unwrap();
        assert_eq!(again(FileKind::Pfm, &grey, &WriteOptions::default()), grey);
    }
}

#[test]
fn pfm_of_both_byte_orders_from_the_bottom() {
    let mut big = b"Pf\n1 2\n1.0\n".to_vec();
    let mut little = b"Pf 1 2\r-1.0 ".to_vec();
    for value in [3.0f32, 4.0] {
        big.extend(value.to_be_bytes());
        little.extend(value.to_le_bytes());
    }
    for bytes in [big, little] {
        let image = read_bytes(&bytes, None, &Limits::default()).unwrap();
        assert_eq!(image.channel("Y").unwrap(), [4.0, 3.0]);
    }
    let dos = [&b"Pf\r\n1 1\r\n-1.0\r\n"[..], &1.5f32.to_le_bytes()].concat();
    assert_eq!(read_bytes(&dos, None, &Limits::default()).unwrap().channel("Y").unwrap(), [1.5]);
    let scaled = [&b"Pf\n1 1\n-2.0\n"[..], &1.5f32.to_le_bytes()].concat();
    assert_eq!(read_bytes(&scaled, None, &Limits::default()).unwrap().channel("Y").unwrap(), [3.0]);
}

#[test]
fn hdr_is_within_half_a_step() {
    for (width, height) in [(1, 1), (7, 3), (8, 2), (200, 9), (513, 2)] {
        let image = picture(width, height);
        let back = again(FileKind::Hdr, &image, &WriteOptions::default());
        for (a, b) in image.to_rgb().unwrap().iter().zip(back.to_rgb().unwrap()) {
            let largest = a[0].max(a[1]).max(a[2]);
            // Eight bits below the shared exponent.
            assert!(a.iter().zip(b).all(|(x, y)| (x - y).abs() <= largest / 255.0), "{a:?} {b:?}");
        }
    }
    let odd = [[f32::NAN, -1.0, 1.0], [f32::INFINITY, 0.0, 0.0], [1e-40, 0.0, 0.0], [f32::MAX, 1e-10, 0.0]];
    let back = again(FileKind::Hdr, &Image::from_rgb(4, 1, &odd).unwrap(), &WriteOptions::default()).to_rgb().unwrap();
    assert_eq!(back[0], [0.0, 0.0, 1.0]);
    assert!(back.as_flattened().iter().all(|v| v.is_finite() && *v >= 0.0) && back[1][0] > 1e38 && back[3][0] > 1e38);
}

#[test]
fn hdr_orientations() {
    // One bright pixel at the top left of a 2 wide, 3 high picture, stored in each of the eight orders.
    let pixel = |bright: bool| if bright { [128, 128, 128, 129] } else { [0u8; 4] };
    for (line, first) in [
        ("-Y 3 +X 2", 0),
        ("-Y 3 -X 2", 1),
        ("+Y 3 +X 2", 4),
        ("+Y 3 -X 2", 5),
        ("+X 2 -Y 3", 0),
        ("+X 2 +Y 3", 2),
        ("-X 2 -Y 3", 3),
        ("-X 2 +Y 3", 5),
    ] {
        let mut bytes = format!("#?RGBE\nFORMAT=32-bit_rle_rgbe\nEXPOSURE=2\n\n{line}\n").into_bytes();
        (0..6).for_each(|i| bytes.extend(pixel(i == first)));
        let image = read_bytes(&bytes, None, &Limits::default()).unwrap();
        assert_eq!((image.width(), image.height()), (2, 3), "{line}");
        let expected = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        assert_eq!(image.channel("R").unwrap(), expected, "{line}");
        assert_eq!(image.metadata.get("EXPOSURE"), Some(&Value::Float(2.0)));
    }
}

#[test]
fn hdr_old_runs_count_in_base_256() {
    let mut bytes = b"#?RADIANCE\n\n-Y 1 +X 300\n".to_vec();
    // One pixel, 43 repeats and then 1 · 256 more.
    bytes.extend([128, 64, 32, 129, 1, 1, 1, 43, 1, 1, 1, 1]);
    let image = read_bytes(&bytes, None, &Limits::default()).unwrap();
    assert!(image.to_rgb().unwrap().iter().all(|p| *p == [1.0, 0.5, 0.25]));
}

#[test]
fn ppm_with_maximum_is_within_half_a_step() {
    let image = picture(20, 10);
    let max = image.to_rgb().unwrap().into_iter().flatten().fold(0.0, f32::max);
    for (plain, sixteen_bit) in [(false, false), (true, false), (false, true), (true, true)] {
        let options = WriteOptions { ppm_plain: plain, sixteen_bit, ..WriteOptions::default() };
        let back = again(FileKind::Pnm, &image, &options);
        let half_step = max / if sixteen_bit { 65535.0 } else { 255.0 } / 2.0;
        for (a, b) in image.to_rgb().unwrap().iter().zip(back.to_rgb().unwrap()) {
            assert!(a.iter().zip(b).all(|(x, y)| (x - y).abs() <= half_step * 1.0001), "{a:?} {b:?}");
        }
    }
}

#[test]
fn ppm_from_the_lab() {
    let text = b"P3\n# feep.ppm\n#MAX=30\n4 1\n15\n0 0 0  15 0 15 # pink\n 7 7 7\n1 2 3";
    let image = read_bytes(text, None, &Limits::default()).unwrap();
    assert_eq!(image.to_rgb().unwrap(), [[0.0; 3], [30.0, 0.0, 30.0], [14.0; 3], [2.0, 4.0, 6.0]]);
    let display = b"P5 2 1 4 \x00\x04";
    let texels = read_texels_bytes(display, None, &Limits::default()).unwrap();
    assert_eq!(texels.data, TexelData::U8(vec![0, 255]));
    assert!(read_bytes(b"P5 1 1 4 \x05", None, &Limits::default()).is_err());
}

#[test]
fn png_codes_are_the_nearest() {
    let mut image = Image::from_rgb(2, 1, &[[0.5, 0.18, 0.0], [1.0, 2.0, f32::NAN]]).unwrap();
    image.push("A", vec![0.5, 1.0]).unwrap();
    image.metadata.set_text("Software", "Steradian");
    image.metadata.set_text("Title", "Küche");
    image.metadata.set("samplesPerPixel", Value::Int(4));
    let bytes = encode(FileKind::Png, &image, &WriteOptions::default()).unwrap();
    let texels = read_texels_bytes(&bytes, None, &Limits::default()).unwrap();
    assert_eq!(texels.data, TexelData::U8(vec![188, 118, 0, 128, 255, 255, 0, 255]));
    assert_eq!(texels.metadata.get("Title"), Some(&Value::Text("Küche".into())));
    assert_eq!(texels.metadata.get("samplesPerPixel"), Some(&Value::Text("4".into())));
    let sixteen = WriteOptions { sixteen_bit: true, ..WriteOptions::default() };
    let back = again(FileKind::Png, &image, &sixteen);
    assert!((back.channel("R").unwrap()[0] - 0.5).abs() < 2e-5 && (back.channel("A").unwrap()[0] - 0.5).abs() < 1e-5);
    // A file that was read is written back to the same codes.
    let again = encode(FileKind::Png, &texels.to_image().unwrap(), &WriteOptions::default()).unwrap();
    assert_eq!(read_texels_bytes(&again, None, &Limits::default()).unwrap().data, texels.data);
}

#[test]
fn jpeg_is_near() {
    let image = Image::from_rgb(32, 32, &[[0.5, 0.2, 0.1]; 1024]).unwrap();
    let back = again(FileKind::Jpeg, &image, &WriteOptions { jpeg_quality: 95, ..WriteOptions::default() });
    for p in back.to_rgb().unwrap() {
        assert!(p.iter().zip([0.5, 0.2, 0.1]).all(|(a, b)| (a - b).abs() < 0.02), "{p:?}");
    }
}

#[test]
fn tone_and_exposure_reach_the_file() {
    let image = Image::from_rgb(1, 1, &[[0.25; 3]]).unwrap();
    let tone = Tone::parse("clamp:exposure=1").unwrap();
    let bytes = encode(FileKind::Png, &image, &WriteOptions { tone, ..WriteOptions::default() }).unwrap();
    assert_eq!(read_texels_bytes(&bytes, None, &Limits::default()).unwrap().data, TexelData::U8(vec![128; 3]));
}

#[test]
fn files_appear_whole_or_not_at_all() {
    let folder = tempfile::tempdir().unwrap();
    let entries = || std::fs::read_dir(folder.path()).unwrap().count();
    let image = picture(16, 16);
    for name in ["a.exr", "a.png", "a.jpg", "a.hdr", "a.pfm", "a.ppm", "a.EXR"] {
        write(&folder.path().join(name), &image, &WriteOptions::default()).unwrap();
        read(&folder.path().join(name), &Limits::default()).unwrap();
    }
    assert_eq!(entries(), 7);
    // Overwriting keeps to the name.
    write(&folder.path().join("a.exr"), &picture(4, 4), &WriteOptions::default()).unwrap();
    assert_eq!(read(&folder.path().join("a.exr"), &Limits::default()).unwrap().width(), 4);

    let missing = folder.path().join("missing").join("a.exr");
    let error = write(&missing, &image, &WriteOptions::default()).unwrap_err().to_string();
    assert!(error.contains("missing") && error.contains("a.exr"), "{error}");
    let unknown = folder.path().join("a.gif");
    assert!(matches!(write(&unknown, &image, &WriteOptions::default()), Err(Error::File { .. })));
    std::fs::create_dir(folder.path().join("d.exr")).unwrap();
    assert!(write(&folder.path().join("d.exr"), &image, &WriteOptions::default()).is_err());
    assert_eq!(entries(), 8);
    let error = read(&folder.path().join("none.exr"), &Limits::default()).unwrap_err().to_string();
    assert!(error.contains("none.exr"), "{error}");
}

#[cfg(target_os = "linux")]
#[test]
fn full_disk_is_an_error() {
    if !std::path::Path::new("/dev/full").exists() {
        println!("skipped: no /dev/full");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let link = folder.path().join("full.exr");
    std::os::unix::fs::symlink("/dev/full", &link).unwrap();
    let error = write(&link, &picture(64, 64), &WriteOptions::default()).unwrap_err().to_string();
    assert!(error.contains("full.exr") && error.contains("cannot write"), "{error}");
}

#[cfg(unix)]
#[test]
fn permissions_are_those_of_a_new_file() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let usual = folder.path().join("usual");
    std::fs::write(&usual, b"x").unwrap();
    let ours = folder.path().join("a.pfm");
    write(&ours, &picture(2, 2), &WriteOptions::default()).unwrap();
    let mode = |p: &std::path::Path| std::fs::metadata(p).unwrap().permissions().mode();
    assert_eq!(mode(&ours), mode(&usual));
    std::fs::set_permissions(&ours, std::fs::Permissions::from_mode(0o444)).unwrap();
    assert!(write(&ours, &picture(2, 2), &WriteOptions::default()).is_err());
}
