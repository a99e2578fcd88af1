//! BSDFs whose point is polarisation, as unpolarised light sees them.

use super::{graph::ObjectId, reader::Reader, texture::Role};
use steradian_scene::{Family, Node, Value};

impl Reader<'_> {
    /// `pplastic`: a rough coat over a diffuse base.
    pub(super) fn polarized_plastic(&mut self, object: ObjectId) -> Node {
        self.unpolarized(object);
        let mut node = self.node(Family::Material, "plastic", object);
        self.put(&mut node, "diffuse_reflectance", object, "diffuse_reflectance", Role::Reflectance, 0.5);
        let eta = self.relative_ior(object, "polypropylene");
        node.set("eta", eta, Some(self.value_span(object, "int_ior")));
        self.roughness(&mut node, object);
        self.specular(&mut node, object, false);
        node
    }

    /// Polarisers let half of unpolarised light pass straight on, retarders all of it.
    pub(super) fn polarizing_filter(&mut self, object: ObjectId, is_retarder: bool) -> Node {
        self.unpolarized(object);
        let why = "the filter acts as on unpolarised light";
        self.no_effect(object, &["theta", "delta", "left_handed", "polarizing"], why);
        let (mut value, span) = match self.spectral(object, "transmittance", Role::Reflectance) {
            Some((value, span)) => (value, Some(span)),
            None => (Value::Float(1.0), None),
        };
        if !is_retarder {
            value = match value {
                Value::Float(v) => Value::Float(0.5 * v),
                other => Value::Node(self.scaled(object, other, 0.5)),
            };
        }
        let node = self.node(Family::Material, "thin_dielectric", object);
        let mut node = node.with("eta", 1.0).with("specular_reflectance", 0.0);
        node.set("specular_transmittance", value, span);
        node
    }

    fn unpolarized(&mut self, object: ObjectId) {
        let what = format!("'{}' acts as on unpolarised light", self.plugin(object));
        self.approximated(self.span(object), what);
    }
}
