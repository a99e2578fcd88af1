//! BC7 by its mode 6: two ends of 7 bits for each of red, green, blue and alpha with a lowest bit that is shared, and
//! for each texel one of sixteen places between them. The other modes, which cut blocks into parts, are read but not
//! written.

use super::{SIXTEEN_PLACES, ends_of_line, refined_ends};

/// Encodes a block.
pub fn encode(texels: &[[u8; 4]; 16]) -> [u8; 16] {
    let points = texels.map(|t| t.map(f32::from));
    let mut ends = ends_of_line(&points);
    let mut best = (u32::MAX, [0; 16]);
    for _ in 0..4 {
        let mut places = None;
        let mut least = u32::MAX;
        for shared in 0..4_u8 {
            let low = [shared & 1, shared >> 1];
            let quantised: [[u8; 4]; 2] = std::array::from_fn(|k| ends[k].map(|v| quantise(v, low[k])));
            let (error, indices) = assign(texels, quantised);
            if error < least {
                least = error;
                places = Some(indices.map(|i| SIXTEEN_PLACES[i as usize] as f32 / 64.0));
            }
            if error < best.0 {
                best = (error, block(quantised, indices));
            }
        }
        match places.and_then(|places| refined_ends(&points, &places)) {
            Some(refined) if best.0 > 0 => ends = refined,
            _ => break,
        }
    }
    best.1
}

/// The 8-bit value with this lowest bit that is nearest.
fn quantise(v: f32, low: u8) -> u8 {
    let seven = ((v - f32::from(low)) * 0.5 + 0.5).clamp(0.0, 127.0) as u8;
    seven << 1 | low
}

/// The nearest of the sixteen places for each texel, and the squared error.
fn assign(texels: &[[u8; 4]; 16], [a, b]: [[u8; 4]; 2]) -> (u32, [u8; 16]) {
    let palette = SIXTEEN_PLACES
        .map(|w| -> [u32; 4] { std::array::from_fn(|c| ((64 - w) * u32::from(a[c]) + w * u32::from(b[c]) + 32) >> 6) });
    let mut error = 0;
    let indices = texels.map(|t| {
        let distance = |p: &[u32; 4]| (0..4).map(|c| p[c].abs_diff(u32::from(t[c])).pow(2)).sum::<u32>();
        let (index, least) = palette
            .iter()
            .enumerate()
            .map(|(i, p)| (i as u8, distance(p)))
            .fold((0, u32::MAX), |best, now| if now.1 < best.1 { now } else { best });
        error += least;
        index
    });
    (error, indices)
}

/// The bits: the mode, the ends channel by channel, their lowest bits, the indices. The first index has three bits: its
/// highest is zero, for which the ends change places where needed.
fn block([mut a, mut b]: [[u8; 4]; 2], mut indices: [u8; 16]) -> [u8; 16] {
    if indices[0] >= 8 {
        std::mem::swap(&mut a, &mut b);
        indices = indices.map(|i| 15 - i);
    }
    let (mut bits, mut at) = (1_u128 << 6, 7);
    let mut put = |value: u8, n: u32| {
        bits |= u128::from(value) << at;
        at += n;
    };
    for c in 0..4 {
        put(a[c] >> 1, 7);
        put(b[c] >> 1, 7);
    }
    put(a[0] & 1, 1);
    put(b[0] & 1, 1);
    for (k, index) in indices.into_iter().enumerate() {
        put(index, if k == 0 { 3 } else { 4 });
    }
    bits.to_le_bytes()
}
