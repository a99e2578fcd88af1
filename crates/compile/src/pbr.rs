//! Compiling the surfaces of glTF and OpenPBR, and sheen.

use super::{
    Compiler,
    subsurface::{BaseSaid, MethodName},
};
use std::sync::Arc;
use steradian_core::material::{Convention, Eta, Model, PbrMaterial, SubsurfaceBase};
use steradian_math::spectra::{
    ColorMode, Dense, Spd,
    role::{Color, Role},
};
use steradian_scene::Node;
use steradian_texture::{FloatTexture, SpectrumTexture};

/// Fraunhofer's lines F, d and C (µm).
const LINES: [f32; 3] = [0.4861, 0.5876, 0.6563];

impl Compiler<'_> {
    /// glTF 2.0's metallic-roughness surface with its extensions.
    pub(super) fn metallic_roughness(&mut self, node: &Node) -> Model {
        let film = self.film_on_base(node, ["iridescence", "iridescence_thickness", "iridescence_eta"]);
        Model::Pbr(Box::new(PbrMaterial {
            base_color: self.spectrum(node, "base_color", Role::Albedo),
            base_weight: FloatTexture::Constant(1.0),
            diffuse_roughness: FloatTexture::Constant(0.0),
            metallic: self.float_texture(node, "metallic"),
            roughness: self.float_texture(node, "roughness"),
            anisotropy: self.float_texture(node, "anisotropy"),
            convention: Convention::Gltf,
            eta: self.dispersive_eta(node, "eta", "dispersion"),
            specular: self.float_texture(node, "specular"),
            specular_color: self.spectrum(node, "specular_color", Role::Unbounded),
            transmission: self.float_texture(node, "transmission"),
            transmission_color: None,
            thin: self.bool(node, "thin"),
            diffuse_transmission: self.float_texture(node, "diffuse_transmission"),
            diffuse_transmission_color: self.spectrum(node, "diffuse_transmission_color", Role::Albedo),
            sheen_color: self.spectrum(node, "sheen_color", Role::Albedo),
            sheen_weight: FloatTexture::Constant(1.0),
            sheen_roughness: self.float_texture(node, "sheen_roughness"),
            coat: self.float_texture(node, "clearcoat"),
            coat_roughness: self.float_texture(node, "clearcoat_roughness"),
            coat_anisotropy: FloatTexture::Constant(0.0),
            coat_darkening: FloatTexture::Constant(0.0),
            coat_eta: FloatTexture::Constant(1.5),
            coat_color: SpectrumTexture::Constant(Color::constant(1.0)),
            film,
            subsurface: None,
        }))
    }

    /// OpenPBR 1.1's surface, by its own parameter names.
    pub(super) fn openpbr(&mut self, node: &Node) -> Model {
        let film = self.film_on_base(node, ["thin_film_weight", "thin_film_thickness", "thin_film_ior"]);
        // Light and media belong to shapes, which have them by now (`carried`); here their values are checked.
        self.float(node, "transmission_scatter_anisotropy");
        self.float(node, "emission_luminance");
        for name in ["transmission_scatter", "emission_color"] {
            self.spectrum(node, name, Role::Unbounded);
        }
        // The colour of a medium is not that of its boundary.
        let has_medium = self.float(node, "transmission_depth") > 0.0 && !self.bool(node, "geometry_thin_walled");
        let transmission_color = match has_medium {
            true => SpectrumTexture::Constant(Color::constant(1.0)),
            false => self.spectrum(node, "transmission_color", Role::Albedo),
        };
        let subsurface = self.openpbr_subsurface(node);
        Model::Pbr(Box::new(PbrMaterial {
            base_color: self.spectrum(node, "base_color", Role::Albedo),
            base_weight: self.float_texture(node, "base_weight"),
            diffuse_roughness: self.float_texture(node, "base_diffuse_roughness"),
            metallic: self.float_texture(node, "base_metalness"),
            roughness: self.float_texture(node, "specular_roughness"),
            anisotropy: self.float_texture(node, "specular_roughness_anisotropy"),
            convention: Convention::OpenPbr,
            eta: self.dispersive_eta(node, "specular_ior", "dispersion"),
            specular: self.float_texture(node, "specular_weight"),
            specular_color: self.spectrum(node, "specular_color", Role::Albedo),
            transmission: self.float_texture(node, "transmission_weight"),
            transmission_color: Some(transmission_color),
            thin: self.bool(node, "geometry_thin_walled"),
            diffuse_transmission: FloatTexture::Constant(0.0),
            diffuse_transmission_color: SpectrumTexture::Constant(Color::constant(1.0)),
            sheen_color: self.spectrum(node, "fuzz_color", Role::Albedo),
            sheen_weight: self.float_texture(node, "fuzz_weight"),
            sheen_roughness: self.float_texture(node, "fuzz_roughness"),
            coat: self.float_texture(node, "coat_weight"),
            coat_roughness: self.float_texture(node, "coat_roughness"),
            coat_anisotropy: self.float_texture(node, "coat_roughness_anisotropy"),
            coat_darkening: self.float_texture(node, "coat_darkening"),
            coat_eta: self.float_texture(node, "coat_ior"),
            coat_color: self.spectrum(node, "coat_color", Role::Albedo),
            film,
            subsurface,
        }))
    }

    /// The subsurface slab of OpenPBR: its index is that of a surface which reflects what `specular_weight` leaves
    /// (3.4.1); a thin-walled surface scatters diffusely to both sides instead.
    fn openpbr_subsurface(&mut self, node: &Node) -> Option<SubsurfaceBase> {
        let path = self.spectrum(node, "subsurface_radius_scale", Role::Unbounded);
        let radius = self.float_texture(node, "subsurface_radius");
        let said = BaseSaid {
            weight: self.float_texture(node, "subsurface_weight"),
            color: self.spectrum(node, "subsurface_color", Role::Albedo),
            path: self.scaled(node, path, radius),
            g: self.float(node, "subsurface_scatter_anisotropy"),
            method: MethodName::Walk,
        };
        let eta = self.at_sodium_line(node, "specular_ior");
        let specular = match self.float_texture(node, "specular_weight") {
            FloatTexture::Constant(w) => w.clamp(0.0, 1.0),
            FloatTexture::Texture(_) => 1.0,
        };
        let root = specular.sqrt() * (eta - 1.0) / (eta + 1.0);
        let is_thin = self.bool(node, "geometry_thin_walled");
        self.subsurface_base(said, (!is_thin).then_some((1.0 + root) / (1.0 - root)))
    }

    /// Charlie sheen over a diffuse surface.
    pub(super) fn sheen(&mut self, node: &Node) -> Model {
        let zero = FloatTexture::Constant(0.0);
        Model::Pbr(Box::new(PbrMaterial {
            base_color: self.spectrum(node, "reflectance", Role::Albedo),
            base_weight: FloatTexture::Constant(1.0),
            diffuse_roughness: FloatTexture::Constant(0.0),
            metallic: zero,
            roughness: FloatTexture::Constant(1.0),
            anisotropy: zero,
            convention: Convention::Gltf,
            eta: Eta::Constant(1.5),
            specular: zero,
            specular_color: SpectrumTexture::Constant(Color::constant(1.0)),
            transmission: zero,
            transmission_color: None,
            thin: true,
            diffuse_transmission: zero,
            diffuse_transmission_color: SpectrumTexture::Constant(Color::constant(1.0)),
            sheen_color: self.spectrum(node, "sheen_color", Role::Albedo),
            sheen_weight: FloatTexture::Constant(1.0),
            sheen_roughness: self.float_texture(node, "sheen_roughness"),
            coat: zero,
            coat_roughness: zero,
            coat_anisotropy: FloatTexture::Constant(0.0),
            coat_darkening: FloatTexture::Constant(0.0),
            coat_eta: FloatTexture::Constant(1.5),
            coat_color: SpectrumTexture::Constant(Color::constant(1.0)),
            film: None,
            subsurface: None,
        }))
    }

    /// The weight, thickness (nm) and index of a film, where there is one.
    fn film_on_base(&mut self, node: &Node, names: [&str; 3]) -> Option<[FloatTexture; 3]> {
        let film = names.map(|name| self.float_texture(node, name));
        (!matches!(film[0], FloatTexture::Constant(w) if w <= 0.0)).then_some(film)
    }

    /// An index that grows towards blue by Cauchy's formula where `dispersion` (20 over the Abbe number,
    /// KHR_materials_dispersion) is above zero.
    fn dispersive_eta(&mut self, node: &Node, name: &str, dispersion: &str) -> Eta {
        let eta = self.eta_named(node, name);
        let mut strength = self.float(node, dispersion);
        if node.kind == "openpbr" {
            let abbe = self.float(node, "transmission_dispersion_abbe_number");
            strength += 20.0 * self.float(node, "transmission_dispersion_scale") / abbe;
        }
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
