//! MaterialX networks: OpenPBR and Autodesk's standard surface over graphs of the standard library's nodes.
//!
//! Nodes over constants are evaluated at reading; over pictures and primvars they become textures. A node that is not
//! known is told by its name, and its input keeps the surface's default.

use super::{
    Loss, Reader,
    look::{Look, Output, rgb},
    stage::Prim,
};
use std::rc::Rc;
use steradian_math::{DMat4, DVec3, Transform};
use steradian_scene::{Family, Node, NodeId, SpectrumValue, Value, names};

/// Longest chain of nodes.
const MOST_DEEP: usize = 64;
/// Most nodes of one surface, counted each time that they are used.
const MOST_NODES: usize = 10_000;
/// Pieces of a curve in place of a function.
const PIECES: usize = 32;

/// Value of an input.
#[derive(Clone, Debug)]
enum Term {
    /// One to four numbers.
    Constant(Vec<f64>),
    Texture(NodeId),
}

impl Term {
    fn number(v: f64) -> Self {
        Self::Constant(vec![v])
    }

    /// The component of a constant; of one number, that.
    fn at(numbers: &[f64], k: usize) -> f64 {
        numbers.get(k).or(numbers.first()).copied().unwrap_or_default()
    }

    fn value(&self) -> Value {
        match self {
            Self::Texture(id) => Value::Node(*id),
            Self::Constant(numbers) if numbers.len() < 3 => Value::Float(Self::at(numbers, 0)),
            Self::Constant(numbers) => Value::Spectrum(rgb([0, 1, 2].map(|k| Self::at(numbers, k)))),
        }
    }
}

/// Parameter of a surface shader.
enum Kind {
    /// Colour or texture.
    Color,
    /// Number or texture.
    Scalar,
    /// Number alone.
    Number,
}

/// Inputs of OpenPBR that are ours by the same name.
const OPENPBR: &[(&str, Kind)] = &[
    ("base_weight", Kind::Scalar),
    ("base_color", Kind::Color),
    ("base_metalness", Kind::Scalar),
    ("base_diffuse_roughness", Kind::Scalar),
    ("subsurface_weight", Kind::Scalar),
    ("subsurface_color", Kind::Color),
    ("subsurface_radius", Kind::Scalar),
    ("subsurface_radius_scale", Kind::Color),
    ("subsurface_scatter_anisotropy", Kind::Number),
    ("specular_weight", Kind::Scalar),
    ("specular_color", Kind::Color),
    ("specular_roughness", Kind::Scalar),
    ("specular_roughness_anisotropy", Kind::Scalar),
    ("specular_ior", Kind::Number),
    ("transmission_weight", Kind::Scalar),
    ("transmission_color", Kind::Color),
    ("transmission_depth", Kind::Number),
    ("transmission_scatter", Kind::Color),
    ("transmission_scatter_anisotropy", Kind::Number),
    ("transmission_dispersion_scale", Kind::Number),
    ("transmission_dispersion_abbe_number", Kind::Number),
    ("coat_weight", Kind::Scalar),
    ("coat_color", Kind::Color),
    ("coat_roughness", Kind::Scalar),
    ("coat_roughness_anisotropy", Kind::Scalar),
    ("coat_ior", Kind::Scalar),
    ("coat_darkening", Kind::Scalar),
    ("fuzz_weight", Kind::Scalar),
    ("fuzz_color", Kind::Color),
    ("fuzz_roughness", Kind::Scalar),
    ("thin_film_weight", Kind::Scalar),
    ("thin_film_ior", Kind::Scalar),
    ("emission_luminance", Kind::Number),
    ("emission_color", Kind::Color),
];

/// Inputs of the standard surface by ours, with their own defaults.
const STANDARD: &[(&str, &str, Kind, f64)] = &[
    ("base", "base_weight", Kind::Scalar, 1.0),
    ("base_color", "base_color", Kind::Color, 0.8),
    ("diffuse_roughness", "base_diffuse_roughness", Kind::Scalar, 0.0),
    ("metalness", "base_metalness", Kind::Scalar, 0.0),
    ("specular", "specular_weight", Kind::Scalar, 1.0),
    ("specular_color", "specular_color", Kind::Color, 1.0),
    ("specular_roughness", "specular_roughness", Kind::Scalar, 0.2),
    ("specular_IOR", "specular_ior", Kind::Number, 1.5),
    ("specular_anisotropy", "specular_roughness_anisotropy", Kind::Scalar, 0.0),
    ("transmission", "transmission_weight", Kind::Scalar, 0.0),
    ("transmission_color", "transmission_color", Kind::Color, 1.0),
    ("transmission_depth", "transmission_depth", Kind::Number, 0.0),
    ("transmission_scatter", "transmission_scatter", Kind::Color, 0.0),
    ("transmission_scatter_anisotropy", "transmission_scatter_anisotropy", Kind::Number, 0.0),
    ("subsurface", "subsurface_weight", Kind::Scalar, 0.0),
    ("subsurface_color", "subsurface_color", Kind::Color, 1.0),
    ("subsurface_radius", "subsurface_radius_scale", Kind::Color, 1.0),
    ("subsurface_scale", "subsurface_radius", Kind::Scalar, 1.0),
    ("subsurface_anisotropy", "subsurface_scatter_anisotropy", Kind::Number, 0.0),
    ("sheen", "fuzz_weight", Kind::Scalar, 0.0),
    ("sheen_color", "fuzz_color", Kind::Color, 1.0),
    ("sheen_roughness", "fuzz_roughness", Kind::Scalar, 0.3),
    ("coat", "coat_weight", Kind::Scalar, 0.0),
    ("coat_color", "coat_color", Kind::Color, 1.0),
    ("coat_roughness", "coat_roughness", Kind::Scalar, 0.1),
    ("coat_anisotropy", "coat_roughness_anisotropy", Kind::Scalar, 0.0),
    ("coat_IOR", "coat_ior", Kind::Scalar, 1.5),
    ("thin_film_thickness", "thin_film_thickness", Kind::Scalar, 0.0),
    ("thin_film_IOR", "thin_film_ior", Kind::Scalar, 1.5),
    ("emission", "emission_luminance", Kind::Number, 0.0),
    ("emission_color", "emission_color", Kind::Color, 1.0),
];

