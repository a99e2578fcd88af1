//! Meshes alone, as PLY and OBJ files.

use super::surface;
use crate::mesh::ply;
use steradian_math::Transform;
use steradian_scene::Mesh;

/// The extensions of files that hold a mesh and nothing else.
pub const MESH_EXTENSIONS: &[&str] = &["ply", "obj"];

/// A mesh as a file of the kind that one of [`MESH_EXTENSIONS`] names; nothing for other names. An OBJ file has no
/// tangents and no attributes.
pub fn write_mesh(mesh: &Mesh, extension: &str) -> Option<Vec<u8>> {
    match extension {
        "ply" => Some(ply::encode(mesh)),
        "obj" => Some(obj(mesh).into_bytes()),
        _ => None,
    }
}

/// A mesh with patches as two triangles each.
pub fn triangulated(mesh: &Mesh) -> Mesh {
    surface::triangulated(mesh)
}

/// A mesh with a transform applied to it.
pub fn placed(mesh: &Mesh, world_from_object: &Transform) -> Mesh {
    surface::placed(mesh, world_from_object)
}

/// The text of an OBJ file. Positions that several vertices have are written once for each of them.
fn obj(mesh: &Mesh) -> String {
    let mut text = String::new();
    let mut list = |name: &str, values: &mut dyn Iterator<Item = &[f32]>| {
        for value in values {
            text += name;
            value.iter().for_each(|x| text += &format!(" {x}"));
            text += "\n";
        }
    };
    list("v", &mut mesh.positions.iter().map(|p| &p[..]));
    list("vt", &mut mesh.uvs.iter().map(|uv| &uv[..]));
    list("vn", &mut mesh.normals.iter().map(|n| &n[..]));
    let corner = |i: u32| match (mesh.uvs.is_empty(), mesh.normals.is_empty()) {
        (true, true) => format!("{i}"),
        (false, true) => format!("{i}/{i}"),
        (true, false) => format!("{i}//{i}"),
        (false, false) => format!("{i}/{i}/{i}"),
    };
    let quads = mesh.patches.iter().map(|&[a, b, d, c]| vec![a, b, c, d]);
    for corners in mesh.triangles.iter().map(|t| t.to_vec()).chain(quads) {
        text += "f";
        corners.iter().for_each(|i| text += &format!(" {}", corner(i + 1)));
        text += "\n";
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Options, mesh::model};

    #[test]
    fn an_obj_file_is_read_back() {
        let mesh = Mesh {
            positions: vec![[0.0; 3], [0.1, 0.0, 0.0], [0.0, 1.0 / 3.0, 0.0], [1.0, 1.0, 0.5]],
            uvs: vec![[0.0; 2], [0.7, 0.0], [0.0, 1.0], [1.0, 1.0]],
            normals: vec![[0.0, 0.0, 1.0]; 4],
            triangles: vec![[0, 1, 2], [2, 1, 3]].into(),
            ..Mesh::default()
        };
        let bytes = write_mesh(&mesh, "obj").unwrap();
        let read = model::import_bytes("a.obj".as_ref(), bytes, &Options::default());
        assert_eq!(*read.desc.meshes[0], mesh);
        assert_eq!(write_mesh(&mesh, "stl"), None);
    }
}
