//! Irradiance and its gradients by stratified rays over a hemisphere (Ward, Heckbert 1992, "Irradiance gradients", eqs.
//! 1 to 4). Rows divide sin²θ and columns φ evenly, so that directions are distributed by the cosine and each cell has
//! the weight π/(rows · columns).
//!
//! The gradient by translation is that of light whose borders between cells move as the nearer of the two things that
//! are seen there does; weights of borders between columns are `sinθ₊ − sinθ₋` (Křivánek and others 2005, "Improved
//! radiance gradient computation"), the integral of the cosine along them.

use std::f32::consts::{PI, TAU};
use steradian_math::{Frame, Spectrum, Vec2, Vec3};

/// Irradiance about a point, to first order.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Irradiance {
    /// At the point.
    pub value: Spectrum,
    /// Derivative by the normal, for each axis.
    pub by_normal: [Spectrum; 3],
    /// Derivative by the place, for each axis; 1/length.
    pub by_place: [Spectrum; 3],
}

impl Irradiance {
    /// At a place and a normal that differ by these vectors; not negative.
    #[inline]
    pub fn at(&self, place: Vec3, normal: Vec3) -> Spectrum {
        let along = |gradient: &[Spectrum; 3], v: Vec3| gradient[0] * v.x + gradient[1] * v.y + gradient[2] * v.z;
        (self.value + along(&self.by_place, place) + along(&self.by_normal, normal)).max(0.0)
    }
}

/// Cells of a hemisphere.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hemisphere {
    /// Divisions of sin²θ.
    pub rows: u32,
    /// Divisions of φ.
    pub columns: u32,
}

impl Hemisphere {
    /// About so many cells, π times as many columns as rows, for cells of equal sides.
    pub fn new(rays: u32) -> Self {
        let rows = ((rays as f32 / PI).sqrt().round() as u32).max(1);
        Self { rows, columns: (rays / rows).max(1) }
    }

    /// Number of cells.
    pub fn cells(&self) -> u32 {
        self.rows * self.columns
    }

    /// A direction in a cell, by two numbers in [0, 1); cells go by rows.
    pub fn direction(&self, cell: u32, u: Vec2) -> Vec3 {
        let sin2 = ((cell / self.columns) as f32 + u.x) / self.rows as f32;
        let phi = TAU * ((cell % self.columns) as f32 + u.y) / self.columns as f32;
        let (sin, cos) = (sin2.sqrt(), (1.0 - sin2).max(0.0).sqrt());
        Vec3::new(sin * phi.cos(), sin * phi.sin(), cos)
    }

    /// Harmonic mean of distances; infinite where all are.
    pub fn mean_distance(&self, distances: &[f32]) -> f32 {
        distances.len() as f32 / distances.iter().map(|r| 1.0 / r.max(f32::MIN_POSITIVE)).sum::<f32>()
    }

    /// Irradiance by the radiance of all cells, and the gradients by the distances too.
    pub fn irradiance(&self, frame: &Frame, light: &[Spectrum], distances: &[f32]) -> Irradiance {
        let (rows, columns) = (self.rows as usize, self.columns as usize);
        let weight = PI / self.cells() as f32;
        let at = |j: usize, k: usize| (light[j * columns + k], distances[j * columns + k]);
        let (sum, mut turn, mut shift) =
            (light.iter().fold(Spectrum::ZERO, |a, b| a + *b), [Spectrum::ZERO; 3], [Spectrum::ZERO; 3]);
        let mut add = |to: usize, light: Spectrum, w: Vec3| {
            let gradient = if to == 0 { &mut turn } else { &mut shift };
            let w = frame.to_world(w);
            for (axis, sum) in gradient.iter_mut().enumerate() {
                *sum += light * w[axis];
            }
        };
        // sinθ at the lower border of a row.
        let sin = |j: usize| (j as f32 / rows as f32).sqrt();
        let step = TAU / columns as f32;
        for k in 0..columns {
            let (middle, border) = ((k as f32 + 0.5) * step, k as f32 * step);
            let outwards = Vec3::new(middle.cos(), middle.sin(), 0.0);
            let across = Vec3::new(-border.sin(), border.cos(), 0.0);
            for j in 0..rows {
                let (here, r) = at(j, k);
                // A turn of the normal by δ changes the cosine by tanθ (û·δ) of itself; tanθ of the middle of the cell.
                let sin2 = (j as f32 + 0.5) / rows as f32;
                add(0, here * (weight * (sin2 / (1.0 - sin2)).sqrt()), outwards);
                // Borders towards the zenith move by cosθ/r, and have the length sinθ Δφ; light counts by cosθ.
                if j > 0 {
                    let (inner, r_inner) = at(j - 1, k);
                    let cos2 = 1.0 - j as f32 / rows as f32;
                    add(1, (here - inner) * (step * sin(j) * cos2 / r.min(r_inner)), outwards);
                }
                // Borders between columns move by 1/r across.
                let (before, r_before) = at(j, (k + columns - 1) % columns);
                add(1, (here - before) * ((sin(j + 1) - sin(j)) / r.min(r_before)), across);
            }
        }
        Irradiance { value: sum * weight, by_normal: turn, by_place: shift }
    }
}
