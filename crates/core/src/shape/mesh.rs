//! Triangle meshes in world (or group) space.

use super::SurfacePoint;
use rayon::prelude::*;
use steradian_math::{
    Spectrum, Vec2, Vec3, Vec4,
    color::{
        space::REC709,
        upsample::{RgbAlbedo, RgbSigmoid},
    },
    ray::gamma,
    spectra::Wavelengths,
    transform::Affine,
};
use steradian_scene::{Mesh, Shared};
use steradian_texture::{Domain, MeshAttributes};

/// Data on a mesh, such as colours.
#[derive(Clone, Debug)]
pub struct MeshAttribute {
    /// Name without a domain prefix.
    pub name: String,
    /// Domain of the values: one per element of it.
    pub domain: Domain,
    /// Numbers per value.
    pub channels: usize,
    /// The numbers.
    pub data: Vec<f32>,
    /// The reflectances of values that are colours in [0, 1], where these are asked for at wavelengths; else empty.
    pub spectra: Vec<RgbAlbedo>,
}

/// Up to so many colours are solved for one by one, which is less work than the table in which more are looked up.
const MOST_SOLVED: usize = 200_000;

impl MeshAttribute {
    /// Makes the spectra of its colours: between vertices they are then interpolated, rather than made anew at every
    /// point. To make one takes solving for its coefficients, of which points between vertices would need any number.
    pub fn upsample(&mut self) {
        if self.channels >= 3 && self.data.iter().all(|v| (0.0..=1.0).contains(v)) {
            let few = self.data.len() / self.channels <= MOST_SOLVED;
            let color = |c: &[f32]| match few {
                true => RgbAlbedo(RgbSigmoid::solved(&REC709, Vec3::from_slice(c))),
                false => RgbAlbedo::new(&REC709, Vec3::from_slice(c)),
            };
            self.spectra = self.data.par_chunks_exact(self.channels).map(color).collect();
        }
    }
}

/// A triangle mesh placed in the space it is traced in.
#[derive(Clone, Debug, Default)]
pub struct TriMesh {
    /// Vertex positions.
    pub positions: Vec<Vec3>,
    /// Unit vertex normals: none or one per vertex.
    pub normals: Vec<Vec3>,
    /// Texture coordinates: none or one per vertex.
    pub uvs: Vec<Vec2>,
    /// Vertex indices.
    pub triangles: Shared<[u32; 3]>,
    /// Further data.
    pub attributes: Vec<MeshAttribute>,
    /// Tangents of normal maps at the corners of triangles, with the sign of the bitangent: none, or one for each
    /// triangle.
    pub tangents: Vec<[Vec4; 3]>,
    /// True if geometric normals point against the winding (only without vertex normals to follow).
    pub flip: bool,
}

impl TriMesh {
    /// The side from which the corners of a triangle are counter-clockwise in the space of the file, by a normal that
    /// has not unit length.
    #[inline]
    pub fn front(&self, triangle: u32) -> Vec3 {
        let [p0, p1, p2] = self.corners(triangle);
        let n = (p1 - p0).cross(p2 - p0);
        if self.flip { -n } else { n }
    }

    /// Places a mesh. `reverse` turns normals over; vertex normals are left out where `flat` is set.
    pub fn new(mesh: &Mesh, place: &Affine, swaps_handedness: bool, reverse: bool, flat: bool) -> Self {
        let sign = if reverse { -1.0 } else { 1.0 };
        let normals = if flat { &[][..] } else { &mesh.normals[..] };
        Self {
            positions: mesh.positions.iter().map(|&p| place.point(Vec3::from(p))).collect(),
            normals: normals.iter().map(|&n| (place.normal(Vec3::from(n)) * sign).normalize_or_zero()).collect(),
            uvs: mesh.uvs.iter().map(|&uv| Vec2::from(uv)).collect(),
            triangles: mesh.triangles.clone(),
            attributes: mesh
                .attributes
                .iter()
                .map(|a| MeshAttribute {
                    name: a.name.clone(),
                    domain: match a.domain {
                        steradian_scene::Domain::Vertex => Domain::Vertex,
                        steradian_scene::Domain::Face => Domain::Face,
                    },
                    channels: a.channels,
                    data: a.data.iter().map(|v| if v.is_finite() { *v } else { 0.0 }).collect(),
                    spectra: Vec::new(),
                })
                .collect(),
            tangents: Vec::new(),
            flip: reverse ^ swaps_handedness,
        }
    }

    /// The corners of a triangle.
    #[inline]
    pub fn corners(&self, triangle: u32) -> [Vec3; 3] {
        self.triangles[triangle as usize].map(|i| self.positions[i as usize])
    }