/// Inputs that are read otherwise, or whose directions are the surface's own.
const OPENPBR_TOO: &[&str] = &[
    "thin_film_thickness",
    "geometry_opacity",
    "geometry_thin_walled",
    "geometry_normal",
    "geometry_coat_normal",
    "geometry_tangent",
    "geometry_coat_tangent",
];
const STANDARD_TOO: &[&str] =
    &["transmission_dispersion", "thin_walled", "opacity", "normal", "coat_normal", "tangent"];

/// Diffuse closures, by their `info:id`.
const OREN_NAYAR: &str = "ND_oren_nayar_diffuse_bsdf";
const BURLEY: &str = "ND_burley_diffuse_bsdf";

/// True for surfaces that are read here, by their `info:id`.
pub(super) fn is_surface(id: &str) -> bool {
    matches!(surface(id), "open_pbr_surface" | "standard_surface")
}

fn surface(id: &str) -> &str {
    if id == "ND_surface" {
        return "surface";
    }
    id.strip_prefix("ND_").and_then(|id| id.strip_suffix("_surfaceshader")).unwrap_or_default()
}

/// The category of a node of the standard library and the type that it makes: `ND_image_color3` is `image`, `color3`.
fn category(id: &str) -> (&str, &str) {
    let id = id.strip_prefix("ND_").unwrap_or(id);
    const TYPES: [&str; 8] = ["float", "color3", "color4", "vector2", "vector3", "vector4", "integer", "boolean"];
    let found = TYPES.iter().filter_map(|t| id.find(&format!("_{t}")).map(|at| (at, *t))).min();
    found.map_or((id, ""), |(at, _)| (&id[..at], id[at + 1..].split('_').next_back().unwrap_or_default()))
}

