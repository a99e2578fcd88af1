//! Emitters.

use super::{Element, Role, Writer, matrix, triple};
use crate::write::{
    colour::Colour,
    exchange::{Source, spot_flux},
};
use std::f64::consts::PI;
use steradian_math::{DVec3, Transform};
use steradian_scene::{Format, Node, NodeId, Value};

impl Writer<'_> {
    /// An emitter that stands in the scene by itself.
    pub(super) fn light(&mut self, id: NodeId) {
        let node = self.x.node(id);
        let to_world = match node.get("to_world") {
            Some(Value::Transform(t)) => *t,
            _ => Transform::IDENTITY,
        };
        let element = match node.kind.as_str() {
            "point" => Some(self.point(node, &to_world)),
            "spot" => Some(self.spot(node, &to_world)),
            "distant" => Some(self.distant(node)),
            "environment" => self.environment(node, &to_world),
            "sky" => Some(self.sky(node, &to_world)),
            "goniometric" => {
                self.x
                    .approximated(node, "Mitsuba has no light by directions; it shines evenly, as bright as its mean");
                let mut out = self.emitter("point", node);
                let mean = self.x.developed(node, [1.0; 3]).and_then(|p| mean(&p)).unwrap_or([1.0; 3]);
                let k = self.x.light_scale(node, "intensity", "power", 4.0 * PI);
                let tint = match self.x.emission(node, "intensity") {
                    Source::Plain(c) => c.scaled(k).with(&Colour::Rgb(mean), |a, b| a * b),
                    Source::Texture(_) => Colour::Rgb(mean).scaled(k),
                };
                out.push(super::colour("intensity", &tint, Role::Emission));
                out.push(matrix("to_world", &to_world));
                Some(out)
            }
            "projection" => self.projection(node, &to_world),
            other => {
                self.x.dropped(node, format!("light '{other}' cannot be expressed and is left out"));
                None
            }
        };
        if let Some(element) = element {
            self.scene.push(element);
        }
    }

    fn emitter(&mut self, plugin: &str, node: &Node) -> Element {
        let out = Element::plugin("emitter", plugin);
        match &node.name {
            Some(name) => out.with("id", self.x.name(Some(name), plugin)),
            None => out,
        }
    }

    fn point(&mut self, node: &Node, to_world: &Transform) -> Element {
        let mut out = self.emitter("point", node);
        let k = self.x.light_scale(node, "intensity", "power", 4.0 * PI);
        let intensity = self.x.emission(node, "intensity");
        self.put_scaled(&mut out, "intensity", &intensity, Role::Emission, k);
        let position = match node.get("position") {
            Some(Value::Vec3(p)) => DVec3::from(*p),
            _ => DVec3::ZERO,
        };
        let [x, y, z] = to_world.point(position).to_array().map(|v| v.to_string());
        out.push(Element::new("point").named("position").with("x", x).with("y", y).with("z", z));
        out
    }

    fn spot(&mut self, node: &Node, to_world: &Transform) -> Element {
        let mut out = self.emitter("spot", node);
        let cone = node.float("cone_angle").unwrap_or(30.0);
        let start = node.float("falloff_start").unwrap_or(25.0).clamp(0.0, cone);
        let k = self.x.light_scale(node, "intensity", "power", spot_flux(cone, start));
        let intensity = self.x.emission(node, "intensity");
        self.put_scaled(&mut out, "intensity", &intensity, Role::Emission, k);
        out.float("cutoff_angle", cone);
        out.float("beam_width", start);
        if start < cone && node.string("falloff").unwrap_or("smoothstep") != "linear" {
            self.x.approximated(node, "the spot's edge falls off linearly with the angle instead of smoothly");
        }
        if let Some(texture) = self.x.source(node, "texture") {
            self.put(&mut out, "texture", &texture, Role::Unbounded);
        }
        out.push(matrix("to_world", to_world));
        out
    }

    fn distant(&mut self, node: &Node) -> Element {
        let mut out = self.emitter("directional", node);
        let k = self.x.light_scale(node, "radiance", "illuminance", 1.0);
        let radiance = self.x.emission(node, "radiance");
        self.put_scaled(&mut out, "irradiance", &radiance, Role::Emission, k);
        let direction = match node.get("direction") {
            Some(Value::Vec3(d)) => *d,
            _ => [0.0, 0.0, 1.0],
        };
        out.push(Element::new("vector").named("direction").with("value", triple(direction)));
        out
    }

    fn environment(&mut self, node: &Node, to_world: &Transform) -> Option<Element> {
        if node.get("portal").is_some() {
            self.x.dropped(node, "the 'portal' of an environment is left out; light comes from all sides");
        }
        let Some(file) = node.path("file") else {
            let mut out = self.emitter("constant", node);
            let k = self.x.light_scale(node, "radiance", "illuminance", PI);
            let radiance = self.x.emission(node, "radiance");
            self.put_scaled(&mut out, "radiance", &radiance, Role::Emission, k);
            return Some(out);
        };
        if node.get("illuminance").is_some() {
            self.x.dropped(node, "'illuminance' of a picture around the scene is left out; its own numbers count");
        }
        let texels = self.x.texels(node, file)?;
        let square = texels.width == texels.height;
        let octahedral = match node.string("parametrization") {
            Some("octahedral") => true,
            Some("latlong") => false,
            _ => square,
        };
        let z_up = octahedral || self.x.desc.format == Format::Pbrt;
        let file = if octahedral {
            self.x.approximated(node, "the octahedral picture around the scene is resampled by longitude and latitude");
            self.x.resampled_environment(node, file, false)?
        } else {
            if node.string("rows") != Some("poles") {
                self.x.approximated(
                    node,
                    "rows of the picture around the scene stand at the poles, not half a row inside",
                );
            }
            self.x.beside.path(file)
        };
        let mut out = self.emitter("envmap", node);
        out.string("filename", &file);
        let k = self.x.light_scale(node, "radiance", "", 1.0);
        let (tint, k) = match self.x.source(node, "radiance") {
            Some(Source::Plain(Colour::Grey(v))) => (None, v * k),
            Some(Source::Plain(Colour::Rgb([r, g, b]))) if r == g && g == b => (None, r * k),
            None => (None, k),
            other => (other, k),
        };
        if tint.is_some() {
            self.x.approximated(node, "the colour that a picture around the scene is multiplied by is left out");
        }
        out.float("scale", k);
        // Longitudes start at local +z and run the other way round the +y axis.
        let turn = Transform::from_rows([0., 0., -1., 0., 1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 0., 1.]);
        out.push(matrix("to_world", &if z_up { *to_world * turn } else { *to_world }));
        Some(out)
    }

    fn sky(&mut self, node: &Node, to_world: &Transform) -> Element {
        let mut out = self.emitter("sunsky", node);
        for name in ["turbidity", "latitude", "longitude", "timezone", "hour", "minute", "second", "sun_aperture"] {
            if let Some(v) = node.float(name) {
                out.float(name, v);
            }
        }
        for name in ["year", "month", "day"] {
            if let Some(v) = node.int(name) {
                out.integer(name, v);
            }
        }
        if let Some(Value::Vec3(d)) = node.get("sun_direction") {
            out.push(Element::new("vector").named("sun_direction").with("value", triple(*d)));
        }
        if let Some(albedo) = self.x.source(node, "albedo") {
            self.put(&mut out, "albedo", &albedo, Role::Reflectance);
        }
        let scale = node.float("scale").unwrap_or(1.0) * self.x.gain;
        for name in ["sun_scale", "sky_scale"] {
            out.float(name, node.float(name).unwrap_or(1.0) * scale);
        }
        if node.string("sun_rgb") != Some("mitsuba") && node.float("sun_scale") != Some(0.0) {
            self.x.approximated(node, "the RGB variants of Mitsuba show the sun brighter, by 5 to 9 %");
        }
        out.boolean("complex_sun", node.bool("limb_darkening").unwrap_or(true));
        // Its own +x is south, +y west.
        out.push(matrix("to_world", &(*to_world * Transform::scale(DVec3::new(-1.0, -1.0, 1.0)))));
        out
    }

    fn projection(&mut self, node: &Node, to_world: &Transform) -> Option<Element> {
        let mut out = self.emitter("projector", node);
        if node.get("power").is_some() {
            self.x.dropped(node, "'power' of a projector is left out; its picture's own numbers count");
        }
        let name = ["texture", "radiance"].into_iter().find(|n| node.get(n).is_some()).unwrap_or("radiance");
        let is_irradiance = self.x.desc.format == Format::Mitsuba;
        let scale = node.float("scale").unwrap_or(1.0) * self.x.gain * if is_irradiance { 1.0 } else { 1.0 / PI };
        if node.get("file").is_some() {
            // v = 0 is the top of a slide.
            let mut slide = Element::plugin("texture", "bitmap").named("irradiance");
            let file = self.x.beside.path(node.path("file")?);
            slide.string("filename", &file);
            slide.string("wrap_mode", "clamp");
            out.push(slide);
        } else {
            let source = self.x.emission(node, name);
            self.put(&mut out, "irradiance", &source, Role::Emission);
        }
        out.float("scale", scale);
        out.float("fov", node.float("fov").unwrap_or(90.0));
        out.string("fov_axis", node.string("fov_axis").unwrap_or("smaller"));
        let mirrored = Transform::scale(DVec3::new(-1.0, 1.0, 1.0));
        out.push(matrix("to_world", &(*to_world * mirrored)));
        Some(out)
    }

    /// The emitter of a shape of that area.
    pub(super) fn area_light(&mut self, id: NodeId, area: f64) -> Option<Element> {
        let node = self.x.node(id);
        let plugin = match node.kind.as_str() {
            "area" => "area",
            "directional_area" => "directionalarea",
            other => {
                self.x.dropped(node, format!("emission '{other}' cannot be expressed and is left out"));
                return None;
            }
        };
        let mut out = self.emitter(plugin, node);
        let two_sided = node.bool("two_sided").unwrap_or(false);
        if two_sided {
            self.x.approximated(node, "an area light that emits on both sides emits on its front only");
        }
        if let Some(file) = node.path("file") {
            if node.get("power").is_some() {
                self.x.dropped(node, "'power' of a light with a picture is left out; the picture's own numbers count");
            }
            let k = self.x.light_scale(node, "", "", 1.0);
            let file = self.x.beside.path(file);
            let mut picture = Element::plugin("texture", "bitmap").named("nested");
            picture.string("filename", &file);
            let mut lit = Element::plugin("spectrum", "d65").named("radiance");
            lit.push(picture);
            lit.float("scale", k);
            return Some(out.child(lit));
        }
        let sides = if two_sided { 2.0 } else { 1.0 };
        let k = self.x.light_scale(node, "radiance", "power", sides * area * PI);
        let radiance = self.x.emission(node, "radiance");
        self.put_scaled(&mut out, "radiance", &radiance, Role::Emission, k);
        Some(out)
    }
}

/// The mean colour of a picture.
fn mean(image: &steradian_image::Image) -> Option<[f64; 3]> {
    let n = image.pixel_count().max(1) as f64;
    let plane = |c: &str| Some(image.channel(c)?.iter().map(|v| f64::from(*v)).sum::<f64>() / n);
    Some([plane("R")?, plane("G")?, plane("B")?])
}
