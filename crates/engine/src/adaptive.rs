//! Adaptive sampling: more samples where the picture errs more, without bias.
//!
//! The picture is made in rounds, each of which takes four times the samples of all before it together, with random
//! numbers of its own. The first spreads them evenly. Each later one gives every cell of 8 × 8 pixels a number that
//! follows from what the rounds *before* it found, and a pixel is put together from its rounds,
//!
//! `I_r = (1 − a_r) I_{r−1} + a_r Ī_r`
//!
//! with weights `a_r` that are fixed beforehand: they follow from how many samples the rounds have in the mean over the
//! picture, not from how many the pixel has. Given the past, the mean `Ī_r` of a round has the right expectation
//! whatever the number of its samples, and so has `I_r`. Weights by number would not do: pixels that by chance look
//! dark and even get few samples, so dark beginnings would count for more than bright ones (Kirk, Arvo 1991, "Unbiased
//! Sampling Techniques for Image Synthesis").
//!
//! Where the first round tells that little is gained it goes on evenly to the end, as if nothing had been asked for.
//!
//! For a sum of squared relative errors `Σ s²/n` at the cost `Σ c n`, the best numbers are `n ∝ s/√c`; `s²` is the mean
//! relative variance of a sample in the cell, `c` its rays.

/// Edge of the cells that get numbers of samples of their own, pixels. Groups of pixels that share paths lie within a
/// cell.
pub const CELL: u32 = 8;

/// Relative errors are against `√(I² + FLOOR)`, so that black pixels have one too. That of the metric relMSE.
pub const FLOOR: f64 = 0.01;

/// Samples of a round over those of all rounds before it, plus one.
const GROWTH: u32 = 4;
/// Samples of the first round.
const FIRST: u32 = 4;
/// Fewest samples of a cell, as a part of the mean; there are at least two, to have a variance.
const FEWEST: f64 = 0.125;
/// Most samples of a cell, as a multiple of the mean.
const MOST: f64 = 32.0;
/// Worth of a sample of the first, even round against one of the second.
const FIRST_WORTH: f64 = 0.5;

/// A round: the samples per pixel, in the mean over the picture, before and after it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Round {
    /// Number of the round, from zero.
    pub number: u32,
    /// Samples before it.
    pub start: u32,
    /// Samples after it.
    pub end: u32,
}

impl Round {
    /// The first of a render of `spp` samples per pixel.
    pub fn first(spp: u32, adaptive: bool) -> Self {
        let mut end = spp;
        // The last round ends with the render, so the first is the part that is left when it is divided down.
        while adaptive && end / GROWTH >= FIRST {
            end /= GROWTH;
        }
        if adaptive && end == spp {
            end = spp.div_ceil(2);
        }
        Self { number: 0, start: 0, end }
    }

    /// The one after this.
    pub fn next(self, spp: u32) -> Self {
        let end = self.end.saturating_mul(GROWTH).saturating_add(GROWTH - 1);
        // What would be left for a last round of its own is taken along.
        let end = if end >= spp / 2 { spp } else { end };
        Self { number: self.number + 1, start: self.end, end }
    }

    /// An even round after this one, up to `end`. It is never the one after the first of an adaptive render, whose
    /// samples count for less.
    pub fn even(self, end: u32) -> Self {
        Self { number: (self.number + 1).max(2), start: self.end, end }
    }

    /// Samples per pixel in the mean.
    pub fn length(self) -> u32 {
        self.end - self.start
    }

    /// Number of the `target` samples that a cell gets in this round which it has when the picture has `next` in the
    /// mean.
    pub fn share(self, target: u32, next: u32) -> u32 {
        let part = u64::from(next.clamp(self.start, self.end) - self.start);
        (u64::from(target) * part / u64::from(self.length().max(1))) as u32
    }

    /// The weight of this round against those before it, where `done` of the `target` samples of a cell are there.
    pub fn weight(self, done: u32, target: u32) -> f64 {
        // A variance takes two.
        if done < 2 {
            return 0.0;
        }
        let worth = if self.number == 1 { FIRST_WORTH } else { 1.0 };
        let here = f64::from(self.length()) * f64::from(done) / f64::from(target.max(1));
        here / (here + worth * f64::from(self.start))
    }
}

