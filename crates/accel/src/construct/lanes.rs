//! Binning with a box in one register: its least corner and its greatest one with the sign changed, so that one minimum
//! makes the box around two of them. The same numbers as without.
#![expect(unsafe_code, reason = "unchecked reads; each place states why it is sound")]

use super::primitives::{PrimRef, Span};
use super::split::{Bins, Cut, Extent, Grid, HALVES, MAX_BINS, MIN_BINS};
use crate::simd::LANES;
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
pub(super) fn cheapest(refs: &[PrimRef], extent: &Extent, scale: f32, grid: Grid) -> Option<Option<Cut>> {
    // SAFETY: the machine has the instructions.
    is_x86_feature_detected!("avx2").then(|| unsafe {
        match grid.count {
            HALVES => cheapest_half(refs, extent, scale, grid),
            MIN_BINS => cheapest_cut::<MIN_BINS>(refs, extent, scale, grid),
            _ => cheapest_cut::<MAX_BINS>(refs, extent, scale, grid),
        }
    })
}

/// See [`Cut::partition_one_by_one`], if the machine has the instructions.
#[inline]
pub(super) fn partition(cut: &Cut, refs: &mut [PrimRef]) -> Option<(usize, [Bounds3; 2])> {
    // SAFETY: the machine has the instructions.
    is_x86_feature_detected!("avx2").then(|| unsafe { partitioned(cut, refs) })
}

/// Mapping from primitives to bins.
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
        // Map the centre to a bin, one axis in each lane.
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
        // SAFETY: a reference is eight `f32`, and the middle is never beyond the present place. Whole references are
        // read and written: one that has just been written in halves would be waited for.
        let (own, first_of_second, r) = unsafe {
            let own = first.add(8 * i);
            (own, first.add(8 * middle), _mm256_loadu_ps(own))
        };
        let (center, bins) = places.of([_mm256_castps256_ps128(r), _mm256_extractf128_ps::<1>(r)]);
        let bin = _mm_castps_si128(_mm_permutevar_ps(_mm_castsi128_ps(bins), axis));
        let is_first = _mm_cmpgt_epi32(border, bin);
        let mask = _mm256_castsi256_ps(_mm256_set_m128i(is_first, is_first));
        let center = folded(center, center);
        // Blend an empty box into the side that the reference does not join, so that both sides accumulate without a
        // branch.
        left = _mm256_min_ps(left, _mm256_blendv_ps(empty(), center, mask));
        right = _mm256_min_ps(right, _mm256_blendv_ps(center, empty(), mask));
        // SAFETY: as above.
        // Exchange the reference with the first one of the second part (branch-free Lomuto partition).
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

