//! Compiling textures and loading images.

use super::{Compiler, LoadedImage};
use crate::{
    color::{Color, Role},
    texture::{self, ImageTexture, Mapping, SpectrumTexture, Texture, image::Wrap, mapping::Projector},
};
use rayon::prelude::*;
use std::{collections::BTreeSet, path::Path, sync::Arc};
use steradian_image::{Encoding, TexelData, Texels};
use steradian_math::{Vec2, Vec3};
use steradian_scene::{Domain, Family, Node, NodeId, SpectrumValue, Value};

impl Compiler<'_> {
    /// Loads every image that a node names, each once, in parallel. Failures are reported where the image is used.
    pub(super) fn load_images(&mut self) {
        let wants_texels =
            |n: &&Node| matches!((n.family, n.kind.as_str()), (Family::Texture, "image") | (Family::Light, _));
        let paths: BTreeSet<&Path> =
            self.desc.nodes.iter().filter(wants_texels).filter_map(|n| n.path("file")).collect();
        let limits = self.options.image_limits;
        let load = |p: &&Path| {
            let texels = steradian_image::read_texels(p, &limits).map_err(|e| e.to_string());
            let image = texels.map(|mut texels| {
                let faults = blacken_non_finite(&mut texels);
                LoadedImage { texels: Arc::new(texels), faults }
            });
            (p.to_path_buf(), image)
        };
        self.images = paths.par_iter().map(load).collect();
    }

    /// The image a node names in its parameter `file`; a failure is reported.
    pub(super) fn image(&mut self, node: &Node) -> Option<Arc<Texels>> {
        let span = node.param("file").and_then(|p| p.span).or(node.span);
        match node.path("file").and_then(|p| self.images.get(p)).cloned() {
            Some(Ok(LoadedImage { texels, faults })) => {
                if faults > 0 {
                    let what = format!("{faults} values of this image are infinite or NaN; they count as black");
                    self.diagnostics.warn(&self.desc.sources, span, what);
                }
                Some(texels)
            }
            Some(Err(e)) => {
                self.error(span, e);
                None
            }
            None => {
                self.error(span, format!("{} '{}' needs a file", node.family.noun(), node.kind));
                None
            }
        }
    }

    /// Compiles a texture used in a role. `depth` counts the nesting.
    pub(super) fn texture(&mut self, id: NodeId, role: Role, depth: usize) -> SpectrumTexture {
        let node = self.node(id);
        let grey = SpectrumTexture::Constant(Color::constant(0.5));
        if depth > texture::MAX_DEPTH {
            self.error(node.span, format!("textures are nested more than {} deep", texture::MAX_DEPTH));
            return grey;
        }
        if node.family != Family::Texture {
            self.error(node.span, format!("a texture is needed here, but this is a {}", node.family.noun()));
            return grey;
        }
        // Constants depend on their role; other textures learn it when they are evaluated.
        if node.kind == "constant" {
            return match node.get("value") {
                Some(Value::Node(inner)) => self.texture(*inner, role, depth + 1),
                _ => self.spectrum(node, "value", role, SpectrumValue::Constant(1.0)),
            };
        }
        let compiled = match self.texture_ids.get(&id) {
            Some(&t) => Some(t),
            None => {
                if !self.open.insert(id) {
                    self.error(node.span, "this texture contains itself");
                    return grey;
                }
                let t = self.new_texture(node, role, depth).map(|t| self.add_texture(node, t));
                if let Some(t) = t {
                    self.texture_ids.insert(id, t);
                }
                self.open.remove(&id);
                t
            }
        };
        compiled.map_or(grey, |t| SpectrumTexture::Texture(t, role))
    }

    /// Adds a texture; one that takes too long to evaluate is an error.
    pub(super) fn add_texture(&mut self, node: &Node, texture: Texture) -> texture::TextureId {
        let id = self.textures.add(texture);
        let texture::Effort { lookups, depth } = self.textures.effort(id);
        if depth as usize > texture::MAX_DEPTH {
            self.error(node.span, format!("textures are nested more than {} deep", texture::MAX_DEPTH));
        } else if lookups > texture::MAX_LOOKUPS {
            let what = "to evaluate this takes more than";
            self.error(node.span, format!("{what} {} textures, counting shared ones each time", texture::MAX_LOOKUPS));
        }
        id
    }

    /// A part of a texture tree, as an index.
    fn part(&mut self, node: &Node, name: &str, role: Role, default: f64, depth: usize) -> texture::TextureId {
        let t = match node.get(name) {
            Some(Value::Node(id)) => self.texture(*id, role, depth + 1),
            _ => self.spectrum(node, name, role, SpectrumValue::Constant(default)),
        };
        match t {
            SpectrumTexture::Constant(c) => self.textures.add(Texture::Constant(c)),
            SpectrumTexture::Texture(id, _) => id,
        }
    }

    fn new_texture(&mut self, node: &Node, role: Role, depth: usize) -> Option<Texture> {
        Some(match node.kind.as_str() {
            "image" => {
                let texels = self.image(node)?;
                Texture::Image(Arc::new(self.image_texture(node, texels)))
            }
            "checkerboard" => Texture::Checkerboard {
                a: self.part(node, "a", role, 1.0, depth),
                b: self.part(node, "b", role, 0.0, depth),
                solid: self.int(node, "dimension") == Some(3),
                mapping: self.mapping(node),
            },
            "scale" => Texture::Scale(
                self.part(node, "texture", role, 1.0, depth),
                self.part(node, "scale", Role::Unbounded, 1.0, depth),
            ),
            "mix" => Texture::Mix(
                self.part(node, "a", role, 0.0, depth),
                self.part(node, "b", role, 1.0, depth),
                self.part(node, "amount", Role::Unbounded, 0.5, depth),
            ),
            "mesh_attribute" => Texture::MeshAttribute {
                name: self.word(node, "name").unwrap_or_default().into(),
                domain: self.choice(
                    node,
                    "domain",
                    None,
                    &[("vertex", Some(Domain::Vertex)), ("face", Some(Domain::Face))],
                ),
                scale: self.float(node, "scale", 1.0),
            },
            other => {
                self.approximated(node.span, format!("texture '{other}' is not implemented; a constant stands in"));
                // The mean of the parts where there are two, grey elsewhere.
                let pair = [("tex1", "tex2"), ("inside", "outside"), ("a", "b"), ("color0", "color1")]
                    .into_iter()
                    .find(|(a, b)| node.get(a).is_some() && node.get(b).is_some());
                match pair {
                    Some((a, b)) => {
                        let (a, b) = (self.part(node, a, role, 1.0, depth), self.part(node, b, role, 0.0, depth));
                        let half = self.textures.add(Texture::Constant(Color::constant(0.5)));
                        Texture::Mix(a, b, half)
                    }
                    None => Texture::Constant(Color::constant(0.5)),
                }
            }
        })
    }

    /// An image with the lookup parameters of a node.
    pub(super) fn image_texture(&mut self, node: &Node, texels: Arc<Texels>) -> ImageTexture {
        let wraps =
            [("repeat", Wrap::Repeat), ("mirror", Wrap::Mirror), ("clamp", Wrap::Clamp), ("black", Wrap::Black)];
        let filters = [("nearest", true), ("bilinear", false), ("trilinear", false), ("ewa", false)];
        if let Some(filter @ ("trilinear" | "ewa")) = node.string("filter") {
            let span = node.param("filter").and_then(|p| p.span).or(node.span);
            self.approximated(span, format!("texture filter '{filter}' is not implemented; 'bilinear' stands in"));
        }
        let raw = self.bool(node, "raw", false);
        let encoding = match node.get("encoding") {
            None => texels.encoding,
            Some(Value::String(s)) => match s.as_str() {
                "auto" => texels.encoding,
                "srgb" => Encoding::Srgb,
                "linear" => Encoding::Linear,
                other => {
                    self.error(
                        node.span,
                        format!("'{other}' is not an encoding; known are auto, srgb, linear, or a gamma"),
                    );
                    texels.encoding
                }
            },
            Some(_) => Encoding::Gamma(self.positive(node, "encoding", 2.2)),
        };
        let encoding = if raw { Encoding::Linear } else { encoding };
        let texels = if encoding == texels.encoding || matches!(texels.data, TexelData::U8(_)) {
            texels
        } else {
            Arc::new(Texels { encoding, ..(*texels).clone() })
        };
        ImageTexture {
            texels,
            decode: Box::new(encoding.table8()),
            wrap_u: self.choice(node, "wrap_u", Wrap::Repeat, &wraps),
            wrap_v: self.choice(node, "wrap_v", Wrap::Repeat, &wraps),
            nearest: self.choice(node, "filter", false, &filters),
            origin_bottom: self.choice(node, "origin", true, &[("bottom", true), ("top", false)]),
            scale: self.float(node, "scale", 1.0),
            invert: self.bool(node, "invert", false),
            mapping: self.mapping(node),
        }
    }

    fn mapping(&mut self, node: &Node) -> Mapping {
        let local = self.transform(node, "texture_from_world").affine().unwrap_or_else(|| {
            self.error(node.span, "the texture's transform is singular or not finite");
            steradian_math::transform::Affine::IDENTITY
        });
        let (v1, v2) = (self.vec3(node, "v1", Vec3::X), self.vec3(node, "v2", Vec3::Y));
        let kind = self.choice(node, "mapping", 0, &[("uv", 0), ("spherical", 1), ("cylindrical", 2), ("planar", 3)]);
        let projector = match kind {
            1 => Projector::Spherical(local),
            2 => Projector::Cylindrical(local),
            3 => Projector::Planar(local, v1, v2),
            // Solid textures need the transform alone.
            _ if self.int(node, "dimension") == Some(3) => Projector::Planar(local, v1, v2),
            _ => Projector::Uv,
        };
        let to_uv = self.transform(node, "to_uv");
        let at = |x: f64, y: f64| {
            let p = to_uv.point(steradian_math::DVec3::new(x, y, 0.0));
            Vec2::new(p.x as f32, p.y as f32)
        };
        let origin = at(0.0, 0.0);
        let matrix = [at(1.0, 0.0) - origin, at(0.0, 1.0) - origin, origin];
        let matrix = if matrix.iter().all(|m| m.is_finite()) {
            matrix
        } else {
            self.error(node.span, "the transform of texture coordinates is not finite");
            [Vec2::X, Vec2::Y, Vec2::ZERO]
        };
        Mapping {
            projector,
            scale: Vec2::new(self.float(node, "scale_u", 1.0), self.float(node, "scale_v", 1.0)),
            delta: Vec2::new(self.float(node, "delta_u", 0.0), self.float(node, "delta_v", 0.0)),
            matrix,
        }
    }
}

/// Infinite and NaN values become black; gives how many there were.
fn blacken_non_finite(texels: &mut Texels) -> usize {
    let mut faults = 0;
    match &mut texels.data {
        TexelData::F32(data) => data.iter_mut().filter(|v| !v.is_finite()).for_each(|v| {
            *v = 0.0;
            faults += 1;
        }),
        TexelData::F16(data) => data.iter_mut().filter(|v| !v.is_finite()).for_each(|v| {
            *v = Default::default();
            faults += 1;
        }),
        TexelData::U8(_) | TexelData::U16(_) => {}
    }
    faults
}
