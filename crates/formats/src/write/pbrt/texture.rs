//! Textures, by name before what uses them.

use super::{Directive, Writer, place};
use crate::write::{
    colour::Colour,
    exchange::{Source, uv_map},
    picture::is_byte_file,
};
use steradian_math::{DVec3, Transform};
use steradian_scene::{Node, NodeId, Value};

/// Type of a texture's values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Values {
    Float,
    Spectrum,
}

impl Writer<'_> {
    /// Puts a spectrum that may be textured into a directive.
    pub(super) fn put_spectrum(&mut self, out: &mut Directive, name: &str, source: &Source) {
        match source {
            Source::Plain(c) => out.spectrum(name, c),
            Source::Texture(id) => match self.texture(*id, Values::Spectrum, [1.0; 3]) {
                Ok(texture) => out.texture(name, &texture),
                Err(stand_in) => out.spectrum(name, &stand_in),
            },
        }
    }

    /// Puts a number that may be textured into a directive.
    pub(super) fn put_float(&mut self, out: &mut Directive, name: &str, source: &Source) {
        match source {
            Source::Plain(c) => out.float(name, c.mean()),
            Source::Texture(id) => match self.texture(*id, Values::Float, [1.0; 3]) {
                Ok(texture) => out.texture(name, &texture),
                Err(stand_in) => out.float(name, stand_in.mean()),
            },
        }
    }

    /// The name of a texture's square, as roughness becomes the width of facets; where pbrt has none like it, what
    /// stands for it.
    pub(super) fn squared(&mut self, id: NodeId) -> Result<String, Colour> {
        let inner = self.texture(id, Values::Float, [1.0; 3])?;
        let key = format!("{inner} squared");
        if let Some(known) = self.textures.get(&key) {
            return Ok(known.clone());
        }
        let name = self.x.name(Some(&format!("{inner}-squared")), "texture");
        let mut out = Directive::new("Texture", &[&name, "float", "scale"]);
        out.texture("tex", &inner);
        out.texture("scale", &inner);
        self.put(&out);
        self.textures.insert(key, name.clone());
        Ok(name)
    }

    /// The name of a texture times a factor; where pbrt has none like it, what stands for it.
    pub(super) fn texture(&mut self, id: NodeId, values: Values, factor: [f64; 3]) -> Result<String, Colour> {
        let key = format!("{id:?} {values:?} {factor:?}");
        if let Some(known) = self.textures.get(&key) {
            return Ok(known.clone());
        }
        let node = self.x.node(id);
        let (class, is_solid) = match node.kind.as_str() {
            "image" => ("imagemap", false),
            "direction_mix" => ("directionmix", true),
            "fbm" | "wrinkled" | "windy" if values == Values::Float && is_plain_noise(node) => {
                (node.kind.as_str(), true)
            }
            "marble" if values == Values::Spectrum && is_plain_noise(node) => ("marble", true),
            "checkerboard" => ("checkerboard", node.int("dimension") == Some(3)),
            "scale" | "mix" | "bilerp" => (node.kind.as_str(), false),
            "dots" => ("dots", false),
            _ => return Err(self.x.stand_in(id)),
        };
        if class != "imagemap" && factor != [1.0; 3] {
            return Err(self.x.stand_in(id));
        }
        let kind = if values == Values::Float { "float" } else { "spectrum" };
        let stem = node.path("file").and_then(|file| file.file_stem()?.to_str());
        let name = self.x.name(node.name.as_deref().or(stem), "texture");
        let mut out = Directive::new("Texture", &[&name, kind, class]);
        match class {
            "imagemap" => self.image(&mut out, node, values, factor)?,
            "checkerboard" => {
                self.operands(&mut out, node, values, [("tex1", "a", 1.0), ("tex2", "b", 0.0)]);
                out.integers("dimension", [node.int("dimension").unwrap_or(2)]);
            }
            "mix" => {
                self.operands(&mut out, node, values, [("tex1", "a", 0.0), ("tex2", "b", 1.0)]);
                let amount = self.x.source_or(node, "amount", 0.5);
                self.put_float(&mut out, "amount", &amount);
            }
            "directionmix" => {
                self.operands(&mut out, node, values, [("tex1", "a", 0.0), ("tex2", "b", 1.0)]);
                if let Some(Value::Vec3(dir)) = node.get("dir") {
                    out.floats("vector3", "dir", *dir);
                }
            }
            "dots" => self.operands(&mut out, node, values, [("outside", "a", 0.0), ("inside", "b", 1.0)]),
            "bilerp" => {
                for (corner, default) in [("v00", 0.0), ("v01", 1.0), ("v10", 0.0), ("v11", 1.0)] {
                    let source = self.x.source_or(node, corner, default);
                    let c = match source {
                        Source::Plain(c) => c,
                        Source::Texture(inner) => self.x.stand_in(inner),
                    };
                    self.put_value(&mut out, corner, &Source::Plain(c), values);
                }
            }
            "scale" => match (self.x.source_or(node, "texture", 1.0), self.x.source_or(node, "scale", 1.0)) {
                // pbrt's factor is a number at each point.
                (Source::Texture(inner), Source::Plain(c @ (Colour::Rgb(_) | Colour::Curve(..)))) => {
                    return self.texture(inner, values, c.rgb());
                }
                (inner, scale) => {
                    self.put_value(&mut out, "tex", &inner, values);
                    self.put_float(&mut out, "scale", &scale);
                }
            },
            "windy" => {}
            _ => {
                if class != "windy" {
                    out.integers("octaves", [node.int("octaves").unwrap_or(8)]);
                    out.float("roughness", node.float("roughness").unwrap_or(0.5));
                }
                if class == "marble" {
                    out.float("scale", node.float("scale").unwrap_or(1.0));
                    out.float("variation", node.float("variation").unwrap_or(0.2));
                }
            }
        }
        let at = if is_solid { place(node, "texture_from_world") } else { self.mapping(&mut out, node, class) };
        let Some(at) = at.inverse() else { return Err(self.x.stand_in(id)) };
        if at == Transform::IDENTITY {
            self.put(&out);
        } else {
            self.line("AttributeBegin");
            self.depth += 1;
            self.transform(&at);
            self.put(&out);
            self.depth -= 1;
            self.line("AttributeEnd");
        }
        self.textures.insert(key, name.clone());
        Ok(name)
    }

    fn put_value(&mut self, out: &mut Directive, name: &str, source: &Source, values: Values) {
        match values {
            Values::Float => self.put_float(out, name, source),
            Values::Spectrum => self.put_spectrum(out, name, source),
        }
    }

    fn operands(&mut self, out: &mut Directive, node: &Node, values: Values, names: [(&str, &str, f64); 2]) {
        for (to, from, default) in names {
            let source = self.x.source_or(node, from, default);
            self.put_value(out, to, &source, values);
        }
    }

    fn image(&mut self, out: &mut Directive, node: &Node, values: Values, factor: [f64; 3]) -> Result<(), Colour> {
        let Some(file) = node.path("file") else { return Err(Colour::Grey(0.5)) };
        let png = file.extension().is_some_and(|e| e.eq_ignore_ascii_case("png"));
        let raw = node.bool("raw").unwrap_or(false);
        // pbrt decodes bytes as sRGB unless a PNG is said to be otherwise, and takes colours and means.
        let encoding = match node.get("encoding") {
            _ if !is_byte_file(node) => Some(None),
            _ if raw => png.then(|| Some("linear".to_owned())),
            None => Some(None),
            Some(Value::String(word)) if word == "auto" || word == "srgb" => Some(None),
            Some(Value::String(word)) if word == "linear" => png.then(|| Some("linear".to_owned())),
            Some(Value::Float(gamma)) => png.then(|| Some(format!("gamma {gamma}"))),
            Some(_) => None,
        };
        let scale = node.float("scale").unwrap_or(1.0);
        let even = factor[0] == factor[1] && factor[1] == factor[2];
        let invert = node.bool("invert").unwrap_or(false);
        let is_color = node.string("channel").unwrap_or("color") == "color";
        let known = file.extension().is_some_and(|e| {
            ["png", "exr", "pfm", "hdr", "jpg", "jpeg", "tga", "bmp"].iter().any(|k| e.eq_ignore_ascii_case(k))
        });
        match encoding {
            Some(encoding) if is_color && known && even && (!invert || factor == [1.0; 3]) => {
                let name = self.x.beside.path(file);
                out.string("filename", &name);
                if let Some(encoding) = encoding {
                    out.string("encoding", &encoding);
                }
                if scale * factor[0] != 1.0 {
                    out.float("scale", scale * factor[0]);
                }
                if invert {
                    out.bool("invert", true);
                }
            }
            _ => {
                let Some(name) = self.x.baked(node, factor) else { return Err(Colour::Grey(0.5)) };
                out.string("filename", &name);
            }
        }
        let filter = match node.string("filter").unwrap_or("bilinear") {
            "nearest" => "point",
            known @ ("bilinear" | "trilinear") => known,
            "ewa" => {
                if let Some(most) = node.float("max_anisotropy") {
                    out.float("maxanisotropy", most);
                }
                "ewa"
            }
            other => {
                self.x.approximated(node, format!("the texture filter '{other}' is replaced by 'bilinear'"));
                "bilinear"
            }
        };
        out.string("filter", filter);
        let wraps = ["wrap_u", "wrap_v"].map(|n| node.string(n).unwrap_or("repeat"));
        let wrap = match wraps[0] {
            known @ ("repeat" | "clamp" | "black") => known,
            "octahedral" => "octahedralsphere",
            _ => "clamp",
        };
        if wraps[0] != wraps[1] || (wrap == "clamp" && wraps[0] != "clamp") {
            let what = format!("pbrt wraps both axes alike: '{wrap}' stands for '{}' and '{}'", wraps[0], wraps[1]);
            self.x.approximated(node, what);
        }
        out.string("wrap", wrap);
        let _ = values;
        Ok(())
    }

    /// Writes the mapping of a two-dimensional texture; returns the transform into its space.
    fn mapping(&mut self, out: &mut Directive, node: &Node, class: &str) -> Transform {
        let number = |name: &str, default: f64| node.float(name).unwrap_or(default);
        let mapping = node.string("mapping").unwrap_or("uv");
        match mapping {
            "spherical" | "cylindrical" => {
                out.string("mapping", mapping);
                return place(node, "texture_from_world");
            }
            "planar" => {
                out.string("mapping", mapping);
                for name in ["v1", "v2"] {
                    if let Some(Value::Vec3(v)) = node.get(name) {
                        out.floats("vector3", name, *v);
                    }
                }
                out.float("udelta", number("delta_u", 0.0));
                out.float("vdelta", number("delta_v", 0.0));
                return place(node, "texture_from_world");
            }
            "uv" if node.get("uv_set").is_none() => {}
            other => {
                self.x
                    .approximated(node, format!("the texture mapping '{other}' is replaced by the mesh's coordinates"));
            }
        }
        if class == "mix" || class == "scale" {
            return Transform::IDENTITY;
        }
        let mut map = uv_map(node);
        if class == "imagemap" && node.string("origin") == Some("top") {
            // pbrt's v = 0 is the last row.
            map = Transform::translate(DVec3::Y) * Transform::scale(DVec3::new(1.0, -1.0, 1.0)) * map;
        }
        let m = &map.matrix;
        if m.x_axis.y.abs() > 1e-9 || m.y_axis.x.abs() > 1e-9 {
            self.x.approximated(node, "pbrt scales and moves texture coordinates only; their rotation is left out");
        }
        for (name, value, default) in [
            ("uscale", m.x_axis.x, 1.0),
            ("vscale", m.y_axis.y, 1.0),
            ("udelta", m.w_axis.x, 0.0),
            ("vdelta", m.w_axis.y, 0.0),
        ] {
            if value != default {
                out.float(name, value);
            }
        }
        Transform::IDENTITY
    }
}

/// True if a noise has only parameters that pbrt has.
fn is_plain_noise(node: &Node) -> bool {
    node.params
        .iter()
        .all(|p| matches!(p.name.as_str(), "octaves" | "roughness" | "texture_from_world" | "scale" | "variation"))
}
