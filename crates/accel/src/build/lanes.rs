//! Binning with a box in one register: its least corner and its greatest one with the sign changed, so that one minimum makes the box
//! around two of them. The same numbers as without.
#![allow(unsafe_code)]

use super::primitives::{PrimRef, Span};
use super::split::{Bins, Extent, Grid};
use glam::Vec3A;
use std::arch::x86_64::*;

/// The bins of some primitives, if the machine has the instructions.
#[inline]
pub(super) fn bins<const BINS: usize>(refs: &[PrimRef], grid: Grid) -> Option<Bins<BINS>> {
    // SAFETY: the machine has the instructions.
    is_x86_feature_detected!("avx2").then(|| unsafe { Folded::of(refs, grid).unfolded() })
}

/// The cheapest cut between bins: its cost, its axis and the first bin of the second part, none if no cut has two sides; and whether the
/// machine has the instructions.
#[inline]
pub(super) fn cheapest<const BINS: usize>(
    refs: &[PrimRef],
    extent: &Extent,
    scale: f32,
    grid: Grid,
) -> Option<Option<(f32, usize, usize)>> {
    // SAFETY: the machine has the instructions.
    is_x86_feature_detected!("avx2").then(|| unsafe { Folded::<BINS>::of(refs, grid).cheapest(extent, scale, grid) })
}

/// Bins whose boxes have the sign of their greatest corner changed.
struct Folded<const BINS: usize> {
    boxes: [[__m256; BINS]; 3],
    counts: [[u32; BINS]; 3],
}

impl<const BINS: usize> Folded<BINS> {
    #[target_feature(enable = "avx2")]
    fn of(refs: &[PrimRef], grid: Grid) -> Self {
        let signs = signs();
        let mut bins = Self { boxes: [[empty(); BINS]; 3], counts: [[0; BINS]; 3] };
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
                    (bins.boxes[axis].get_unchecked_mut(bin), bins.counts[axis].get_unchecked_mut(bin))
                };
                *own = _mm256_min_ps(*own, span);
                *count += 1;
            }
        }
        bins
    }

    #[target_feature(enable = "avx2")]
    fn unfolded(&self) -> Bins<BINS> {
        let span = |own: __m256| {
            let own = _mm256_xor_ps(own, signs());
            Span { min: Vec3A::from(_mm256_castps256_ps128(own)), max: Vec3A::from(_mm256_extractf128_ps::<1>(own)) }
        };
        Bins { bounds: self.boxes.map(|axis| axis.map(span)), counts: self.counts }
    }

    #[target_feature(enable = "avx2")]
    fn cheapest(&self, extent: &Extent, scale: f32, grid: Grid) -> Option<(f32, usize, usize)> {
        let (mut best, mut best_cost) = (None, f32::INFINITY);
        let used = grid.count.min(BINS);
        for axis in 0..3 {
            let (boxes, counts) = (&self.boxes[axis], &self.counts[axis]);
            // Costs of all second parts, from the end.
            let mut costs = [0.0_f32; BINS];
            let (mut bounds, mut count) = (empty(), 0);
            for bin in (1..used).rev() {
                bounds = _mm256_min_ps(bounds, boxes[bin]);
                count += counts[bin];
                costs[bin] = if count == 0 { f32::INFINITY } else { half_area(bounds, scale) * extent.tests(count) };
            }
            let (mut bounds, mut count) = (empty(), 0);
            for bin in 1..used {
                bounds = _mm256_min_ps(bounds, boxes[bin - 1]);
                count += counts[bin - 1];
                let cost = half_area(bounds, scale) * extent.tests(count) + costs[bin];
                if count > 0 && cost < best_cost {
                    best_cost = cost;
                    best = Some((cost, axis, bin));
                }
            }
        }
        best
    }
}

/// What changes the sign of the greatest corner.
#[target_feature(enable = "avx2")]
fn signs() -> __m256 {
    _mm256_setr_ps(0.0, 0.0, 0.0, 0.0, -0.0, -0.0, -0.0, -0.0)
}

/// A box without a point.
#[target_feature(enable = "avx2")]
fn empty() -> __m256 {
    _mm256_set1_ps(f32::INFINITY)
}

/// See [`super::split::half_area`]; of a box that is not empty.
#[target_feature(enable = "avx2")]
fn half_area(folded: __m256, scale: f32) -> f32 {
    let half = _mm256_mul_ps(folded, _mm256_set1_ps(0.5));
    // The lengths with a sign, which products lose.
    let sum = _mm_add_ps(_mm256_castps256_ps128(half), _mm256_extractf128_ps::<1>(half));
    let d = _mm_mul_ps(sum, _mm_set1_ps(scale));
    // x·y, y·z and z·x.
    let faces = _mm_mul_ps(d, _mm_shuffle_ps::<0b11_00_10_01>(d, d));
    let second = _mm_shuffle_ps::<0b01>(faces, faces);
    _mm_cvtss_f32(_mm_add_ss(_mm_add_ss(faces, second), _mm_movehl_ps(faces, faces)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Geometry;
    use crate::build::Primitives;
    use steradian_math::hash::HashRng;
    use steradian_math::{Bounds3, Vec3};

    #[test]
    fn wide_registers_change_no_bit() {
        let mut rng = HashRng::new(29);
        let (mut cuts, mut none) = (0, 0);
        for round in 0..400 {
            let size = [1.0, 1e-30, 1e6, 3e38][round % 4];
            let mut number = || {
                let x = rng.next_f32() * 2.0 - 1.0;
                if round % 3 == 0 { (x * 3.0).round() / 3.0 } else { x }
            };
            let mut point = || Vec3::new(number(), number(), number()) * size;
            let boxes: Vec<_> = (0..1 + round).map(|_| Bounds3::from_points([point(), point()])).collect();
            let refs = Primitives::new(&[Geometry::boxes(&boxes)]).expect("few boxes").refs();
            let extent = Extent::of(&refs);
            let grid = Grid::new(&extent.centers, refs.len());
            let plain = Bins::<32>::one_by_one(&refs, grid);
            let Some(wide) = bins::<32>(&refs, grid) else { return };
            assert_eq!(plain.counts, wide.counts, "{round}");
            let bounds = |bins: &Bins<32>| bins.bounds.map(|axis| axis.map(Span::bounds));
            assert_eq!(bounds(&plain), bounds(&wide), "{round}");
            let scale = crate::build::binary::scale(&extent.bounds);
            let cut = plain.cheapest(&extent, scale, grid);
            assert_eq!(cheapest::<32>(&refs, &extent, scale, grid), Some(cut), "{round}");
            *if cut.is_some() { &mut cuts } else { &mut none } += 1;
        }
        assert!(cuts > 300 && none > 0, "{cuts} {none}");
    }
}
