//! A pass over a picture.

use rayon::prelude::*;
use steradian_accel::{Lanes, kernel};
use steradian_math::Vec3;

use super::{features::Features, plane::Plane, settings::Settings};
use crate::falloff::falloff;

/// Rows that are filtered together; the same for any number of threads.
const BAND: usize = 16;
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
    /// Of values and variances.
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

    /// The value of a pixel.
    pub fn at(&self, x: usize, y: usize) -> Vec3 {
        Vec3::from_array(self.value.each_ref().map(|plane| plane.row(y as i64, x as i64, 1)[0]))
    }

    /// With at least a part of the variance of another.
    pub fn with_noise_of(self, noisy: &Self, part: f32) -> Self {
        let width = self.size[0];
        let more = |mine: &Plane, other: &Plane| {
            let at = |plane: &Plane, place: usize| plane.row((place / width) as i64, (place % width) as i64, 1)[0];
            Plane::new(self.size, self.margin, |place| at(mine, place) + part * at(other, place))
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
    /// How far patches reach; at most as far as the settings say.
    pub patch: u32,
    pub settings: &'a Settings,
}

/// Rows of a band while it is filtered.
struct Band {
    /// Its first row.
    top: usize,
    /// Sums of weighted values and variances of three channels each, and of weights, row by row.
    sums: Vec<[Vec<f32>; 7]>,
    /// Likeness of surfaces of pairs, of its rows and those that patches reach.
    alike: Vec<Vec<f32>>,
    /// Its sums along rows, and those of distances that it weighs.
    along: Vec<[Vec<f32>; 2]>,
    /// Distances of pairs of a row.
    distances: Vec<f32>,
    /// Columns of a row's sums.
    patch: [Vec<f32>; 2],
}

impl Pass<'_> {
    /// Filters all.
    pub fn run(&self, lanes: Lanes) -> Estimate {
        let [width, height] = self.source.size;
        let tops: Vec<usize> = (0..height).step_by(BAND).collect();
        let bands: Vec<Vec<[Vec<f32>; 7]>> = tops.par_iter().map(|&top| self.band(lanes, top)).collect();
        let rows: Vec<&[Vec<f32>; 7]> = bands.iter().flatten().collect();
        let plane =
            |c: usize| Plane::new([width, height], self.source.margin, |place| rows[place / width][c][place % width]);
        Estimate {
            value: [plane(0), plane(1), plane(2)],
            variance: [plane(3), plane(4), plane(5)],
            weight: self.source.weight.clone(),
            ..*self.source
        }
    }

    /// Filters the rows of a band.
    fn band(&self, lanes: Lanes, top: usize) -> Vec<[Vec<f32>; 7]> {
        let [width, height] = self.source.size;
        let (radius, patch) = (self.settings.radius as i64, self.patch as usize);
        let rows = BAND.min(height - top);
        let wide = width + 2 * patch;
        let mut band = Band {
            top,
            sums: vec![[(); 7].map(|()| vec![0.0; width]); rows],
            alike: vec![vec![0.0; wide]; rows + 2 * patch],
            along: vec![[(); 2].map(|()| vec![0.0; width]); rows + 2 * patch],
            distances: vec![0.0; wide],
            patch: [(); 2].map(|()| vec![0.0; width]),
        };
        for dy in -radius..=radius {
            for dx in -radius..=radius {
                offset(lanes, self, [dx, dy], &mut band);
            }
        }
        for row in &mut band.sums {
            let [r, g, b, vr, vg, vb, weights] = row;
            for (k, &weight) in weights.iter().enumerate() {
                let over = if weight > 0.0 { 1.0 / weight } else { 0.0 };
                [&mut *r, &mut *g, &mut *b].into_iter().for_each(|sum| sum[k] *= over);
                [&mut *vr, &mut *vg, &mut *vb].into_iter().for_each(|sum| sum[k] *= over * over);
            }
        }
        band.sums
    }

    /// Compares the pairs of a row, beyond the picture's edge as far as patches reach.
    #[inline(always)]
    fn compare(&self, y: i64, [dx, dy]: [i64; 2], alike: &mut [f32], distances: &mut [f32]) {
        let count = alike.len();
        let x = -(self.patch as i64);
        self.features.distances([x, y], [dx, dy], distances);
        for k in 0..count {
            alike[k] = falloff(distances[k]);
        }
        let value = |c: usize, x, y| self.guide.value[c].row(y, x, count);
        let variance = |c: usize, x, y| self.guide.variance[c].row(y, x, count);
        let square = self.settings.damping * self.settings.damping;
        distances.fill(0.0);
        for c in 0..3 {
            let (p, q) = (value(c, x, y), value(c, x + dx, y + dy));
            let (vp, vq) = (variance(c, x, y), variance(c, x + dx, y + dy));
            for k in 0..count {
                let d = p[k] - q[k];
                let beyond = d * d - (vp[k] + vp[k].min(vq[k]));
                distances[k] += beyond / (TINY + square * (vp[k] + vq[k].min(TRUST * vp[k])));
            }
        }
        for k in 0..count {
            distances[k] *= alike[k] * (1.0 / 3.0);
        }
    }
}

kernel! {
    /// Adds to each pixel of a band the one some columns and rows away.
    fn offset(pass: &'a Pass<'a>, by: [i64; 2], band: &'a mut Band) {
        let [width, height] = pass.source.size;
        let (patch, [dx, dy]) = (pass.patch as usize, by);
        let rows = band.sums.len();
        let bottom = band.top as i64 + rows as i64;
        if bottom + dy <= 0 || band.top as i64 + dy >= height as i64 {
            return;
        }
        for row in 0..rows + 2 * patch {
            let y = (band.top + row) as i64 - patch as i64;
            pass.compare(y, by, &mut band.alike[row], &mut band.distances);
            let [weights, distances] = &mut band.along[row];
            add_along(&band.alike[row], weights, 2 * patch + 1);
            add_along(&band.distances, distances, 2 * patch + 1);
        }
        let [weights, distances] = &mut band.patch;
        for row in 0..rows {
            let y = (band.top + row) as i64;
            if y + dy < 0 || y + dy >= height as i64 {
                continue;
            }
            weights.fill(0.0);
            distances.fill(0.0);
            for [w, d] in &band.along[row..=row + 2 * patch] {
                for k in 0..width {
                    weights[k] += w[k];
                    distances[k] += d[k];
                }
            }
            let alike = &band.alike[row + patch][patch..patch + width];
            let counts = pass.source.weight.row(y + dy, dx, width);
            for k in 0..width {
                let distance = (distances[k] / (weights[k] + TINY)).max(0.0);
                weights[k] = (falloff(distance) * alike[k] - CUT).max(0.0) * counts[k];
            }
            let [sums @ .., total] = &mut band.sums[row];
            for c in 0..3 {
                let (value, variance) =
                    (pass.source.value[c].row(y + dy, dx, width), pass.source.variance[c].row(y + dy, dx, width));
                let [values, variances] = sums.get_disjoint_mut([c, 3 + c]).expect("six sums");
                for k in 0..width {
                    values[k] += weights[k] * value[k];
                    variances[k] += weights[k] * weights[k] * variance[k];
                }
            }
            for k in 0..width {
                total[k] += weights[k];
            }
        }
    }
}

/// Sums of so many values that follow one another.
#[inline(always)]
fn add_along(values: &[f32], sums: &mut [f32], count: usize) {
    let width = sums.len();
    sums.copy_from_slice(&values[..width]);
    for from in 1..count {
        let values = &values[from..from + width];
        for k in 0..width {
            sums[k] += values[k];
        }
    }
}
