//! State shared by all writers: values of nodes as formats can hold them, light in absolute numbers, names, and the
//! report of losses.

use super::colour::Colour;
use crate::companion_files::Beside;
use std::{
    collections::{BTreeMap, HashSet},
    f64::consts::PI,
    path::Path,
};
use steradian_math::{DVec3, Transform, spectra::photometry::photometric_from_y};
use steradian_scene::{Diagnostics, Format, Node, NodeId, SceneDesc, Value};

/// A parameter that may be textured.
#[derive(Clone, Debug)]
pub(crate) enum Source {
    Plain(Colour),
    Texture(NodeId),
}

/// The parts of a writer that do not depend on the format.
#[derive(Debug)]
pub(crate) struct Exchange<'a> {
    pub desc: &'a SceneDesc,
    pub beside: Beside<'a>,
    pub diagnostics: Diagnostics,
    /// Factor on emission in place of the film's exposure.
    pub gain: f64,
    taken: HashSet<String>,
    /// Pictures that were made, by what they show.
    pub made: BTreeMap<String, String>,
}

impl<'a> Exchange<'a> {
    pub fn new(desc: &'a SceneDesc, path: &Path) -> Self {
        let film = desc.film.map(|f| desc.node(f));
        let number = |name: &str, default: f64| film.and_then(|f| f.float(name)).unwrap_or(default);
        Self {
            desc,
            beside: Beside::new(desc, path),
            diagnostics: Diagnostics::default(),
            gain: number("exposure_time", 1.0) * number("iso", 100.0) / 100.0,
            taken: HashSet::new(),
            made: BTreeMap::new(),
        }
    }

