//! Meshlets: clusters of triangles with vertex tables of their own.

use std::ops::Range;

use glam::Vec3;

use super::{
    bounds::{NormalCone, Sphere},
    build,
};
use crate::error::{Result, refuse};

/// Size limits of meshlets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MeshletLimits {
    /// Distinct vertices of a meshlet, from 3 to 256.
    pub vertices: usize,
    /// Triangles of a meshlet, from 1 to 256.
    pub triangles: usize,
}

impl MeshletLimits {
    /// The most of either that a meshlet may have: what a mesh shader may put out (`maxMeshOutputVertices` and
    /// `maxMeshOutputPrimitives` of `VK_EXT_mesh_shader` are at least 256).
    pub const LARGEST: Self = Self { vertices: 256, triangles: 256 };

    fn check(self) -> Result<()> {
        let Self { vertices, triangles } = self;
        if !(3..=Self::LARGEST.vertices).contains(&vertices) {
            return refuse(CALL, format!("meshlets of up to {vertices} vertices; the limit may be from 3 to 256"));
        }
        if !(1..=Self::LARGEST.triangles).contains(&triangles) {
            return refuse(CALL, format!("meshlets of up to {triangles} triangles; the limit may be from 1 to 256"));
        }
        Ok(())
    }
}

/// 64 vertices and 126 triangles, as Kubisch recommends ("Introduction to Turing Mesh Shaders", NVIDIA 2018).
impl Default for MeshletLimits {
    fn default() -> Self {
        Self { vertices: 64, triangles: 126 }
    }
}

/// One cluster: its places in the tables of [`Meshlets`], and what it is culled by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Meshlet {
    pub(super) first_vertex: u32,
    pub(super) vertices: u32,
    pub(super) first_triangle: u32,
    pub(super) triangles: u32,
    /// Contains all its triangles.
    pub sphere: Sphere,
    /// Tells from where all its triangles show their backs.
    pub cone: NormalCone,
}

impl Meshlet {
    /// Range of its vertices in [`Meshlets::vertices`].
    pub fn vertices(&self) -> Range<usize> {
        range(self.first_vertex, self.vertices)
    }

    /// Range of its triangles in [`Meshlets::triangles`] and [`Meshlets::sources`].
    pub fn triangles(&self) -> Range<usize> {
        range(self.first_triangle, self.triangles)
    }
}

fn range(first: u32, count: u32) -> Range<usize> {
    first as usize..first as usize + count as usize
}

/// A mesh in meshlets. Each triangle of the mesh is in one of them, with its corners in the same order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Meshlets {
    pub(super) meshlets: Vec<Meshlet>,
    pub(super) vertices: Vec<u32>,
    pub(super) triangles: Vec<[u8; 3]>,
    pub(super) sources: Vec<u32>,
}

const CALL: &str = "Meshlets::build";

impl Meshlets {
    /// Clusters a mesh: three indices for each triangle, each the number of a position. Takes time in proportion to the
    /// mesh (and n log n for one sort), and always gives the same clusters.
    ///
    /// Clusters grow triangle by triangle over common vertices. The next one is that which adds the fewest vertices; of
    /// several, the one nearest to the cluster's centre, where distances grow with the angle between its normal and the
    /// cluster's. The method is modelled on `meshopt_buildMeshlets` of meshoptimizer (Kapoulkine, documented in its
    /// README, "Mesh shading").
    ///
    /// Degenerate triangles are kept. Positions that no index names may have any value.
    ///
    /// # Errors
    /// Where a limit is out of its range, the number of indices is no multiple of three or has more than 2³² − 1
    /// triangles, an index names no position, or a position that is named is not finite.
    pub fn build(positions: &[Vec3], indices: &[u32], limits: MeshletLimits) -> Result<Self> {
        limits.check()?;
        // Triangles are triples of indices, without a rest.
        let (triangles, rest) = indices.as_chunks::<3>();
        if !rest.is_empty() {
            return refuse(CALL, format!("{} indices; three for each triangle", indices.len()));
        }
        if u32::try_from(triangles.len()).is_err() {
            return refuse(CALL, format!("{} triangles; at most 2³² − 1", triangles.len()));
        }
        // Validate indices and the positions they name before clustering.
        for (place, &index) in indices.iter().enumerate() {
            match positions.get(index as usize) {
                None => {
                    let count = positions.len();
                    return refuse(CALL, format!("index {index} at place {place}; there are {count} positions"));
                }
                Some(position) if !position.is_finite() => {
                    return refuse(CALL, format!("position {index} is {position}, which is not finite"));
                }
                Some(_) => {}
            }
        }
        Ok(build::build(positions, triangles, limits))
    }

    /// The meshlets.
    pub fn meshlets(&self) -> &[Meshlet] {
        &self.meshlets
    }

    /// Numbers of the mesh's vertices, the table of one meshlet after the other.
    pub fn vertices(&self) -> &[u32] {
        &self.vertices
    }

    /// Corners of triangles: places in the table of their meshlet.
    pub fn triangles(&self) -> &[[u8; 3]] {
        &self.triangles
    }

    /// For each triangle, its number in the mesh.
    pub fn sources(&self) -> &[u32] {
        &self.sources
    }

    /// The triangles as indices of the mesh's vertices, in the order of the meshlets.
    pub fn to_indices(&self) -> Vec<u32> {
        // Resolve the two levels of indices: triangle corner to table entry to vertex.
        let corners = |meshlet: &Meshlet| {
            let table = &self.vertices[meshlet.vertices()];
            self.triangles[meshlet.triangles()].iter().flatten().map(move |&corner| table[usize::from(corner)])
        };
        self.meshlets.iter().flat_map(corners).collect()
    }
}
