//! Pictures as signals: their discrete Fourier transform, what sampling does to it, and what a prefilter prevents.
//!
//! Frequencies are in cycles per pixel. The transform of a picture of N pixels across knows the frequencies k/N from
//! −1/2 up to 1/2; sampled at every s-th pixel, with the rate 1/s, a picture keeps what is below half that rate, and
//! the rest appears at another frequency.

mod plot;
mod sampling;

pub use plot::{panels, spectrum_svg};
pub use sampling::{Peak, Prefilter, alias, comb, peaks, prefilter};

use crate::{Error, Result};
use rustfft::{FftPlanner, num_complex::Complex};

/// A two-dimensional discrete Fourier transform, row by row, frequency zero first:
/// `X[k, l] = Σ x[m, n] e^(−2πi (km/W + ln/H))`.
#[derive(Clone, Debug)]
pub struct Dft {
    /// Frequencies across.
    pub width: usize,
    /// Frequencies down.
    pub height: usize,
    /// `width × height` values.
    pub values: Vec<Complex<f64>>,
}

impl Dft {
    /// The transform of a plane of real values.
    ///
    /// # Errors
    /// [`Error::Invalid`] when the plane has another size, is empty, or holds values that are not finite.
    pub fn new(plane: &[f32], width: usize, height: usize) -> Result<Self> {
        if plane.is_empty() || width.checked_mul(height) != Some(plane.len()) {
            return Err(Error::Invalid(format!("{} values are no picture of {width}x{height}", plane.len())));
        }
        if plane.iter().any(|v| !v.is_finite()) {
            return Err(Error::Invalid("a picture with values that are not finite has no Fourier transform".into()));
        }
        let mut values: Vec<_> = plane.iter().map(|&v| Complex::new(f64::from(v), 0.0)).collect();
        transform(&mut values, width, height, false);
        Ok(Self { width, height, values })
    }

    /// The real part of the inverse transform.
    pub fn inverse(&self) -> Vec<f32> {
        let mut values = self.values.clone();
        transform(&mut values, self.width, self.height, true);
        let scale = 1.0 / (self.width * self.height) as f64;
        values.iter().map(|v| (v.re * scale) as f32).collect()
    }

    /// The frequency of a value, cycles per pixel, each component in `[−1/2, 1/2)`.
    pub fn frequency(&self, index: usize) -> [f64; 2] {
        let signed = |k: usize, n: usize| {
            let f = k as f64 / n as f64;
            if 2 * k >= n && n > 1 { f - 1.0 } else { f }
        };
        [signed(index % self.width, self.width), signed(index / self.width, self.height)]
    }

    /// Amplitudes: magnitudes over the number of pixels.
    pub fn amplitudes(&self) -> Vec<f64> {
        let scale = 1.0 / (self.width * self.height) as f64;
        self.values.iter().map(|v| v.norm() * scale).collect()
    }

    /// Multiplies by a function of frequency: a convolution with what that is the transform of.
    #[must_use]
    pub fn filtered(&self, response: impl Fn([f64; 2]) -> f64) -> Self {
        let values = self.values.iter().enumerate().map(|(i, v)| v * response(self.frequency(i))).collect();
        Self { values, ..*self }
    }
}

/// Transforms rows, then columns, in place.
fn transform(values: &mut [Complex<f64>], width: usize, height: usize, inverse: bool) {
    let mut planner = FftPlanner::new();
    let mut plan = |n| if inverse { planner.plan_fft_inverse(n) } else { planner.plan_fft_forward(n) };
    let (across, down) = (plan(width), plan(height));
    values.chunks_exact_mut(width).for_each(|row| across.process(row));
    let mut column = vec![Complex::default(); height];
    for x in 0..width {
        (0..height).for_each(|y| column[y] = values[y * width + x]);
        down.process(&mut column);
        (0..height).for_each(|y| values[y * width + x] = column[y]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noise(n: usize) -> Vec<f32> {
        (0..n).map(|i| ((i as u32).wrapping_mul(2_654_435_761) >> 8) as f32 / (1 << 24) as f32 - 0.3).collect()
    }

    /// Parseval: the energy of a picture is that of its transform over the number of pixels.
    #[test]
    fn energy_is_kept() {
        for (w, h) in [(16, 16), (31, 17), (1, 40), (12, 1), (1, 1)] {
            let plane = noise(w * h);
            let dft = Dft::new(&plane, w, h).unwrap();
            let energy: f64 = plane.iter().map(|&v| f64::from(v).powi(2)).sum();
            let seen: f64 = dft.values.iter().map(|v| v.norm_sqr()).sum::<f64>() / (w * h) as f64;
            assert!((energy - seen).abs() < 1e-9 * energy, "{w}x{h}");
            plane.iter().zip(dft.inverse()).for_each(|(a, b)| assert!((a - b).abs() < 1e-6));
        }
    }

    /// The definition, term by term.
    #[test]
    fn the_transform_is_the_sum_it_is_said_to_be() {
        let (w, h) = (5, 3);
        let plane = noise(w * h);
        let dft = Dft::new(&plane, w, h).unwrap();
        for k in 0..w {
            for l in 0..h {
                let mut sum = Complex::new(0.0, 0.0);
                for m in 0..w {
                    for n in 0..h {
                        let phase = -std::f64::consts::TAU * ((k * m) as f64 / w as f64 + (l * n) as f64 / h as f64);
                        sum += Complex::from_polar(f64::from(plane[n * w + m]), phase);
                    }
                }
                assert!((sum - dft.values[l * w + k]).norm() < 1e-9);
            }
        }
        assert_eq!(dft.frequency(3)[0], -0.4);
        assert_eq!(Dft::new(&noise(4), 4, 1).unwrap().frequency(2)[0], -0.5);
    }

    /// The convolution theorem: the transform of a circular convolution is the product of transforms.
    #[test]
    fn convolutions_become_products() {
        let (w, h) = (12, 7);
        let (a, b) = (noise(w * h), noise(3 * w * h)[w * h..2 * w * h].to_vec());
        let mut folded = vec![0.0_f64; w * h];
        for (i, va) in a.iter().enumerate() {
            for (j, vb) in b.iter().enumerate() {
                let (x, y) = ((i % w + j % w) % w, (i / w + j / w) % h);
                folded[y * w + x] += f64::from(*va) * f64::from(*vb);
            }
        }
        let (a, b) = (Dft::new(&a, w, h).unwrap(), Dft::new(&b, w, h).unwrap());
        let product = Dft { values: a.values.iter().zip(&b.values).map(|(a, b)| a * b).collect(), ..a };
        let seen = product.inverse();
        folded.iter().zip(seen).for_each(|(a, b)| assert!((a - f64::from(b)).abs() < 1e-4, "{a} {b}"));
    }

    #[test]
    fn what_is_no_picture_is_refused() {
        assert!(Dft::new(&[], 0, 0).is_err());
        assert!(Dft::new(&[1.0; 6], 2, 2).is_err());
        assert!(Dft::new(&[1.0, f32::NAN], 2, 1).is_err());
    }
}
