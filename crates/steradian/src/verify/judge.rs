//! Statistical tests of a picture against a reference.

use super::{MOST, picture::Values, quantile::quantile};

/// The chance that an integrator that agrees is said not to, in one look at it; half of it for the blocks, and half for
/// the mean.
const ALPHA: f64 = 0.002;
/// Errors smaller than this part of the picture's mean are those of rounding.
const ROUNDING: f64 = 1e-4;
/// Nothing is decided where a difference of the mean by this part could go unseen.
pub const POWER: f64 = 0.01;

/// More than the samples that are expected to decide, by this factor.
const MARGIN: f64 = 1.2;

/// `1/(2^p − 1)` for an error of order p = 0.74.
const ORDER: f64 = 1.5;
/// Blocks in which errors of different sign meet change less than they err, by so many times the usual change.
const SLACK: f64 = 2.0;

/// Verdict on an integrator.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// No difference was found, and one of [`POWER`] would have been.
    Agrees,
    /// Difference of a bias that shrinks with the radius or the size of patches; its limit is the reference.
    Converges,
    /// No difference is seen, but a large one might not be either; or the errors are not known well enough.
    Undecided,
    /// Difference that noise does not explain.
    Differs,
}

/// Difference of a picture from the reference.
#[derive(Clone, Debug)]
pub struct Difference {
    /// Mean over the picture and the channels, over that of the reference; noisy blocks count less.
    pub ratio: f64,
    /// The smallest difference of `ratio` from one that is told from noise.
    pub detects: f64,
    /// Root mean square of the differences of blocks, over the reference's mean.
    pub difference: f64,
    /// Expected value of that by noise alone.
    pub noise: f64,
    /// Difference of each block in standard errors, by channel (R, G, B), rows of blocks from the top; `None` where
    /// the error is not known.
    pub z: Vec<Option<f64>>,
    /// Edge of the blocks in pixels; those at the right and at the bottom may be cut.
    pub edge: usize,
    /// The largest magnitude among `z`.
    pub largest: f64,
    /// The largest that is allowed.
    pub allowed: f64,
    /// Change of `ratio` when the radius or the edges of patches were halved, for biased integrators.
    pub change: Option<f64>,
    /// True if the errors are known, so that more samples can decide.
    pub is_reliable: bool,
    /// Verdict.
    pub verdict: Verdict,
}

impl Difference {
    /// With how many rounds it is likely decided, if not yet and if these are affordable; `rounds` are there.
    pub(super) fn needed(&self, rounds: u32) -> Option<u32> {
        let is_noisy = self.is_reliable && self.verdict == Verdict::Undecided && self.detects > POWER;
        // Errors shrink by the root of their number, and are themselves known but roughly.
        let needed = MARGIN * f64::from(rounds) * (self.detects / POWER).powi(2);
        (is_noisy && needed <= f64::from(MOST)).then_some(needed.ceil() as u32)
    }
}

/// Amount by which a value is farther from the reference than noise and bias allow: a bias that is about halved or less
/// where the radius is halved (an error of order 0.74 and higher) is at most [`ORDER`] times as much as it was seen to
/// change, in the direction of that change.
fn beyond(difference: f64, change: f64, slack: f64) -> f64 {
    let change = ORDER * change;
    let (low, high) = (change.min(0.0) - slack, change.max(0.0) + slack);
    (difference - high).max(low - difference).max(0.0)
}

/// Weights of blocks in means that noise disturbs little: what is noisier than half of all blocks counts less, and what
/// few bright paths make not at all.
fn weights(all: &[&Values]) -> Vec<f64> {
    let variance = |k: usize| all.iter().map(|v| v.blocks[k].variance).sum::<f64>();
    let variances: Vec<f64> = (0..all[0].blocks.len()).map(variance).collect();
    let mut sorted = variances.clone();
    sorted.sort_by(f64::total_cmp);
    let usual = sorted.get(sorted.len() / 2).copied().unwrap_or(0.0).max(f64::MIN_POSITIVE);
    let is_known = |k: usize| all.iter().all(|v| v.is_known[k]);
    let weight = |(k, v): (usize, &f64)| if is_known(k) { usual / (usual + v) } else { 0.0 };
    let weights: Vec<f64> = variances.iter().enumerate().map(weight).collect();
    let sum = weights.iter().sum::<f64>().max(f64::MIN_POSITIVE);
    weights.iter().map(|w| w / sum).collect()
}

