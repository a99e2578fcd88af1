//! Materials: metallic-roughness with its extensions.

use super::{Json, Writer, texture::Tinted};
use crate::write::{colour::Colour, exchange::Source};
use serde_json::{Map, json};
use steradian_scene::{Format, Node, NodeId, Shape, Value};

/// A material of the document and what its surfaces need.
#[derive(Clone, Copy, Debug)]
pub(super) struct Look {
    pub material: usize,
    /// True if vertex colours are used.
    pub vertices: bool,
}

/// A number of a material: our name, the extension, its name there without `Factor`, the channel of its texture, its
/// default.
type Row = (&'static str, &'static str, &'static str, &'static str, f64);

/// A material under way.
#[derive(Debug, Default)]
struct Draft {
    base: Map<String, Json>,
    top: Map<String, Json>,
    extensions: Map<String, Json>,
    vertices: bool,
    opacity: f64,
}

impl Draft {
    fn extension(&mut self, name: &str) -> &mut Json {
        self.extensions.entry(name).or_insert_with(|| json!({}))
    }
}

impl Writer<'_> {
    /// The material of a shape; none where there is no surface.
    pub(super) fn look(&mut self, shape: &Shape) -> Option<Look> {
        let key = format!("{:?} {:?} {:?}", shape.material, shape.emission, shape.interior);
        if let Some(known) = self.materials.get(&key) {
            return *known;
        }
        let look = self.new_look(shape);
        self.materials.insert(key, look);
        look
    }

    fn new_look(&mut self, shape: &Shape) -> Option<Look> {
        let mut draft = Draft { opacity: 1.0, ..Draft::default() };
        let mut double = self.x.desc.format != Format::Mitsuba;
        match shape.material {
            Some(id) => {
                let node = self.x.node(id);
                if node.kind == "interface" {
                    self.x.dropped(node, "glTF has no surfaces that only separate media; they are left out");
                    return None;
                }
                if let Some(name) = &node.name {
                    draft.top.insert("name".into(), json!(name));
                }
                self.outer(&mut draft, id, &mut double, 0);
            }
            None => self.diffuse(&mut draft, &Source::Plain(Colour::Grey(0.5))),
        }
        if let Some(light) = shape.emission {
            double = self.emission(&mut draft, light, shape);
        }
        if let Some(medium) = shape.interior {
            self.volume(&mut draft, medium);
        }
        let Draft { base, mut top, extensions, vertices, .. } = draft;
        for name in extensions.keys() {
            if let Some(known) = EXTENSIONS.iter().find(|e| *e == name) {
                self.extensions.insert(known);
            }
        }
        top.insert("pbrMetallicRoughness".into(), Json::Object(base));
        if !extensions.is_empty() {
            top.insert("extensions".into(), Json::Object(extensions));
        }
        if double {
            top.insert("doubleSided".into(), json!(true));
        }
        let material = self.push("materials", Json::Object(top));
        Some(Look { material, vertices })
    }

    /// Unwraps masks and sides, and what a mix is mostly made of.
    fn outer(&mut self, draft: &mut Draft, id: NodeId, double: &mut bool, depth: usize) {
        let node = self.x.node(id);
        let inner = |name: &str| match node.get(name) {
            Some(&Value::Node(inner)) => Some(inner),
            _ => None,
        };
        match (node.kind.as_str(), inner("material"), inner("front")) {
            ("mask", Some(inner), _) if depth < 16 => {
                self.outer(draft, inner, double, depth + 1);
                self.opacity(draft, node);
            }
            ("two_sided", _, Some(front)) if depth < 16 => {
                *double = true;
                if node.get("back").is_some_and(|b| Some(b) != node.get("front")) {
                    self.x.approximated(node, "glTF's surfaces are alike on both sides; that of the front counts");
                }
                self.outer(draft, front, double, depth + 1);
            }
            ("mix", ..) if depth < 16 => {
                self.x.approximated(node, "of a mix of materials glTF gets the one that counts most");
                let amount = match self.x.source_or(node, "amount", 0.5) {
                    Source::Plain(c) => c.mean(),
                    Source::Texture(_) => 0.5,
                };
                if let Some(Value::Nodes(parts)) = node.get("materials")
                    && let Some(&part) = parts.get(usize::from(amount > 0.5))
                {
                    self.outer(draft, part, double, depth + 1);
                }
            }
            _ => self.model(draft, node),
        }
    }

    fn opacity(&mut self, draft: &mut Draft, mask: &Node) {
        draft.top.insert("alphaMode".into(), json!("BLEND"));
        let source = self.x.source_or(mask, "opacity", 0.5);
        let id = match &source {
            Source::Plain(c) => {
                draft.opacity *= c.mean();
                let mut factor = draft.base.get("baseColorFactor").cloned().unwrap_or(json!([1.0, 1.0, 1.0, 1.0]));
                factor[3] = json!(draft.opacity.clamp(0.0, 1.0));
                draft.base.insert("baseColorFactor".into(), factor);
                return;
            }
            Source::Texture(id) => *id,
        };
        // A threshold is a curve with one step.
        let node = self.x.node(id);
        let (picture, cutoff) = match (node.kind.as_str(), self.x.source(node, "input"), node.get("places")) {
            ("curve", Some(inner), Some(Value::Floats(places))) if places.len() == 2 => (inner, Some(places[1])),
            _ => (source, None),
        };
        // The alpha of the very picture that gives the colour.
        let own = self.channel(&picture, "a").filter(|(_, r)| Some(r) == draft.base.get("baseColorTexture"));
        let Some((factor, _)) = own else {
            self.x.approximated(mask, "an opacity that is not the alpha of the base colour's picture is left out");
            draft.top.remove("alphaMode");
            return;
        };
        if let Some(cutoff) = cutoff {
            draft.top.insert("alphaMode".into(), json!("MASK"));
            draft.top.insert("alphaCutoff".into(), json!(cutoff));
        }
        draft.opacity *= factor;
        if let Some(base) = draft.base.get_mut("baseColorFactor") {
            base[3] = json!(draft.opacity.clamp(0.0, 1.0));
        }
    }

    fn base_color(&mut self, draft: &mut Draft, source: &Source) {
        let Tinted { factor, image, vertices } = self.product(source);
        draft.vertices |= vertices;
        let [r, g, b] = factor.map(|v| v.clamp(0.0, 1.0));
        draft.base.insert("baseColorFactor".into(), json!([r, g, b, 1.0]));
        if let Some(texture) = image.and_then(|id| self.colors(id)) {
            draft.base.insert("baseColorTexture".into(), texture);
        }
    }

    fn diffuse(&mut self, draft: &mut Draft, reflectance: &Source) {
        self.base_color(draft, reflectance);
        draft.base.insert("metallicFactor".into(), json!(0.0));
        draft.base.insert("roughnessFactor".into(), json!(1.0));
        // Without a specular part the surface is Lambertian.
        draft.extension("KHR_materials_specular")["specularFactor"] = json!(0.0);
    }

    fn model(&mut self, draft: &mut Draft, node: &Node) {
        match node.kind.as_str() {
            "diffuse" => {
                let reflectance = self.x.source_or(node, "reflectance", 0.5);
                self.diffuse(draft, &reflectance);
            }
            "metallic_roughness" => self.metallic_roughness(draft, node),
            "conductor" => self.conductor(draft, node, ["eta", "k", "reflectance"], ["alpha_u", "alpha_v"]),
            "coated_conductor" => {
                let names = ["conductor.eta", "conductor.k", "reflectance"];
                self.conductor(draft, node, names, ["conductor.uroughness", "conductor.vroughness"]);
                draft.extension("KHR_materials_clearcoat")["clearcoatFactor"] = json!(1.0);
            }
            "dielectric" | "thin_dielectric" => {
                self.x.approximated(node, format!("'{}' becomes glTF's transmission", node.kind));
                self.gloss(draft, node, ["alpha_u", "alpha_v"], 0.0);
                self.index(draft, node, "eta", 1.5);
                draft.extension("KHR_materials_transmission")["transmissionFactor"] = json!(1.0);
                if node.kind == "dielectric" {
                    draft.extension("KHR_materials_volume")["thicknessFactor"] = json!(1.0);
                }
            }
            "polarizer" | "retarder" => {
                self.x.approximated(node, format!("'{}' becomes a pane as unpolarised light sees it", node.kind));
                self.gloss(draft, node, ["alpha_u", "alpha_v"], 0.0);
                let part = if node.kind == "polarizer" { 0.5 } else { 1.0 };
                self.base_color(draft, &Source::Plain(Colour::Grey(part)));
                draft.extension("KHR_materials_ior")["ior"] = json!(1.0);
                draft.extension("KHR_materials_transmission")["transmissionFactor"] = json!(1.0);
            }
            "plastic" | "coated_diffuse" => {
                self.x.approximated(node, format!("'{}' becomes glTF's dielectric over a diffuse base", node.kind));
                let name = if node.kind == "plastic" { "diffuse_reflectance" } else { "reflectance" };
                let base = self.x.source_or(node, name, 0.5);
                self.base_color(draft, &base);
                self.gloss(draft, node, ["alpha_u", "alpha_v"], 0.0);
                self.index(draft, node, "eta", 1.5);
            }
            "diffuse_transmission" => {
                self.x.approximated(node, "'diffuse_transmission' keeps its colours; the sum of both ways is one");
                let sources = ["reflectance", "transmittance"].map(|n| self.x.source_or(node, n, 0.25));
                let [r, t] = sources.each_ref().map(|s| match s {
                    Source::Plain(c) => c.mean(),
                    Source::Texture(_) => 0.5,
                });
                self.diffuse(draft, &sources[0]);
                let tint = self.product(&sources[1]).factor;
                let share = t / (r + t).max(1e-6);
                *draft.extension("KHR_materials_diffuse_transmission") =
                    json!({ "diffuseTransmissionFactor": share, "diffuseTransmissionColorFactor": tint });
            }
            "sheen" => {
                let base = self.x.source_or(node, "reflectance", 0.5);
                self.diffuse(draft, &base);
                self.sheen(draft, node);
            }
            "principled" | "principledthin" | "openpbr" => self.principled(draft, node),
            other => {
                self.x.approximated(
                    node,
                    format!("glTF has no material like '{other}'; a diffuse surface stands for it"),
                );
                let names = ["reflectance", "diffuse_reflectance", "base_color", "color"];
                let name = names.into_iter().find(|n| node.get(n).is_some()).unwrap_or("reflectance");
                let source = self.x.source_or(node, name, 0.5);
                self.diffuse(draft, &source);
            }
        }
        for name in ["bump", "displacement"] {
            self.x.without(node, &[name]);
        }
        if let Some(Source::Texture(id)) = self.x.source(node, "normal_map") {
            match self.numbers(id) {
                Some(mut map) => {
                    let strength = node.float("normal_map_strength").unwrap_or(1.0);
                    if strength != 1.0 {
                        map["scale"] = json!(strength);
                    }
                    draft.top.insert("normalTexture".into(), map);
                }
                None => self.x.dropped(node, "a normal map that is no PNG or JPEG picture is left out"),
            }
        }
        if draft.extensions.contains_key("KHR_materials_clearcoat") {
            self.coat_normals(draft, node);
        }
    }

    /// The coat's own normal map; glTF's coat has the normals of the surface without, ours those of its base.
    fn coat_normals(&mut self, draft: &mut Draft, node: &Node) {
        let map = match self.x.source(node, "coat_normal_map") {
            Some(Source::Texture(id)) => {
                let map = self.numbers(id);
                if map.is_none() {
                    self.x.dropped(node, "a normal map of the coat that is no PNG or JPEG picture is left out");
                }
                map.map(|mut map| {
                    let strength = node.float("coat_normal_map_strength").unwrap_or(1.0);
                    if strength != 1.0 {
                        map["scale"] = json!(strength);
                    }
                    map
                })
            }
            _ if node.string("coat_normals") == Some("own") => None,
            _ => draft.top.get("normalTexture").cloned(),
        };
        if let Some(map) = map {
            draft.extension("KHR_materials_clearcoat")["clearcoatNormalTexture"] = map;
        }
    }

    /// Directions of the anisotropy: red and green of the picture whose blue is the strength.
    fn directions(&mut self, draft: &mut Draft, node: &Node) {
        const KEY: &str = "anisotropyTexture";
        let Some(e) = draft.extensions.get("KHR_materials_anisotropy") else { return };
        let strength = e.get(KEY).cloned();
        let directions = match self.x.source(node, "anisotropy_direction") {
            Some(Source::Texture(id)) => self.numbers(id),
            _ => None,
        };
        match (strength, directions) {
            (None, None) if node.get("anisotropy_direction").is_some() => {
                self.x.dropped(node, "directions of anisotropy that are no PNG or JPEG picture are left out");
            }
            (None, None) => {}
            (None, Some(directions)) => {
                self.x.approximated(node, "the strength of the anisotropy is scaled by the blue of its directions");
                draft.extension("KHR_materials_anisotropy")[KEY] = directions;
            }
            (Some(strength), directions) if directions.as_ref() != Some(&strength) => {
                let what = "red and green of the picture that is the strength of the anisotropy become its directions";
                self.x.approximated(node, what);
            }
            _ => {}
        }
    }

    /// glTF's roughness is the root of α.
    fn gloss(&mut self, draft: &mut Draft, node: &Node, names: [&str; 2], metallic: f64) {
        let [u, v] = names.map(|n| match self.x.alpha(node, n) {
            Source::Plain(c) => c.mean(),
            Source::Texture(_) => {
                self.x.approximated(node, format!("the texture of '{n}' is replaced by a roughness of 0.5"));
                0.25
            }
        });
        if (u - v).abs() > 1e-6 {
            self.x.approximated(node, "different roughness along and across becomes its mean");
        }
        draft.base.insert("roughnessFactor".into(), json!((0.5 * (u + v)).sqrt().clamp(0.0, 1.0)));
        draft.base.insert("metallicFactor".into(), json!(metallic));
    }

    fn index(&mut self, draft: &mut Draft, node: &Node, name: &str, default: f64) {
        let eta = match self.x.source_or(node, name, default) {
            Source::Plain(c @ Colour::Curve(..)) => {
                self.x.approximated(node, "an index of refraction over wavelength becomes that at 589.3 nm");
                c.at_sodium_line()
            }
            Source::Plain(c) => c.at_sodium_line(),
            Source::Texture(_) => {
                self.x.approximated(node, format!("a textured index of refraction becomes {default}"));
                default
            }
        };
        // Below one the other side is the denser.
        let eta = if eta < 1.0 { 1.0 / eta.max(1e-3) } else { eta };
        if eta != 1.5 {
            draft.extension("KHR_materials_ior")["ior"] = json!(eta);
        }
    }

    fn conductor(&mut self, draft: &mut Draft, node: &Node, [eta, k, color]: [&str; 3], alphas: [&str; 2]) {
        self.x.approximated(node, format!("'{}' becomes metal of the colour that it has straight on", node.kind));
        let base = match self.x.source(node, color) {
            Some(source) => source,
            None => match [(eta, 1.0), (k, 0.0)].map(|(n, default)| self.x.source_or(node, n, default)) {
                _ if node.get(eta).is_none() && node.get(k).is_none() => {
                    self.x.source_or(node, "specular_reflectance", 1.0)
                }
                [Source::Plain(eta), Source::Plain(k)] => {
                    // ((η − 1)² + κ²) / ((η + 1)² + κ²)
                    let k2 = k.map(|k| k * k);
                    let part = |sign: f64| eta.with(&k2, |eta, k2| (eta + sign).powi(2) + k2);
                    Source::Plain(part(-1.0).with(&part(1.0), |a, b| a / b.max(1e-9)))
                }
                _ => Source::Plain(Colour::Grey(0.9)),
            },
        };
        self.base_color(draft, &base);
        self.gloss(draft, node, alphas, 1.0);
    }

    fn sheen(&mut self, draft: &mut Draft, node: &Node) {
        if let Some(source) = self.x.source(node, "sheen_color") {
            let Tinted { factor, image, .. } = self.product(&source);
            if factor != [0.0; 3] {
                draft.extension("KHR_materials_sheen")["sheenColorFactor"] = json!(factor);
                if let Some(texture) = image.and_then(|id| self.colors(id)) {
                    draft.extension("KHR_materials_sheen")["sheenColorTexture"] = texture;
                }
                self.factor(draft, node, ("sheen_roughness", "KHR_materials_sheen", "sheenRoughness", "a", 0.0));
            }
        }
    }

    /// A number with its texture as an extension's `…Factor` and `…Texture`.
    fn factor(&mut self, draft: &mut Draft, node: &Node, (name, extension, key, channel, default): Row) {
        let Some(source) = self.x.source(node, name) else { return };
        let factor_key = if key == "anisotropyStrength" { key.to_owned() } else { format!("{key}Factor") };
        match &source {
            Source::Plain(c) if (c.mean() - default).abs() < 1e-9 => {}
            Source::Plain(c) => draft.extension(extension)[factor_key] = json!(c.mean()),
            texture => match self.channel(texture, channel) {
                Some((factor, reference)) => {
                    let texture_key = if key == "anisotropyStrength" {
                        "anisotropyTexture".to_owned()
                    } else {
                        format!("{key}Texture")
                    };
                    draft.extension(extension)[factor_key] = json!(factor);
                    draft.extension(extension)[texture_key] = reference;
                }
                None => {
                    self.x.approximated(node, format!("the texture of '{name}' becomes 0.5"));
                    draft.extension(extension)[factor_key] = json!(0.5);
                }
            },
        }
    }

    fn metallic_roughness(&mut self, draft: &mut Draft, node: &Node) {
        let base = self.x.source_or(node, "base_color", 1.0);
        self.base_color(draft, &base);
        let mut map = None;
        for (name, key, channel) in [("metallic", "metallicFactor", "b"), ("roughness", "roughnessFactor", "g")] {
            let value = match self.x.source_or(node, name, 1.0) {
                Source::Plain(c) => c.mean(),
                texture => match self.channel(&texture, channel) {
                    Some((factor, reference)) if map.is_none() || map.as_ref() == Some(&reference) => {
                        map = Some(reference);
                        factor
                    }
                    _ => {
                        let what = format!("the texture of '{name}' is not that of glTF's one picture and becomes 0.5");
                        self.x.approximated(node, what);
                        0.5
                    }
                },
            };
            draft.base.insert(key.into(), json!(value));
        }
        if let Some(map) = map {
            draft.base.insert("metallicRoughnessTexture".into(), map);
        }
        for row in [
            ("specular", "KHR_materials_specular", "specular", "a", 1.0),
            ("transmission", "KHR_materials_transmission", "transmission", "r", 0.0),
            ("clearcoat", "KHR_materials_clearcoat", "clearcoat", "r", 0.0),
            ("clearcoat_roughness", "KHR_materials_clearcoat", "clearcoatRoughness", "g", 0.0),
            ("anisotropy", "KHR_materials_anisotropy", "anisotropyStrength", "b", 0.0),
            ("iridescence", "KHR_materials_iridescence", "iridescence", "r", 0.0),
            ("diffuse_transmission", "KHR_materials_diffuse_transmission", "diffuseTransmission", "a", 0.0),
        ] {
            self.factor(draft, node, row);
        }
        for (name, extension, key, default) in [
            ("specular_color", "KHR_materials_specular", "specularColor", 1.0),
            ("diffuse_transmission_color", "KHR_materials_diffuse_transmission", "diffuseTransmissionColor", 1.0),
        ] {
            let Some(source) = self.x.source(node, name) else { continue };
            let Tinted { factor, image, .. } = self.product(&source);
            if factor != [default; 3] {
                draft.extension(extension)[format!("{key}Factor")] = json!(factor);
            }
            if let Some(texture) = image.and_then(|id| self.colors(id)) {
                draft.extension(extension)[format!("{key}Texture")] = texture;
            }
        }
        self.sheen(draft, node);
        self.index(draft, node, "eta", 1.5);
        if let Some(dispersion) = node.float("dispersion").filter(|d| *d != 0.0) {
            draft.extension("KHR_materials_dispersion")["dispersion"] = json!(dispersion);
        }
        if let Some(rotation) = node.float("anisotropy_rotation").filter(|r| *r != 0.0) {
            draft.extension("KHR_materials_anisotropy")["anisotropyRotation"] = json!(rotation.to_radians());
        }
        self.directions(draft, node);
        if draft.extensions.contains_key("KHR_materials_iridescence") {
            let eta = node.float("iridescence_eta").unwrap_or(1.3);
            draft.extension("KHR_materials_iridescence")["iridescenceIor"] = json!(eta);
            match self.x.source_or(node, "iridescence_thickness", 400.0) {
                Source::Plain(c) => {
                    draft.extension("KHR_materials_iridescence")["iridescenceThicknessMaximum"] = json!(c.mean());
                }
                Source::Texture(_) => self.x.approximated(node, "the texture of the film's thickness is left out"),
            }
        }
        if node.bool("thin") == Some(false) {
            draft.extension("KHR_materials_volume")["thicknessFactor"] = json!(1.0);
        }
    }

    /// Disney's and OpenPBR by what they have in common.
    fn principled(&mut self, draft: &mut Draft, node: &Node) {
        self.x.approximated(node, format!("'{}' becomes glTF's metallic-roughness", node.kind));
        let openpbr = node.kind == "openpbr";
        let named = |ours: &'static str, theirs: &'static str| if openpbr { theirs } else { ours };
        let color = self.x.base_color_of(node);
        let base = self.x.source_or(node, color, if openpbr { 0.8 } else { 0.5 });
        self.base_color(draft, &base);
        for (key, name, default) in [
            ("metallicFactor", named("metallic", "base_metalness"), 0.0),
            ("roughnessFactor", named("roughness", "specular_roughness"), if openpbr { 0.3 } else { 0.5 }),
        ] {
            let value = match self.x.source_or(node, name, default) {
                Source::Plain(c) => c.mean(),
                Source::Texture(_) => {
                    self.x.approximated(node, format!("the texture of '{name}' becomes 0.5"));
                    0.5
                }
            };
            draft.base.insert(key.into(), json!(value.clamp(0.0, 1.0)));
        }
        for (name, extension, key, channel) in [
            (named("spec_trans", "transmission_weight"), "KHR_materials_transmission", "transmission", "r"),
            (named("clearcoat", "coat_weight"), "KHR_materials_clearcoat", "clearcoat", "r"),
        ] {
            self.factor(draft, node, (name, extension, key, channel, 0.0));
        }
        let eta = named("eta", "specular_ior");
        if node.get(eta).is_some() {
            self.index(draft, node, eta, 1.5);
        }
        if draft.extensions.contains_key("KHR_materials_transmission") && node.kind != "principledthin" {
            draft.extension("KHR_materials_volume")["thicknessFactor"] = json!(1.0);
        }
    }

    /// Emission of surfaces; whether both sides emit.
    fn emission(&mut self, draft: &mut Draft, id: NodeId, shape: &Shape) -> bool {
        let node = self.x.node(id);
        if node.kind != "area" || node.get("file").is_some() {
            self.x.dropped(node, format!("emission '{}' by a file or a direction is left out", node.kind));
            return false;
        }
        let two_sided = node.bool("two_sided").unwrap_or(false);
        let area = self.area(shape);
        let sides = if two_sided { 2.0 } else { 1.0 };
        let k = self.x.light_scale(node, "radiance", "power", sides * area * std::f64::consts::PI);
        let Tinted { factor, image, .. } = match self.x.emission(node, "radiance") {
            Source::Plain(c) => Tinted { factor: c.emitted_rgb(), ..Tinted::default() },
            texture => self.product(&texture),
        };
        let color = factor.map(|v| (v * k).max(0.0));
        let strength = color.into_iter().fold(0.0, f64::max);
        self.shines |= strength > 1.0;
        if strength > 1.0 {
            draft.extension("KHR_materials_emissive_strength")["emissiveStrength"] = json!(strength);
            draft.top.insert("emissiveFactor".into(), json!(color.map(|v| v / strength)));
        } else {
            draft.top.insert("emissiveFactor".into(), json!(color));
        }
        if let Some(texture) = image.and_then(|id| self.colors(id)) {
            draft.top.insert("emissiveTexture".into(), texture);
        }
        two_sided
    }

    /// Attenuation and scattering by an interior homogeneous medium.
    fn volume(&mut self, draft: &mut Draft, id: NodeId) {
        let node = self.x.node(id);
        if node.kind != "homogeneous" {
            self.x.dropped(node, format!("medium '{}' cannot be expressed and is left out", node.kind));
            return;
        }
        let plain = |x: &Self, name: &str, default: f64| match x.x.source_or(node, name, default) {
            Source::Plain(c) => c.rgb(),
            Source::Texture(_) => [default; 3],
        };
        let scale = node.float("scale").unwrap_or(1.0);
        let (sigma_t, albedo) = if node.get("sigma_t").is_some() || node.get("albedo").is_some() {
            (plain(self, "sigma_t", 1.0), plain(self, "albedo", 0.75))
        } else {
            let (a, s) = (plain(self, "sigma_a", 1.0), plain(self, "sigma_s", 1.0));
            let t = [0, 1, 2].map(|i| a[i] + s[i]);
            (t, [0, 1, 2].map(|i| if t[i] > 0.0 { s[i] / t[i] } else { 0.0 }))
        };
        let sigma_t = sigma_t.map(|v| v * scale);
        let mean = sigma_t.iter().sum::<f64>() / 3.0;
        if mean <= 0.0 {
            return;
        }
        let e = draft.extension("KHR_materials_volume");
        e["thicknessFactor"] = json!(1.0);
        e["attenuationDistance"] = json!(1.0 / mean);
        e["attenuationColor"] = json!(sigma_t.map(|v| (-v / mean).exp()));
        if albedo.iter().any(|a| *a > 0.0) {
            let g = match node.get("phase") {
                Some(&Value::Node(phase)) => self.x.node(phase).float("g"),
                _ => node.float("g"),
            };
            let e = draft.extension("KHR_materials_volume_scatter");
            e["multiscatterColor"] = json!(albedo.map(crate::gltf::multiple_scattering_albedo));
            e["scatterAnisotropy"] = json!(g.unwrap_or(0.0).clamp(-0.99, 0.99));
        }
    }
}

/// Material extensions used by the writer.
const EXTENSIONS: [&str; 13] = [
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_diffuse_transmission",
    "KHR_materials_dispersion",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_iridescence",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_volume",
    "KHR_materials_volume_scatter",
];