    /// Unit geometric normal of a triangle, oriented: to the side of the vertex normals where there are any, by winding
    /// elsewhere. Zero for a degenerate triangle.
    pub fn geometric_normal(&self, triangle: u32) -> Vec3 {
        let [p0, p1, p2] = self.corners(triangle);
        let n = face_normal([p0, p1, p2]);
        if self.normals.is_empty() {
            return if self.flip { -n } else { n };
        }
        let sum: Vec3 = self.triangles[triangle as usize].iter().map(|&i| self.normals[i as usize]).sum();
        if sum.dot(n) < 0.0 { -n } else { n }
    }

    /// The surface at barycentric coordinates `(1 − u − v, u, v)` of a triangle.
    #[inline]
    pub fn surface(&self, triangle: u32, u: f32, v: f32) -> SurfacePoint {
        let uvs = match self.uvs.is_empty() {
            true => [Vec2::ZERO, Vec2::X, Vec2::ONE],
            false => self.triangles[triangle as usize].map(|i| self.uvs[i as usize]),
        };
        let uv = uvs[0] * (1.0 - u - v) + uvs[1] * u + uvs[2] * v;
        SurfacePoint { dpdu: tangent(self.corners(triangle), uvs), uv, ..self.bare(triangle, u, v) }
    }

    /// The surface at barycentric coordinates `(1 − u − v, u, v)` of a triangle, without its parametrisation.
    #[inline]
    pub fn bare(&self, triangle: u32, u: f32, v: f32) -> SurfacePoint {
        let index = self.triangles[triangle as usize];
        let corners = index.map(|i| self.positions[i as usize]);
        let is_smooth = !self.normals.is_empty();
        let normals = if is_smooth { index.map(|i| self.normals[i as usize]) } else { [Vec3::ZERO; 3] };
        on_triangle(corners, normals, (is_smooth, self.flip), (u, v), face_normal(corners))
    }

    /// Texture coordinates at barycentric coordinates of a triangle.
    #[inline]
    pub fn uv(&self, triangle: u32, u: f32, v: f32) -> Vec2 {
        let w = 1.0 - u - v;
        if self.uvs.is_empty() {
            return Vec2::X * u + Vec2::ONE * v;
        }
        let [a, b, c] = self.triangles[triangle as usize].map(|i| self.uvs[i as usize]);
        a * w + b * u + c * v
    }

    /// ∂p/∂v of a triangle; zero where the parametrisation is degenerate.
    pub fn dpdv(&self, triangle: u32) -> Vec3 {
        let uvs = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)].map(|(u, v)| self.uv(triangle, u, v));
        // The same with the roles of u and v exchanged.
        tangent(self.corners(triangle), uvs.map(|t| Vec2::new(t.y, t.x)))
    }

    /// The tangent for normal maps at barycentric coordinates of a triangle, and the sign of the bitangent `n × t`.
    pub fn tangent_frame(&self, triangle: u32, b: Vec2) -> Option<(Vec3, f32)> {
        let [x, y, z] = self.tangents.get(triangle as usize)?;
        Some(((*x * (1.0 - b.x - b.y) + *y * b.x + *z * b.y).truncate(), x.w))
    }

    /// Change of the interpolated vertex normal for a displacement in the plane of a triangle; zero without vertex
    /// normals.
    pub fn normal_change(&self, triangle: u32, dp: Vec3) -> Vec3 {
        let index = self.triangles[triangle as usize];
        let [p0, p1, p2] = index.map(|i| self.positions[i as usize]);
        let (a, b) = (p1 - p0, p2 - p0);
        let (aa, ab, bb) = (a.dot(a), a.dot(b), b.dot(b));
        let det = aa * bb - ab * ab;
        if self.normals.is_empty() || det <= 0.0 {
            return Vec3::ZERO;
        }
        let (da, db) = (a.dot(dp), b.dot(dp));
        let (u, v) = ((bb * da - ab * db) / det, (aa * db - ab * da) / det);
        let [n0, n1, n2] = index.map(|i| self.normals[i as usize]);
        (n1 - n0) * u + (n2 - n0) * v
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        (self.positions.len() + self.normals.len()) * 12
            + self.uvs.len() * 8
            + self.triangles.len() * 12
            + self.tangents.len() * 48
            + self.attributes.iter().map(|a| a.data.len() * 4 + a.spectra.len() * size_of::<RgbAlbedo>()).sum::<usize>()
    }
}

