//! Eight, sixteen or thirty-two `f32` lanes on several instruction sets, all with the same bits (but for
//! [`Lanes::mul_add`]): only correctly rounded operations, no contraction, and one meaning of minimum and maximum.
//!
//! A value of a type that implements [`Simd`] is a token: that it exists proves that the machine has the instructions,
//! so that its operations are safe to call. They are fast only when inlined into a function compiled for that
//! instruction set.

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
#[cfg(target_arch = "x86_64")]
mod avx512_wide;
mod double;
#[cfg(any(test, not(target_arch = "x86_64")))]
mod portable;
#[cfg(target_arch = "x86_64")]
mod sort;
#[cfg(target_arch = "x86_64")]
mod sse2;

#[cfg(target_arch = "x86_64")]
pub(crate) use avx2::Avx2;
#[cfg(target_arch = "x86_64")]
pub(crate) use avx512::Avx512;
#[cfg(target_arch = "x86_64")]
pub(crate) use avx512_wide::Avx512Wide;
pub(crate) use double::DoubleLanes;
#[cfg(not(target_arch = "x86_64"))]
pub(crate) use portable::Portable;
#[cfg(target_arch = "x86_64")]
pub(crate) use sse2::Sse2;

use steradian_math::Vec3;

/// Number of lanes, and with it the width of nodes and triangle blocks.
pub(crate) const LANES: usize = 8;

/// A row of lanes as it lies in memory.
#[repr(C, align(32))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Row(pub [f32; LANES]);

/// Most lanes there are, and with it the most rays of a packet.
pub(crate) const WIDE: usize = 32;

/// Columns of a table of rays.
pub(crate) const COLUMNS: usize = 8;

/// Numbers of as many lanes as there may be, as they lie in memory; what follows these has no meaning.
#[repr(C, align(64))]
#[derive(Clone, Copy, Debug)]
pub(crate) struct Wide(pub [f32; WIDE]);

impl Wide {
    /// Broadcasts one number to all lanes.
    pub const fn splat(x: f32) -> Self {
        Self([x; WIDE])
    }

    /// So many of them, from a multiple of that number on.
    #[inline(always)]
    fn lanes<const N: usize>(&self, first: usize) -> &[f32; N] {
        assert!(first.is_multiple_of(N), "rows of lanes are aligned");
        self.0[first..].first_chunk().expect("lanes within a row")
    }

    /// Mutable access to `N` lanes from `first` on, a multiple of `N`.
    #[inline(always)]
    fn lanes_mut<const N: usize>(&mut self, first: usize) -> &mut [f32; N] {
        assert!(first.is_multiple_of(N), "rows of lanes are aligned");
        self.0[first..].first_chunk_mut().expect("lanes within a row")
    }
}

/// Operations on [`Lanes::COUNT`] lanes.
pub(crate) trait Lanes: Copy {
    /// Number of lanes: eight, sixteen or thirty-two.
    const COUNT: usize;
    /// Half of them, where these are several registers; else the same.
    type Half: Lanes;
    /// A number for each lane.
    type F: Copy;
    /// A truth value for each lane.
    type M: Copy;

    /// The lanes of a half.
    fn half(self) -> Self::Half;
    /// The first lane of the half that all of some lanes are in, if there is one.
    #[inline(always)]
    fn half_of(self, lanes: u32) -> Option<usize> {
        let half = Self::Half::COUNT;
        if half == Self::COUNT {
            None
        } else if lanes >> half == 0 {
            Some(0)
        } else {
            (lanes.trailing_zeros() as usize >= half).then_some(half)
        }
    }