/// Holds values against a reference; `wider` are those with twice the bias or more, for a method that has some.
pub(super) fn compare(reference: &Values, ours: &Values, wider: Option<&Values>) -> Difference {
    let all: Vec<&Values> = [Some(reference), Some(ours), wider].into_iter().flatten().collect();
    let weights = weights(&all);
    let (count, freedom) =
        (weights.iter().filter(|w| **w > 0.0).count().max(1), all.iter().map(|v| v.freedom).min().unwrap_or(0));
    let (a, b) = (ours.mean(&weights), reference.mean(&weights));
    let level = b.mean.abs().max(f64::MIN_POSITIVE);
    let (allowed, allowed_of_mean) = (quantile(0.5 * ALPHA, count, freedom), quantile(0.5 * ALPHA, 1, freedom));
    // Errors of blocks are heavier-tailed than normal ones where few paths carry much, and their variances are
    // underestimated where none of these came: no block counts as surer than half the picture's usual error.
    let counting = || (0..weights.len()).filter(|k| weights[*k] > 0.0);
    let usual = counting().map(|k| ours.blocks[k].variance + reference.blocks[k].variance).sum::<f64>() / count as f64;
    let change_of = |k: usize| wider.map_or(0.0, |w| ours.blocks[k].mean - w.blocks[k].mean);
    let usual_change = (counting().map(|k| change_of(k).powi(2)).sum::<f64>() / count as f64).sqrt();
    let in_errors = |d: f64, variance: f64| {
        (d - ROUNDING * level).max(0.0) / variance.max(0.25 * usual).sqrt().max(f64::MIN_POSITIVE)
    };
    let (mut squares, mut noise, mut largest_beyond) = (0.0, 0.0, 0.0_f64);
    let mut z = vec![None; weights.len()];
    for k in counting() {
        let (a, b) = (ours.blocks[k], reference.blocks[k]);
        let d = a.mean - b.mean;
        squares += d * d;
        noise += a.variance + b.variance;
        z[k] = Some(in_errors(d.abs(), a.variance + b.variance).copysign(d));
        if let Some(w) = wider {
            let v = 4.0 * a.variance + b.variance + w.blocks[k].variance;
            largest_beyond = largest_beyond.max(in_errors(beyond(-d, change_of(k), SLACK * usual_change), v));
        }
    }
    let largest = z.iter().flatten().fold(0.0_f64, |largest, z| largest.max(z.abs()));
    let detects_with = |variance: f64| ROUNDING + allowed_of_mean * variance.sqrt() / level;
    let (ratio, detects) = (a.mean / level, detects_with(a.variance + b.variance));
    let is_same = largest <= allowed && (ratio - 1.0).abs() <= detects;
    // The limit, and whether a difference of it would be seen.
    let limit = wider.map(|w| {
        let w = w.mean(&weights);
        let change = (a.mean - w.mean) / level;
        let noise = detects_with(4.0 * a.variance + b.variance + w.variance);
        let is_same = largest_beyond <= allowed && beyond(1.0 - ratio, change, 0.0) <= noise;
        (change, is_same, noise <= 2.0 * POWER)
    });
    let is_reliable = all.iter().all(|v| v.is_reliable);
    let verdict = if !is_reliable {
        Verdict::Undecided
    } else if is_same {
        if detects <= POWER { Verdict::Agrees } else { Verdict::Undecided }
    } else {
        match limit {
            Some((_, true, true)) => Verdict::Converges,
            Some((_, true, false)) => Verdict::Undecided,
            _ => Verdict::Differs,
        }
    };
    let root = |v: f64| (v / count as f64).sqrt() / level;
    let change = limit.map(|l| l.0);
    let (difference, noise) = (root(squares), root(noise));
    let edge = ours.edge;
    Difference { ratio, detects, difference, noise, z, edge, largest, allowed, change, is_reliable, verdict }
}

#[cfg(test)]
mod tests {
    use super::{super::picture::Picture, *};

    /// A picture of 16 blocks with a relative error.
    fn of(level: f64, error: f64) -> Values {
        let noise = |k: usize| (k as f64 * 0.618_034).fract() - 0.5;
        let part =
            |n: usize| (0..16).map(|k| level * (1.0 + error * 32_f64.sqrt() * noise(16 * n + k) * 3.46)).collect();
        Picture::of((0..32).map(part).collect()).values()
    }

    #[test]
    fn what_noise_hides_is_not_decided() {
        let verdict = |level, error| compare(&of(1.0, error), &of(level, error), None).verdict;
        assert_eq!(verdict(1.0, 0.005), Verdict::Agrees);
        assert_eq!(verdict(1.1, 0.005), Verdict::Differs);
        assert_eq!(verdict(1.02, 0.1), Verdict::Undecided);
        assert_eq!(verdict(1.01, 0.001), Verdict::Differs);
        let doubtful = Values { is_reliable: false, ..of(1.1, 0.001) };
        assert_eq!(compare(&of(1.0, 0.001), &doubtful, None).verdict, Verdict::Undecided);
    }

    /// Noise is worth more samples where these are affordable; errors that are not known are not.
    #[test]
    fn samples_are_added_where_they_decide() {
        let found = |error: f64| compare(&of(1.0, error), &of(1.0, error), None);
        let (sure, noisy, hopeless) = (found(0.001), found(0.02), found(0.5));
        assert_eq!((sure.verdict, sure.needed(16)), (Verdict::Agrees, None));
        let rounds = noisy.needed(16).expect("an affordable number");
        assert!(noisy.detects > POWER && rounds > 16 && rounds <= MOST, "{noisy:?} {rounds}");
        assert_eq!(hopeless.needed(16), None);
        assert_eq!(Difference { is_reliable: false, ..noisy }.needed(16), None);
    }

    /// A bias is excused by the limit to which it goes, not because it becomes less.
    #[test]
    fn limits_are_tested() {
        let verdict =
            |level: f64, wider: f64| compare(&of(1.0, 1e-3), &of(level, 1e-3), Some(&of(wider, 1e-3))).verdict;
        // First and second order.
        assert_eq!(verdict(0.97, 0.94), Verdict::Converges);
        assert_eq!(verdict(0.97, 0.88), Verdict::Converges);
        // The same error at both radii, or one that shrinks to another limit, or grows.
        assert_eq!(verdict(0.97, 0.97), Verdict::Differs);
        assert_eq!(verdict(0.94, 0.91), Verdict::Differs);
        assert_eq!(verdict(0.97, 0.99), Verdict::Differs);
    }
}
