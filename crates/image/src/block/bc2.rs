//! BC2: four bits of alpha for each texel, before a block of BC1.

/// Encodes the alpha of a block, rounded to 15 steps.
pub fn encode_alpha(values: &[u8; 16]) -> [u8; 8] {
    let four = |v: u8| ((u32::from(v) * 15 + 127) / 255) as u8;
    std::array::from_fn(|k| four(values[2 * k]) | four(values[2 * k + 1]) << 4)
}
