//! Trial of sharing: the group size that pays, by a few groups of pixels from all over the picture, before a render.
//!
//! Pictures are looked at from afar, made smaller, and denoised: what counts is the error of single pixels and of means
//! over 4 × 4, 8 × 8 and 16 × 16 of them, all alike. A mean over n × n pixels has the variance `(v + κ(n) c)/n²`, with
//! `v` that of a pixel, `c` the covariance of two members of a group, and `κ(n)` how many of the other pixels of the
//! square share with one, in the mean over samples. The group for which the geometric mean over the four, times cost,
//! is least is taken.

use super::probe::Probe;
use crate::{
    adaptive::FLOOR,
    partition::{MAX_GROUP, Partition, TILE},
    path::PathTracer,
    precomputed::Precomputed,
};
use rayon::prelude::*;
use steradian_core::Scene;
use steradian_math::sobol;

/// Group sizes that are tried.
pub const SIZES: [u32; 3] = [1, 4, MAX_GROUP as u32];
/// The CPU time of a ray with so many, over that of one of paths that share nothing, which go in waves. Measured.
const RAY: [f64; SIZES.len()] = [1.0, 2.0, 1.5];
/// Samples of a pixel, spread over each other as those of a picture are, in each of two renders.
const SAMPLES: u32 = 4;
/// Samples of the picture for each group that is tried, and bounds of their number.
const PER_GROUP: u64 = 1 << 13;
const GROUPS: (u64, u64) = (32, 384);
/// Variance × cost has to become less by this factor.
const WORTH: f64 = 1.25;
/// The variance of means over pixels that share nothing, over that of independent ones: the default sampler lets
/// neighbours err in opposite directions.
const SPREAD: f64 = 0.75;

/// Measurements of one size of groups, summed over the picture.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Found {
    /// Relative squared differences of two renders over two, summed over pixels.
    variance: f64,
    /// Products of relative differences over two, summed over ordered pairs of members, and the number of pairs.
    covariance: f64,
    pairs: f64,
    pixels: f64,
    cost: f64,
}

impl Found {
    fn plus(self, o: Self) -> Self {
        Self {
            variance: self.variance + o.variance,
            covariance: self.covariance + o.covariance,
            pairs: self.pairs + o.pairs,
            pixels: self.pixels + o.pixels,
            cost: self.cost + o.cost,
        }
    }

    /// The geometric mean over the scales of variance, times cost.
    fn product(&self, size: u32) -> f64 {
        // Mean variance v of a pixel, and mean covariance c of two members.
        let variance = self.variance / self.pixels.max(1.0);
        let covariance = if self.pairs > 0.0 { (self.covariance / self.pairs).clamp(0.0, variance) } else { 0.0 };
        let edge = size.isqrt();
        // Of the four scales the first two are within a block, no two pixels of which share.
        let scales = [0.0, 0.0, partners(2, edge), partners(4, edge)];
        // ∏ (v + κ(n) c)^(1/4) over the four scales; the factor n² is common to all sizes.
        let product: f64 = scales.iter().map(|n| (variance + n * covariance).powf(0.25)).product();
        let spread = if size == 1 { SPREAD.powf(0.75) } else { 1.0 };
        spread * product * self.cost / self.pixels.max(1.0)
    }
}

/// Mean number of pixels of a square that share with one of it, over its pixels and over samples; edges of the square
/// and of windows, in blocks.
fn partners(square: u32, window: u32) -> f64 {
    // Along one axis two blocks share with probability (w − |i − j|)/w; both axes are independent.
    let axis: f64 = (0..square * square)
        .map(|k| f64::from(window.saturating_sub((k / square).abs_diff(k % square))) / f64::from(window))
        .sum();
    (axis / f64::from(square)).powi(2) - 1.0
}

/// Selects the group size for a picture of so many samples.
pub(crate) fn trial<const MEDIA: bool>(
    path: &PathTracer<MEDIA>,
    scene: &Scene,
    precomputed: &Precomputed,
    samples: u64,
) -> u32 {
    // Many groups for large renders, few for small ones.
    let groups = (samples / PER_GROUP).clamp(GROUPS.0, GROUPS.1) as u32;
    let found: Vec<[Found; SIZES.len()]> =
        (0..groups).into_par_iter().map(|k| of_group(path, scene, precomputed, k)).collect();
    best(&std::array::from_fn(|size| found.iter().map(|f| f[size]).fold(Found::default(), Found::plus)))
}

