//! Vertex reuse of a mesh, and memory that drawing it reads.

use std::collections::{HashMap, HashSet};

use super::meshlet::{Meshlet, Meshlets};

/// Vertex reuse while triangles are drawn in order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VertexReuse {
    /// Vertices that are shaded.
    pub shaded: u64,
    /// Distinct vertices that triangles name.
    pub distinct: u64,
    /// Triangles.
    pub triangles: u64,
}

impl VertexReuse {
    /// Reuse of a list of triangles, with a FIFO cache: a vertex is shaded unless it is among the last `cache` that
    /// were. A last triangle without all three indices does not count.
    pub fn of_indices(indices: &[u32], cache: usize) -> Self {
        let (triangles, _) = indices.as_chunks::<3>();
        // For each vertex, how many were shaded when it was shaded last, itself counted; 0 if never.
        let mut when = HashMap::new();
        let mut shaded = 0;
        for &index in triangles.iter().flatten() {
            // Simulate a FIFO cache by the time each vertex was shaded last.
            let when = when.entry(index).or_insert(0);
            if *when == 0 || shaded - *when >= cache as u64 {
                shaded += 1;
                *when = shaded;
            }
        }
        Self { shaded, distinct: when.len() as u64, triangles: triangles.len() as u64 }
    }

    /// Reuse of meshlets, each of which shades the vertices of its table.
    pub fn of_meshlets(meshlets: &Meshlets) -> Self {
        let distinct: HashSet<u32> = meshlets.vertices().iter().copied().collect();
        Self {
            shaded: meshlets.vertices().len() as u64,
            distinct: distinct.len() as u64,
            triangles: meshlets.triangles().len() as u64,
        }
    }

    /// Average cache miss ratio: vertices shaded for each triangle, from about ½ to 3; 0 without triangles. (Hoppe,
    /// "Optimization of Mesh Locality for Transparent Vertex Caching", SIGGRAPH 1999.)
    pub fn acmr(&self) -> f64 {
        ratio(self.shaded, self.triangles)
    }

    /// Average transform to vertex ratio: how often a vertex is shaded, at least 1; 0 without vertices.
    pub fn atvr(&self) -> f64 {
        ratio(self.shaded, self.distinct)
    }
}

/// Bytes that a draw reads of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BytesRead {
    /// Bytes that say which vertices triangles have, and by what they are culled.
    pub topology: u64,
    /// Bytes of vertices.
    pub vertices: u64,
}

impl BytesRead {
    /// Bytes read by an indexed draw: `index_bytes` for each index, and `vertex_bytes` whenever a vertex is shaded,
    /// with a cache as in [`VertexReuse::of_indices`].
    pub fn of_indices(indices: &[u32], cache: usize, index_bytes: u64, vertex_bytes: u64) -> Self {
        let reuse = VertexReuse::of_indices(indices, cache);
        Self { topology: 3 * reuse.triangles * index_bytes, vertices: reuse.shaded * vertex_bytes }
    }

    /// Bytes read by a draw of those meshlets for whose numbers `is_drawn` holds: a [`Meshlet`] for each, drawn or not,
    /// and for those that are drawn 3 bytes for each triangle, 4 for each vertex of the table, and `vertex_bytes` for
    /// the vertex itself.
    pub fn of_meshlets(meshlets: &Meshlets, is_drawn: impl Fn(usize) -> bool, vertex_bytes: u64) -> Self {
        let all = meshlets.meshlets().iter().enumerate();
        let mut read = Self { topology: (all.len() * size_of::<Meshlet>()) as u64, vertices: 0 };
        for (_, meshlet) in all.filter(|(number, _)| is_drawn(*number)) {
            // Connectivity in bytes local to the meshlet, and the indices of its vertex table.
            let (vertices, triangles) = (meshlet.vertices().len() as u64, meshlet.triangles().len() as u64);
            read.topology += 3 * triangles + 4 * vertices;
            read.vertices += vertices * vertex_bytes;
        }
        read
    }

    /// All together.
    pub fn total(&self) -> u64 {
        self.topology + self.vertices
    }
}

fn ratio(a: u64, b: u64) -> f64 {
    if b == 0 { 0.0 } else { a as f64 / b as f64 }
}
