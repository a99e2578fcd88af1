//! Lanes in one 256-bit register, masks in mask registers.
#![expect(unsafe_code, reason = "unchecked reads; each place states why it is sound")]

use super::sort::{nearest, sort_descending};
use super::{LANES, Lanes, Row, Simd, Wide};
use std::arch::x86_64::*;

/// Proof that the machine has AVX-512 F and VL.
#[derive(Clone, Copy)]
pub(crate) struct Avx512(());

impl Avx512 {
    /// Makes the token.
    ///
    /// # Safety
    /// The machine must have AVX-512 F and VL.
    #[inline(always)]
    pub(crate) unsafe fn assume_supported() -> Self {
        Self(())
    }
}

// SAFETY (all blocks below): the token proves that the instructions exist; loads and stores go to whole arrays of eight
// `f32`.
impl Lanes for Avx512 {
    const COUNT: usize = LANES;
    type Half = Self;
    type F = __m256;
    type M = __mmask8;

    #[inline(always)]
    fn half(self) -> Self {
        self
    }
    #[inline(always)]
    fn splat(self, x: f32) -> Self::F {
        // SAFETY: see above.
        unsafe { _mm256_set1_ps(x) }
    }
    #[inline(always)]
    fn add(self, a: Self::F, b: Self::F) -> Self::F {
        // SAFETY: see above.
        unsafe { _mm256_add_ps(a, b) }
    }
    #[inline(always)]
    fn sub(self, a: Self::F, b: Self::F) -> Self::F {
        // SAFETY: see above.
        unsafe { _mm256_sub_ps(a, b) }
    }
    #[inline(always)]
    fn mul(self, a: Self::F, b: Self::F) -> Self::F {
        // SAFETY: see above.
        unsafe { _mm256_mul_ps(a, b) }
    }
    #[inline(always)]
    fn mul_add(self, a: Self::F, b: Self::F, c: Self::F) -> Self::F {
        // SAFETY: see above.
        unsafe { _mm256_fmadd_ps(a, b, c) }
    }
    #[inline(always)]
    fn div(self, a: Self::F, b: Self::F) -> Self::F {
        // SAFETY: see above.
        unsafe { _mm256_div_ps(a, b) }
    }
    #[inline(always)]
    fn min(self, a: Self::F, b: Self::F) -> Self::F {
        // SAFETY: see above.
        unsafe { _mm256_min_ps(a, b) }
    }
    #[inline(always)]
    fn max(self, a: Self::F, b: Self::F) -> Self::F {
        // SAFETY: see above.
        unsafe { _mm256_max_ps(a, b) }
    }
    #[inline(always)]
    fn nearer(self, a: Self::F, b: Self::F) -> Self::F {
        // SAFETY: see above.
        unsafe { _mm256_castsi256_ps(_mm256_min_epi32(_mm256_castps_si256(a), _mm256_castps_si256(b))) }
    }
    #[inline(always)]
    fn farther(self, a: Self::F, b: Self::F) -> Self::F {
        // SAFETY: see above.
        unsafe { _mm256_castsi256_ps(_mm256_max_epi32(_mm256_castps_si256(a), _mm256_castps_si256(b))) }
    }
    #[inline(always)]
    fn le(self, a: Self::F, b: Self::F) -> Self::M {
        // SAFETY: see above.
        unsafe { _mm256_cmp_ps_mask::<_CMP_LE_OQ>(a, b) }
    }
    #[inline(always)]
    fn lt(self, a: Self::F, b: Self::F) -> Self::M {
        // SAFETY: see above.
        unsafe { _mm256_cmp_ps_mask::<_CMP_LT_OQ>(a, b) }
    }
    #[inline(always)]
    fn eq(self, a: Self::F, b: Self::F) -> Self::M {
        // SAFETY: see above.
        unsafe { _mm256_cmp_ps_mask::<_CMP_EQ_OQ>(a, b) }
    }
    #[inline(always)]
    fn and(self, a: Self::M, b: Self::M) -> Self::M {
        a & b
    }
    #[inline(always)]
    fn or(self, a: Self::M, b: Self::M) -> Self::M {
        a | b
    }
    #[inline(always)]
    fn bits(self, m: Self::M) -> u32 {
        u32::from(m)
    }
    #[inline(always)]
    fn mask(self, bits: u32) -> Self::M {
        bits as __mmask8
    }
    #[inline(always)]
    fn least(self, a: Self::F) -> f32 {
        // SAFETY: see above.
        unsafe {
            let a = _mm_min_ps(_mm256_castps256_ps128(a), _mm256_extractf128_ps::<1>(a));
            let a = _mm_min_ps(a, _mm_movehl_ps(a, a));
            _mm_cvtss_f32(_mm_min_ss(a, _mm_shuffle_ps::<1>(a, a)))
        }
    }
    #[inline(always)]
    fn greatest(self, a: Self::F) -> f32 {
        // SAFETY: see above.
        unsafe {
            let a = _mm_max_ps(_mm256_castps256_ps128(a), _mm256_extractf128_ps::<1>(a));
            let a = _mm_max_ps(a, _mm_movehl_ps(a, a));
            _mm_cvtss_f32(_mm_max_ss(a, _mm_shuffle_ps::<1>(a, a)))
        }
    }
    #[inline(always)]
    fn select(self, m: Self::M, a: Self::F, b: Self::F) -> Self::F {
        // SAFETY: see above.
        unsafe { _mm256_mask_blend_ps(m, b, a) }
    }
    #[inline(always)]
    fn read_from(self, wide: &Wide, first: usize) -> Self::F {
        // SAFETY: see above.
        unsafe { _mm256_load_ps(wide.lanes::<LANES>(first).as_ptr()) }
    }
    #[inline(always)]
    fn write_from(self, a: Self::F, wide: &mut Wide, first: usize) {
        // SAFETY: see above.
        unsafe { _mm256_store_ps(wide.lanes_mut::<LANES>(first).as_mut_ptr(), a) }
    }
}

impl Simd for Avx512 {
    #[inline(always)]
    fn load(self, row: &Row) -> Self::F {
        // SAFETY: see above.
        unsafe { _mm256_load_ps(row.0.as_ptr()) }
    }
    #[inline(always)]
    fn store(self, a: Self::F) -> [f32; LANES] {
        let mut out = [0.0; LANES];
        // SAFETY: see above.
        unsafe { _mm256_storeu_ps(out.as_mut_ptr(), a) };
        out
    }
    #[inline(always)]
    fn sort_descending(self, a: Self::F, chosen: u32, companions: &[u32; LANES]) -> ([u32; LANES], [u32; LANES]) {
        // SAFETY: see above.
        unsafe { sort_descending(keys(a, chosen), companions) }
    }
    #[inline(always)]
    fn nearest(self, a: Self::F, chosen: u32) -> usize {
        // SAFETY: see above.
        unsafe { nearest(keys(a, chosen)) }
    }
}

/// Keys of numbers that are at least +0. As signed integers they are not negative; lanes that are not chosen become -1.
///
/// # Safety
/// The machine must have AVX-512 F and VL.
#[inline(always)]
unsafe fn keys(a: __m256, chosen: u32) -> __m256i {
    // SAFETY: the caller promises AVX-512.
    unsafe {
        let lanes = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
        let keys = _mm256_or_si256(_mm256_andnot_si256(_mm256_set1_epi32(7), _mm256_castps_si256(a)), lanes);
        _mm256_mask_blend_epi32(chosen as __mmask8, _mm256_set1_epi32(-1), keys)
    }
}