    pub fn node(&self, id: NodeId) -> &'a Node {
        self.desc.node(id)
    }

    /// Says that something else stands for a construct.
    pub fn approximated(&mut self, node: &Node, message: impl Into<String>) {
        self.diagnostics.approximated(&self.desc.sources, node.span, message);
    }

    /// Says that a construct is left out.
    pub fn dropped(&mut self, node: &Node, message: impl Into<String>) {
        self.diagnostics.dropped(&self.desc.sources, node.span, message);
    }

    /// Says that what moves stands still in the format, as at the beginning of its motion.
    pub fn stands_still(&mut self, format: &str) {
        let moving = self.desc.instances.iter().filter(|i| i.movement.is_some()).map(|i| i.span);
        let cameras = self.desc.cameras.iter().map(|c| self.desc.node(*c));
        let cameras = cameras.filter(|c| c.get("to_world_end").is_some()).map(|c| c.span);
        for span in moving.chain(cameras).collect::<Vec<_>>() {
            let what = format!("{format} has no motion: this stands still, as at the beginning of its motion");
            self.diagnostics.dropped(&self.desc.sources, span, what);
        }
    }

    /// When motions begin and end, as parts of the exposure; where they differ that of the first counts, which is said.
    /// `None` where nothing moves while the shutter is open.
    pub fn motion_times(&mut self) -> Option<[f64; 2]> {
        let camera = self.desc.cameras.first().map(|c| self.desc.node(*c));
        let shutter = |name, default| camera.and_then(|c| c.float(name)).unwrap_or(default);
        let (open, close) = (shutter("shutter_open", 0.0), shutter("shutter_close", 1.0));
        let of_camera = camera.filter(|c| c.get("to_world_end").is_some()).map(|c| {
            let times = c.floats("motion_times").and_then(|t| <[f64; 2]>::try_from(t).ok()).unwrap_or([0.0, 1.0]);
            (times, c.span)
        });
        let of_instances = self.desc.instances.iter().filter_map(|i| Some((i.movement?.times, i.span)));
        let all: Vec<_> = of_camera.into_iter().chain(of_instances).collect();
        let (first, _) = *all.first()?;
        for (_, span) in all.iter().filter(|(times, _)| *times != first) {
            let what = "all motions last as long as the first: the format has one pair of times";
            self.diagnostics.approximated(&self.desc.sources, *span, what);
        }
        (close > open).then(|| first.map(|t| (t - open) / (close - open)))
    }

    /// Says what changes nothing in the expected picture.
    pub fn note(&mut self, node: &Node, message: impl Into<String>) {
        self.diagnostics.note(&self.desc.sources, node.span, message);
    }

    /// Says of parameters that are set, to anything but what they are without being set, and that the format has no
    /// word for that they are left out.
    pub fn without(&mut self, node: &Node, names: &[&str]) {
        for name in names.iter().filter(|n| node.get(n).is_some_and(|value| !is_default(n, value))) {
            let what = format!("'{name}' of {} '{}' is left out", node.family.noun(), node.kind);
            self.dropped(node, what);
        }
    }

    /// A name that nothing else in the document has, of letters that every format takes.
    pub fn name(&mut self, wanted: Option<&str>, kind: &str) -> String {
        let plain = |c: char| if c.is_ascii_alphanumeric() || c == '-' || c == '_' { c } else { '_' };
        let wanted: String = wanted.unwrap_or(kind).trim_start_matches('_').chars().map(plain).collect();
        let wanted = if wanted.is_empty() { kind.to_owned() } else { wanted };
        let mut name = wanted.clone();
        for i in 2.. {
            if self.taken.insert(name.clone()) {
                break;
            }
            name = format!("{wanted}-{i}");
        }
        name
    }

    /// Value or texture of a parameter; textures of constants are constants.
    pub fn source(&self, node: &Node, name: &str) -> Option<Source> {
        node.get(name).map(|v| self.source_of(v, 0))
    }

    pub fn source_or(&self, node: &Node, name: &str, default: f64) -> Source {
        self.source(node, name).unwrap_or(Source::Plain(Colour::Grey(default)))
    }

    /// The parameter of a layered surface that has the colour of its diffuse base, where formats do not follow light
    /// below surfaces, which is told.
    pub fn base_color_of(&mut self, node: &Node) -> &'static str {
        let is_openpbr = node.kind == "openpbr";
        let weight = if is_openpbr { "subsurface_weight" } else { "subsurface" };
        let share = match self.source(node, weight) {
            Some(Source::Plain(c)) => c.mean(),
            Some(Source::Texture(_)) => 0.5,
            None => 0.0,
        };
        if share <= 0.0 {
            return "base_color";
        }
        let what =
            format!("'{weight}' of '{}' is left out: what light brings from below the surface is diffuse", node.kind);
        self.approximated(node, what);
        let has_own = is_openpbr || node.get("subsurface_color").is_some();
        if share >= 0.5 && has_own { "subsurface_color" } else { "base_color" }
    }

    fn source_of(&self, value: &Value, depth: usize) -> Source {
        let id = match value {
            Value::Float(v) => return Source::Plain(Colour::Grey(*v)),
            Value::Int(v) => return Source::Plain(Colour::Grey(*v as f64)),
            Value::Vec3(v) => return Source::Plain(Colour::Rgb(*v)),
            Value::Spectrum(s) => return Source::Plain(Colour::of(s)),
            Value::Node(id) => *id,
            _ => return Source::Plain(Colour::Grey(0.0)),
        };
        let node = self.node(id);
        let part = |name: &str, default: f64| match node.get(name) {
            Some(v) if depth < 64 => self.source_of(v, depth + 1),
            _ => Source::Plain(Colour::Grey(default)),
        };
        match node.kind.as_str() {
            "constant" => part("value", 1.0),
            "scale" => match (part("texture", 1.0), part("scale", 1.0)) {
                (Source::Plain(a), Source::Plain(b)) => Source::Plain(a.with(&b, |a, b| a * b)),
                (Source::Texture(a), Source::Plain(Colour::Grey(1.0))) => Source::Texture(a),
                _ => Source::Texture(id),
            },
            "mix" => match (part("a", 0.0), part("b", 1.0), part("amount", 0.5)) {
                (Source::Plain(a), Source::Plain(b), Source::Plain(t)) => {
                    let (a, b) = (a.with(&t, |a, t| a * (1.0 - t)), b.with(&t, |b, t| b * t));
                    Source::Plain(a.with(&b, |a, b| a + b))
                }
                _ => Source::Texture(id),
            },
            "add" => match (part("a", 0.0), part("b", 0.0)) {
                (Source::Plain(a), Source::Plain(b)) => Source::Plain(a.with(&b, |a, b| a + b)),
                _ => Source::Texture(id),
            },
            _ => Source::Texture(id),
        }
    }

    /// Substitute colour for a texture that a format lacks: the mean of the two ends of its range.
    pub fn stand_in(&mut self, id: NodeId) -> Colour {
        let node = self.node(id);
        let ends = [("a", 0.0), ("b", 1.0)].map(|(name, default)| match self.source_or(node, name, default) {
            Source::Plain(c) => c,
            Source::Texture(_) => Colour::Grey(0.5),
        });
        self.approximated(node, format!("texture '{}' cannot be expressed; one colour stands for it", node.kind));
        match (node.kind.as_str(), self.source(node, "texture"), self.source(node, "scale")) {
            ("scale", Some(Source::Plain(c)), _) | ("scale", _, Some(Source::Plain(c))) => c.scaled(0.5),
            _ => ends[0].with(&ends[1], |a, b| 0.5 * (a + b)),
        }
    }

    /// A roughness α: numbers as α, textures as they are where the material takes α itself.
    pub fn alpha(&mut self, node: &Node, name: &str) -> Source {
        let remap = node.bool("remap_roughness").unwrap_or(false);
        match self.source_or(node, name, 0.0) {
            Source::Plain(c) => Source::Plain(Colour::Grey(if remap { c.mean().max(0.0).sqrt() } else { c.mean() })),
            texture => {
                if remap {
                    let what = format!("the texture '{name}' of material '{}' is taken as α, not as α²", node.kind);
                    self.approximated(node, what);
                }
                texture
            }
        }
    }

    /// Factor on the emission of a light: its scale, its normalisation, the exposure, and the factor that reaches its
    /// power, where `flux` is that of one unit.
    pub fn light_scale(&mut self, light: &Node, quantity: &str, target: &str, flux: f64) -> f64 {
        if ["on", "off", "period"].iter().any(|name| light.get(name).is_some()) {
            self.dropped(light, "when a light goes on and off is left out: it always shines");
        }
        let mut k = light.float("scale").unwrap_or(1.0) * self.gain;
        if light.bool("normalize").unwrap_or(false)
            && let Some(Source::Plain(c)) = self.source(light, quantity)
            && !matches!(c, Colour::Rgb(_))
            && c.luminance() > 0.0
        {
            k /= c.luminance();
        }
        if let Some(power) = self.luminous_target(light, quantity, target) {
            k *= power / flux;
        }
        k
    }

    /// Ratio of the flux or illuminance `target` of a light (lm or lx, converted to units of the scene's radiance) to
    /// that of one unit of its emission `quantity`; to that of white where the light is normalised.
    pub fn luminous_target(&self, light: &Node, quantity: &str, target: &str) -> Option<f64> {
        let unit = if self.desc.format == Format::Gltf { 1.0 } else { photometric_from_y(1.0) };
        let power = light.float(target).filter(|p| *p > 0.0)? / unit;
        let luminance = match self.source(light, quantity) {
            Some(Source::Plain(c)) if !light.bool("normalize").unwrap_or(false) => c.luminance(),
            _ => 1.0,
        };
        (luminance > 0.0).then_some(power / luminance)
    }

    /// The emission of a light in absolute numbers; white where the light names none.
    pub fn emission(&self, light: &Node, quantity: &str) -> Source {
        self.source(light, quantity).unwrap_or(Source::Plain(Colour::Rgb([1.0; 3])))
    }
}

