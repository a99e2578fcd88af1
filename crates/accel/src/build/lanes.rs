//! Binning with a box in one register: its least corner and its greatest one with the sign changed, so that one minimum makes the box
//! around two of them. The same numbers as without.
#![allow(unsafe_code)]

use super::primitives::{PrimRef, Span};
use super::split::{Bins, Grid};
use glam::Vec3A;
use std::arch::x86_64::*;

/// The bins of some primitives, if the machine has the instructions.
#[inline]
pub(super) fn bins<const BINS: usize>(refs: &[PrimRef], grid: Grid) -> Option<Bins<BINS>> {
    // SAFETY: the machine has the instructions.
    is_x86_feature_detected!("avx2").then(|| unsafe { bins_avx2(refs, grid) })
}

#[target_feature(enable = "avx2")]
fn bins_avx2<const BINS: usize>(refs: &[PrimRef], grid: Grid) -> Bins<BINS> {
    let signs = _mm256_setr_ps(0.0, 0.0, 0.0, 0.0, -0.0, -0.0, -0.0, -0.0);
    let mut boxes = [[_mm256_set1_ps(f32::INFINITY); BINS]; 3];
    let mut counts = [[0; BINS]; 3];
    let (origin, scale) = (__m128::from(grid.origin), __m128::from(grid.scale));
    let last = _mm_set1_epi32(grid.count.min(BINS) as i32 - 1);
    for r in refs {
        let [low, high] = r.lanes();
        let center = _mm_add_ps(_mm_mul_ps(low, _mm_set1_ps(0.5)), _mm_mul_ps(high, _mm_set1_ps(0.5)));
        let place = _mm_mul_ps(_mm_sub_ps(center, origin), scale);
        // What is not a number becomes zero, as in a cast; what is too large is a large number without a sign.
        let bin = _mm_min_epu32(_mm_cvttps_epi32(_mm_max_ps(place, _mm_setzero_ps())), last);
        let bin = [_mm_cvtsi128_si32(bin), _mm_extract_epi32::<1>(bin), _mm_extract_epi32::<2>(bin)];
        let span = _mm256_xor_ps(_mm256_set_m128(high, low), signs);
        for axis in 0..3 {
            // SAFETY: bins are at most the last.
            let (own, count) = unsafe {
                let bin = bin[axis] as usize;
                (boxes[axis].get_unchecked_mut(bin), counts[axis].get_unchecked_mut(bin))
            };
            *own = _mm256_min_ps(*own, span);
            *count += 1;
        }
    }
    let span = |own: __m256| {
        let own = _mm256_xor_ps(own, signs);
        Span { min: Vec3A::from(_mm256_castps256_ps128(own)), max: Vec3A::from(_mm256_extractf128_ps::<1>(own)) }
    };
    Bins { bounds: boxes.map(|axis| axis.map(span)), counts }
}
