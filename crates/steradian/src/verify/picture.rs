//! A picture in parts, whose spread tells its error, and whether that can be trusted.

use super::Render;
use crate::{Control, Film, Pixel, Scene};
use std::sync::{Arc, atomic::Ordering};

/// Edge of the blocks of pixels that are compared.
const BLOCK: usize = 4;
/// Parts of the samples of a round, and groups of parts whose spread tells variances: means of many samples, whose
/// errors are nearly normal.
const PARTS: u32 = 32;
/// Fewer groups than this tell nothing.
const FEWEST: usize = 16;
/// Coarser blocks are at least so many.
const FEWEST_BLOCKS: usize = 9;
/// A value is made by few bright paths where one group holds this part of the squared deviations (of normal errors the
/// largest of 32 holds a fifth, and half once in 10⁸).
const DOMINATED: f64 = 0.5;
/// A picture is made by few bright paths where more than this part of its values is. (A lamp that a mirror shows makes
/// few.)
const RARE: f64 = 0.1;

/// A picture, and how parts of its samples differ from each other.
#[derive(Clone, Debug, Default)]
pub(super) struct Picture {
    /// All samples.
    pub film: Option<Film>,
    /// Blocks across and down; none where that is not known.
    blocks: [usize; 2],
    /// Means of blocks by channel, for each part.
    parts: Vec<Vec<f64>>,
    /// CPU seconds.
    pub seconds: f64,
    /// True if photons guided its paths: there are caustics that paths alone hardly find.
    pub is_guided: bool,
}

/// The mean of a value with its variance.
#[derive(Clone, Copy, Debug)]
pub(super) struct Value {
    pub mean: f64,
    pub variance: f64,
}

/// All values of a picture.
#[derive(Clone, Debug)]
pub(super) struct Values {
    /// Values of blocks, by channel.
    pub blocks: Vec<Value>,
    /// Flags of blocks whose variance can be trusted: not where few bright paths make it.
    pub is_known: Vec<bool>,
    /// The means of blocks of each group of parts.
    pub groups: Vec<Vec<f64>>,
    /// Degrees of freedom of the variances.
    pub freedom: usize,
    /// True if variances can be trusted as a whole.
    pub is_reliable: bool,
    /// Edge of the blocks in pixels.
    pub edge: usize,
}

impl Value {
    /// The mean of independent numbers.
    fn of(each: impl Iterator<Item = f64> + Clone) -> Self {
        let n = each.clone().count() as f64;
        let mean = each.clone().sum::<f64>() / n;
        Self { mean, variance: each.map(|v| (v - mean) * (v - mean)).sum::<f64>() / (n * (n - 1.0).max(1.0)) }
    }
}

impl Values {
    /// Values by the means of blocks, of an edge, of each group of parts.
    fn of(groups: Vec<Vec<f64>>, edge: usize) -> Self {
        let (mut blocks, mut is_known) = (Vec::new(), Vec::new());
        for k in 0..groups.first().map_or(0, Vec::len) {
            let value = Value::of(groups.iter().map(|g| g[k]));
            let squares = groups.iter().map(|g| (g[k] - value.mean) * (g[k] - value.mean));
            let (sum, largest) = squares.fold((0.0, 0.0_f64), |(sum, largest), d| (sum + d, largest.max(d)));
            is_known.push(largest <= DOMINATED * sum);
            blocks.push(value);
        }
        let unknown = is_known.iter().filter(|known| !**known).count();
        let is_reliable = groups.len() >= FEWEST && unknown as f64 <= RARE * blocks.len() as f64;
        Self { blocks, is_known, freedom: groups.len().saturating_sub(1), is_reliable, edge, groups }
    }

    /// The mean of blocks with weights whose sum is one.
    pub fn mean(&self, weights: &[f64]) -> Value {
        Value::of(self.groups.iter().map(|g| g.iter().zip(weights).map(|(v, w)| v * w).sum::<f64>()))
    }
}

impl Picture {
    /// Renders and adds what comes of it, which is independent of what is there.
    pub fn add(&mut self, scene: &Arc<Scene>, render: Render, control: &Control) {
        let step = render.plan.sampler.spp.div_ceil(PARTS);
        // Refusals are told when the method is made.
        let Ok(mut session) = render.session(scene) else { return };
        let (mut before, mut samples) = (Vec::new(), 0.0);
        while !session.is_done() && !control.cancel.load(Ordering::Relaxed) {
            session.step(step, control);
            let (so_far, taken) = (means(&session.film()), f64::from(session.samples()));
            if taken > samples {
                let part = |(k, m): (usize, &f64)| {
                    let old = before.get(k).copied().unwrap_or(0.0);
                    (taken * m - samples * old) / (taken - samples)
                };
                self.parts.push(so_far.iter().enumerate().map(part).collect());
                (before, samples) = (so_far, taken);
            }
        }
        self.seconds += session.cpu().as_secs_f64();
        self.is_guided |= session.asks_photons();
        let film = session.film();
        self.blocks = [film.crop.width(), film.crop.height()].map(|side| (side as usize).div_ceil(BLOCK));
        match &mut self.film {
            None => self.film = Some(film),
            Some(sum) => sum.pixels.iter_mut().zip(&film.pixels).for_each(|(a, b)| include(a, b)),
        }
    }

    /// Picture of parts alone.
    #[cfg(test)]
    pub fn of(parts: Vec<Vec<f64>>) -> Self {
        Self { parts, ..Self::default() }
    }

