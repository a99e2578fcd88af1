//! Meshes as binary PLY files.

use crate::mesh::ply::{self, PlyOptions};
use steradian_scene::Mesh;

/// The file, if reading it gives the very mesh back: without tangents and attributes.
pub(super) fn exact(mesh: &Mesh) -> Option<Vec<u8>> {
    if !mesh.tangents.is_empty() || !mesh.attributes.is_empty() {
        return None;
    }
    let bytes = encode(mesh);
    let read = ply::read(&bytes, &PlyOptions { keep_quads: true }).ok()?;
    (read.mesh == *mesh).then_some(bytes)
}

fn encode(mesh: &Mesh) -> Vec<u8> {
    let (has_normals, has_uvs) = (!mesh.normals.is_empty(), !mesh.uvs.is_empty());
    let property = |names: &str| names.split(' ').map(|n| format!("property float {n}\n")).collect::<String>();
    let mut out = format!("ply\nformat binary_little_endian 1.0\nelement vertex {}\n", mesh.positions.len());
    out += &property("x y z");
    out += &if has_normals { property("nx ny nz") } else { String::new() };
    out += &if has_uvs { property("u v") } else { String::new() };
    let faces = mesh.triangles.len() + mesh.patches.len();
    out += &format!("element face {faces}\nproperty list uchar uint vertex_indices\nend_header\n");
    let mut out = out.into_bytes();
    let mut put = |values: &[f32]| values.iter().for_each(|v| out.extend(v.to_le_bytes()));
    for (i, p) in mesh.positions.iter().enumerate() {
        put(p);
        if has_normals {
            put(&mesh.normals[i]);
        }
        if has_uvs {
            put(&mesh.uvs[i]);
        }
    }
    let mut face = |corners: &[u32]| {
        out.push(corners.len() as u8);
        corners.iter().for_each(|c| out.extend(c.to_le_bytes()));
    };
    mesh.triangles.iter().for_each(|t| face(t));
    mesh.patches.iter().for_each(|&[a, b, d, c]| face(&[a, b, c, d]));
    out
}
