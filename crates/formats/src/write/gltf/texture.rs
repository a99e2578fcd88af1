//! Pictures, samplers and texture transforms.

use super::{Json, Writer};
use crate::write::{
    colour::Colour,
    exchange::{Source, uv_map},
};
use serde_json::json;
use std::path::Path;
use steradian_image::{FileKind, WriteOptions, encode, open_regular, read_regular};
use steradian_math::{DVec3, Transform};
use steradian_scene::{Node, NodeId};

/// Largest picture that is copied.
const MOST_BYTES: u64 = 2 << 30;

/// A colour as glTF has it: a factor, times a picture, times the colour of vertices.
#[derive(Clone, Debug, Default)]
pub(super) struct Tinted {
    pub factor: [f64; 3],
    pub image: Option<NodeId>,
    pub vertices: bool,
}

/// A path as a reference in JSON.
pub(super) fn uri(path: &str) -> String {
    let plain = |b: u8| b.is_ascii_alphanumeric() || b"-_.~/".contains(&b);
    path.bytes().map(|b| if plain(b) { char::from(b).to_string() } else { format!("%{b:02X}") }).collect()
}

impl Writer<'_> {
    /// A parameter as a product; what is none is one colour, which is reported.
    pub(super) fn product(&mut self, source: &Source) -> Tinted {
        match source {
            Source::Plain(c) => Tinted { factor: c.rgb(), ..Tinted::default() },
            Source::Texture(id) => self.product_of(*id, 0),
        }
    }

    fn product_of(&mut self, id: NodeId, depth: usize) -> Tinted {
        let node = self.x.node(id);
        match node.kind.as_str() {
            "image" => Tinted { factor: [1.0; 3], image: Some(id), vertices: false },
            "mesh_attribute" if node.string("name") == Some("color") && node.string("domain") != Some("face") => {
                Tinted { factor: [node.float("scale").unwrap_or(1.0); 3], image: None, vertices: true }
            }
            "scale" if depth < 16 => {
                let parts = ["texture", "scale"].map(|n| self.x.source_or(node, n, 1.0));
                let [a, b] = parts.map(|p| match p {
                    Source::Plain(c) => Tinted { factor: c.rgb(), ..Tinted::default() },
                    Source::Texture(inner) => self.product_of(inner, depth + 1),
                });
                if a.image.is_some() && b.image.is_some() {
                    self.x.approximated(node, "of two pictures that are multiplied the first counts");
                }
                Tinted {
                    factor: [0, 1, 2].map(|i| a.factor[i] * b.factor[i]),
                    image: a.image.or(b.image),
                    vertices: a.vertices || b.vertices,
                }
            }
            _ => Tinted { factor: self.x.stand_in(id).rgb(), ..Tinted::default() },
        }
    }

    /// A texture reference to the colours of a picture.
    pub(super) fn colors(&mut self, id: NodeId) -> Option<Json> {
        let node = self.x.node(id);
        let plain = self.x.is_plain(node) && !node.bool("raw").unwrap_or(false) && self.is_web(node);
        self.reference(node, plain)
    }

    /// A texture reference to one channel of a picture of numbers, where the picture is so already.
    pub(super) fn channel(&mut self, source: &Source, channel: &str) -> Option<(f64, Json)> {
        let Source::Texture(id) = source else { return None };
        let (factor, id) = match self.x.node(*id) {
            n if n.kind == "scale" => match (self.x.source(n, "texture"), self.x.source(n, "scale")) {
                (Some(Source::Texture(inner)), Some(Source::Plain(Colour::Grey(k)))) => (k, inner),
                _ => return None,
            },
            _ => (1.0, *id),
        };
        let node = self.x.node(id);
        let fits = node.kind == "image"
            && node.bool("raw").unwrap_or(false)
            && node.string("channel") == Some(channel)
            && node.float("scale").unwrap_or(1.0) == 1.0
            && !node.bool("invert").unwrap_or(false)
            && self.is_web(node);
        if !fits {
            return None;
        }
        self.reference(node, true).map(|r| (factor, r))
    }

    /// A reference to a normal map.
    pub(super) fn numbers(&mut self, id: NodeId) -> Option<Json> {
        let node = self.x.node(id);
        let fits = node.kind == "image" && self.is_web(node) && node.float("scale").unwrap_or(1.0) == 1.0;
        if fits { self.reference(node, true) } else { None }
    }

    /// True if a picture is of a format allowed in glTF, by its first bytes.
    fn is_web(&self, node: &Node) -> bool {
        use std::io::Read;
        let Some(file) = node.path("file") else { return false };
        let mut head = [0; 4];
        match self.x.desc.embedded.get(file) {
            Some(bytes) => head.iter_mut().zip(bytes.iter()).for_each(|(h, b)| *h = *b),
            None => {
                let read = open_regular(file).and_then(|(mut f, _)| f.read_exact(&mut head));
                if read.is_err() {
                    return false;
                }
            }
        }
        head.starts_with(b"\x89PNG") || head.starts_with(b"\xff\xd8")
    }

    fn reference(&mut self, node: &Node, as_it_is: bool) -> Option<Json> {
        let image = if as_it_is { self.image(node)? } else { self.made(node)? };
        let sampler = self.sampler(node);
        let key = format!("texture {image} {sampler}");
        let texture = match self.known.get(&key) {
            Some(&known) => known,
            None => {
                let index = self.push("textures", json!({ "source": image, "sampler": sampler }));
                self.known.insert(key, index);
                index
            }
        };
        let mut out = json!({ "index": texture });
        let set = node.string("uv_set").and_then(|s| s.strip_prefix("uv")).and_then(|s| s.parse::<u32>().ok());
        if let Some(set) = set.filter(|s| *s > 0) {
            out["texCoord"] = json!(set);
        } else if node.string("mapping").unwrap_or("uv") != "uv" {
            let mapping = node.string("mapping").unwrap_or_default();
            self.x.approximated(node, format!("the texture mapping '{mapping}' is replaced by the mesh's coordinates"));
        }
        let mut map = uv_map(node);
        if node.string("origin").unwrap_or("bottom") != "top" {
            // v = 0 is the first row.
            map = Transform::translate(DVec3::Y) * Transform::scale(DVec3::new(1.0, -1.0, 1.0)) * map;
        }
        if map != Transform::IDENTITY {
            let m = &map.matrix;
            let (a, b, c, d) = (m.x_axis.x, m.y_axis.x, m.x_axis.y, m.y_axis.y);
            let size = a.hypot(c).max(1e-12);
            let (rotation, other) = ((-c).atan2(a), (a * d - b * c) / size);
            let (sin, cos) = rotation.sin_cos();
            if (b - sin * other).abs() + (d - cos * other).abs() > 1e-6 {
                self.x.approximated(node, "shear of texture coordinates is left out");
            }
            self.extensions.insert("KHR_texture_transform");
            out["extensions"] = json!({ "KHR_texture_transform": {
                "offset": [m.w_axis.x, m.w_axis.y], "rotation": rotation, "scale": [size, other] } });
        }
        Some(out)
    }

    fn sampler(&mut self, node: &Node) -> usize {
        let mut wrap = |name: &str| match node.string(name).unwrap_or("repeat") {
            "repeat" => 10497,
            "mirror" => 33648,
            "clamp" => 33071,
            other => {
                self.x.approximated(node, format!("beyond a picture's edge '{other}' is replaced by 'clamp'"));
                33071
            }
        };
        let (s, t) = (wrap("wrap_u"), wrap("wrap_v"));
        let (mag, min) = match node.string("filter").unwrap_or("bilinear") {
            "nearest" => (9728, 9728),
            "bilinear" => (9729, 9729),
            "trilinear" => (9729, 9987),
            other => {
                self.x.approximated(node, format!("the texture filter '{other}' is replaced by 'trilinear'"));
                (9729, 9987)
            }
        };
        let key = format!("sampler {s} {t} {mag} {min}");
        if let Some(&known) = self.known.get(&key) {
            return known;
        }
        let sampler = json!({ "wrapS": s, "wrapT": t, "magFilter": mag, "minFilter": min });
        let index = self.push("samplers", sampler);
        self.known.insert(key, index);
        index
    }

    /// The picture of a node as it is.
    fn image(&mut self, node: &Node) -> Option<usize> {
        let file = node.path("file")?;
        let key = format!("image {}", file.display());
        if let Some(&known) = self.known.get(&key) {
            return Some(known);
        }
        let image = if self.binary {
            let bytes = match self.x.desc.embedded.get(file) {
                Some(bytes) => bytes.to_vec(),
                None => match read_regular(file, MOST_BYTES) {
                    Ok(bytes) => bytes,
                    Err(e) => {
                        self.x.dropped(node, format!("'{}' cannot be read and is left out: {e}", file.display()));
                        return None;
                    }
                },
            };
            let mime = if bytes.starts_with(b"\x89PNG") { "image/png" } else { "image/jpeg" };
            json!({ "bufferView": self.buffer.view(&bytes, None), "mimeType": mime })
        } else {
            let mut name = self.x.beside.path(file);
            if name.starts_with("..") || Path::new(&name).is_absolute() {
                // What glTF names lies in the document's folder or below.
                let bytes = read_regular(file, MOST_BYTES).map_err(|e| {
                    self.x.dropped(node, format!("'{}' cannot be read and is left out: {e}", file.display()));
                });
                let last = file.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
                name = self.x.beside.add("pictures", &last, bytes.ok()?);
            }
            json!({ "uri": uri(&name) })
        };
        let index = self.push("images", image);
        self.known.insert(key, index);
        Some(index)
    }

    /// A picture made of what a node's means, as PNG.
    fn made(&mut self, node: &Node) -> Option<usize> {
        let key = format!("made {:?} {:?}", node.path("file"), node.params);
        if let Some(&known) = self.known.get(&key) {
            return Some(known);
        }
        let picture = self.x.developed(node, [1.0; 3])?;
        let exceeds = picture.channels().iter().any(|c| c.data.iter().any(|v| *v > 1.0));
        if exceeds {
            self.x.approximated(node, "pictures of glTF end at one; brighter texels are cut");
        }
        let bytes =
            encode(FileKind::Png, &picture, &WriteOptions { sixteen_bit: true, ..WriteOptions::default() }).ok()?;
        let image = if self.binary {
            json!({ "bufferView": self.buffer.view(&bytes, None), "mimeType": "image/png" })
        } else {
            json!({ "uri": uri(&self.x.beside.add("pictures", "made.png", bytes)) })
        };
        let index = self.push("images", image);
        self.known.insert(key, index);
        Some(index)
    }
}
