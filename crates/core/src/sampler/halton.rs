//! Halton points: the radical inverse of the index in a prime base for each coordinate, with digits permuted at random.
//!
//! The permutation of a digit depends on all digits before it, as in Owen's scrambles (1995), so that points of a pixel
//! are uniform and those of pixels independent. Large bases are spread evenly only over many samples: beyond [`PAIRS`]
//! pairs of dimensions numbers are independent.

use super::permute::permute;
use steradian_math::hash::{ONE_MINUS_EPSILON, combine32};

/// Pairs of dimensions that have bases of their own: the first five or six events of a path.
pub(super) const PAIRS: u32 = 64;

static PRIMES: [u32; 2 * PAIRS as usize] = primes();

const fn primes() -> [u32; 2 * PAIRS as usize] {
    let mut found = [2; 2 * PAIRS as usize];
    let (mut n, mut candidate) = (1, 3);
    // Sieve by trial division at compile time.
    while n < found.len() {
        let mut k = 0;
        while k < n && candidate % found[k] != 0 {
            k += 1;
        }
        if k == n {
            found[n] = candidate;
            n += 1;
        }
        candidate += 2;
    }
    found
}

/// Coordinate `2 · pair + axis` of a point.
pub(super) fn coordinate(index: u32, pair: u32, axis: u32, seed: u32) -> f32 {
    radical_inverse(index, PRIMES[(2 * pair + axis) as usize], combine32(seed, axis))
}

/// The digits of an index in a base, permuted, after the point.
fn radical_inverse(mut index: u32, base: u32, seed: u32) -> f32 {
    let (mut x, mut scale, mut before) = (0.0, 1.0, seed);
    // To the last bit of the result.
    while scale > 1.0 / f64::from(1 << 25) {
        let digit = index % base;
        index /= base;
        scale /= f64::from(base);
        x += scale * f64::from(permute(digit, base, before));
        before = combine32(before, digit);
    }
    (x as f32).min(ONE_MINUS_EPSILON)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bases_are_the_primes() {
        assert_eq!(PRIMES[..8], [2, 3, 5, 7, 11, 13, 17, 19]);
        assert_eq!(PRIMES[127], 719);
    }

    /// The first b₁^i b₂^j points have one in each of the boxes of that many columns and rows.
    #[test]
    fn points_are_spread_over_boxes_of_their_bases() {
        for (pair, i, j) in [(0, 4, 3), (0, 6, 1), (1, 2, 1), (5, 1, 1)] {
            let [a, b] = [PRIMES[2 * pair], PRIMES[2 * pair + 1]];
            let (columns, rows) = (a.pow(i), b.pow(j));
            let mut seen = vec![false; (columns * rows) as usize];
            for k in 0..columns * rows {
                let p = [0, 1].map(|axis| f64::from(coordinate(k, pair as u32, axis, 77)));
                // Boxes have edges that are no binary fractions: rounding must not move a point over them.
                let at = |x: f64, n: u32| (x * f64::from(n) + 1e-5) as usize;
                seen[at(p[1], rows) * columns as usize + at(p[0], columns)] = true;
            }
            assert!(seen.iter().all(|s| *s), "bases {a} and {b}");
        }
    }
}
