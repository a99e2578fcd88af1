//! Emitters to lights. Mitsuba never normalises spectra photometrically: `normalize` is off throughout.

use super::{
    graph::{Category, ObjectId},
    reader::Reader,
    sensor::mirrored_x,
    texture::{Role, rgb},
    told::{NOISE, SPEED},
};
use steradian_math::{DVec3, Transform};
use steradian_scene::{Family, Node, NodeId, Value};

impl Reader<'_> {
    /// The emitter of a shape; `None` after an error or when it is left out.
    pub fn surface_emitter(&mut self, object: ObjectId) -> Option<NodeId> {
        let kind = match self.plugin(object) {
            "area" => "area",
            "directionalarea" => "directional_area",
            other => {
                let message =
                    format!("a shape cannot be the emitter '{other}': 'area' and 'directionalarea' belong on shapes");
                if self.is_known(object) {
                    self.error(self.span(object), message)
                } else {
                    self.unknown_plugin(object)
                }
                return None;
            }
        };
        self.once(object, Role::Emission, |r| {
            let mut node = r.node(Family::Light, kind, object);
            r.put(&mut node, "radiance", object, "radiance", Role::Emission, 1.0);
            if kind == "directional_area" {
                r.note(r.span(object), "Mitsuba's 'path' finds no light of 'directionalarea'; here it shines");
            }
            r.no_effect(object, &["sampling_weight"], NOISE);
            node.set("two_sided", false, None).set("scale", 1.0, None).set("normalize", false, None);
            Some(r.desc.add(node))
        })
    }

    /// An emitter that stands in the scene by itself.
    pub fn emitter(&mut self, object: ObjectId) -> Option<NodeId> {
        let node = match self.plugin(object) {
            "point" => self.point(object),
            "spot" => self.spot(object),
            "directional" => self.directional(object),
            "constant" => {
                let mut node = self.node(Family::Light, "environment", object);
                self.put(&mut node, "radiance", object, "radiance", Role::Emission, 1.0);
                node
            }
            "envmap" => self.environment_map(object)?,
            "projector" => self.projector(object),
            "sunsky" | "sky" | "sun" => return self.sky(object),
            "timed_sunsky" => self.constant_sky(object),
            "collimated" => {
                self.graph.objects[object].visited = false;
                let message = format!("there is no emitter '{}'; it is left out", self.plugin(object));
                self.dropped(self.span(object), message);
                return None;
            }
            _ => {
                self.unknown_plugin(object);
                return None;
            }
        };
        self.no_effect(object, &["sampling_weight"], NOISE);
        // Emitters inside media need no naming of the medium.
        self.graph.children(object, Category::Medium);
        Some(self.desc.add(node.with("normalize", false)))
    }

    fn point(&mut self, object: ObjectId) -> Node {
        let mut node = self.node(Family::Light, "point", object);
        self.put(&mut node, "intensity", object, "intensity", Role::Emission, 1.0);
        let to_world = match self.vec3(object, "position") {
            Some(p) => {
                self.excludes(object, "position", "to_world");
                Transform::translate(p.into())
            }
            None => self.transform(object, "to_world"),
        };
        node.with("to_world", to_world).with("scale", 1.0)
    }

    fn spot(&mut self, object: ObjectId) -> Node {
        let mut node = self.node(Family::Light, "spot", object);
        self.put(&mut node, "intensity", object, "intensity", Role::Emission, 1.0);
        self.put_given(&mut node, "texture", object, "texture", Role::Unbounded);
        let cutoff = self.float(object, "cutoff_angle").unwrap_or(20.0);
        let beam = self.float(object, "beam_width").unwrap_or(cutoff * 0.75);
        if !(cutoff > 0.0 && cutoff < 180.0 && (0.0..=cutoff).contains(&beam)) {
            let span = self.value_span(object, "cutoff_angle");
            self.error(span, "a spot needs 0 ≤ beam_width ≤ cutoff_angle < 180");
        }
        node.set("cone_angle", cutoff, Some(self.value_span(object, "cutoff_angle")));
        node.set("falloff_start", beam, Some(self.value_span(object, "beam_width")));
        let to_world = self.transform(object, "to_world");
        node.with("falloff", "linear").with("to_world", to_world).with("scale", 1.0)
    }

    fn directional(&mut self, object: ObjectId) -> Node {
        let mut node = self.node(Family::Light, "distant", object);
        self.put(&mut node, "radiance", object, "irradiance", Role::Emission, 1.0);
        let span = self.value_span(object, "direction");
        let direction = match self.vec3(object, "direction") {
            Some(d) => {
                self.excludes(object, "direction", "to_world");
                DVec3::from(d)
            }
            None => self.transform(object, "to_world").vector(DVec3::Z),
        };
        match direction.try_normalize() {
            Some(d) => {
                node.set("direction", d.to_array(), Some(span));
            }
            None => self.error(span, "the direction is zero"),
        }
        node.with("scale", 1.0)
    }

    fn environment_map(&mut self, object: ObjectId) -> Option<Node> {
        let mut node = self.node(Family::Light, "environment", object);
        let file = self.needed_file(object, "filename");
        let scale = self.float(object, "scale").unwrap_or(1.0);
        let to_world = self.transform(object, "to_world");
        self.no_effect(object, &["mis_compensation"], NOISE);
        self.no_effect(object, &["cache"], SPEED);
        let extension = file.as_ref().and_then(|f| f.extension()).map(|e| e.to_ascii_lowercase());
        let is_linear = extension.is_some_and(|e| ["exr", "hdr", "pfm"].iter().any(|linear| e == *linear));
        let harmless = if is_linear { &["-1", "1"][..] } else { &["-1"] };
        self.left_out(object, "gamma", harmless, "the encoding is that of the file");
        node.set("file", file?, Some(self.value_span(object, "filename")));
        node.set("scale", scale, Some(self.value_span(object, "scale")));
        // Version 0.6 has texels at the middle of rows.
        let rows = if self.graph.objects[object].legacy { "centers" } else { "poles" };
        Some(node.with("parametrization", "latlong").with("rows", rows).with("to_world", to_world))
    }

    /// A slide projector: like the camera, it has local +x on the left.
    fn projector(&mut self, object: ObjectId) -> Node {
        let mut node = self.node(Family::Light, "projection", object);
        match self.spectral(object, "irradiance", Role::Emission) {
            Some((texture @ Value::Node(_), span)) => node.set("texture", texture, Some(span)),
            Some((spectrum, span)) => node.set("radiance", spectrum, Some(span)),
            None => node.set("radiance", rgb([1.0; 3]), None),
        };
        self.field_of_view(&mut node, object);
        let scale = self.float(object, "scale").unwrap_or(1.0);
        node.set("scale", scale, Some(self.value_span(object, "scale")));
        let to_world = self.transform(object, "to_world") * mirrored_x();
        node.with("to_world", to_world)
    }

    /// A constant, bluish sky in the place of another.
    fn constant_sky(&mut self, object: ObjectId) -> Node {
        let message = format!("there is no emitter '{}'; a constant sky is used", self.plugin(object));
        self.approximated(self.span(object), message);
        let scale = self.float(object, "sky_scale").or_else(|| self.float(object, "scale")).unwrap_or(1.0);
        let node = self.node(Family::Light, "environment", object);
        self.graph.objects[object].props.iter_mut().for_each(|p| p.used = true);
        node.with("radiance", rgb([0.12, 0.17, 0.26].map(|v| v * scale)))
    }

    /// Reports two properties that exclude each other.
    fn excludes(&mut self, object: ObjectId, given: &str, other: &'static str) {
        if self.graph.take(object, other).is_some() {
            self.error(self.value_span(object, other), format!("'{given}' excludes '{other}'"));
        }
    }
}
