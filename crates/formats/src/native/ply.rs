//! Meshes as binary PLY files.

use crate::mesh::ply::{self, PlyOptions};
use steradian_scene::Mesh;

/// The file, if reading it gives the very mesh back: without tangents and attributes.
pub(super) fn exact(mesh: &Mesh) -> Option<Vec<u8>> {
    if !mesh.tangents.is_empty() || !mesh.attributes.is_empty() {
        return None;
    }
    let bytes = ply::encode(mesh);
    let read = ply::read(&bytes, &PlyOptions { keep_quads: true, ..PlyOptions::default() }).ok()?;
    (read.mesh == *mesh).then_some(bytes)
}
