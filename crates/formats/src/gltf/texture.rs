//! Textures: pictures, samplers, coordinates and their transforms.

use super::{Reader, container, json::At};
use std::path::PathBuf;
use steradian_scene::{Family, Node, NodeId, Value};

/// Contents of an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Holds {
    /// Colours, encoded as sRGB.
    Colors,
    /// Numbers as they stand, in one channel (`r` `g` `b` `a`) or, as `color`, all.
    Numbers(&'static str),
}

/// Extensions with a 'source' of their own.
const PACKED: [&str; 2] = ["EXT_texture_webp", "KHR_texture_basisu"];

impl Reader<'_> {
    /// The texture that the member `name` of `at` refers to; `None` where there is none, or where it cannot be had,
    /// which is reported.
    pub(super) fn texture(&mut self, root: &At<'_>, at: &At<'_>, name: &str, holds: Holds) -> Option<NodeId> {
        let info = at.get(name)?;
        let (_, texture) = self.index(root, &info, "index", "textures")?;
        // The plain picture, where there is one, was not packed a second time.
        let is_plain = texture.get("source").is_some();
        let packed = || PACKED.iter().find_map(|name| texture.extension(name));
        let holder = if is_plain { None } else { packed() }.unwrap_or_else(|| texture.clone());
        if holder.get("source").is_none() {
            self.dropped(&info, "this texture has no picture that can be read: the material goes without");
            return None;
        }
        let (number, image) = self.index(root, &holder, "source", "images")?;
        let file = self.image_file(root, number, &image)?;
        let mut node = Node::new(Family::Texture, "image", self.span(&info)).with("file", file).with("origin", "top");
        match holds {
            Holds::Colors => node.set("encoding", "srgb", None),
            Holds::Numbers(channel) => node.set("raw", true, None).set("channel", channel, None),
        };
        self.sampler(root, &texture, &mut node);
        let mut set = info.get("texCoord").and_then(|t| t.value.as_u64()).unwrap_or(0);
        if let Some(transform) = info.extension("KHR_texture_transform") {
            set = transform.get("texCoord").and_then(|t| t.value.as_u64()).unwrap_or(set);
            let offset = self.numbers(&transform, "offset", [0.0; 2]);
            let scale = self.numbers(&transform, "scale", [1.0; 2]);
            let rotation = self.number(&transform, "rotation", 0.0, (-1e6, 1e6)).to_degrees();
            node.set("khr_offset", offset.to_vec(), None).set("khr_scale", scale.to_vec(), None).set(
                "khr_rotation",
                rotation,
                None,
            );
        }
        if set > 0 {
            node.set("uv_set", format!("uv{set}"), None);
        }
        Some(self.import.desc.add(node))
    }

    fn sampler(&mut self, root: &At<'_>, texture: &At<'_>, node: &mut Node) {
        let sampler = texture.get("sampler").and_then(|_| self.index(root, texture, "sampler", "samplers"));
        let Some((_, sampler)) = sampler else { return };
        for (name, parameter) in [("wrapS", "wrap_u"), ("wrapT", "wrap_v")] {
            let Some(member) = sampler.get(name) else { continue };
            let wrap = match member.value.as_u64() {
                Some(10497) => "repeat",
                Some(33071) => "clamp",
                Some(33648) => "mirror",
                _ => {
                    self.error(&member, "a wrap mode is 10497 (repeat), 33071 (clamp) or 33648 (mirror)");
                    continue;
                }
            };
            node.set(parameter, wrap, None);
        }
        if sampler.get("magFilter").is_some_and(|f| f.value == 9728) {
            node.set("filter", "nearest", None);
        } else if sampler.get("minFilter").is_some_and(|f| f.value.as_u64().is_some_and(|v| (9984..=9987).contains(&v)))
        {
            node.set("filter", "trilinear", None);
        }
    }

    /// The path by which nodes name a picture; pictures inside the file get one of their own.
    fn image_file(&mut self, root: &At<'_>, number: usize, image: &At<'_>) -> Option<PathBuf> {
        let inside = PathBuf::from(format!("{}#/images/{number}", self.path.display()));
        if self.import.desc.embedded.contains_key(&inside) {
            return Some(inside);
        }
        if image.get("bufferView").is_some() {
            let (bytes, _) = self.buffer_view(root, image, "bufferView")?;
            self.import.desc.embedded.insert(inside.clone(), bytes.as_slice().into());
            return Some(inside);
        }
        let Some(text) = image.text("uri") else {
            self.error(image, "a picture needs a 'uri' or a 'bufferView'");
            return None;
        };
        match container::uri(text) {
            Ok(container::Uri::Data(bytes)) => {
                self.import.desc.embedded.insert(inside.clone(), bytes.into());
                Some(inside)
            }
            Ok(container::Uri::File(name)) => match self.search.find(&name) {
                Ok(path) => Some(path),
                Err(e) => {
                    self.approximated(image, format!("{e}: the material goes without"));
                    None
                }
            },
            Err(why) => {
                self.error(image, why);
                None
            }
        }
    }

    /// A texture times a number; the number where there is no texture.
    pub(super) fn scaled_number(&mut self, texture: Option<NodeId>, factor: f64) -> Value {
        match texture {
            None => Value::Float(factor),
            Some(id) if factor == 1.0 => Value::Node(id),
            Some(id) => {
                let node = Node::new(Family::Texture, "scale", None).with("texture", id).with("scale", factor);
                Value::Node(self.import.desc.add(node))
            }
        }
    }

    /// A texture times a colour (and times another texture); the colour where there is none.
    pub(super) fn tinted(&mut self, textures: &[Option<NodeId>], color: [f64; 3]) -> Value {
        let tint = steradian_scene::SpectrumValue::Rgb(color, steradian_scene::ColorSpace::Srgb);
        let mut product: Option<NodeId> = None;
        for id in textures.iter().flatten() {
            product = Some(match product {
                None => *id,
                Some(before) => {
                    let node = Node::new(Family::Texture, "scale", None).with("texture", before).with("scale", *id);
                    self.import.desc.add(node)
                }
            });
        }
        match product {
            None => Value::Spectrum(tint),
            Some(id) if color == [1.0; 3] => Value::Node(id),
            Some(id) => {
                let node = Node::new(Family::Texture, "scale", None).with("texture", id).with("scale", tint);
                Value::Node(self.import.desc.add(node))
            }
        }
    }
}