impl MeshAttributes for TriMesh {
    #[inline]
    fn attribute_spectrum(
        &self,
        name: &str,
        domain: Option<Domain>,
        triangle: u32,
        uv: Vec2,
        lambda: &Wavelengths,
    ) -> Option<Spectrum> {
        let a = self.attributes.iter().find(|a| a.name == name && domain.is_none_or(|d| d == a.domain))?;
        let at = |i: u32| a.spectra.get(i as usize).map(|s| s.sample(lambda));
        match a.domain {
            Domain::Face => at(triangle),
            Domain::Vertex => {
                let [x, y, z] = self.triangles[triangle as usize].map(at);
                Some(x? * (1.0 - uv.x - uv.y) + y? * uv.x + z? * uv.y)
            }
        }
    }

    fn attribute(&self, name: &str, domain: Option<Domain>, triangle: u32, uv: Vec2) -> Option<([f32; 4], usize)> {
        let a = self.attributes.iter().find(|a| a.name == name && domain.is_none_or(|d| d == a.domain))?;
        let n = a.channels.min(4);
        let at = |i: usize| -> [f32; 4] {
            std::array::from_fn(|c| if c < n { a.data.get(i * a.channels + c).copied().unwrap_or(0.0) } else { 0.0 })
        };
        let value = match a.domain {
            Domain::Face => at(triangle as usize),
            Domain::Vertex => {
                let [x, y, z] = self.triangles[triangle as usize].map(|i| at(i as usize));
                let w = 1.0 - uv.x - uv.y;
                std::array::from_fn(|c| x[c] * w + y[c] * uv.x + z[c] * uv.y)
            }
        };
        Some((value, n))
    }

    fn barycentric_change(&self, triangle: u32, duv: Vec2) -> Vec2 {
        let corner = |u, v| self.uv(triangle, u, v);
        let o = corner(0.0, 0.0);
        let (a, b) = (corner(1.0, 0.0) - o, corner(0.0, 1.0) - o);
        let change = Vec2::new(duv.perp_dot(b), a.perp_dot(duv)) / a.perp_dot(b);
        if change.is_finite() { change } else { Vec2::ZERO }
    }
}

/// The surface at barycentric coordinates `(1 − u − v, u, v)` of a triangle of a mesh that has vertex normals or none,
/// and may be turned over, by its normal by winding; without a parametrisation.
#[inline(always)]
pub fn on_triangle(
    [p0, p1, p2]: [Vec3; 3],
    [n0, n1, n2]: [Vec3; 3],
    (is_smooth, flip): (bool, bool),
    (u, v): (f32, f32),
    face: Vec3,
) -> SurfacePoint {
    let w = 1.0 - u - v;
    let (q0, q1, q2) = (p0 * w, p1 * u, p2 * v);
    let error = (q0.abs() + q1.abs() + q2.abs()) * gamma(7);
    let mut n = if flip && !is_smooth { -face } else { face };
    let mut ns = n;
    if is_smooth {
        let s = n0 * w + n1 * u + n2 * v;
        let len2 = s.length_squared();
        if len2 > 0.0 {
            ns = s / len2.sqrt();
            n = if n.dot(ns) < 0.0 { -n } else { n };
        }
    }
    SurfacePoint { ns, ..SurfacePoint::bare(q0 + q1 + q2, error, n) }
}

/// Unit normal by winding; zero where the corners lie on a line.
#[inline]
pub fn face_normal([p0, p1, p2]: [Vec3; 3]) -> Vec3 {
    // Squares of tiny and huge triangles leave the range of f32.
    usual_face_normal([p0, p1, p2])
        .unwrap_or_else(|| (p1 - p0).as_dvec3().cross((p2 - p0).as_dvec3()).normalize_or_zero().as_vec3())
}

/// [`face_normal`], where single precision does for it.
#[inline(always)]
pub fn usual_face_normal([p0, p1, p2]: [Vec3; 3]) -> Option<Vec3> {
    let n = (p1 - p0).cross(p2 - p0);
    let len2 = n.length_squared();
    (len2 > 0.0 && len2.is_finite()).then(|| n / len2.sqrt())
}

/// ∂p/∂u of a triangle; zero where the parametrisation is degenerate.
#[inline]
fn tangent([p0, p1, p2]: [Vec3; 3], [uv0, uv1, uv2]: [Vec2; 3]) -> Vec3 {
    let (duv02, duv12) = (uv0 - uv2, uv1 - uv2);
    let det = duv02.x * duv12.y - duv02.y * duv12.x;
    if det.abs() < 1e-20 {
        return Vec3::ZERO;
    }
    ((p0 - p2) * duv12.y - (p1 - p2) * duv02.y) / det
}

