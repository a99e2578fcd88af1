use crate::{Error, Limits, read};
use std::io::Write;

const LIMITS: Limits = Limits { voxels: 1 << 16, bytes: 1 << 20 };
const ZIP: u32 = 1;
const ACTIVE_ONLY: u32 = 2;

fn text(b: &mut Vec<u8>, text: &str) {
    b.extend((text.len() as u32).to_le_bytes());
    b.extend(text.as_bytes());
}

/// A list of numbers in the packing of a grid.
fn list(b: &mut Vec<u8>, packing: u32, is_half: bool, values: &[f32]) {
    let bytes =
        |v: &f32| if is_half { half::f16::from_f32(*v).to_le_bytes().to_vec() } else { v.to_le_bytes().to_vec() };
    let plain: Vec<u8> = values.iter().flat_map(bytes).collect();
    if packing & ZIP == 0 || is_half && plain.is_empty() {
        return b.extend(plain);
    }
    let mut zip = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::fast());
    zip.write_all(&plain).unwrap();
    let zip = zip.finish().unwrap();
    let (length, list) = if zip.len() < plain.len() { (zip.len() as i64, zip) } else { (-(plain.len() as i64), plain) };
    b.extend(length.to_le_bytes());
    b.extend(list);
}

/// A file of a grid with an active tile of 3 at (0, 0, 0), and a leaf at (8, 0, 0) whose even voxels are active and
/// their own places; the odd ones are −1 in the lower half along x and 2 in the upper one.
fn file(packing: u32, is_half: bool) -> Vec<u8> {
    let mut b = b" BDV\0\0\0\0".to_vec();
    [224_u32, 10, 0].iter().for_each(|v| b.extend(v.to_le_bytes()));
    b.push(1);
    b.extend([b'0'; 36]);
    [0_u32, 1].iter().for_each(|v| b.extend(v.to_le_bytes()));
    text(&mut b, "density\u{1e}0");
    text(&mut b, if is_half { "Tree_float_5_4_3_HalfFloat" } else { "Tree_float_5_4_3" });
    text(&mut b, "");
    let at = b.len() as u64 + 24;
    [at, at, 1 << 40].iter().for_each(|v| b.extend(v.to_le_bytes()));
    // Packing, class, and x' = y/2 + 7, y' = x, z' = 2 z, whose rows are what axes become.
    [packing, 1].iter().for_each(|v| b.extend(v.to_le_bytes()));
    ["class", "string", "fog volume", "AffineMap"].iter().for_each(|t| text(&mut b, t));
    let matrix = [0.0, 1.0, 0.0, 0.0, 0.5, 0.0, 0.0, 0.0, 0.0, 0.0, 2.0, 0.0, 7.0, 0.0, 0.0, 1.0_f64];
    matrix.iter().for_each(|v| b.extend(v.to_le_bytes()));
    // One buffer, a background of 0, no tile and one child at the origin.
    [1_u32, 0, 0, 1, 0, 0, 0].iter().for_each(|v| b.extend(v.to_le_bytes()));
    let mask = |b: &mut Vec<u8>, size: usize, first: u8| b.extend((0..size).map(|i| if i == 0 { first } else { 0 }));
    mask(&mut b, 4096, 1);
    mask(&mut b, 4096, 0);
    b.push(0);
    list(&mut b, packing, is_half, if packing & ACTIVE_ONLY == 0 { &[0.0; 32768] } else { &[] });
    // The second child along x of 16³ is the leaf.
    b.extend((0..512).map(|i| u8::from(i == 32)));
    mask(&mut b, 512, 1);
    b.push(0);
    let mut tiles = vec![0.0; if packing & ACTIVE_ONLY == 0 { 4096 } else { 1 }];
    tiles[0] = 3.0;
    list(&mut b, packing, is_half, &tiles);
    b.extend([0x55; 64]);
    // Values of the leaf, of two inactive numbers and a mask that chooses.
    b.extend([0x55; 64]);
    b.push(5);
    [-1.0_f32, 2.0].iter().for_each(|v| b.extend(v.to_le_bytes()));
    b.extend((0..64).map(|i| if i < 32 { 0 } else { 0xff }));
    let all = (0..512).map(|n| if n % 2 == 0 { n as f32 } else { [-1.0, 2.0][n / 256] });
    let listed: Vec<f32> =
        all.enumerate().filter(|(n, _)| packing & ACTIVE_ONLY == 0 || n % 2 == 0).map(|p| p.1).collect();
    list(&mut b, packing, is_half, &listed);
    b
}

#[test]
fn numbers_and_places_are_read() {
    for packing in 0..4 {
        for is_half in [false, true] {
            let volume = read(&file(packing, is_half), "density", &LIMITS).unwrap();
            // The last voxel of the leaf along z is inactive.
            assert_eq!((volume.low, volume.size), ([-1; 3], [18, 10, 10]));
            let at = |x: usize, y: usize, z: usize| volume.values[((z + 1) * 10 + y + 1) * 18 + x + 1];
            assert_eq!([at(0, 0, 0), at(7, 7, 7), at(8, 0, 0), at(9, 2, 2)], [3.0, 3.0, 0.0, 82.0]);
            assert_eq!([at(9, 2, 3), at(15, 7, 6), at(15, 7, 5), at(16, 0, 0)], [-1.0, 510.0, 2.0, 0.0]);
            let map = [[0.0, 0.5, 0.0, 7.0], [1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 2.0, 0.0]];
            assert_eq!(volume.world_from_index, map);
        }
    }
}

#[test]
fn what_is_not_read_is_named() {
    let plain = file(ACTIVE_ONLY, false);
    let says = |from: &str, to: &str| {
        let at = plain.windows(from.len()).position(|w| w == from.as_bytes()).unwrap();
        let b = [&plain[..at], to.as_bytes(), &plain[at + from.len()..]].concat();
        read(&b, "", &LIMITS).unwrap_err().to_string()
    };
    assert!(says("\u{a}\0\0\0fog volume", "\u{9}\0\0\0level set").contains("level set"));
    assert!(says("Tree_float", "Tree_vec3s").contains("Tree_vec3s_5_4_3"));
    assert!(says("AffineMap", "FrustumMp").contains("FrustumMp"));
    let mut old = plain.clone();
    old[8] = 221;
    assert!(read(&old, "", &LIMITS).unwrap_err().to_string().contains("version 221"));
    assert_eq!(
        read(&plain, "heat", &LIMITS),
        Err(Error::NoGrid { name: "heat".into(), there: vec!["density".into()] })
    );
}

/// Every cut and every byte that is another gives a grid or an error, in bounded time and memory.
#[test]
fn damaged_files_are_refused_or_read() {
    let whole = file(ACTIVE_ONLY | ZIP, true);
    for end in (0..whole.len()).filter(|end| *end < 800 || *end > whole.len() - 1500 || end % 64 == 0) {
        assert!(read(&whole[..end], "density", &LIMITS).is_err(), "{end}");
    }
    for at in (0..whole.len()).step_by(3).filter(|at| *at < 600 || *at > whole.len() - 900) {
        for v in [0x01, 0x80, 0xff] {
            let mut b = whole.clone();
            b[at] ^= v;
            let _ = read(&b, "density", &LIMITS);
        }
    }
}
