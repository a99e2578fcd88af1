//! The BSDF `hair`: Mitsuba's names for the parameters of Chiang et al.

use super::{graph::ObjectId, reader::Reader, texture::Role};
use steradian_scene::{Family, Node, Value};

impl Reader<'_> {
    pub(super) fn hair(&mut self, object: ObjectId) -> Node {
        let mut node = self.node(Family::Material, "hair", object);
        let pigments = [("eumelanin", 1.3), ("pheomelanin", 0.2)];
        if !self.graph.has(object, "sigma_a") {
            self.no_effect(object, &["scale"], "it multiplies 'sigma_a' only");
        }
        if let Some((value, span)) = self.spectral(object, "sigma_a", Role::Unbounded) {
            let scale = self.float(object, "scale").unwrap_or(1.0);
            for (name, _) in pigments {
                if self.graph.has(object, name) {
                    self.error(self.value_span(object, name), format!("'sigma_a' excludes '{name}'"));
                }
            }
            let value = if scale == 1.0 { value } else { Value::Node(self.scaled(object, value, scale)) };
            node.set("sigma_a", value, Some(span));
        }
        for (name, default) in pigments {
            let value = self.float(object, name).unwrap_or(default);
            if node.get("sigma_a").is_none() {
                node.set(name, value, Some(self.value_span(object, name)));
            }
        }
        let eta = self.relative_ior(object, "amber");
        node.set("eta", eta, Some(self.value_span(object, "int_ior")));
        for (from, to, default) in [
            ("longitudinal_roughness", "beta_m", 0.3),
            ("azimuthal_roughness", "beta_n", 0.3),
            ("scale_tilt", "alpha", 2.0),
        ] {
            let value = self.float(object, from).unwrap_or(default);
            node.set(to, value, Some(self.value_span(object, from)));
        }
        node.with("round", true)
    }
}