/// Bilinear patches as triangles where that is the same surface with the same parametrisation (parallelograms), or
/// where `all` asks for it; the other patches are given back.
pub fn split_patches(mesh: &Mesh, all: bool) -> (Vec<[u32; 3]>, Vec<[u32; 4]>) {
    let mut triangles = Vec::new();
    let mut curved = Vec::new();
    let faces = mesh.attributes.iter().any(|a| a.domain == steradian_scene::Domain::Face);
    for &[a, b, c, d] in &mesh.patches {
        let p = [a, b, c, d].map(|i| Vec3::from(mesh.positions[i as usize]));
        let size = (p[3] - p[0]).abs().max((p[2] - p[1]).abs()).max_element();
        let straight = (p[0] + p[3] - p[1] - p[2]).length() <= 1e-6 * size;
        let uv_straight = mesh.uvs.is_empty() || {
            let t = [a, b, c, d].map(|i| Vec2::from(mesh.uvs[i as usize]));
            (t[0] + t[3] - t[1] - t[2]).length() <= 1e-6
        };
        // Without coordinates of its own a patch has those of the unit square, which triangles cannot state.
        if all || (straight && uv_straight && !mesh.uvs.is_empty() && !faces) {
            triangles.extend([[a, b, d], [a, d, c]]);
        } else {
            curved.push([a, b, c, d]);
        }
    }
    (triangles, curved)
}

#[cfg(test)]
mod tests {
    use super::*;
    use steradian_math::spectra::{ColorMode, role, role::Role};
    use steradian_scene::Attribute;
    use steradian_texture::{SpectrumTexture, Texture, TextureContext, Textures};

    /// In spectral mode colours of vertices become spectra once: at vertices those of the colour, between them their
    /// mean, whose colour is the mean colour; of faces that of the face. Colours above one are made anew at every
    /// point, as before.
    #[test]
    fn colours_of_vertices_are_made_spectra_once() {
        let colors = [[0.9, 0.1, 0.1], [0.1, 0.8, 0.2], [0.1, 0.2, 0.7]];
        let attribute = |name: &str, domain, colors: &[[f32; 3]], scale: f32| Attribute {
            name: name.into(),
            domain,
            channels: 3,
            data: colors.as_flattened().iter().map(|v| v * scale).collect(),
        };
        let mesh = Mesh {
            positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
            triangles: vec![[0, 1, 2]].into(),
            attributes: vec![
                attribute("color", steradian_scene::Domain::Vertex, &colors, 1.0),
                attribute("side", steradian_scene::Domain::Face, &colors[1..2], 1.0),
                attribute("bright", steradian_scene::Domain::Vertex, &colors, 4.0),
            ],
            ..Mesh::default()
        };
        let mut made = TriMesh::new(&mesh, &Affine::default(), false, false, false);
        made.attributes.iter_mut().for_each(MeshAttribute::upsample);
        assert_eq!(made.attributes.iter().map(|a| a.spectra.len()).collect::<Vec<_>>(), [3, 1, 0]);
        let mut textures = Textures::new(ColorMode::Spectral);
        let mut look = |name: &str, scale: f32| {
            let id = textures.add(Texture::MeshAttribute { name: name.into(), domain: None, scale });
            SpectrumTexture::Texture(id, Role::Albedo)
        };
        let (color, half, side, bright) =
            (look("color", 1.0), look("color", 0.5), look("side", 1.0), look("bright", 0.25));
        let spectrum = |rgb: Vec3, lambda: &Wavelengths| role::texel(rgb, Role::Albedo, lambda, ColorMode::Spectral);
        for k in 0..8 {
            let lambda = Wavelengths::sample_visible((k as f32 + 0.5) / 8.0);
            let eval = |t: &SpectrumTexture, b: Vec2| {
                let at = TextureContext { mesh: Some((&made, 0, b)), ..TextureContext::new(Vec3::ZERO, Vec2::ZERO) };
                t.eval(&textures, &at, &lambda)
            };
            let near = |a: Spectrum, b: Spectrum| assert!((a - b).map(f32::abs).max_element() < 1e-5, "{a:?} {b:?}");
            let corners = [Vec2::ZERO, Vec2::X, Vec2::Y];
            let mean = corners.into_iter().zip(colors).fold(Spectrum::ZERO, |sum, (b, c)| {
                let expected = RgbSigmoid::solved(&REC709, c.into()).sample(&lambda);
                near(eval(&color, b), expected);
                near(eval(&bright, b), spectrum(c.into(), &lambda));
                sum + expected / 3.0
            });
            let middle = Vec2::splat(1.0 / 3.0);
            near(eval(&color, middle), mean);
            near(eval(&half, middle), mean * 0.5);
            near(eval(&side, middle), RgbSigmoid::solved(&REC709, colors[1].into()).sample(&lambda));
        }
    }
}
