//! Compiling displaced meshes.

use super::Compiler;
use steradian_core::shape::displacement::{MAX_TRIANGLES, Vertex, displace};
use steradian_math::{Vec3, spectra::role::Role, transform::Affine};
use steradian_scene::{Mesh, Node};
use steradian_texture::{FloatTexture, SpectrumTexture, TextureContext};

impl Compiler<'_> {
    /// The mesh with its triangles split and its vertices moved by the shape's `displacement`: heights along the
    /// normal, or vectors whose components go along ∂p/∂u, across it, and along the normal. In units of object space.
    pub(super) fn displaced(&mut self, node: &Node, mesh: &Mesh, place: &Affine) -> Option<Mesh> {
        if let Err(e) = mesh.validate() {
            self.error(node.span, format!("malformed mesh: {e}"));
            return None;
        }
        let is_vector = self.bool(node, "displacement_vector");
        let scale = self.float(node, "displacement_scale");
        let middle = self.float(node, "displacement_middle");
        let length = self.if_positive(node, "edge_length");
        let pixels = self.if_positive(node, "edge_pixels");
        let height =
            if is_vector { FloatTexture::Constant(0.0) } else { self.float_texture_or(node, "displacement", 0.0) };
        let vector = match (is_vector, self.reference(node, "displacement")) {
            (true, Some(id)) => match self.texture(id, Role::Unbounded) {
                SpectrumTexture::Texture(id, _) => Some(id),
                SpectrumTexture::Constant(_) => None,
            },
            _ => None,
        };
        if is_vector && vector.is_none() {
            self.error(node.span, "a vector displacement needs a texture that varies");
            return None;
        }
        let eye = self.eye;
        self.depends_on_camera |= pixels.is_some();
        let textures = &self.textures;
        // How many times too long an edge is, in the world.
        let measure = |a: Vec3, b: Vec3| {
            let (a, b) = (place.point(a), place.point(b));
            let by_length = length.map_or(0.0, |l| (b - a).length() / l);
            let by_pixels = match (pixels, eye) {
                (Some(n), Some((eye, pixel))) => {
                    let distance = ((a + b) * 0.5 - eye).length().max((b - a).length() * 0.5);
                    (b - a).length() / (distance * pixel * n)
                }
                _ => 0.0,
            };
            by_length.max(by_pixels)
        };
        let offset = |v: &Vertex| {
            let at = TextureContext {
                n: place.normal(v.n).normalize_or_zero(),
                ..TextureContext::new(place.point(v.p), v.uv)
            };
            match vector {
                Some(id) => {
                    let d = (textures.rgb(id, &at) - middle) * scale;
                    v.t * d.x + v.n.cross(v.t) * d.y + v.n * d.z
                }
                None => v.n * ((height.eval(textures, &at) - middle) * scale),
            }
        };
        match displace(mesh, MAX_TRIANGLES, measure, offset) {
            Ok(mesh) => Some(mesh),
            Err(e) => {
                let span = node.param("edge_length").or(node.param("edge_pixels")).and_then(|p| p.span).or(node.span);
                self.error(span, e.to_string());
                None
            }
        }
    }
}
