//! Polygon meshes as they come from files: pure arrays.

use crate::Shared;
use serde::{Deserialize, Serialize};
use steradian_math::{DVec3, geometry::surface::SurfaceMesh};

/// Domain of an [`Attribute`]: the elements that have one value each.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Domain {
    /// Per vertex, interpolated.
    Vertex,
    /// Per face: one value per triangle, then per patch.
    Face,
}

/// Extra data on a mesh, such as colours.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Attribute {
    /// Name without a domain prefix, e.g. `color`.
    pub name: String,
    /// Elements that have one value each.
    pub domain: Domain,
    /// Numbers per value, 1 to 4.
    pub channels: usize,
    /// `channels × count` numbers.
    pub data: Vec<f32>,
}

/// Triangles and bilinear patches over shared vertices, in object space.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Mesh {
    /// Vertex positions.
    pub positions: Vec<[f32; 3]>,
    /// Vertex normals: none or one per position. Not necessarily of unit length.
    pub normals: Vec<[f32; 3]>,
    /// Texture coordinates: none or one per position.
    pub uvs: Vec<[f32; 2]>,
    /// Vertex tangents: none or one per position.
    pub tangents: Vec<[f32; 3]>,
    /// Vertex indices of each triangle, counter-clockwise seen from the front.
    pub triangles: Shared<[u32; 3]>,
    /// Vertex indices of each bilinear patch, in the order p00, p10, p01, p11.
    pub patches: Vec<[u32; 4]>,
    /// Further data per vertex or face.
    pub attributes: Vec<Attribute>,
}

/// Fault of a [`Mesh`].
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum MeshFault {
    /// An index points past the vertices.
    #[error("{what} {face} refers to vertex {index}, but there are only {count} vertices")]
    IndexOutOfRange {
        /// "triangle" or "patch".
        what: &'static str,
        /// Which one, from 0.
        face: usize,
        /// The index.
        index: u32,
        /// Number of vertices.
        count: usize,
    },
    /// A coordinate is NaN or infinite.
    #[error("the {what} of vertex {vertex} is not a finite number")]
    NotFinite {
        /// "position", "normal", "uv" or "tangent".
        what: &'static str,
        /// Which one, from 0.
        vertex: usize,
    },
    /// An array has the wrong length.
    #[error("{what}: {found} values where {expected} are needed")]
    WrongLength {
        /// Which array.
        what: String,
        /// Number of values found.
        found: usize,
        /// Number of values expected.
        expected: usize,
    },
}

impl From<SurfaceMesh> for Mesh {
    /// Rounds a surface mesh to single precision; its parameters become texture coordinates.
    fn from(mesh: SurfaceMesh) -> Self {
        let single = |v: DVec3| v.as_vec3().to_array();
        Self {
            positions: mesh.positions.iter().map(|p| single(p.to_vector())).collect(),
            normals: mesh.normals.iter().map(|n| single(*n)).collect(),
            uvs: mesh.parameters.iter().map(|p| p.as_vec2().to_array()).collect(),
            triangles: mesh.triangles.into(),
            ..Self::default()
        }
    }
}

impl Mesh {
    /// Checks every invariant the fields promise. Readers call it before they hand a mesh on.
    ///
    /// # Errors
    /// The first [`MeshFault`] found.
    pub fn validate(&self) -> Result<(), MeshFault> {
        let n = self.positions.len();
        let length = |what: &str, found: usize, expected: usize| {
            (found == expected).then_some(()).ok_or(MeshFault::WrongLength { what: what.into(), found, expected })
        };
        for (what, len) in [("normals", self.normals.len()), ("uvs", self.uvs.len()), ("tangents", self.tangents.len())]
        {
            if len > 0 {
                length(what, len, n)?;
            }
        }
        for (face, t) in self.triangles.iter().enumerate() {
            if let Some(&index) = t.iter().find(|&&i| i as usize >= n) {
                return Err(MeshFault::IndexOutOfRange { what: "triangle", face, index, count: n });
            }
        }
        for (face, t) in self.patches.iter().enumerate() {
            if let Some(&index) = t.iter().find(|&&i| i as usize >= n) {
                return Err(MeshFault::IndexOutOfRange { what: "patch", face, index, count: n });
            }
        }
        let finite3 = |what, a: &[[f32; 3]]| match a.iter().position(|v| !v.iter().all(|x| x.is_finite())) {
            Some(vertex) => Err(MeshFault::NotFinite { what, vertex }),
            None => Ok(()),
        };
        finite3("position", &self.positions)?;
        finite3("normal", &self.normals)?;
        finite3("tangent", &self.tangents)?;
        if let Some(vertex) = self.uvs.iter().position(|v| !v.iter().all(|x| x.is_finite())) {
            return Err(MeshFault::NotFinite { what: "uv", vertex });
        }
        for a in &self.attributes {
            let count = match a.domain {
                Domain::Vertex => n,
                Domain::Face => self.triangles.len() + self.patches.len(),
            };
            length(&format!("attribute '{}'", a.name), a.data.len(), count.saturating_mul(a.channels))?;
        }
        Ok(())
    }

    /// Bytes held by the arrays.
    pub fn bytes(&self) -> usize {
        self.positions.len() * 12
            + (self.normals.len() + self.tangents.len()) * 12
            + self.uvs.len() * 8
            + self.triangles.len() * 12
            + self.patches.len() * 16
            + self.attributes.iter().map(|a| a.data.len() * 4).sum::<usize>()
    }
}
