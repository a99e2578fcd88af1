//! Lanes in two 128-bit registers: the baseline of x86-64.
#![expect(unsafe_code, reason = "unchecked reads; each place states why it is sound")]

use super::{LANES, Lanes, Row, Simd, Wide};
use std::arch::x86_64::*;

/// Proof that the machine has SSE2, as every x86-64 does.
#[derive(Clone, Copy)]
pub(crate) struct Sse2(());

impl Sse2 {
    /// Makes the token.
    ///
    /// # Safety
    /// The machine must have SSE2, as every x86-64 does.
    #[inline(always)]
    pub(crate) unsafe fn assume_supported() -> Self {
        Self(())
    }
}

// SAFETY (all blocks below): the token proves that the instructions exist; loads and stores go to whole arrays of eight
// `f32`.
impl Lanes for Sse2 {
    const COUNT: usize = LANES;
    type Half = Self;
    type F = [__m128; 2];
    type M = [__m128; 2];

    #[inline(always)]
    fn half(self) -> Self {
        self
    }
    #[inline(always)]
    fn splat(self, x: f32) -> Self::F {
        // SAFETY: see above.
        unsafe { [_mm_set1_ps(x); 2] }
    }
    #[inline(always)]
    fn add(self, a: Self::F, b: Self::F) -> Self::F {
        // SAFETY: see above.
        unsafe { [_mm_add_ps(a[0], b[0]), _mm_add_ps(a[1], b[1])] }
    }
    #[inline(always)]
    fn sub(self, a: Self::F, b: Self::F) -> Self::F {
        // SAFETY: see above.
        unsafe { [_mm_sub_ps(a[0], b[0]), _mm_sub_ps(a[1], b[1])] }
    }
    #[inline(always)]
    fn mul(self, a: Self::F, b: Self::F) -> Self::F {
        // SAFETY: see above.
        unsafe { [_mm_mul_ps(a[0], b[0]), _mm_mul_ps(a[1], b[1])] }
    }
    #[inline(always)]
    fn mul_add(self, a: Self::F, b: Self::F, c: Self::F) -> Self::F {
        self.add(self.mul(a, b), c)
    }
    #[inline(always)]
    fn div(self, a: Self::F, b: Self::F) -> Self::F {
        // SAFETY: see above.
        unsafe { [_mm_div_ps(a[0], b[0]), _mm_div_ps(a[1], b[1])] }
    }
    #[inline(always)]
    fn min(self, a: Self::F, b: Self::F) -> Self::F {
        // SAFETY: see above.
        unsafe { [_mm_min_ps(a[0], b[0]), _mm_min_ps(a[1], b[1])] }
    }
    #[inline(always)]
    fn max(self, a: Self::F, b: Self::F) -> Self::F {
        // SAFETY: see above.
        unsafe { [_mm_max_ps(a[0], b[0]), _mm_max_ps(a[1], b[1])] }
    }
    #[inline(always)]
    fn le(self, a: Self::F, b: Self::F) -> Self::M {
        // SAFETY: see above.
        unsafe { [_mm_cmple_ps(a[0], b[0]), _mm_cmple_ps(a[1], b[1])] }
    }
    #[inline(always)]
    fn lt(self, a: Self::F, b: Self::F) -> Self::M {
        // SAFETY: see above.
        unsafe { [_mm_cmplt_ps(a[0], b[0]), _mm_cmplt_ps(a[1], b[1])] }
    }
    #[inline(always)]
    fn eq(self, a: Self::F, b: Self::F) -> Self::M {
        // SAFETY: see above.
        unsafe { [_mm_cmpeq_ps(a[0], b[0]), _mm_cmpeq_ps(a[1], b[1])] }
    }
    #[inline(always)]
    fn and(self, a: Self::M, b: Self::M) -> Self::M {
        // SAFETY: see above.
        unsafe { [_mm_and_ps(a[0], b[0]), _mm_and_ps(a[1], b[1])] }
    }
    #[inline(always)]
    fn or(self, a: Self::M, b: Self::M) -> Self::M {
        // SAFETY: see above.
        unsafe { [_mm_or_ps(a[0], b[0]), _mm_or_ps(a[1], b[1])] }
    }
    #[inline(always)]
    fn bits(self, m: Self::M) -> u32 {
        // SAFETY: see above.
        unsafe { (_mm_movemask_ps(m[0]) | _mm_movemask_ps(m[1]) << 4) as u32 }
    }
    #[inline(always)]
    fn mask(self, bits: u32) -> Self::M {
        // SAFETY: see above.
        unsafe {
            let bits = _mm_set1_epi32(bits as i32);
            let (low, high) = (_mm_setr_epi32(1, 2, 4, 8), _mm_setr_epi32(16, 32, 64, 128));
            [
                _mm_castsi128_ps(_mm_cmpeq_epi32(_mm_and_si128(bits, low), low)),
                _mm_castsi128_ps(_mm_cmpeq_epi32(_mm_and_si128(bits, high), high)),
            ]
        }
    }
    #[inline(always)]
    fn least(self, a: Self::F) -> f32 {
        // SAFETY: see above.
        unsafe {
            let a = _mm_min_ps(a[0], a[1]);
            let a = _mm_min_ps(a, _mm_movehl_ps(a, a));
            _mm_cvtss_f32(_mm_min_ss(a, _mm_shuffle_ps::<1>(a, a)))
        }
    }
    #[inline(always)]
    fn greatest(self, a: Self::F) -> f32 {
        // SAFETY: see above.
        unsafe {
            let a = _mm_max_ps(a[0], a[1]);
            let a = _mm_max_ps(a, _mm_movehl_ps(a, a));
            _mm_cvtss_f32(_mm_max_ss(a, _mm_shuffle_ps::<1>(a, a)))
        }
    }
    #[inline(always)]
    fn select(self, m: Self::M, a: Self::F, b: Self::F) -> Self::F {
        // SAFETY: see above.
        unsafe {
            [
                _mm_or_ps(_mm_and_ps(m[0], a[0]), _mm_andnot_ps(m[0], b[0])),
                _mm_or_ps(_mm_and_ps(m[1], a[1]), _mm_andnot_ps(m[1], b[1])),
            ]
        }
    }
    #[inline(always)]
    fn read_from(self, wide: &Wide, first: usize) -> Self::F {
        let lanes = wide.lanes::<LANES>(first);
        // SAFETY: see above.
        unsafe { [_mm_load_ps(lanes.as_ptr()), _mm_load_ps(lanes.as_ptr().add(4))] }
    }
    #[inline(always)]
    fn write_from(self, a: Self::F, wide: &mut Wide, first: usize) {
        let lanes = wide.lanes_mut::<LANES>(first);
        // SAFETY: see above.
        unsafe {
            _mm_store_ps(lanes.as_mut_ptr(), a[0]);
            _mm_store_ps(lanes.as_mut_ptr().add(4), a[1]);
        }
    }
}

impl Simd for Sse2 {
    #[inline(always)]
    fn load(self, row: &Row) -> Self::F {
        // SAFETY: see above.
        unsafe { [_mm_load_ps(row.0.as_ptr()), _mm_load_ps(row.0.as_ptr().add(4))] }
    }
    #[inline(always)]
    fn store(self, a: Self::F) -> [f32; LANES] {
        let mut out = [0.0; LANES];
        // SAFETY: see above.
        unsafe {
            _mm_storeu_ps(out.as_mut_ptr(), a[0]);
            _mm_storeu_ps(out.as_mut_ptr().add(4), a[1]);
        }
        out
    }
}
