//! BC1: two colours of 5, 6 and 5 bits, and for each texel which of four on the line between them it has.

use super::{ends_of_line, nearest_of_palette, refined_ends};
use std::sync::LazyLock;

/// Places between the ends that indices stand for.
const PLACES: [f32; 4] = [0.0, 1.0, 1.0 / 3.0, 2.0 / 3.0];

/// Encodes the colours of a block, as opaque.
pub fn encode(texels: &[[u8; 4]; 16]) -> [u8; 8] {
    let first = [texels[0][0], texels[0][1], texels[0][2]];
    if texels.iter().all(|t| t[..3] == first) {
        return single(first);
    }
    let points = texels.map(|t| [t[0], t[1], t[2]].map(f32::from));
    let mut ends = ends_of_line(&points);
    let mut best = (f32::INFINITY, [0; 8]);
    for _ in 0..3 {
        let packed = ends.map(pack);
        let (error, indices) = assign(&points, packed);
        if error < best.0 {
            best = (error, block(packed, indices));
        }
        match refined_ends(&points, &indices.map(|i| PLACES[i as usize])) {
            Some(refined) => ends = refined,
            None => break,
        }
    }
    best.1
}

fn pack(c: [f32; 3]) -> u16 {
    let q = |v: f32, most: f32| (v.clamp(0.0, 255.0) / 255.0 * most + 0.5) as u16;
    q(c[0], 31.0) << 11 | q(c[1], 63.0) << 5 | q(c[2], 31.0)
}

fn unpack(c: u16) -> [f32; 3] {
    let (r, g, b) = (c >> 11, c >> 5 & 63, c & 31);
    [r << 3 | r >> 2, g << 2 | g >> 4, b << 3 | b >> 2].map(f32::from)
}

/// The nearest colour of the palette for each point, and the squared error.
fn assign(points: &[[f32; 3]; 16], packed: [u16; 2]) -> (f32, [u8; 16]) {
    let [a, b] = packed.map(unpack);
    let palette = PLACES.map(|t| -> [f32; 3] { std::array::from_fn(|c| a[c] + (b[c] - a[c]) * t) });
    nearest_of_palette(points, &palette)
}

/// The bytes; the first end must be the larger number, or the palette is another one.
fn block([a, b]: [u16; 2], mut indices: [u8; 16]) -> [u8; 8] {
    let (a, b) = if a < b {
        indices = indices.map(|i| i ^ 1);
        (b, a)
    } else {
        (a, b)
    };
    if a == b {
        // With equal ends the fourth colour is transparent black.
        indices = [0; 16];
    }
    let bits = indices.iter().enumerate().fold(0_u32, |bits, (k, &i)| bits | u32::from(i) << (2 * k));
    let mut bytes = [0; 8];
    bytes[..2].copy_from_slice(&a.to_le_bytes());
    bytes[2..4].copy_from_slice(&b.to_le_bytes());
    bytes[4..].copy_from_slice(&bits.to_le_bytes());
    bytes
}

/// For each 8-bit value the ends, of so many bits, whose point at a third is nearest.
fn thirds(bits: u32) -> [[u16; 2]; 256] {
    let expand = |v: u32| v << (8 - bits) | v >> (2 * bits - 8);
    std::array::from_fn(|value| {
        let mut best = (u32::MAX, [0; 2]);
        for a in 0..1 << bits {
            for b in 0..1 << bits {
                let error = (2 * expand(a) + expand(b)).abs_diff(3 * value as u32) * 64 + a.abs_diff(b);
                if error < best.0 {
                    best = (error, [a as u16, b as u16]);
                }
            }
        }
        best.1
    })
}

/// A block of one colour: the point at a third meets it better than any end.
fn single(colour: [u8; 3]) -> [u8; 8] {
    static FIVE: LazyLock<[[u16; 2]; 256]> = LazyLock::new(|| thirds(5));
    static SIX: LazyLock<[[u16; 2]; 256]> = LazyLock::new(|| thirds(6));
    let [r, g, b] = colour.map(usize::from);
    let end = |k: usize| FIVE[r][k] << 11 | SIX[g][k] << 5 | FIVE[b][k];
    block([end(0), end(1)], [2; 16])
}
