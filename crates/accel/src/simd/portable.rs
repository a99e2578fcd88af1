//! Plain arrays: the baseline where there is no better one, and the reference for the others in tests.

use super::{LANES, Lanes, Row, Simd, Wide};
use std::array::from_fn;

/// Lanes as arrays.
#[derive(Clone, Copy)]
pub(crate) struct Portable;

impl Lanes for Portable {
    const COUNT: usize = LANES;
    type Half = Self;
    type F = [f32; LANES];
    type M = [bool; LANES];

    #[inline(always)]
    fn half(self) -> Self {
        self
    }
    #[inline(always)]
    fn splat(self, x: f32) -> Self::F {
        [x; LANES]
    }
    #[inline(always)]
    fn add(self, a: Self::F, b: Self::F) -> Self::F {
        from_fn(|i| a[i] + b[i])
    }
    #[inline(always)]
    fn sub(self, a: Self::F, b: Self::F) -> Self::F {
        from_fn(|i| a[i] - b[i])
    }
    #[inline(always)]
    fn mul(self, a: Self::F, b: Self::F) -> Self::F {
        from_fn(|i| a[i] * b[i])
    }
    #[inline(always)]
    fn mul_add(self, a: Self::F, b: Self::F, c: Self::F) -> Self::F {
        self.add(self.mul(a, b), c)
    }
    #[inline(always)]
    fn div(self, a: Self::F, b: Self::F) -> Self::F {
        from_fn(|i| a[i] / b[i])
    }
    #[inline(always)]
    fn min(self, a: Self::F, b: Self::F) -> Self::F {
        from_fn(|i| if a[i] < b[i] { a[i] } else { b[i] })
    }
    #[inline(always)]
    fn max(self, a: Self::F, b: Self::F) -> Self::F {
        from_fn(|i| if a[i] > b[i] { a[i] } else { b[i] })
    }
    #[inline(always)]
    fn le(self, a: Self::F, b: Self::F) -> Self::M {
        from_fn(|i| a[i] <= b[i])
    }
    #[inline(always)]
    fn lt(self, a: Self::F, b: Self::F) -> Self::M {
        from_fn(|i| a[i] < b[i])
    }
    #[inline(always)]
    fn eq(self, a: Self::F, b: Self::F) -> Self::M {
        from_fn(|i| a[i] == b[i])
    }
    #[inline(always)]
    fn and(self, a: Self::M, b: Self::M) -> Self::M {
        from_fn(|i| a[i] & b[i])
    }
    #[inline(always)]
    fn or(self, a: Self::M, b: Self::M) -> Self::M {
        from_fn(|i| a[i] | b[i])
    }
    #[inline(always)]
    fn bits(self, m: Self::M) -> u32 {
        m.iter().rev().fold(0, |bits, &lane| bits << 1 | u32::from(lane))
    }
    #[inline(always)]
    fn mask(self, bits: u32) -> Self::M {
        from_fn(|i| bits >> i & 1 == 1)
    }
    #[inline(always)]
    fn least(self, a: Self::F) -> f32 {
        a.into_iter().fold(f32::INFINITY, f32::min)
    }
    #[inline(always)]
    fn greatest(self, a: Self::F) -> f32 {
        a.into_iter().fold(f32::NEG_INFINITY, f32::max)
    }
    #[inline(always)]
    fn select(self, m: Self::M, a: Self::F, b: Self::F) -> Self::F {
        from_fn(|i| if m[i] { a[i] } else { b[i] })
    }
    #[inline(always)]
    fn read_from(self, wide: &Wide, first: usize) -> Self::F {
        *wide.lanes(first)
    }
    #[inline(always)]
    fn write_from(self, a: Self::F, wide: &mut Wide, first: usize) {
        *wide.lanes_mut(first) = a;
    }
}

impl Simd for Portable {
    #[inline(always)]
    fn load(self, row: &Row) -> Self::F {
        row.0
    }
    #[inline(always)]
    fn store(self, a: Self::F) -> [f32; LANES] {
        a
    }
}
