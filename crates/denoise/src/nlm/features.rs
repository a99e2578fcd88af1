//! How alike the surfaces of two pixels are.

use rayon::prelude::*;

use super::{
    local::{calm_variance, map},
    picture::Picture,
    plane::Plane,
    settings::Settings,
};
use crate::falloff::falloff;

/// How many columns and rows away variances are averaged.
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
    /// Of a picture.
    pub fn new(picture: &Picture<'_>, settings: &Settings) -> Self {
        let (size, margin) = (picture.size(), settings.margin());
        let plane = |values: &[f32]| Plane::new(size, margin, |place| values[place]);
        let held = |v: f32, scale: f32| if v.is_finite() { (v / scale).clamp(-1e9, 1e9) } else { 0.0 };
        let vectors = [(picture.albedo, settings.sigma_albedo), (picture.normal, settings.sigma_normal)];
        let vectors = vectors.into_iter().filter_map(|(image, scale)| {
            let image = image?;
            let channels = [0, 1, 2].map(|c| map(size, |x, y| held(image.values()[y * size[0] + x][c], scale)));
            let variances = channels.each_ref().map(|values| calm_variance(size, values));
            let variance = map(size, |x, y| variances.iter().map(|v| v[y * size[0] + x]).sum());
            Some((channels.each_ref().map(|values| plane(values)), plane(&variance)))
        });
        let depth = picture.depth.map(|image| {
            let values = map(size, |x, y| held(image.values()[y * size[0] + x], 1.0));
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
            let sigma: Vec<f32> = values.iter().map(|z| (settings.sigma_depth * z.abs()).max(1e-9)).collect();
            [plane(&values), plane(&sigma), plane(&slope(1, 0)), plane(&slope(0, 1))]
        });
        let surface = Plane::new(size, margin, |place| f32::from(picture.has_surface(place)));
        Self { vectors: vectors.collect(), depth, surface }
    }

    /// The squares of the means of roots over the 5×5 pixels around, those that show the same surface: at the foot of a
    /// highlight, the mean of variances would be that of its top.
    pub fn smooth(&self, [width, height]: [usize; 2], values: &[f32], margin: usize) -> Vec<f32> {
        let values = Plane::new([width, height], margin, |place| values[place].sqrt());
        let reach = SMOOTHED as i64;
        let mut means = vec![0.0; width * height];
        means.par_chunks_mut(width).enumerate().for_each(|(y, means)| {
            let (mut weights, mut distances, y) = (vec![0.0; width], vec![0.0; width], y as i64);
            for [dx, dy] in (-reach..=reach).flat_map(|dy| (-reach..=reach).map(move |dx| [dx, dy])) {
                self.distances([0, y], [dx, dy], &mut distances);
                let values = values.row(y + dy, dx, width);
                for k in 0..width {
                    let weight = falloff(distances[k]);
                    weights[k] += weight;
                    means[k] += weight * values[k];
                }
            }
            means.iter_mut().zip(&weights).for_each(|(mean, weight)| *mean = (*mean / weight).powi(2));
        });
        means
    }

    /// The squares of differences beyond what noise explains, for pixels from a column and row, and those some columns
    /// and rows away.
    #[inline(always)]
    pub fn distances(&self, [x, y]: [i64; 2], [dx, dy]: [i64; 2], out: &mut [f32]) {
        let count = out.len();
        let (p, q) = (self.surface.row(y, x, count), self.surface.row(y + dy, x + dx, count));
        for k in 0..count {
            out[k] = if p[k] == q[k] { 0.0 } else { 1e3 };
        }
        for (channels, variance) in &self.vectors {
            let p = channels.each_ref().map(|plane| plane.row(y, x, count));
            let q = channels.each_ref().map(|plane| plane.row(y + dy, x + dx, count));
            let (vp, vq) = (variance.row(y, x, count), variance.row(y + dy, x + dx, count));
            for k in 0..count {
                let d = [p[0][k] - q[0][k], p[1][k] - q[1][k], p[2][k] - q[2][k]];
                let squares = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
                let beyond = (squares - vp[k] - vp[k].min(vq[k])).max(0.0);
                out[k] += beyond / (1.0 + vp[k]);
            }
        }
        if let Some([depth, sigma, across, down]) = &self.depth {
            let (p, q) = (depth.row(y, x, count), depth.row(y + dy, x + dx, count));
            let (sigma, across, down) = (sigma.row(y, x, count), across.row(y, x, count), down.row(y, x, count));
            let (columns, rows) = (dx.abs() as f32, dy.abs() as f32);
            for k in 0..count {
                let beyond = ((p[k] - q[k]).abs() - across[k] * columns - down[k] * rows).max(0.0) / sigma[k];
                out[k] += beyond * beyond;
            }
        }
    }
}
