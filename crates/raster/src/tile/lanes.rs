//! Sixteen lanes at a time, in loops that compilers turn into vector instructions.

/// The pixels of a strip: columns and rows.
pub(super) const COLUMN: [i32; 16] = [0, 1, 2, 3, 4, 5, 6, 7, 0, 1, 2, 3, 4, 5, 6, 7];
pub(super) const ROW: [i32; 16] = [0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1, 1, 1];

/// A bit for each byte, which is 0 or 1.
#[inline(always)]
pub(super) fn bits(bytes: [u8; 16]) -> u16 {
    let half = |bytes: &[u8]| {
        let mut eight = [0; 8];
        eight.copy_from_slice(bytes);
        // Byte i moves from bit 8i to bit 56 + i; all others miss the top byte.
        (u64::from_le_bytes(eight).wrapping_mul(0x0102_0408_1020_4080) >> 56) as u16
    };
    half(&bytes[..8]) | half(&bytes[8..]) << 8
}

/// A bit for each lane where the condition holds.
#[inline(always)]
pub(super) fn bits_where(condition: impl Fn(usize) -> bool) -> u16 {
    let mut bytes = [0; 16];
    for (i, byte) in bytes.iter_mut().enumerate() {
        *byte = u8::from(condition(i));
    }
    bits(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_are_in_order() {
        for mask in 0..=u16::MAX {
            assert_eq!(bits_where(|i| mask >> i & 1 == 1), mask);
        }
    }
}
