//! Compiling matter that gives light back at other wavelengths.

use super::Compiler;
use std::{path::Path, sync::Arc};
use steradian_core::material::{FluorescentMaterial, Model};
use steradian_image::read_regular;
use steradian_math::spectra::{
    BispectralTable, ColorMode, LAMBDA_MAX, LAMBDA_MIN, Reradiation, Wavelengths,
    role::{Color, Role},
};
use steradian_scene::{Node, SpectrumValue};
use steradian_texture::SpectrumTexture;

/// Largest table.
const MAX_BYTES: u64 = 1 << 26;
/// By how much photons may be more than one, for the rounding of tables.
const SLACK: f32 = 2e-3;

impl Compiler<'_> {
    /// A fluorescent surface; a diffuse one in RGB mode, and where an error is reported.
    pub(super) fn fluorescent(&mut self, node: &Node) -> Model {
        let reflectance = self.spectrum(node, "reflectance", Role::Albedo, SpectrumValue::Constant(0.5));
        let plain = Model::Diffuse(reflectance.clone());
        let lifetime = self.float(node, "lifetime", 0.0);
        let Some(reradiation) = self.reradiation(node) else { return plain };
        if self.mode == ColorMode::Rgb {
            self.approximated(
                node.span,
                "fluorescence takes spectral mode (--color spectral); it is left out in RGB mode",
            );
            return plain;
        }
        if let Some((lambda, photons)) = too_many(&reradiation, &reflectance) {
            let message =
                format!("of one photon of {lambda:.0} nm {photons:.3} leave: a surface cannot create photons");
            self.error(node.span, message);
            return plain;
        }
        let local = self.add(node, plain).id;
        Model::Fluorescent(Box::new(FluorescentMaterial {
            reflectance,
            reradiation: Arc::new(reradiation),
            lifetime,
            local,
        }))
    }

    fn reradiation(&mut self, node: &Node) -> Option<Reradiation> {
        let span = node.param("matrix").and_then(|p| p.span).or(node.span);
        if let Some(path) = self.typed(node, "matrix", "a file", |n| n.path("matrix")) {
            self.superseded(node, "matrix", &["absorption", "emission", "quantum_yield"]);
            return match read(path) {
                Ok(table) => Some(Reradiation::new(|out, from| table.eval(out, from))),
                Err(e) => {
                    self.error(span, format!("cannot use the matrix in '{}': {e}", path.display()));
                    None
                }
            };
        }
        let absorption = self.constant_color(node, "absorption", Role::Unbounded, SpectrumValue::Constant(0.0));
        let emission = self.constant_color(node, "emission", Role::Unbounded, SpectrumValue::Constant(1.0));
        let quantum_yield = self.float(node, "quantum_yield", 1.0);
        Some(Reradiation::of_pigment(|l| at(&absorption, l), quantum_yield, |l| at(&emission, l)))
    }
}

fn read(path: &Path) -> Result<BispectralTable, String> {
    let bytes = read_regular(path, MAX_BYTES).map_err(|e| e.to_string())?;
    BispectralTable::parse(&String::from_utf8_lossy(&bytes)).map_err(|e| e.to_string())
}

fn at(color: &Color, lambda: f32) -> f32 {
    color.eval(&Wavelengths::at([lambda; 4]))[0]
}

/// A wavelength of which more photons leave than come, and how many; textures are not looked at.
fn too_many(reradiation: &Reradiation, reflectance: &SpectrumTexture) -> Option<(f32, f32)> {
    let plain = |lambda| match reflectance {
        SpectrumTexture::Constant(color) => at(color, lambda),
        SpectrumTexture::Texture(..) => 0.0,
    };
    let count = (LAMBDA_MAX - LAMBDA_MIN) as u32;
    let all = (0..count).map(|k| LAMBDA_MIN + k as f32 + 0.5).map(|l| (l, reradiation.photons(l) + plain(l)));
    all.max_by(|a, b| a.1.total_cmp(&b.1)).filter(|worst| worst.1 > 1.0 + SLACK)
}
