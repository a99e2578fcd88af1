//! Edge-stopping weights of pixels by the surfaces that they show, for many pixels at once.

use rayon::prelude::*;

use super::{settings::Settings, surface::Surface};
use crate::falloff::falloff;
use crate::{
    image::Image,
    rows::{Column, Rows, WIDTH},
};

/// Relative tolerance of depths beyond their gradients: surfaces are curved.
const CURVATURE: f32 = 1e-3;
/// Less than this is no likeness of normals.
const LEAST: f32 = 1e-12;
/// Planes: depth, its gradient, and the normal.
const DEPTH: usize = 0;
const GRADIENT: usize = 1;
const NORMAL: usize = 3;
const PLANES: usize = 6;

/// Surfaces in columns. Depth is NaN outside the picture: nothing is like it.
#[derive(Clone, Debug)]
pub(super) struct Geometry {
    shape: Rows,
    id: Rows<u32>,
}

impl Geometry {
    /// Geometry of surfaces, with a margin.
    pub fn new(surfaces: &Image<Surface>, margin: usize) -> Self {
        let mut shape = Rows::filled(surfaces.size(), &[f32::NAN; PLANES], margin);
        let mut id = Rows::filled(surfaces.size(), &[0], margin);
        let rows = surfaces.values().par_chunks(surfaces.width() as usize);
        shape.par_rows().zip(id.par_rows()).zip(rows).for_each(|(((_, mut shape), (_, mut id)), surfaces)| {
            // Depth, its gradient and the normal of each surface, from structures to columns.
            for (x, surface) in surfaces.iter().enumerate() {
                let Surface { depth, gradient, normal, .. } = surface;
                let values = [*depth, gradient.x, gradient.y, normal.x, normal.y, normal.z];
                values.into_iter().enumerate().for_each(|(plane, value)| shape.set(plane, x, value));
                id.set(0, x, surface.id);
            }
        });
        Self { shape, id }
    }

    /// 1 for the pixels of a block whose neighbours at an offset, in row `y` of the picture, show the same object.
    #[inline(always)]
    pub fn is_same(&self, at: [usize; 2], y: usize, columns: i64, same: &mut Column) {
        let (id, other) = (self.id.block(0, at, 0), self.id.block(0, [at[0], y], columns));
        for k in 0..WIDTH {
            same[k] = if id[k] == other[k] { 1.0 } else { 0.0 };
        }
    }

    /// Likeness of the pixels of a block and those at an offset, in row `y` of the picture.
    #[inline(always)]
    pub fn compare(&self, at: [usize; 2], y: usize, offset: [i64; 2], settings: &Settings, to: &mut Likeness) {
        let here = |plane| self.shape.block(plane, at, 0);
        let there = |plane| self.shape.block(plane, [at[0], y], offset[0]);
        let (z, other_z, gradient) = (here(DEPTH), there(DEPTH), [here(GRADIENT), here(GRADIENT + 1)]);
        let [dx, dy] = offset.map(|o| o as f32);
        // w_z: |z_p − z_q|/(σ_z |∇z·(p − q)| + ε) as an exponent (equation 3).
        for k in 0..WIDTH {
            let expected = (gradient[0][k] * dx + gradient[1][k] * dy).abs();
            let apart = (z[k] - other_z[k]).abs() / (settings.sigma_depth * expected + CURVATURE * z[k].abs());
            to.depth[k] = if z[k] == other_z[k] { 0.0 } else { apart };
        }
        let normal = [here(NORMAL), here(NORMAL + 1), here(NORMAL + 2)];
        let other = [there(NORMAL), there(NORMAL + 1), there(NORMAL + 2)];
        // w_n: max(0, n_p·n_q) to the power σ_n (equation 4).
        for k in 0..WIDTH {
            let dot = normal[0][k] * other[0][k] + normal[1][k] * other[1][k] + normal[2][k] * other[2][k];
            let is_equal =
                (normal[0][k] == other[0][k]) & (normal[1][k] == other[1][k]) & (normal[2][k] == other[2][k]);
            let cosine = if is_equal | (dot > 1.0) { 1.0 } else { dot };
            // Not so for NaN.
            to.factor[k] = if cosine >= LEAST { cosine } else { 0.0 };
        }
        power(&mut to.factor, settings.normal_power);
        // Another object has no weight.
        let (id, other_id) = (self.id.block(0, at, 0), self.id.block(0, [at[0], y], offset[0]));
        for k in 0..WIDTH {
            let is_alike = (to.factor[k] >= LEAST) & (id[k] == other_id[k]);
            to.factor[k] = if is_alike { to.factor[k] } else { 0.0 };
        }
    }
}

/// Edge-stopping weights of the pixels of a block: w_z and w_n of the paper's equations 3 and 4.
#[derive(Clone, Copy, Debug)]
pub(super) struct Likeness {
    /// w_n, 0 for another object.
    pub factor: Column,
    /// The exponent of w_z: w_z = e^−depth. May be NaN, where w_z is 0.
    pub depth: Column,
}

impl Likeness {
    /// Likeness of equal surfaces: w_z = w_n = 1.
    pub const WHOLE: Self = Self { factor: [1.0; WIDTH], depth: [0.0; WIDTH] };

    /// The product of both.
    #[inline(always)]
    pub fn weights(&self) -> Column {
        let mut weights = [0.0; WIDTH];
        for (k, weight) in weights.iter_mut().enumerate() {
            *weight = self.factor[k] * falloff(self.depth[k]);
        }
        weights
    }
}

/// xⁿ by squaring.
#[inline(always)]
fn power(x: &mut Column, n: u32) {
    // Exponentiation by squaring, the same for all columns.
    let mut square = *x;
    *x = [1.0; WIDTH];
    for bit in 0..u32::BITS - n.leading_zeros() {
        if n >> bit & 1 == 1 {
            (0..WIDTH).for_each(|k| x[k] *= square[k]);
        }
        (0..WIDTH).for_each(|k| square[k] *= square[k]);
    }
}
