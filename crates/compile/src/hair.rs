//! Compiling hair.

use super::Compiler;
use steradian_bsdf::hair::{EUMELANIN, PHEOMELANIN};
use steradian_core::material::{Absorption, HairMaterial, Model};
use steradian_math::{
    Vec3,
    color::space::REC709,
    spectra::role::{Color, Role},
};
use steradian_scene::{Node, SpectrumValue};
use steradian_texture::{FloatTexture, SpectrumTexture};

impl Compiler<'_> {
    pub(super) fn hair(&mut self, node: &Node) -> Model {
        let one = SpectrumValue::Constant(1.0);
        let color = if node.get("reflectance").is_some() { "reflectance" } else { "color" };
        let absorption = if node.get("sigma_a").is_some() {
            self.superseded(node, "sigma_a", &["reflectance", "color", "eumelanin", "pheomelanin"]);
            Absorption::Coefficient(self.spectrum_or(node, "sigma_a", Role::Unbounded, one))
        } else if node.get(color).is_some() {
            self.superseded(node, color, &["eumelanin", "pheomelanin"]);
            Absorption::Color(self.spectrum_or(node, color, Role::Albedo, one))
        } else {
            self.pigments(node)
        };
        Model::Hair(Box::new(HairMaterial {
            absorption,
            eta: self.float_texture(node, "eta"),
            beta_m: self.float_texture(node, "beta_m"),
            beta_n: self.float_texture(node, "beta_n"),
            alpha: self.float_texture(node, "alpha"),
            is_round: self.bool(node, "round"),
        }))
    }

    fn pigments(&mut self, node: &Node) -> Absorption {
        let neither = node.get("eumelanin").is_none() && node.get("pheomelanin").is_none();
        let concentrations = [
            self.float_texture_or(node, "eumelanin", if neither { 1.3 } else { 0.0 }),
            self.float_texture(node, "pheomelanin"),
        ];
        let units = [EUMELANIN, PHEOMELANIN].map(Vec3::from);
        let mode = self.mode;
        let color = |rgb| Color::rgb(rgb, &REC709, Role::Unbounded, mode);
        match concentrations {
            [FloatTexture::Constant(e), FloatTexture::Constant(p)] => {
                let sigma_a = units[0] * e.max(0.0) + units[1] * p.max(0.0);
                Absorption::Coefficient(SpectrumTexture::Constant(color(sigma_a)))
            }
            textured => Absorption::Pigments(textured, units.map(color)),
        }
    }

    /// Reports parameters that another one leaves without effect.
    pub(super) fn superseded(&mut self, node: &Node, by: &str, names: &[&str]) {
        for name in names {
            if let Some(p) = node.param(name) {
                let what = format!("'{name}' of {} '{}' has no effect beside '{by}'", node.family.noun(), node.kind);
                self.diagnostics.unused(&self.desc.sources, p.span.or(node.span), what, None);
            }
        }
    }
}
