//! Texture coordinates at the corners of faces ("wedges"), as MeshLab writes them: vertices are split where they
//! differ.

use super::header::Element;
use std::collections::HashMap;
use steradian_scene::{Domain, Mesh};

/// The names of the list.
const NAMES: [&str; 3] = ["texcoord", "texcoords", "texture_uv"];

/// The property that has the texture coordinates.
pub(super) fn slot(element: &Element) -> Option<usize> {
    element.properties.iter().position(|p| p.length.is_some() && NAMES.contains(&p.name.as_str()))
}

/// Vertices by their texture coordinates.
pub(super) struct Wedges {
    /// Per vertex of the file: true if it has its texture coordinates.
    is_taken: Vec<bool>,
    /// The vertices made for further texture coordinates of a vertex of the file.
    made: HashMap<(u32, [u32; 2]), u32>,
}

impl Wedges {
    /// Begins with the vertices of the file; texture coordinates of theirs give way.
    pub(super) fn new(mesh: &mut Mesh) -> Self {
        mesh.uvs = vec![[0.0; 2]; mesh.positions.len()];
        Self { is_taken: vec![false; mesh.positions.len()], made: HashMap::new() }
    }

    /// Replaces the corners of a face by vertices that have their texture coordinates; zero where `uvs` are not two
    /// finite numbers for each corner.
    pub(super) fn split(&mut self, mesh: &mut Mesh, corners: &mut [u32], uvs: &[f32]) {
        let is_whole = uvs.len() == 2 * corners.len();
        for (k, corner) in corners.iter_mut().enumerate() {
            let uv = if is_whole { [uvs[2 * k], uvs[2 * k + 1]] } else { [0.0; 2] };
            let uv = uv.map(|v| if v.is_finite() { v } else { 0.0 });
            let v = *corner as usize;
            if !std::mem::replace(&mut self.is_taken[v], true) {
                mesh.uvs[v] = uv;
            }
            if mesh.uvs[v] != uv {
                *corner = *self.made.entry((*corner, uv.map(f32::to_bits))).or_insert_with(|| copied(mesh, v, uv));
            }
        }
    }
}

/// A copy of a vertex with other texture coordinates.
fn copied(mesh: &mut Mesh, vertex: usize, uv: [f32; 2]) -> u32 {
    let new = mesh.positions.len() as u32;
    mesh.positions.push(mesh.positions[vertex]);
    mesh.normals.extend(mesh.normals.get(vertex).copied());
    mesh.uvs.push(uv);
    for attribute in mesh.attributes.iter_mut().filter(|a| a.domain == Domain::Vertex) {
        let from = vertex * attribute.channels;
        attribute.data.extend_from_within(from..from + attribute.channels);
    }
    new
}
