//! Disney's surface: what a scene says of it.

use super::{Point, SubsurfaceBase};
use steradian_bsdf::{Bsdf, Principled, PrincipledThin, principled::PrincipledParams, subsurface::SubsurfacePart};
use steradian_math::{Spectrum, Vec2, color::luminance};
use steradian_texture::{FloatTexture, SpectrumTexture};

/// Parameters of Disney's surface, in [0, 1] but for `eta` and `diff_trans`.
#[derive(Clone, Debug)]
pub struct PrincipledMaterial {
    /// Base colour.
    pub base_color: SpectrumTexture,
    /// Luminance of the base colour under D65, where that is the same everywhere.
    pub luminance: Option<f32>,
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
    /// Subsurface medium within the diffuse part.
    pub subsurface: Option<SubsurfaceBase>,
}

impl PrincipledMaterial {
    /// The surface at a point.
    pub(super) fn bsdf(&self, p: &Point<'_>) -> Bsdf<'static> {
        let base_color = p.albedo(&self.base_color);
        let (spec_tint, sheen_tint) = (p.float(&self.spec_tint), p.float(&self.sheen_tint));
        let luminance = match (self.luminance, &self.base_color) {
            _ if spec_tint <= 0.0 && sheen_tint <= 0.0 => 0.0,
            (None, SpectrumTexture::Texture(id, _)) => luminance(p.textures.rgb(*id, p.at)),
            (known, _) => known.unwrap_or(0.0),
        };
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
            spec_tint,
            sheen: p.float(&self.sheen),
            sheen_tint,
            flatness: p.float(&self.flatness),
            clearcoat: p.float(&self.clearcoat),
            clearcoat_gloss: p.float(&self.clearcoat_gloss),
            subsurface: self.subsurface.as_ref().map_or(SubsurfacePart::NONE, |s| s.part(p)),
        };
        match &self.thin {
            Some(diff_trans) => Bsdf::PrincipledThin(PrincipledThin::new(&params, p.float(diff_trans))),
            None => Bsdf::Principled(Principled::new(&params)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use steradian_bsdf::TransportMode;
    use steradian_math::{
        Vec3,
        color::space::REC709,
        spectra::{
            ColorMode, Wavelengths,
            role::{Color, Role},
        },
    };
    use steradian_texture::{Texture, TextureContext, Textures};

    /// The hue of tints is the base colour over its luminance, the same at all wavelengths that a path may have drawn:
    /// a tinted highlight seen in spectral mode has, in the mean, the colour that it has in RGB mode.
    #[test]
    fn tints_do_not_depend_on_the_wavelengths_drawn() {
        let rgb = Vec3::new(0.7, 0.3, 0.1);
        let luminance = luminance(rgb);
        let number = |v: f32| FloatTexture::Constant(v);
        for is_textured in [false, true] {
            let mut textures = Textures::new(ColorMode::Spectral);
            let color = Color::rgb(rgb, &REC709, Role::Albedo, ColorMode::Spectral);
            let id = textures.add(Texture::Constant(color.clone()));
            let material = PrincipledMaterial {
                base_color: if is_textured {
                    SpectrumTexture::Texture(id, Role::Albedo)
                } else {
                    SpectrumTexture::Constant(color.clone())
                },
                luminance: (!is_textured).then_some(luminance),
                roughness: number(0.5),
                anisotropic: number(0.0),
                metallic: number(0.0),
                spec_trans: number(0.0),
                eta: number(1.5),
                spec_tint: number(1.0),
                sheen: number(0.0),
                sheen_tint: number(0.0),
                flatness: number(0.0),
                clearcoat: number(0.0),
                clearcoat_gloss: number(0.0),
                thin: None,
                subsurface: None,
            };
            let at = TextureContext::new(Vec3::ZERO, Vec2::ZERO);
            for k in 0..20 {
                let lambda = Wavelengths::sample_visible((k as f32 + 0.5) / 20.0);
                let bsdf = material.bsdf(&Point { textures: &textures, at: &at, lambda: &lambda });
                let plain = PrincipledMaterial { spec_tint: number(0.0), ..material.clone() };
                let plain = plain.bsdf(&Point { textures: &textures, at: &at, lambda: &lambda });
                let value = |b: &Bsdf<'_>| b.eval(Vec3::Z, Vec3::Z, TransportMode::Radiance).value;
                // Of 4 % at normal incidence the tint makes 4 % times the base over its luminance.
                let (added, base) = (value(&bsdf) - value(&plain), color.eval(&lambda));
                let highlight = 0.04 / (std::f32::consts::PI * 0.25f32.powi(2) * 4.0);
                for lane in 0..4 {
                    let expected = highlight * (base[lane] / luminance - 1.0);
                    assert!((added[lane] - expected).abs() < 2e-3 * highlight, "{} {expected}", added[lane]);
                }
            }
        }
    }
}
