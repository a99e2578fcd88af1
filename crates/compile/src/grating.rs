//! Compiling diffraction gratings.

use super::Compiler;
use steradian_bsdf::{Grooves, NormalDistribution, Profile, Shadowing};
use steradian_core::material::{Eta, GratingMaterial, Metal, Model, Roughness};
use steradian_math::spectra::{
    ColorMode, LAMBDA_MIN,
    role::{Color, Role},
};
use steradian_scene::Node;
use steradian_texture::SpectrumTexture;

impl Compiler<'_> {
    /// A grating; the zeroth order alone in RGB mode.
    pub(super) fn grating(&mut self, node: &Node) -> Model {
        let [u, v] = self.alphas(node, ["alpha_u", "alpha_v"]);
        let roughness = Roughness {
            u,
            v,
            remap: false,
            distribution: NormalDistribution::Ggx,
            shadowing: Shadowing::HeightCorrelated,
        };
        let surface = self.metal(node, roughness);
        let transmittance = self.spectrum(node, "specular_transmittance", Role::Albedo);
        let index = self.float(node, "index");
        let transmits = self.bool(node, "transmission").then_some(index);
        let grooves = self.grooves(node, transmits);
        let Some(mut metal) = as_metal(&surface) else { return surface };
        if transmits.is_some() {
            metal.tint = transmittance.clone();
        }
        if self.mode == ColorMode::Spectral {
            return Model::Grating(Box::new(GratingMaterial { metal, grooves }));
        }
        self.approximated(
            node.span,
            "a grating takes spectral mode (--color spectral); in RGB mode all light goes where the zeroth order does",
        );
        match transmits {
            None => surface,
            Some(_) => {
                Model::ThinDielectric { eta: Eta::Constant(1.0), reflectance: transmittance.clone(), transmittance }
            }
        }
    }

    fn grooves(&mut self, node: &Node, transmits: Option<f32>) -> Grooves {
        let mut period = self.positive(node, "period");
        if node.param("lines").is_some() {
            self.superseded(node, "lines", &["period"]);
            period = 1e6 / self.positive_or(node, "lines", 625.0);
        }
        let depth = self.float(node, "depth");
        let duty = self.float(node, "duty");
        let orders = self.int(node, "orders").clamp(0, 100) as u16;
        let shapes = [("sinusoidal", 0), ("rectangular", 1), ("blazed", 2)];
        let mut profile = match self.choice(node, "profile", &shapes) {
            0 => Profile::sinusoidal(orders, depth / LAMBDA_MIN * transmits.unwrap_or(2.0).max(2.0)),
            1 => Profile::Rectangular(duty),
            _ => Profile::Blazed,
        };
        if let Some(efficiencies) = self.list(node, "efficiencies") {
            self.superseded(node, "efficiencies", &["profile", "depth", "duty"]);
            let span = node.param("efficiencies").and_then(|p| p.span).or(node.span);
            let sum: f32 = efficiencies.iter().sum();
            if efficiencies.len() % 2 == 0 || efficiencies.iter().any(|e| *e < 0.0) {
                self.error(span, "'efficiencies' must be an odd number of values from 0, of orders from −m to m");
            } else if sum > 1.0 + 1e-5 {
                self.error(
                    span,
                    format!("'efficiencies' have a sum of {sum}; a grating sends out at most all light, 1"),
                );
            } else {
                profile = Profile::Listed(efficiencies);
            }
        }
        Grooves { period, depth, profile, orders, transmits }
    }
}

/// A metal or mirror by its index.
fn as_metal(surface: &Model) -> Option<Metal> {
    let constant = |v: f32| SpectrumTexture::Constant(Color::constant(v));
    Some(match surface {
        Model::Conductor { eta, k, tint, roughness } => {
            Metal { eta: eta.clone(), k: k.clone(), tint: tint.clone(), roughness: *roughness }
        }
        Model::Mirror(tint, roughness) | Model::ConductorReflectance(tint, roughness) => {
            Metal { eta: constant(0.0), k: constant(1.0), tint: tint.clone(), roughness: *roughness }
        }
        _ => return None,
    })
}
