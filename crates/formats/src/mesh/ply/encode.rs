//! Writing PLY files.

use steradian_scene::{Domain, Mesh};

/// The mesh as a binary PLY file, attributes by Mitsuba's rule.
pub(crate) fn encode(mesh: &Mesh) -> Vec<u8> {
    let (has_normals, has_uvs) = (!mesh.normals.is_empty(), !mesh.uvs.is_empty());
    let property = |names: &str| names.split(' ').map(|n| format!("property float {n}\n")).collect::<String>();
    let mut out = format!("ply\nformat binary_little_endian 1.0\nelement vertex {}\n", mesh.positions.len());
    out += &property("x y z");
    out += &if has_normals { property("nx ny nz") } else { String::new() };
    out += &if has_uvs { property("u v") } else { String::new() };
    let of =
        |domain: Domain| mesh.attributes.iter().filter(move |a| a.domain == domain && (1..=4).contains(&a.channels));
    let names = |domain: Domain| -> String {
        of(domain)
            .map(|a| match (a.name.as_str(), a.channels) {
                ("color", 3) => property("r g b"),
                (name, n) => "xyzw"[..n].chars().map(|c| property(&format!("{name}_{c}"))).collect(),
            })
            .collect()
    };
    out += &names(Domain::Vertex);
    let faces = mesh.triangles.len() + mesh.patches.len();
    out += &format!("element face {faces}\nproperty list uchar uint vertex_indices\n");
    out += &names(Domain::Face);
    out += "end_header\n";
    let mut out = out.into_bytes();
    let put = |out: &mut Vec<u8>, values: &[f32]| values.iter().for_each(|v| out.extend(v.to_le_bytes()));
    for (i, p) in mesh.positions.iter().enumerate() {
        put(&mut out, p);
        if has_normals {
            put(&mut out, &mesh.normals[i]);
        }
        if has_uvs {
            put(&mut out, &mesh.uvs[i]);
        }
        for a in of(Domain::Vertex) {
            put(&mut out, &a.data[i * a.channels..(i + 1) * a.channels]);
        }
    }
    let quads = mesh.patches.iter().map(|&[a, b, d, c]| vec![a, b, c, d]);
    for (i, corners) in mesh.triangles.iter().map(|t| t.to_vec()).chain(quads).enumerate() {
        out.push(corners.len() as u8);
        corners.iter().for_each(|c| out.extend(c.to_le_bytes()));
        for a in of(Domain::Face) {
            put(&mut out, &a.data[i * a.channels..(i + 1) * a.channels]);
        }
    }
    out
}
