//! BC6H without signs by its mode 11: two ends of 10 bits for each of red, green and blue, and for each texel one of
//! sixteen places between them. The other modes, which cut blocks into parts or store differences, are read but not
//! written.
//!
//! Ends and places are bits of half floats, so that errors are relative to brightness.

use super::{SIXTEEN_PLACES, ends_of_line, nearest_of_palette, refined_ends};
use half::f16;

/// Largest bits of a finite half float.
const LARGEST: f32 = 0x7bff as f32;

/// Encodes linear values; those below zero and what is no number become zero, those beyond half floats the largest.
pub fn encode(texels: &[[f32; 3]; 16]) -> [u8; 16] {
    let bits = |v: f32| if v > 0.0 { f32::from(f16::from_f32(v.min(65504.0)).to_bits()) } else { 0.0 };
    let points = texels.map(|t| t.map(bits));
    // In steps of 64, which are about those of the ends: squares of squares of the bits themselves are beyond floats.
    let mut ends = ends_of_line(&points.map(|p| p.map(|v| v / 64.0))).map(|end| end.map(|v| v * 64.0));
    let mut best = (f32::INFINITY, [0; 16]);
    for _ in 0..4 {
        let quantised = ends.map(|end| end.map(quantise));
        let (error, indices) = assign(&points, quantised);
        if error < best.0 {
            best = (error, block(quantised, indices));
        }
        match refined_ends(&points, &indices.map(|i| SIXTEEN_PLACES[i as usize] as f32 / 64.0)) {
            Some(refined) if best.0 > 0.0 => ends = refined,
            _ => break,
        }
    }
    best.1
}

/// The 10-bit end that is nearest to the bits of a half float.
fn quantise(v: f32) -> u16 {
    let guess = (v.clamp(0.0, LARGEST) * (64.0 / 31.0) / 64.0) as u16;
    let error = |q: &u16| (finish(unquantise(*q)) - v).abs();
    (guess.saturating_sub(1)..=(guess + 1).min(1023)).min_by(|a, b| error(a).total_cmp(&error(b))).unwrap_or(guess)
}

/// From 10 to 16 bits (Khronos Data Format Specification 1.3, 20.2).
fn unquantise(q: u16) -> u32 {
    match q {
        0 => 0,
        1023 => 0xffff,
        q => (u32::from(q) << 16 | 0x8000) >> 10,
    }
}

/// Bits of a half float from 16 bits.
fn finish(v: u32) -> f32 {
    ((v * 31) >> 6) as f32
}

/// The nearest of the sixteen places for each texel, and the squared error in bits of half floats.
fn assign(points: &[[f32; 3]; 16], ends: [[u16; 3]; 2]) -> (f32, [u8; 16]) {
    let [a, b] = ends.map(|end| end.map(unquantise));
    let palette =
        SIXTEEN_PLACES.map(|w| -> [f32; 3] { std::array::from_fn(|c| finish((a[c] * (64 - w) + b[c] * w + 32) >> 6)) });
    nearest_of_palette(points, &palette)
}

/// The bytes: mode, ends, and indices, the first of which has no highest bit.
fn block([mut a, mut b]: [[u16; 3]; 2], mut indices: [u8; 16]) -> [u8; 16] {
    if indices[0] >= 8 {
        (a, b) = (b, a);
        indices = indices.map(|i| 15 - i);
    }
    let mut bits = 0b00011_u128;
    let mut at = 5;
    for end in a.into_iter().chain(b) {
        bits |= u128::from(end) << at;
        at += 10;
    }
    for (k, index) in indices.into_iter().enumerate() {
        bits |= u128::from(index) << at;
        at += if k == 0 { 3 } else { 4 };
    }
    bits.to_le_bytes()
}
