//! Facets with a choice of reflectance, and metals by their index, with their textures.

use super::{Roughness, albedo, optical_constant};
use steradian_bsdf::{Conductor, CookTorrance, DiffuseCoupling, Reflectance, ThinFilm};
use steradian_math::spectra::{ColorMode, Wavelengths};
use steradian_texture::{FloatTexture, SpectrumTexture, TextureContext, Textures};

/// A metal by its complex index.
#[derive(Clone, Debug)]
pub struct Metal {
    /// Real part.
    pub eta: SpectrumTexture,
    /// Imaginary part.
    pub k: SpectrumTexture,
    /// Factor.
    pub tint: SpectrumTexture,
    /// Roughness.
    pub roughness: Roughness,
}

impl Metal {
    pub(super) fn eval(&self, textures: &Textures, at: &TextureContext, lambda: &Wavelengths) -> Conductor {
        Conductor {
            eta: optical_constant(self.eta.eval(textures, at, lambda)),
            k: optical_constant(self.k.eval(textures, at, lambda)),
            tint: albedo(self.tint.eval(textures, at, lambda)),
            microfacet: self.roughness.microfacet(textures, at),
        }
    }
}

/// A thin film.
#[derive(Clone, Copy, Debug)]
pub struct Film {
    /// Thickness in nm.
    pub thickness: FloatTexture,
    /// Index.
    pub eta: FloatTexture,
    /// Meaning of the spectral lanes.
    pub mode: ColorMode,
}

/// Reflectance of facets.
#[derive(Clone, Debug)]
pub enum FacetReflectance {
    /// A dielectric.
    Dielectric(FloatTexture),
    /// A metal; whether by the large-k approximation.
    Conductor(SpectrumTexture, SpectrumTexture, bool),
    /// Schlick's form between two reflectances.
    Schlick(SpectrumTexture, SpectrumTexture),
}

/// Facets over a diffuse part.
#[derive(Clone, Debug)]
pub struct Facets {
    /// `k_d`.
    pub diffuse: SpectrumTexture,
    /// `k_s`.
    pub specular: SpectrumTexture,
    /// Reflectance of the facets.
    pub reflectance: FacetReflectance,
    /// A film on them; not on Schlick's.
    pub film: Option<Film>,
    /// Coupling of the diffuse part to the specular reflection.
    pub coupling: DiffuseCoupling,
    /// Roughness.
    pub roughness: Roughness,
}

impl Facets {
    pub(super) fn eval(&self, textures: &Textures, at: &TextureContext, lambda: &Wavelengths) -> CookTorrance {
        use steradian_math::Spectrum;
        let constant = |t: &SpectrumTexture| optical_constant(t.eval(textures, at, lambda));
        let spectrum = |t: &SpectrumTexture| albedo(t.eval(textures, at, lambda));
        let film = self.film.map(|f| {
            let lambda = (f.mode == ColorMode::Spectral).then_some(lambda.lambda);
            ThinFilm::new(f.eta.eval(textures, at), f.thickness.eval(textures, at), lambda)
        });
        let reflectance = match (&self.reflectance, film) {
            (FacetReflectance::Dielectric(eta), film) => {
                let eta = super::index_of_refraction(eta.eval(textures, at));
                match film {
                    Some(film) => Reflectance::ThinFilm { film, eta: Spectrum::splat(eta), k: Spectrum::ZERO },
                    None => Reflectance::Dielectric(eta),
                }
            }
            (FacetReflectance::Conductor(eta, k, _), Some(film)) => {
                Reflectance::ThinFilm { film, eta: constant(eta), k: constant(k) }
            }
            (FacetReflectance::Conductor(eta, k, true), None) => {
                Reflectance::LargeK { eta: constant(eta), k: constant(k) }
            }
            (FacetReflectance::Conductor(eta, k, false), None) => {
                Reflectance::Conductor { eta: constant(eta), k: constant(k) }
            }
            (FacetReflectance::Schlick(f0, f90), _) => Reflectance::Schlick { f0: spectrum(f0), f90: spectrum(f90) },
        };
        CookTorrance::new(
            spectrum(&self.diffuse),
            spectrum(&self.specular),
            reflectance,
            self.roughness.microfacet(textures, at),
            self.coupling,
        )
    }
}
