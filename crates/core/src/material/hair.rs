//! Hair: what a scene says of a fibre's colour, roughness and scales.

use super::Point;
use steradian_bsdf::{Bsdf, Hair, hair::Offset};
use steradian_math::{
    Spectrum,
    spectra::{ColorMode, role::Color},
};
use steradian_texture::{FloatTexture, SpectrumTexture};

/// Parameters of a fibre.
#[derive(Clone, Debug)]
pub struct HairMaterial {
    /// Absorption that colours the fibre.
    pub absorption: Absorption,
    /// Index of refraction.
    pub eta: FloatTexture,
    /// Roughness along the fibre, in [0.01, 1].
    pub beta_m: FloatTexture,
    /// Roughness around the fibre, in [0.01, 1].
    pub beta_n: FloatTexture,
    /// Tilt of the scales, degrees.
    pub alpha: FloatTexture,
    /// True if the surface is really round and the fibre runs along the bitangent (Mitsuba), rather than a strip along
    /// the tangent.
    pub is_round: bool,
}

/// Absorption in hair.
#[derive(Clone, Debug)]
pub enum Absorption {
    /// σ_a, per radius of the fibre.
    Coefficient(SpectrumTexture),
    /// The colour of a mass of it.
    Color(SpectrumTexture),
    /// Concentrations of eumelanin and pheomelanin, and what one unit of each absorbs.
    Pigments([FloatTexture; 2], [Color; 2]),
}

impl HairMaterial {
    /// The fibre at a point.
    pub(super) fn bsdf(&self, p: &Point<'_>) -> Bsdf<'static> {
        let beta_n = p.float(&self.beta_n);
        let sigma_a = match &self.absorption {
            Absorption::Coefficient(s) => p.unbounded(s),
            Absorption::Color(c) => Hair::sigma_a_of_color(p.albedo(c), beta_n),
            Absorption::Pigments(concentrations, units) => {
                let [e, f] = [0, 1].map(|i| units[i].eval(p.lambda) * p.float(&concentrations[i]).max(0.0));
                e + f
            }
        };
        // The lane that RGB leaves empty has a part in choosing lobes.
        let [r, g, b, last] = sigma_a.to_array();
        let last = if p.textures.mode() == ColorMode::Rgb { (r + g + b) / 3.0 } else { last };
        let sigma_a = Spectrum::new([r, g, b, last]);
        let offset = if self.is_round { Offset::FromNormal } else { Offset::Given(2.0 * p.at.uv.y - 1.0) };
        let (eta, beta_m, alpha) = (p.float(&self.eta), p.float(&self.beta_m), p.float(&self.alpha));
        Bsdf::Hair(Hair::new(offset, sigma_a, eta, beta_m, beta_n, alpha))
    }
}
