//! Pictures as binary messages: tiles of half floats with a header.

use half::f16;
use half::slice::HalfFloatSliceExt;

/// Magic number at the beginning of each tile: "STRT".
const MAGIC: u32 = u32::from_le_bytes(*b"STRT");
/// Bytes before the values.
const HEADER: usize = 24;
/// Most rows of a tile.
const ROWS: usize = 256;

/// Values of a picture, pixel by pixel, rows from the top.
pub struct Plane<'a> {
    /// 0 for the picture, then the layers in their order.
    pub layer: u16,
    /// Values of a pixel: 1 or 3.
    pub components: u16,
    /// Pixels.
    pub size: [u32; 2],
    /// As many as there are pixels times components.
    pub values: &'a [f32],
}

/// The tiles of a plane: a header of 24 bytes in little-endian order (`u32` "STRT" and generation; `u16` layer,
/// components, width and height of the frame, x, y, width and height of the tile), then half floats. Values that halves
/// cannot hold are the largest that they can.
pub fn tiles(generation: u32, plane: &Plane<'_>) -> Vec<Vec<u8>> {
    let [width, height] = plane.size.map(|n| n as usize);
    let row = width * usize::from(plane.components);
    let tile = |y: usize| {
        let rows = ROWS.min(height - y);
        let values = &plane.values[y * row..(y + rows) * row];
        let mut bytes = Vec::with_capacity(HEADER + 2 * values.len());
        bytes.extend([MAGIC, generation].iter().flat_map(|v| v.to_le_bytes()));
        let words =
            [plane.layer, plane.components, width as u16, height as u16, 0, y as u16, width as u16, rows as u16];
        bytes.extend(words.iter().flat_map(|v| v.to_le_bytes()));
        let mut halves = [f16::ZERO; 1024];
        let mut held = [0.0_f32; 1024];
        for piece in values.chunks(held.len()) {
            let (held, halves) = (&mut held[..piece.len()], &mut halves[..piece.len()]);
            let most = f32::from(f16::MAX);
            held.iter_mut().zip(piece).for_each(|(held, v)| *held = v.clamp(-most, most));
            halves.convert_from_f32_slice(held);
            bytes.extend(halves.iter().flat_map(|h| h.to_le_bytes()));
        }
        bytes
    };
    (0..height).step_by(ROWS).map(tile).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_cover_the_picture_and_hold_its_values() {
        let values: Vec<f32> = (0..3 * 2 * 300).map(|k| k as f32 / 8.0).collect();
        let made = tiles(7, &Plane { layer: 2, components: 3, size: [2, 300], values: &values });
        assert_eq!(made.len(), 2);
        let word = |tile: &[u8], k: usize| u16::from_le_bytes([tile[8 + 2 * k], tile[9 + 2 * k]]);
        let mut got = Vec::new();
        for (tile, [y, rows]) in made.iter().zip([[0, 256], [256, 44]]) {
            assert_eq!(&tile[..8], b"STRT\x07\0\0\0");
            assert_eq!((0..8).map(|k| word(tile, k)).collect::<Vec<_>>(), [2, 3, 2, 300, 0, y, 2, rows]);
            got.extend(tile[24..].chunks(2).map(|b| f16::from_le_bytes([b[0], b[1]]).to_f32()));
        }
        assert_eq!(got, values);
    }

    #[test]
    fn what_halves_cannot_hold_is_the_largest_that_they_can() {
        let values = [1e9, f32::NEG_INFINITY, f32::NAN, 65504.0];
        let made = tiles(0, &Plane { layer: 0, components: 1, size: [4, 1], values: &values });
        let got: Vec<f32> = made[0][24..].chunks(2).map(|b| f16::from_le_bytes([b[0], b[1]]).to_f32()).collect();
        assert_eq!((got[0], got[1], got[3]), (65504.0, -65504.0, 65504.0));
        assert!(got[2].is_nan());
        assert!(tiles(0, &Plane { layer: 0, components: 1, size: [0, 0], values: &[] }).is_empty());
    }
}
