//! BSDFs to materials. Mitsuba's defaults are written out, for Steradian's own need not be the same.

use super::{
    graph::{Category, ObjectId},
    reader::Reader,
    texture::Role,
    told::NOISE,
};
use steradian_scene::{Family, Node, NodeId, SpectrumValue, Value};

impl Reader<'_> {
    /// A BSDF as a material node; `None` after an error.
    pub fn material(&mut self, object: ObjectId) -> Option<NodeId> {
        self.once(object, Role::Unbounded, |r| r.material_node(object))
    }

    fn material_node(&mut self, object: ObjectId) -> Option<NodeId> {
        let plugin = self.plugin(object).to_owned();
        self.graph.objects[object].visited = true;
        let node = match plugin.as_str() {
            "diffuse" => {
                let mut node = self.node(Family::Material, "diffuse", object);
                self.put(&mut node, "reflectance", object, "reflectance", Role::Reflectance, 0.5);
                node
            }
            "conductor" | "roughconductor" => self.conductor(object, plugin == "roughconductor"),
            "dielectric" | "roughdielectric" => {
                let mut node = self.node(Family::Material, "dielectric", object);
                let eta = self.relative_ior(object, "bk7");
                node.set("eta", eta, Some(self.value_span(object, "int_ior")));
                if plugin == "roughdielectric" {
                    self.roughness(&mut node, object);
                }
                self.specular(&mut node, object, true);
                node
            }
            "thindielectric" => {
                let mut node = self.node(Family::Material, "thin_dielectric", object);
                let eta = self.relative_ior(object, "bk7");
                node.set("eta", eta, Some(self.value_span(object, "int_ior")));
                self.specular(&mut node, object, true);
                node
            }
            "plastic" | "roughplastic" => {
                let mut node = self.node(Family::Material, "plastic", object);
                self.put(&mut node, "diffuse_reflectance", object, "diffuse_reflectance", Role::Reflectance, 0.5);
                let eta = self.relative_ior(object, "polypropylene");
                node.set("eta", eta, Some(self.value_span(object, "int_ior")));
                let nonlinear = self.bool(object, "nonlinear").unwrap_or(false);
                node.set("nonlinear", nonlinear, None);
                if plugin == "roughplastic" {
                    self.roughness(&mut node, object);
                }
                self.specular(&mut node, object, false);
                node
            }
            "roughdiffuse" => self.rough_diffuse(object),
            "phong" | "ward" => self.classical_lobe(object, plugin == "ward"),
            "twosided" => {
                let sides = self.nested(object, 1, 2)?;
                let back = sides.get(1).or(sides.first()).copied()?;
                self.no_effect(object, &["allow_transmission"], "materials inside may transmit light as they are");
                self.node(Family::Material, "two_sided", object).with("front", *sides.first()?).with("back", back)
            }
            "mask" => {
                let mut node = self.node(Family::Material, "mask", object);
                self.put(&mut node, "opacity", object, "opacity", Role::Scalar, 0.5);
                node.with("material", *self.nested(object, 1, 1)?.first()?)
            }
            "blendbsdf" => {
                let mut node = self.node(Family::Material, "mix", object);
                if !self.put_given(&mut node, "amount", object, "weight", Role::Scalar) {
                    self.error(self.span(object), "the BSDF 'blendbsdf' needs 'weight'");
                }
                node.with("materials", self.nested(object, 2, 2)?)
            }
            "measured" | "measured_polarized" => {
                let file = self.needed_file(object, "filename")?;
                self.no_effect(object, &["alpha_sample"], NOISE);
                let span = Some(self.value_span(object, "filename"));
                let mut node = self.node(Family::Material, "measured", object);
                node.set("file", Value::Path(file), span);
                node
            }
            "hair" => self.hair(object),
            "pplastic" => self.polarized_plastic(object),
            "polarizer" | "circular" => self.polarizer(object),
            "retarder" => self.retarder(object),
            "null" => self.node(Family::Material, "interface", object),
            "bumpmap" | "normalmap" => return self.mapped(object, plugin == "normalmap"),
            // Disney's have the same parameters in both vocabularies.
            "principled" | "principledthin" => return self.taken_over(object, &plugin),
            _ if self.is_known(object) => return self.verbatim(object, Family::Material),
            _ => return self.taken_over(object, &plugin),
        };
        Some(self.desc.add(node))
    }

    /// A model under Steradian's own name with its own parameters. Sampling rates change the noise only.
    fn taken_over(&mut self, object: ObjectId, kind: &str) -> Option<NodeId> {
        let Some(model) = self.options.kinds.model(Family::Material, kind) else {
            self.unknown_plugin(object);
            return None;
        };
        let node = self.verbatim(object, Family::Material);
        for p in model.all() {
            self.ignore(object, &[p.name]);
        }
        for p in &mut self.graph.objects[object].props {
            p.used = p.name.is_empty() || p.name.ends_with("_sampling_rate") || model.parameter(&p.name).is_some();
        }
        node
    }

    /// The nested BSDFs, of which there must be between `least` and `most`.
    fn nested(&mut self, object: ObjectId, least: usize, most: usize) -> Option<Vec<NodeId>> {
        let children = self.graph.children(object, Category::Bsdf);
        if !(least..=most).contains(&children.len()) {
            let wanted = if least == most { least.to_string() } else { format!("{least} or {most}") };
            let message =
                format!("the BSDF '{}' needs {wanted} nested BSDFs, not {}", self.plugin(object), children.len());
            self.error(self.span(object), message);
            return None;
        }
        children.into_iter().map(|(_, child)| self.material(child)).collect()
    }

    fn conductor(&mut self, object: ObjectId, rough: bool) -> Node {
        let mut node = self.node(Family::Material, "conductor", object);
        let material = self.string(object, "material");
        let measured = material.as_deref().filter(|m| *m != "none");
        match measured {
            Some(_) if self.graph.has(object, "eta") || self.graph.has(object, "k") => {
                self.error(self.value_span(object, "material"), "'material' excludes 'eta' and 'k'");
                self.ignore(object, &["eta", "k"]);
            }
            Some(name) => {
                if let Some(ours) = self.conductor_name(object, name) {
                    let span = Some(self.value_span(object, "material"));
                    let named = |what: &str| SpectrumValue::Named(format!("metal-{ours}-{what}"));
                    node.set("eta", named("eta"), span).set("k", named("k"), span);
                }
            }
            // Mitsuba 0.6 means copper where nothing is said; later versions a perfect mirror.
            None if material.is_none() && self.graph.objects[object].legacy && !self.graph.has(object, "eta") => {
                let named = |what: &str| SpectrumValue::Named(format!("metal-Cu-{what}"));
                node.set("eta", named("eta"), None).set("k", named("k"), None);
            }
            None if self.graph.has(object, "eta") || self.graph.has(object, "k") => {
                self.put(&mut node, "eta", object, "eta", Role::Unbounded, 0.0);
                self.put(&mut node, "k", object, "k", Role::Unbounded, 1.0);
            }
            None => {}
        }
        if self.graph.has(object, "ext_eta") {
            let outside = self.ior(object, "ext_eta", "air");
            if outside > 1.01 {
                let span = self.value_span(object, "ext_eta");
                self.dropped(span, "a conductor is taken to border on air; 'ext_eta' is left out");
            }
        }
        if rough {
            self.roughness(&mut node, object);
        }
        self.specular(&mut node, object, false);
        node
    }

    /// Oren–Nayar of Mitsuba 0.6, whose `alpha` is a root mean square slope: σ times √2.
    fn rough_diffuse(&mut self, object: ObjectId) -> Node {
        let mut node = self.node(Family::Material, "oren_nayar", object);
        self.put(&mut node, "reflectance", object, "reflectance", Role::Reflectance, 0.5);
        let fast = self.bool(object, "use_fast_approx").unwrap_or(false);
        node.set("form", if fast { "qualitative" } else { "full" }, None);
        let (alpha, span) =
            self.spectral(object, "alpha", Role::Scalar).unwrap_or((Value::Float(0.2), self.span(object)));
        let sigma = match alpha {
            Value::Float(v) => Value::Float(v * std::f64::consts::FRAC_1_SQRT_2),
            map => Value::Node(self.scaled(object, map, std::f64::consts::FRAC_1_SQRT_2)),
        };
        node.set("sigma", sigma, Some(span));
        node
    }

    /// Phong's and Ward's models of Mitsuba 0.6.
    fn classical_lobe(&mut self, object: ObjectId, ward: bool) -> Node {
        let mut node = self.node(Family::Material, if ward { "ward" } else { "phong" }, object);
        self.put(&mut node, "diffuse_reflectance", object, "diffuse_reflectance", Role::Reflectance, 0.5);
        self.put(&mut node, "specular_reflectance", object, "specular_reflectance", Role::Reflectance, 0.2);
        if ward {
            let form = match self.choice(object, "variant", &["balanced", "ward", "ward-duer"]) {
                "ward" => "ward",
                "ward-duer" => "duer",
                _ => "bounded",
            };
            node.set("form", form, None);
            for name in ["alpha_u", "alpha_v"] {
                self.put(&mut node, name, object, name, Role::Scalar, 0.1);
            }
        } else {
            node.set("form", "modified", None);
            self.put(&mut node, "exponent", object, "exponent", Role::Scalar, 30.0);
        }
        node
    }

    /// The microfacet parameters: `alpha`, or `alpha_u` and `alpha_v`; Beckmann unless said otherwise.
    pub(super) fn roughness(&mut self, node: &mut Node, object: ObjectId) {
        let distribution =
            self.choice(object, "distribution", &["beckmann", "ggx", "phong", "as", "student_t", "gaussian"]);
        let distribution = match distribution {
            // Both are the cosine power of Ashikhmin and Shirley.
            "phong" | "as" => "blinn",
            known => known,
        };
        let has = |r: &Self, name: &str| r.graph.has(object, name);
        if has(self, "alpha_u") || has(self, "alpha_v") {
            if has(self, "alpha") {
                self.error(self.value_span(object, "alpha"), "'alpha' excludes 'alpha_u' and 'alpha_v'");
                self.ignore(object, &["alpha"]);
            }
            for (name, other) in [("alpha_u", "alpha_v"), ("alpha_v", "alpha_u")] {
                if !self.put_given(node, name, object, name, Role::Scalar) && !has(self, name) {
                    self.error(self.value_span(object, other), format!("'{other}' needs '{name}' beside it"));
                }
            }
        } else {
            let alpha = self.spectral(object, "alpha", Role::Scalar);
            let (value, span) = alpha.map_or((Value::Float(0.1), None), |(v, s)| (v, Some(s)));
            node.set("alpha_u", value.clone(), span).set("alpha_v", value, span);
        }
        node.set("distribution", distribution, None).set("remap_roughness", false, None);
        self.no_effect(object, &["sample_visible"], NOISE);
        // Steradian's own choices.
        for name in ["shadowing", "compensation", "fresnel"] {
            if let Some(word) = self.string(object, name) {
                node.set(name, word, Some(self.value_span(object, name)));
            }
        }
        for name in ["gamma", "film_thickness", "film_eta"] {
            self.put_given(node, name, object, name, Role::Scalar);
        }
    }

    pub(super) fn specular(&mut self, node: &mut Node, object: ObjectId, transmits: bool) {
        self.put_given(node, "specular_reflectance", object, "specular_reflectance", Role::Reflectance);
        if transmits {
            self.put_given(node, "specular_transmittance", object, "specular_transmittance", Role::Reflectance);
        }
    }

    /// Bump and normal maps: the nested material with the map on it.
    fn mapped(&mut self, object: ObjectId, normals: bool) -> Option<NodeId> {
        let inner = *self.nested(object, 1, 1)?.first()?;
        // Version 0.6 knows neither.
        let legacy = self.graph.objects[object].legacy;
        let flips = !legacy && self.bool(object, "flip_invalid_normals").unwrap_or(true);
        let shadows = !legacy && self.bool(object, "use_shadowing_function").unwrap_or(true);
        let scale = if normals { 1.0 } else { self.float(object, "scale").unwrap_or(1.0) };
        let textures = self.graph.children(object, Category::Texture);
        let [(_, texture)] = textures[..] else {
            let message = format!("the BSDF '{}' needs one texture, not {}", self.plugin(object), textures.len());
            self.error(self.span(object), message);
            return None;
        };
        let role = if normals { Role::Unbounded } else { Role::Scalar };
        let mut map = self.texture(texture, role)?;
        if scale != 1.0 {
            map = Value::Node(self.scaled(object, map, scale));
        }
        let mut node = self.desc.node(inner).clone();
        if node.get("normal_map").or(node.get("bump")).is_some() {
            let span = self.span(object);
            self.approximated(span, "of several nested bump and normal maps the outermost of each is used");
        }
        node.set(if normals { "normal_map" } else { "bump" }, map, Some(self.span(texture)));
        node.set("detail_facing", if flips { "turned" } else { "as_it_is" }, None);
        node.set("detail_shadowing", shadows, None);
        node.span = Some(self.span(object));
        Some(self.desc.add(node))
    }
}
