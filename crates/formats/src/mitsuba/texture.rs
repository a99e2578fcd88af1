//! Textures, and the properties that hold them.

use super::{
    graph::{Category, ObjectId, Prop, Raw},
    reader::Reader,
    told::SPEED,
};
use steradian_math::{DVec3, Transform};
use steradian_scene::{ColorSpace, Family, Node, NodeId, Span, SpectrumValue, Value};

/// Role of a parameter, which decides how Mitsuba reads a colour in it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Role {
    /// Between 0 and 1.
    Reflectance,
    /// Any size: an index of refraction, an extinction coefficient.
    Unbounded,
    /// Emitted light: plain numbers and colours are multiples of D65.
    Emission,
    /// One number per point: a roughness, an opacity, a height.
    Scalar,
}

/// Wrap modes for texture coordinates outside 0…1; `zero` and `one` are of version 0.6.
const WRAPS: [&str; 5] = ["repeat", "mirror", "clamp", "zero", "one"];

/// Linear sRGB components as a value.
pub(super) fn rgb(components: [f64; 3]) -> Value {
    Value::Spectrum(SpectrumValue::Rgb(components, ColorSpace::Srgb))
}

/// A plain number in a role.
pub(super) fn plain(v: f64, role: Role) -> Value {
    match role {
        Role::Emission => rgb([v; 3]),
        _ => Value::Float(v),
    }
}

/// Constant spectrum in a role. As emission it is not a multiple of D65, so it is spelt out: three components would
/// mean D65.
pub(super) fn flat(v: f64, role: Role) -> Value {
    Value::Spectrum(match role {
        Role::Emission => SpectrumValue::Sampled { lambdas: vec![360.0, 830.0], values: vec![v as f32; 2] },
        _ => SpectrumValue::Constant(v),
    })
}

