//! The light that a filter lost, given back: the mean of a filtered picture is that of the noisy one.
//!
//! Weights that follow from colours are biased. Bright pixels are unlike all others: those around do not count them,
//! and they count those around. So the mean falls, the more the longer the tail of the noise. What a channel of a pixel
//! lost, r = noisy − filtered, is given back in four parts.
//!
//! 1. Where r is far beyond the noise of the pixel, or of those around that lost as much, and far beyond what is left,
//!    detail was lost, such as a lamp that covers a part of the pixel: it gets r back ([`Amount`], [`FACTORS`]).
//!    A single bright path does not pass, since its pixel's standard deviation is as large as its radiance. The same
//!    holds of r where all within reach may take too little beside it ([`CAPACITIES`]), where [`Amount`] says so.
//! 2. The rest goes to the pixels around, in proportion to what they may take, w = min(filtered, σ), σ being the
//!    standard deviation that the variance of their neighbourhood tells: calm surfaces keep their light. With nodes
//!    every [`SPACING`] pixels, bilinear weights P of nodes for pixels, and a tent K over nodes,
//!
//!    ```text
//!    R = Pᵀ r    W = K Pᵀ w    g = K (R / W)    balanced = filtered + w · P g
//!    ```
//!
//!    The sum is that of the noisy picture for any K that is symmetric. The gain g is smooth, so neither noise nor
//!    detail comes back; it is bounded, so that a path brighter than all around does not shine into what is dark.
//! 3. What the bound left goes, where [`Amount`] says so, to all that is there in proportion to its light, with a bound
//!    of its own: likewise to pixels around, then by one factor to the whole picture. So rare paths make the picture
//!    slightly brighter where they were held back, without points.
//! 4. The rest stays with the pixels that lost most, as far as they lost more than a level.

use rayon::prelude::*;
use steradian_math::Vec3;

use crate::image::Image;

/// Pixels from node to node.
const SPACING: usize = 8;
/// Radius of the tent, in nodes: with 4, the gain is noisier and the error larger by a few per cent.
const REACH: usize = 20;
/// Ratio of a loss to the remaining value at which it begins to be detail, and at which it is so wholly.
const FACTORS: [f64; 2] = [1.0, 3.0];
/// The part of all that those within reach may take that a pixel may lose to them: beyond, it keeps its loss as well.
const CAPACITIES: [f64; 2] = [0.02, 0.05];
/// Bounds of the light that is given back.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Amount {
    /// Standard deviations of its own from which on a loss begins to be detail, and from which on it is so wholly. Of
    /// one bright sample among n it is 1, of k about √k.
    pub noises: [f64; 2],
    /// Likewise of those of the 3×3 pixels around that lost as much, together: a lamp is in several of them.
    pub noises_around: [f64; 2],
    /// The largest part of what it may take that a pixel is given.
    pub most_gain: f64,
    /// The largest part of all that it has that a pixel is given beyond that, nearby and then in the whole picture.
    pub most_wide_gain: f64,
    /// Pixels brighter than those around can take keep their loss, as points.
    pub keeps_points: bool,
}

/// Keeps quotients finite.
const TINY: f64 = 1e-30;
/// The part of all losses that is of rounding.
const ROUNDING: f64 = 1e-9;

impl Amount {
    /// Pixels around take what they can; the rest stays with the pixels that lost it.
    pub const ALL: Self =
        Self { noises: [1.5, 2.5], noises_around: [2.0, 3.0], most_gain: 0.3, most_wide_gain: 0.0, keeps_points: true };
}

