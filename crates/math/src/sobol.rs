//! Sobol' points with hashed Owen scrambling: well-spread numbers as a pure function of (index, dimension, seed).
//!
//! The sequence is Sobol's (1967) with the direction numbers of Joe and Kuo (2008). Scrambling and shuffling are nested
//! uniform (Owen 1995) by the Laine–Karras construction on bit-reversed integers (2011), with Vegdahl's constants
//! (2021), put together as in Burley, "Practical Hash-based Owen Scrambling" (2020). Points are 32-bit binary
//! fractions, most significant bit first.

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

/// Dimension 1 before its final bit reversal: the product with the Pascal matrix modulo 2, which is a Kronecker power
/// of `[1 1; 0 1]` and so takes one masked shift per level.
#[inline(always)]
const fn pascal(mut x: u32) -> u32 {
    x ^= (x >> 1) & 0x5555_5555;
    x ^= (x >> 2) & 0x3333_3333;
    x ^= (x >> 4) & 0x0f0f_0f0f;
    x ^= (x >> 8) & 0x00ff_00ff;
    x ^ (x >> 16)
}

/// Laine–Karras permutation: every bit is flipped as a function of the bits below it and of the seed.
#[inline(always)]
const fn laine_karras(mut x: u32, seed: u32) -> u32 {
    x ^= x.wrapping_mul(0x3d20_adea);
    x = x.wrapping_add(seed);
    x = x.wrapping_mul((seed >> 16) | 1);
    x ^= x.wrapping_mul(0x0552_6c56);
    x ^ x.wrapping_mul(0x53a2_2864)
}

/// One dimension of the point `index`. Dimensions from [`SOBOL_DIMENSIONS`] on are padded: the same dimensions again,
/// with the index Owen-shuffled by the number of the repetition.
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

/// Nested uniform scramble of a 32-bit binary fraction: each bit is flipped or not as a hash of `seed` and of all bits
/// above it, so nets stay nets. A bijection for every seed; the seed should be well mixed ([`mix32`]).
#[inline]
pub const fn owen_scramble(x: u32, seed: u32) -> u32 {
    laine_karras(x.reverse_bits(), seed).reverse_bits()
}

/// Shuffling and scrambling of the points of one pair of dimensions.
#[derive(Clone, Copy, Debug)]
pub struct Scramble {
    order: u32,
    x: u32,
    y: u32,
}

impl Scramble {
    /// Scramble from a hash of the purpose of the pair.
    #[inline(always)]
    pub const fn new(hash: u64) -> Self {
        // Two halves and the high half of a product.
        Self { order: hash as u32, x: (hash >> 32) as u32, y: (hash.wrapping_mul(0xd6e8_feb8_6659_fd93) >> 32) as u32 }
    }

    /// The point of the first dimension, for an index given with its bits reversed, which is where both shuffling and
    /// scrambling start.
    #[inline(always)]
    pub fn point_1d(self, reversed: u32) -> f32 {
        let i = laine_karras(reversed, self.order).reverse_bits();
        unit_f32(laine_karras(i, self.x).reverse_bits())
    }

    /// The point of the first two dimensions, for an index given with its bits reversed: as
    /// [`shuffled_scrambled_sobol_2d`].
    #[inline(always)]
    pub fn point_2d(self, reversed: u32) -> [f32; 2] {
        let i = laine_karras(reversed, self.order).reverse_bits();
        // Both are turned round at once.
        let (x, y) = (laine_karras(i, self.x), laine_karras(pascal(i), self.y));
        let both = (x as u64 | (y as u64) << 32).reverse_bits();
        [unit_f32((both >> 32) as u32), unit_f32(both as u32)]
    }
}