/// True if a value equals the default of an absent parameter.
fn is_default(name: &str, value: &Value) -> bool {
    let number = match value {
        Value::Float(v) => Some(*v),
        Value::Int(v) => Some(*v as f64),
        _ => None,
    };
    match name {
        "lens_radius"
        | "anisotropy_rotation"
        | "displacement_middle"
        | "edge_pixels"
        | "film_thickness"
        | "white_balance"
        | "bump"
        | "displacement" => number == Some(0.0),
        "normal_map_strength" | "coat_normal_map_strength" | "displacement_scale" | "alpha" => number == Some(1.0),
        "gamma" => number == Some(2.0),
        "film_eta" => number == Some(1.33),
        "max_component" => number == Some(f64::INFINITY),
        "displacement_vector" => matches!(value, Value::Bool(false)),
        "normal_map_filter" | "compensation" => matches!(value, Value::String(word) if word == "none"),
        "fresnel" => matches!(value, Value::String(word) if word == "exact" || word == "dielectric"),
        "sensor" => matches!(value, Value::String(word) if word == "cie1931"),
        "coat_normals" => matches!(value, Value::String(word) if word == "base"),
        "normal_map_code" => matches!(value, Value::String(word) if word == "xyz"),
        _ => false,
    }
}

/// Flux of a spot of intensity one with smooth falloff.
pub(crate) fn spot_flux(cone: f64, start: f64) -> f64 {
    let (c, s) = (cone.to_radians().cos(), start.to_radians().cos());
    2.0 * PI * ((1.0 - s) + 0.5 * (s - c))
}

