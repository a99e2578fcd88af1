//! A density on [0,1) that is constant on equal pieces.

use super::{accumulate, find, guide_len, piece_at, place, weight};

/// A piecewise-constant density on `[0,1)`, proportional to the sizes of tabulated values.
#[derive(Clone, Debug)]
pub struct Piecewise1D {
    /// Density of each piece, with the sign of its value.
    density: Vec<f32>,
    cdf: Vec<f32>,
    guide: Vec<u32>,
    integral: f32,
}

impl Piecewise1D {
    /// From one value per piece; no value at all gives the uniform density.
    pub fn new(values: &[f32]) -> Self {
        let values = if values.is_empty() { &[0.0][..] } else { values };
        let n = values.len();
        let mut cdf = vec![0.0; n + 1];
        let mut guide = vec![0; guide_len(n)];
        let sum = accumulate(values.iter().map(|&v| weight(v)), &mut cdf, &mut guide);
        let mean = sum / n as f64;
        let density =
            values.iter().map(|&v| if sum > 0.0 { ((weight(v) / mean) as f32).copysign(v) } else { 1.0 }).collect();
        Self { density, cdf, guide, integral: mean as f32 }
    }

    /// The place of `u`, its density, and the piece it lies in. Monotone in `u`.
    #[inline]
    pub fn sample(&self, u: f32) -> (f32, f32, usize) {
        let (i, t) = find(&self.cdf, &self.guide, u);
        (place(i, t, self.len()), self.density[i].abs(), i)
    }

    /// Density at `x`; zero outside `[0,1)`.
    #[inline]
    pub fn pdf(&self, x: f32) -> f32 {
        if (0.0..1.0).contains(&x) { self.density[piece_at(x, self.len())].abs() } else { 0.0 }
    }

    /// `−1` where the value of piece `index` is negative, else `1`.
    #[inline]
    pub fn value_sign(&self, index: usize) -> f32 {
        self.density.get(index).map_or(1.0, |d| d.signum())
    }

    /// Integral over `[0,1)` of the sizes of the values; zero where the density had to be made uniform.
    pub fn integral(&self) -> f32 {
        self.integral
    }

    /// Number of pieces, at least one.
    #[inline]
    #[expect(clippy::len_without_is_empty, reason = "never empty")]
    pub fn len(&self) -> usize {
        self.density.len()
    }
}
