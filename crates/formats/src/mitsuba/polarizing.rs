//! BSDFs whose point is polarisation.

use super::{graph::ObjectId, reader::Reader, texture::Role};
use steradian_scene::{Family, Node, Value};

impl Reader<'_> {
    /// `pplastic`: a rough coat over a diffuse base, as unpolarised light sees it.
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

    /// `polarizer` and `circular`.
    pub(super) fn polarizer(&mut self, object: ObjectId) -> Node {
        let is_linear = self.plugin(object) == "polarizer";
        if is_linear && self.bool(object, "polarizing") == Some(false) {
            return self.neutral_filter(object);
        }
        let mut node = self.node(Family::Material, "polarizer", object);
        if is_linear {
            self.put(&mut node, "theta", object, "theta", Role::Scalar, 0.0);
        } else {
            let is_left = self.bool(object, "left_handed").unwrap_or(false);
            node.set("form", if is_left { "left_circular" } else { "right_circular" }, None);
            self.no_effect(object, &["theta"], "circular polarisers have no axis");
        }
        self.put_given(&mut node, "transmittance", object, "transmittance", Role::Reflectance);
        node
    }

    /// `retarder`.
    pub(super) fn retarder(&mut self, object: ObjectId) -> Node {
        let mut node = self.node(Family::Material, "retarder", object);
        self.put(&mut node, "theta", object, "theta", Role::Scalar, 0.0);
        self.put(&mut node, "delta", object, "delta", Role::Scalar, 90.0);
        node
    }

    /// A polariser that is told not to polarise: it passes half of all light.
    fn neutral_filter(&mut self, object: ObjectId) -> Node {
        self.no_effect(object, &["theta"], "'polarizing' is false");
        let (value, span) = match self.spectral(object, "transmittance", Role::Reflectance) {
            Some((Value::Float(v), span)) => (Value::Float(0.5 * v), Some(span)),
            Some((other, span)) => (Value::Node(self.scaled(object, other, 0.5)), Some(span)),
            None => (Value::Float(0.5), None),
        };
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
