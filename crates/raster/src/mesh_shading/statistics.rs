//! How well a mesh reuses vertices, and what drawing it reads.

use std::collections::{HashMap, HashSet};

use super::meshlet::Meshlets;

/// How often vertices are used again while triangles are drawn in order.
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
    /// Of a list of triangles, where a vertex is shaded unless it is among the last `cache` that were: a cache that
    /// drops what came first. A last triangle without all three indices does not count.
    pub fn of_indices(indices: &[u32], cache: usize) -> Self {
        let (triangles, _) = indices.as_chunks::<3>();
        // For each vertex, how many were shaded when it was shaded last, itself counted; 0 if never.
        let mut when = HashMap::new();
        let mut shaded = 0;
        for &index in triangles.iter().flatten() {
            let when = when.entry(index).or_insert(0);
            if *when == 0 || shaded - *when >= cache as u64 {
                shaded += 1;
                *when = shaded;
            }
        }
        Self { shaded, distinct: when.len() as u64, triangles: triangles.len() as u64 }
    }

    /// Of meshlets, each of which shades the vertices of its table.
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

fn ratio(a: u64, b: u64) -> f64 {
    if b == 0 { 0.0 } else { a as f64 / b as f64 }
}
