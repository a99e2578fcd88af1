//! Lights.

use super::{Directive, Writer, place};
use crate::write::{colour::Colour, exchange::Source};
use std::f64::consts::PI;
use steradian_math::{DVec3, Transform};
use steradian_scene::{Format, Node, NodeId, Value};

impl Writer<'_> {
    /// The spectrum, the scale, and the power of a light. pbrt brings spectra that are not RGB to luminance one.
    fn emission(&mut self, out: &mut Directive, node: &Node, from: &str, to: &str, target: &str, k: f64) {
        let mut scale = node.float("scale").unwrap_or(1.0) * k;
        match self.x.emission(node, from) {
            Source::Plain(c) => {
                if !node.bool("normalize").unwrap_or(false) && !matches!(c, Colour::Rgb(_)) {
                    scale *= c.luminance();
                }
                if !c.is_black() {
                    out.emission(to, &c);
                } else {
                    out.spectrum(to, &Colour::Rgb([0.0; 3]));
                }
            }
            Source::Texture(_) => self.x.approximated(node, format!("the texture of the light's '{from}' is left out")),
        }
        if let Some(power) = self.x.luminous_target(node, from, target) {
            // A power counts instead of what the numbers come to, but is multiplied by the scale.
            out.float(target, power);
        }
        if scale * self.x.gain != 1.0 {
            out.float("scale", scale * self.x.gain);
        }
    }

    pub(super) fn light(&mut self, id: NodeId) {
        let node = self.x.node(id);
        let to_world = place(node, "to_world");
        let (out, at) = match node.kind.as_str() {
            "point" => {
                let mut out = Directive::new("LightSource", &["point"]);
                self.emission(&mut out, node, "intensity", "I", "power", 1.0);
                let p = match node.get("position") {
                    Some(Value::Vec3(p)) => DVec3::from(*p),
                    _ => DVec3::ZERO,
                };
                out.floats("point3", "from", to_world.point(p).to_array());
                (out, Transform::IDENTITY)
            }
            "spot" => {
                let mut out = Directive::new("LightSource", &["spot"]);
                self.emission(&mut out, node, "intensity", "I", "power", 1.0);
                let cone = node.float("cone_angle").unwrap_or(30.0);
                let start = node.float("falloff_start").unwrap_or(25.0).clamp(0.0, cone);
                out.float("coneangle", cone);
                out.float("conedeltaangle", cone - start);
                if start < cone && node.string("falloff").is_some_and(|f| f != "smoothstep") {
                    self.x.approximated(node, "the spot's edge falls off smoothly instead of linearly with the angle");
                }
                self.x.without(node, &["texture"]);
                (out, to_world)
            }
            "distant" => {
                let mut out = Directive::new("LightSource", &["distant"]);
                self.emission(&mut out, node, "radiance", "L", "illuminance", 1.0);
                let direction = match node.get("direction") {
                    Some(Value::Vec3(d)) => *d,
                    _ => [0.0, 0.0, 1.0],
                };
                out.floats("point3", "from", [0.0; 3]);
                out.floats("point3", "to", direction);
                (out, Transform::IDENTITY)
            }
            "environment" => match self.environment(node, to_world) {
                Some(both) => both,
                None => return,
            },
            "goniometric" => {
                let mut out = Directive::new("LightSource", &["goniometric"]);
                self.emission(&mut out, node, "intensity", "I", "power", 1.0);
                let file = node.path("file").map(|f| self.x.beside.path(f)).unwrap_or_default();
                out.string("filename", &file);
                // pbrt swaps y and z before it looks a direction up.
                let swap = Transform::from_rows([1., 0., 0., 0., 0., 0., 1., 0., 0., 1., 0., 0., 0., 0., 0., 1.]);
                (out, to_world * swap)
            }
            "projection" => match self.projection(node) {
                Some(out) => (out, to_world),
                None => return,
            },
            other => {
                self.x.dropped(node, format!("light '{other}' cannot be expressed and is left out"));
                return;
            }
        };
        self.line("AttributeBegin");
        self.depth += 1;
        if at != Transform::IDENTITY {
            self.transform(&at);
        }
        self.put(&out);
        self.depth -= 1;
        self.line("AttributeEnd");
    }

    fn environment(&mut self, node: &Node, to_world: Transform) -> Option<(Directive, Transform)> {
        let mut out = Directive::new("LightSource", &["infinite"]);
        let portal = match node.get("portal") {
            Some(Value::Floats(p)) => Some(p.clone()),
            _ => None,
        };
        if let Some(portal) = portal {
            out.floats("point3", "portal", portal);
        }
        let Some(file) = node.path("file") else {
            self.emission(&mut out, node, "radiance", "L", "illuminance", 1.0);
            return Some((out, to_world));
        };
        let mut k = 1.0;
        match self.x.source(node, "radiance") {
            None => {}
            Some(Source::Plain(Colour::Rgb([r, g, b]))) if r == g && g == b => k = r,
            Some(Source::Plain(Colour::Grey(v))) => k = v,
            Some(_) => {
                self.x.approximated(node, "the colour that a picture around the scene is multiplied by is left out");
            }
        }
        let texels = self.x.texels(node, file)?;
        let octahedral = match node.string("parametrization") {
            Some("octahedral") => true,
            Some("latlong") => false,
            _ => texels.width == texels.height,
        };
        let mut at = to_world;
        let name = if octahedral {
            self.x.beside.path(file)
        } else {
            let what = "the picture around the scene, by longitude and latitude, is resampled to pbrt's octahedral map";
            self.x.approximated(node, what);
            if self.x.desc.format != Format::Pbrt {
                // pbrt's +z is up, and its longitudes start elsewhere.
                at = to_world * Transform::from_rows([0., 1., 0., 0., 0., 0., 1., 0., -1., 0., 0., 0., 0., 0., 0., 1.]);
            }
            self.x.resampled_environment(node, file, true)?
        };
        out.string("filename", &name);
        if let Some(target) = self.x.luminous_target(node, "radiance", "illuminance") {
            out.float("illuminance", target);
        }
        out.float("scale", node.float("scale").unwrap_or(1.0) * k * self.x.gain);
        Some((out, at))
    }

    fn projection(&mut self, node: &Node) -> Option<Directive> {
        let file = match (node.path("file"), self.x.source(node, "texture")) {
            (Some(file), _) => Some(self.x.beside.path(file)),
            (None, Some(Source::Texture(id))) if self.x.node(id).kind == "image" => {
                self.x.node(id).path("file").map(|f| self.x.beside.path(f))
            }
            (None, None) => match self.x.emission(node, "radiance") {
                Source::Plain(c) => self.x.plain_picture(c.emitted_rgb()),
                Source::Texture(_) => None,
            },
            _ => None,
        };
        let Some(file) = file else {
            self.x.dropped(node, "a projector without a picture cannot be expressed and is left out");
            return None;
        };
        let mut out = Directive::new("LightSource", &["projection"]);
        out.string("filename", &file);
        if node.string("fov_axis").unwrap_or("smaller") != "smaller" {
            self.x.approximated(node, "the angle of a projector is that of its shorter axis");
        }
        out.float("fov", node.float("fov").unwrap_or(90.0));
        let unit = if self.x.desc.format == Format::Mitsuba { PI } else { 1.0 };
        out.float("scale", node.float("scale").unwrap_or(1.0) * unit * self.x.gain);
        if let Some(power) = self.x.luminous_target(node, "", "power") {
            out.float("power", power);
        }
        Some(out)
    }

    /// The emission of the shapes that follow; whether there is any.
    pub(super) fn area_light(&mut self, id: NodeId) {
        let node = self.x.node(id);
        if node.kind != "area" {
            self.x.dropped(node, format!("emission '{}' cannot be expressed and is left out", node.kind));
            return;
        }
        let mut out = Directive::new("AreaLightSource", &["diffuse"]);
        let picture = match (node.path("file"), self.x.source(node, "radiance")) {
            (Some(file), _) => Some(self.x.beside.path(file)),
            (None, Some(Source::Texture(texture))) => {
                let texture = self.x.node(texture);
                let file = texture.path("file").filter(|_| texture.kind == "image" && self.x.is_plain(texture));
                file.map(|f| {
                    if texture.string("origin") != Some("top") {
                        self.x.approximated(texture, "an emitted picture has its first row at v = 0");
                    }
                    self.x.beside.path(f)
                })
            }
            _ => None,
        };
        match picture {
            Some(file) => {
                out.string("filename", &file);
                out.float("scale", node.float("scale").unwrap_or(1.0) * self.x.gain);
                if let Some(power) = self.x.luminous_target(node, "", "power") {
                    out.float("power", power);
                }
            }
            None => self.emission(&mut out, node, "radiance", "L", "power", 1.0),
        }
        if node.bool("two_sided").unwrap_or(false) {
            out.bool("twosided", true);
        }
        self.put(&out);
    }
}
