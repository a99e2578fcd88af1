//! Subsurface media: coefficients as a scene gives them, and the approximation by which light is transported.

use super::{Point, Roughness};
use std::sync::Arc;
use steradian_bsdf::{
    Bsdf, Dielectric,
    subsurface::{Emergence, Entry, ProfileTable, SubsurfacePart, WalkAlbedo, deep_albedo, deep_single_scattering},
};
use steradian_math::{Spectrum, spectra::Wavelengths};
use steradian_texture::{FloatTexture, SpectrumTexture, TextureContext, Textures};

/// A material that light enters, to leave it elsewhere on the same object.
#[derive(Clone, Debug)]
pub struct SubsurfaceMaterial {
    /// Factor on reflection.
    pub reflectance: SpectrumTexture,
    /// Factor on what enters.
    pub transmittance: SpectrumTexture,
    /// Roughness of the surface.
    pub roughness: Roughness,
    /// Medium below the surface.
    pub medium: SubsurfaceMedium,
    /// Index of the material that stands in where light is not followed below.
    pub local: u32,
}

/// The part of a layered surface's diffuse base that is a medium.
#[derive(Clone, Debug)]
pub struct SubsurfaceBase {
    /// Weight of the medium.
    pub weight: FloatTexture,
    /// The part of the light that comes back.
    pub color: SpectrumTexture,
    /// Mean cosine of the phase function.
    pub g: f32,
    /// Medium below the surface; `None` if light is not followed there.
    pub medium: Option<SubsurfaceMedium>,
}

impl SubsurfaceBase {
    /// Its parameters at a point.
    pub(super) fn part(&self, p: &Point<'_>) -> SubsurfacePart {
        SubsurfacePart {
            weight: p.float(&self.weight),
            color: p.albedo(&self.color),
            is_followed: self.medium.is_some(),
            g: self.g,
        }
    }
}

/// A medium that light enters, to leave it elsewhere on the same object.
#[derive(Clone, Debug)]
pub struct SubsurfaceMedium {
    /// Model of light that leaves the medium; holds the index of refraction inside over outside.
    pub emergence: Emergence,
    /// The boundary as light meets it from within: the same, or one that reflects nothing where the content is what
    /// comes back without a boundary.
    pub within: Emergence,
    /// Optical properties of the medium.
    pub content: Content,
    /// Mean cosine of its phase function.
    pub g: f32,
    /// Method of light transport in the medium.
    pub method: SubsurfaceMethod,
}

/// Optical properties of a medium below a surface.
#[derive(Clone, Debug)]
pub enum Content {
    /// By its coefficients of absorption and scattering, in 1/length.
    Coefficients(SpectrumTexture, SpectrumTexture),
    /// By the part of the light that comes back, and the mean free path, a length.
    Albedo(SpectrumTexture, SpectrumTexture),
}

/// Method of light transport in a medium below a surface.
#[derive(Clone, Debug)]
pub enum SubsurfaceMethod {
    /// A profile by the albedo of single scattering and distances in mean free paths.
    PhotonBeam(Arc<ProfileTable>),
    /// A profile by the reduced albedo and distances in reduced mean free paths.
    Dipole(Arc<ProfileTable>),
    /// A profile by the albedo of the surface and distances in reduced mean free paths.
    NormalizedDiffusion(Arc<ProfileTable>),
    /// Random walks, and how much they bring back, where the medium is given by that.
    Walk(Option<Arc<WalkAlbedo>>),
}

/// Subsurface medium at a point of a surface.
#[derive(Clone, Copy, Debug)]
pub struct Below<'a> {
    /// Extinction by lanes, 1/length: for profiles the inverse of the length that their table counts in.
    pub sigma_t: Spectrum,
    /// Albedo by lanes: of single scattering, or what the table goes by.
    pub albedo: Spectrum,
    /// The profile; `None` for random walks.
    pub table: Option<&'a ProfileTable>,
}

/// Mean free paths are held above this, so that coefficients stay finite.
const SHORTEST: f32 = 1e-8;

impl SubsurfaceMaterial {
    /// The surface at a point.
    pub(super) fn bsdf(&self, p: &Point<'_>) -> Bsdf<'static> {
        let interface = Dielectric {
            reflectance: p.albedo(&self.reflectance),
            transmittance: p.albedo(&self.transmittance),
            eta: self.medium.emergence.eta(),
            microfacet: self.roughness.microfacet(p.textures, p.at),
        };
        Bsdf::Subsurface(Entry { interface })
    }
}

impl SubsurfaceMedium {
    /// Subsurface medium at a point.
    pub fn below(&self, textures: &Textures, at: &TextureContext<'_>, lambda: &Wavelengths) -> Below<'_> {
        let p = Point { textures, at, lambda };
        let (table, is_reduced) = match &self.method {
            SubsurfaceMethod::PhotonBeam(table) => (Some(&**table), false),
            SubsurfaceMethod::Dipole(table) | SubsurfaceMethod::NormalizedDiffusion(table) => (Some(&**table), true),
            SubsurfaceMethod::Walk(_) => (None, false),
        };
        let by_surface = matches!(self.method, SubsurfaceMethod::NormalizedDiffusion(_));
        // Scattering counts by 1 − g where forward scattering is taken for none.
        let kept = if is_reduced { 1.0 - self.g } else { 1.0 };
        let (sigma_t, albedo) = match &self.content {
            Content::Coefficients(absorption, scattering) => {
                let (a, s) = (p.unbounded(absorption), p.unbounded(scattering) * kept);
                let albedo = ratio(s, a + s);
                // Of what comes back to the surface a part is sent down again.
                let k = self.within.diffuse_reflected_within();
                let by_boundary = |a: f32| (1.0 - k) * a / (1.0 - k * a);
                (a + s, if by_surface { albedo.map(|a| by_boundary(deep_albedo(a))) } else { albedo })
            }
            Content::Albedo(albedo, path) => {
                let albedo = p.albedo(albedo);
                let sigma_t = p.unbounded(path).map(|l| 1.0 / l.max(SHORTEST));
                let single = |a| match &self.method {
                    SubsurfaceMethod::NormalizedDiffusion(_) => a,
                    SubsurfaceMethod::PhotonBeam(table) | SubsurfaceMethod::Dipole(table) => {
                        table.single_scattering_albedo(a)
                    }
                    SubsurfaceMethod::Walk(Some(walks)) => walks.single_scattering(a),
                    SubsurfaceMethod::Walk(None) => deep_single_scattering(a),
                };
                let found = albedo.map(single);
                if !is_reduced {
                    return Below { sigma_t, albedo: found, table };
                }
                // σ_t' = σ_t (1 − a g), where a/(1 − a) is (a'/(1 − a'))/(1 − g).
                let reduced = if by_surface { albedo.map(deep_single_scattering) } else { found };
                let whole = reduced.map(|a| a / (a + (1.0 - a) * kept).max(f32::MIN_POSITIVE));
                (sigma_t * whole.map(|a| 1.0 - a * self.g), found)
            }
        };
        Below { sigma_t, albedo, table }
    }
}

fn ratio(a: Spectrum, b: Spectrum) -> Spectrum {
    let (a, b) = (a.to_array(), b.to_array());
    Spectrum::new(std::array::from_fn(|i| if b[i] > 0.0 { (a[i] / b[i]).min(1.0) } else { 0.0 }))
}
