//! Likeness of the surfaces of two pixels.

use rayon::prelude::*;
use steradian_accel::{Lanes, kernel};

use super::{
    local::{calm_variance, map},
    picture::Picture,
    plane::{BLOCK, Block, Plane},
    settings::Settings,
};
use crate::falloff::falloff;

/// Radius in columns and rows over which variances are averaged.
pub(super) const SMOOTHED: usize = 2;

/// The features of surfaces, scaled to what they may differ by.
#[derive(Debug)]
pub(super) struct Features {
    /// Albedo and normal, each with the variance that its neighbourhood has on the pixel's side of edges.
    pub vectors: Vec<([Plane; 3], Plane)>,
    /// Depth, what it may differ by, and what by for each column and row.
    pub depth: Option<[Plane; 4]>,
    /// 1 where there is a surface, else 0.
    pub surface: Plane,
}

impl Features {
    /// Features of a picture.
    pub fn new(picture: &Picture<'_>, settings: &Settings) -> Self {
        let (size, margin) = (picture.size(), settings.margin());
        let plane = |values: &[f32]| Plane::new(size, margin, |place| values[place]);
        let held = |v: f32, scale: f32| if v.is_finite() { (v / scale).clamp(-1e9, 1e9) } else { 0.0 };
        let vectors = [(picture.albedo, settings.sigma_albedo), (picture.normal, settings.sigma_normal)];
        let vectors = vectors.into_iter().filter_map(|(image, scale)| {
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
        let surface = Plane::new(size, margin, |place| f32::from(picture.has_surface(place)));
        Self { vectors: vectors.collect(), depth, surface }
    }

    /// The squares of the means of roots over the 5×5 pixels around, those that show the same surface: at the foot of a
    /// highlight, the mean of variances would be that of its top.
    pub fn smooth(&self, [width, height]: [usize; 2], values: &[f32], margin: usize, lanes: Lanes) -> Vec<f32> {
        // Roots first: the mean of standard deviations is robust against single bright pixels.
        let values = Plane::new([width, height], margin, |place| values[place].sqrt());
        let mut means = vec![0.0; width * height];
        means.par_chunks_mut(width).enumerate().for_each(|(y, means)| {
            for (k, means) in means.chunks_mut(BLOCK).enumerate() {
                let mut block = [0.0; BLOCK];
                smoothed(lanes, self, &values, [(k * BLOCK) as i64, y as i64], &mut block);
                means.copy_from_slice(&block[..means.len()]);
            }
        });
        means
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
        for (channels, variance) in &self.vectors {
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

kernel! {
    /// A block of [`Features::smooth`].
    fn smoothed(features: &'a Features, roots: &'a Plane, at: [i64; 2], out: &'a mut Block) {
        let reach = SMOOTHED as i64;
        // Mean of standard deviations over the window, weighted by the likeness of surfaces.
        let (mut weights, mut means) = ([0.0; BLOCK], [0.0; BLOCK]);
        for dy in -reach..=reach {
            for dx in -reach..=reach {
                let alike = features.likeness(at, [dx, dy]);
                let roots = roots.block([at[0] + dx, at[1] + dy]);
                for k in 0..BLOCK {
                    weights[k] += alike[k];
                    means[k] += alike[k] * roots[k];
                }
            }
        }
        for k in 0..BLOCK {
            // The square of the mean root is the smoothed variance.
            let mean = means[k] / weights[k];
            out[k] = mean * mean;
        }
    }
}