    /// Changes the parts, as a faulty integrator would: for tests.
    #[cfg(test)]
    pub fn map(&mut self, value: impl Fn(usize, f64) -> f64) {
        for part in &mut self.parts {
            part.iter_mut().enumerate().for_each(|(k, v)| *v = value(k, *v));
        }
    }

    /// Adds the parts of another picture: for tests.
    #[cfg(test)]
    pub fn append(&mut self, other: Self) {
        self.parts.extend(other.parts);
        self.seconds += other.seconds;
        self.film = self.film.take().or(other.film);
    }

    /// Adds another picture so many times, part by part: for tests.
    #[cfg(test)]
    pub fn include(&mut self, other: &Self, factor: f64) {
        for (a, b) in self.parts.iter_mut().zip(&other.parts) {
            a.iter_mut().zip(b).for_each(|(a, b)| *a += factor * b);
        }
    }

    /// The values with their variances.
    pub fn values(&self) -> Values {
        Values::of(self.groups(), BLOCK)
    }

    /// The values of blocks whose edges are so many times as long; `None` where these would be too few.
    pub fn coarser(&self, times: usize) -> Option<Values> {
        let [columns, rows] = self.blocks;
        let [across, down] = [columns.div_ceil(times), rows.div_ceil(times)];
        if across * down < FEWEST_BLOCKS {
            return None;
        }
        let merged = |group: Vec<f64>| -> Vec<f64> {
            let (mut sums, mut counts) = (vec![0.0; across * down * 3], vec![0.0; across * down * 3]);
            for (k, v) in group.into_iter().enumerate() {
                let (x, y) = (k / 3 % columns, k / 3 / columns);
                let to = (y / times * across + x / times) * 3 + k % 3;
                sums[to] += v;
                counts[to] += 1.0;
            }
            sums.into_iter().zip(counts).map(|(sum, count)| sum / count).collect()
        };
        Some(Values::of(self.groups().into_iter().map(merged).collect(), BLOCK * times))
    }

    /// The parts in groups of equal size, of which there are at most twice [`PARTS`].
    fn groups(&self) -> Vec<Vec<f64>> {
        let size = (self.parts.len() / PARTS as usize).max(1);
        let mean = |group: &[Vec<f64>]| {
            (0..group[0].len()).map(|k| group.iter().map(|p| p[k]).sum::<f64>() / size as f64).collect()
        };
        self.parts.chunks_exact(size).map(mean).collect()
    }
}

/// Adds the samples of a pixel.
fn include(sum: &mut Pixel, more: &Pixel) {
    for c in 0..3 {
        sum.sum[c] += more.sum[c];
        sum.sum_squares[c] += more.sum_squares[c];
    }
    sum.samples += more.samples;
}

/// The means of blocks by channel.
fn means(film: &Film) -> Vec<f64> {
    let (w, h) = (film.crop.width() as usize, film.crop.height() as usize);
    let mut all = Vec::new();
    for y in (0..h).step_by(BLOCK) {
        for x in (0..w).step_by(BLOCK) {
            let (mut sums, mut count) = ([0.0; 3], 0.0);
            for v in y..h.min(y + BLOCK) {
                for u in x..w.min(x + BLOCK) {
                    let m = film.pixels[v * w + u].mean();
                    (0..3).for_each(|c| sums[c] += m[c]);
                    count += 1.0;
                }
            }
            all.extend(sums.map(|s| s / count));
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(parts: impl Iterator<Item = f64>) -> Values {
        Picture { parts: parts.map(|p| vec![p, 2.0 * p]).collect(), ..Picture::default() }.values()
    }

    #[test]
    fn variances_are_those_of_means() {
        let noise = |k: u32| (f64::from(k) * 0.618_034).fract() - 0.5;
        let v = of((0..320).map(|k| 3.0 + noise(k)));
        assert!((v.blocks[0].mean - 3.0).abs() < 0.01 && v.freedom == 31 && v.is_reliable);
        assert!((v.blocks[1].variance - 4.0 * v.blocks[0].variance).abs() < 1e-12);
        // Both blocks err together.
        let mean = v.mean(&[0.5, 0.5]);
        assert!((mean.variance - 2.25 * v.blocks[0].variance).abs() < 1e-12, "{mean:?}");
    }

    /// Rare bright paths that each meet another block are known where blocks are merged; blocks at the edge, too.
    #[test]
    fn larger_blocks_meet_rare_paths_often_enough() {
        let part = |n: usize| (0..7 * 6 * 3).map(|k| if n % 32 == k / 3 % 32 { 50.0 } else { 1.0 }).collect();
        let parts: Vec<Vec<f64>> = (0..32).map(part).collect();
        let picture = Picture { parts, blocks: [7, 6], ..Picture::default() };
        assert!(!picture.values().is_reliable);
        let coarse = picture.coarser(2).expect("twelve blocks");
        assert!(coarse.is_reliable && coarse.blocks.len() == 4 * 3 * 3);
        assert!((coarse.blocks[0].mean - (1.0 + 49.0 / 32.0)).abs() < 1e-12, "{:?}", coarse.blocks[0]);
        assert!(picture.coarser(4).is_none());
    }

    /// One bright part tells nothing of how often such parts come.
    #[test]
    fn few_bright_paths_are_not_reliable() {
        let rare = |every: u32| of((0..64).map(move |k| if k % every == 3 { 50.0 } else { 1.0 }));
        assert!(!rare(64).is_reliable && rare(8).is_reliable);
        assert!(!of((0..8).map(f64::from)).is_reliable);
    }
}
