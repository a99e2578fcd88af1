//! Compiling the surfaces of glTF and OpenPBR, and sheen.

use super::{
    Compiler,
    subsurface::{BaseSaid, MethodName},
};
use std::sync::Arc;
use steradian_core::material::{Eta, Model, PbrMaterial, Stretch, SubsurfaceBase};
use steradian_math::spectra::{
    ColorMode, Dense, Spd,
    role::{Color, Role},
};
use steradian_scene::{ColorSpace, Node, SpectrumValue};
use steradian_texture::{FloatTexture, SpectrumTexture};

/// Fraunhofer's lines F, d and C (µm).
const LINES: [f32; 3] = [0.4861, 0.5876, 0.6563];

const fn grey(v: f64) -> SpectrumValue {
    SpectrumValue::Constant(v)
}

impl Compiler<'_> {
    /// glTF 2.0's metallic-roughness surface with its extensions.
    pub(super) fn metallic_roughness(&mut self, node: &Node) -> Model {
        let film = self.film_on_base(node, "iridescence", ("iridescence_thickness", 400.0), ("iridescence_eta", 1.3));
        Model::Pbr(Box::new(PbrMaterial {
            base_color: self.spectrum(node, "base_color", Role::Albedo, grey(1.0)),
            base_weight: FloatTexture::Constant(1.0),
            metallic: self.float_texture(node, "metallic", 1.0),
            roughness: self.float_texture(node, "roughness", 1.0),
            anisotropy: self.float_texture(node, "anisotropy", 0.0),
            stretch: Stretch::Gltf,
            eta: self.dispersive_eta(node, "eta", "dispersion"),
            specular: self.float_texture(node, "specular", 1.0),
            specular_color: self.spectrum(node, "specular_color", Role::Unbounded, grey(1.0)),
            transmission: self.float_texture(node, "transmission", 0.0),
            transmission_color: None,
            thin: self.bool(node, "thin", true),
            diffuse_transmission: self.float_texture(node, "diffuse_transmission", 0.0),
            diffuse_transmission_color: self.spectrum(node, "diffuse_transmission_color", Role::Albedo, grey(1.0)),
            sheen_color: self.spectrum(node, "sheen_color", Role::Albedo, grey(0.0)),
            sheen_weight: FloatTexture::Constant(1.0),
            sheen_roughness: self.float_texture(node, "sheen_roughness", 0.0),
            coat: self.float_texture(node, "clearcoat", 0.0),
            coat_roughness: self.float_texture(node, "clearcoat_roughness", 0.0),
            coat_eta: FloatTexture::Constant(1.5),
            coat_color: SpectrumTexture::Constant(Color::constant(1.0)),
            film,
            subsurface: None,
        }))
    }

    /// OpenPBR 1.1's surface, by its own parameter names.
    pub(super) fn openpbr(&mut self, node: &Node) -> Model {
        self.name_losses(
            node,
            &[
                ("base_diffuse_roughness", "the diffuse base is Lambertian"),
                (
                    "transmission_depth",
                    "the colour of transmission acts at the surface; absorption needs an interior medium",
                ),
                ("transmission_scatter", "scattering inside needs an interior medium"),
                ("coat_roughness_anisotropy", "the coat is isotropic"),
                ("emission_luminance", "emission belongs to the shape's light"),
            ],
        );
        let film = self.film_on_base(node, "thin_film_weight", ("thin_film_thickness", 500.0), ("thin_film_ior", 1.4));
        let transmission_color = self.spectrum(node, "transmission_color", Role::Albedo, grey(1.0));
        let subsurface = self.openpbr_subsurface(node);
        Model::Pbr(Box::new(PbrMaterial {
            base_color: self.spectrum(node, "base_color", Role::Albedo, grey(0.8)),
            base_weight: self.float_texture(node, "base_weight", 1.0),
            metallic: self.float_texture(node, "base_metalness", 0.0),
            roughness: self.float_texture(node, "specular_roughness", 0.3),
            anisotropy: self.float_texture(node, "specular_roughness_anisotropy", 0.0),
            stretch: Stretch::OpenPbr,
            eta: self.dispersive_eta(node, "specular_ior", "dispersion"),
            specular: self.float_texture(node, "specular_weight", 1.0),
            specular_color: self.spectrum(node, "specular_color", Role::Albedo, grey(1.0)),
            transmission: self.float_texture(node, "transmission_weight", 0.0),
            transmission_color: Some(transmission_color),
            thin: self.bool(node, "geometry_thin_walled", false),
            diffuse_transmission: FloatTexture::Constant(0.0),
            diffuse_transmission_color: SpectrumTexture::Constant(Color::constant(1.0)),
            sheen_color: self.spectrum(node, "fuzz_color", Role::Albedo, grey(1.0)),
            sheen_weight: self.float_texture(node, "fuzz_weight", 0.0),
            sheen_roughness: self.float_texture(node, "fuzz_roughness", 0.5),
            coat: self.float_texture(node, "coat_weight", 0.0),
            coat_roughness: self.float_texture(node, "coat_roughness", 0.0),
            coat_eta: self.float_texture(node, "coat_ior", 1.6),
            coat_color: self.spectrum(node, "coat_color", Role::Albedo, grey(1.0)),
            film,
            subsurface,
        }))
    }

    /// The subsurface slab of OpenPBR: its index is that of a surface which reflects what `specular_weight` leaves
    /// (3.4.1); a thin-walled surface scatters diffusely to both sides instead.
    fn openpbr_subsurface(&mut self, node: &Node) -> Option<SubsurfaceBase> {
        let scale = SpectrumValue::Rgb([1.0, 0.5, 0.25], ColorSpace::Srgb);
        let path = self.spectrum(node, "subsurface_radius_scale", Role::Unbounded, scale);
        let radius = self.float_texture(node, "subsurface_radius", 1.0);
        let said = BaseSaid {
            weight: self.float_texture(node, "subsurface_weight", 0.0),
            color: self.spectrum(node, "subsurface_color", Role::Albedo, grey(0.8)),
            path: self.scaled(node, path, radius),
            g: self.float(node, "subsurface_scatter_anisotropy", 0.0),
            method: MethodName::Walk,
        };
        let eta = self.at_sodium_line(node, "specular_ior", 1.5);
        let specular = match self.float_texture(node, "specular_weight", 1.0) {
            FloatTexture::Constant(w) => w.clamp(0.0, 1.0),
            FloatTexture::Texture(_) => 1.0,
        };
        let root = specular.sqrt() * (eta - 1.0) / (eta + 1.0);
        let is_thin = self.bool(node, "geometry_thin_walled", false);
        self.subsurface_base(said, (!is_thin).then_some((1.0 + root) / (1.0 - root)))
    }

    /// Charlie sheen over a diffuse surface.
    pub(super) fn sheen(&mut self, node: &Node) -> Model {
        let zero = FloatTexture::Constant(0.0);
        Model::Pbr(Box::new(PbrMaterial {
            base_color: self.spectrum(node, "reflectance", Role::Albedo, grey(0.5)),
            base_weight: FloatTexture::Constant(1.0),
            metallic: zero,
            roughness: FloatTexture::Constant(1.0),
            anisotropy: zero,
            stretch: Stretch::Gltf,
            eta: Eta::Constant(1.5),
            specular: zero,
            specular_color: SpectrumTexture::Constant(Color::constant(1.0)),
            transmission: zero,
            transmission_color: None,
            thin: true,
            diffuse_transmission: zero,
            diffuse_transmission_color: SpectrumTexture::Constant(Color::constant(1.0)),
            sheen_color: self.spectrum(node, "sheen_color", Role::Albedo, grey(1.0)),
            sheen_weight: FloatTexture::Constant(1.0),
            sheen_roughness: self.float_texture(node, "sheen_roughness", 0.5),
            coat: zero,
            coat_roughness: zero,
            coat_eta: FloatTexture::Constant(1.5),
            coat_color: SpectrumTexture::Constant(Color::constant(1.0)),
            film: None,
            subsurface: None,
        }))
    }

    /// The weight, thickness (nm) and index of a film, where there is one.
    fn film_on_base(
        &mut self,
        node: &Node,
        weight: &str,
        (thickness, nm): (&str, f64),
        (eta, index): (&str, f64),
    ) -> Option<[FloatTexture; 3]> {
        let film = [(weight, 0.0), (thickness, nm), (eta, index)].map(|(name, v)| self.float_texture(node, name, v));
        (!matches!(film[0], FloatTexture::Constant(w) if w <= 0.0)).then_some(film)
    }

    /// Reports what parameters that are set do not do.
    fn name_losses(&mut self, node: &Node, losses: &[(&str, &str)]) {
        for (name, what) in losses {
            if let Some(p) = node.param(name)
                && node.float(name) != Some(0.0)
            {
                self.approximated(p.span.or(node.span), format!("'{name}' of '{}': {what}", node.kind));
            }
        }
    }

    /// An index that grows towards blue by Cauchy's formula where `dispersion` (20 over the Abbe number,
    /// KHR_materials_dispersion) is above zero.
    fn dispersive_eta(&mut self, node: &Node, name: &str, dispersion: &str) -> Eta {
        let eta = self.eta_named(node, name, 1.5);
        let strength = self.float(node, dispersion, 0.0);
        match eta {
            Eta::Constant(n) if strength > 0.0 && self.mode == ColorMode::Spectral => {
                let square = |line: f32| 1.0 / (line * line);
                let b = (n - 1.0) * strength / 20.0 / (square(LINES[0]) - square(LINES[2]));
                let at = move |nm: f32| (n + b * (square(nm * 1e-3) - square(LINES[1]))).clamp(1.0, 20.0);
                Eta::Dispersive(Color::Spectral(Spd::Dense(Arc::new(Dense::new(at)))))
            }
            eta => eta,
        }
    }
}
