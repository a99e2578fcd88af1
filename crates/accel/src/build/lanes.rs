//! Binning with a box in one register: its least corner and its greatest one with the sign changed, so that one minimum makes the box
//! around two of them. The same numbers as without.
#![allow(unsafe_code)]

use super::primitives::{PrimRef, Span};
use super::split::{Bins, Cut, Extent, Grid};
use glam::Vec3A;
use std::arch::x86_64::*;
use steradian_math::Bounds3;

/// The bins of some primitives, if the machine has the instructions.
#[inline]
pub(super) fn bins<const BINS: usize>(refs: &[PrimRef], grid: Grid) -> Option<Bins<BINS>> {
    // SAFETY: the machine has the instructions.
    is_x86_feature_detected!("avx2").then(|| unsafe { unfolded_bins(refs, grid) })
}

/// See [`Bins::cheapest`], if the machine has the instructions.
#[inline]
pub(super) fn cheapest<const BINS: usize>(
    refs: &[PrimRef],
    extent: &Extent,
    scale: f32,
    grid: Grid,
) -> Option<Option<Cut>> {
    // SAFETY: the machine has the instructions.
    is_x86_feature_detected!("avx2").then(|| unsafe { cheapest_cut::<BINS>(refs, extent, scale, grid) })
}

/// See [`Cut::partition_one_by_one`], if the machine has the instructions.
#[inline]
pub(super) fn partition(cut: &Cut, refs: &mut [PrimRef]) -> Option<(usize, [Bounds3; 2])> {
    // SAFETY: the machine has the instructions.
    is_x86_feature_detected!("avx2").then(|| unsafe { partitioned(cut, refs) })
}

/// What finds the bins of primitives.
#[derive(Clone, Copy)]
struct Places {
    origin: __m128,
    scale: __m128,
    last: __m128i,
}

impl Places {
    #[target_feature(enable = "avx2")]
    fn new(grid: Grid, bins: usize) -> Self {
        let last = _mm_set1_epi32(grid.count.min(bins) as i32 - 1);
        Self { origin: grid.origin.into(), scale: grid.scale.into(), last }
    }

    /// The centre of a box and its bins along all axes.
    #[target_feature(enable = "avx2")]
    fn of(&self, [low, high]: [__m128; 2]) -> (__m128, __m128i) {
        let half = _mm_set1_ps(0.5);
        let center = _mm_add_ps(_mm_mul_ps(low, half), _mm_mul_ps(high, half));
        let place = _mm_mul_ps(_mm_sub_ps(center, self.origin), self.scale);
        // What is not a number becomes zero, as in a cast; what is too large is a large number without a sign.
        (center, _mm_min_epu32(_mm_cvttps_epi32(_mm_max_ps(place, _mm_setzero_ps())), self.last))
    }
}

#[target_feature(enable = "avx2")]
fn partitioned(cut: &Cut, refs: &mut [PrimRef]) -> (usize, [Bounds3; 2]) {
    let places = Places::new(cut.grid, cut.grid.count);
    let (axis, border) = (_mm_set1_epi32(cut.axis as i32), _mm_set1_epi32(cut.bin as i32));
    let (mut left, mut right) = (empty(), empty());
    let mut middle = 0;
    const { assert!(size_of::<PrimRef>() == size_of::<__m256>()) };
    let first: *mut f32 = refs.as_mut_ptr().cast();
    for i in 0..refs.len() {
        // SAFETY: a reference is eight `f32`, and the middle is never beyond the present place. Whole references are read and written:
        // one that has just been written in halves would be waited for.
        let (own, first_of_second, r) = unsafe {
            let own = first.add(8 * i);
            (own, first.add(8 * middle), _mm256_loadu_ps(own))
        };
        let (center, bins) = places.of([_mm256_castps256_ps128(r), _mm256_extractf128_ps::<1>(r)]);
        let bin = _mm_castps_si128(_mm_permutevar_ps(_mm_castsi128_ps(bins), axis));
        let is_first = _mm_cmpgt_epi32(border, bin);
        let mask = _mm256_castsi256_ps(_mm256_set_m128i(is_first, is_first));
        let center = folded(center, center);
        left = _mm256_min_ps(left, _mm256_blendv_ps(empty(), center, mask));
        right = _mm256_min_ps(right, _mm256_blendv_ps(center, empty(), mask));
        // SAFETY: as above.
        unsafe {
            _mm256_storeu_ps(own, _mm256_loadu_ps(first_of_second));
            _mm256_storeu_ps(first_of_second, r);
        }
        middle += (_mm_cvtsi128_si32(is_first) & 1) as usize;
    }
    (middle, [unfolded(left).bounds(), unfolded(right).bounds()])
}

#[target_feature(enable = "avx2")]
fn unfolded_bins<const BINS: usize>(refs: &[PrimRef], grid: Grid) -> Bins<BINS> {
    let mut folded = Folded::new();
    folded.add(refs, grid);
    Bins { bounds: folded.boxes.map(|axis| axis.map(|own| unfolded(own))), counts: folded.counts }
}

