//! Dispersion by formula: an index of refraction from an Abbe number, or from Cauchy's or Sellmeier's constants.

use super::Compiler;
use std::sync::Arc;
use steradian_core::material::Eta;
use steradian_math::spectra::{ColorMode, Dense, Dispersion, LAMBDA_COUNT, LAMBDA_MIN, Spd, role::Color};
use steradian_scene::Node;

/// The sodium line, nm: where an index that cannot depend on the wavelength is taken.
const SODIUM: f64 = 589.3;

impl Compiler<'_> {
    /// The index of a material with `abbe_number`, `cauchy` (two or three numbers, λ in µm) or `sellmeier` (six
    /// numbers: B₁, B₂, B₃, then C₁, C₂, C₃ in µm²). In RGB it is the one at the sodium line. `None` where none of them
    /// is there.
    pub(super) fn dispersion(&mut self, node: &Node) -> Option<Eta> {
        let formula = if node.param("abbe_number").is_some() {
            let abbe = self.float_or(node, "abbe_number", 0.0);
            Dispersion::from_abbe(f64::from(self.at_sodium_line(node, "eta")), f64::from(abbe))
        } else if node.param("cauchy").is_some() {
            let c = self.list(node, "cauchy")?;
            if !(2..=3).contains(&c.len()) {
                self.error(node.span, format!("Cauchy's formula has two or three constants, not {}", c.len()));
                return None;
            }
            Dispersion::Cauchy([0, 1, 2].map(|i| c.get(i).map_or(0.0, |v| f64::from(*v))))
        } else if node.param("sellmeier").is_some() {
            let c = self.list(node, "sellmeier")?;
            if c.len() != 6 {
                self.error(node.span, format!("Sellmeier's formula has six constants, not {}", c.len()));
                return None;
            }
            Dispersion::three_terms([0, 1, 2].map(|i| [f64::from(c[i]), f64::from(c[i + 3])]))
        } else {
            return None;
        };
        let lambdas = (0..LAMBDA_COUNT).map(|i| LAMBDA_MIN + i as f32);
        if let Some(l) = lambdas.map(f64::from).find(|l| !formula.is_possible(*l)) {
            let name = ["abbe_number", "cauchy", "sellmeier"].into_iter().find(|n| node.param(n).is_some());
            let span = name.and_then(|n| node.param(n)).and_then(|p| p.span).or(node.span);
            let what = format!(
                "by '{}' the index of refraction at {l} nm is not in [0.05, 20]; it is held there",
                name.unwrap_or_default()
            );
            self.diagnostics.warn(&self.desc.sources, span, what);
        }
        let sodium = formula.eval(SODIUM);
        let dense = Dense::new(|l| formula.eval(f64::from(l)) as f32);
        let flat = dense.values().windows(2).all(|w| w[0] == w[1]);
        if self.mode == ColorMode::Rgb || flat {
            return Some(Eta::Constant(sodium as f32));
        }
        Some(Eta::Dispersive(Color::Spectral(Spd::Dense(Arc::new(dense)))))
    }
}
