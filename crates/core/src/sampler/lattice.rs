//! A rank-1 lattice: multiples of one vector, modulo one, in the order of the radical inverse, so that any number of
//! points is well spread, and 2^k of them are a lattice; shifted at random (Cranley, Patterson 1976).
//!
//! The vector is that of Cools, Kuo, Nuyens 2006, "Constructing Embedded Lattice Rules for Multivariate Integration"
//! (`exod2_base2_m20_CKN`: for order-two weights, up to 2²⁰ points), of which each pair of dimensions takes two
//! components. Beyond [`PAIRS`] pairs they are taken again, with the order of the points shuffled.

use steradian_math::{Vec2, hash::combine32, sobol::owen_scramble};

/// Pairs of dimensions with components of their own.
const PAIRS: u32 = 50;

#[rustfmt::skip]
static GENERATOR: [u32; 2 * PAIRS as usize] = [
    1, 182_667, 469_891, 498_753, 110_745, 446_247, 250_185, 118_627, 245_333, 283_199,
    408_519, 391_023, 246_327, 126_539, 399_185, 461_527, 300_343, 69_681, 516_695, 436_179,
    106_383, 238_523, 413_283, 70_841, 47_719, 300_129, 113_029, 123_925, 410_745, 211_325,
    17_489, 511_893, 40_767, 186_077, 519_471, 255_369, 101_819, 243_573, 66_189, 152_143,
    503_455, 113_217, 132_603, 463_967, 297_717, 157_383, 224_015, 502_917, 36_237, 94_049,
    170_665, 79_397, 123_963, 223_451, 323_871, 303_633, 98_567, 318_855, 494_245, 477_137,
    177_975, 64_483, 26_695, 88_779, 94_497, 239_429, 381_007, 110_205, 339_157, 73_397,
    407_559, 181_791, 442_675, 301_397, 32_569, 147_737, 189_949, 138_655, 350_241, 63_371,
    511_925, 515_861, 434_045, 383_435, 249_187, 492_723, 479_195, 84_589, 99_703, 239_831,
    269_423, 182_241, 61_063, 130_789, 143_095, 471_209, 139_019, 172_565, 487_045, 304_803,
];

/// A pair of coordinates of a point, as binary fractions. The order of points beyond the first pairs is that of
/// `pixel`, their shift that of `seed`.
pub(super) fn pair(index: u32, pair: u32, pixel: u32, seed: u32) -> [u32; 2] {
    let (again, pair) = (pair / PAIRS, pair % PAIRS);
    // Reuse components for late dimensions with a shuffled order, which decorrelates them.
    let index = if again == 0 { index } else { owen_scramble(index, combine32(pixel, again)) };
    // x_i = {φ₂(i)·z + Δ} in 32-bit fixed point: overflow is the modulo.
    let phi = index.reverse_bits();
    [0, 1].map(|axis| phi.wrapping_mul(GENERATOR[(2 * pair + axis) as usize]).wrapping_add(combine32(seed, axis)))
}

/// [`pair`] as numbers in `[0, 1)`.
pub(super) fn point(index: u32, dimension: u32, pixel: u32, seed: u32) -> Vec2 {
    Vec2::from(pair(index, dimension, pixel, seed).map(steradian_math::hash::unit_f32))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Differences of points of a lattice are points of it, up to the shift; and 2^k of them differ in each coordinate
    /// by multiples of 2^-k.
    #[test]
    fn points_form_a_lattice() {
        for d in [0, 1, 7, 49, 50, 120] {
            let points: Vec<[u32; 2]> = (0..64).map(|i| pair(i, d, 5, 9)).collect();
            let minus = |a: [u32; 2], b: [u32; 2]| [a[0].wrapping_sub(b[0]), a[1].wrapping_sub(b[1])];
            let lattice: std::collections::BTreeSet<_> = points.iter().map(|p| minus(*p, points[0])).collect();
            assert_eq!(lattice.len(), 64);
            assert!(lattice.iter().flatten().all(|c| c % (1 << 26) == 0), "dimension {d}");
            for p in &points {
                assert!(points.iter().all(|q| lattice.contains(&minus(*p, *q))), "dimension {d}");
            }
        }
    }
}
