//! Compiling materials that light enters to leave elsewhere.

use super::Compiler;
use std::sync::Arc;
use steradian_bsdf::subsurface::{
    Emergence, ProfileTable, WalkAlbedo, dipole, normalized_diffusion, photon_beam_diffusion,
};
use steradian_core::material::{Content, Model, SubsurfaceMaterial, SubsurfaceMethod};
use steradian_math::spectra::role::{Color, Role};
use steradian_scene::{Node, SpectrumValue};
use steradian_texture::{SpectrumTexture, Texture};

/// The methods by name.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub(super) enum MethodName {
    PhotonBeam,
    Dipole,
    NormalizedDiffusion,
    Walk,
}

/// What a profile's table depends on: the method, and the bits of index and mean cosine.
pub(super) type ProfileKey = (MethodName, u32, u32);

const ONE: SpectrumValue = SpectrumValue::Constant(1.0);

impl Compiler<'_> {
    pub(super) fn subsurface(&mut self, node: &Node) -> Model {
        let names = [
            ("random_walk", MethodName::Walk),
            ("photon_beam", MethodName::PhotonBeam),
            ("dipole", MethodName::Dipole),
            ("normalized_diffusion", MethodName::NormalizedDiffusion),
        ];
        let method = self.choice(node, "method", MethodName::Walk, &names);
        // One that is out of range is told, and held within it.
        let emergence = Emergence::new(self.at_sodium_line(node, "eta", 1.33));
        let eta = emergence.eta();
        let g = self.float(node, "g", 0.0).clamp(-0.99, 0.99);
        let scale = self.float(node, "scale", 1.0);
        let (content, local) = self.content(node, scale);
        let roughness = self.roughness(node, "alpha_u", "alpha_v");
        let local = self.add(node, Model::Diffuse(local)).id;
        Model::Subsurface(Box::new(SubsurfaceMaterial {
            reflectance: self.spectrum(node, "specular_reflectance", Role::Albedo, ONE),
            transmittance: self.spectrum(node, "specular_transmittance", Role::Albedo, ONE),
            roughness,
            emergence,
            method: self.subsurface_method(method, eta, g, matches!(content, Content::Albedo(..))),
            content,
            g,
            local,
        }))
    }

    fn subsurface_method(&mut self, method: MethodName, eta: f32, g: f32, is_by_albedo: bool) -> SubsurfaceMethod {
        let mut table = |make: &dyn Fn() -> ProfileTable, g: f32| {
            let key = (method, eta.to_bits(), g.to_bits());
            Arc::clone(self.coats.profiles.entry(key).or_insert_with(|| Arc::new(make())))
        };
        match method {
            MethodName::Walk => {
                let make = || Arc::new(WalkAlbedo::new(Emergence::new(eta), g));
                let key = (eta.to_bits(), g.to_bits());
                SubsurfaceMethod::Walk(
                    is_by_albedo.then(|| Arc::clone(self.coats.walks.entry(key).or_insert_with(make))),
                )
            }
            MethodName::PhotonBeam => SubsurfaceMethod::PhotonBeam(table(&|| photon_beam_diffusion(g, eta), g)),
            MethodName::Dipole => SubsurfaceMethod::Dipole(table(&|| dipole(eta), 0.0)),
            MethodName::NormalizedDiffusion => SubsurfaceMethod::NormalizedDiffusion(table(&normalized_diffusion, 0.0)),
        }
    }

    /// What is below, and the albedo of a diffuse surface that looks like it from afar.
    fn content(&mut self, node: &Node, scale: f32) -> (Content, SpectrumTexture) {
        let has = |name: &str| node.get(name).is_some();
        if has("reflectance") || !has("sigma_s") && !has("sigma_a") {
            self.superseded(node, "reflectance", &["sigma_a", "sigma_s"]);
            let albedo = self.spectrum(node, "reflectance", Role::Albedo, SpectrumValue::Constant(0.7));
            let path = self.spectrum(node, "mfp", Role::Unbounded, ONE);
            return (Content::Albedo(albedo.clone(), self.scaled(node, path, scale)), albedo);
        }
        self.superseded(node, "sigma_a", &["mfp"]);
        let local = self.subsurface_albedo(node);
        let [a, s] = ["sigma_a", "sigma_s"].map(|name| {
            let sigma = self.spectrum(node, name, Role::Unbounded, ONE);
            self.scaled(node, sigma, scale)
        });
        (Content::Coefficients(a, s), local)
    }

    /// A quantity multiplied by a number.
    fn scaled(&mut self, node: &Node, value: SpectrumTexture, scale: f32) -> SpectrumTexture {
        match value {
            _ if scale == 1.0 => value,
            SpectrumTexture::Constant(color) => SpectrumTexture::Constant(color.scaled(scale)),
            SpectrumTexture::Texture(id, role) => {
                let factor = self.textures.add(Texture::Constant(Color::constant(scale)));
                SpectrumTexture::Texture(self.add_texture(node, Texture::Scale(id, factor)), role)
            }
        }
    }
}