#[target_feature(enable = "avx2")]
fn cheapest_cut<const BINS: usize>(refs: &[PrimRef], extent: &Extent, scale: f32, grid: Grid) -> Option<Cut> {
    let mut folded = Folded::<BINS>::new();
    folded.add(refs, grid);
    folded.cheapest(refs.len() as u32, extent, scale, grid)
}

/// Bins whose boxes have the sign of their greatest corner changed.
struct Folded<const BINS: usize> {
    boxes: [[__m256; BINS]; 3],
    counts: [[u32; BINS]; 3],
}

impl<const BINS: usize> Folded<BINS> {
    #[target_feature(enable = "avx2")]
    fn new() -> Self {
        Self { boxes: [[empty(); BINS]; 3], counts: [[0; BINS]; 3] }
    }

    #[target_feature(enable = "avx2")]
    fn add(&mut self, refs: &[PrimRef], grid: Grid) {
        let places = Places::new(grid, BINS);
        for r in refs {
            let [low, high] = r.lanes();
            let (_, bin) = places.of([low, high]);
            let bin = [_mm_cvtsi128_si32(bin), _mm_extract_epi32::<1>(bin), _mm_extract_epi32::<2>(bin)];
            let span = folded(low, high);
            for axis in 0..3 {
                // SAFETY: bins are at most the last.
                let (own, count) = unsafe {
                    let bin = bin[axis] as usize;
                    (self.boxes[axis].get_unchecked_mut(bin), self.counts[axis].get_unchecked_mut(bin))
                };
                *own = _mm256_min_ps(*own, span);
                *count += 1;
            }
        }
    }

    /// The cheapest cut of so many primitives.
    #[target_feature(enable = "avx2")]
    fn cheapest(&self, total: u32, extent: &Extent, scale: f32, grid: Grid) -> Option<Cut> {
        let (mut best, mut best_cost, mut best_parts) = (None, f32::INFINITY, [empty(); 2]);
        let used = grid.count.min(BINS);
        for axis in 0..3 {
            let (boxes, counts) = (&self.boxes[axis], &self.counts[axis]);
            // All second parts, from the end.
            let (mut after, mut bounds) = ([empty(); BINS], empty());
            for bin in (1..used).rev() {
                bounds = _mm256_min_ps(bounds, boxes[bin]);
                after[bin] = bounds;
            }
            let (mut bounds, mut count) = (empty(), 0);
            for bin in 1..used {
                bounds = _mm256_min_ps(bounds, boxes[bin - 1]);
                count += counts[bin - 1];
                let tests = [extent.tests(count), extent.tests(total - count)];
                let cost = cost([bounds, after[bin]], tests, scale);
                if count > 0 && count < total && cost < best_cost {
                    (best_cost, best_parts) = (cost, [bounds, after[bin]]);
                    best = Some((axis, bin));
                }
            }
        }
        let (axis, bin) = best?;
        let [left, right] = best_parts;
        Some(Cut { grid, axis, bin, cost: best_cost, bounds: [unfolded(left).bounds(), unfolded(right).bounds()] })
    }
}

/// A box with the sign of its greatest corner changed.
#[target_feature(enable = "avx2")]
fn folded(low: __m128, high: __m128) -> __m256 {
    _mm256_xor_ps(_mm256_set_m128(high, low), signs())
}

/// The same as others see it.
#[target_feature(enable = "avx2")]
fn unfolded(folded: __m256) -> Span {
    let own = _mm256_xor_ps(folded, signs());
    Span { min: Vec3A::from(_mm256_castps256_ps128(own)), max: Vec3A::from(_mm256_extractf128_ps::<1>(own)) }
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

/// The sum of the areas ([`super::split::half_area`]) of two boxes that are not empty times the tests of each.
#[target_feature(enable = "avx2")]
fn cost([left, right]: [__m256; 2], tests: [f32; 2], scale: f32) -> f32 {
    let half = _mm256_set1_ps(0.5);
    let (left, right) = (_mm256_mul_ps(left, half), _mm256_mul_ps(right, half));
    // The lengths with a sign, which products lose.
    let sum = _mm256_add_ps(_mm256_permute2f128_ps::<0x20>(left, right), _mm256_permute2f128_ps::<0x31>(left, right));
    let d = _mm256_mul_ps(sum, _mm256_set1_ps(scale));
    // x·y, y·z and z·x.
    let faces = _mm256_mul_ps(d, _mm256_permute_ps::<0b11_00_10_01>(d));
    let (second, third) = (_mm256_permute_ps::<0b01>(faces), _mm256_permute_ps::<0b10>(faces));
    let areas = _mm256_add_ps(_mm256_add_ps(faces, second), third);
    let (left, right) = (_mm256_castps256_ps128(areas), _mm256_extractf128_ps::<1>(areas));
    _mm_cvtss_f32(left) * tests[0] + _mm_cvtss_f32(right) * tests[1]
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
            if let Some(cut) = cut {
                let mut parts = [refs.clone(), refs];
                let [plain, wide] = &mut parts;
                assert_eq!(partition(&cut, wide), Some(cut.partition_one_by_one(plain)), "{round}");
                let indices = parts.map(|refs| refs.iter().map(PrimRef::index).collect::<Vec<_>>());
                assert_eq!(indices[0], indices[1], "{round}");
            }
        }
        assert!(cuts > 300 && none > 0, "{cuts} {none}");
    }
}
