//! Eight `f32` lanes on several instruction sets, all with the same bits: only correctly rounded operations, no contraction, and
//! one meaning of minimum and maximum.
//!
//! A value of a type that implements [`Simd`] is a token: that it exists proves that the machine has the instructions, so that
//! its operations are safe to call. They are fast only when inlined into a function compiled for that instruction set.

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
#[cfg(any(test, not(target_arch = "x86_64")))]
mod portable;
#[cfg(target_arch = "x86_64")]
mod sse2;

#[cfg(target_arch = "x86_64")]
pub(crate) use avx2::Avx2;
#[cfg(target_arch = "x86_64")]
pub(crate) use avx512::Avx512;
#[cfg(not(target_arch = "x86_64"))]
pub(crate) use portable::Portable;
#[cfg(target_arch = "x86_64")]
pub(crate) use sse2::Sse2;

/// Number of lanes, and with it the width of nodes and triangle blocks.
pub(crate) const LANES: usize = 8;

/// A row of lanes as it lies in memory.
#[repr(C, align(32))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Row(pub [f32; LANES]);

/// Operations on eight lanes.
pub(crate) trait Simd: Copy {
    /// Eight numbers.
    type F: Copy;
    /// Eight truth values.
    type M: Copy;

    /// The same number in every lane.
    fn splat(self, x: f32) -> Self::F;
    /// The lanes of a row.
    fn load(self, row: &Row) -> Self::F;
    /// The lanes as an array.
    fn store(self, a: Self::F) -> [f32; LANES];
    /// `a + b`.
    fn add(self, a: Self::F, b: Self::F) -> Self::F;
    /// `a - b`.
    fn sub(self, a: Self::F, b: Self::F) -> Self::F;
    /// `a * b`.
    fn mul(self, a: Self::F, b: Self::F) -> Self::F;
    /// `a / b`.
    fn div(self, a: Self::F, b: Self::F) -> Self::F;
    /// `if a < b { a } else { b }`: gives `b` where either is NaN.
    fn min(self, a: Self::F, b: Self::F) -> Self::F;
    /// `if a > b { a } else { b }`: gives `b` where either is NaN.
    fn max(self, a: Self::F, b: Self::F) -> Self::F;
    /// `a <= b`, false for NaN.
    fn le(self, a: Self::F, b: Self::F) -> Self::M;
    /// `a < b`, false for NaN.
    fn lt(self, a: Self::F, b: Self::F) -> Self::M;
    /// `a == b`, false for NaN.
    fn eq(self, a: Self::F, b: Self::F) -> Self::M;
    /// Both.
    fn and(self, a: Self::M, b: Self::M) -> Self::M;
    /// Either.
    fn or(self, a: Self::M, b: Self::M) -> Self::M;
    /// Bit `i` is lane `i`.
    fn bits(self, m: Self::M) -> u32;

    /// Sorts numbers that are at least +0, farthest first: the keys of those in `chosen` (see [`key`]), and in the same order their
    /// companions. What follows these has no meaning.
    #[inline(always)]
    fn sort_descending(self, a: Self::F, chosen: u32, companions: &[u32; LANES]) -> ([u32; LANES], [u32; LANES]) {
        let a = self.store(a);
        let mut keys = [0; LANES];
        let mut len = 0;
        for (lane, x) in a.into_iter().enumerate().filter(|(lane, _)| chosen >> lane & 1 == 1) {
            let key = key(x, lane);
            let mut slot = len;
            while slot > 0 && keys[slot - 1] < key {
                keys[slot] = keys[slot - 1];
                slot -= 1;
            }
            keys[slot] = key;
            len += 1;
        }
        (keys, keys.map(|key| companions[key_lane(key)]))
    }
}

/// A number that is at least +0 and its lane as an integer that sorts like them: the lane replaces the lowest three bits.
#[inline(always)]
pub(crate) fn key(x: f32, lane: usize) -> u32 {
    x.to_bits() & !LANE_BITS | lane as u32
}

/// The number in a key, or one that is a little smaller.
#[inline(always)]
pub(crate) fn key_number(key: u32) -> f32 {
    f32::from_bits(key & !LANE_BITS)
}

/// The lane in a key.
#[inline(always)]
pub(crate) fn key_lane(key: u32) -> usize {
    (key & LANE_BITS) as usize
}

/// The bits of a key that hold the lane.
const LANE_BITS: u32 = LANES as u32 - 1;