/// The cheapest of three cuts where there are two bins along each axis: their boxes stay in registers.
#[target_feature(enable = "avx2")]
fn cheapest_half(refs: &[PrimRef], extent: &Extent, scale: f32, grid: Grid) -> Option<Cut> {
    let places = Places::new(grid, HALVES);
    let (mut left, mut right) = ([empty(); 4], [empty(); 4]);
    let mut of_right = _mm_setzero_si128();
    // Add every box to one half on each axis by masks, and count the right halves by adding bin numbers.
    for r in refs {
        let [low, high] = r.lanes();
        let (_, bin) = places.of([low, high]);
        of_right = _mm_add_epi32(of_right, bin);
        let span = folded(low, high);
        let is_right = _mm256_castsi128_si256(_mm_sub_epi32(_mm_setzero_si128(), bin));
        for axis in 0..3 {
            let is_right = _mm256_permutevar8x32_epi32(is_right, _mm256_set1_epi32(axis as i32));
            let is_left = _mm256_xor_si256(is_right, _mm256_set1_epi32(-1));
            // All bits together are not a number, of which and another number the second one is taken.
            left[axis] = _mm256_min_ps(_mm256_or_ps(span, _mm256_castsi256_ps(is_right)), left[axis]);
            right[axis] = _mm256_min_ps(_mm256_or_ps(span, _mm256_castsi256_ps(is_left)), right[axis]);
        }
    }
    let of_left = _mm_sub_epi32(_mm_set1_epi32(refs.len() as i32), of_right);
    let counts = _mm256_set_m128i(of_right, of_left);
    // Cost of a cut: the area times the tests of the left half plus the same of the right one.
    let costs = costs(areas(&left, &right, 0, scale), counts, extent);
    let costs = _mm_add_ps(_mm256_castps256_ps128(costs), _mm256_extractf128_ps::<1>(costs));
    let mut of_axis = [0.0; 4];
    // SAFETY: there are four of them.
    unsafe { _mm_storeu_ps(of_axis.as_mut_ptr(), costs) };
    let mut axis = usize::from(of_axis[1] < of_axis[0]);
    axis = if of_axis[2] < of_axis[axis] { 2 } else { axis };
    let bounds = [left[axis], right[axis]].map(|own| unfolded(own).bounds());
    (of_axis[axis] < f32::INFINITY).then_some(Cut { grid, axis, bin: 1, cost: of_axis[axis], bounds })
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
                // One minimum merges both corners, because the greatest one has its sign changed.
                *own = _mm256_min_ps(*own, span);
                *count += 1;
            }
        }
    }

    /// The cheapest cut of so many primitives: first the boxes on both sides of all cuts, then the costs of eight cuts
    /// at a time, so that no branch depends on them.
    #[target_feature(enable = "avx2")]
    fn cheapest(mut self, total: u32, extent: &Extent, scale: f32, grid: Grid) -> Option<Cut> {
        const { assert!(BINS.is_multiple_of(8)) };
        // Bins beyond those of the grid are empty: cuts there have no second part. Of the fewest bins all are used,
        // which the compiler cannot know.
        let used = if BINS == MIN_BINS { BINS } else { grid.count.min(BINS).next_multiple_of(8) };
        let mut all = [[f32::INFINITY; BINS]; 3];
        let mut after = [[empty(); BINS]; 3];
        let mut least = _mm256_set1_ps(f32::INFINITY);
        for axis in 0..3 {
            let (boxes, after) = (&mut self.boxes[axis], &mut after[axis]);
            // Sweep from the right: the boxes of all second parts.
            let mut bounds = empty();
            for bin in (0..used).rev() {
                bounds = _mm256_min_ps(bounds, boxes[bin]);
                after[bin] = bounds;
            }
            // Sweep from the left: the boxes of all first parts, in place.
            let mut bounds = empty();
            for own in &mut boxes[..used] {
                (*own, bounds) = (bounds, _mm256_min_ps(bounds, *own));
            }
            // Evaluate SAH costs A_l·N_l + A_r·N_r of eight cuts at a time, with prefix sums of the counts.
            let mut count = _mm256_setzero_si256();
            for cuts in (0..used).step_by(8) {
                // SAFETY: there are as many counts as bins.
                let counts = unsafe { _mm256_loadu_si256(self.counts[axis].as_ptr().add(cuts).cast()) };
                let (of_left, sum) = before(counts, count);
                count = sum;
                let of_right = _mm256_sub_epi32(_mm256_set1_epi32(total as i32), of_left);
                let low = areas(boxes, after, cuts, scale);
                let high = areas(boxes, after, cuts + 4, scale);
                let left = costs(_mm256_permute2f128_ps::<0x20>(low, high), of_left, extent);
                let right = costs(_mm256_permute2f128_ps::<0x31>(low, high), of_right, extent);
                let cost = _mm256_add_ps(left, right);
                least = _mm256_min_ps(cost, least);
                // SAFETY: as many costs, too.
                unsafe { _mm256_storeu_ps(all[axis].as_mut_ptr().add(cuts), cost) };
            }
        }
        let cost = least_lane(least);
        if cost == f32::INFINITY {
            return None;
        }
        // The first of all that cost as little.
        let mut at = 0;
        for cuts in (0..3 * BINS).step_by(8).rev() {
            // SAFETY: there are eight costs from here on.
            let costs = unsafe { _mm256_loadu_ps(all.as_flattened().as_ptr().add(cuts)) };
            let same = _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_EQ_OQ>(costs, _mm256_set1_ps(cost)));
            at = if same == 0 { at } else { cuts + same.trailing_zeros() as usize };
        }
        let (axis, bin) = (at / BINS, at % BINS);
        let bounds = [self.boxes[axis][bin], after[axis][bin]].map(|own| unfolded(own).bounds());
        Some(Cut { grid, axis, bin, cost, bounds })
    }
}

/// The sums of the counts before each, behind so many in every lane; and the sum of all.
#[target_feature(enable = "avx2")]
fn before(counts: __m256i, start: __m256i) -> (__m256i, __m256i) {
    // Prefix sum by shifts of one and of two lanes within each half.
    let pairs = _mm256_add_epi32(counts, _mm256_slli_si256::<4>(counts));
    let halves = _mm256_add_epi32(pairs, _mm256_slli_si256::<8>(pairs));
    // The sum of the lower half is added to the upper one.
    let lower = _mm256_permute2x128_si256::<0x08>(halves, halves);
    let sums = _mm256_add_epi32(halves, _mm256_shuffle_epi32::<0xff>(lower));
    let up_to = _mm256_add_epi32(sums, start);
    let last = _mm256_permutevar8x32_epi32(up_to, _mm256_set1_epi32(7));
    (_mm256_sub_epi32(up_to, counts), last)
}

/// Areas times how many tests so many primitives are (see [`Extent::tests`]); without an end for none.
#[target_feature(enable = "avx2")]
fn costs(areas: __m256, counts: __m256i, extent: &Extent) -> __m256 {
    // Blocks of eight triangles are tested at once: round the count up to whole blocks.
    const { assert!(LANES == 8) };
    let blocks = _mm256_srli_epi32::<3>(_mm256_add_epi32(counts, _mm256_set1_epi32(7)));
    let tests = _mm256_cvtepi32_ps(if extent.triangles { blocks } else { counts });
    let is_none = _mm256_castsi256_ps(_mm256_cmpeq_epi32(counts, _mm256_setzero_si256()));
    _mm256_blendv_ps(_mm256_mul_ps(areas, tests), _mm256_set1_ps(f32::INFINITY), is_none)
}

