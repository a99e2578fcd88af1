//! Denoisers by name.

use pyo3::{exceptions::PyValueError, prelude::*};
use steradian::{
    Error, Layer,
    denoise::{self, GUIDES, OIDN_GUIDES, Oidn, Outcome},
    image::Image,
};

/// A denoiser.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Denoiser {
    /// First-order regression.
    Nlm,
    /// The à-trous wavelet filter.
    Atrous,
    /// Open Image Denoise.
    Oidn,
}

impl From<Denoiser> for steradian_server::Denoiser {
    fn from(denoiser: Denoiser) -> Self {
        match denoiser {
            Denoiser::Nlm => Self::Nlm,
            Denoiser::Atrous => Self::Atrous,
            Denoiser::Oidn => Self::Oidn,
        }
    }
}

impl Denoiser {
    /// By name.
    pub fn named(name: &str) -> PyResult<Self> {
        match name {
            "nlm" => Ok(Self::Nlm),
            "atrous" => Ok(Self::Atrous),
            "oidn" => Ok(Self::Oidn),
            other => Err(PyValueError::new_err(format!("there is no denoiser '{other}'; known are nlm, atrous, oidn"))),
        }
    }

    /// Refuses Open Image Denoise where its library is not found, before anything takes long.
    pub fn check(self) -> PyResult<()> {
        match self {
            Self::Oidn => denoise::oidn_library(None).map(drop).map_err(PyValueError::new_err),
            Self::Nlm | Self::Atrous => Ok(()),
        }
    }

    /// The layers that guide it.
    pub fn guides(self) -> &'static [Layer] {
        if self == Self::Oidn { &OIDN_GUIDES } else { &GUIDES }
    }

    /// A picture without its noise. `half` and `strength` are of `nlm`.
    pub fn picture(self, noisy: &Image, half: Option<&Image>, strength: f32) -> Result<Outcome, String> {
        let told = |e: Error| e.to_string();
        match self {
            Self::Nlm => denoise::picture(noisy, half, strength).map_err(told),
            Self::Atrous => denoise::quick(noisy).map_err(told),
            Self::Oidn => {
                let path = denoise::oidn_library(None)?;
                let oidn = Oidn::load(&path, 0).map_err(|e| format!("'{}': {e}", path.display()))?;
                denoise::by_oidn(noisy, &oidn).map_err(told)
            }
        }
    }
}
