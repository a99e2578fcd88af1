//! Numbers on a three-dimensional grid, and Mitsuba's file of them (`.vol`).
//!
//! Little-endian: "VOL", version 3, encoding 1 (`f32`), the counts along x, y, z and of channels, the box (xmin, ymin,
//! zmin, xmax, ymax, zmax), then the values with the channels innermost and x next.

use crate::{Error, Limits, Result, limits::within};
use std::path::Path;

/// A grid of samples at the middles of its voxels.
#[derive(Clone, Debug, PartialEq)]
pub struct VoxelGrid {
    /// Voxels along x, y, z; none is zero.
    pub size: [usize; 3],
    /// Numbers per voxel.
    pub channels: usize,
    /// Corners of the box that the file gives.
    pub bounds: [[f32; 3]; 2],
    /// `channels × x × y × z` numbers, channels innermost, then x, then y.
    pub data: Vec<f32>,
}

const HEADER: usize = 48;

/// Reads a `.vol` file.
///
/// # Errors
/// Where the file cannot be read, is none, or is larger than the limits allow.
pub fn read_voxel_grid(path: &Path, limits: &Limits) -> Result<VoxelGrid> {
    let bytes = crate::read::load(path, limits)?;
    decode(&bytes, limits).map_err(|e| e.at(path))
}

/// Reads a `.vol` file from memory. Values that are not finite are kept.
///
/// # Errors
/// As [`read_voxel_grid`].
pub fn decode(bytes: &[u8], limits: &Limits) -> Result<VoxelGrid> {
    let fault = |what: String| Error::VoxelGrid(what);
    if bytes.len() < HEADER || &bytes[..3] != b"VOL" {
        return Err(fault("it does not begin with a header ('VOL' and 45 bytes more)".into()));
    }
    if bytes[3] != 3 {
        return Err(fault(format!("version {} is not known; 3 is", bytes[3])));
    }
    let word = |i: usize| -> [u8; 4] { std::array::from_fn(|k| bytes[4 + 4 * i + k]) };
    let count = |i: usize| i32::from_le_bytes(word(i));
    if count(0) != 1 {
        return Err(fault(format!("encoding {} is not known; 1 (32-bit numbers) is", count(0))));
    }
    let [x, y, z, channels] = [1, 2, 3, 4].map(count);
    if x < 1 || y < 1 || z < 1 || channels < 1 {
        return Err(fault(format!("{x} × {y} × {z} voxels of {channels} channels are none")));
    }
    within("the number of channels", channels as u64, limits.channels)?;
    let values = [x, y, z, channels].iter().try_fold(1_u64, |n, &v| n.checked_mul(v as u64)).unwrap_or(u64::MAX);
    within("the size in bytes", values.saturating_mul(4), limits.bytes)?;
    let body = &bytes[HEADER..];
    if (body.len() as u64) < values * 4 {
        return Err(fault(format!("{x} × {y} × {z} × {channels} values are declared, {} are there", body.len() / 4)));
    }
    let number = |b: &[u8]| f32::from_le_bytes([b[0], b[1], b[2], b[3]]);
    let corner = |i: usize| std::array::from_fn(|k| f32::from_le_bytes(word(i + k)));
    Ok(VoxelGrid {
        size: [x as usize, y as usize, z as usize],
        channels: channels as usize,
        bounds: [corner(5), corner(8)],
        data: body[..values as usize * 4].chunks_exact(4).map(number).collect(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(size: [i32; 4], values: &[f32]) -> Vec<u8> {
        let mut b = b"VOL\x03\x01\0\0\0".to_vec();
        size.iter().for_each(|v| b.extend(v.to_le_bytes()));
        [0.0_f32, 0.0, 0.0, 1.0, 2.0, 3.0].iter().chain(values).for_each(|v| b.extend(v.to_le_bytes()));
        b
    }

    #[test]
    fn grids_are_read() {
        let g = decode(&file([2, 1, 1, 3], &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]), &Limits::default()).unwrap();
        assert_eq!((g.size, g.channels, g.bounds[1]), ([2, 1, 1], 3, [1.0, 2.0, 3.0]));
        assert_eq!(g.data, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
    }

    #[test]
    fn what_is_wrong_is_said() {
        let limits = Limits { bytes: 1 << 20, ..Limits::default() };
        let says = |b: &[u8]| decode(b, &limits).unwrap_err().to_string();
        let good = file([2, 1, 1, 1], &[1.0, 2.0]);
        assert!(says(&good[..20]).contains("header"));
        assert!(says(&good[..52]).contains("are there"));
        assert!(says(b"PNG").contains("VOL"));
        let with = |at: usize, v: u8| {
            let mut b = good.clone();
            b[at] = v;
            b
        };
        assert!(says(&with(3, 4)).contains("version 4"));
        assert!(says(&with(4, 2)).contains("encoding 2"));
        assert!(says(&file([0, 1, 1, 1], &[])).contains("none"));
        assert!(says(&file([-1, 1, 1, 1], &[])).contains("none"));
        // Four numbers whose product has no 64 bits.
        assert!(says(&file([i32::MAX, i32::MAX, i32::MAX, 3], &[])).contains("bytes"));
        assert!(says(&file([i32::MAX, 1, 1, i32::MAX], &[])).contains("channels"));
    }
}
