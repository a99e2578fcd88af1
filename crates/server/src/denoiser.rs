//! Denoisers of the pictures that are shown.

use crate::{
    frame::Shown,
    protocol::{Denoiser, Named},
};
use std::path::{Path, PathBuf};
use steradian::{
    Layer,
    denoise::{self, GUIDES, OIDN_GUIDES, Oidn},
    develop,
    image::{Image, Value},
};

/// The file of Open Image Denoise's library, or why there is none.
pub type Library = Result<PathBuf, String>;

/// Denoisers that can be had.
pub struct Denoisers {
    /// The library of Open Image Denoise.
    pub library: Library,
    /// The one that is taken where none is chosen: Open Image Denoise, where it can be loaded.
    pub best: Denoiser,
}

impl Denoisers {
    /// With the library, if there is one.
    pub fn new(library: Library) -> Self {
        let best = if load(&library).is_ok() { Denoiser::Oidn } else { Denoiser::Nlm };
        Self { library, best }
    }
}

/// Denoisers that pages choose from.
pub const CHOICES: [Named; 3] = [
    Named { name: Denoiser::Nlm.name(), doc: "first-order regression in the end, a wavelet filter on the way" },
    Named { name: Denoiser::Atrous.name(), doc: "a wavelet filter, which takes a small part of the time" },
    Named { name: Denoiser::Oidn.name(), doc: "Open Image Denoise in the end, a wavelet filter on the way" },
];

impl Denoiser {
    /// As the command line calls it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Nlm => "nlm",
            Self::Atrous => "atrous",
            Self::Oidn => "oidn",
        }
    }

    /// The layers that guide it.
    pub fn guides(self) -> &'static [Layer] {
        if self == Self::Oidn { &OIDN_GUIDES } else { &GUIDES }
    }

    /// Tests if the denoiser can be had.
    ///
    /// # Errors
    /// Why not.
    pub fn check(self, denoisers: &Denoisers) -> Result<(), String> {
        if self == Self::Oidn { load(&denoisers.library).map(|_| ()) } else { Ok(()) }
    }

    /// A picture without its noise.
    ///
    /// # Errors
    /// Why there is none.
    pub fn picture(self, shown: &Shown, denoisers: &Denoisers) -> Result<Image, String> {
        let mut noisy = develop(&shown.scene, &shown.film, self.guides());
        if shown.samples < 2.0 {
            noisy.metadata.set("samplesPerPixel", Value::Int(1));
        }
        let outcome = match self {
            Self::Nlm => denoise::picture(&noisy, None, 1.0),
            Self::Atrous => denoise::quick(&noisy),
            // One thread alone may use what is loaded, and what fails inside is not used again.
            Self::Oidn => denoise::by_oidn(&noisy, &load(&denoisers.library)?),
        };
        Ok(outcome.map_err(|e| e.to_string())?.picture)
    }
}

fn load(library: &Library) -> Result<Oidn, String> {
    let path: &Path = library.as_deref().map_err(Clone::clone)?;
    let failed = |e: &dyn std::fmt::Display| format!("'{}': {e}", path.display());
    Oidn::load(path, rayon::current_num_threads()).map_err(|e| failed(&e))
}