    /// Broadcasts one number to all lanes.
    fn splat(self, x: f32) -> Self::F;
    /// Each coordinate in every lane.
    #[inline(always)]
    fn splat3(self, v: Vec3) -> [Self::F; 3] {
        [self.splat(v.x), self.splat(v.y), self.splat(v.z)]
    }
    /// The lanes from memory.
    #[inline(always)]
    fn read(self, wide: &Wide) -> Self::F {
        self.read_from(wide, 0)
    }
    /// The lanes to memory.
    #[inline(always)]
    fn write(self, a: Self::F, wide: &mut Wide) {
        self.write_from(a, wide, 0);
    }
    /// The lanes from memory, of which the first is at a multiple of their number.
    fn read_from(self, wide: &Wide, first: usize) -> Self::F;
    /// The lanes to memory, of which the first is at a multiple of their number.
    fn write_from(self, a: Self::F, wide: &mut Wide, first: usize);
    /// `a` where `m`, else `b`, bit for bit.
    fn select(self, m: Self::M, a: Self::F, b: Self::F) -> Self::F;
    /// `a + b`.
    fn add(self, a: Self::F, b: Self::F) -> Self::F;
    /// `a - b`.
    fn sub(self, a: Self::F, b: Self::F) -> Self::F;
    /// `a * b`.
    fn mul(self, a: Self::F, b: Self::F) -> Self::F;
    /// `a · b + c`, rounded once or twice: the one operation whose bits differ between levels. Boxes are tested with
    /// it, whose bounds hold for both.
    fn mul_add(self, a: Self::F, b: Self::F, c: Self::F) -> Self::F;
    /// `a / b`.
    fn div(self, a: Self::F, b: Self::F) -> Self::F;
    /// `if a < b { a } else { b }`: gives `b` where either is NaN.
    fn min(self, a: Self::F, b: Self::F) -> Self::F;
    /// `if a > b { a } else { b }`: gives `b` where either is NaN.
    fn max(self, a: Self::F, b: Self::F) -> Self::F;
    /// [`Lanes::min`] of numbers that are not NaN and of which one at least has no sign; of two with a sign either.
    /// Faster where integers are compared faster than numbers.
    #[inline(always)]
    fn nearer(self, a: Self::F, b: Self::F) -> Self::F {
        self.min(a, b)
    }
    /// [`Lanes::max`] of such numbers.
    #[inline(always)]
    fn farther(self, a: Self::F, b: Self::F) -> Self::F {
        self.max(a, b)
    }
    /// `a <= b`, false for NaN.
    fn le(self, a: Self::F, b: Self::F) -> Self::M;
    /// `a < b`, false for NaN.
    fn lt(self, a: Self::F, b: Self::F) -> Self::M;
    /// `a == b`, false for NaN.
    fn eq(self, a: Self::F, b: Self::F) -> Self::M;
    /// Both.
    fn and(self, a: Self::M, b: Self::M) -> Self::M;
    /// Either.
    fn or(self, a: Self::M, b: Self::M) -> Self::M;
    /// Bit `i` is lane `i`.
    fn bits(self, m: Self::M) -> u32;
    /// Lane `i` is bit `i`.
    fn mask(self, bits: u32) -> Self::M;
    /// The least of numbers that are not NaN.
    fn least(self, a: Self::F) -> f32;
    /// The greatest of numbers that are not NaN.
    fn greatest(self, a: Self::F) -> f32;

    /// The columns of a table with as many rows as there are lanes.
    #[inline(always)]
    fn columns(self, rows: &[[f32; COLUMNS]]) -> [Self::F; COLUMNS] {
        let mut columns = [Wide::splat(0.0); COLUMNS];
        for (lane, row) in rows[..Self::COUNT].iter().enumerate() {
            for (column, &x) in columns.iter_mut().zip(row) {
                column.0[lane] = x;
            }
        }
        let mut read = [self.splat(0.0); COLUMNS];
        for (read, column) in read.iter_mut().zip(&columns) {
            *read = self.read(column);
        }
        read
    }
}

/// Operations on the eight children of a node, or the eight triangles of a block.
pub(crate) trait Simd: Lanes {
    /// The lanes of a row.
    fn load(self, row: &Row) -> Self::F;
    /// The lanes as an array.
    fn store(self, a: Self::F) -> [f32; LANES];

    /// Sorts numbers that are at least +0, farthest first: the keys of those in `chosen` (see [`key`]), and in the same
    /// order their companions. What follows these has no meaning.
    #[inline(always)]
    fn sort_descending(self, a: Self::F, chosen: u32, companions: &[u32; LANES]) -> ([u32; LANES], [u32; LANES]) {
        let a = self.store(a);
        let mut keys = [0; LANES];
        for (len, lane) in (0..LANES).filter(|lane| chosen >> lane & 1 == 1).enumerate() {
            let key = key(a[lane], lane);
            let mut slot = len;
            while slot > 0 && keys[slot - 1] < key {
                keys[slot] = keys[slot - 1];
                slot -= 1;
            }
            keys[slot] = key;
        }
        (keys, keys.map(|key| companions[key_lane(key)]))
    }

    /// The lane in `chosen`, which is not empty, that [`Simd::sort_descending`] puts last. It is known sooner than the
    /// whole order, and what depends on it need not wait.
    #[inline(always)]
    fn nearest(self, a: Self::F, chosen: u32) -> usize {
        let a = self.store(a);
        let keys = (0..LANES).filter(|lane| chosen >> lane & 1 == 1).map(|lane| key(a[lane], lane));
        keys.min().map_or(0, key_lane)
    }
}

/// A number that is at least +0 and its lane as an integer that sorts like them: the lane replaces the lowest three
/// bits.
#[inline(always)]
pub(crate) fn key(x: f32, lane: usize) -> u32 {
    x.to_bits() & !LANE_BITS | lane as u32
}

/// The greatest key of a number that is not greater than one that is at least +0.
#[inline(always)]
pub(crate) fn last_key(x: f32) -> u32 {
    x.to_bits() | LANE_BITS
}

/// The lane in a key.
#[inline(always)]
pub(crate) fn key_lane(key: u32) -> usize {
    (key & LANE_BITS) as usize
}

/// The bits of a key that hold the lane.
const LANE_BITS: u32 = LANES as u32 - 1;

#[cfg(test)]
mod tests {
    use super::*;
    use portable::Portable;

