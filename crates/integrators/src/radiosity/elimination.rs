//! The direct solution: `(I − ρF − τF') B = S` by elimination with row pivoting, once for each lane.

use super::{
    patches::NONE,
    system::{Solved, System},
};
use glam::DVec4;
use rayon::prelude::*;

/// Most patches: a matrix of 128 MiB, and minutes.
pub const LIMIT: usize = 4096;

impl System {
    /// Solves the equation directly; `None` where told to stop. For up to [`LIMIT`] patches.
    pub fn direct(&self, tell: &dyn Fn(usize) -> bool) -> Option<Solved> {
        let n = self.len();
        let mut radiosity = vec![DVec4::ZERO; self.sources.len()];
        // Every lane has a matrix of its own, since albedos differ by wavelength.
        for b in 0..self.bands {
            let mut done = Vec::new();
            for lane in 0..4 {
                let of = |values: &[DVec4]| -> Vec<f64> { (0..n).map(|i| values[i * self.bands + b][lane]).collect() };
                let equation @ (reflectance, transmittance, sources) =
                    &(of(&self.reflectance), of(&self.transmittance), of(&self.sources));
                // Grey lanes have one matrix; so do those that the RGB mode leaves empty.
                if sources.iter().all(|s| *s == 0.0) {
                    continue;
                }
                let values = match done.iter().find(|(_, known)| known == equation) {
                    Some((same, _)) => of(&radiosity.iter().map(|r| DVec4::splat(r[*same])).collect::<Vec<_>>()),
                    None => eliminate(self.matrix(reflectance, transmittance), sources.clone(), tell)?,
                };
                values.iter().enumerate().for_each(|(i, v)| radiosity[i * self.bands + b][lane] = *v);
                done.push((lane, equation.clone()));
            }
        }
        // H = F B from the radiosities.
        let mut irradiance = vec![DVec4::ZERO; radiosity.len()];
        for (k, h) in irradiance.iter_mut().enumerate() {
            let (i, b) = (k / self.bands, k % self.bands);
            *h = self.rows[i].iter().map(|(j, f)| radiosity[*j as usize * self.bands + b] * *f).sum();
        }
        let residual = self.residual(&radiosity);
        Some(Solved { irradiance, steps: 1, residual })
    }

    /// The matrix of a lane, by rows.
    fn matrix(&self, reflectance: &[f64], transmittance: &[f64]) -> Vec<Vec<f64>> {
        (0..self.len())
            .into_par_iter()
            .map(|i| {
                let mut row = vec![0.0; self.len()];
                // Row i of I − ρ_i F_i − τ_i F_i'.
                row[i] = 1.0;
                self.rows[i].iter().for_each(|(j, f)| row[*j as usize] -= reflectance[i] * f);
                if self.twins[i] != NONE && transmittance[i] > 0.0 {
                    let through = &self.rows[self.twins[i] as usize];
                    through.iter().for_each(|(j, f)| row[*j as usize] -= transmittance[i] * f);
                }
                row
            })
            .collect()
    }
}

/// Solves `M x = y` by elimination with row pivoting.
fn eliminate(mut m: Vec<Vec<f64>>, mut y: Vec<f64>, tell: &dyn Fn(usize) -> bool) -> Option<Vec<f64>> {
    let n = y.len();
    // Forward elimination: the pivot is the greatest entry of the column below.
    for k in 0..n {
        if !tell(1) {
            return None;
        }
        let pivot = (k..n).max_by(|a, b| m[*a][k].abs().total_cmp(&m[*b][k].abs()))?;
        m.swap(k, pivot);
        y.swap(k, pivot);
        let (above, below) = m.split_at_mut(k + 1);
        let first = &above[k];
        let (known, rest) = y.split_at_mut(k + 1);
        below.par_iter_mut().zip(rest).with_min_len(32).for_each(|(row, y)| {
            // Row − factor · pivot row, in parallel over the rows below.
            let factor = row[k] / first[k];
            if factor != 0.0 {
                row[k] = 0.0;
                row[k + 1..].iter_mut().zip(&first[k + 1..]).for_each(|(a, b)| *a -= factor * b);
                *y -= factor * known[k];
            }
        });
    }
    // Back substitution.
    for k in (0..n).rev() {
        let sum: f64 = (k + 1..n).map(|j| m[k][j] * y[j]).sum();
        y[k] = (y[k] - sum) / m[k][k];
    }
    Some(y)
}
