//! The sky and the sun: `sunsky` of Mitsuba 3; `sky`, `sun` and `sunsky` of 0.6.

use super::{
    graph::{Category, ObjectId},
    reader::Reader,
    texture::Role,
    told::NOISE,
};
use steradian_math::{DVec3, Transform};
use steradian_scene::{Family, Node, NodeId};

/// The whole angle of the sun in degrees where a file says nothing of it.
const APERTURE: f64 = 0.5358;

const NUMBERS: [&str; 9] =
    ["turbidity", "latitude", "longitude", "timezone", "hour", "minute", "second", "sun_scale", "sky_scale"];

impl Reader<'_> {
    /// The light of a sky.
    pub(super) fn sky(&mut self, object: ObjectId) -> Option<NodeId> {
        let legacy = self.graph.objects[object].legacy;
        let (with_sky, with_sun) = match self.plugin(object) {
            "sky" => (true, false),
            "sun" => (false, true),
            _ => (true, true),
        };
        let mut node = self.node(Family::Light, "sky", object);
        self.put_given(&mut node, "albedo", object, "albedo", Role::Reflectance);
        // One without the other has no scale for it.
        let foreign = if with_sky { "sun_scale" } else { "sky_scale" };
        for name in NUMBERS.into_iter().filter(|name| (with_sky && with_sun) || *name != foreign) {
            if let Some(v) = self.float(object, name) {
                node.set(name, v, Some(self.value_span(object, name)));
            }
        }
        for name in ["year", "month", "day"] {
            if let Some(v) = self.int(object, name) {
                node.set(name, v, Some(self.value_span(object, name)));
            }
        }
        if let Some(d) = self.vec3(object, "sun_direction") {
            node.set("sun_direction", d, Some(self.value_span(object, "sun_direction")));
        }
        node.set("limb_darkening", self.bool(object, "complex_sun").unwrap_or(false), None);
        if let Some(v) = self.float(object, "sun_aperture") {
            node.set("sun_aperture", v, Some(self.value_span(object, "sun_aperture")));
        }
        if !with_sky {
            node.set("sky_scale", 0.0, None);
        }
        if !with_sun {
            node.set("sun_scale", 0.0, None);
        }
        let to_world = self.transform(object, "to_world");
        let own = if legacy {
            self.legacy_sky(&mut node, object)
        } else {
            node.set("sun_rgb", "mitsuba", None);
            // Its own +x is south, +y west.
            Transform::scale(DVec3::new(-1.0, -1.0, 1.0))
        };
        self.no_effect(object, &["sampling_weight"], NOISE);
        self.graph.children(object, Category::Medium);
        Some(self.desc.add(node.with("to_world", to_world * own)))
    }

    /// Conventions of version 0.6: other defaults, +y up, −z north, and the sun of Preetham et al.
    fn legacy_sky(&mut self, node: &mut Node, object: ObjectId) -> Transform {
        if node.get("albedo").is_none() {
            node.set("albedo", 0.15, None);
        }
        if let Some(v) = self.float(object, "scale") {
            node.set("scale", v, Some(self.value_span(object, "scale")));
        }
        if let Some(v) = self.float(object, "sun_radius_scale") {
            node.set("sun_aperture", (v * APERTURE).max(0.01), Some(self.value_span(object, "sun_radius_scale")));
        }
        if node.float("sun_scale") != Some(0.0) {
            self.approximated(self.span(object), "the sun is that of Hosek and Wilkie (2013), as in Mitsuba 3");
        }
        if self.float(object, "stretch").is_some_and(|v| v != 1.0) {
            self.dropped(self.value_span(object, "stretch"), "'stretch' of a sky is left out: it ends at the horizon");
        }
        self.no_effect(object, &["resolution"], "the sky is not made of pixels");
        self.left_out(object, "extend", &["false"], "a sky ends at the horizon");
        Transform::from_rows([0., 1., 0., 0., 0., 0., 1., 0., -1., 0., 0., 0., 0., 0., 0., 1.])
    }
}
