//! Materials and media.

use super::{Directive, Writer, texture::Values};
use crate::write::{coat::Coat, colour::Colour, exchange::Source};
use steradian_scene::{Format, Node, NodeId, Value};

/// Parameters that nothing in pbrt's models corresponds to.
const FACETS: [&str; 6] = ["gamma", "compensation", "fresnel", "film_thickness", "film_eta", "permittivity"];
/// Parameters beyond a plain normal map.
const NORMAL_MAPS: [&str; 3] = ["normal_map_strength", "normal_map_filter", "anisotropy_rotation"];
/// The thickness of coats that do not absorb.
const THIN: f64 = 1e-3;
/// Interfaces that a walk in such a coat may meet.
const DEEP: i64 = 100;

impl Writer<'_> {
    /// The name of a material, which is written before.
    pub(super) fn material(&mut self, id: NodeId) -> String {
        if let Some(known) = self.materials.get(&id) {
            return known.clone();
        }
        let node = self.x.node(id);
        let name = self.x.name(node.name.as_deref(), "material");
        self.materials.insert(id, name.clone());
        if !self.open.insert(id) {
            self.x.dropped(node, "a material that contains itself is left out");
            return name;
        }
        let mut out = Directive::new("MakeNamedMaterial", &[&name]);
        self.body(&mut out, node);
        self.open.remove(&id);
        self.put(&out);
        name
    }

    /// The material inside of masks, and the mask.
    pub(super) fn unmasked(&mut self, id: NodeId) -> (NodeId, Option<Source>) {
        let node = self.x.node(id);
        match (node.kind.as_str(), node.get("material")) {
            ("mask", Some(&Value::Node(inner))) => {
                if self.x.node(inner).kind == "mask" {
                    self.x.approximated(node, "of nested masks the outermost counts");
                }
                let opacity = self.x.source_or(node, "opacity", 0.5);
                let mut inner = inner;
                while let ("mask", Some(&Value::Node(next))) =
                    (self.x.node(inner).kind.as_str(), self.x.node(inner).get("material"))
                {
                    if next == inner {
                        break;
                    }
                    inner = next;
                }
                (inner, Some(opacity))
            }
            ("two_sided", _) => match node.get("front") {
                Some(&Value::Node(front)) if self.x.node(front).kind == "mask" => self.unmasked(front),
                _ => (id, None),
            },
            _ => (id, None),
        }
    }

    fn body(&mut self, out: &mut Directive, node: &Node) {
        if node.kind == "two_sided" {
            if let Some(&Value::Node(front)) = node.get("front") {
                if node.get("back").is_some_and(|b| Some(b) != node.get("front")) {
                    self.x.approximated(node, "pbrt's surfaces are alike on both sides; that of the front counts");
                }
                let front = self.x.node(front);
                return self.sided(out, front, true);
            }
            self.x.dropped(node, "'two_sided' without a front is left out");
        }
        self.sided(out, node, false);
    }

    /// `both` is whether the material is known to reflect on both sides.
    fn sided(&mut self, out: &mut Directive, node: &Node, both: bool) {
        let reflects = !matches!(
            node.kind.as_str(),
            "dielectric"
                | "thin_dielectric"
                | "polarizer"
                | "retarder"
                | "diffuse_transmission"
                | "interface"
                | "mix"
                | "mask"
                | "hair"
                | "principledthin"
        );
        let is_black = node.kind == "diffuse"
            && matches!(self.x.source(node, "reflectance"), Some(Source::Plain(c)) if c.is_black());
        if self.x.desc.format == Format::Mitsuba && reflects && !both && !is_black {
            self.x.approximated(node, format!("'{}' reflects on both sides in pbrt, not on the front only", node.kind));
        }
        self.model(out, node);
        self.detail(out, node);
    }

    fn detail(&mut self, out: &mut Directive, node: &Node) {
        if let Some(Source::Texture(id)) = self.x.source(node, "normal_map") {
            self.x.without(node, &NORMAL_MAPS);
            let texture = self.x.node(id);
            match texture.path("file").filter(|_| texture.kind == "image") {
                Some(file) => {
                    if texture.string("origin") == Some("top") {
                        self.x.approximated(texture, "a normal map is laid out with v = 0 in its last row");
                    }
                    let file = self.x.beside.path(file);
                    out.string("normalmap", &file);
                }
                None => self.x.dropped(node, "a normal map that is no picture is left out"),
            }
        }
        for name in ["bump", "displacement"] {
            if let Some(Source::Texture(id)) = self.x.source(node, name) {
                match self.texture(id, Values::Float, [1.0; 3]) {
                    Ok(texture) => return out.texture("displacement", &texture),
                    Err(_) => self.x.dropped(node, format!("the bump map '{name}' is left out")),
                }
            }
        }
    }

    fn model(&mut self, out: &mut Directive, node: &Node) {
        match node.kind.as_str() {
            "diffuse" => {
                out.string("type", "diffuse");
                let reflectance = self.x.source_or(node, "reflectance", 0.5);
                self.put_spectrum(out, "reflectance", &reflectance);
            }
            "conductor" => self.conductor(out, node),
            "dielectric" => {
                out.string("type", "dielectric");
                self.index(out, node, "eta", 1.5);
                self.facets(out, node);
                self.tints(node, &["specular_reflectance", "specular_transmittance"]);
            }
            "thin_dielectric" => {
                out.string("type", "thindielectric");
                self.index(out, node, "eta", 1.5);
                self.tints(node, &["specular_reflectance", "specular_transmittance"]);
            }
            "plastic" => self.plastic(out, node),
            "coated_diffuse" => {
                out.string("type", "coateddiffuse");
                self.spectra(out, node, &[("reflectance", 0.5), ("albedo", 0.0)]);
                self.index(out, node, "eta", 1.5);
                self.facets(out, node);
                self.tints(node, &["specular_reflectance"]);
                self.floats(out, node, &[("thickness", 0.01), ("g", 0.0)]);
                self.walk(out, node);
            }
            "coated_conductor" => self.coated_conductor(out, node),
            "diffuse_transmission" => {
                out.string("type", "diffusetransmission");
                self.spectra(out, node, &[("reflectance", 0.25), ("transmittance", 0.25)]);
            }
            "hair" => self.hair(out, node),
            "measured" => self.measured(out, node),
            "mix" => self.mix(out, node),
            "interface" => out.string("type", "interface"),
            "polarizer" | "retarder" => {
                self.x.approximated(node, format!("pbrt has no '{}': nothing is there instead", node.kind));
                out.string("type", "interface");
            }
            "principled" | "principledthin" | "metallic_roughness" | "openpbr" => self.layered(out, node),
            _ => self.stand_in(out, node),
        }
    }

    fn coated_conductor(&mut self, out: &mut Directive, node: &Node) {
        out.string("type", "coatedconductor");
        self.index(out, node, "interface.eta", 1.5);
        let names = ["conductor.eta", "conductor.k", "reflectance", "albedo"];
        let given: Vec<(&str, f64)> = names.into_iter().filter(|n| node.get(n).is_some()).map(|n| (n, 0.0)).collect();
        self.spectra(out, node, &given);
        let rough = ["interface.uroughness", "interface.vroughness", "conductor.uroughness", "conductor.vroughness"];
        self.floats(out, node, &rough.map(|n| (n, 0.0)));
        self.floats(out, node, &[("thickness", 0.01), ("g", 0.0)]);
        out.bool("remaproughness", node.bool("remap_roughness").unwrap_or(false));
        self.walk(out, node);
    }

    fn hair(&mut self, out: &mut Directive, node: &Node) {
        out.string("type", "hair");
        for name in ["sigma_a", "reflectance", "color"] {
            if node.get(name).is_some() {
                self.spectra(out, node, &[(name, 0.0)]);
            }
        }
        for name in ["eumelanin", "pheomelanin"] {
            if node.get(name).is_some() {
                self.floats(out, node, &[(name, 0.0)]);
            }
        }
        self.floats(out, node, &[("eta", 1.55), ("beta_m", 0.3), ("beta_n", 0.3), ("alpha", 2.0)]);
        if node.bool("round").unwrap_or(false) {
            self.x.approximated(node, "hair lies along strips in pbrt, not around tubes");
        }
    }

    fn measured(&mut self, out: &mut Directive, node: &Node) {
        let file = node.path("file").unwrap_or(std::path::Path::new("")).to_path_buf();
        if file.extension().is_some_and(|e| e.eq_ignore_ascii_case("bsdf")) {
            out.string("type", "measured");
            let file = self.x.beside.path(&file);
            out.string("filename", &file);
        } else {
            self.x.approximated(node, format!("pbrt reads no measurements like '{}'", file.display()));
            out.string("type", "diffuse");
        }
    }

    fn mix(&mut self, out: &mut Directive, node: &Node) {
        out.string("type", "mix");
        if let Some(Value::Nodes(parts)) = node.get("materials") {
            let names: Vec<String> = parts
                .iter()
                .map(|&part| {
                    let (inner, mask) = self.unmasked(part);
                    if mask.is_some() {
                        self.x.approximated(node, "masks of the parts of a mix are left out");
                    }
                    self.material(inner)
                })
                .collect();
            out.strings("materials", &names);
        }
        self.floats(out, node, &[("amount", 0.5)]);
    }

    /// A diffuse surface for models that pbrt lacks.
    fn stand_in(&mut self, out: &mut Directive, node: &Node) {
        let message = format!("pbrt has no material like '{}'; a diffuse surface stands for it", node.kind);
        self.x.approximated(node, message);
        out.string("type", "diffuse");
        let names = ["reflectance", "diffuse_reflectance", "base_color", "color"];
        let name = names.into_iter().find(|n| node.get(n).is_some()).unwrap_or("reflectance");
        let source = self.x.source_or(node, name, 0.5);
        self.put_spectrum(out, "reflectance", &source);
    }

    fn spectra(&mut self, out: &mut Directive, node: &Node, names: &[(&str, f64)]) {
        for &(name, default) in names {
            let source = self.x.source_or(node, name, default);
            self.put_spectrum(out, name, &source);
        }
    }

    fn floats(&mut self, out: &mut Directive, node: &Node, names: &[(&str, f64)]) {
        for &(name, default) in names {
            let source = self.x.source_or(node, name, default);
            self.put_float(out, name, &source);
        }
    }

    fn walk(&mut self, out: &mut Directive, node: &Node) {
        for (to, from) in [("maxdepth", "max_depth"), ("nsamples", "samples")] {
            if let Some(n) = node.int(from) {
                out.integers(to, [n.clamp(1, 1 << 20)]);
            }
        }
    }

    fn tints(&mut self, node: &Node, names: &[&str]) {
        let tinted = |x: &Self, name: &str| match x.x.source(node, name) {
            Some(Source::Plain(c)) => c.rgb() != [1.0; 3],
            Some(Source::Texture(_)) => true,
            None => false,
        };
        let names: Vec<&str> = names.iter().copied().filter(|n| tinted(self, n)).collect();
        self.x.without(node, &names);
    }

    fn index(&mut self, out: &mut Directive, node: &Node, name: &str, default: f64) {
        self.x.without(node, &["abbe_number", "cauchy", "sellmeier"]);
        match self.x.source_or(node, name, default) {
            Source::Plain(c @ Colour::Curve(..)) => out.spectrum(name, &c),
            Source::Plain(c) => out.float(name, c.at_sodium_line()),
            Source::Texture(_) => {
                self.x.approximated(node, format!("a textured index of refraction becomes {default}"));
                out.float(name, default);
            }
        }
    }

    fn facets(&mut self, out: &mut Directive, node: &Node) {
        self.x.without(node, &FACETS);
        let values = ["alpha_u", "alpha_v"].map(|n| self.x.source_or(node, n, 0.0));
        let smooth = values.iter().all(|v| matches!(v, Source::Plain(c) if c.mean() == 0.0));
        if smooth {
            return;
        }
        let remap = node.bool("remap_roughness").unwrap_or(false);
        for (name, value) in ["uroughness", "vroughness"].into_iter().zip(&values) {
            self.put_float(out, name, value);
        }
        out.bool("remaproughness", remap);
        let distribution = node.string("distribution").unwrap_or("ggx");
        if distribution != "ggx" {
            self.x.approximated(node, format!("the distribution '{distribution}' of facets is replaced by 'ggx'"));
        }
        let default = if self.x.desc.format == Format::Mitsuba { "separable" } else { "height_correlated" };
        let shadowing = node.string("shadowing").unwrap_or(default);
        if shadowing != "height_correlated" {
            let what = format!("the masking and shadowing of facets is pbrt's 'height_correlated', not '{shadowing}'");
            self.x.approximated(node, what);
        }
    }

    fn conductor(&mut self, out: &mut Directive, node: &Node) {
        out.string("type", "conductor");
        if let Some(reflectance) = self.x.source(node, "reflectance") {
            self.put_spectrum(out, "reflectance", &reflectance);
        } else if node.get("eta").is_none() && node.get("k").is_none() {
            self.x.approximated(node, "a perfect mirror becomes a conductor that reflects as much straight on");
            let tint = self.x.source_or(node, "specular_reflectance", 1.0);
            self.put_spectrum(out, "reflectance", &tint);
        } else {
            self.spectra(out, node, &[("eta", 1.0), ("k", 0.0)]);
            self.tints(node, &["specular_reflectance"]);
        }
        self.facets(out, node);
    }

    /// Mitsuba's plastic as a coat that does not absorb.
    fn plastic(&mut self, out: &mut Directive, node: &Node) {
        self.x.approximated(node, "'plastic' becomes 'coateddiffuse' over a base that looks the same straight on");
        out.string("type", "coateddiffuse");
        let eta = if let Source::Plain(c) = self.x.source_or(node, "eta", 1.49) { c.at_sodium_line() } else { 1.49 };
        let from = Coat::plastic(eta, node.bool("nonlinear").unwrap_or(false));
        let to = Coat::layered(eta, THIN, DEEP);
        match self.x.source_or(node, "diffuse_reflectance", 0.5) {
            Source::Plain(c) => {
                let c = c.map(|rho| to.base_like(&from, rho.clamp(0.0, 1.0)));
                out.spectrum("reflectance", &c);
            }
            Source::Texture(id) => {
                let k = to.base_like(&from, 0.5) / 0.5;
                match self.texture(id, Values::Spectrum, [k; 3]) {
                    Ok(name) => out.texture("reflectance", &name),
                    Err(stand_in) => out.spectrum("reflectance", &stand_in.scaled(k)),
                }
            }
        }
        out.float("eta", eta);
        out.float("thickness", THIN);
        out.integers("maxdepth", [DEEP]);
        self.facets(out, node);
        self.tints(node, &["specular_reflectance"]);
    }

    /// Models of many layers as metal, glass, or a coated base, mixed where they are metal in part.
    fn layered(&mut self, out: &mut Directive, node: &Node) {
        self.x.approximated(node, format!("'{}' becomes a coated base, metal or glass, or a mix of them", node.kind));
        self.x.without(node, &["coat_normal_map", "anisotropy_direction"]);
        let openpbr = node.kind == "openpbr";
        let named = |a: &'static str, b: &'static str| if openpbr { b } else { a };
        let color = self.x.base_color_of(node);
        let base = self.x.source_or(node, color, if openpbr { 0.8 } else { 1.0 });
        let metallic = match self.x.source(node, named("metallic", "base_metalness")) {
            Some(s) => s,
            None => Source::Plain(Colour::Grey(if node.kind == "metallic_roughness" { 1.0 } else { 0.0 })),
        };
        let default = if node.kind == "metallic_roughness" { 1.0 } else { 0.5 };
        let rough = self.x.source_or(node, named("roughness", "specular_roughness"), default);
        let alpha = match &rough {
            Source::Plain(c) => Err(c.mean().powi(2)),
            Source::Texture(id) => self.squared(*id).map_err(|stand_in| stand_in.mean().powi(2)),
        };
        let trans = ["transmission", "transmission_weight", "spec_trans"];
        let transmits =
            trans.iter().any(|n| matches!(self.x.source(node, n), Some(Source::Plain(c)) if c.mean() > 0.5));
        let eta = match self.x.source_or(node, named("eta", "specular_ior"), 1.5) {
            Source::Plain(c) => c.at_sodium_line(),
            Source::Texture(_) => 1.5,
        };
        let glossy = |out: &mut Directive| {
            match &alpha {
                Ok(texture) => out.texture("roughness", texture),
                Err(alpha) => out.float("roughness", *alpha),
            }
            out.bool("remaproughness", false);
        };
        let metal = |w: &mut Self, out: &mut Directive| {
            out.string("type", "conductor");
            w.put_spectrum(out, "reflectance", &base);
            glossy(out);
        };
        let rest = |w: &mut Self, out: &mut Directive| {
            if transmits {
                out.string("type", "dielectric");
            } else {
                out.string("type", "coateddiffuse");
                w.put_spectrum(out, "reflectance", &base);
                out.float("thickness", THIN);
                out.integers("maxdepth", [DEEP]);
            }
            out.float("eta", eta.max(1.0001));
            glossy(out);
        };
        match &metallic {
            Source::Plain(c) if c.mean() >= 0.999 => metal(self, out),
            Source::Plain(c) if c.mean() <= 0.001 => rest(self, out),
            amount => {
                let names = ["rest", "metal"].map(|n| self.x.name(node.name.as_deref(), n));
                let mut first = Directive::new("MakeNamedMaterial", &[&names[0]]);
                rest(self, &mut first);
                self.put(&first);
                let mut second = Directive::new("MakeNamedMaterial", &[&names[1]]);
                metal(self, &mut second);
                self.put(&second);
                out.string("type", "mix");
                out.strings("materials", &names);
                self.put_float(out, "amount", amount);
            }
        }
    }

    /// The name of a medium, which is written before; none for those that pbrt lacks.
    pub(super) fn medium(&mut self, id: NodeId) -> Option<String> {
        if let Some(known) = self.media.get(&id) {
            return Some(known.clone());
        }
        let node = self.x.node(id);
        if node.kind != "homogeneous" {
            self.x.dropped(node, format!("medium '{}' cannot be expressed and is left out", node.kind));
            return None;
        }
        let plain = |x: &Self, name: &str, default: f64| match x.x.source_or(node, name, default) {
            Source::Plain(c) => c,
            Source::Texture(_) => Colour::Grey(default),
        };
        let (a, s) = if node.get("sigma_t").is_some() || node.get("albedo").is_some() {
            let (t, albedo) = (plain(self, "sigma_t", 1.0), plain(self, "albedo", 0.75));
            let s = t.with(&albedo, |t, albedo| t * albedo);
            (t.with(&s, |t, s| (t - s).max(0.0)), s)
        } else {
            (plain(self, "sigma_a", 1.0), plain(self, "sigma_s", 1.0))
        };
        let name = self.x.name(node.name.as_deref(), "medium");
        let mut out = Directive::new("MakeNamedMedium", &[&name]);
        out.string("type", "homogeneous");
        out.spectrum("sigma_a", &a);
        out.spectrum("sigma_s", &s);
        out.float("scale", node.float("scale").unwrap_or(1.0));
        let phase = match node.get("phase") {
            Some(&Value::Node(phase)) => Some(self.x.node(phase)),
            _ => None,
        };
        if let Some(phase) = phase.filter(|p| !matches!(p.kind.as_str(), "hg" | "isotropic")) {
            self.x.approximated(phase, format!("the phase function '{}' becomes Henyey–Greenstein's", phase.kind));
        }
        let g = phase.filter(|p| p.kind != "isotropic").and_then(|p| p.float("g")).or(node.float("g"));
        if let Some(g) = g.filter(|g| *g != 0.0) {
            out.float("g", g.clamp(-1.0, 1.0));
        }
        if let Some(Source::Plain(light)) = self.x.source(node, "Le") {
            out.emission("Le", &light);
            out.float("Lescale", node.float("Lescale").unwrap_or(1.0) * self.x.gain);
        }
        self.put(&out);
        self.media.insert(id, name.clone());
        Some(name)
    }
}
