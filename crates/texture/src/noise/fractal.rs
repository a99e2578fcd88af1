//! Sums of noise over octaves, which end where the footprint would alias.
//!
//! Frequencies grow by 1.99 and amplitudes by the roughness from octave to octave, and the number of octaves is
//! `−1 − log₂ w` for a footprint of width `w`, the last one faded in: the rules of Pharr, Jakob, Humphreys, *Physically
//! Based Rendering*, 3rd ed., § 10.6 (and pbrt-v4's `noise.cpp`), so that pictures agree.

use super::{gradient_noise, smoothstep, value_noise};
use crate::{exact, mapping::Coordinates3};
use steradian_math::Vec3;

/// Basis function of the sum.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Basis {
    /// Perlin's noise.
    Gradient,
    /// Value noise.
    Value,
}

/// A sum over octaves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fractal {
    /// The noise.
    pub basis: Basis,
    /// Octaves at most.
    pub octaves: u32,
    /// Amplitude from octave to octave, pbrt's `omega`.
    pub roughness: f32,
    /// Frequency from octave to octave.
    pub lacunarity: f32,
    /// Which noise; 0 is Perlin's own.
    pub seed: u32,
}

/// Octaves beyond this change nothing that `f32` can hold.
pub const MAX_OCTAVES: u32 = 32;

impl Fractal {
    /// Octaves of gradient noise as pbrt has them.
    pub fn new(octaves: u32, roughness: f32) -> Self {
        Self { basis: Basis::Gradient, octaves, roughness, lacunarity: 1.99, seed: 0 }
    }

    /// One value of the basis at an octave's scale.
    fn noise(&self, p: Vec3) -> f32 {
        match self.basis {
            Basis::Gradient => gradient_noise(p, self.seed),
            Basis::Value => value_noise(p, self.seed),
        }
    }

    /// Number of octaves that fit the footprint, with a fraction.
    fn fitting(&self, at: &Coordinates3) -> f32 {
        let most = self.octaves.min(MAX_OCTAVES) as f32;
        let len2 = at.dx.length_squared().max(at.dy.length_squared());
        let n = -1.0 - 0.5 * exact::log2(len2.into()) as f32;
        if n < most { n.max(0.0) } else { most }
    }

    /// Weights of the octaves that count, with their frequency and amplitude; the last is the partial one.
    fn sum(&self, at: &Coordinates3, mut term: impl FnMut(f32, f32, f32)) -> u32 {
        let n = self.fitting(at);
        let whole = n.floor();
        let (mut frequency, mut amplitude) = (1.0_f32, 1.0_f32);
        for _ in 0..whole as u32 {
            term(frequency, amplitude, 1.0);
            frequency *= self.lacunarity;
            amplitude *= self.roughness;
        }
        term(frequency, amplitude, smoothstep(n - whole, 0.3, 0.7));
        whole as u32
    }

    /// Fractional Brownian motion: `Σ ωⁱ noise(λⁱ p)`.
    pub fn fbm(&self, at: &Coordinates3) -> f32 {
        let mut sum = 0.0;
        self.sum(at, |f, a, share| {
            if share > 0.0 {
                sum += a * share * self.noise(at.p * f);
            }
        });
        sum
    }

    /// Turbulence: `Σ ωⁱ |noise(λⁱ p)|`, with the mean (0.2, as pbrt has it) for octaves that do not fit.
    pub fn turbulence(&self, at: &Coordinates3) -> f32 {
        const MEAN: f32 = 0.2;
        let mut sum = 0.0;
        let mut last = 1.0;
        let whole = self.sum(at, |f, a, share| {
            let value = if share > 0.0 { self.noise(at.p * f).abs() } else { 0.0 };
            sum += a * ((1.0 - share) * MEAN + share * value);
            last = a;
        });
        for _ in whole..self.octaves.min(MAX_OCTAVES) {
            sum += last * MEAN;
            last *= self.roughness;
        }
        sum
    }

