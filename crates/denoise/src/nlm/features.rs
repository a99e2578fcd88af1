//! Likeness of the surfaces of two pixels.

use rayon::prelude::*;
use steradian_accel::{Kernel, Lanes};

use super::{
    local::{calm_variance, map},
    picture::Picture,
    plane::{BLOCK, Block, Plane},
    settings::Settings,
};
use crate::falloff::falloff;

/// The features of surfaces, scaled to what they may differ by.
#[derive(Debug)]
pub(super) struct Features {
    /// Albedo and normal where they are known, each with the variance on the pixel's side of edges.
    pub vectors: [Option<([Plane; 3], Plane)>; 2],
    /// Depth, what it may differ by, and what by for each column and row.
    pub depth: Option<[Plane; 4]>,
    /// 1 where there is a surface, else 0, as beyond the edge.
    pub surface: Plane,
}

impl Features {
    /// Features of a picture.
    pub fn new(picture: &Picture<'_>, settings: &Settings) -> Self {
        let size = picture.size();
        let plane = |values: &[f32]| Plane::new(size, |place| values[place]);
        let held = |v: f32, scale: f32| if v.is_finite() { (v / scale).clamp(-1e9, 1e9) } else { 0.0 };
        let vectors = [(picture.albedo, settings.sigma_albedo), (picture.normal, settings.sigma_normal)];
        let vectors = vectors.map(|(image, scale)| {
            let image = image?;
            // Scale features by what they may differ by, so that one is the unit of all.
            let channels = [0, 1, 2].map(|c| map(size, |x, y| held(image.values()[y * size[0] + x][c], scale)));
            // Their noise: the variance on the calm side of an edge, summed over the channels.
            let variances = channels.each_ref().map(|values| calm_variance(size, values));
            let variance = map(size, |x, y| variances.iter().map(|v| v[y * size[0] + x]).sum());
            Some((channels.each_ref().map(|values| plane(values)), plane(&variance)))
        });
        let depth = picture.depth.map(|image| {
            let values = map(size, |x, y| held(image.values()[y * size[0] + x], 1.0));
            // Slope of depth: the lesser of both differences, which does not cross an edge.
            let slope = |dx: usize, dy: usize| {
                map(size, |x, y| {
                    let at = |x: usize, y: usize| values[y.min(size[1] - 1) * size[0] + x.min(size[0] - 1)];
                    let ahead = (at(x + dx, y + dy) - at(x, y)).abs();
                    let behind = (at(x, y) - at(x.saturating_sub(dx), y.saturating_sub(dy))).abs();
                    // At the edge of the picture one of them is none.
                    let is_edge = x < dx || y < dy || x + dx >= size[0] || y + dy >= size[1];
                    if is_edge { ahead.max(behind) } else { ahead.min(behind) }
                })
            };
            // Tolerance of depth in proportion to the distance.
            let sigma: Vec<f32> = values.iter().map(|z| (settings.sigma_depth * z.abs()).max(1e-9)).collect();
            [plane(&values), plane(&sigma), plane(&slope(1, 0)), plane(&slope(0, 1))]
        });
        let surface = Plane::new(size, |place| f32::from(picture.has_surface(place))).with_edge(0.0);
        Self { vectors, depth, surface }
    }

    /// Sums over the pixels up to `reach` away, weighted by how near they are and how alike their surfaces are: of `N`
    /// planes, of `S` planes with the squares of the weights, and of the weights. `own` is the weight of the pixel
    /// itself.
    pub fn sums<const N: usize, const S: usize>(
        &self,
        (reach, own): (i64, f32),
        (values, squared): ([&Plane; N], [&Plane; S]),
        lanes: Lanes,
    ) -> Vec<Sums<N, S>> {
        let [width, height] = self.surface.size();
        let mut sums = vec![Sums { values: [0.0; N], squared: [0.0; S], weight: 0.0 }; width * height];
        sums.par_chunks_mut(width).enumerate().for_each(|(y, sums)| {
            for (k, sums) in sums.chunks_mut(BLOCK).enumerate() {
                let around = Around { features: self, at: [(k * BLOCK) as i64, y as i64], reach, own, values, squared };
                let mut blocks =
                    Blocks { values: [[0.0; BLOCK]; N], squared: [[0.0; BLOCK]; S], weights: [0.0; BLOCK] };
                lanes.run(Summing(&around, &mut blocks));
                for (k, sums) in sums.iter_mut().enumerate() {
                    let (values, squared) = (blocks.values.map(|v| v[k]), blocks.squared.map(|v| v[k]));
                    *sums = Sums { values, squared, weight: blocks.weights[k] };
                }
            }
        });
        sums
    }

