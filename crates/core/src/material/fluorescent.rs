//! Matter that gives light back at other wavelengths.

use super::Point;
use std::sync::Arc;
use steradian_bsdf::{Bsdf, Diffuse};
use steradian_math::spectra::{Reradiation, Wavelengths};
use steradian_texture::{SpectrumTexture, TextureContext, Textures};

/// A diffuse surface of which part of the light leaves at other wavelengths.
#[derive(Clone, Debug)]
pub struct FluorescentMaterial {
    /// Albedo without fluorescence.
    pub reflectance: SpectrumTexture,
    /// Reradiation: light emitted at each wavelength per light absorbed at each.
    pub reradiation: Arc<Reradiation>,
    /// Mean time for which light that leaves at other wavelengths is held back, s.
    pub lifetime: f32,
    /// Index of the material that stands in where wavelengths are not changed.
    pub local: u32,
}

impl FluorescentMaterial {
    /// The surface at a point: by chance one that keeps wavelengths, or one that changes them, each as much brighter as
    /// it is rarer, and for how long that holds light back. Paths come from the eye, so that `lambda` becomes what the
    /// light comes with.
    pub(super) fn bsdf(
        &self,
        textures: &Textures,
        at: &TextureContext<'_>,
        choice: f32,
        lambda: &mut Wavelengths,
        lifetime: &mut f32,
    ) -> Bsdf<'static> {
        let reflectance = Point { textures, at, lambda }.albedo(&self.reflectance);
        let live = |lane: &usize| lambda.pdf[*lane] > 0.0;
        let sum = |of: &dyn Fn(usize) -> f32| (0..4).filter(live).map(of).sum::<f32>();
        let (plain, shifted) = (sum(&|k| reflectance[k]), sum(&|k| self.reradiation.total(lambda.lambda[k])));
        // Neither is left out where it is the lesser part.
        let p = if shifted <= 0.0 { 0.0 } else { (shifted / (plain + shifted)).clamp(0.05, 0.95) };
        if choice >= p {
            return Bsdf::Diffuse(Diffuse { reflectance: reflectance / (1.0 - p) });
        }
        *lifetime = self.lifetime;
        Bsdf::Diffuse(Diffuse { reflectance: self.reradiation.shift(lambda, choice / p) / p })
    }
}