/// Gives back what pixels that `counts` tells of, by their places, have lost. `noisy` is finite there. Without a
/// variance, they may take as much as they have, and no loss is known to be detail. The result does not depend on the
/// number of threads.
pub(crate) fn give_back(
    filtered: &mut Image<Vec3>,
    noisy: &Image<Vec3>,
    variance: Option<&Image<Vec3>>,
    counts: impl Fn(usize) -> bool + Sync,
    amount: Amount,
) {
    let nodes = Nodes::over(filtered.size());
    let before = &*filtered;
    // Each channel is balanced by itself: losses of channels differ.
    let of_channel = |c: usize| {
        let at = |image: &Image<Vec3>, place: usize| f64::from(image.values()[place][c]);
        let known = |place: usize| variance.map(|v| at(v, place)).filter(|v| v.is_finite() && *v >= 0.0);
        // r = noisy − filtered for pixels that count; the others neither lose nor take.
        let pixel = |place: usize| {
            let left = at(before, place);
            if counts(place) { Pixel::new(at(noisy, place), left, known(place)) } else { Pixel::default() }
        };
        let pixels: Vec<Pixel> = (0..before.values().len()).into_par_iter().map(pixel).collect();
        nodes.gains(&with_detail(&pixels, before.size(), amount), amount)
    };
    let gains: Vec<Vec<f64>> = (0..3usize).into_par_iter().map(of_channel).collect();
    filtered.values_mut().par_iter_mut().enumerate().for_each(|(place, value)| {
        let more = [0, 1, 2].map(|c| gains[c][place] as f32);
        *value = (*value + Vec3::from_array(more)).clamp(Vec3::splat(f32::MIN), Vec3::splat(f32::MAX));
    });
}

/// Loss of a channel of a pixel, and the light that it may take.
#[derive(Clone, Copy, Debug, Default)]
struct Pixel {
    /// Part of the loss that the pixel itself gets back.
    detail: f64,
    /// The rest of its loss.
    lost: f64,
    /// The most that it may take.
    most: f64,
    variance: Option<f64>,
}

impl Pixel {
    fn new(noisy: f64, filtered: f64, variance: Option<f64>) -> Self {
        Self { detail: 0.0, lost: noisy - filtered, most: filtered.max(0.0), variance }
    }
}

