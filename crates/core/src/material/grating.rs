//! Grooves that diffract: what a scene says of them.

use super::{Metal, Wavelengths};
use steradian_bsdf::{Bsdf, Grating, Grooves};
use steradian_texture::{TextureContext, Textures};

/// A diffraction grating.
#[derive(Clone, Debug)]
pub struct GratingMaterial {
    /// Material of the grating; its roughness blurs the orders. A transmitting grating uses its tint.
    pub metal: Metal,
    /// Its grooves, along the tangent.
    pub grooves: Grooves,
}

impl GratingMaterial {
    /// The surface at a point. Without a blur directions depend on the wavelength, so that paths keep the hero alone.
    pub(super) fn bsdf(&self, textures: &Textures, at: &TextureContext<'_>, lambda: &mut Wavelengths) -> Bsdf<'_> {
        let metal = self.metal.eval(textures, at, lambda);
        if metal.microfacet.is_smooth() {
            lambda.terminate_secondary();
        }
        let is_single = lambda.is_secondary_terminated();
        Bsdf::Grating(Grating::new(metal, &self.grooves, lambda.lambda, is_single))
    }
}
