//! Disney's surface: what a scene says of it.

use super::Point;
use crate::{
    bsdf::{Bsdf, Principled, PrincipledThin, principled::PrincipledParams},
    texture::{FloatTexture, SpectrumTexture},
};
use steradian_math::{Spectrum, Vec2};

/// Parameters of Disney's surface, in [0, 1] but for `eta` and `diff_trans`.
#[derive(Clone, Debug)]
pub struct PrincipledMaterial {
    /// Base colour.
    pub base_color: SpectrumTexture,
    /// Roughness.
    pub roughness: FloatTexture,
    /// Stretch of the highlight.
    pub anisotropic: FloatTexture,
    /// Metal.
    pub metallic: FloatTexture,
    /// Specular transmission.
    pub spec_trans: FloatTexture,
    /// Index of refraction.
    pub eta: FloatTexture,
    /// Tint of the highlight.
    pub spec_tint: FloatTexture,
    /// Sheen.
    pub sheen: FloatTexture,
    /// Tint of the sheen.
    pub sheen_tint: FloatTexture,
    /// Flatness of the diffuse part.
    pub flatness: FloatTexture,
    /// Clear coat.
    pub clearcoat: FloatTexture,
    /// Gloss of the clear coat.
    pub clearcoat_gloss: FloatTexture,
    /// For a thin sheet, the diffuse transmission in [0, 2].
    pub thin: Option<FloatTexture>,
}

impl PrincipledMaterial {
    /// The surface at a point.
    pub(super) fn bsdf(&self, p: &Point<'_>) -> Bsdf<'static> {
        let base_color = p.albedo(&self.base_color);
        let luminance = p.luminance(base_color);
        // One roughness for both axes: that of the mean square slope.
        let r = p.float(&self.roughness);
        let (x, y) = p.at.roughened(r * r, r * r);
        let params = PrincipledParams {
            base_color,
            tint: if luminance > 1e-6 { base_color / luminance } else { Spectrum::ONE },
            roughness: if p.at.slopes == Vec2::ZERO { r } else { (0.5 * (x * x + y * y)).sqrt().sqrt().min(1.0) },
            anisotropic: p.float(&self.anisotropic),
            metallic: p.float(&self.metallic),
            spec_trans: p.float(&self.spec_trans),
            eta: p.float(&self.eta),
            spec_tint: p.float(&self.spec_tint),
            sheen: p.float(&self.sheen),
            sheen_tint: p.float(&self.sheen_tint),
            flatness: p.float(&self.flatness),
            clearcoat: p.float(&self.clearcoat),
            clearcoat_gloss: p.float(&self.clearcoat_gloss),
        };
        match &self.thin {
            Some(diff_trans) => Bsdf::PrincipledThin(PrincipledThin::new(&params, p.float(diff_trans))),
            None => Bsdf::Principled(Principled::new(&params)),
        }
    }
}
