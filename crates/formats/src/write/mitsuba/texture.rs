//! Textures.

use super::{Element, Role, Writer, matrix};
use crate::write::{
    colour::Colour,
    exchange::{Source, uv_map},
    picture::is_byte_file,
};
use steradian_math::{DVec3, Transform};
use steradian_scene::{Node, NodeId};

impl Writer<'_> {
    /// A texture times a number; where Mitsuba has none like it, what stands for it.
    pub(super) fn texture(&mut self, name: &str, id: NodeId, role: Role, scale: f64) -> Result<Element, Colour> {
        let node = self.x.node(id);
        if self.no_texture {
            self.x.approximated(node, "textures on a disk are laid out differently; one colour stands for this one");
            return Err(Colour::Grey(0.5));
        }
        match node.kind.as_str() {
            "image" => self.image(name, node, role, [scale; 3]),
            "scale" => match (self.x.source(node, "texture"), self.x.source(node, "scale")) {
                (Some(Source::Texture(inner)), Some(Source::Plain(k))) if self.x.node(inner).kind == "image" => {
                    self.image(name, self.x.node(inner), role, k.scaled(scale).rgb())
                }
                (Some(Source::Texture(inner)), Some(Source::Plain(Colour::Grey(k)))) => {
                    self.texture(name, inner, role, k * scale)
                }
                _ => Err(self.x.stand_in(id)),
            },
            "checkerboard" if node.int("dimension").unwrap_or(2) == 2 && is_over_uv(node) => {
                let mut out = Element::plugin("texture", "checkerboard").named(name);
                // Evaluated as single numbers, Mitsuba's cells are the other way round.
                let (even, odd) = if role == Role::Scalar { ("b", "a") } else { ("a", "b") };
                for (to, from) in [("color0", even), ("color1", odd)] {
                    let source = self.x.source_or(node, from, if from == "a" { 1.0 } else { 0.0 });
                    // Within the board numbers are colours.
                    let role = if role == Role::Scalar { Role::Reflectance } else { role };
                    self.put_scaled(&mut out, to, &source, role, scale);
                }
                let half = Transform::scale(DVec3::new(0.5, 0.5, 1.0));
                out.push(matrix("to_uv", &(half * uv_map(node))));
                Ok(out)
            }
            "mesh_attribute" => {
                let mut out = Element::plugin("texture", "mesh_attribute").named(name);
                let (attribute, domain) = (node.string("name"), node.string("domain"));
                out.string("name", &format!("{}_{}", domain.unwrap_or("vertex"), attribute.unwrap_or_default()));
                out.float("scale", node.float("scale").unwrap_or(1.0) * scale);
                Ok(out)
            }
            _ => Err(self.x.stand_in(id)),
        }
    }

    /// A picture; where Mitsuba cannot use it as it is, a picture made of it.
    fn image(&mut self, name: &str, node: &Node, role: Role, factor: [f64; 3]) -> Result<Element, Colour> {
        let Some(file) = node.path("file") else { return Err(Colour::Grey(0.5)) };
        if !is_over_uv(node) {
            let mapping = node.string("mapping").unwrap_or("uv");
            self.x.approximated(node, format!("the texture mapping '{mapping}' is replaced by the mesh's coordinates"));
        }
        let even = factor[0] == factor[1] && factor[1] == factor[2];
        let mut out = Element::plugin("texture", "bitmap").named(name);
        let linear = node.string("encoding") == Some("linear") && is_byte_file(node);
        let mut scale = 1.0;
        if self.x.is_plain(node) && (factor == [1.0; 3] || (even && role == Role::Emission)) {
            let file = self.x.beside.path(file);
            out.string("filename", &file);
            // Numbers rather than colours; single numbers have no colour to decode but a curve.
            out.boolean("raw", node.bool("raw").unwrap_or(false) || (linear && role != Role::Emission));
            scale = factor[0];
        } else {
            let Some(file) = self.x.baked(node, factor) else { return Err(Colour::Grey(0.5)) };
            out.string("filename", &file);
            out.boolean("raw", node.bool("raw").unwrap_or(false));
        }
        let filter = node.string("filter").unwrap_or("bilinear");
        if filter == "nearest" {
            out.string("filter_type", "nearest");
        } else if filter != "bilinear" {
            self.x.approximated(node, format!("the texture filter '{filter}' is replaced by 'bilinear'"));
        }
        let wraps = ["wrap_u", "wrap_v"].map(|n| node.string(n).unwrap_or("repeat"));
        let wrap = match wraps[0] {
            known @ ("repeat" | "mirror" | "clamp") => known,
            _ => "clamp",
        };
        if wrap != wraps[0] || wraps[0] != wraps[1] {
            let what = format!("Mitsuba wraps both axes alike: '{wrap}' stands for '{}' and '{}'", wraps[0], wraps[1]);
            self.x.approximated(node, what);
        }
        if wrap != "repeat" {
            out.string("wrap_mode", wrap);
        }
        let mut to_uv = uv_map(node);
        if node.string("origin").unwrap_or("bottom") != "top" {
            // Mitsuba's v = 0 is the first row.
            to_uv = Transform::translate(DVec3::Y) * Transform::scale(DVec3::new(1.0, -1.0, 1.0)) * to_uv;
        }
        if to_uv != Transform::IDENTITY {
            out.push(matrix("to_uv", &to_uv));
        }
        if scale == 1.0 {
            return Ok(out);
        }
        let mut lit = Element::plugin("spectrum", "d65").named(name);
        lit.push(out.renamed("nested"));
        lit.float("scale", scale);
        Ok(lit)
    }
}

/// True if a texture is looked up by the mesh's own coordinates.
pub(super) fn is_over_uv(node: &Node) -> bool {
    node.string("mapping").unwrap_or("uv") == "uv" && node.get("uv_set").is_none()
}
