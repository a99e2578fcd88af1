//! Sobol' points with hashed Owen scrambling: well-spread numbers as a pure function of (index, dimension, seed).
//!
//! The sequence is Sobol's (1967) with the direction numbers of Joe and Kuo (2008). Scrambling and shuffling are nested uniform
//! (Owen 1995) by the Laine–Karras construction on bit-reversed integers (2011), with Vegdahl's constants (2021), put together as
//! in Burley, "Practical Hash-based Owen Scrambling" (2020). Points are 32-bit binary fractions, most significant bit first.

use crate::hash::{combine32, mix32, unit_f32};

/// Dimensions that [`sobol`] has direction numbers for.
pub const SOBOL_DIMENSIONS: usize = 16;

/// Degree `s`, inner coefficients `a` of the primitive polynomial and initial numbers `m` of dimensions 1.. (file
/// new-joe-kuo-6.21201; dimension 0 is the van der Corput sequence).
const JOE_KUO: [(u32, u32, [u32; 6]); SOBOL_DIMENSIONS - 1] = [
    (1, 0, [1, 0, 0, 0, 0, 0]),
    (2, 1, [1, 3, 0, 0, 0, 0]),
    (3, 1, [1, 3, 1, 0, 0, 0]),
    (3, 2, [1, 1, 1, 0, 0, 0]),
    (4, 1, [1, 1, 3, 3, 0, 0]),
    (4, 4, [1, 3, 5, 13, 0, 0]),
    (5, 2, [1, 1, 5, 5, 17, 0]),
    (5, 4, [1, 1, 5, 5, 5, 0]),
    (5, 7, [1, 1, 7, 11, 19, 0]),
    (5, 11, [1, 1, 5, 1, 1, 0]),
    (5, 13, [1, 1, 1, 3, 11, 0]),
    (5, 14, [1, 3, 5, 5, 31, 0]),
    (6, 1, [1, 3, 3, 9, 7, 49]),
    (6, 13, [1, 1, 1, 15, 21, 21]),
    (6, 16, [1, 3, 1, 13, 27, 49]),
];

/// Generator matrices: column `i` is the point of index `2^i`.
static MATRICES: [[u32; 32]; SOBOL_DIMENSIONS] = matrices();

const fn matrices() -> [[u32; 32]; SOBOL_DIMENSIONS] {
    let mut all = [[0; 32]; SOBOL_DIMENSIONS];
    let mut i = 0;
    while i < 32 {
        all[0][i] = 1 << (31 - i);
        i += 1;
    }
    let mut d = 1;
    while d < SOBOL_DIMENSIONS {
        let (s, a, m) = JOE_KUO[d - 1];
        let s = s as usize;
        let mut i = 0;
        while i < 32 {
            all[d][i] = if i < s {
                m[i] << (31 - i)
            } else {
                // v_i = v_{i−s} ⊕ v_{i−s}/2^s ⊕ Σ a_k v_{i−k}
                let mut v = all[d][i - s] ^ (all[d][i - s] >> s);
                let mut k = 1;
                while k < s {
                    if (a >> (s - 1 - k)) & 1 == 1 {
                        v ^= all[d][i - k];
                    }
                    k += 1;
                }
                v
            };
            i += 1;
        }
        d += 1;
    }
    all
}

/// Dimension 1 before its final bit reversal: the product with the Pascal matrix modulo 2, which is a Kronecker power of
/// `[1 1; 0 1]` and so takes one masked shift per level.
#[inline]
const fn pascal(mut x: u32) -> u32 {
    x ^= (x >> 1) & 0x5555_5555;
    x ^= (x >> 2) & 0x3333_3333;
    x ^= (x >> 4) & 0x0f0f_0f0f;
    x ^= (x >> 8) & 0x00ff_00ff;
    x ^ (x >> 16)
}

/// Laine–Karras permutation: every bit is flipped as a function of the bits below it and of the seed.
#[inline]
const fn laine_karras(mut x: u32, seed: u32) -> u32 {
    x ^= x.wrapping_mul(0x3d20_adea);
    x = x.wrapping_add(seed);
    x = x.wrapping_mul((seed >> 16) | 1);
    x ^= x.wrapping_mul(0x0552_6c56);
    x ^ x.wrapping_mul(0x53a2_2864)
}

/// The first two dimensions of the point `index`: a (0,2)-sequence in base 2.
#[inline]
pub const fn sobol_2d(index: u32) -> [u32; 2] {
    [index.reverse_bits(), pascal(index).reverse_bits()]
}

/// One dimension of the point `index`. Dimensions from [`SOBOL_DIMENSIONS`] on are padded: the same dimensions again, with the
/// index Owen-shuffled by the number of the repetition.
#[inline]
pub fn sobol(index: u32, dimension: usize) -> u32 {
    let (block, dimension) = (dimension / SOBOL_DIMENSIONS, dimension % SOBOL_DIMENSIONS);
    let mut rest = if block == 0 { index } else { owen_scramble(index, mix32(block as u32)) };
    let mut x = 0;
    while rest != 0 {
        x ^= MATRICES[dimension][rest.trailing_zeros() as usize];
        rest &= rest - 1;
    }
    x
}

/// Nested uniform scramble of a 32-bit binary fraction: each bit is flipped or not as a hash of `seed` and of all bits above it, so
/// nets stay nets. A bijection for every seed; the seed should be well mixed ([`mix32`]).
#[inline]
pub const fn owen_scramble(x: u32, seed: u32) -> u32 {
    laine_karras(x.reverse_bits(), seed).reverse_bits()
}

/// Point `index` of the first dimension, shuffled and scrambled by `seed`.
#[inline]
pub fn shuffled_scrambled_sobol_1d(index: u32, seed: u32) -> f32 {
    let i = owen_scramble(index, mix32(seed));
    unit_f32(laine_karras(i, combine32(seed, 1)).reverse_bits())
}

/// Point `index` of the first two dimensions, shuffled and scrambled by `seed`: the points of one seed form an Owen-scrambled
/// (0,2)-sequence, and those of different seeds are independent of each other, so dimensions can be padded in pairs.
#[inline]
pub fn shuffled_scrambled_sobol_2d(index: u32, seed: u32) -> [f32; 2] {
    let i = owen_scramble(index, mix32(seed));
    // The scrambles start from bit-reversed points, which the two dimensions have for free.
    [
        unit_f32(laine_karras(i, combine32(seed, 1)).reverse_bits()),
        unit_f32(laine_karras(pascal(i), combine32(seed, 2)).reverse_bits()),
    ]
}

/// Point `index` of the first four dimensions, shuffled and scrambled by `seed`.
#[inline]
pub fn shuffled_scrambled_sobol_4d(index: u32, seed: u32) -> [f32; 4] {
    let i = owen_scramble(index, mix32(seed));
    [
        unit_f32(laine_karras(i, combine32(seed, 1)).reverse_bits()),
        unit_f32(laine_karras(pascal(i), combine32(seed, 2)).reverse_bits()),
        unit_f32(owen_scramble(sobol(i, 2), combine32(seed, 3))),
        unit_f32(owen_scramble(sobol(i, 3), combine32(seed, 4))),
    ]
}