impl Reader<'_> {
    /// Sets a parameter of a node from a property that may be a number, a spectrum or a texture, or to a default.
    pub fn put(
        &mut self,
        node: &mut Node,
        name: &str,
        object: ObjectId,
        property: &'static str,
        role: Role,
        default: f64,
    ) {
        if !self.put_given(node, name, object, property, role) {
            node.set(name, plain(default, role), None);
        }
    }

    /// Sets a parameter of a node only where the file has the property; whether it does.
    pub fn put_given(
        &mut self,
        node: &mut Node,
        name: &str,
        object: ObjectId,
        property: &'static str,
        role: Role,
    ) -> bool {
        let Some((value, span)) = self.spectral(object, property, role) else { return false };
        node.set(name, value, Some(span));
        true
    }

    /// A property that may be a number, a spectrum or a texture.
    pub fn spectral(&mut self, object: ObjectId, name: &'static str, role: Role) -> Option<(Value, Span)> {
        let prop = self.graph.take(object, name)?;
        self.spectral_of(object, prop, role)
    }

    /// The value of a property that may be a number, a spectrum or a texture.
    pub fn spectral_of(&mut self, object: ObjectId, prop: Prop, role: Role) -> Option<(Value, Span)> {
        let legacy = self.graph.objects[object].legacy;
        let name = &prop.name;
        let value = match prop.value {
            Raw::Float(v) => plain(v, role),
            Raw::Int(v) => plain(v as f64, role),
            Raw::Rgb(c) => {
                let out_of_range = role == Role::Reflectance && c.iter().any(|v| !(0.0..=1.0).contains(v));
                if out_of_range {
                    self.warn(prop.value_span, format!("'{name}' is a reflectance: its components are clamped to 0…1"));
                }
                rgb(if out_of_range { c.map(|v| v.clamp(0.0, 1.0)) } else { c })
            }
            // Mitsuba 0.6 takes one number as the same for red, green and blue.
            Raw::Spectrum(SpectrumValue::Constant(v)) => {
                if legacy {
                    plain(v, role)
                } else {
                    flat(v, role)
                }
            }
            Raw::Spectrum(spectrum) => Value::Spectrum(spectrum),
            Raw::Object(child) if self.graph.objects[child].category == Category::Texture => {
                self.texture(child, role)?
            }
            Raw::Object(child) if self.graph.objects[child].category == Category::Volume => self.volume(child, role)?,
            ref other => {
                let message = format!("'{name}' needs a number, a spectrum or a texture, not {}", other.noun());
                self.error(prop.value_span, message);
                return None;
            }
        };
        Some((value, prop.value_span))
    }

    /// A texture object: a node, or the spectrum that a spectrum plugin stands for.
    pub fn texture(&mut self, object: ObjectId, role: Role) -> Option<Value> {
        if !self.is_known(object) {
            self.unknown_plugin(object);
            return None;
        }
        match self.plugin(object) {
            "uniform" | "rawconstant" | "d65" | "blackbody" | "regular" | "irregular" | "srgb" => {
                if !self.enter(object) {
                    return None;
                }
                let value = self.spectrum_plugin(object, role);
                self.leave();
                value
            }
            _ => self.once(object, role, |r| r.texture_node(object, role)).map(Value::Node),
        }
    }

    fn texture_node(&mut self, object: ObjectId, role: Role) -> Option<NodeId> {
        match self.plugin(object) {
            "bitmap" => self.bitmap(object),
            "checkerboard" => {
                let mut node = self.node(Family::Texture, "checkerboard", object);
                // Evaluated as single numbers, Mitsuba's cells are the other way round.
                let (even, odd) = if role == Role::Scalar { ("b", "a") } else { ("a", "b") };
                self.put(&mut node, even, object, "color0", role, 0.4);
                self.put(&mut node, odd, object, "color1", role, 0.2);
                // One repetition of Mitsuba's board is two cells wide.
                let to_uv = Transform::scale(DVec3::new(2.0, 2.0, 1.0)) * self.uv_map(object).unwrap_or_default();
                node.set("to_uv", to_uv, Some(self.value_span(object, "to_uv"))).set("antialias", false, None);
                Some(self.desc.add(node))
            }
            "volume" => {
                let mut node = self.node(Family::Texture, "constant", object);
                self.put(&mut node, "value", object, "volume", role, 0.75);
                Some(self.desc.add(node))
            }
            "mesh_attribute" => {
                let mut node = self.node(Family::Texture, "mesh_attribute", object);
                let span = self.value_span(object, "name");
                let full = self.string(object, "name").unwrap_or_default();
                let (name, domain) = match (full.strip_prefix("vertex_"), full.strip_prefix("face_")) {
                    (Some(name), _) => (name, "vertex"),
                    (_, Some(name)) => (name, "face"),
                    _ => {
                        self.error(span, "the 'name' of a mesh attribute starts with 'vertex_' or 'face_'");
                        return None;
                    }
                };
                node.set("name", name, Some(span)).set("domain", domain, None);
                let scale = self.float(object, "scale").unwrap_or(1.0);
                node.set("scale", scale, None);
                Some(self.desc.add(node))
            }
            "vertexcolors" => {
                let node = self.node(Family::Texture, "mesh_attribute", object);
                self.graph.objects[object].visited = true;
                Some(self.desc.add(node.with("name", "color").with("domain", "vertex").with("scale", 1.0)))
            }
            "scale" => {
                let mut node = self.node(Family::Texture, "scale", object);
                let (_, inner) = self.graph.children(object, Category::Texture).into_iter().next()?;
                let inner = self.texture(inner, role)?;
                node.set("texture", inner, None);
                self.put(&mut node, "scale", object, "scale", Role::Unbounded, 1.0);
                Some(self.desc.add(node))
            }
            _ => self.verbatim(object, Family::Texture),
        }
    }

    fn bitmap(&mut self, object: ObjectId) -> Option<NodeId> {
        let mut node = self.node(Family::Texture, "image", object);
        let file = self.needed_file(object, "filename");
        // The first is the default. Trilinear and elliptical filters are of 0.6, where the latter is the default.
        let legacy = self.graph.objects[object].legacy;
        let filters = if legacy {
            ["ewa", "trilinear", "nearest", "bilinear"]
        } else {
            ["bilinear", "nearest", "trilinear", "ewa"]
        };
        let filter = self.choice(object, "filter_type", &filters);
        let wrap = self.choice(object, "wrap_mode", &WRAPS);
        let wraps = ["wrap_mode_u", "wrap_mode_v"]
            .map(|n| if self.graph.has(object, n) { self.choice(object, n, &WRAPS) } else { wrap });
        let [wrap_u, wrap_v] = wraps.map(|w| if w == "zero" { "black" } else { w });
        let raw = self.bool(object, "raw").unwrap_or(false);
        // `gamma` is what 0.6 decodes with: 1 is linear, -1 finds out.
        let encoding = match self.float(object, "gamma") {
            Some(1.0) => Value::from("linear"),
            Some(gamma) if gamma > 0.0 => Value::Float(gamma),
            _ => Value::from("auto"),
        };
        if let Some(to_uv) = self.uv_map(object) {
            node.set("to_uv", to_uv, Some(self.value_span(object, "to_uv")));
        }
        // Both are of 0.6.
        if filter == "ewa" {
            let most = self.float(object, "max_anisotropy").or(legacy.then_some(20.0));
            if let Some(most) = most {
                node.set("max_anisotropy", Value::Float(most), Some(self.value_span(object, "max_anisotropy")));
            }
        } else {
            self.no_effect(object, &["max_anisotropy"], "only the filter 'ewa' has it");
        }
        if self.graph.has(object, "channel") {
            let channel = self.choice(object, "channel", &["all", "r", "g", "b", "a"]);
            let ours = if channel == "all" { "color" } else { channel };
            node.set("channel", ours, Some(self.value_span(object, "channel")));
        }
        self.no_effect(object, &["accel", "cache"], SPEED);
        self.no_effect(object, &["format"], "pictures keep the precision of their files");
        node.set("file", file?, Some(self.value_span(object, "filename")));
        for (name, value) in [("filter", filter), ("wrap_u", wrap_u), ("wrap_v", wrap_v), ("origin", "top")] {
            node.set(name, value, None);
        }
        node.set("encoding", encoding, None).set("raw", raw, None);
        Some(self.desc.add(node))
    }

    /// Numbers on a grid that fills the unit cube of its own space.
    fn grid(&mut self, object: ObjectId) -> Option<NodeId> {
        let mut node = self.node(Family::Texture, "grid", object);
        let file = self.needed_file(object, "filename");
        let filter = self.choice(object, "filter_type", &["trilinear", "nearest"]);
        let wrap = self.choice(object, "wrap_mode", &["clamp", "repeat", "mirror"]);
        let use_bounds = self.bool(object, "use_grid_bbox").unwrap_or(false);
        if let Some(to_world) = self.some_transform(object, "to_world") {
            let span = self.value_span(object, "to_world");
            match to_world.inverse() {
                Some(inverse) => _ = node.set("texture_from_world", inverse, Some(span)),
                None => self.error(span, "the transform of this volume cannot be inverted"),
            }
        }
        self.no_effect(object, &["raw"], "numbers on a grid are taken as they stand");
        self.no_effect(object, &["accel", "max_value"], SPEED);
        node.set("file", file?, Some(self.value_span(object, "filename")));
        node.set("filter", filter, None).set("wrap", wrap, None).set("use_grid_bounds", use_bounds, None);
        Some(self.desc.add(node))
    }

    /// The map of texture coordinates, if any. On a disk Mitsuba has u from the centre to the rim and v around it,
    /// Steradian u around and v from the rim to the centre: u' = 1 - v, v' = u comes first.
    fn uv_map(&mut self, object: ObjectId) -> Option<Transform> {
        let given = self.some_transform(object, "to_uv");
        if !self.on_disk {
            return given;
        }
        let disk = Transform::from_rows([0., -1., 0., 1., 1., 0., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1.]);
        Some(given.unwrap_or_default() * disk)
    }

    /// A texture times a number.
    pub fn scaled(&mut self, object: ObjectId, texture: Value, scale: f64) -> NodeId {
        let node = Node::new(Family::Texture, "scale", Some(self.span(object)));
        self.desc.add(node.with("texture", texture).with("scale", scale))
    }

    /// Notes the place of a constant, unless a medium took it for its own.
    fn constant_place(&mut self, object: ObjectId) {
        if self.graph.objects[object].props.iter().any(|p| p.name == "to_world" && !p.used) {
            self.no_effect(object, &["to_world"], "a constant is the same everywhere");
        }
    }

    /// A volume where a constant is needed: that of `constvolume`, else the volume under its own name.
    pub fn volume(&mut self, object: ObjectId, role: Role) -> Option<Value> {
        match self.plugin(object) {
            "constvolume" => {
                if !self.enter(object) {
                    return None;
                }
                let value = self.spectral(object, "value", role).map(|(v, _)| v);
                self.constant_place(object);
                self.leave();
                value
            }
            "gridvolume" => self.once(object, role, |r| r.grid(object)).map(Value::Node),
            _ if self.is_known(object) => {
                self.once(object, role, |r| r.verbatim(object, Family::Texture)).map(Value::Node)
            }
            _ => {
                self.unknown_plugin(object);
                None
            }
        }
    }
}
