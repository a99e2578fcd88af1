//! The surface of glTF and OpenPBR: what a scene says of it.

use super::{Eta, Point, SubsurfaceBase, albedo};
pub use steradian_bsdf::pbr::Convention;
use steradian_bsdf::{Bsdf, Microfacet, Pbr, ThinFilm, pbr::PbrParams, subsurface::SubsurfacePart};
use steradian_math::{
    Spectrum,
    spectra::{ColorMode, Wavelengths},
};
use steradian_texture::{FloatTexture, SpectrumTexture, TextureContext, Textures};

/// α along and across of a roughness and an anisotropy `a`.
///
/// ```text
/// α_t = α + (1 − α) a²,               α_b = α           KHR_materials_anisotropy
/// α_t = α √(2/(1 + (1−a)²)),          α_b = (1−a) α_t   OpenPBR 1.1, 3.1.1
/// ```
fn alphas(convention: Convention, roughness: f32, anisotropy: f32) -> (f32, f32) {
    let (r, a) = (roughness.clamp(0.0, 1.0), anisotropy.clamp(0.0, 1.0));
    let alpha = r * r;
    match convention {
        _ if a == 0.0 => (alpha, alpha),
        Convention::Gltf => (alpha + (1.0 - alpha) * a * a, alpha),
        Convention::OpenPbr => {
            let x = alpha * (2.0 / (1.0 + (1.0 - a) * (1.0 - a))).sqrt();
            (x, (1.0 - a) * x)
        }
    }
}

/// Parameters of the surface; colours and weights in [0, 1].
#[derive(Clone, Debug)]
pub struct PbrMaterial {
    /// Base colour.
    pub base_color: SpectrumTexture,
    /// Factor on the base colour.
    pub base_weight: FloatTexture,
    /// Roughness of the diffuse base.
    pub diffuse_roughness: FloatTexture,
    /// Weight of the metal.
    pub metallic: FloatTexture,
    /// Roughness; α is its square.
    pub roughness: FloatTexture,
    /// Strength of the anisotropy.
    pub anisotropy: FloatTexture,
    /// Specification that the parameters are of.
    pub convention: Convention,
    /// Index of refraction.
    pub eta: Eta,
    /// Strength of the dielectric reflection.
    pub specular: FloatTexture,
    /// Its tint.
    pub specular_color: SpectrumTexture,
    /// Refraction.
    pub transmission: FloatTexture,
    /// Tint of what is refracted; the base colour where it is `None`.
    pub transmission_color: Option<SpectrumTexture>,
    /// True for a thin wall, which light passes unbent.
    pub thin: bool,
    /// Diffuse transmission.
    pub diffuse_transmission: FloatTexture,
    /// Its colour.
    pub diffuse_transmission_color: SpectrumTexture,
    /// Colour of the sheen.
    pub sheen_color: SpectrumTexture,
    /// Factor on it.
    pub sheen_weight: FloatTexture,
    /// Roughness of the sheen.
    pub sheen_roughness: FloatTexture,
    /// Clear coat.
    pub coat: FloatTexture,
    /// Its roughness; α is its square.
    pub coat_roughness: FloatTexture,
    /// Strength of its anisotropy.
    pub coat_anisotropy: FloatTexture,
    /// Strength of the darkening below it.
    pub coat_darkening: FloatTexture,
    /// Its index of refraction.
    pub coat_eta: FloatTexture,
    /// Transmittance of the coat.
    pub coat_color: SpectrumTexture,
    /// A film over the base: how much of it, its thickness (nm) and index.
    pub film: Option<[FloatTexture; 3]>,
    /// Subsurface medium within the diffuse base.
    pub subsurface: Option<SubsurfaceBase>,
}

impl PbrMaterial {
    fn facets(&self, p: &Point<'_>) -> Microfacet {
        let (x, y) = alphas(self.convention, p.float(&self.roughness), p.float(&self.anisotropy));
        let (x, y) = p.at.roughened(x, y);
        Microfacet::ggx(x, y)
    }

    /// The surface at a point; `coat_at` is where the roughness of the coat is looked up.
    pub(super) fn bsdf(
        &self,
        textures: &Textures,
        at: &TextureContext,
        coat_at: &TextureContext,
        lambda: &mut Wavelengths,
    ) -> Bsdf<'static> {
        // Dispersion ends the other wavelengths only where light is refracted.
        let refracts = !self.thin && self.transmission.eval(textures, at) > 0.0;
        let eta = match &self.eta {
            Eta::Dispersive(color) if !refracts => color.eval(lambda)[0],
            eta => eta.eval(textures, at, lambda),
        };
        let p = Point { textures, at, lambda };
        let base_color = p.albedo(&self.base_color) * p.float(&self.base_weight).clamp(0.0, 1.0);
        let (coat_x, coat_y) = alphas(self.convention, p.float(&self.coat_roughness), p.float(&self.coat_anisotropy));
        let (coat_x, coat_y) = coat_at.roughened(coat_x, coat_y);
        let sheen: Spectrum = albedo(p.albedo(&self.sheen_color) * p.float(&self.sheen_weight));
        let lanes = (textures.mode() == ColorMode::Spectral).then_some(lambda.lambda);
        let [film_weight, thickness, film_eta] =
            self.film.as_ref().map_or([0.0, 0.0, 1.0], |f| f.each_ref().map(|t| p.float(t)));
        Bsdf::Pbr(Pbr::new(&PbrParams {
            film: ThinFilm::new(film_eta, thickness, lanes),
            film_weight,
            base_color,
            diffuse_roughness: p.float(&self.diffuse_roughness),
            metallic: p.float(&self.metallic),
            facets: self.facets(&p),
            eta,
            specular: p.float(&self.specular),
            specular_color: p.unbounded(&self.specular_color),
            transmission: p.float(&self.transmission),
            transmission_color: self.transmission_color.as_ref().map_or(base_color, |t| p.albedo(t)),
            thin: self.thin,
            diffuse_transmission: p.float(&self.diffuse_transmission),
            diffuse_transmission_color: p.albedo(&self.diffuse_transmission_color),
            sheen_color: sheen,
            sheen_roughness: p.float(&self.sheen_roughness),
            coat: p.float(&self.coat),
            coat_facets: Microfacet::ggx(coat_x, coat_y),
            coat_eta: p.float(&self.coat_eta),
            coat_color: p.albedo(&self.coat_color),
            coat_darkening: p.float(&self.coat_darkening),
            convention: self.convention,
            subsurface: self.subsurface.as_ref().map_or(SubsurfacePart::NONE, |s| s.part(&p)),
        }))
    }
}
