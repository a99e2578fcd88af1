//! Coats by random walks: what a scene says of the layers.

use super::{Eta, Point, Roughness, albedo, optical_constant};
use steradian_bsdf::{
    Bsdf, Conductor, Diffuse, Layered,
    layered::{Base, Walk},
};
use steradian_math::{Spectrum, spectra::Wavelengths};
use steradian_texture::{FloatTexture, SpectrumTexture, TextureContext, Textures};

/// A dielectric coat, a medium, and what is under them.
#[derive(Clone, Debug)]
pub struct LayeredMaterial {
    /// Index of refraction of the coat.
    pub eta: Eta,
    /// Roughness of the coat.
    pub coat: Roughness,
    /// Base under the coat.
    pub base: LayeredBase,
    /// Optical depth of the medium.
    pub thickness: FloatTexture,
    /// Single-scattering albedo of the medium.
    pub albedo: SpectrumTexture,
    /// Mean cosine of its phase function.
    pub g: FloatTexture,
    /// Most events of a walk.
    pub max_depth: u16,
    /// Walks for each evaluation.
    pub samples: u16,
}

/// Base under a coat.
#[derive(Clone, Debug)]
pub enum LayeredBase {
    /// A metal by η and k in vacuum.
    Conductor(SpectrumTexture, SpectrumTexture, Roughness),
    /// A metal by its reflectance.
    ConductorReflectance(SpectrumTexture, Roughness),
    /// Lambert.
    Diffuse(SpectrumTexture),
}

impl LayeredMaterial {
    /// The surface at a point.
    pub(super) fn bsdf(&self, textures: &Textures, at: &TextureContext, lambda: &mut Wavelengths) -> Bsdf<'static> {
        let eta = self.eta.eval(textures, at, lambda);
        let p = Point { textures, at, lambda };
        let spectrum = |t: &SpectrumTexture| t.eval(textures, at, p.lambda);
        // pbrt divides the made-up constants of a reflectance by the coat's index too.
        let inside = |v: Spectrum| optical_constant(v) / eta;
        let base = match &self.base {
            LayeredBase::Conductor(n, k, roughness) => Base::Conductor(Conductor {
                eta: inside(spectrum(n)),
                k: inside(spectrum(k)),
                tint: Spectrum::ONE,
                microfacet: roughness.microfacet(textures, at),
            }),
            LayeredBase::ConductorReflectance(r, roughness) => {
                let c = Conductor::from_reflectance(albedo(spectrum(r)), roughness.microfacet(textures, at));
                Base::Conductor(Conductor { eta: inside(c.eta), k: inside(c.k), ..c })
            }
            LayeredBase::Diffuse(r) => Base::Diffuse(Diffuse { reflectance: p.albedo(r) }),
        };
        let walk = Walk {
            thickness: p.float(&self.thickness),
            albedo: p.albedo(&self.albedo),
            g: p.float(&self.g),
            max_depth: self.max_depth,
            samples: self.samples,
        };
        Bsdf::Layered(Layered::new(eta, self.coat.microfacet(textures, at), base, &walk))
    }
}
