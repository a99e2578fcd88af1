//! A density on the unit square that is constant on the cells of a grid.

use super::{accumulate, find, guide_len, piece_at, place, weight};
use crate::{Vec2, distribution::Piecewise1D};

/// A piecewise-constant density on `[0,1)²`, proportional to the sizes of tabulated values: a marginal over rows and a
/// conditional within each row.
#[derive(Clone, Debug)]
pub struct Piecewise2D {
    nu: usize,
    nv: usize,
    /// Density of each cell, row by row, with the sign of its value.
    density: Vec<f32>,
    /// Cumulative distributions and guide tables of the rows, one after the other.
    cdf: Vec<f32>,
    guide: Vec<u32>,
    rows: Piecewise1D,
    integral: f32,
}

impl Piecewise2D {
    /// From `nv` rows of `nu` values, `u` (the first coordinate) fastest. A slice of any other length than `nu·nv`
    /// describes no grid, and gives the uniform density.
    pub fn new(values: &[f32], nu: usize, nv: usize) -> Self {
        let is_grid = nu > 0 && nv > 0 && nu.checked_mul(nv) == Some(values.len());
        let (values, nu, nv) = if is_grid { (values, nu, nv) } else { (&[0.0][..], 1, 1) };

        let guide_nu = guide_len(nu);
        let mut cdf = vec![0.0; (nu + 1) * nv];
        let mut guide = vec![0; guide_nu * nv];
        let mut row_sums = Vec::with_capacity(nv);
        for (v, row) in values.chunks_exact(nu).enumerate() {
            let cdf_row = &mut cdf[v * (nu + 1)..][..nu + 1];
            let guide_row = &mut guide[v * guide_nu..][..guide_nu];
            row_sums.push(accumulate(row.iter().map(|&x| weight(x)), cdf_row, guide_row));
        }
        let mean = row_sums.iter().sum::<f64>() / (nu * nv) as f64;
        let density =
            values.iter().map(|&x| if mean > 0.0 { ((weight(x) / mean) as f32).copysign(x) } else { 1.0 }).collect();
        // Rows relative to their mean: sums of finite values can be beyond f32.
        let row_mean = if mean > 0.0 { mean * nu as f64 } else { 1.0 };
        let rows = Piecewise1D::new(&row_sums.iter().map(|s| (s / row_mean) as f32).collect::<Vec<_>>());
        Self { nu, nv, density, cdf, guide, rows, integral: mean as f32 }
    }

    /// The point of `u`, and its density.
    #[inline]
    pub fn sample(&self, u: Vec2) -> (Vec2, f32) {
        let (p, pdf, _) = self.sample_cell(u);
        (p, pdf)
    }

    /// Like [`Piecewise2D::sample`], with the cell `[column, row]` of the point.
    #[inline]
    pub fn sample_cell(&self, u: Vec2) -> (Vec2, f32, [usize; 2]) {
        let (y, _, row) = self.rows.sample(u.y);
        let guide_nu = guide_len(self.nu);
        let cdf = &self.cdf[row * (self.nu + 1)..][..self.nu + 1];
        let (column, t) = find(cdf, &self.guide[row * guide_nu..][..guide_nu], u.x);
        let pdf = self.density[row * self.nu + column].abs();
        (Vec2::new(place(column, t, self.nu), y), pdf, [column, row])
    }

    /// Density at `p`; zero outside the square.
    #[inline]
    pub fn pdf(&self, p: Vec2) -> f32 {
        if (0.0..1.0).contains(&p.x) && (0.0..1.0).contains(&p.y) {
            self.density[piece_at(p.y, self.nv) * self.nu + piece_at(p.x, self.nu)].abs()
        } else {
            0.0
        }
    }

    /// `−1` where the value of the cell `[column, row]` is negative, else `1`.
    #[inline]
    pub fn value_sign(&self, cell: [usize; 2]) -> f32 {
        self.density.get(cell[1] * self.nu + cell[0]).map_or(1.0, |d| d.signum())
    }

    /// Integral over the square of the sizes of the values; zero where the density had to be made uniform.
    pub fn integral(&self) -> f32 {
        self.integral
    }

    /// Columns and rows of the grid.
    pub fn size(&self) -> [usize; 2] {
        [self.nu, self.nv]
    }
}
