//! Sorting eight keys in one register.
#![expect(unsafe_code, reason = "unchecked reads; each place states why it is sound")]

use super::LANES;
use std::arch::x86_64::*;

/// Sorts keys as signed integers, greatest first, and companions in the same order; the lowest three bits of a key are
/// the lane it came from, unless it is -1, whose companion has no meaning.
///
/// # Safety
/// The machine must have AVX2.
#[inline(always)]
pub(super) unsafe fn sort_descending(keys: __m256i, companions: &[u32; LANES]) -> ([u32; LANES], [u32; LANES]) {
    // A bitonic network: each stage compares with a permutation of the lanes and keeps the greater key at the lower
    // lane.
    macro_rules! stage {
        ($keys:expr, $permuted:expr, $lower:literal) => {{
            let other = $permuted;
            let (min, max) = (_mm256_min_epi32($keys, other), _mm256_max_epi32($keys, other));
            _mm256_blend_epi32::<$lower>(min, max)
        }};
    }
    let (mut sorted_keys, mut sorted_companions) = ([0; LANES], [0; LANES]);
    // SAFETY: the caller promises AVX2; loads and stores go to whole arrays.
    unsafe {
        let keys = stage!(keys, _mm256_shuffle_epi32::<0b10_11_00_01>(keys), 0b0101_0101);
        let keys = stage!(keys, _mm256_shuffle_epi32::<0b00_01_10_11>(keys), 0b0011_0011);
        let keys = stage!(keys, _mm256_shuffle_epi32::<0b10_11_00_01>(keys), 0b0101_0101);
        let reversed = _mm256_setr_epi32(7, 6, 5, 4, 3, 2, 1, 0);
        let keys = stage!(keys, _mm256_permutevar8x32_epi32(keys, reversed), 0b0000_1111);
        let keys = stage!(keys, _mm256_shuffle_epi32::<0b01_00_11_10>(keys), 0b0011_0011);
        let keys = stage!(keys, _mm256_shuffle_epi32::<0b10_11_00_01>(keys), 0b0101_0101);
        // The permutation looks at the lowest three bits only.
        let companions = _mm256_permutevar8x32_epi32(_mm256_loadu_si256(companions.as_ptr().cast()), keys);
        _mm256_storeu_si256(sorted_keys.as_mut_ptr().cast(), keys);
        _mm256_storeu_si256(sorted_companions.as_mut_ptr().cast(), companions);
    }
    (sorted_keys, sorted_companions)
}

/// The lane of the least of some keys that [`sort_descending`] would sort, of which one at least is not -1.
///
/// # Safety
/// The machine must have AVX2.
#[inline(always)]
pub(super) unsafe fn nearest(keys: __m256i) -> usize {
    // SAFETY: the caller promises AVX2.
    unsafe {
        // As unsigned integers -1 is the greatest.
        let least = _mm_min_epu32(_mm256_castsi256_si128(keys), _mm256_extracti128_si256::<1>(keys));
        let least = _mm_min_epu32(least, _mm_shuffle_epi32::<0b01_00_11_10>(least));
        let least = _mm_min_epu32(least, _mm_shuffle_epi32::<0b10_11_00_01>(least));
        _mm_cvtsi128_si32(least) as usize & (LANES - 1)
    }
}