/// The least of eight numbers.
#[target_feature(enable = "avx2")]
fn least_lane(of: __m256) -> f32 {
    let of = _mm_min_ps(_mm256_castps256_ps128(of), _mm256_extractf128_ps::<1>(of));
    let of = _mm_min_ps(of, _mm_movehl_ps(of, of));
    _mm_cvtss_f32(_mm_min_ss(of, _mm_movehdup_ps(of)))
}

/// A box with the sign of its greatest corner changed.
#[target_feature(enable = "avx2")]
fn folded(low: __m128, high: __m128) -> __m256 {
    _mm256_xor_ps(_mm256_set_m128(high, low), signs())
}

/// Box of a [`folded`] one, with the sign of its greatest corner restored.
#[target_feature(enable = "avx2")]
fn unfolded(folded: __m256) -> Span {
    let own = _mm256_xor_ps(folded, signs());
    Span { min: Vec3A::from(_mm256_castps256_ps128(own)), max: Vec3A::from(_mm256_extractf128_ps::<1>(own)) }
}

/// Mask that flips the signs of the greatest corner.
#[target_feature(enable = "avx2")]
fn signs() -> __m256 {
    _mm256_setr_ps(0.0, 0.0, 0.0, 0.0, -0.0, -0.0, -0.0, -0.0)
}

/// A box without a point.
#[target_feature(enable = "avx2")]
fn empty() -> __m256 {
    _mm256_set1_ps(f32::INFINITY)
}

/// The areas ([`super::split::half_area`]) of both parts of four cuts: of first parts in the lower half, of second
/// parts in the upper one.
#[target_feature(enable = "avx2")]
fn areas<const BINS: usize>(left: &[__m256; BINS], right: &[__m256; BINS], cuts: usize, scale: f32) -> __m256 {
    let [a, b, c, d] = [0, 1, 2, 3].map(|i| (left[cuts + i], right[cuts + i]));
    let (a, b, c, d) = (faces(a, scale), faces(b, scale), faces(c, scale), faces(d, scale));
    // Faces of one kind side by side.
    let (ab, cd) = (_mm256_unpacklo_ps(a, b), _mm256_unpacklo_ps(c, d));
    let first = _mm256_shuffle_ps::<0b01_00_01_00>(ab, cd);
    let second = _mm256_shuffle_ps::<0b11_10_11_10>(ab, cd);
    let third = _mm256_shuffle_ps::<0b01_00_01_00>(_mm256_unpackhi_ps(a, b), _mm256_unpackhi_ps(c, d));
    _mm256_add_ps(_mm256_add_ps(first, second), third)
}

/// The products x·y, y·z and z·x of half the lengths of two boxes, times a scale.
#[target_feature(enable = "avx2")]
fn faces((left, right): (__m256, __m256), scale: f32) -> __m256 {
    let half = _mm256_set1_ps(0.5);
    let (left, right) = (_mm256_mul_ps(left, half), _mm256_mul_ps(right, half));
    // The lengths with a sign, which products lose.
    // Folded boxes hold −max, so that min − max comes from one addition.
    let sum = _mm256_add_ps(_mm256_blend_ps::<0xf0>(left, right), _mm256_permute2f128_ps::<0x21>(left, right));
    let d = _mm256_mul_ps(sum, _mm256_set1_ps(scale));
    _mm256_mul_ps(d, _mm256_permute_ps::<0b11_00_10_01>(d))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Geometry;
    use crate::construct::Primitives;
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
            let count = if round % 5 < 2 { 1 + round } else { 1 + round / 5 % 24 };
            let boxes: Vec<_> = (0..count).map(|_| Bounds3::from_points([point(), point()])).collect();
            let refs = Primitives::new(&[Geometry::boxes(&boxes)]).expect("few boxes").refs();
            let extent = Extent { triangles: round % 7 < 3, ..Extent::of(&refs) };
            let grid = Grid::new(&extent.centers, refs.len());
            let plain = Bins::<32>::one_by_one(&refs, grid);
            let Some(wide) = bins::<32>(&refs, grid) else { return };
            assert_eq!(plain.counts, wide.counts, "{round}");
            let bounds = |bins: &Bins<32>| bins.bounds.map(|axis| axis.map(Span::bounds));
            assert_eq!(bounds(&plain), bounds(&wide), "{round}");
            let scale = crate::construct::binary::scale(&extent.bounds);
            let cut = plain.cheapest(&extent, scale, grid);
            assert_eq!(cheapest(&refs, &extent, scale, grid), Some(cut), "{round}");
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
