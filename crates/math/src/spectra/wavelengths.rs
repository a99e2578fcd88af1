//! Sampling of wavelengths: four of them per path, stratified, from one random number (hero wavelengths, Wilkie et al.
//! 2014, "Hero Wavelength Spectral Sampling").
//!
//! The visible-importance density is the one of pbrt-v4 (after Radziszewski et al. 2009, "An Improved Technique for
//! Full Spectral Rendering"): `p(λ) ∝ sech²(0.0072 (λ − 538))` on [360, 830] nm, inverted in closed form.

use super::cie::{CIE_Y_INTEGRAL, CMF_F32, nearest};
use super::{LAMBDA_MAX, LAMBDA_MIN};
use crate::color::space::REC709;
use crate::{Spectrum, Vec3, Vec4};

/// Width (1/nm) and centre (nm) of the visible-importance density.
const SLOPE: f32 = 0.0072;
const CENTRE: f32 = 538.0;
/// `tanh(SLOPE (CENTRE − 360))` and `tanh(SLOPE (830 − CENTRE)) + ` the same: the start and the range of the inverted
/// integral.
const TANH_START: f32 = 0.856_910_6;
const TANH_RANGE: f32 = 1.827_502;

/// Four wavelengths in nm and the density (1/nm) with which each was drawn, and the moment: what light of a path is
/// looked at. A lane of density zero is terminated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wavelengths {
    /// Wavelengths, nm. The first is the hero.
    pub lambda: [f32; 4],
    /// Densities, 1/nm.
    pub pdf: [f32; 4],
    /// Place in the shutter interval, [0, 1).
    pub time: f32,
    /// Delay by matter, s: the light set out that much earlier.
    pub delay: f32,
}

impl Wavelengths {
    /// No wavelengths, for the lanes of RGB, as the shutter opens.
    pub const RGB: Self = Self::at([0.0; 4]);

    /// These wavelengths, each of density one, as the shutter opens.
    pub const fn at(lambda: [f32; 4]) -> Self {
        Self { lambda, pdf: [1.0; 4], time: 0.0, delay: 0.0 }
    }

    /// Replaces the moment of the exposure.
    #[must_use]
    pub fn at_time(self, time: f32) -> Self {
        Self { time, ..self }
    }

    /// Four stratified wavelengths from `u` in [0, 1), distributed by the visible-importance density.
    pub fn sample_visible(u: f32) -> Self {
        let tanh = strata(u).map(tanh_at);
        // sech² = 1 − tanh² spares the hyperbolic cosine.
        Self {
            lambda: tanh.map(lambda_at),
            pdf: tanh.map(|t| SLOPE / TANH_RANGE * (1.0 - t * t)),
            time: 0.0,
            delay: 0.0,
        }
    }

    /// Keeps the hero wavelength alone, for a path whose direction depends on it (dispersion): the other lanes get
    /// density zero and the hero's is divided by four, since it was as likely to have been any of the four lanes.
    pub fn terminate_secondary(&mut self) {
        if !self.is_secondary_terminated() {
            self.pdf = [self.pdf[0] / 4.0, 0.0, 0.0, 0.0];
        }
    }

    /// True if only the hero wavelength is left.
    #[inline]
    pub fn is_secondary_terminated(&self) -> bool {
        self.pdf[1..] == [0.0; 3]
    }

    /// The one-sample estimate of CIE XYZ of radiance `l` at these wavelengths: the mean over lanes of `l x̄ / p`, over
    /// [`CIE_Y_INTEGRAL`]. Terminated lanes add nothing.
    #[inline]
    pub fn to_xyz(&self, l: Spectrum) -> Vec3 {
        let mut sum = Vec4::ZERO;
        for lane in 0..4 {
            if let (Some(i), true) = (nearest(self.lambda[lane]), self.pdf[lane] > 0.0) {
                sum += CMF_F32[i] * (l[lane] / self.pdf[lane]);
            }
        }
        sum.truncate() * (0.25 / CIE_Y_INTEGRAL as f32)
    }

    /// The one-sample estimate of the luminance Y of `l` (the Y of [`to_xyz`](Self::to_xyz)).
    #[inline]
    pub fn luminance(&self, l: Spectrum) -> f32 {
        self.to_xyz(l).y
    }

    /// The one-sample estimate of linear Rec.709 of `l`. May be negative: single wavelengths lie outside the gamut.
    #[inline]
    pub fn to_rgb(&self, l: Spectrum) -> Vec3 {
        REC709.rgb_from_xyz_f32() * self.to_xyz(l)
    }
}

/// `u`, `u + ¼`, `u + ½`, `u + ¾`, wrapped into [0, 1).
#[inline]
fn strata(u: f32) -> [f32; 4] {
    [0.0, 0.25, 0.5, 0.75].map(|s| if u + s >= 1.0 { u + s - 1.0 } else { u + s })
}

/// The wavelength (nm, in [360, 830]) below which the visible-importance distribution has the share `u` in [0, 1].
#[inline]
pub fn sample_visible(u: f32) -> f32 {
    lambda_at(tanh_at(u))
}

/// `tanh(SLOPE (CENTRE − λ))` of the wavelength below which there is the share `u`.
#[inline]
fn tanh_at(u: f32) -> f32 {
    TANH_START - TANH_RANGE * u
}