    /// Numbers where instruction sets could differ.
    const NASTY: [f32; 14] = [
        0.0,
        -0.0,
        1.0,
        -1.5,
        f32::NAN,
        f32::INFINITY,
        f32::NEG_INFINITY,
        f32::MAX,
        f32::MIN,
        f32::MIN_POSITIVE,
        1e-44,
        3.1e-7,
        16_777_217.0,
        -7.3e19,
    ];

    /// Compares a level with plain arrays: every pair of nasty numbers, in every operation.
    fn same_as_portable<S: Simd>(s: S) {
        let p = Portable;
        // Any NaN is as good as another.
        let bits = |a: [f32; LANES]| a.map(|x| if x.is_nan() { u32::MAX } else { x.to_bits() });
        for (i, &x) in NASTY.iter().enumerate() {
            for j in 0..NASTY.len() {
                let row = Row(std::array::from_fn(|lane| NASTY[(j + lane) % NASTY.len()]));
                let (a, b) = (s.splat(x), s.load(&row));
                let (pa, pb) = (p.splat(x), p.load(&row));
                macro_rules! check {
                    ($($op:ident)*) => {$(
                        assert_eq!(bits(s.store(s.$op(a, b))), bits(p.$op(pa, pb)), "{} {i} {j}", stringify!($op));
                        assert_eq!(bits(s.store(s.$op(b, a))), bits(p.$op(pb, pa)), "{} {j} {i}", stringify!($op));
                    )*};
                }
                check!(add sub mul div min max);
                fused_or_not(s, [a, b], [pa, pb]);
                let (nearer, farther) = (s.store(s.nearer(a, b)), s.store(s.farther(a, b)));
                let usable = |y: f32| (x.is_sign_positive() || y.is_sign_positive()) && !x.is_nan() && !y.is_nan();
                for (lane, y) in pb.into_iter().enumerate().filter(|&(_, y)| usable(y)) {
                    assert!(nearer[lane] == x.min(y) && farther[lane] == x.max(y), "{x} {y}");
                }
                let compare = [s.bits(s.le(a, b)), s.bits(s.lt(a, b)), s.bits(s.eq(a, b))];
                assert_eq!(compare, [p.bits(p.le(pa, pb)), p.bits(p.lt(pa, pb)), p.bits(p.eq(pa, pb))]);
                let (m, n) = (s.le(a, b), s.le(b, a));
                let (pm, pn) = (p.le(pa, pb), p.le(pb, pa));
                assert_eq!([s.bits(s.and(m, n)), s.bits(s.or(m, n))], [p.bits(p.and(pm, pn)), p.bits(p.or(pm, pn))]);
            }
        }
        sorts(s);
    }

    /// The sum of a product is rounded once or twice.
    fn fused_or_not<S: Simd>(s: S, [a, b]: [S::F; 2], [pa, pb]: [[f32; LANES]; 2]) {
        let same = |x: f32, y: f32| x.to_bits() == y.to_bits() || x.is_nan() && y.is_nan();
        let found = s.store(s.mul_add(a, b, b));
        for lane in 0..LANES {
            let (x, y) = (pa[lane], pb[lane]);
            assert!(same(found[lane], x.mul_add(y, y)) || same(found[lane], x * y + y), "{x} {y}");
        }
    }

    /// Sorts every choice of lanes, with equal numbers and infinity among them.
    fn sorts<S: Simd>(s: S) {
        let rows = [
            [3.0, 1.0, 2.0, 7.0, 5.0, 0.0, 4.0, 6.0],
            [0.0; LANES],
            [1.0, f32::INFINITY, 1.0, 0.0, 1.0, f32::MAX, f32::INFINITY, 1e-45],
        ];
        let companions: [u32; LANES] = std::array::from_fn(|lane| 100 + lane as u32);
        for row in rows {
            for chosen in 1_u32..256 {
                let (keys, sorted) = s.sort_descending(s.load(&Row(row)), chosen, &companions);
                let count = chosen.count_ones() as usize;
                let mut expected: Vec<u32> =
                    (0..LANES).filter(|lane| chosen >> lane & 1 == 1).map(|lane| key(row[lane], lane)).collect();
                expected.sort_by(|a, b| b.cmp(a));
                assert_eq!(keys[..count], expected);
                let lanes: Vec<u32> = expected.iter().map(|&key| 100 + key_lane(key) as u32).collect();
                assert_eq!(sorted[..count], lanes);
                assert_eq!(s.nearest(s.load(&Row(row)), chosen), key_lane(expected[count - 1]));
            }
        }
    }

    #[test]
    fn plain_arrays_sort() {
        sorts(Portable);
    }

    #[test]
    #[cfg(target_arch = "x86_64")]
    #[expect(unsafe_code, reason = "unchecked reads; each place states why it is sound")]
    fn every_level_gives_the_same_bits() {
        use crate::Isa;
        // SAFETY: each level is tried only where it is supported.
        unsafe {
            same_as_portable(Sse2::assume_supported());
            if Isa::Avx2.is_supported() {
                same_as_portable(Avx2::assume_supported());
            }
            if Isa::Avx512.is_supported() {
                same_as_portable(Avx512::assume_supported());
            }
        }
    }
}
