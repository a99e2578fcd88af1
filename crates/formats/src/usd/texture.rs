//! Textures: UsdUVTexture, UsdTransform2d and UsdPrimvarReader.

use super::{
    Loss, Reader,
    look::{Output, rgb},
    stage::Prim,
};
use std::rc::Rc;
use steradian_math::{DMat4, DVec3, Transform};
use steradian_scene::{Family, Node, NodeId};

/// Longest chain of transforms of coordinates.
const MOST_TRANSFORMS: usize = 8;

/// Contents of a texture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Holds {
    Colors,
    Numbers,
    Normals,
}

/// Source of an input's value.
pub(super) enum Source {
    Texture(NodeId),
    /// Value of a texture without a picture.
    Color([f64; 3]),
}

impl Reader<'_> {
    /// The texture that an input is connected to; `None` where there is none, or where it is not read, which is told.
    pub(super) fn source(&mut self, shader: &Rc<Prim>, name: &str, holds: Holds) -> Option<Source> {
        let Output { shader: from, name: channel } = self.output(shader, &format!("inputs:{name}"))?;
        let id = self.word(&from, "info:id").unwrap_or_default();
        match id.as_str() {
            "UsdUVTexture" => self.picture(&from, &channel, holds),
            "UsdPrimvarReader_float3" | "UsdPrimvarReader_float" | "UsdPrimvarReader_vector" => {
                let name = self.input(&from, "varname")?.2.text()?.to_owned();
                if name != "displayColor" {
                    self.count(Loss::Dropped(format!("values of meshes called '{name}' are left out")), &from, None);
                    return None;
                }
                let node = Node::new(Family::Texture, "mesh_attribute", None).with("name", name);
                Some(Source::Texture(self.stage.import.desc.add(node.with("domain", "vertex"))))
            }
            _ => {
                self.count(
                    Loss::Dropped(format!("the shader '{id}' is not read: its input keeps its own value")),
                    &from,
                    None,
                );
                None
            }
        }
    }

    fn picture(&mut self, shader: &Rc<Prim>, channel: &str, holds: Holds) -> Option<Source> {
        let numbers = |reader: &mut Self, name: &str, default: [f64; 4]| {
            let value = reader.input(shader, name).and_then(|i| i.2.tuple::<4>());
            value.filter(|v| v.iter().all(|v| v.is_finite())).unwrap_or(default)
        };
        let (scale, bias) = (numbers(self, "scale", [1.0; 4]), numbers(self, "bias", [0.0; 4]));
        let fallback = numbers(self, "fallback", [0.0, 0.0, 0.0, 1.0]);
        let index = ["r", "g", "b", "a"].iter().position(|c| *c == channel);
        let (owner, attribute, _) = self.input(shader, "file")?;
        let file = match self.stage.asset(&owner, &attribute)? {
            Ok(file) => file,
            Err(why) => {
                let span = self.stage.span(&owner, Some(&attribute));
                self.stage.approximated(span, format!("{}: {why}: its fallback is used", shader.path));
                let number = index.and_then(|k| fallback.get(k)).copied();
                return Some(Source::Color(number.map_or([fallback[0], fallback[1], fallback[2]], |v| [v; 3])));
            }
        };
        let mut node = Node::new(Family::Texture, "image", self.stage.span(shader, None)).with("file", file);
        let space = self.input(shader, "sourceColorSpace").and_then(|i| i.2.text().map(str::to_owned));
        match space.as_deref() {
            Some("raw") => node.set("raw", true, None),
            Some("sRGB") if channel != "a" => node.set("encoding", "srgb", None),
            _ if holds == Holds::Normals || channel == "a" => node.set("raw", true, None),
            _ => &mut node,
        };
        if let (Some(_), true) = (index, holds != Holds::Normals) {
            node.set("channel", channel, None);
        }
        for (name, parameter) in [("wrapS", "wrap_u"), ("wrapT", "wrap_v")] {
            let wrap = self.input(shader, name).and_then(|i| i.2.text().map(str::to_owned));
            let wrap =
                wrap.as_deref().filter(|w| ["repeat", "clamp", "mirror", "black"].contains(w)).unwrap_or("repeat");
            node.set(parameter, wrap, None);
        }
        self.coordinates(shader, &mut node);
        let id = self.stage.import.desc.add(node);
        Some(Source::Texture(match holds {
            Holds::Normals => {
                let usual = (scale[0], scale[1], bias[0], bias[1]);
                if usual != (2.0, 2.0, -1.0, -1.0) && usual != (1.0, 1.0, 0.0, 0.0) {
                    self.count(
                        Loss::Approximated("scale and bias of a normal map are taken as 2 and -1".into()),
                        shader,
                        None,
                    );
                }
                id
            }
            _ => self.adjusted(shader, id, index, (scale, bias)),
        }))
    }

    /// A texture times `scale`, plus `bias`.
    fn adjusted(
        &mut self,
        shader: &Prim,
        id: NodeId,
        index: Option<usize>,
        (scale, bias): ([f64; 4], [f64; 4]),
    ) -> NodeId {
        let used = index.map_or(0..3, |k| k..k + 1);
        let of = |v: &[f64; 4]| v.get(used.clone()).unwrap_or_default().to_vec();
        let (scale, bias) = (of(&scale), of(&bias));
        let node = if bias.iter().any(|v| *v != 0.0) {
            let (Some(a), Some(s), true) = (bias.first(), scale.first(), index.is_some()) else {
                self.count(Loss::Dropped("the bias of a texture of colours is left out".into()), shader, None);
                return id;
            };
            Node::new(Family::Texture, "mix", None).with("a", *a).with("b", a + s).with("amount", id)
        } else if scale.iter().all(|v| *v == 1.0) {
            return id;
        } else {
            let scaled = Node::new(Family::Texture, "scale", None).with("texture", id);
            match scale.as_slice() {
                [r, g, b] => scaled.with("scale", rgb([*r, *g, *b])),
                other => scaled.with("scale", other.first().copied().unwrap_or(1.0)),
            }
        };
        self.stage.import.desc.add(node)
    }

    /// Placement of a picture on the surface: its mapping.
    fn coordinates(&mut self, shader: &Rc<Prim>, node: &mut Node) {
        let (mut shader, mut attribute) = (shader.clone(), "inputs:st");
        let mut matrix = DMat4::IDENTITY;
        for _ in 0..MOST_TRANSFORMS {
            let Some(Output { shader: from, .. }) = self.output(&shader, attribute) else { break };
            match self.word(&from, "info:id").as_deref() {
                Some("UsdTransform2d") => {
                    let pair = |reader: &mut Self, name: &str, default: f64| {
                        let value = reader.input(&from, name).and_then(|i| i.2.tuple::<2>());
                        let [x, y] = value.filter(|v| v.iter().all(|v| v.is_finite())).unwrap_or([default; 2]);
                        DVec3::new(x, y, default)
                    };
                    let (scale, shift) = (pair(self, "scale", 1.0), pair(self, "translation", 0.0));
                    let angle = self.input(&from, "rotation").and_then(|i| i.2.number()).filter(|v| v.is_finite());
                    let turn = DMat4::from_rotation_z(angle.unwrap_or(0.0).to_radians());
                    matrix *= DMat4::from_translation(shift) * turn * DMat4::from_scale(scale);
                    (shader, attribute) = (from, "inputs:in");
                }
                Some("UsdPrimvarReader_float2") => {
                    let name = self.input(&from, "varname").and_then(|i| i.2.text().map(str::to_owned));
                    if let Some(name) = name.filter(|name| name != "st") {
                        node.set("uv_set", name, None);
                    }
                    break;
                }
                other => {
                    let what =
                        format!("coordinates by '{}' are not read: those of the mesh are used", other.unwrap_or(""));
                    self.count(Loss::Approximated(what), &from, None);
                    break;
                }
            }
        }
        if matrix != DMat4::IDENTITY {
            node.set("to_uv", Transform { matrix }, None);
        }
    }
}