/// Statistics of a cell's past samples.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Need {
    /// Pixels of the picture in it.
    pub pixels: u32,
    /// Mean relative variance of a sample.
    pub variance: f64,
    /// Rays of a sample.
    pub rays: f64,
}

/// No pixel gets more samples than this for `mean` over all pixels: the next power of two of the most is taken.
pub fn most(mean: u32) -> u32 {
    mean.saturating_mul(2 * MOST as u32)
}

/// Number of samples per pixel of each cell, for `mean` over all pixels. Cells are given by rows of `columns`.
pub fn allocate(needs: &[Need], columns: usize, mean: u32) -> Vec<u32> {
    let mut demand: Vec<f64> = (0..needs.len())
        .map(|i| {
            let own = needs[i].variance;
            let around = around(needs, columns, i, true);
            // A cell that found nothing as yet may have missed what its neighbours found.
            (0.5 * (own + around) / (1.0 + needs[i].rays)).sqrt().min(1e150)
        })
        .collect();
    // Every cell has some, so that all samples can be given away.
    let greatest = demand.iter().copied().fold(0.0, f64::max);
    demand.iter_mut().for_each(|d| *d = if greatest > 0.0 { (*d / greatest).max(1e-6) } else { 1.0 });
    let mean = f64::from(mean);
    let (fewest, most) = ((FEWEST * mean).max(2.0), (MOST * mean).max(2.0));
    let pixels: f64 = needs.iter().map(|n| f64::from(n.pixels)).sum();
    let total = |scale: f64| -> f64 {
        needs.iter().zip(&demand).map(|(n, d)| f64::from(n.pixels) * (scale * d).clamp(fewest, most)).sum()
    };
    // The scale at which they come to the mean: the total grows with it.
    let (mut low, mut high) = (0.0, 1.0);
    while total(high) < mean * pixels && high < 1e300 {
        high *= 2.0;
    }
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if total(middle) < mean * pixels { low = middle } else { high = middle }
    }
    // Powers of two, which samplers spread best, chosen so that the difference does not add up.
    let mut carry = 0.0;
    needs
        .iter()
        .zip(&demand)
        .map(|(n, d)| {
            let wanted = (high * d).clamp(fewest, most);
            let pixels = f64::from(n.pixels);
            let owed = wanted + if n.pixels > 0 { carry / pixels } else { 0.0 };
            let below = 2_f64.powi(wanted.log2().floor() as i32);
            let count = if owed < 1.5 * below { below } else { 2.0 * below }.max(2.0);
            carry += (wanted - count) * pixels;
            count as u32
        })
        .collect()
}

/// Factor by which a second round with these numbers of samples is expected to lower variance × cost, against even
/// numbers. It flatters, since the numbers follow from the same variances.
pub fn gain(needs: &[Need], counts: &[u32], first: Round, second: Round) -> f64 {
    let (mut variance, mut rest, mut cost, mut uneven) = (0.0, 0.0, 0.0, 0.0);
    for (need, count) in needs.iter().zip(counts) {
        let (pixels, n) = (f64::from(need.pixels), f64::from(*count));
        let v = pixels * need.variance.min(1e150);
        variance += v;
        rest += v / n;
        cost += pixels * (1.0 + need.rays);
        uneven += pixels * (1.0 + need.rays) * n;
    }
    let (start, end) = (f64::from(first.end), f64::from(second.end));
    let a = second.weight(2, 2);
    let joined = (1.0 - a) * (1.0 - a) * variance / start + a * a * rest;
    if joined > 0.0 { (variance / end) * (cost * end) / (joined * (cost * start + uneven)) } else { 1.0 }
}