/// The affine map of texture coordinates: scale and offset first, then the matrix or glTF's transform.
pub(crate) fn uv_map(node: &Node) -> Transform {
    let number = |name: &str, default: f64| node.float(name).unwrap_or(default);
    let scale = Transform::scale(DVec3::new(number("scale_u", 1.0), number("scale_v", 1.0), 1.0));
    let moved = Transform::translate(DVec3::new(number("delta_u", 0.0), number("delta_v", 0.0), 0.0)) * scale;
    let pair = |name: &str, default: f64| match node.get(name) {
        Some(Value::Floats(v)) if v.len() == 2 => [v[0], v[1]],
        _ => [default; 2],
    };
    let khr = ["khr_offset", "khr_rotation", "khr_scale"].iter().any(|n| node.get(n).is_some());
    let then = match node.get("to_uv") {
        _ if khr => {
            let (offset, size) = (pair("khr_offset", 0.0), pair("khr_scale", 1.0));
            let (sin, cos) = number("khr_rotation", 0.0).to_radians().sin_cos();
            Transform::from_rows([
                cos * size[0],
                sin * size[1],
                0.0,
                offset[0], //
                -sin * size[0],
                cos * size[1],
                0.0,
                offset[1], //
                0.0,
                0.0,
                1.0,
                0.0,
                0.0,
                0.0,
                0.0,
                1.0,
            ])
        }
        Some(Value::Transform(t)) => *t,
        _ => Transform::IDENTITY,
    };
    then * moved
}

#[cfg(test)]
mod tests {
    use super::*;
    use steradian_scene::Family;

    /// A parameter at its default is no loss: the picture without it is the same.
    #[test]
    fn defaults_are_not_dropped() {
        let desc = SceneDesc::default();
        let told = |name: &str, value: Value| {
            let node = Node::new(Family::Material, "conductor", None).with(name, value);
            let mut x = Exchange::new(&desc, Path::new("a.xml"));
            x.without(&node, &[name]);
            x.diagnostics.iter().count()
        };
        for (name, default, other) in [
            ("lens_radius", Value::Float(0.0), Value::Float(0.1)),
            ("normal_map_strength", Value::Float(1.0), Value::Float(2.0)),
            ("compensation", Value::String("none".into()), Value::String("turquin".into())),
            ("fresnel", Value::String("exact".into()), Value::String("large_k".into())),
            ("displacement_vector", Value::Bool(false), Value::Bool(true)),
            ("gamma", Value::Int(2), Value::Float(3.0)),
        ] {
            assert_eq!((told(name, default), told(name, other)), (0, 1), "{name}");
        }
    }
}
