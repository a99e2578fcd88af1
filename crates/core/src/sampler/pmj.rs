//! Progressive multi-jittered (0,2) points (Christensen, Kensler, Kilpatrick 2018, "Progressive Multi-Jittered Sample
//! Sequences"): each first 2^k points have one in every elementary interval of area 2^-k, and of the places that this
//! leaves the one farthest from the others is taken.
//!
//! One sequence of 4096 points serves all: pixels and dimensions take its points in random order, and flip the same
//! random bits in all of them, which keeps the strata. Further samples are sets of their own.

use super::permute::permute;
use std::sync::OnceLock;
use steradian_math::{
    Vec2,
    hash::{HashRng, combine32, unit_f32},
};

/// log₂ of the number of points.
const LEVELS: u32 = 12;
/// Places that are compared for each point.
const CANDIDATES: usize = 8;

/// A pair of coordinates: of `n` samples the one with an index.
pub(super) fn point(index: u32, n: u32, seed: u32) -> Vec2 {
    static POINTS: OnceLock<Vec<[u32; 2]>> = OnceLock::new();
    let points = POINTS.get_or_init(|| sequence(LEVELS, 0x5eed));
    // Restrict to a prefix of a power of two, which is stratified by itself.
    let n = n.clamp(1, 1 << LEVELS).next_power_of_two();
    let seed = combine32(seed, index / n);
    // Visit the prefix in a random order and flip random bits: an XOR scramble keeps all strata.
    let [x, y] = points[permute(index % n, n, seed) as usize];
    Vec2::new(unit_f32(x ^ combine32(seed, 1)), unit_f32(y ^ combine32(seed, 2)))
}

/// The strata of a power of two of points: for each shape of elementary intervals, which have a point.
struct Strata {
    /// log₂ of the number of strata.
    level: u32,
    /// Shape `a` has 2^a columns and 2^(level − a) rows.
    taken: Vec<Vec<bool>>,
}

impl Strata {
    fn new(level: u32, points: &[[u32; 2]]) -> Self {
        let mut strata = Self { level, taken: vec![vec![false; 1 << level]; level as usize + 1] };
        points.iter().for_each(|p| strata.take(*p));
        strata
    }

    fn cell(&self, a: u32, [x, y]: [u32; 2]) -> usize {
        let top = |v: u32, bits: u32| if bits == 0 { 0 } else { (v >> (32 - bits)) as usize };
        // The highest bits of both coordinates name the elementary interval.
        (top(y, self.level - a) << a) | top(x, a)
    }

    fn take(&mut self, p: [u32; 2]) {
        for a in 0..=self.level {
            let cell = self.cell(a, p);
            self.taken[a as usize][cell] = true;
        }
    }

    fn is_free(&self, p: [u32; 2]) -> bool {
        (0..=self.level).all(|a| !self.taken[a as usize][self.cell(a, p)])
    }
}

/// The first `2^levels` points.
fn sequence(levels: u32, seed: u64) -> Vec<[u32; 2]> {
    let mut rng = HashRng::new(seed);
    let mut points = vec![[rng.next_u64() as u32, rng.next_u64() as u32]];
    // Double the set at each level: a new point for each old one.
    for level in 1..=levels {
        let n = points.len();
        let mut strata = Strata::new(level, &points);
        // The squares of side 2^-half have a point each, or two on a diagonal; the new ones go into empty quarters of
        // them.
        let half = (level - 1) / 2;
        let quarter = 31 - half;
        // Odd levels fill the diagonally opposite quarter, even levels the other two.
        for i in 0..n {
            let p = points[i];
            let quarters: &[[u32; 2]] = if level % 2 == 1 { &[[1, 1]] } else { &[[1, 0], [0, 1]] };
            let mut places = Vec::new();
            for [dx, dy] in quarters {
                let corner = [((p[0] >> quarter) ^ dx) << quarter, ((p[1] >> quarter) ^ dy) << quarter];
                places.extend(free_places(&strata, corner, quarter));
            }
            let Some(best) = spread(&places, &points, level, &mut rng) else { continue };
            strata.take(best);
            points.push(best);
        }
    }
    points
}

/// The cells of the finest strata, within a square of 2^`quarter` from a corner, whose elementary intervals are all
/// empty.
fn free_places(strata: &Strata, [x, y]: [u32; 2], quarter: u32) -> Vec<[u32; 2]> {
    let fine = 32 - strata.level;
    let steps = 1_u32 << (quarter + strata.level - 32);
    let axis = |from: u32, a: u32, of: fn(u32) -> [u32; 2]| -> Vec<u32> {
        (0..steps).map(|s| from + (s << fine)).filter(|v| !strata.taken[a as usize][strata.cell(a, of(*v))]).collect()
    };
    // Free columns and rows first; their crossings are tested in the other shapes.
    let (xs, ys) = (axis(x, strata.level, |v| [v, 0]), axis(y, 0, |v| [0, v]));
    xs.iter().flat_map(|x| ys.iter().map(|y| [*x, *y])).filter(|p| strata.is_free(*p)).collect()
}

/// The candidate farthest from all points on the torus, among places jittered within their cells.
fn spread(places: &[[u32; 2]], points: &[[u32; 2]], level: u32, rng: &mut HashRng) -> Option<[u32; 2]> {
    let jitter = (1_u64 << (32 - level)) - 1;
    let mut best: Option<(u64, [u32; 2])> = None;
    for _ in 0..CANDIDATES.min(places.len()) {
        // Best candidate: the one whose nearest neighbour is farthest.
        let place = places[((u128::from(rng.next_u64()) * places.len() as u128) >> 64) as usize];
        let candidate = place.map(|v| v | (rng.next_u64() & jitter) as u32);
        // Toroidal distance by wrapping subtraction.
        let distance = |p: &[u32; 2]| -> u64 {
            (0..2).map(|k| u64::from((candidate[k].wrapping_sub(p[k]) as i32).unsigned_abs()).pow(2) >> 1).sum()
        };
        let nearest = points.iter().map(distance).min().unwrap_or(u64::MAX);
        if best.is_none_or(|(d, _)| nearest > d) {
            best = Some((nearest, candidate));
        }
    }
    best.map(|(_, p)| p)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn first_powers_of_two_are_nets() {
        let points = sequence(8, 3);
        assert_eq!(points.len(), 256, "a point found no place");
        for level in 0..=8 {
            let strata = Strata::new(level, &points[..1 << level]);
            assert!(strata.taken.iter().flatten().all(|t| *t), "2^{level} points");
        }
    }

    /// The points keep a distance: with 256 of them the smallest is more than a tenth of that of a hexagonal packing;
    /// among independent points the nearest two are some 200 times nearer than packed ones.
    #[test]
    fn points_keep_a_distance() {
        let points = sequence(8, 3);
        let mut nearest = f64::MAX;
        for (i, p) in points.iter().enumerate() {
            for q in &points[..i] {
                let d = [0, 1].map(|k| f64::from(p[k].wrapping_sub(q[k]) as i32) / 2_f64.powi(32));
                nearest = nearest.min(d[0].hypot(d[1]));
            }
        }
        let packed = (2.0 / (3_f64.sqrt() * 256.0)).sqrt();
        assert!(nearest > 0.1 * packed, "{nearest} of {packed}");
    }
}