/// Point `index` of the first two dimensions, shuffled and scrambled by `seed`: the points of one seed form an
/// Owen-scrambled (0,2)-sequence, and those of different seeds are independent of each other, so dimensions can be
/// padded in pairs.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hash::{HashRng, mix64};

    #[test]
    fn generator_matrices_are_the_published_ones() {
        // Column 20 of each dimension, from the matrices that Joe and Kuo's numbers define (compared in full with a
        // published table when this was written).
        let column = [
            0x0000_0800,
            0x8800_8800,
            0x6868_e800,
            0xa085_8800,
            0x7802_2800,
            0x2880_c800,
            0x9e78_d800,
            0xf680_0800,
            0x18a8_0800,
            0xea38_0800,
            0xe18d_8800,
            0xf83b_8800,
            0x420e_8800,
            0x0d6f_1800,
            0xe3a1_6800,
            0x3629_b800,
        ];
        for (d, c) in column.into_iter().enumerate() {
            assert_eq!(MATRICES[d][20], c, "dimension {d}");
        }
    }

    #[test]
    fn the_shifts_equal_the_direction_numbers() {
        let mut rng = HashRng::new(11);
        for i in (0..4096).chain((0..4096).map(|_| rng.next_u64() as u32)) {
            assert_eq!([i.reverse_bits(), pascal(i).reverse_bits()], [sobol(i, 0), sobol(i, 1)]);
        }
        assert_eq!([sobol(3, 0), sobol(3, 1)], [0xc000_0000, 0x4000_0000]);
    }

    /// Every elementary interval of area 1/n holds one of the first n = 2^k points.
    fn is_net(points: &[[f32; 2]]) -> bool {
        let n = points.len();
        let k = n.trailing_zeros();
        (0..=k).all(|a| {
            let (nx, ny) = (1_usize << a, 1_usize << (k - a));
            let mut seen = vec![false; n];
            points.iter().all(|p| {
                let cell = (p[1] * ny as f32) as usize * nx + (p[0] * nx as f32) as usize;
                !std::mem::replace(&mut seen[cell], true)
            })
        })
    }

    #[test]
    fn scrambled_points_are_nets() {
        for seed in [0, 1, 2, 0xdead_beef, 12345] {
            for k in [4, 8, 10] {
                let points: Vec<_> = (0..1 << k).map(|i| shuffled_scrambled_sobol_2d(i, seed)).collect();
                assert!(is_net(&points), "seed {seed}, 2^{k} points");
                let scramble = Scramble::new(mix64(u64::from(seed)));
                let points: Vec<_> = (0..1_u32 << k).map(|i| scramble.point_2d(i.reverse_bits())).collect();
                assert!(is_net(&points), "seed {seed}, 2^{k} points");
                assert!(points.iter().zip(0..).all(|(p, i)| p[0] == scramble.point_1d(u32::reverse_bits(i))));
                let four: Vec<_> = (0..1 << k).map(|i| shuffled_scrambled_sobol_4d(i, seed)).collect();
                for d in 0..4 {
                    let mut line: Vec<usize> = four.iter().map(|p| (p[d] * (1_u32 << k) as f32) as usize).collect();
                    line.sort_unstable();
                    assert!(line.iter().enumerate().all(|(i, &x)| i == x), "dimension {d}");
                }
            }
        }
        // A sequence, not only a net: later aligned blocks are nets too.
        let block: Vec<_> = (256 * 5..256 * 6).map(|i| shuffled_scrambled_sobol_2d(i, 77)).collect();
        assert!(is_net(&block));
    }

    #[test]
    fn scrambles_are_nested_and_flip_every_bit_half_the_time() {
        let mut rng = HashRng::new(5);
        let mut flips = [0_u32; 32];
        const N: u32 = 20_000;
        for _ in 0..N {
            let (x, seed) = (rng.next_u64() as u32, mix32(rng.next_u64() as u32));
            let y = owen_scramble(x, seed);
            for (b, f) in flips.iter_mut().enumerate() {
                *f += ((x ^ y) >> b) & 1;
            }
            // Numbers that share their first bits share them after the scramble, and the next bit still differs.
            let bit = 1 << (rng.next_u64() % 32) as u32;
            let z = owen_scramble(x ^ bit, seed);
            assert_eq!((y ^ z).leading_zeros(), u32::leading_zeros(bit));
        }
        for (b, f) in flips.into_iter().enumerate() {
            let z = (f64::from(f) - 0.5 * f64::from(N)) / (0.25 * f64::from(N)).sqrt();
            assert!(z.abs() < 5.0, "bit {b} is flipped {f} times of {N}");
        }
    }

    #[test]
    fn different_seeds_are_uncorrelated() {
        // Pairs padded from different seeds must behave like independent points: E[(x − ½)(y − ½)] = 0.
        let n = 256;
        let mut z = 0.0;
        for pair in 0..64_u32 {
            let mut c = 0.0;
            for i in 0..n {
                let x = f64::from(shuffled_scrambled_sobol_2d(i, 2 * pair)[0]) - 0.5;
                let y = f64::from(shuffled_scrambled_sobol_2d(i, 2 * pair + 1)[0]) - 0.5;
                c += x * y;
            }
            // Each sum has the variance n/144.
            z += (c * 12.0).powi(2) / f64::from(n);
        }
        // χ² with 64 degrees of freedom: 64 ± 11.3.
        assert!((20.0..120.0).contains(&z), "{z}");
    }

    #[test]
    fn integration_error_falls_far_faster_than_at_random() {
        // The root mean square error of ∫∫ sin(πx) sin(πy) = 4/π² over seeds, at 1024 points; at random it is 0.0096.
        let exact = 4.0 / (std::f64::consts::PI * std::f64::consts::PI);
        let mut square = 0.0;
        for seed in 0..32 {
            let sum: f64 = (0..1024)
                .map(|i| {
                    let [x, y] = shuffled_scrambled_sobol_2d(i, seed);
                    (std::f64::consts::PI * f64::from(x)).sin() * (std::f64::consts::PI * f64::from(y)).sin()
                })
                .sum();
            square += (sum / 1024.0 - exact).powi(2) / 32.0;
        }
        assert!(square.sqrt() < 2e-4, "{}", square.sqrt());
    }

    #[test]
    fn padded_dimensions_differ_and_stay_stratified() {
        for d in [16, 17, 40, 1_000_000] {
            let mut line: Vec<u32> = (0..256).map(|i| sobol(i, d)).collect();
            assert_ne!(line, (0..256).map(|i| sobol(i, d % SOBOL_DIMENSIONS)).collect::<Vec<_>>());
            line.sort_unstable();
            line.dedup();
            assert_eq!(line.len(), 256);
        }
    }
}