/// The mean variance over the cells around one, and itself if it is `with`.
pub fn around(needs: &[Need], columns: usize, at: usize, with: bool) -> f64 {
    let rows = needs.len() / columns;
    let (x, y) = (at % columns, at / columns);
    let (mut sum, mut count) = (0.0, 0.0);
    for v in y.saturating_sub(1)..(y + 2).min(rows) {
        for u in x.saturating_sub(1)..(x + 2).min(columns) {
            let k = v * columns + u;
            if with || k != at {
                sum += needs[k].variance * f64::from(needs[k].pixels);
                count += f64::from(needs[k].pixels);
            }
        }
    }
    if count > 0.0 { sum / count } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounds_follow_each_other_to_the_end() {
        for spp in (1..300).chain([1000, 4096, 12345, 1 << 24]) {
            let mut round = Round::first(spp, true);
            assert!(round.end >= 1 && round.end <= 4 * FIRST, "{spp}: {round:?}");
            while round.end < spp {
                let next = round.next(spp);
                assert_eq!((next.number, next.start), (round.number + 1, round.end));
                assert!(next.end > next.start && next.end <= spp, "{spp}: {next:?}");
                round = next;
            }
            assert_eq!(round.end, spp);
        }
        assert_eq!(Round::first(64, false), Round { number: 0, start: 0, end: 64 });
    }

    #[test]
    fn shares_end_at_the_target() {
        let round = Round { number: 1, start: 4, end: 16 };
        let shares: Vec<u32> = (4..=16).map(|next| round.share(30, next)).collect();
        assert!(shares.windows(2).all(|w| w[0] <= w[1]));
        assert_eq!((shares[0], shares[12]), (0, 30));
        // The even spread takes what it is told.
        let even = Round::first(100, false);
        assert!((0..=100).all(|next| even.share(100, next) == next));
    }

    fn cell(variance: f64, rays: f64) -> Need {
        Need { pixels: 64, variance, rays }
    }

    #[test]
    fn numbers_follow_the_square_root_of_variance_over_cost() {
        // Bands of cells, of which those at the edges see other neighbours.
        let band = |v, c| vec![cell(v, c); 900];
        let cells = [band(1.0, 3.0), band(4.0, 3.0), band(4.0, 15.0)].concat();
        let n = allocate(&cells, 30, 300);
        let mean = |rows: std::ops::Range<usize>| {
            n[rows.start * 30..rows.end * 30].iter().map(|&n| f64::from(n)).sum::<f64>() / (30 * rows.len()) as f64
        };
        assert!((mean(0..90) - 300.0).abs() < 1.0, "{}", mean(0..90));
        let [a, b, c] = [mean(1..29), mean(31..59), mean(61..89)];
        assert!((b / a - 2.0).abs() < 0.04 && (c / a - 1.0).abs() < 0.02, "{a} {b} {c}");
        assert!(n.iter().all(|n| n.is_power_of_two()));
    }

    /// Two halves of which one errs 100 times more: even numbers `v/n` against `n ∝ √v`,
    /// `2 (1 + 100) / (1 + 10)² = 1.67` times better.
    #[test]
    fn the_gain_is_that_of_the_numbers() {
        let cells = [cell(1.0, 3.0), cell(100.0, 3.0)];
        let (first, second) = (Round { number: 0, start: 0, end: 1 }, Round { number: 1, start: 1, end: 110_001 });
        let gain = gain(&cells, &[20_000, 200_000], first, second);
        assert!((gain / (202.0 / 121.0) - 1.0).abs() < 1e-3, "{gain}");
        let even = [cell(4.0, 3.0); 2];
        let (first, second) = (Round { number: 0, start: 0, end: 4 }, Round { number: 1, start: 4, end: 16 });
        // Two rounds of which the first counts half: (1/16) / ((1/7)²/4 + (6/7)²/12).
        assert!((super::gain(&even, &[12; 2], first, second) - 0.9423).abs() < 1e-3);
    }

    #[test]
    fn nothing_is_left_out_and_nothing_takes_all() {
        let mut cells = vec![Need { pixels: 64, ..Need::default() }; 400];
        let mean = |n: &[u32]| n.iter().map(|&n| f64::from(n)).sum::<f64>() / n.len() as f64;
        let even = allocate(&cells, 20, 12);
        assert!(even.iter().all(|n| [8, 16].contains(n)) && (mean(&even) - 12.0).abs() < 0.1, "{even:?}");
        cells[210].variance = 1e12;
        let n = allocate(&cells, 20, 80);
        assert!(n.iter().all(|&n| n >= 8) && n[210] <= 4096 && n[210] >= 1024);
        cells[3].variance = f64::MAX;
        assert_eq!(allocate(&cells, 20, 80).len(), 400);
        // Cells without pixels cost nothing.
        cells[0].pixels = 0;
        let n = allocate(&cells, 20, 80);
        assert!((mean(&n[1..]) - 80.0).abs() < 10.0, "{}", mean(&n[1..]));
    }
}
