//! Compiling coats that need random walks.

use super::Compiler;
use steradian_core::material::{LayeredBase, LayeredMaterial, Model};
use steradian_math::spectra::role::Role;
use steradian_scene::{Node, SpectrumValue, Value};
use steradian_texture::SpectrumTexture;

impl Compiler<'_> {
    /// pbrt's `coatedconductor`.
    pub(super) fn coated_conductor(&mut self, node: &Node) -> Model {
        let metal = self.roughness(node, "conductor.uroughness", "conductor.vroughness");
        let base = if node.get("reflectance").is_some() {
            let reflectance = self.spectrum_or(node, "reflectance", Role::Albedo, SpectrumValue::Constant(1.0));
            LayeredBase::ConductorReflectance(reflectance, metal)
        } else {
            let copper = |part: &str| SpectrumValue::Named(format!("metal-Cu-{part}"));
            LayeredBase::Conductor(
                self.spectrum_or(node, "conductor.eta", Role::Index, copper("eta")),
                self.spectrum_or(node, "conductor.k", Role::Index, copper("k")),
                metal,
            )
        };
        self.layered(node, "interface.eta", ["interface.uroughness", "interface.vroughness"], base)
    }

    /// A coat over `base`.
    pub(super) fn layered(&mut self, node: &Node, eta: &str, [u, v]: [&str; 2], base: LayeredBase) -> Model {
        let thickness = self.float_texture(node, "thickness");
        let g = self.float_texture(node, "g");
        Model::Layered(Box::new(LayeredMaterial {
            eta: self.eta_named(node, eta),
            coat: self.roughness(node, u, v),
            base,
            thickness,
            albedo: self.spectrum(node, "albedo", Role::Albedo),
            g,
            max_depth: self.count(node, "max_depth"),
            samples: self.count(node, "samples").max(1),
        }))
    }

    /// A whole number that a loop runs to, held below a thousand.
    fn count(&mut self, node: &Node, name: &str) -> u16 {
        let v = self.int(node, name);
        let span = node.param(name).and_then(|p| p.span).or(node.span);
        if v > 1000 {
            self.approximated(span, format!("'{name}' is {v}; at most 1000 is used"));
        }
        v.clamp(0, 1000) as u16
    }

    /// True if the medium of a coat scatters, so that there is no closed form.
    pub(super) fn coat_scatters(node: &Node) -> bool {
        match node.get("albedo") {
            None => false,
            Some(Value::Float(v)) => *v != 0.0,
            Some(Value::Int(v)) => *v != 0,
            Some(Value::Spectrum(SpectrumValue::Constant(v))) => *v != 0.0,
            Some(Value::Spectrum(SpectrumValue::Rgb(v, _))) => *v != [0.0; 3],
            Some(_) => true,
        }
    }

    /// A coat over a diffuse base whose medium scatters, or whose thickness varies.
    pub(super) fn layered_diffuse(&mut self, node: &Node) -> Model {
        let base: SpectrumTexture = self.spectrum(node, "reflectance", Role::Albedo);
        if let Some(p) = node.param("specular_reflectance") {
            let what = "'specular_reflectance' has no meaning for a coat with a medium in it; it is left out";
            self.approximated(p.span.or(node.span), what);
        }
        self.layered(node, "eta", ["alpha_u", "alpha_v"], LayeredBase::Diffuse(base))
    }
}
