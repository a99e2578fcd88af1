//! Sampling of wavelengths: four of them per path, stratified, from one random number (hero wavelengths, Wilkie et al. 2014,
//! "Hero Wavelength Spectral Sampling").
//!
//! The visible-importance density is the one of pbrt-v4 (after Radziszewski et al. 2009, "An Improved Technique for Full Spectral
//! Rendering"): `p(λ) ∝ sech²(0.0072 (λ − 538))` on [360, 830] nm, inverted in closed form.

use super::cie::{CIE_Y_INTEGRAL, CMF_F32, nearest};
use super::{LAMBDA_MAX, LAMBDA_MIN};
use crate::color::space::REC709;
use crate::{Spectrum, Vec3, Vec4};

/// Width (1/nm) and centre (nm) of the visible-importance density.
const SLOPE: f32 = 0.0072;
const CENTRE: f32 = 538.0;
/// `tanh(SLOPE (CENTRE − 360))` and `tanh(SLOPE (830 − CENTRE)) + ` the same: the start and the range of the inverted integral.
const TANH_START: f32 = 0.856_910_6;
const TANH_RANGE: f32 = 1.827_502;

/// Four wavelengths in nm and the density (1/nm) with which each was drawn. A lane of density zero is terminated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wavelengths {
    /// Wavelengths, nm. The first is the hero.
    pub lambda: [f32; 4],
    /// Densities, 1/nm.
    pub pdf: [f32; 4],
}

impl Wavelengths {
    /// Four evenly spaced wavelengths of [360, 830] nm from `u` in [0, 1); each is uniformly distributed.
    pub fn sample_uniform(u: f32) -> Self {
        let range = LAMBDA_MAX - LAMBDA_MIN;
        Self { lambda: strata(u).map(|u| LAMBDA_MIN + u * range), pdf: [1.0 / range; 4] }
    }

    /// Four stratified wavelengths from `u` in [0, 1), distributed by [`visible_pdf`].
    pub fn sample_visible(u: f32) -> Self {
        let lambda = strata(u).map(sample_visible);
        Self { lambda, pdf: lambda.map(visible_pdf) }
    }

    /// Keeps the hero wavelength alone, for a path whose direction depends on it (dispersion): the other lanes get density zero
    /// and the hero's is divided by four, since it was as likely to have been any of the four lanes.
    pub fn terminate_secondary(&mut self) {
        if !self.is_secondary_terminated() {
            self.pdf = [self.pdf[0] / 4.0, 0.0, 0.0, 0.0];
        }
    }

    /// Whether only the hero wavelength is left.
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

/// Density (1/nm) of the visible-importance distribution at `lambda` nm; zero outside [360, 830].
#[inline]
pub fn visible_pdf(lambda: f32) -> f32 {
    if !(LAMBDA_MIN..=LAMBDA_MAX).contains(&lambda) {
        return 0.0;
    }
    let c = (SLOPE * (lambda - CENTRE)).cosh();
    SLOPE / TANH_RANGE / (c * c)
}

/// The wavelength (nm, in [360, 830]) below which the visible-importance distribution has the share `u` in [0, 1].
#[inline]
pub fn sample_visible(u: f32) -> f32 {
    (CENTRE - (TANH_START - TANH_RANGE * u).atanh() / SLOPE).clamp(LAMBDA_MIN, LAMBDA_MAX)
}
