//! Bands of wavelengths of a film.

use super::Compiler;
use std::sync::Arc;
use steradian_core::film::Bands;
use steradian_math::spectra::{
    ColorMode, Spd,
    role::{Color, Role},
};
use steradian_scene::{Family, Node, SpectrumValue, Value};

/// Numbers of a spectral film that other films do not have.
const OWN: [&str; 3] = ["lambda_min", "lambda_max", "buckets"];

impl Compiler<'_> {
    /// The bands of a spectral film; `None` for films without, and where there are no wavelengths.
    pub(super) fn bands(&mut self, film: &Node) -> Option<Arc<Bands>> {
        if film.kind != "spectral" {
            return None;
        }
        // Of its own parameters those out of range are refused, and have their defaults then.
        let mut own = Node::new(film.family, film.kind.as_str(), film.span);
        own.params = film.params.iter().filter(|p| OWN.contains(&p.name.as_str())).cloned().collect();
        let own = &*self.within_ranges(&own);
        if self.mode == ColorMode::Rgb {
            let what = "the bands of a 'spectral' film need spectra (--color spectral); the picture has R, G and B";
            self.diagnostics.dropped(&self.desc.sources, film.span, what);
            return None;
        }
        let range = self.float(own, "lambda_min")..self.float(own, "lambda_max");
        let count = self.int(own, "buckets").clamp(1, i64::from(Bands::MOST)) as u32;
        if let Some(curves) = self.band_curves(film) {
            return Some(Arc::new(Bands::Curves(curves)));
        }
        if range.start >= range.end {
            let (low, high) = (range.start, range.end);
            let what = format!("bands from {low} nm to {high} nm: 'lambda_max' must be more than 'lambda_min'");
            self.error(film.span, what);
            return None;
        }
        Some(Arc::new(Bands::Even { range, count }))
    }

    /// Names and sensitivities of bands that are given one by one. Names are channels, so no two are alike, and none
    /// is one of the picture's.
    fn band_curves(&mut self, film: &Node) -> Option<Vec<(String, Spd)>> {
        let nodes = self.typed(film, "bands", "a list of textures", |film| match film.get("bands") {
            Some(Value::Nodes(nodes)) => Some(nodes.clone()),
            _ => None,
        })?;
        let span = film.param("bands").and_then(|p| p.span).or(film.span);
        if nodes.is_empty() || nodes.len() > Bands::MOST as usize {
            self.error(span, format!("a film has from 1 to {} bands, not {}", Bands::MOST, nodes.len()));
            return None;
        }
        let mut curves: Vec<(String, Spd)> = Vec::new();
        for id in nodes {
            let node = self.node(id);
            let name = node.name.as_deref().unwrap_or_default();
            let is_channel = !name.is_empty() && name.len() <= 200 && !name.contains(['.', '\0']);
            if !is_channel || ["R", "G", "B", "A", "Z"].contains(&name) || curves.iter().any(|(known, _)| known == name)
            {
                let rule = "names are distinct, without dots, not R, G, B, A or Z";
                let what = format!("'{name}' cannot be the channel of a band: {rule}");
                self.error(node.span.or(span), what);
                return None;
            }
            if node.family != Family::Texture || node.kind != "constant" {
                self.error(node.span.or(span), format!("the sensitivity '{name}' of a band is no texture 'constant'"));
                return None;
            }
            let color = self.constant_color_or(node, "value", Role::Unbounded, SpectrumValue::Constant(1.0));
            let curve = match color {
                Color::Spectral(curve) => curve,
                Color::Lanes(lanes) => Spd::Constant(lanes[0]),
            };
            curves.push((name.to_owned(), curve));
        }
        Some(curves)
    }
}