/// The size that pays.
fn best(found: &[Found; SIZES.len()]) -> u32 {
    // Variance × cost in CPU time; sharing has to win clearly.
    let product = |size: usize| RAY[size] * found[size].product(SIZES[size]);
    let best = (0..SIZES.len()).min_by(|a, b| product(*a).total_cmp(&product(*b)));
    best.filter(|best| product(*best) * WORTH < product(0)).map_or(1, |best| SIZES[best])
}

/// Measurements of the pixels of one large group, by groups of all sizes.
fn of_group<const MEDIA: bool>(
    path: &PathTracer<MEDIA>,
    scene: &Scene,
    precomputed: &Precomputed,
    k: u32,
) -> [Found; SIZES.len()] {
    let place = sobol::shuffled_scrambled_sobol_2d(k, 9);
    let size = [scene.film().width, scene.film().height];
    let tile = [0, 1].map(|axis| (place[axis] * size[axis].div_ceil(TILE) as f32) as i32);
    let large = Partition::new(MAX_GROUP as u32, 0);
    let layer = k % Partition::LAYERS;
    // Windows that begin with the tile, so that they are whole where the frame is.
    let mut found = [Found::default(); SIZES.len()];
    let (mut level, mut count) = (0.0, 0.0);
    // The same pixels by each size of groups.
    for (size, found) in SIZES.into_iter().zip(&mut found) {
        let partition = Partition::new(size, 0);
        for window in large.parts(tile, layer, &partition) {
            let mut probe = Probe::new(scene, &partition, window);
            let members = probe.places.len();
            if members == 0 {
                continue;
            }
            let mut means = [[0.0_f64; MAX_GROUP]; 2];
            for (seed, means) in (0..).zip(&mut means) {
                for index in 0..SAMPLES {
                    let (light, cost) = probe.sample(path, scene, precomputed, seed, (index, SAMPLES));
                    means.iter_mut().zip(light).for_each(|(m, l)| *m += l / f64::from(SAMPLES));
                    found.cost += cost / f64::from(2 * SAMPLES);
                }
            }
            // Two renders a and b: v from (a − b)²/2, c from the square of the sum less the squares.
            let differences = || (0..members).map(|m| means[0][m] - means[1][m]);
            let squares: f64 = differences().map(|d| d * d / 2.0).sum();
            found.variance += squares;
            found.covariance += differences().sum::<f64>().powi(2) / 2.0 - squares;
            found.pairs += (members * (members - 1)) as f64;
            found.pixels += members as f64;
            level += (0..members).map(|m| 0.5 * (means[0][m] + means[1][m])).sum::<f64>();
            count += members as f64;
        }
    }
    // Relative to the brightness there, the same for all sizes.
    let level = level / f64::max(count, 1.0);
    let scale = 1.0 / (level * level + FLOOR);
    found.map(|f| Found { variance: f.variance * scale, covariance: f.covariance * scale, ..f })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// In a square as large as the window, of two blocks to an edge: half share with those beside them, so
    /// `(1 + ½)² − 1`.
    #[test]
    fn partners_are_counted() {
        assert_eq!([partners(1, 4), partners(2, 2), partners(4, 1)], [0.0, 1.25, 0.0]);
        assert!((partners(4, 4) - (2.75 * 2.75 - 1.0)).abs() < 1e-12);
        assert!((partners(2, 4) - (1.75 * 1.75 - 1.0)).abs() < 1e-12);
    }

    /// Sharing that takes nine tenths of the variance of pixels pays although what is left of it is common, until it
    /// costs three times as much.
    #[test]
    fn what_pays_at_all_scales_is_taken() {
        let of = |variance: f64, correlation: f64, cost: f64| Found {
            variance: variance * 100.0,
            covariance: correlation * variance * 100.0,
            pairs: 100.0,
            pixels: 100.0,
            cost: cost * 100.0,
        };
        let plain = of(1.0, 0.0, 5.0);
        assert_eq!(best(&[plain, of(0.3, 0.5, 6.0), of(0.1, 1.0, 8.0)]), 16);
        assert_eq!(best(&[plain, of(0.1, 0.5, 6.0), of(0.1, 1.0, 40.0)]), 4);
        assert_eq!(best(&[plain, of(0.9, 0.9, 7.0), of(0.8, 1.0, 10.0)]), 1);
        assert_eq!(best(&[Found::default(); 3]), 1);
    }
}
