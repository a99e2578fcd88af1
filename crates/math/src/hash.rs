//! Integer hashes: the source of all randomness. Every random number is a hash of what it is for, never of when it is
//! drawn.

/// A bijective 32-bit mixer with low bias (Wellons, "hash prospector", constants of the `lowbias32` family).
#[inline(always)]
pub const fn mix32(mut x: u32) -> u32 {
    x ^= x >> 16;
    x = x.wrapping_mul(0x21f0_aaad);
    x ^= x >> 15;
    x = x.wrapping_mul(0xd35a_2d97);
    x ^ (x >> 15)
}

/// A bijective 64-bit mixer (Stafford's variant 13, the finaliser of SplitMix64).
#[inline(always)]
pub const fn mix64(mut x: u64) -> u64 {
    x ^= x >> 30;
    x = x.wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x ^= x >> 27;
    x = x.wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

/// Folds a value into a running 32-bit hash.
#[inline(always)]
pub const fn combine32(seed: u32, value: u32) -> u32 {
    mix32(seed ^ value.wrapping_mul(0x9e37_79b9).wrapping_add(0x7f4a_7c15))
}

/// Folds a value into a running 64-bit hash.
#[inline]
pub const fn combine64(seed: u64, value: u64) -> u64 {
    mix64(seed ^ value.wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add(0x632b_e59b_d9b4_e019))
}

/// The largest `f32` below one.
pub const ONE_MINUS_EPSILON: f32 = 1.0 - f32::EPSILON * 0.5;

/// A number in `[0, 1)` from the top 24 bits of an integer.
#[inline(always)]
pub fn unit_f32(x: u32) -> f32 {
    (x >> 8) as f32 * (1.0 / 16_777_216.0)
}

/// A small sequential generator seeded by a hash, for places that draw an unknown count of numbers (random walks,
/// tests).
#[derive(Clone, Copy, Debug)]
pub struct HashRng {
    state: u64,
}

impl HashRng {
    /// A generator whose sequence is a function of `seed`.
    pub fn new(seed: u64) -> Self {
        Self { state: mix64(seed ^ 0x9e37_79b9_7f4a_7c15) }
    }

    /// The next 64 random bits (SplitMix64).
    #[inline]
    pub fn next_u64(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        mix64(self.state)
    }

    /// The next number in `[0, 1)`.
    #[inline]
    pub fn next_f32(&mut self) -> f32 {
        unit_f32((self.next_u64() >> 32) as u32)
    }
}
