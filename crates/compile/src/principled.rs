//! Compiling Disney's surface.

use super::{Compiler, subsurface::BaseSaid};
use steradian_core::material::{Model, PrincipledMaterial, SubsurfaceBase};
use steradian_math::spectra::{
    ColorMode,
    role::{Color, Role},
};
use steradian_scene::{Format, Node, SpectrumValue, Value};
use steradian_texture::{FloatTexture, SpectrumTexture};

impl Compiler<'_> {
    pub(super) fn principled(&mut self, node: &Node, is_thin: bool) -> Model {
        let weight = |c: &mut Self, name: &str| {
            if !is_thin || !matches!(name, "metallic" | "clearcoat" | "clearcoat_gloss") {
                c.float_texture(node, name)
            } else {
                FloatTexture::Constant(0.0)
            }
        };
        let is_tinted = |name: &str| node.get(name).is_some_and(|v| !matches!(v, Value::Float(0.0)));
        if self.mode == ColorMode::Spectral
            && self.desc.format == Format::Mitsuba
            && (is_tinted("spec_tint") || (is_tinted("sheen") && is_tinted("sheen_tint")))
        {
            let what = "tints are relative to the luminance of 'base_color'; in its spectral mode Mitsuba takes what \
                        the four wavelengths of a sample happen to have";
            self.diagnostics.note(&self.desc.sources, node.span, what);
        }
        let roughness = weight(self, "roughness");
        let [anisotropic, metallic, spec_trans, spec_tint, sheen, sheen_tint, flatness, clearcoat, clearcoat_gloss] = [
            "anisotropic",
            "metallic",
            "spec_trans",
            "spec_tint",
            "sheen",
            "sheen_tint",
            "flatness",
            "clearcoat",
            "clearcoat_gloss",
        ]
        .map(|name| weight(self, name));
        let base_color = self.spectrum(node, "base_color", Role::Albedo);
        let luminance = match &base_color {
            SpectrumTexture::Constant(Color::Spectral(curve)) => {
                Some(Color::curve(curve, Role::Albedo, ColorMode::Rgb).luminance(ColorMode::Rgb))
            }
            SpectrumTexture::Constant(lanes) => Some(lanes.luminance(self.mode)),
            SpectrumTexture::Texture(..) => None,
        };
        let eta = self.principled_eta(node, is_thin);
        Model::Principled(Box::new(PrincipledMaterial {
            subsurface: if is_thin { None } else { self.principled_subsurface(node, &base_color, eta) },
            base_color,
            luminance,
            eta,
            thin: is_thin.then(|| self.float_texture(node, "diff_trans")),
            roughness,
            anisotropic,
            metallic,
            spec_trans,
            spec_tint,
            sheen,
            sheen_tint,
            flatness,
            clearcoat,
            clearcoat_gloss,
        }))
    }

    /// The medium that the diffuse part is, by the names and defaults of Blender's node; it has the base's colour.
    fn principled_subsurface(
        &mut self,
        node: &Node,
        base: &SpectrumTexture,
        eta: FloatTexture,
    ) -> Option<SubsurfaceBase> {
        let path = self.spectrum(node, "subsurface_radius", Role::Unbounded);
        let scale = self.float_texture(node, "subsurface_scale");
        let has_color = node.get("subsurface_color").is_some();
        let color = self.spectrum_or(node, "subsurface_color", Role::Albedo, SpectrumValue::Constant(0.5));
        let said = BaseSaid {
            weight: self.float_texture(node, "subsurface"),
            color: if has_color { color } else { base.clone() },
            path: self.scaled(node, path, scale),
            g: self.float(node, "subsurface_anisotropy"),
            method: self.method_named(node, "subsurface_method"),
        };
        let eta = if let FloatTexture::Constant(eta) = eta { eta } else { 1.5 };
        self.subsurface_base(said, Some(eta))
    }

    /// `eta`, or Disney's `specular`, which spans reflectances from 0 to 8 %.
    fn principled_eta(&mut self, node: &Node, is_thin: bool) -> FloatTexture {
        if node.get("eta").is_some() || is_thin {
            return self.float_texture(node, "eta");
        }
        let FloatTexture::Constant(specular) = self.float_texture(node, "specular") else {
            self.approximated(node.span, "'specular' cannot be textured here; 0.5 is used");
            return FloatTexture::Constant(1.5);
        };
        FloatTexture::Constant(2.0 / (1.0 - (0.08 * specular.clamp(0.0, 1.0)).sqrt()) - 1.0)
    }
}