/// The wavelength of such a hyperbolic tangent: `atanh t = ½ ln((1 + t) / (1 − t))`.
#[inline]
fn lambda_at(tanh: f32) -> f32 {
    (CENTRE - ((1.0 + tanh) / (1.0 - tanh)).ln() * (0.5 / SLOPE)).clamp(LAMBDA_MIN, LAMBDA_MAX)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hash::HashRng;
    use crate::spectra::{Spd, d65};

    #[test]
    fn the_constants_are_those_of_the_density() {
        let (slope, centre) = (0.0072f64, 538.0f64);
        let start = (slope * (centre - 360.0)).tanh();
        let range = start + (slope * (830.0 - centre)).tanh();
        assert!((f64::from(TANH_START) - start).abs() < 1e-7);
        assert!((f64::from(TANH_RANGE) - range).abs() < 2e-7);
    }

    #[test]
    fn the_density_integrates_to_one_and_inverts() {
        let density = |l: f32| SLOPE / TANH_RANGE / (SLOPE * (l - CENTRE)).cosh().powi(2);
        let sum: f64 = (0..47_000).map(|i| f64::from(density(360.005 + i as f32 * 0.01)) * 0.01).sum();
        assert!((sum - 1.0).abs() < 1e-5, "{sum}");
        assert!((sample_visible(0.0) - 360.0).abs() < 0.01 && (sample_visible(1.0) - 830.0).abs() < 0.02);
        for i in 1..100 {
            // The share below the sample of u is u.
            let u = i as f64 / 100.0;
            let l = f64::from(sample_visible(u as f32));
            let share = ((0.0072 * (l - 538.0)).tanh() + f64::from(TANH_START)) / f64::from(TANH_RANGE);
            assert!((share - u).abs() < 1e-5, "{u}: {share}");
            let w = Wavelengths::sample_visible(u as f32);
            for (l, p) in w.lambda.into_iter().zip(w.pdf) {
                assert!((p / density(l) - 1.0).abs() < 1e-5, "{l} nm");
            }
        }
    }

    /// Pearson's statistic of all four lanes against the integral of the density over each bin, at about four standard
    /// deviations.
    #[test]
    fn every_lane_follows_its_density() {
        const BINS: usize = 47;
        const N: usize = 100_000;
        let cdf = |l: f64| (0.0072 * (l - 538.0)).tanh() / f64::from(TANH_RANGE);
        let mut rng = HashRng::new(7);
        let mut counts = [[0usize; BINS]; 4];
        for _ in 0..N {
            let w = Wavelengths::sample_visible(rng.next_f32());
            for (counts, l) in counts.iter_mut().zip(w.lambda) {
                counts[(((l - 360.0) / 10.0) as usize).min(BINS - 1)] += 1;
            }
        }
        for (lane, counts) in counts.iter().enumerate() {
            let chi2: f64 = (0..BINS)
                .map(|b| {
                    let low = 360.0 + 10.0 * b as f64;
                    let expected = N as f64 * (cdf(low + 10.0) - cdf(low));
                    (counts[b] as f64 - expected).powi(2) / expected
                })
                .sum();
            let dof = (BINS - 1) as f64;
            assert!(chi2 < dof + 4.0 * (2.0 * dof).sqrt(), "lane {lane}: {chi2}");
        }
    }

    /// A white surface under D65 is RGB (1, 1, 1) on average, with all lanes and with the hero alone.
    #[test]
    fn the_estimate_of_white_is_unbiased() {
        for terminate in [false, true] {
            let mut rng = HashRng::new(11);
            let (n, mut sum, mut square) = (100_000, glam::DVec3::ZERO, glam::DVec3::ZERO);
            for _ in 0..n {
                let mut w = Wavelengths::sample_visible(rng.next_f32());
                if terminate {
                    w.terminate_secondary();
                }
                let v = w.to_rgb(d65().sample(&w)).as_dvec3();
                sum += v;
                square += v * v;
            }
            let mean = sum / f64::from(n);
            let sigma = ((square / f64::from(n) - mean * mean) / f64::from(n)).map(f64::sqrt);
            assert!(((mean - 1.0).abs() / sigma).max_element() < 4.0, "{mean} ± {sigma}");
            assert!(sigma.max_element() < 0.02);
        }
    }

    #[test]
    fn the_estimate_agrees_with_the_integral_for_any_spectrum() {
        let s = Spd::Blackbody(crate::spectra::Blackbody::normalized(3000.0));
        let n = 50_000;
        let mean = (0..n)
            .map(|i| {
                let w = Wavelengths::sample_visible((i as f32 + 0.5) / n as f32);
                w.to_xyz(s.sample(&w)).as_dvec3()
            })
            .sum::<glam::DVec3>()
            / f64::from(n);
        let exact = s.to_xyz();
        assert!(((mean - exact) / exact).abs().max_element() < 1e-3, "{mean} {exact}");
    }

    #[test]
    fn lanes_are_distinct_strata_inside_the_range() {
        for u in [0.0, 0.1, 0.25, 0.5, 0.75, 0.999_999_94] {
            let w = Wavelengths::sample_visible(u);
            let mut sorted = w.lambda;
            sorted.sort_by(f32::total_cmp);
            assert!(sorted.windows(2).all(|p| p[1] - p[0] > 20.0), "{sorted:?}");
            assert!(sorted[0] >= 360.0 && sorted[3] <= 830.0);
            assert!(w.pdf.iter().all(|&p| p > 0.0));
        }
    }

    #[test]
    fn terminating_twice_is_terminating_once() {
        let mut w = Wavelengths::sample_visible(0.3);
        assert!(!w.is_secondary_terminated());
        w.terminate_secondary();
        let once = w;
        w.terminate_secondary();
        assert_eq!(w, once);
        assert!(w.is_secondary_terminated());
        // Lanes of density zero add nothing, whatever they hold.
        assert!(w.to_xyz(Spectrum::new([1.0, f32::INFINITY, f32::NAN, 5.0])).is_finite());
    }
}