impl Reader<'_> {
    /// The look of a surface shader of MaterialX.
    pub(super) fn materialx(&mut self, material: &Prim, shader: &Rc<Prim>, id: &str, is_two_sided: bool) -> Look {
        self.graph_nodes = 0;
        let mut node = Node::new(Family::Material, "openpbr", self.stage.span(shader, None));
        node.name = Some(material.name().to_owned());
        match surface(id) {
            "standard_surface" => self.standard(shader, &mut node),
            "surface" => self.matte(shader, &mut node),
            _ => {
                for (name, kind) in OPENPBR {
                    self.parameter(shader, (name, name, kind), &mut node, None);
                }
                let thickness = self.term(shader, "thin_film_thickness", 0);
                if let Some(thickness) = thickness {
                    // From micrometres.
                    let thickness = self.product(thickness, Term::number(1000.0));
                    node.set("thin_film_thickness", thickness.value(), None);
                }
            }
        }
        self.tell_unknown(shader, surface(id));
        let name = if surface(id) == "open_pbr_surface" { "geometry_thin_walled" } else { "thin_walled" };
        if let Some((_, _, value)) = self.input(shader, name)
            && value.bool() == Some(true)
        {
            node.set("geometry_thin_walled", true, None);
        }
        let is_stretched =
            node.get("specular_roughness_anisotropy").is_some_and(|v| !matches!(v, Value::Float(a) if *a == 0.0));
        let is_turned =
            ["geometry_tangent", "tangent"].iter().any(|name| self.output(shader, &format!("inputs:{name}")).is_some());
        if is_stretched && is_turned {
            let what = "its highlight is stretched along the tangent of the mesh".into();
            self.count(Loss::Approximated(what), shader, None);
        }
        let mut look = Look { tangents: is_stretched, ..Look::default() };
        let names = match surface(id) {
            "standard_surface" | "surface" => ["normal", "coat_normal", "opacity"],
            _ => ["geometry_normal", "geometry_coat_normal", "geometry_opacity"],
        };
        for (name, ours) in names.into_iter().zip(["normal_map", "coat_normal_map"]) {
            look.tangents |= self.normals(shader, name, ours, &mut node);
        }
        if node.float("emission_luminance").is_some_and(|v| v > 0.0) {
            self.uses_lights |= node.float("emission_luminance").is_some_and(|v| v > 1.0);
            look.emission = self.emission_of(&mut node, is_two_sided);
        }
        let opacity = self.term(shader, names[2], 0);
        let id = self.stage.import.desc.add(node);
        look.material = Some(match opacity {
            None => id,
            Some(Term::Constant(v)) if v.iter().all(|v| *v >= 1.0) => id,
            Some(opacity) => {
                let opacity = match opacity {
                    Term::Constant(v) => Value::Float(v.iter().sum::<f64>() / v.len().max(1) as f64),
                    Term::Texture(id) => Value::Node(id),
                };
                let mask = Node::new(Family::Material, "mask", None).with("opacity", opacity).with("material", id);
                self.stage.import.desc.add(mask)
            }
        });
        look
    }

    /// Tells of inputs that the surface does not have, or that are not read.
    fn tell_unknown(&mut self, shader: &Rc<Prim>, surface: &str) {
        let known: Vec<&str> = match surface {
            "surface" => vec!["bsdf", "edf", "opacity", "thin_walled"],
            "standard_surface" => STANDARD.iter().map(|row| row.0).chain(STANDARD_TOO.iter().copied()).collect(),
            _ => OPENPBR.iter().map(|row| row.0).chain(OPENPBR_TOO.iter().copied()).collect(),
        };
        for property in self.stage.properties(shader) {
            let Some(name) = property.strip_prefix("inputs:").filter(|name| !known.contains(name)) else { continue };
            // Exporters write what they leave off, too.
            let is_connected = self.output(shader, &property).is_some();
            if !is_connected && self.stage.value(shader, &property).is_none_or(|v| v.number() == Some(0.0)) {
                continue;
            }
            let nearest = names::did_you_mean(name, known.iter().copied());
            let help = nearest.map(|help| format!(": {help}")).unwrap_or_default();
            let what = format!("'{name}' is not an input of '{surface}' that is read{help}");
            self.count(Loss::Dropped(what), shader, Some(&property));
        }
    }

    /// The emission of a surface as the light of its shapes.
    fn emission_of(&mut self, node: &mut Node, is_two_sided: bool) -> Option<NodeId> {
        let scale = node.float("emission_luminance")?;
        let color = node.get("emission_color").cloned().unwrap_or_else(|| Value::Spectrum(rgb([1.0; 3])));
        node.set("emission_luminance", 0.0, None);
        let light = Node::new(Family::Light, "area", node.span).with("radiance", color).with("scale", scale);
        Some(self.stage.import.desc.add(light.with("two_sided", is_two_sided)))
    }

    /// True for a surface that is made of a diffuse closure or emits evenly, and of nothing else.
    pub(super) fn is_matte(&mut self, shader: &Rc<Prim>, id: &str) -> bool {
        if id != "ND_surface" {
            return false;
        }
        let [bsdf, edf] = ["bsdf", "edf"].map(|name| self.closure(shader, name).map(|c| c.1));
        let is_diffuse = bsdf.as_deref().is_none_or(|kind| matches!(kind, OREN_NAYAR | BURLEY));
        let is_even = edf.as_deref().is_none_or(|kind| kind == "ND_uniform_edf");
        is_diffuse && is_even && (bsdf.is_some() || edf.is_some())
    }

    /// A closure of a surface, with its kind.
    fn closure(&mut self, shader: &Rc<Prim>, name: &str) -> Option<(Rc<Prim>, String)> {
        let closure = self.output(shader, &format!("inputs:{name}"))?.shader;
        let kind = self.word(&closure, "info:id").unwrap_or_default();
        Some((closure, kind))
    }

    /// A surface of a diffuse closure and an even emission.
    fn matte(&mut self, shader: &Rc<Prim>, node: &mut Node) {
        node.set("specular_weight", 0.0, None).set("base_weight", 0.0, None);
        if let Some((bsdf, kind)) = self.closure(shader, "bsdf") {
            for (name, ours, parameter, default) in [
                ("weight", "base_weight", Kind::Scalar, 1.0),
                ("color", "base_color", Kind::Color, 0.18),
                ("roughness", "base_diffuse_roughness", Kind::Scalar, 0.0),
            ] {
                self.parameter(&bsdf, (name, ours, &parameter), node, Some(default));
            }
            if kind == BURLEY {
                self.count(Loss::Approximated("Burley's diffuse closure is that of OpenPBR".into()), &bsdf, None);
            }
            self.normals(&bsdf, "normal", "normal_map", node);
        }
        if let Some((edf, _)) = self.closure(shader, "edf") {
            self.parameter(&edf, ("color", "emission_color", &Kind::Color), node, Some(1.0));
            let mut most = 1.0;
            if let Some(Value::Spectrum(SpectrumValue::Rgb(color, _))) = node.get("emission_color") {
                most = color.iter().copied().fold(0.0, f64::max);
                let color = color.map(|v| if most > 0.0 { v / most } else { 0.0 });
                node.set("emission_color", Value::Spectrum(rgb(color)), None);
            }
            node.set("emission_luminance", most, None);
        }
    }

    fn standard(&mut self, shader: &Rc<Prim>, node: &mut Node) {
        for (name, ours, kind, default) in STANDARD {
            self.parameter(shader, (name, ours, kind), node, Some(*default));
        }
        if node.float("thin_film_thickness").is_none_or(|v| v > 0.0) && node.get("thin_film_thickness").is_some() {
            node.set("thin_film_weight", 1.0, None);
        }
        if node.float("transmission_weight") != Some(0.0) {
            let abbe = self.input(shader, "transmission_dispersion").and_then(|i| i.2.number());
            if let Some(abbe) = abbe.filter(|v| *v >= 1.0) {
                node.set("transmission_dispersion_scale", 1.0, None);
                node.set("transmission_dispersion_abbe_number", abbe, None);
            }
        }
        node.set("coat_darkening", 0.0, None);
    }

    /// Sets a parameter from an input, where that is given.
    fn parameter(
        &mut self,
        shader: &Rc<Prim>,
        (name, ours, kind): (&str, &str, &Kind),
        node: &mut Node,
        default: Option<f64>,
    ) {
        let Some(term) = self.term(shader, name, 0) else {
            if let Some(default) = default {
                node.set(ours, default, None);
            }
            return;
        };
        let (low, high) = match ours {
            "subsurface_scatter_anisotropy" | "transmission_scatter_anisotropy" => (-1.0, 1.0),
            "specular_ior" | "coat_ior" => (0.05, 20.0),
            "thin_film_ior" => (1.0, 5.0),
            "transmission_dispersion_abbe_number" => (1.0, 1e4),
            "thin_film_thickness" => (0.0, 1e5),
            "subsurface_radius"
            | "subsurface_radius_scale"
            | "transmission_depth"
            | "transmission_scatter"
            | "emission_luminance"
            | "emission_color" => (0.0, 1e6),
            _ => (0.0, 1.0),
        };
        let value = match (term, kind) {
            (Term::Texture(_), Kind::Number) => {
                let what = format!("the texture of '{name}' is left out: it is one number of the whole surface");
                return self.count(Loss::Dropped(what), shader, Some(&format!("inputs:{name}")));
            }
            (Term::Texture(id), _) => Value::Node(id),
            (Term::Constant(v), Kind::Color) => {
                let v: [f64; 3] = [0, 1, 2].map(|k| Term::at(&v, k).clamp(low, high));
                Value::Spectrum(rgb(v))
            }
            (Term::Constant(v), _) => Value::Float(Term::at(&v, 0).clamp(low, high)),
        };
        node.set(ours, value, None);
    }

    /// Sets a map of normals, or heights; true if one was set.
    fn normals(&mut self, shader: &Rc<Prim>, name: &str, ours: &str, node: &mut Node) -> bool {
        let Some(Output { shader: from, .. }) = self.output(shader, &format!("inputs:{name}")) else { return false };
        let id = self.word(&from, "info:id").unwrap_or_default();
        let strength = |reader: &mut Self| match reader.term(&from, "scale", 0) {
            Some(Term::Constant(v)) => Term::at(&v, 0),
            _ => 1.0,
        };
        match category(&id).0 {
            "normalmap" => {
                let Some(Term::Texture(map)) = self.term(&from, "in", 0) else { return false };
                let scale = strength(self);
                node.set(ours, map, None);
                if scale != 1.0 {
                    node.set(format!("{ours}_strength"), scale, None);
                }
                true
            }
            "bump" if ours == "normal_map" => {
                let Some(height) = self.term(&from, "height", 0) else { return false };
                let scale = strength(self);
                let height = self.product(height, Term::number(scale));
                if let Term::Texture(map) = height {
                    node.set("bump", map, None);
                }
                false
            }
            // The surface's own.
            "normal" | "normalize" => false,
            other => {
                let what = format!("normals by '{other}' are left out");
                self.count(Loss::Dropped(what), shader, Some(&format!("inputs:{name}")));
                false
            }
        }
    }

    /// The value of an input; `None` where it has none, or where it is not read, which is told.
    fn term(&mut self, owner: &Rc<Prim>, name: &str, depth: usize) -> Option<Term> {
        let Some(Output { shader, name: output }) = self.output(owner, &format!("inputs:{name}")) else {
            let (_, _, value) = self.input(owner, name)?;
            let numbers = value.numbers()?.to_vec();
            return (!numbers.is_empty() && numbers.iter().all(|v| v.is_finite())).then_some(Term::Constant(numbers));
        };
        self.graph_nodes += 1;
        if depth > MOST_DEEP || self.graph_nodes > MOST_NODES {
            let what =
                format!("a graph of more than {MOST_DEEP} nodes in a row or {MOST_NODES} in all is not followed");
            self.count(Loss::Dropped(what), owner, None);
            return None;
        }
        self.computed(&shader, &output, depth + 1)
    }

    /// The output of a node.
    fn computed(&mut self, node: &Rc<Prim>, output: &str, depth: usize) -> Option<Term> {
        let id = self.word(node, "info:id").unwrap_or_default();
        let (kind, made) = category(&id);
        let or = |reader: &mut Self, name: &str, default: f64| {
            reader.term(node, name, depth).unwrap_or_else(|| Term::number(default))
        };
        let term = match kind {
            "image" | "tiledimage" => {
                self.image(node, kind, made, None).or_else(|| self.term(node, "default", depth))?
            }
            "constant" => self.term(node, "value", depth)?,
            "convert" | "dot" => self.term(node, "in", depth)?,
            "add" | "subtract" | "multiply" | "divide" | "min" | "max" | "power" => {
                let usual = if matches!(kind, "add" | "subtract") { 0.0 } else { 1.0 };
                let (a, b) = (or(self, "in1", 0.0), or(self, "in2", usual));
                self.arithmetic(node, kind, a, b)?
            }
            "invert" => {
                let (amount, x) = (or(self, "amount", 1.0), or(self, "in", 0.0));
                self.arithmetic(node, "subtract", amount, x)?
            }
            "mix" => {
                let (bg, fg, amount) = (or(self, "bg", 0.0), or(self, "fg", 0.0), or(self, "mix", 0.0));
                self.mixed(bg, fg, amount)
            }
            "geompropvalue" | "UsdPrimvarReader" => {
                let name = if kind == "geompropvalue" { "geomprop" } else { "varname" };
                let name = self.input(node, name)?.2.text()?.to_owned();
                if name != "displayColor" {
                    let what = format!("values of meshes called '{name}' are left out");
                    self.count(Loss::Dropped(what), node, None);
                    return self.term(node, "default", depth);
                }
                let attribute = Node::new(Family::Texture, "mesh_attribute", None).with("name", name);
                Term::Texture(self.stage.import.desc.add(attribute.with("domain", "vertex")))
            }
            "extract" | "separate2" | "separate3" | "separate4" => return self.component(node, kind, output, depth),
            "combine2" | "combine3" | "combine4" => {
                let parts = ["in1", "in2", "in3"].map(|name| or(self, name, 0.0));
                self.combined(parts)
            }
            _ => return self.adjusted_by(node, kind, depth),
        };
        Some(term)
    }

    /// The output of a node that changes one value.
    fn adjusted_by(&mut self, node: &Rc<Prim>, kind: &str, depth: usize) -> Option<Term> {
        let or = |reader: &mut Self, name: &str, default: f64| {
            reader.term(node, name, depth).unwrap_or_else(|| Term::number(default))
        };
        Some(match kind {
            "clamp" => {
                let (low, high) = (or(self, "low", 0.0), or(self, "high", 1.0));
                let x = or(self, "in", 0.0);
                match (low, high) {
                    (Term::Constant(l), Term::Constant(h)) => {
                        let (l, h) = (Term::at(&l, 0), Term::at(&h, 0));
                        self.curve(x, &[l.min(h), h.max(l + 1e-9)], move |v| v.clamp(l.min(h), h.max(l)))
                    }
                    _ => return self.unread(node, kind),
                }
            }
            "remap" | "range" => {
                let [il, ih, ol, oh] =
                    [("inlow", 0.0), ("inhigh", 1.0), ("outlow", 0.0), ("outhigh", 1.0)].map(|(n, d)| or(self, n, d));
                let x = or(self, "in", 0.0);
                let (il, ih) = match (il, ih) {
                    (Term::Constant(l), Term::Constant(h)) => (Term::at(&l, 0), Term::at(&h, 0)),
                    _ => return self.unread(node, kind),
                };
                if il == ih {
                    return Some(ol);
                }
                let x = self.sum(x, Term::number(-il));
                let share = self.product(x, Term::number(1.0 / (ih - il)));
                self.mixed(ol, oh, share)
            }
            "smoothstep" => {
                let (low, high) = (or(self, "low", 0.0), or(self, "high", 1.0));
                let x = or(self, "in", 0.0);
                match (low, high) {
                    (Term::Constant(l), Term::Constant(h)) if Term::at(&l, 0) < Term::at(&h, 0) => {
                        let (l, h) = (Term::at(&l, 0), Term::at(&h, 0));
                        let places: Vec<f64> = (0..=PIECES).map(|k| l + (h - l) * k as f64 / PIECES as f64).collect();
                        self.curve(x, &places, move |v| {
                            let t = ((v - l) / (h - l)).clamp(0.0, 1.0);
                            t * t * (3.0 - 2.0 * t)
                        })
                    }
                    _ => return self.unread(node, kind),
                }
            }
            "contrast" => {
                let [x, amount, pivot] = [("in", 0.0), ("amount", 1.0), ("pivot", 0.5)].map(|(n, d)| or(self, n, d));
                let minus = self.product(pivot.clone(), Term::number(-1.0));
                let x = self.sum(x, minus);
                let x = self.product(x, amount);
                self.sum(x, pivot)
            }
            "luminance" => match or(self, "in", 0.0) {
                Term::Constant(v) => {
                    let [r, g, b] = [0, 1, 2].map(|k| Term::at(&v, k));
                    Term::number(0.2126 * r + 0.7152 * g + 0.0722 * b)
                }
                Term::Texture(input) => self.channel(input, "luminance"),
            },
            "saturate" => {
                let (amount, x) = (or(self, "amount", 1.0), or(self, "in", 0.0));
                let Term::Texture(input) = x else { return Some(x) };
                let grey = self.channel(input, "luminance");
                self.mixed(grey, Term::Texture(input), amount)
            }
            "hsvadjust" => match (or(self, "in", 0.0), or(self, "amount", 1.0)) {
                (Term::Texture(input), Term::Constant(v)) => {
                    let hsv = Node::new(Family::Texture, "hsv", None)
                        .with("input", input)
                        .with("hue", Term::at(&v, 0) * 360.0)
                        .with("saturation", Term::at(&v, 1))
                        .with("value", Term::at(&v, 2));
                    Term::Texture(self.stage.import.desc.add(hsv))
                }
                _ => return self.unread(node, kind),
            },
            _ => return self.unread(node, kind),
        })
    }

    /// One number of a value.
    fn component(&mut self, node: &Rc<Prim>, kind: &str, output: &str, depth: usize) -> Option<Term> {
        let index = match kind {
            "extract" => match self.term(node, "index", depth) {
                Some(Term::Constant(v)) => Term::at(&v, 0) as usize,
                _ => 0,
            },
            _ => "rgba"
                .find(output.trim_start_matches("out"))
                .or_else(|| "xyzw".find(output.trim_start_matches("out")))
                .unwrap_or(0),
        };
        let name = ["r", "g", "b", "a"].get(index).copied().unwrap_or("r");
        // Opacity is known to the picture alone.
        if let Some(Output { shader: picture, .. }) = self.output(node, "inputs:in") {
            let id = self.word(&picture, "info:id").unwrap_or_default();
            let (kind, made) = category(&id);
            if matches!(kind, "image" | "tiledimage") {
                return self.image(&picture, kind, made, Some(name));
            }
        }
        Some(match self.term(node, "in", depth)? {
            Term::Constant(v) => Term::number(Term::at(&v, index)),
            Term::Texture(input) if index < 3 => self.channel(input, name),
            Term::Texture(_) => return self.unread(node, kind),
        })
    }

    /// A value of three numbers.
    fn combined(&mut self, parts: [Term; 3]) -> Term {
        match parts {
            [Term::Constant(a), Term::Constant(b), Term::Constant(c)] => {
                Term::Constant([a, b, c].iter().map(|v| Term::at(v, 0)).collect())
            }
            parts => {
                let [r, g, b] = parts;
                let unit = |k: usize| Term::Constant((0..3).map(|c| f64::from(u8::from(c == k))).collect());
                let (r, g, b) = (self.product(r, unit(0)), self.product(g, unit(1)), self.product(b, unit(2)));
                let sum = self.sum(r, g);
                self.sum(sum, b)
            }
        }
    }

    fn unread(&mut self, node: &Prim, kind: &str) -> Option<Term> {
        let what = format!("the node '{kind}' is not read: what it feeds keeps its default");
        self.count(Loss::Dropped(what), node, None);
        None
    }

    fn add_texture(&mut self, node: Node) -> Term {
        Term::Texture(self.stage.import.desc.add(node))
    }

    fn channel(&mut self, input: NodeId, name: &str) -> Term {
        self.add_texture(Node::new(Family::Texture, "channel", None).with("input", input).with("channel", name))
    }

    fn sum(&mut self, a: Term, b: Term) -> Term {
        match (&a, &b) {
            (Term::Constant(a), Term::Constant(b)) => elementwise(a, b, |a, b| a + b),
            (Term::Texture(_), Term::Constant(v)) if v.iter().all(|v| *v == 0.0) => a,
            _ => self.add_texture(Node::new(Family::Texture, "add", None).with("a", a.value()).with("b", b.value())),
        }
    }

    fn product(&mut self, a: Term, b: Term) -> Term {
        match (&a, &b) {
            (Term::Constant(a), Term::Constant(b)) => elementwise(a, b, |a, b| a * b),
            (Term::Texture(_), Term::Constant(v)) if v.iter().all(|v| *v == 1.0) => a,
            (Term::Constant(v), Term::Texture(_)) if v.iter().all(|v| *v == 1.0) => b,
            _ => self.add_texture(
                Node::new(Family::Texture, "scale", None).with("texture", a.value()).with("scale", b.value()),
            ),
        }
    }

    fn mixed(&mut self, a: Term, b: Term, amount: Term) -> Term {
        match (&a, &b, &amount) {
            (Term::Constant(a), Term::Constant(b), Term::Constant(t)) => {
                let difference = elementwise(b, a, |b, a| b - a);
                let Term::Constant(difference) = difference else { return difference };
                let Term::Constant(part) = elementwise(&difference, t, |d, t| d * t) else { return amount };
                elementwise(a, &part, |a, p| a + p)
            }
            (_, _, Term::Constant(t)) if t.iter().all(|t| *t == 0.0) => a,
            (_, _, Term::Constant(t)) if t.iter().all(|t| *t == 1.0) => b,
            _ => self.add_texture(
                Node::new(Family::Texture, "mix", None)
                    .with("a", a.value())
                    .with("b", b.value())
                    .with("amount", amount.value()),
            ),
        }
    }

    /// A function of each component, linear between places.
    fn curve(&mut self, x: Term, places: &[f64], f: impl Fn(f64) -> f64) -> Term {
        match x {
            Term::Constant(v) => Term::Constant(v.into_iter().map(f).collect()),
            Term::Texture(input) => {
                let values: Vec<f64> = places.iter().map(|x| f(*x)).collect();
                self.add_texture(
                    Node::new(Family::Texture, "curve", None)
                        .with("input", input)
                        .with("places", places.to_vec())
                        .with("values", values),
                )
            }
        }
    }

    fn arithmetic(&mut self, node: &Prim, kind: &str, a: Term, b: Term) -> Option<Term> {
        let unit = || (0..=PIECES).map(|k| k as f64 / PIECES as f64).collect::<Vec<_>>();
        Some(match (kind, a, b) {
            ("add", a, b) => self.sum(a, b),
            ("multiply", a, b) => self.product(a, b),
            ("subtract", a, b) => {
                let minus = self.product(b, Term::number(-1.0));
                self.sum(a, minus)
            }
            (_, Term::Constant(a), Term::Constant(b)) => match kind {
                "divide" => elementwise(&a, &b, |a, b| if b == 0.0 { 0.0 } else { a / b }),
                "min" => elementwise(&a, &b, f64::min),
                "max" => elementwise(&a, &b, f64::max),
                _ => elementwise(&a, &b, |a, b| a.max(0.0).powf(b)),
            },
            ("divide", a, Term::Constant(b)) if b.iter().all(|b| *b != 0.0) => {
                self.product(a, Term::Constant(b.into_iter().map(|b| 1.0 / b).collect()))
            }
            ("power", a, Term::Constant(b)) if b.iter().all(|e| *e == Term::at(&b, 0)) => {
                let exponent = Term::at(&b, 0);
                self.curve(a, &unit(), move |v| v.max(0.0).powf(exponent))
            }
            ("min" | "max", a @ Term::Texture(_), Term::Constant(b))
            | ("min" | "max", Term::Constant(b), a @ Term::Texture(_)) => {
                let limit = Term::at(&b, 0);
                let mut places = unit();
                if limit > 0.0 && limit < 1.0 {
                    places.push(limit);
                    places.sort_by(f64::total_cmp);
                    places.dedup();
                }
                let is_least = kind == "min";
                self.curve(a, &places, move |v| if is_least { v.min(limit) } else { v.max(limit) })
            }
            _ => return self.unread(node, kind),
        })
    }

    /// A picture, or one channel of it; `None` where it cannot be read, which is told.
    fn image(&mut self, node: &Rc<Prim>, kind: &str, made: &str, channel: Option<&str>) -> Option<Term> {
        let (owner, attribute, _) = self.input(node, "file")?;
        let span = self.stage.span(&owner, Some(&attribute));
        let space =
            self.stage.property_field(&owner, &attribute, "colorSpace").and_then(|v| v.text().map(str::to_owned));
        let file = match self.stage.asset(&owner, &attribute)? {
            Ok(file) => file,
            Err(why) => {
                self.stage.approximated(span, format!("{}: {why}: its default is used", node.path));
                return None;
            }
        };
        let mut texture = Node::new(Family::Texture, "image", span).with("file", file);
        let is_color = made.starts_with("color") && channel != Some("a");
        match space.as_deref() {
            _ if !is_color => texture.set("raw", true, None),
            Some(space) if space.contains("srgb") || space.contains("sRGB") => texture.set("encoding", "srgb", None),
            Some(space) if space.contains("lin") || space.eq_ignore_ascii_case("raw") => texture.set("raw", true, None),
            Some("none") => texture.set("raw", true, None),
            _ => &mut texture,
        };
        match (channel, made) {
            (Some(channel), _) => texture.set("channel", channel, None),
            (None, "float") => texture.set("channel", "r", None),
            _ => &mut texture,
        };
        let filter = self.input(node, "filtertype").and_then(|i| i.2.text().map(str::to_owned));
        match filter.as_deref() {
            Some("closest") => texture.set("filter", "nearest", None),
            Some("cubic") => texture.set("filter", "bspline", None),
            _ => &mut texture,
        };
        for (name, ours) in [("uaddressmode", "wrap_u"), ("vaddressmode", "wrap_v")] {
            let mode = self.input(node, name).and_then(|i| i.2.text().map(str::to_owned));
            let mode = match mode.as_deref() {
                Some("constant") => "black",
                Some("clamp") => "clamp",
                Some("mirror") => "mirror",
                _ => "repeat",
            };
            texture.set(ours, mode, None);
        }
        let mut matrix = DMat4::IDENTITY;
        if kind == "tiledimage" {
            let pair = |reader: &mut Self, name: &str, default: f64| match reader.term(node, name, 0) {
                Some(Term::Constant(v)) => DVec3::new(Term::at(&v, 0), Term::at(&v, 1), 1.0),
                _ => DVec3::new(default, default, 1.0),
            };
            let (tiling, offset) = (pair(self, "uvtiling", 1.0), pair(self, "uvoffset", 0.0));
            let (tile, size) = (pair(self, "realworldtilesize", 1.0), pair(self, "realworldimagesize", 1.0));
            let real = tile / size;
            if real.is_finite() {
                let shift = DMat4::from_translation(-DVec3::new(offset.x, offset.y, 0.0));
                matrix = DMat4::from_scale(real) * shift * DMat4::from_scale(tiling);
            }
        }
        self.places(node, matrix, &mut texture);
        Some(self.add_texture(texture))
    }

    /// Coordinates of a picture: the mesh's, through affine maps.
    fn places(&mut self, node: &Rc<Prim>, mut matrix: DMat4, texture: &mut Node) {
        let (mut node, mut input) = (node.clone(), "texcoord");
        for _ in 0..MOST_DEEP {
            let Some(Output { shader, .. }) = self.output(&node, &format!("inputs:{input}")) else { break };
            let id = self.word(&shader, "info:id").unwrap_or_default();
            let flat = |reader: &mut Self, name: &str, default: f64| match reader.term(&shader, name, 0) {
                Some(Term::Constant(v)) => [Term::at(&v, 0), Term::at(&v, 1)],
                _ => [default; 2],
            };
            let at = |[x, y]: [f64; 2]| DMat4::from_translation(DVec3::new(x, y, 0.0));
            let turned = |degrees: f64| DMat4::from_rotation_z(-degrees.to_radians());
            match category(&id).0 {
                "texcoord" => break,
                "geompropvalue" | "UsdPrimvarReader" => {
                    let name = if id.contains("geomprop") { "geomprop" } else { "varname" };
                    let name = self.input(&shader, name).and_then(|i| i.2.text().map(str::to_owned));
                    if let Some(name) = name.filter(|name| name != "st") {
                        texture.set("uv_set", name, None);
                    }
                    break;
                }
                "convert" | "extract" => (node, input) = (shader, "in"),
                "place2d" => {
                    let [pivot, scale] = [flat(self, "pivot", 0.0), flat(self, "scale", 1.0)];
                    let ([turn, _], shift) = (flat(self, "rotate", 0.0), flat(self, "offset", 0.0));
                    let scale = DMat4::from_scale(DVec3::new(1.0 / scale[0], 1.0 / scale[1], 1.0));
                    let shift = at(shift.map(|v| -v));
                    let [order, _] = flat(self, "operationorder", 0.0);
                    let inner = if order == 1.0 { scale * turned(turn) * shift } else { shift * turned(turn) * scale };
                    let map = at(pivot) * inner * at(pivot.map(|v| -v));
                    if map.is_finite() {
                        matrix *= map;
                    }
                    (node, input) = (shader, "texcoord");
                }
                kind @ ("multiply" | "divide" | "add" | "subtract") => {
                    let is_second = self.output(&shader, "inputs:in1").is_none();
                    let name = if is_second { "in1" } else { "in2" };
                    let [x, y] = flat(self, name, if matches!(kind, "add" | "subtract") { 0.0 } else { 1.0 });
                    let map = match kind {
                        "multiply" => DMat4::from_scale(DVec3::new(x, y, 1.0)),
                        "divide" => DMat4::from_scale(DVec3::new(1.0 / x, 1.0 / y, 1.0)),
                        "add" => at([x, y]),
                        _ => at([-x, -y]),
                    };
                    if map.is_finite() && !(is_second && matches!(kind, "divide" | "subtract")) {
                        matrix *= map;
                    }
                    (node, input) = (shader, if is_second { "in2" } else { "in1" });
                }
                "rotate2d" | "rotate3d" => {
                    let [turn, _] = flat(self, "amount", 0.0);
                    matrix *= turned(turn);
                    (node, input) = (shader, "in");
                }
                other => {
                    let what = format!("coordinates by '{other}' are not read: those of the mesh are used");
                    self.count(Loss::Approximated(what), &shader, None);
                    break;
                }
            }
        }
        if matrix != DMat4::IDENTITY {
            texture.set("to_uv", Transform { matrix }, None);
        }
    }
}

fn elementwise(a: &[f64], b: &[f64], f: impl Fn(f64, f64) -> f64) -> Term {
    let count = a.len().max(b.len());
    Term::Constant((0..count).map(|k| f(Term::at(a, k), Term::at(b, k))).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_nodes_come_apart() {
        assert_eq!(category("ND_image_color3"), ("image", "color3"));
        assert_eq!(category("ND_convert_color4_color3"), ("convert", "color3"));
        assert_eq!(category("ND_normalmap_float"), ("normalmap", "float"));
        assert_eq!(category("ND_multiply_color3FA"), ("multiply", "color3FA"));
        assert_eq!(category("ND_place2d_vector2"), ("place2d", "vector2"));
        assert_eq!(category("UsdUVTexture"), ("UsdUVTexture", ""));
    }
}
