//! A pass over a picture, tile by tile.
//!
//! For each offset, the pixels of a tile are compared with those that far away, a row of [`BLOCK`] columns at a time;
//! of these, a tile has as many as patches leave at both ends.

use rayon::prelude::*;
use steradian_accel::{Lanes, kernel};
use steradian_math::Vec3;

use super::{
    features::Features,
    plane::{BLOCK, Block, Plane},
    settings::Settings,
};
use crate::falloff::falloff;

/// Rows of a tile.
const ROWS: usize = 32;
/// Largest reach of patches, on both sides together.
const PATCHES: usize = 16;
/// Weights below this are none: what is far brighter would be seen through them.
const CUT: f32 = 0.02;
/// By how many times a pixel's own variance that of another counts at most. Without a bound, nothing is farther from a
/// bright pixel of few paths than 1/k², and it would shine into what is dark around.
const TRUST: f32 = 4.0;
/// Keeps quotients finite.
const TINY: f32 = 1e-20;

/// Three channels with their variances, and whether pixels count for others.
#[derive(Clone, Debug)]
pub(super) struct Estimate {
    value: [Plane; 3],
    variance: [Plane; 3],
    weight: Plane,
    size: [usize; 2],
    margin: usize,
}

impl Estimate {
    /// Estimate with these values, variances and weights.
    pub fn new(size: [usize; 2], settings: &Settings, channels: [(Vec<f32>, Vec<f32>); 3], weights: Vec<f32>) -> Self {
        let margin = settings.margin();
        let plane = |values: &Vec<f32>| Plane::new(size, margin, |place| values[place]);
        Self {
            value: channels.each_ref().map(|c| plane(&c.0)),
            variance: channels.each_ref().map(|c| plane(&c.1)),
            weight: plane(&weights).with_edge(0.0),
            size,
            margin,
        }
    }

    /// Width and height in pixels.
    pub fn size(&self) -> [usize; 2] {
        self.size
    }

    /// The value of a pixel's channel, and its variance.
    pub fn channel(&self, channel: usize, place: usize) -> (f32, f32) {
        (self.value[channel].at(place), self.variance[channel].at(place))
    }

    /// Weight of a pixel for others.
    pub fn count(&self, place: usize) -> f32 {
        self.weight.at(place)
    }

    /// The value of a pixel.
    pub fn at(&self, place: usize) -> Vec3 {
        Vec3::from_array(self.value.each_ref().map(|plane| plane.at(place)))
    }

    /// With at least a part of the variance of another.
    pub fn with_noise_of(self, noisy: &Self, part: f32) -> Self {
        // The second pass trusts the first not wholly: a part of the noise is taken to be left.
        let more = |mine: &Plane, other: &Plane| {
            Plane::new(self.size, self.margin, |place| mine.at(place) + part * other.at(place))
        };
        let variance = std::array::from_fn(|c| more(&self.variance[c], &noisy.variance[c]));
        Self { variance, ..self }
    }
}

/// A pass: weights from a guide and features, means of a source.
pub(super) struct Pass<'a> {
    pub guide: &'a Estimate,
    pub source: &'a Estimate,
    pub features: &'a Features,
    /// Radius of patches; at most that of the settings.
    pub patch: u32,
    pub settings: &'a Settings,
}

/// Sums of weighted values and variances of three channels each, and of weights.
type Sums = [Block; 7];

/// A part of the picture while it is filtered.
struct Tile {
    /// Its first column and row.
    at: [i64; 2],
    /// Sums of each of its rows.
    sums: Vec<Sums>,
    /// Likeness of surfaces of pairs, of its rows and those that patches reach, from the first column that they reach.
    alike: Vec<Block>,
    /// Its sums along rows, and those of distances that it weighs, from the first column.
    along: Vec<[Block; 2]>,
}

