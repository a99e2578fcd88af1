//! A grid of NanoVDB, for tests of what reads volumes.

const ROOT: usize = 736;
const UPPER: usize = 832;
const LOWER: usize = UPPER + 270_400;
const LEAF: usize = LOWER + 33_856;

/// A grid as it lies in memory, which is also a file, as several of them one after the other are: voxels of side 1
/// whose first one is at index and place 0, at most 8 along each axis.
///
/// `values` are x fastest, z slowest. Where all are one number there is a single tile at the root, else a leaf.
///
/// # Panics
/// For sizes beyond 8, and where the values are not as many as the voxels.
pub fn nanovdb(name: &str, size: [usize; 3], values: &[f32]) -> Vec<u8> {
    assert!(size.iter().all(|n| (1..=8).contains(n)) && values.len() == size.iter().product::<usize>());
    let is_tile = values.iter().all(|v| *v == values[0]);
    let mut bytes = vec![0; if is_tile { UPPER } else { LEAF + 96 + 4 * 512 }];
    let length = bytes.len() as u64;
    let mut put = |at: usize, part: &[u8]| bytes[at..at + part.len()].copy_from_slice(part);
    // The grid: magic number, version 32, length, name, the identity as its map, class, type.
    put(0, b"NanoVDB1");
    put(16, &(32_u32 << 21).to_le_bytes());
    put(32, &length.to_le_bytes());
    put(40, name.as_bytes());
    [384, 416, 448].iter().for_each(|at| put(*at, &1.0_f64.to_le_bytes()));
    [(632, 2_u32), (636, 1)].iter().for_each(|(at, v)| put(*at, &v.to_le_bytes()));
    // The tree: where the root is; its box, and a table of one.
    put(696, &64_u64.to_le_bytes());
    (0..3).for_each(|a| put(ROOT + 12 + 4 * a, &(size[a] as u32 - 1).to_le_bytes()));
    put(ROOT + 24, &1_u32.to_le_bytes());
    if is_tile {
        put(ROOT + 84, &values[0].to_le_bytes());
        return bytes;
    }
    // The offset of the first child of each node, and its bit in the mask.
    put(ROOT + 72, &96_u64.to_le_bytes());
    put(UPPER + 4128, &[1]);
    put(UPPER + 8256, &270_400_u64.to_le_bytes());
    put(LOWER + 544, &[1]);
    put(LOWER + 1088, &33_856_u64.to_le_bytes());
    for (i, v) in values.iter().enumerate() {
        let [x, y, z] = [i % size[0], i / size[0] % size[1], i / (size[0] * size[1])];
        put(LEAF + 96 + 4 * (x << 6 | y << 3 | z), &v.to_le_bytes());
    }
    bytes
}