/// A smooth step, from 0 to 1.
fn part(value: f64, [from, to]: [f64; 2]) -> f64 {
    let t = ((value - from) / (to - from)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// Pixels with what of their loss is detail.
fn with_detail(pixels: &[Pixel], size: [u32; 2], amount: Amount) -> Vec<Pixel> {
    let [width, height] = size.map(|n| n as usize);
    let noises = |lost: f64, variance: f64| lost / variance.sqrt().max(TINY);
    let found = |place: usize| {
        let pixel = pixels[place];
        let (Some(variance), true) = (pixel.variance, pixel.lost > FACTORS[0] * pixel.most) else { return pixel };
        // Losses of the 3×3 pixels around that are alike, and the variance of their sum.
        let ([x, y], mut lost, mut of_all) = ([place % width, place / width], 0.0, 0.0);
        for row in y.saturating_sub(1)..(y + 2).min(height) {
            let near = &pixels[row * width + x.saturating_sub(1)..row * width + (x + 2).min(width)];
            for near in near.iter().filter(|near| near.lost > FACTORS[0] * near.most) {
                lost += near.lost;
                of_all += near.variance.unwrap_or(0.0);
            }
        }
        // In standard deviations: of the pixel alone, and of those around together.
        let alone = part(noises(pixel.lost, variance), amount.noises);
        let together = part(noises(lost, of_all), amount.noises_around);
        // Detail is what is beyond the noise and beyond what is left as well.
        let detail = pixel.lost * alone.max(together) * part(pixel.lost / pixel.most.max(TINY), FACTORS);
        Pixel { detail, lost: pixel.lost - detail, ..pixel }
    };
    (0..pixels.len()).into_par_iter().map(found).collect()
}

/// A coarse grid over a picture.
struct Nodes {
    /// Columns and rows of nodes.
    count: [usize; 2],
    /// For each column, and each row, of pixels the node before it, and how much the one after that weighs: P.
    along: [Vec<(usize, f64)>; 2],
}

impl Nodes {
    fn over(size: [u32; 2]) -> Self {
        let place = |at: u32| {
            let at = (f64::from(at) + 0.5) / SPACING as f64;
            (at as usize, at.fract())
        };
        Self {
            // A node more than cells, so that every pixel lies between two.
            count: size.map(|n| (n as usize).div_ceil(SPACING) + 1),
            along: size.map(|n| (0..n).map(place).collect()),
        }
    }

    /// Sums of values of pixels at nodes: Pᵀ.
    fn collect(&self, of: impl Fn(usize) -> f64 + Sync) -> Vec<f64> {
        let [columns, rows] = &self.along;
        // Rows in parallel, each onto the nodes of its row; then all rows onto the rows of nodes.
        let (width, across) = (columns.len(), self.count[0]);
        let along_row = |y: usize| {
            let mut sums = vec![0.0; across];
            for (x, (node, after)) in columns.iter().enumerate() {
                let value = of(y * width + x);
                sums[*node] += (1.0 - after) * value;
                sums[node + 1] += after * value;
            }
            sums
        };
        let of_rows: Vec<Vec<f64>> = (0..rows.len()).into_par_iter().map(along_row).collect();
        let mut all = vec![0.0; across * self.count[1]];
        for ((node, after), sums) in rows.iter().zip(of_rows) {
            for (x, sum) in sums.into_iter().enumerate() {
                all[node * across + x] += (1.0 - after) * sum;
                all[(node + 1) * across + x] += after * sum;
            }
        }
        all
    }

    /// A number for each pixel from the value of nodes there, P, and the pixel's place.
    fn at_pixels(&self, nodes: &[f64], of: impl Fn(f64, usize) -> f64 + Sync) -> Vec<f64> {
        let [columns, rows] = &self.along;
        let (width, across) = (columns.len(), self.count[0]);
        let mut values = vec![0.0; width * rows.len()];
        // Interpolate the two rows of nodes once for the line of pixels, then along it.
        values.par_chunks_mut(width.max(1)).zip(rows).enumerate().for_each(|(y, (values, (node, below)))| {
            let between = |x: usize| {
                let node = node * across + x;
                (1.0 - below) * nodes[node] + below * nodes[node + across]
            };
            let line: Vec<f64> = (0..across).map(between).collect();
            for (x, (value, (node, after))) in values.iter_mut().zip(columns).enumerate() {
                *value = of((1.0 - after) * line[*node] + after * line[node + 1], y * width + x);
            }
        });
        values
    }

    /// The tent over nodes, K: along rows, then along columns.
    fn spread(&self, nodes: &[f64]) -> Vec<f64> {
        // The tent is separable: weights REACH − |distance| along one axis, then the other.
        let along = |from: &[f64], length: usize, stride: usize| -> Vec<f64> {
            let tent = |node: usize| {
                let at = node / stride % length;
                let first = node - at * stride;
                let reached = at.saturating_sub(REACH - 1)..(at + REACH).min(length);
                reached.map(|other| (REACH - at.abs_diff(other)) as f64 * from[first + other * stride]).sum()
            };
            (0..from.len()).map(tent).collect()
        };
        let [columns, rows] = self.count;
        along(&along(nodes, columns, 1), rows, columns)
    }

    /// Light that pixels may take: no more than they have, and than the standard deviation from the mean of the
    /// variances around, where one is known.
    fn shares(&self, pixels: &[Pixel]) -> Vec<f64> {
        // Mean variance at the nodes, of the pixels of which it is known; the root is what noise may hide.
        let sums = self.collect(|place| pixels[place].variance.unwrap_or(0.0));
        let counts = self.collect(|place| f64::from(u8::from(pixels[place].variance.is_some())));
        let mean = |(sum, count): (&f64, f64)| if count > 0.0 { sum / count } else { f64::MAX };
        let means: Vec<f64> = sums.iter().zip(counts).map(mean).collect();
        self.at_pixels(&means, |variance, place| pixels[place].most.min(variance.sqrt()))
    }

    /// Pixels of which what is too bright for those around is kept as well.
    fn too_bright(&self, pixels: &[Pixel], capacity: &[f64]) -> Vec<Pixel> {
        let peak = (REACH * REACH) as f64;
        // The loss against all that those within reach of its tent may take.
        let parts = self
            .at_pixels(capacity, |capacity, place| part(pixels[place].lost * peak / capacity.max(TINY), CAPACITIES));
        let kept = |(pixel, part): (&Pixel, f64)| {
            let more = pixel.lost.max(0.0) * part;
            Pixel { detail: pixel.detail + more, lost: pixel.lost - more, ..*pixel }
        };
        pixels.iter().zip(parts).map(kept).collect()
    }

    /// Light that pixels are given for what was lost around them: a smooth gain, bounded, of their shares.
    fn given(&self, lost: &[f64], shares: &[f64], capacity: &[f64], most_gain: f64) -> Vec<f64> {
        // g = K (R/W): the gain of nodes, bounded.
        let quotient = |(lost, shares): (f64, &f64)| if *shares > 0.0 { lost / shares } else { 0.0 };
        let lost = self.collect(|place| lost[place]);
        let mut nodes = self.spread(&lost.into_iter().zip(capacity).map(quotient).collect::<Vec<_>>());
        nodes.iter_mut().for_each(|gain| *gain = gain.clamp(-most_gain, most_gain));
        self.at_pixels(&nodes, |gain, place| shares[place] * gain)
    }

    /// Light given to each pixel of a channel.
    fn gains(&self, pixels: &[Pixel], amount: Amount) -> Vec<f64> {
        // W = K Pᵀ w: what may be taken around each node.
        let capacity = |shares: &[f64]| self.spread(&self.collect(|place| shares[place]));
        let shares = self.shares(pixels);
        let reached = capacity(&shares);
        let kept = amount.keeps_points.then(|| self.too_bright(pixels, &reached));
        let pixels = kept.as_deref().unwrap_or(pixels);
        let mut lost: Vec<f64> = pixels.iter().map(|pixel| pixel.lost).collect();
        let all: f64 = lost.iter().map(|lost| lost.abs()).sum();
        let mut gains: Vec<f64> = pixels.iter().map(|pixel| pixel.detail).collect();
        let give = |given: &[f64], lost: &mut [f64], gains: &mut [f64]| {
            for ((lost, gain), given) in lost.iter_mut().zip(gains).zip(given) {
                *lost -= given;
                *gain += given;
            }
        };
        give(&self.given(&lost, &shares, &reached, amount.most_gain), &mut lost, &mut gains);
        if amount.most_wide_gain > 0.0 {
            // All that is there takes what noise does not hide: first nearby, then in the whole picture.
            let shares: Vec<f64> = pixels.iter().map(|pixel| pixel.most).collect();
            give(&self.given(&lost, &shares, &capacity(&shares), amount.most_wide_gain), &mut lost, &mut gains);
            let (left, whole): (f64, f64) = (lost.iter().sum(), shares.iter().sum());
            let gain = (left / whole.max(TINY)).clamp(-amount.most_wide_gain, amount.most_wide_gain);
            give(&shares.iter().map(|share| share * gain).collect::<Vec<_>>(), &mut lost, &mut gains);
        }
        // What the bounds left out goes to the pixels that lost most, down to a common level.
        let left: f64 = lost.iter().sum();
        // Where more was given than lost, the pixels that won most pay.
        let sign = if left < 0.0 { -1.0 } else { 1.0 };
        let losses: Vec<f64> = pixels.par_iter().map(|pixel| sign * pixel.lost).collect();
        let level = if left.abs() > ROUNDING * all { level(&losses, left.abs()) } else { f64::INFINITY };
        for (gain, loss) in gains.iter_mut().zip(losses) {
            *gain += sign * (loss - level).max(0.0);
        }
        gains
    }
}

/// The level above which numbers have a sum; 0 where all that are positive have less.
fn level(values: &[f64], sum: f64) -> f64 {
    let mut sorted: Vec<f64> = values.iter().copied().filter(|value| *value > 0.0).collect();
    // From the largest down until the sum above the next value suffices; the level lies between the two.
    sorted.par_sort_unstable_by(|a, b| b.total_cmp(a));
    let (mut total, mut count) = (0.0, 0.0);
    for (k, value) in sorted.iter().enumerate() {
        (total, count) = (total + value, count + 1.0);
        let next = sorted.get(k + 1).copied().unwrap_or(0.0);
        if total - count * next >= sum {
            return ((total - sum) / count).max(0.0);
        }
    }
    0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_level_leaves_the_sum() {
        let values = [3.0, -4.0, 1.0, 8.0, 2.0, 0.0];
        for sum in [0.0, 1.0, 5.0, 7.5, 13.9] {
            let level = level(&values, sum);
            let above: f64 = values.iter().map(|value| (value - level).max(0.0)).sum();
            assert!((above - sum).abs() < 1e-12, "{above} for {sum}");
        }
        assert_eq!(level(&values, 20.0), 0.0);
        assert_eq!(level(&[], 1.0), 0.0);
    }
}