impl Pass<'_> {
    /// Filters all.
    pub fn run(&self, lanes: Lanes) -> Estimate {
        let [width, height] = self.source.size;
        // A block loses the reach of a patch at both ends, so tiles are so much narrower.
        let columns = BLOCK - 2 * self.patch as usize;
        let across = width.div_ceil(columns);
        let places: Vec<[usize; 2]> =
            (0..height.div_ceil(ROWS) * across).map(|tile| [tile % across * columns, tile / across * ROWS]).collect();
        // Tiles in parallel; each sums over all offsets for itself.
        let tiles: Vec<Vec<Sums>> = places.par_iter().map(|&place| self.tile(lanes, place)).collect();
        let plane = |c: usize| {
            Plane::new([width, height], self.source.margin, |place| {
                let [x, y] = [place % width, place / width];
                tiles[y / ROWS * across + x / columns][y % ROWS][c][x % columns]
            })
        };
        Estimate {
            value: [plane(0), plane(1), plane(2)],
            variance: [plane(3), plane(4), plane(5)],
            weight: self.source.weight.clone(),
            ..*self.source
        }
    }

    /// Filters the pixels from a column and row.
    fn tile(&self, lanes: Lanes, at: [usize; 2]) -> Vec<Sums> {
        let (radius, patch) = (self.settings.radius as i64, self.patch as usize);
        let rows = ROWS.min(self.source.size[1] - at[1]);
        let mut tile = Tile {
            at: at.map(|n| n as i64),
            sums: vec![[[0.0; BLOCK]; 7]; rows],
            alike: vec![[0.0; BLOCK]; rows + 2 * patch],
            along: vec![[[0.0; BLOCK]; 2]; rows + 2 * patch],
        };
        // Offset by offset: the distances of all pairs of one offset share their patch sums.
        for dy in -radius..=radius {
            for dx in -radius..=radius {
                offset(lanes, self, [dx, dy], &mut tile);
            }
        }
        for [r, g, b, vr, vg, vb, weights] in &mut tile.sums {
            // Normalise: Σ w c/Σ w, and Σ w² Var/(Σ w)² for the variance of the mean.
            for (k, &weight) in weights.iter().enumerate() {
                let over = if weight > 0.0 { 1.0 / weight } else { 0.0 };
                [&mut *r, &mut *g, &mut *b].into_iter().for_each(|sum| sum[k] *= over);
                [&mut *vr, &mut *vg, &mut *vb].into_iter().for_each(|sum| sum[k] *= over * over);
            }
        }
        tile.sums
    }

    /// Distances of pairs, times the likeness of their surfaces.
    #[inline(always)]
    fn distances(&self, [x, y]: [i64; 2], [dx, dy]: [i64; 2], alike: &Block) -> Block {
        // Per-pixel distance of non-local means: (d² − (Var_p + min(Var_p, Var_q)))/(k² (Var_p + Var_q)).
        let square = self.settings.damping * self.settings.damping;
        let mut distances = [0.0; BLOCK];
        for (value, variance) in self.guide.value.iter().zip(&self.guide.variance) {
            let (p, q) = (value.block([x, y]), value.block([x + dx, y + dy]));
            let (vp, vq) = (variance.block([x, y]), variance.block([x + dx, y + dy]));
            for k in 0..BLOCK {
                let d = p[k] - q[k];
                let beyond = d * d - (vp[k] + vp[k].min(vq[k]));
                distances[k] += beyond / (TINY + square * (vp[k] + vq[k].min(TRUST * vp[k])));
            }
        }
        // Mean over channels, weighted by the likeness of the pair's surfaces.
        for k in 0..BLOCK {
            distances[k] *= alike[k] * (1.0 / 3.0);
        }
        distances
    }
}

kernel! {
    /// Adds to each pixel of a tile the one some columns and rows away.
    fn offset(pass: &'a Pass<'a>, by: [i64; 2], tile: &'a mut Tile) {
        let height = pass.source.size[1] as i64;
        let (patch, [x, top], [dx, dy]) = (pass.patch as usize, tile.at, by);
        let rows = tile.sums.len();
        // Skip offsets that lead out of the picture with all rows.
        if top + rows as i64 + dy <= 0 || top + dy >= height {
            return;
        }
        // Distances of pairs, with sums along rows of a patch's width.
        for row in 0..rows + 2 * patch {
            let at = [x - patch as i64, top + row as i64 - patch as i64];
            let alike = pass.features.likeness(at, by);
            let distances = pass.distances(at, by, &alike);
            tile.along[row] = [add_along(&alike, 2 * patch + 1), add_along(&distances, 2 * patch + 1)];
            tile.alike[row] = alike;
        }
        for row in 0..rows {
            let y = top + row as i64;
            if y + dy < 0 || y + dy >= height {
                continue;
            }
            // Sum the rows of a patch: the patch distance is the weighted mean over its pairs.
            let (mut weights, mut distances) = ([0.0; BLOCK], [0.0; BLOCK]);
            for [w, d] in &tile.along[row..=row + 2 * patch] {
                for k in 0..BLOCK {
                    weights[k] += w[k];
                    distances[k] += d[k];
                }
            }
            let alike = shifted(&tile.alike[row + patch], patch);
            let counts = pass.source.weight.block([x + dx, y + dy]);
            // Weight e^−max(0, D) times the likeness of the middles, cut where it is small.
            for k in 0..BLOCK {
                let distance = (distances[k] / (weights[k] + TINY)).max(0.0);
                weights[k] = (falloff(distance) * alike[k] - CUT).max(0.0) * counts[k];
            }
            // Accumulate values by w, variances by w².
            let sums = &mut tile.sums[row];
            for c in 0..3 {
                let value = pass.source.value[c].block([x + dx, y + dy]);
                let variance = pass.source.variance[c].block([x + dx, y + dy]);
                for k in 0..BLOCK {
                    sums[c][k] += weights[k] * value[k];
                    sums[3 + c][k] += weights[k] * weights[k] * variance[k];
                }
            }
            for k in 0..BLOCK {
                sums[6][k] += weights[k];
            }
        }
    }
}

/// The values some columns on, then zeros.
#[inline(always)]
fn shifted(values: &Block, by: usize) -> Block {
    let mut shifted = [0.0; BLOCK];
    shifted[..BLOCK - by].copy_from_slice(&values[by..]);
    shifted
}

/// Sums of so many values that follow one another; beyond the last are zeros.
#[inline(always)]
fn add_along(values: &Block, count: usize) -> Block {
    let mut wide = [0.0; BLOCK + PATCHES];
    wide[..BLOCK].copy_from_slice(values);
    let mut sums = *values;
    // Sum of a sliding window by shifted copies, for whole blocks at once.
    for from in 1..count {
        let values: &Block = wide[from..].first_chunk().expect("patches are as wide at most");
        for k in 0..BLOCK {
            sums[k] += values[k];
        }
    }
    sums
}
