//! Lanes in two 128-bit registers: the baseline of x86-64.
#![allow(unsafe_code)]

use super::{LANES, Row, Simd};
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

// SAFETY (all blocks below): the token proves that the instructions exist; loads and stores go to whole arrays of eight `f32`.
impl Simd for Sse2 {
    type F = [__m128; 2];
    type M = [__m128; 2];

    #[inline(always)]
    fn splat(self, x: f32) -> Self::F {
        // SAFETY: see above.
        unsafe { [_mm_set1_ps(x); 2] }
    }
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
}