    /// Ridges: `Σ ωⁱ (1 − |noise(λⁱ p)|)² / Σ ωⁱ`, in [0, 1] (Musgrave, in Ebert et al., *Texturing & Modeling*, ch.
    /// 16, without its feedback), with the mean for octaves that do not fit.
    pub fn ridged(&self, at: &Coordinates3) -> f32 {
        // The mean of (1 − |noise|)² over space, of gradient and of value noise.
        let mean = match self.basis {
            Basis::Gradient => 0.633,
            Basis::Value => 0.5,
        };
        let (mut sum, mut weights, mut left) = (0.0, 0.0, 0.0);
        let whole = self.sum(at, |f, a, share| {
            let ridge = if share > 0.0 { 1.0 - self.noise(at.p * f).abs() } else { 0.0 };
            sum += a * share * ridge * ridge;
            weights += a * share;
            left = a * (1.0 - share);
        });
        // What remains of the partial octave and of those after it.
        let rest = self.octaves.min(MAX_OCTAVES).saturating_sub(whole);
        let mut amplitude = if rest > 0 { left } else { 0.0 };
        for i in 0..rest {
            sum += amplitude * mean;
            weights += amplitude;
            if i == 0 {
                amplitude = power(self.roughness, whole);
            }
            amplitude *= self.roughness;
        }
        if weights > 0.0 { sum / weights } else { mean }
    }
}

/// `x` to a whole power, by the same products everywhere.
fn power(x: f32, n: u32) -> f32 {
    (0..n).fold(1.0, |p, _| p * x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use steradian_math::hash::HashRng;

    fn point(p: Vec3) -> Coordinates3 {
        Coordinates3 { p, ..Coordinates3::default() }
    }

    #[test]
    fn octaves_add_up() {
        let p = Vec3::new(0.3, 1.7, -2.2);
        let f = Fractal::new(3, 0.5);
        let n = |k: f32| gradient_noise(p * k, 0);
        let (l, l2) = (1.99_f32, 1.99_f32 * 1.99);
        assert!((f.fbm(&point(p)) - (n(1.0) + 0.5 * n(l) + 0.25 * n(l2))).abs() < 1e-6);
        let t = n(1.0).abs() + 0.5 * n(l).abs() + 0.25 * n(l2).abs();
        // pbrt adds the mean of the octave after the last, which does not fit either.
        assert!((f.turbulence(&point(p)) - t - 0.125 * 0.2).abs() < 1e-6);
        let r = |v: f32| (1.0 - v.abs()) * (1.0 - v.abs());
        assert!((f.ridged(&point(p)) - (r(n(1.0)) + 0.5 * r(n(l)) + 0.25 * r(n(l2))) / 1.75).abs() < 1e-6);
    }

    #[test]
    fn octaves_that_do_not_fit_leave_their_mean() {
        let f = Fractal::new(8, 0.5);
        let at = |w: f32| Coordinates3 { p: Vec3::new(0.3, 1.7, -2.2), dx: Vec3::X * w, dy: Vec3::ZERO };
        // A footprint of 2⁻⁴ leaves three octaves.
        assert_eq!(f.fbm(&at(0.0625)), Fractal::new(3, 0.5).fbm(&at(0.0)));
        assert_eq!((f.fbm(&at(1.0)), f.fbm(&at(1e20))), (0.0, 0.0));
        assert!((f.ridged(&at(1e20)) - 0.633).abs() < 1e-5);
        // Σ 0.2 ωⁱ over the octaves and the one at which none fitted.
        assert!((f.turbulence(&at(10.0)) - 0.2 * (1.0 + (1.0 - 0.5_f32.powi(8)) / 0.5)).abs() < 1e-5);
    }

    #[test]
    fn the_mean_of_ridges_is_what_is_put_for_it() {
        for (basis, seed) in [(Basis::Gradient, 0), (Basis::Gradient, 4), (Basis::Value, 1)] {
            let f = Fractal { basis, seed, ..Fractal::new(1, 0.5) };
            let mut rng = HashRng::new(11);
            let (mut sum, mut squares, n) = (0.0, 0.0, 100_000);
            for _ in 0..n {
                let p = Vec3::new(rng.next_f32(), rng.next_f32(), rng.next_f32()) * 256.0;
                let v = f64::from(f.ridged(&point(p)));
                sum += v;
                squares += v * v;
            }
            let mean = sum / f64::from(n);
            let error = ((squares / f64::from(n) - mean * mean) / f64::from(n)).sqrt();
            let far = Coordinates3 { p: Vec3::ZERO, dx: Vec3::X * 1e9, dy: Vec3::ZERO };
            // Rounded to three digits.
            assert!((mean - f64::from(f.ridged(&far))).abs() < 4.0 * error + 0.0005, "{basis:?} {mean}");
        }
    }
}
