//! The two meanings of a spectrum's four lanes.

use super::Wavelengths;
use crate::{Spectrum, Vec3, color::luminance};

/// Meaning of the four lanes of a [`Spectrum`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ColorMode {
    /// Linear Rec.709 in three lanes.
    #[default]
    Rgb,
    /// Radiance at four sampled wavelengths.
    Spectral,
}

impl ColorMode {
    /// The wavelengths of a path: drawn by a number in [0, 1), for which RGB does not ask.
    #[inline]
    pub fn wavelengths(self, u: impl FnOnce() -> f32) -> Wavelengths {
        match self {
            Self::Rgb => Wavelengths::RGB,
            Self::Spectral => Wavelengths::sample_visible(u()),
        }
    }

    /// The luminance of lanes: that of Rec.709, or an estimate from those at the wavelengths.
    #[inline]
    pub fn luminance(self, lanes: Spectrum, lambda: &Wavelengths) -> f32 {
        match self {
            Self::Rgb => luminance(Vec3::from(lanes.to_rgb())),
            Self::Spectral => lambda.luminance(lanes),
        }
    }

    /// Linear Rec.709 of lanes, as an estimate: exact in RGB mode, the one-sample estimate in spectral mode.
    #[inline]
    pub fn to_rgb(self, lanes: Spectrum, lambda: &Wavelengths) -> Vec3 {
        match self {
            Self::Rgb => Vec3::from(lanes.to_rgb()),
            Self::Spectral => lambda.to_rgb(lanes),
        }
    }
}
