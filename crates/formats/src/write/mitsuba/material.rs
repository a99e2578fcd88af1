//! BSDFs.

use super::{Element, Role, Writer};
use crate::write::{coat::Coat, colour::Colour, exchange::Source};
use steradian_scene::{Family, Node, NodeId, SpectrumValue, Value};

/// Parameters that nothing in Mitsuba's microfacet models corresponds to.
const FACETS: [&str; 6] = ["gamma", "compensation", "fresnel", "film_thickness", "film_eta", "permittivity"];
/// Below this α Mitsuba's `roughplastic` is written as `plastic`.
const NEARLY_SMOOTH: f64 = 0.002;
/// Parameters beyond a plain normal map.
const NORMAL_MAPS: [&str; 3] = ["normal_map_strength", "normal_map_filter", "anisotropy_rotation"];

impl Writer<'_> {
    /// The id of a material in the document, which is written there at its first use.
    pub(super) fn material(&mut self, id: NodeId) -> String {
        if let Some(known) = self.materials.get(&id) {
            return known.clone();
        }
        let node = self.x.node(id);
        let name = self.x.name(node.name.as_deref(), "material");
        if !self.open.insert(id) {
            self.x.dropped(node, "a material that contains itself is left out");
            return name;
        }
        let element = self.detailed(node).with("id", name.clone());
        self.open.remove(&id);
        self.scene.push(element);
        if !self.no_texture {
            self.materials.insert(id, name.clone());
        }
        name
    }

    fn reference(&mut self, id: NodeId) -> Element {
        Element::new("ref").with("id", self.material(id))
    }

    /// A material with its normal and bump maps around it, on both sides where the scene means both.
    fn detailed(&mut self, node: &Node) -> Element {
        let (mut out, reflects) = self.bsdf(node);
        for name in ["bump", "displacement"] {
            if let Some(Source::Texture(id)) = self.x.source(node, name) {
                let hidden = node.get("normal_map").is_some() && self.x.desc.format == steradian_scene::Format::Pbrt;
                match self.texture("nested", id, Role::Scalar, 1.0) {
                    _ if hidden => {}
                    Ok(map) => out = Element::plugin("bsdf", "bumpmap").child(map).child(out),
                    Err(_) => self.x.dropped(node, format!("the bump map '{name}' is left out")),
                }
            }
        }
        if let Some(Source::Texture(id)) = self.x.source(node, "normal_map") {
            self.x.without(node, &NORMAL_MAPS);
            if node.string("normal_map_code").unwrap_or("xyz") != "xyz" {
                self.x.without(node, &["normal_map_code"]);
            }
            match self.texture("normalmap", id, Role::Unbounded, 1.0) {
                Ok(map) => out = Element::plugin("bsdf", "normalmap").child(map).child(out),
                Err(_) => self.x.dropped(node, "the normal map is left out"),
            }
        }
        if reflects && !self.is_one_sided() { Element::plugin("bsdf", "twosided").child(out) } else { out }
    }

    /// A BSDF, and whether it only reflects, on the side of the normal alone.
    fn bsdf(&mut self, node: &Node) -> (Element, bool) {
        let plain = |plugin: &str| Element::plugin("bsdf", plugin);
        match node.kind.as_str() {
            "diffuse" => (self.diffuse(node, "reflectance", 0.5), true),
            "conductor" => (self.conductor(node, ["eta", "k", "reflectance"], ["alpha_u", "alpha_v"]), true),
            "dielectric" => {
                let rough = self.is_rough(node, "alpha_u", "alpha_v");
                let mut out = plain(if rough { "roughdielectric" } else { "dielectric" });
                self.index(&mut out, node, "eta", 1.5, true);
                self.facets(&mut out, node, rough, ["alpha_u", "alpha_v"]);
                self.specular(&mut out, node, true);
                (out, false)
            }
            "thin_dielectric" => {
                let mut out = plain("thindielectric");
                self.index(&mut out, node, "eta", 1.5, false);
                self.specular(&mut out, node, true);
                (out, false)
            }
            "polarizer" => (self.polarizer(node), false),
            "retarder" => {
                let mut out = plain("retarder");
                self.angles(&mut out, node, &[("theta", 0.0), ("delta", 90.0)]);
                (out, false)
            }
            "plastic" => (self.plastic(node, "diffuse_reflectance", 1.49), true),
            "coated_diffuse" => {
                let what = "'coated_diffuse' becomes 'plastic' over a base that looks the same straight on";
                self.x.approximated(node, what);

                (self.plastic(node, "reflectance", 1.5), true)
            }
            "coated_conductor" => {
                self.x.approximated(node, "the coat of 'coated_conductor' is left out");
                let names = ["conductor.eta", "conductor.k", "reflectance"];
                (self.conductor(node, names, ["conductor.uroughness", "conductor.vroughness"]), true)
            }
            "diffuse_transmission" => (self.diffuse_transmission(node), false),
            "hair" => (self.hair(node), false),
            "principled" | "principledthin" => self.principled(node),
            "metallic_roughness" | "openpbr" => self.layered(node),
            "measured" => self.measured(node),
            "interface" => (plain("null"), false),
            "mask" => {
                let mut out = plain("mask");
                let opacity = self.x.source_or(node, "opacity", 0.5);
                self.put(&mut out, "opacity", &opacity, Role::Scalar);
                let inner = self.nested(node, "material");
                (out.child(inner), false)
            }
            "two_sided" => {
                let mut out = plain("twosided");
                for side in ["front", "back"] {
                    if let Some(&Value::Node(id)) = node.get(side) {
                        // Both sides the same is the default.
                        if side == "back" && node.get("front") == node.get("back") {
                            continue;
                        }
                        out.push(self.one_side(id));
                    }
                }
                (out, false)
            }
            "mix" => {
                let mut out = plain("blendbsdf");
                let amount = self.x.source_or(node, "amount", 0.5);
                self.put(&mut out, "weight", &amount, Role::Scalar);
                if let Some(Value::Nodes(parts)) = node.get("materials") {
                    for &part in parts {
                        let part = self.reference(part);
                        out.push(part);
                    }
                }
                (out, false)
            }
            other => (self.stand_in(node, other), true),
        }
    }

    fn polarizer(&mut self, node: &Node) -> Element {
        let form = node.string("form").unwrap_or("linear");
        let mut out = Element::plugin("bsdf", if form == "linear" { "polarizer" } else { "circular" });
        if form == "linear" {
            self.angles(&mut out, node, &[("theta", 0.0)]);
        } else {
            out.boolean("left_handed", form == "left_circular");
        }
        let transmittance = self.x.source_or(node, "transmittance", 1.0);
        self.put(&mut out, "transmittance", &transmittance, Role::Reflectance);
        out
    }

    fn angles(&mut self, out: &mut Element, node: &Node, names: &[(&str, f64)]) {
        for &(name, default) in names {
            let source = self.x.source_or(node, name, default);
            self.put(out, name, &source, Role::Scalar);
        }
    }

    /// A material inside `twosided`, which takes none that are two-sided themselves.
    fn one_side(&mut self, id: NodeId) -> Element {
        let node = self.x.node(id);
        if self.is_one_sided() {
            return self.reference(id);
        }
        let (out, reflects) = self.bsdf(node);
        if !reflects {
            self.x
                .approximated(node, format!("Mitsuba's 'twosided' takes no '{}', through which light goes", node.kind));
            return self.diffuse(node, "reflectance", 0.5);
        }
        out
    }

    fn nested(&mut self, node: &Node, name: &str) -> Element {
        match node.get(name) {
            Some(&Value::Node(id)) => self.reference(id),
            _ => Element::plugin("bsdf", "diffuse"),
        }
    }

    fn diffuse(&mut self, node: &Node, name: &str, default: f64) -> Element {
        let mut out = Element::plugin("bsdf", "diffuse");
        let reflectance = self.x.source_or(node, name, default);
        self.put(&mut out, "reflectance", &reflectance, Role::Reflectance);
        out
    }

    /// A diffuse surface for models that Mitsuba lacks.
    fn stand_in(&mut self, node: &Node, kind: &str) -> Element {
        self.x.approximated(node, format!("Mitsuba has no material like '{kind}'; a diffuse surface stands for it"));
        let names = ["reflectance", "diffuse_reflectance", "base_color", "color"];
        let name = names.into_iter().find(|n| node.get(n).is_some()).unwrap_or("reflectance");
        self.diffuse(node, name, 0.5)
    }

    fn is_rough(&mut self, node: &Node, u: &str, v: &str) -> bool {
        [u, v].iter().any(|n| match self.x.source_or(node, n, 0.0) {
            Source::Plain(c) => c.mean() > 0.0,
            Source::Texture(_) => true,
        })
    }

    fn facets(&mut self, out: &mut Element, node: &Node, rough: bool, [u, v]: [&str; 2]) {
        self.x.without(node, &FACETS);
        if !rough {
            return;
        }
        let distribution = match node.string("distribution").unwrap_or("ggx") {
            known @ ("ggx" | "beckmann") => known,
            other => {
                self.x.approximated(node, format!("the distribution '{other}' of facets is replaced by 'ggx'"));
                "ggx"
            }
        };
        out.string("distribution", distribution);
        let default = if self.is_one_sided() { "separable" } else { "height_correlated" };
        let shadowing = node.string("shadowing").unwrap_or(default);
        if shadowing != "separable" {
            let what = format!("the masking and shadowing of facets is Mitsuba's 'separable', not '{shadowing}'");
            self.x.approximated(node, what);
        }
        let (u, v) = (self.x.alpha(node, u), self.x.alpha(node, v));
        match (&u, &v) {
            (Source::Plain(a), Source::Plain(b)) if a == b => self.put(out, "alpha", &u, Role::Scalar),
            (Source::Texture(a), Source::Texture(b)) if a == b => self.put(out, "alpha", &u, Role::Scalar),
            _ => {
                self.put(out, "alpha_u", &u, Role::Scalar);
                self.put(out, "alpha_v", &v, Role::Scalar);
            }
        }
    }

    fn specular(&mut self, out: &mut Element, node: &Node, transmits: bool) {
        for name in ["specular_reflectance", "specular_transmittance"] {
            if let Some(source) = self.x.source(node, name).filter(|_| transmits || name == "specular_reflectance") {
                self.put(out, name, &source, Role::Reflectance);
            }
        }
    }

    /// Interior over exterior index of refraction; the exterior's is one.
    fn index(&mut self, out: &mut Element, node: &Node, name: &str, default: f64, bends: bool) {
        self.x.without(node, &["abbe_number", "cauchy", "sellmeier"]);
        let eta = match self.x.source_or(node, name, default) {
            Source::Plain(Colour::Grey(v)) => v,
            Source::Plain(c) => {
                self.x.approximated(node, "an index of refraction over wavelength becomes that at 589.3 nm");
                c.at_sodium_line()
            }
            Source::Texture(_) => {
                self.x.approximated(node, format!("a textured index of refraction becomes {default}"));
                default
            }
        };
        // Rough interfaces between equal media do not exist in Mitsuba.
        let eta = if bends && (eta - 1.0).abs() < 1e-4 { 1.0001 } else { eta };
        out.float("int_ior", eta);
        out.float("ext_ior", 1.0);
    }

    fn conductor(&mut self, node: &Node, [eta, k, reflectance]: [&str; 3], alphas: [&str; 2]) -> Element {
        let rough = self.is_rough(node, alphas[0], alphas[1]);
        let mut out = Element::plugin("bsdf", if rough { "roughconductor" } else { "conductor" });
        if let Some(source) = self.x.source(node, reflectance) {
            match source {
                Source::Plain(c) => {
                    // pbrt's: η of one, and the κ that reflects so much straight on.
                    let c = c.map(|r| r.clamp(0.0, 0.9999));
                    self.x.approximated(
                        node,
                        "a conductor's 'reflectance' becomes an index of refraction of that colour",
                    );
                    out.push(super::colour("eta", &Colour::Rgb([1.0; 3]), Role::Unbounded));
                    let c = Colour::Rgb(c.rgb());
                    out.push(super::colour("k", &c.map(|r| 2.0 * (r / (1.0 - r)).sqrt()), Role::Unbounded));
                }
                texture => {
                    self.x.approximated(node, "a conductor's textured 'reflectance' becomes that of a mirror");
                    out.string("material", "none");
                    self.put(&mut out, "specular_reflectance", &texture, Role::Reflectance);
                }
            }
        } else if let Some(metal) = metal(node, eta, k).filter(|_| self.is_one_sided()) {
            out.string("material", metal);
        } else if node.get(eta).is_none() && node.get(k).is_none() {
            out.string("material", "none");
        } else {
            for (to, from, default) in [("eta", eta, 1.0), ("k", k, 0.0)] {
                let source = self.x.source_or(node, from, default);
                self.put(&mut out, to, &source, Role::Unbounded);
            }
        }
        self.facets(&mut out, node, rough, alphas);
        if node.get(reflectance).is_none() {
            self.specular(&mut out, node, false);
        }
        out
    }

    fn plastic(&mut self, node: &Node, base: &str, eta: f64) -> Element {
        let alphas = ["alpha_u", "alpha_v"].map(|n| match self.x.source_or(node, n, 0.0) {
            Source::Plain(_) => self.x.alpha(node, n),
            texture => texture,
        });
        // Mitsuba's quadrature does not resolve facets that are nearly smooth.
        let rough = !alphas.iter().all(|a| matches!(a, Source::Plain(c) if c.mean() < NEARLY_SMOOTH));
        let mut out = Element::plugin("bsdf", if rough { "roughplastic" } else { "plastic" });
        let reflectance = self.x.source_or(node, base, 0.5);
        if node.kind == "coated_diffuse" {
            let index =
                if let Source::Plain(c) = self.x.source_or(node, "eta", eta) { c.at_sodium_line() } else { eta };
            let (thickness, depth) = (node.float("thickness").unwrap_or(0.01), node.int("max_depth").unwrap_or(10));
            let (from, to) = (Coat::layered(index, thickness, depth), Coat::plastic(index, true));
            match &reflectance {
                Source::Plain(c) => {
                    let c = Source::Plain(c.map(|rho| to.base_like(&from, rho.clamp(0.0, 1.0))));
                    self.put(&mut out, "diffuse_reflectance", &c, Role::Reflectance);
                }
                texture => {
                    let k = to.base_like(&from, 0.5) / 0.5;
                    self.put_scaled(&mut out, "diffuse_reflectance", texture, Role::Reflectance, k);
                }
            }
        } else {
            self.put(&mut out, "diffuse_reflectance", &reflectance, Role::Reflectance);
        }
        self.index(&mut out, node, "eta", eta, true);
        out.boolean("nonlinear", node.kind == "coated_diffuse" || node.bool("nonlinear").unwrap_or(false));
        if rough {
            // Mitsuba's has one roughness, the same everywhere.
            let mut mean = node.clone();
            let alphas = ["alpha_u", "alpha_v"].map(|n| self.x.alpha(node, n));
            let value = match &alphas {
                [Source::Plain(a), Source::Plain(b)] => {
                    if a != b {
                        self.x.approximated(node, "'roughplastic' is as rough both ways: the mean of both counts");
                    }
                    0.5 * (a.mean() + b.mean())
                }
                _ => {
                    self.x.approximated(node, "'roughplastic' takes no textured roughness: 0.1 stands for it");
                    0.1
                }
            };
            mean.set("alpha_u", value, None).set("alpha_v", value, None).set("remap_roughness", false, None);
            self.facets(&mut out, &mean, true, ["alpha_u", "alpha_v"]);
        }
        self.specular(&mut out, node, false);
        out
    }

    /// A thin sheet without gloss.
    fn diffuse_transmission(&mut self, node: &Node) -> Element {
        self.x
            .approximated(node, "'diffuse_transmission' becomes 'principledthin', which has one colour for both ways");
        let mut out = Element::plugin("bsdf", "principledthin");
        let both = ["reflectance", "transmittance"].map(|n| self.x.source_or(node, n, 0.25));
        let (color, share) = match &both {
            [Source::Plain(r), Source::Plain(t)] => {
                let sum = r.with(t, |r, t| r + t);
                let share = t.mean() / sum.mean().max(1e-6);
                (Source::Plain(sum.map(|v| v.min(1.0))), share)
            }
            [texture @ Source::Texture(_), _] | [_, texture] => (texture.clone(), 0.5),
        };
        self.put(&mut out, "base_color", &color, Role::Reflectance);
        out.float("roughness", 0.5);
        out.float("spec_trans", 0.0);
        out.float("diff_trans", 2.0 * share);
        out
    }

    fn hair(&mut self, node: &Node) -> Element {
        let mut out = Element::plugin("bsdf", "hair");
        let number = |x: &Self, name: &str, default: f64| match x.x.source_or(node, name, default) {
            Source::Plain(c) => Some(c.mean()),
            Source::Texture(_) => None,
        };
        let beta_n = number(self, "beta_n", 0.3).unwrap_or(0.3);
        let color = ["reflectance", "color"].into_iter().find(|n| node.get(n).is_some());
        if let Some(sigma_a) = self.x.source(node, "sigma_a") {
            self.put(&mut out, "sigma_a", &sigma_a, Role::Unbounded);
        } else if let Some(Source::Plain(c)) = color.and_then(|name| self.x.source(node, name)) {
            // Chiang et al. 2016, equation 9: the absorption of a mass of hair of that colour.
            let n = beta_n;
            let d = 5.969 - 0.215 * n + 2.532 * n.powi(2) - 10.73 * n.powi(3) + 5.574 * n.powi(4) + 0.245 * n.powi(5);
            let c = Colour::Rgb(c.rgb()).map(|c| (c.clamp(1e-4, 1.0).ln() / d).powi(2));
            self.put(&mut out, "sigma_a", &Source::Plain(c), Role::Unbounded);
        } else if color.is_some() {
            self.x.approximated(node, "the texture of the hair's colour is left out");
        } else {
            let given = node.get("eumelanin").is_some() || node.get("pheomelanin").is_some();
            let default = if given { 0.0 } else { 1.3 };
            for (name, default) in [("eumelanin", default), ("pheomelanin", 0.0)] {
                match number(self, name, default) {
                    Some(v) => out.float(name, v),
                    None => self.x.approximated(node, format!("the texture of the hair's '{name}' is left out")),
                }
            }
        }
        for (to, from, default) in [
            ("longitudinal_roughness", "beta_m", 0.3),
            ("azimuthal_roughness", "beta_n", 0.3),
            ("scale_tilt", "alpha", 2.0),
        ] {
            match number(self, from, default) {
                Some(v) => out.float(to, v),
                None => self.x.approximated(node, format!("the texture of the hair's '{from}' is left out")),
            }
        }
        self.index(&mut out, node, "eta", 1.55, false);
        out
    }

    /// Disney's, by the same names.
    fn principled(&mut self, node: &Node) -> (Element, bool) {
        let mut out = Element::plugin("bsdf", &node.kind);
        let mut transmits = node.kind == "principledthin";
        let color = self.x.base_color_of(node);
        for param in &node.params {
            let name = param.name.as_str();
            let role = match name {
                _ if name == color => Role::Reflectance,
                "roughness" | "anisotropic" | "metallic" | "spec_trans" | "eta" | "specular" | "spec_tint"
                | "sheen" | "sheen_tint" | "flatness" | "clearcoat" | "clearcoat_gloss" | "diff_trans" => Role::Scalar,
                _ => continue,
            };
            if let Some(source) = self.x.source(node, name) {
                transmits |= name == "spec_trans" && !matches!(&source, Source::Plain(c) if c.is_black());
                self.put(&mut out, if name == color { "base_color" } else { name }, &source, role);
            }
        }
        (out, !transmits)
    }

    /// glTF's and OpenPBR as Disney's.
    fn layered(&mut self, node: &Node) -> (Element, bool) {
        self.x.approximated(node, format!("'{}' becomes Mitsuba's 'principled'", node.kind));
        self.x.without(node, &["coat_normal_map", "anisotropy_direction"]);
        let mut out = Element::plugin("bsdf", "principled");
        let names: [(&str, &str, f64); 8] = if node.kind == "openpbr" {
            [
                ("base_color", self.x.base_color_of(node), 0.8),
                ("metallic", "base_metalness", 0.0),
                ("roughness", "specular_roughness", 0.3),
                ("spec_trans", "transmission_weight", 0.0),
                ("clearcoat", "coat_weight", 0.0),
                ("sheen", "fuzz_weight", 0.0),
                ("eta", "specular_ior", 1.5),
                ("anisotropic", "specular_roughness_anisotropy", 0.0),
            ]
        } else {
            [
                ("base_color", "base_color", 1.0),
                ("metallic", "metallic", 1.0),
                ("roughness", "roughness", 1.0),
                ("spec_trans", "transmission", 0.0),
                ("clearcoat", "clearcoat", 0.0),
                ("sheen", "sheen_color", 0.0),
                ("eta", "eta", 1.5),
                ("anisotropic", "anisotropy", 0.0),
            ]
        };
        let mut transmits = false;
        for (to, from, default) in names {
            let source = self.x.source_or(node, from, default);
            let absent = node.get(from).is_none() && default == 0.0;
            if absent {
                continue;
            }
            let role = if to == "base_color" { Role::Reflectance } else { Role::Scalar };
            // Mitsuba's index of refraction is a number above one.
            if to == "eta" {
                let eta = if let Source::Plain(c) = &source { c.at_sodium_line() } else { default };
                out.float("eta", eta.max(1.0001));
                continue;
            }
            transmits |= to == "spec_trans" && !matches!(&source, Source::Plain(c) if c.is_black());
            self.put(&mut out, to, &source, role);
        }
        (out, !transmits)
    }

    fn measured(&mut self, node: &Node) -> (Element, bool) {
        let file = node.path("file").unwrap_or(std::path::Path::new("")).to_path_buf();
        let extension = file.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default();
        let plugin = match extension.as_str() {
            "bsdf" => "measured",
            "pbsdf" => "measured_polarized",
            _ => {
                self.x.approximated(node, format!("Mitsuba reads no measurements like '{}'", file.display()));
                return (self.diffuse(node, "reflectance", 0.5), true);
            }
        };
        let mut out = Element::plugin("bsdf", plugin);
        let file = self.x.beside.path(&file);
        out.string("filename", &file);
        (out, true)
    }

    /// The id of a medium in the document; none for those that Mitsuba lacks.
    pub(super) fn medium(&mut self, id: NodeId) -> Option<String> {
        if let Some(known) = self.media.get(&id) {
            return Some(known.clone());
        }
        let node = self.x.node(id);
        if node.kind != "homogeneous" {
            self.x.dropped(node, format!("medium '{}' cannot be expressed and is left out", node.kind));
            return None;
        }
        self.x.without(node, &["Le", "emission"]);
        let plain = |x: &Self, name: &str, default: f64| match x.x.source_or(node, name, default) {
            Source::Plain(c) => c,
            Source::Texture(_) => Colour::Grey(default),
        };
        let (sigma_t, albedo) = if node.get("sigma_t").is_some() || node.get("albedo").is_some() {
            (plain(self, "sigma_t", 1.0), plain(self, "albedo", 0.75))
        } else {
            let (a, s) = (plain(self, "sigma_a", 1.0), plain(self, "sigma_s", 1.0));
            let t = a.with(&s, |a, s| a + s);
            let albedo = s.with(&t, |s, t| if t > 0.0 { s / t } else { 0.0 });
            (t, albedo)
        };
        let name = self.x.name(node.name.as_deref(), "medium");
        let mut out = Element::plugin("medium", "homogeneous").with("id", name.clone());
        out.push(super::colour("sigma_t", &sigma_t, Role::Unbounded));
        out.push(super::colour("albedo", &albedo, Role::Reflectance));
        out.float("scale", node.float("scale").unwrap_or(1.0));
        out.push(self.phase(node));
        self.scene.push(out);
        self.media.insert(id, name.clone());
        Some(name)
    }

    fn phase(&mut self, medium: &Node) -> Element {
        let own = medium.float("g");
        let node = match medium.get("phase") {
            Some(&Value::Node(id)) => self.x.node(id).clone(),
            _ => Node::new(Family::Phase, if own.is_some() { "hg" } else { "isotropic" }, medium.span),
        };
        self.phase_node(&node, own)
    }

    /// A phase function; Henyey and Greenstein's takes the `g` of its medium where it has none.
    fn phase_node(&mut self, node: &Node, own: Option<f64>) -> Element {
        let g = node.float("g").or(own).unwrap_or(0.0);
        match node.kind.as_str() {
            "rayleigh" => Element::plugin("phase", "rayleigh"),
            "tabulated" => {
                let mut out = Element::plugin("phase", "tabphase");
                let values = match node.get("values") {
                    Some(Value::Floats(values)) => values.iter().map(f64::to_string).collect::<Vec<_>>().join(", "),
                    _ => String::new(),
                };
                out.string("values", &values);
                out
            }
            "blend" => {
                let mut out = Element::plugin("phase", "blendphase");
                out.float("weight", node.float("weight").unwrap_or(0.5));
                for (name, theirs) in [("first", "phase_0"), ("second", "phase_1")] {
                    if let Some(&Value::Node(id)) = node.get(name) {
                        let part = self.x.node(id).clone();
                        out.push(self.phase_node(&part, None).named(theirs));
                    }
                }
                out
            }
            "isotropic" => Element::plugin("phase", "isotropic"),
            kind => {
                if kind != "hg" {
                    self.x.approximated(node, format!("the phase function '{kind}' becomes Henyey–Greenstein's"));
                }
                let mut out = Element::plugin("phase", "hg");
                // Mitsuba excludes the ends.
                out.float("g", g.clamp(-0.999, 0.999));
                out
            }
        }
    }
}

/// The metal that both indices are measured of.
fn metal<'a>(node: &'a Node, eta: &str, k: &str) -> Option<&'a str> {
    let name = |param: &str, suffix: &str| match node.get(param) {
        Some(Value::Spectrum(SpectrumValue::Named(n))) => n.strip_prefix("metal-")?.strip_suffix(suffix),
        _ => None,
    };
    let (a, b) = (name(eta, "-eta")?, name(k, "-k")?);
    (a == b && a != "CuZn").then_some(a)
}
