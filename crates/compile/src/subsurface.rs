//! Compiling materials that light enters to leave elsewhere.

use super::Compiler;
use std::sync::Arc;
use steradian_bsdf::subsurface::{
    Emergence, ProfileTable, WalkAlbedo, dipole, normalized_diffusion, photon_beam_diffusion,
};
use steradian_core::material::{
    Content, Model, SubsurfaceBase, SubsurfaceMaterial, SubsurfaceMedium, SubsurfaceMethod,
};
use steradian_math::spectra::role::{Color, Role};
use steradian_scene::{Node, SpectrumValue};
use steradian_texture::{FloatTexture, SpectrumTexture, Texture};

/// The methods by name.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub(super) enum MethodName {
    PhotonBeam,
    Dipole,
    NormalizedDiffusion,
    Walk,
}

/// Key of a profile's table: the method, and the bits of index and mean cosine.
pub(super) type ProfileKey = (MethodName, u32, u32);

const ONE: SpectrumValue = SpectrumValue::Constant(1.0);

/// The methods by the words that scenes have for them.
const METHODS: [(&str, MethodName); 4] = [
    ("random_walk", MethodName::Walk),
    ("photon_beam", MethodName::PhotonBeam),
    ("dipole", MethodName::Dipole),
    ("normalized_diffusion", MethodName::NormalizedDiffusion),
];

/// Parameters of a layered surface for the medium that its diffuse base is.
pub(super) struct BaseSaid {
    /// Share of the medium in the base.
    pub weight: FloatTexture,
    /// The part of the light that comes back.
    pub color: SpectrumTexture,
    /// Mean free path.
    pub path: SpectrumTexture,
    /// Mean cosine of the phase function.
    pub g: f32,
    /// Method of subsurface scattering.
    pub method: MethodName,
}

impl Compiler<'_> {
    pub(super) fn subsurface(&mut self, node: &Node) -> Model {
        let method = self.method_named(node, "method");
        // One that is out of range is told, and held within it.
        let emergence = Emergence::new(self.at_sodium_line(node, "eta"));
        let eta = emergence.eta();
        let g = self.float(node, "g").clamp(-0.99, 0.99);
        let scale = self.float(node, "scale");
        let (content, local) = self.content(node, scale);
        let roughness = self.roughness(node, "alpha_u", "alpha_v");
        let local = self.add(node, Model::Diffuse(local)).id;
        Model::Subsurface(Box::new(SubsurfaceMaterial {
            reflectance: self.spectrum(node, "specular_reflectance", Role::Albedo),
            transmittance: self.spectrum(node, "specular_transmittance", Role::Albedo),
            roughness,
            medium: SubsurfaceMedium {
                emergence,
                within: emergence,
                method: self.subsurface_method(method, eta, g, matches!(content, Content::Albedo(..))),
                content,
                g,
            },
            local,
        }))
    }

    /// Method of subsurface scattering in a medium.
    pub(super) fn method_named(&mut self, node: &Node, name: &str) -> MethodName {
        self.choice(node, name, &METHODS)
    }

    /// The medium that a layered surface's diffuse base is, if any of it is one. Its colour is what a boundary that
    /// reflects nothing lets out again, so that is what light meets from within; it leaves as a surface of index `eta`
    /// lets it pass. Without `eta` light is not followed there.
    pub(super) fn subsurface_base(&mut self, said: BaseSaid, eta: Option<f32>) -> Option<SubsurfaceBase> {
        let BaseSaid { weight, color, path, g, method } = said;
        if matches!(weight, FloatTexture::Constant(w) if w <= 0.0) {
            return None;
        }
        let g = g.clamp(-0.99, 0.99);
        let within = Emergence::new(1.0);
        let medium = eta.map(|eta| SubsurfaceMedium {
            emergence: Emergence::new(eta),
            within,
            content: Content::Albedo(color.clone(), path),
            method: match method {
                // What walks bring back then has a closed form.
                MethodName::Walk if g == 0.0 => SubsurfaceMethod::Walk(None),
                _ => self.subsurface_method(method, within.eta(), g, true),
            },
            g,
        });
        Some(SubsurfaceBase { weight, color, g, medium })
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

    /// Medium below the surface, and the albedo of a diffuse surface that looks like it from afar.
    fn content(&mut self, node: &Node, scale: f32) -> (Content, SpectrumTexture) {
        let has = |name: &str| node.get(name).is_some();
        if has("reflectance") || !has("sigma_s") && !has("sigma_a") {
            self.superseded(node, "reflectance", &["sigma_a", "sigma_s"]);
            let albedo = self.spectrum(node, "reflectance", Role::Albedo);
            let path = self.spectrum(node, "mfp", Role::Unbounded);
            return (Content::Albedo(albedo.clone(), self.scaled(node, path, FloatTexture::Constant(scale))), albedo);
        }
        self.superseded(node, "sigma_a", &["mfp"]);
        let local = self.subsurface_albedo(node);
        let [a, s] = ["sigma_a", "sigma_s"].map(|name| {
            let sigma = self.spectrum_or(node, name, Role::Unbounded, ONE);
            self.scaled(node, sigma, FloatTexture::Constant(scale))
        });
        (Content::Coefficients(a, s), local)
    }

    /// A quantity multiplied by a number.
    pub(super) fn scaled(&mut self, node: &Node, value: SpectrumTexture, factor: FloatTexture) -> SpectrumTexture {
        match (value, factor) {
            (value, FloatTexture::Constant(1.0)) => value,
            (SpectrumTexture::Constant(color), FloatTexture::Constant(factor)) => {
                SpectrumTexture::Constant(color.scaled(factor))
            }
            (value, factor) => {
                let role = match &value {
                    SpectrumTexture::Texture(_, role) => *role,
                    SpectrumTexture::Constant(_) => Role::Unbounded,
                };
                let value = self.as_texture(value);
                let factor = match factor {
                    FloatTexture::Texture(id) => id,
                    FloatTexture::Constant(v) => self.textures.add(Texture::Constant(Color::constant(v))),
                };
                SpectrumTexture::Texture(self.add_texture(node, Texture::Scale(value, factor)), role)
            }
        }
    }
}