    /// Adds the distances of the surfaces of a row of pixels from that of a pixel, `rows` away, whose column is
    /// `reach` after their first. Differences of vectors are written into `apart`.
    #[inline(always)]
    pub fn add_distances<const N: usize>(
        &self,
        (place, reach): (usize, usize),
        (at, rows): ([i64; 2], f32),
        distances: &mut [f32; N],
        apart: &mut [[[f32; N]; 3]; 2],
    ) {
        for (vector, apart) in self.vectors.iter().zip(apart) {
            let Some((channels, variance)) = vector else { continue };
            let mut squares = [0.0; N];
            for (channel, apart) in channels.iter().zip(apart) {
                let (middle, others) = (channel.at(place), channel.row::<N>(at));
                for k in 0..N {
                    apart[k] = others[k] - middle;
                    squares[k] += apart[k] * apart[k];
                }
            }
            let (own, others) = (variance.at(place), variance.row::<N>(at));
            let over = 1.0 / (1.0 + own);
            for k in 0..N {
                distances[k] += (squares[k] - own - own.min(others[k])).max(0.0) * over;
            }
        }
        if let Some([depth, sigma, across, down]) = &self.depth {
            let (middle, others) = (depth.at(place), depth.row::<N>(at));
            let (over, across, down) = (1.0 / sigma.at(place), across.at(place), rows * down.at(place));
            for k in 0..N {
                let columns = (k as f32 - reach as f32).abs();
                let beyond = ((others[k] - middle).abs() - across * columns - down).max(0.0) * over;
                distances[k] += beyond * beyond;
            }
        }
    }

    /// Likeness of the surfaces of a block's pixels to those some columns and rows away, beyond differences explained
    /// by noise.
    #[inline(always)]
    pub fn likeness<'a>(&'a self, [x, y]: [i64; 2], [dx, dy]: [i64; 2]) -> Block {
        let both = |plane: &'a Plane| [plane.block([x, y]), plane.block([x + dx, y + dy])];
        // Distance 0 within surfaces; between a surface and none a distance that leaves no weight.
        let mut distances = [0.0; BLOCK];
        let [p, q] = both(&self.surface);
        for k in 0..BLOCK {
            distances[k] = if p[k] == q[k] { 0.0 } else { 1e3 };
        }
        for (channels, variance) in self.vectors.iter().flatten() {
            let [[px, qx], [py, qy], [pz, qz]] = [both(&channels[0]), both(&channels[1]), both(&channels[2])];
            let [vp, vq] = both(variance);
            for k in 0..BLOCK {
                // Squared distance beyond what noise explains: d² − (Var_p + min(Var_p, Var_q)) (Rousselle et al.
                // 2013).
                let d = [px[k] - qx[k], py[k] - qy[k], pz[k] - qz[k]];
                let squares = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
                let beyond = (squares - vp[k] - vp[k].min(vq[k])).max(0.0);
                distances[k] += beyond / (1.0 + vp[k]);
            }
        }
        if let Some([depth, sigma, across, down]) = &self.depth {
            let [p, q] = both(depth);
            let [sigma, across, down] = [sigma, across, down].map(|plane| plane.block([x, y]));
            // Depth may differ by its slope times the offset; what is beyond counts in units of the tolerance.
            let (columns, rows) = (dx.abs() as f32, dy.abs() as f32);
            for k in 0..BLOCK {
                let beyond = ((p[k] - q[k]).abs() - across[k] * columns - down[k] * rows).max(0.0) / sigma[k];
                distances[k] += beyond * beyond;
            }
        }
        // Likeness e^−d².
        for distance in &mut distances {
            *distance = falloff(*distance);
        }
        distances
    }
}

/// Sums about a pixel.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sums<const N: usize, const S: usize> {
    pub values: [f32; N],
    /// With the squares of weights.
    pub squared: [f32; S],
    pub weight: f32,
}

/// Sums of a block's pixels.
struct Blocks<const N: usize, const S: usize> {
    values: [Block; N],
    squared: [Block; S],
    weights: Block,
}

/// A block that sums are taken about.
struct Around<'a, const N: usize, const S: usize> {
    features: &'a Features,
    at: [i64; 2],
    reach: i64,
    own: f32,
    values: [&'a Plane; N],
    squared: [&'a Plane; S],
}

/// A block of [`Features::sums`].
struct Summing<'a, const N: usize, const S: usize>(&'a Around<'a, N, S>, &'a mut Blocks<N, S>);

impl<const N: usize, const S: usize> Kernel for Summing<'_, N, S> {
    #[inline(always)]
    fn run(self) {
        let Self(around, sums) = self;
        let [x, y] = around.at;
        for dy in -around.reach..=around.reach {
            for dx in -around.reach..=around.reach {
                let mut weights = around.features.likeness([x, y], [dx, dy]);
                let far = (dx * dx + dy * dy) as f32 / ((around.reach + 1) * (around.reach + 1)) as f32;
                let near = if [dx, dy] == [0, 0] { around.own } else { (1.0 - far).max(0.0) };
                weights.iter_mut().for_each(|weight| *weight *= near);
                sums.weights.iter_mut().zip(&weights).for_each(|(sum, weight)| *sum += weight);
                for (sums, plane) in sums.values.iter_mut().zip(around.values) {
                    let values = plane.block([x + dx, y + dy]);
                    for k in 0..BLOCK {
                        sums[k] += weights[k] * values[k];
                    }
                }
                for (sums, plane) in sums.squared.iter_mut().zip(around.squared) {
                    let values = plane.block([x + dx, y + dy]);
                    for k in 0..BLOCK {
                        sums[k] += weights[k] * weights[k] * values[k];
                    }
                }
            }
        }
    }
}
