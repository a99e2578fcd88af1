//! Sixteen lanes in one 512-bit register, masks in mask registers: for packets of rays.
#![expect(unsafe_code, reason = "unchecked reads; each place states why it is sound")]

use super::{COLUMNS, Lanes, Wide};
use std::arch::x86_64::*;

/// Proof that the machine has AVX-512 F.
#[derive(Clone, Copy)]
pub(crate) struct Avx512Wide(());

impl Avx512Wide {
    /// Makes the token.
    ///
    /// # Safety
    /// The machine must have AVX-512 F.
    #[inline(always)]
    pub(crate) unsafe fn assume_supported() -> Self {
        Self(())
    }
}

// SAFETY (all blocks below): the token proves that the instructions exist; loads and stores go to whole arrays of
// sixteen `f32`.
impl Lanes for Avx512Wide {
    const COUNT: usize = 16;
    type Half = Self;
    type F = __m512;
    type M = __mmask16;

    #[inline(always)]
    fn half(self) -> Self {
        self
    }
    #[inline(always)]
    fn splat(self, x: f32) -> Self::F {
        // SAFETY: see above.
        unsafe { _mm512_set1_ps(x) }
    }
    #[inline(always)]
    fn add(self, a: Self::F, b: Self::F) -> Self::F {
        // SAFETY: see above.
        unsafe { _mm512_add_ps(a, b) }
    }
    #[inline(always)]
    fn sub(self, a: Self::F, b: Self::F) -> Self::F {
        // SAFETY: see above.
        unsafe { _mm512_sub_ps(a, b) }
    }
    #[inline(always)]
    fn mul(self, a: Self::F, b: Self::F) -> Self::F {
        // SAFETY: see above.
        unsafe { _mm512_mul_ps(a, b) }
    }
    #[inline(always)]
    fn mul_add(self, a: Self::F, b: Self::F, c: Self::F) -> Self::F {
        // SAFETY: see above.
        unsafe { _mm512_fmadd_ps(a, b, c) }
    }
    #[inline(always)]
    fn div(self, a: Self::F, b: Self::F) -> Self::F {
        // SAFETY: see above.
        unsafe { _mm512_div_ps(a, b) }
    }
    #[inline(always)]
    fn min(self, a: Self::F, b: Self::F) -> Self::F {
        // SAFETY: see above.
        unsafe { _mm512_min_ps(a, b) }
    }
    #[inline(always)]
    fn max(self, a: Self::F, b: Self::F) -> Self::F {
        // SAFETY: see above.
        unsafe { _mm512_max_ps(a, b) }
    }
    #[inline(always)]
    fn nearer(self, a: Self::F, b: Self::F) -> Self::F {
        // SAFETY: see above.
        unsafe { _mm512_castsi512_ps(_mm512_min_epi32(_mm512_castps_si512(a), _mm512_castps_si512(b))) }
    }
    #[inline(always)]
    fn farther(self, a: Self::F, b: Self::F) -> Self::F {
        // SAFETY: see above.
        unsafe { _mm512_castsi512_ps(_mm512_max_epi32(_mm512_castps_si512(a), _mm512_castps_si512(b))) }
    }
    #[inline(always)]
    fn le(self, a: Self::F, b: Self::F) -> Self::M {
        // SAFETY: see above.
        unsafe { _mm512_cmp_ps_mask::<_CMP_LE_OQ>(a, b) }
    }
    #[inline(always)]
    fn lt(self, a: Self::F, b: Self::F) -> Self::M {
        // SAFETY: see above.
        unsafe { _mm512_cmp_ps_mask::<_CMP_LT_OQ>(a, b) }
    }
    #[inline(always)]
    fn eq(self, a: Self::F, b: Self::F) -> Self::M {
        // SAFETY: see above.
        unsafe { _mm512_cmp_ps_mask::<_CMP_EQ_OQ>(a, b) }
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
        bits as __mmask16
    }
    #[inline(always)]
    fn least(self, a: Self::F) -> f32 {
        // SAFETY: see above.
        unsafe { _mm512_reduce_min_ps(a) }
    }
    #[inline(always)]
    fn greatest(self, a: Self::F) -> f32 {
        // SAFETY: see above.
        unsafe { _mm512_reduce_max_ps(a) }
    }
    #[inline(always)]
    fn select(self, m: Self::M, a: Self::F, b: Self::F) -> Self::F {
        // SAFETY: see above.
        unsafe { _mm512_mask_blend_ps(m, b, a) }
    }
    #[inline(always)]
    fn read_from(self, wide: &Wide, first: usize) -> Self::F {
        // SAFETY: see above.
        unsafe { _mm512_load_ps(wide.lanes::<16>(first).as_ptr()) }
    }
    #[inline(always)]
    fn write_from(self, a: Self::F, wide: &mut Wide, first: usize) {
        // SAFETY: see above.
        unsafe { _mm512_store_ps(wide.lanes_mut::<16>(first).as_mut_ptr(), a) }
    }
    #[inline(always)]
    fn columns(self, rows: &[[f32; COLUMNS]]) -> [Self::F; COLUMNS] {
        let rows = &rows[..Self::COUNT];
        // SAFETY: see above, and there are as many rows as lanes.
        unsafe {
            let [a, b, c, d] = transposed(quarters(rows, 0));
            let [e, f, g, h] = transposed(quarters(rows, 4));
            [a, b, c, d, e, f, g, h]
        }
    }
}

/// Four columns of sixteen rows: in each register those of every fourth row.
///
/// # Safety
/// The machine must have AVX-512 F, and there must be sixteen rows with these columns.
#[inline(always)]
unsafe fn quarters(rows: &[[f32; COLUMNS]], column: usize) -> [__m512; 4] {
    debug_assert!(rows.len() >= Avx512Wide::COUNT && column + 4 <= COLUMNS);
    // SAFETY: the caller's promise.
    unsafe {
        let mut parts = [_mm512_setzero_ps(); 4];
        for (row, part) in parts.iter_mut().enumerate() {
            let first = rows.as_ptr().add(row).cast::<f32>().add(column);
            *part = _mm512_castps128_ps512(_mm_loadu_ps(first));
            *part = _mm512_insertf32x4::<1>(*part, _mm_loadu_ps(first.add(4 * COLUMNS)));
            *part = _mm512_insertf32x4::<2>(*part, _mm_loadu_ps(first.add(8 * COLUMNS)));
            *part = _mm512_insertf32x4::<3>(*part, _mm_loadu_ps(first.add(12 * COLUMNS)));
        }
        parts
    }
}

/// The columns of the four by four numbers in each quarter of some registers.
///
/// # Safety
/// The machine must have AVX-512 F.
#[inline(always)]
unsafe fn transposed([a, b, c, d]: [__m512; 4]) -> [__m512; 4] {
    // SAFETY: the caller's promise.
    unsafe {
        let (ab, cd) = (_mm512_unpacklo_ps(a, b), _mm512_unpacklo_ps(c, d));
        let (high_ab, high_cd) = (_mm512_unpackhi_ps(a, b), _mm512_unpackhi_ps(c, d));
        [
            _mm512_shuffle_ps::<0b01_00_01_00>(ab, cd),
            _mm512_shuffle_ps::<0b11_10_11_10>(ab, cd),
            _mm512_shuffle_ps::<0b01_00_01_00>(high_ab, high_cd),
            _mm512_shuffle_ps::<0b11_10_11_10>(high_ab, high_cd),
        ]
    }
}
