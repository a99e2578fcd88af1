use crate::{Error, Limits, read};

const LIMITS: Limits = Limits { voxels: 1 << 16, bytes: 1 << 20 };
const ROOT: usize = 736;
const NODE: usize = 832;
const LOWER: usize = NODE + 270_400;
const LEAF: usize = LOWER + 33_856;

fn put(bytes: &mut [u8], at: usize, part: &[u8]) {
    bytes[at..at + part.len()].copy_from_slice(part);
}

/// A grid as it lies in memory: a leaf at (8, 0, 0) whose numbers are their own places, a tile of 3 at (0, 0, 0).
fn grid() -> Vec<u8> {
    let mut b = vec![0; LEAF + 2144];
    let size = b.len() as u64;
    put(&mut b, 0, b"NanoVDB1");
    put(&mut b, 16, &(32_u32 << 21).to_le_bytes());
    put(&mut b, 32, &size.to_le_bytes());
    put(&mut b, 40, b"density");
    // x' = y/2 + 7, y' = x, z' = 2 z.
    for (at, v) in [(392, 0.5_f64), (408, 1.0), (448, 2.0), (528, 7.0)] {
        put(&mut b, at, &v.to_le_bytes());
    }
    for (at, v) in [(632, 2_u32), (636, 1), (696, 64), (ROOT + 12, 15), (ROOT + 16, 7), (ROOT + 20, 7), (ROOT + 24, 1)]
    {
        put(&mut b, at, &v.to_le_bytes());
    }
    put(&mut b, ROOT + 72, &96_u64.to_le_bytes());
    put(&mut b, NODE + 4128, &[1]);
    put(&mut b, NODE + 8256, &270_400_u64.to_le_bytes());
    // The second child along x of 16 × 16 × 16.
    put(&mut b, LOWER + 544 + 32, &[1]);
    put(&mut b, LOWER + 1088, &3.0_f32.to_le_bytes());
    put(&mut b, LOWER + 1088 + 8 * 256, &33_856_u64.to_le_bytes());
    for n in 0..512 {
        put(&mut b, LEAF + 96 + 4 * n, &(n as f32).to_le_bytes());
    }
    b
}

/// A file with a grid of the name `first` before this one, packed by zlib.
fn zipped() -> Vec<u8> {
    use std::io::Write;
    let body = grid();
    let mut zip = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::fast());
    zip.write_all(&body).unwrap();
    let zip = zip.finish().unwrap();
    let mut file = b"NanoVDB2".to_vec();
    file.extend((32_u32 << 21).to_le_bytes());
    file.extend([2, 0, 1, 0]);
    for (name, packed) in [(&b"first\0"[..], 0), (b"density\0", zip.len() as u64 + 8)] {
        let mut head = vec![0; 176];
        put(&mut head, 0, &(body.len() as u64).to_le_bytes());
        put(&mut head, 8, &packed.to_le_bytes());
        put(&mut head, 136, &(name.len() as u32).to_le_bytes());
        file.extend(head);
        file.extend(name);
    }
    file.extend((zip.len() as u64).to_le_bytes());
    file.extend(zip);
    file
}

#[test]
fn numbers_and_places_are_read() {
    let volume = read(&grid(), "density", &LIMITS).unwrap();
    assert_eq!((volume.low, volume.size), ([-1; 3], [18, 10, 10]));
    let at = |x: usize, y: usize, z: usize| volume.values[((z + 1) * 10 + y + 1) * 18 + x + 1];
    assert_eq!([at(0, 0, 0), at(7, 7, 7), at(8, 0, 0), at(9, 2, 3), at(15, 7, 7)], [3.0, 3.0, 0.0, 83.0, 511.0]);
    assert_eq!((volume.values[0], at(16, 7, 7)), (0.0, 0.0));
    assert_eq!(volume.world_from_index, [[0.0, 0.5, 0.0, 7.0], [1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 2.0, 0.0]]);
    assert_eq!(read(&zipped(), "density", &LIMITS).unwrap(), volume);
}

#[test]
fn what_is_not_read_is_named() {
    let says = |at: usize, v: u32| {
        let mut b = grid();
        put(&mut b, at, &v.to_le_bytes());
        read(&b, "", &LIMITS).unwrap_err().to_string()
    };
    assert!(says(16, 29 << 21).contains("version 29.0"));
    assert!(says(632, 1).contains("level set"));
    assert!(says(636, 6).contains("vectors"));
    assert!(says(ROOT + 12, 1 << 30).contains("more than 65536"));
    assert!(says(ROOT + 12, u32::MAX).contains("no active voxels"));
    let there = vec!["first".to_owned(), "density".to_owned()];
    assert_eq!(read(&zipped(), "heat", &LIMITS), Err(Error::NoGrid { name: "heat".into(), there }));
}

/// Every cut and every byte that is another gives a grid or an error, in bounded time and memory.
#[test]
fn damaged_files_are_refused_or_read() {
    let zip = zipped();
    for end in 0..zip.len() - 1 {
        assert!(read(&zip[..end], "density", &LIMITS).is_err(), "{end}");
    }
    let plain = grid();
    let ends = (0..1000).chain(NODE + 4000..NODE + 4200).chain(LOWER..LOWER + 600).chain(LEAF..LEAF + 2144);
    for end in ends {
        assert!(read(&plain[..end], "density", &LIMITS).is_err(), "{end}");
    }
    for (file, at) in (0..900).map(|at| (&plain, at)).chain((0..zip.len()).map(|at| (&zip, at))) {
        for v in [0x00, 0x01, 0x80, 0xff] {
            let mut b = file.clone();
            b[at] ^= v;
            let _ = read(&b, "density", &LIMITS);
        }
    }
}
