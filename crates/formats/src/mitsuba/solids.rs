//! Meshes of the shapes that Mitsuba defines as such, in its parametrisation.

use steradian_scene::Mesh;

/// The square [-1, 1]² in the plane z = 0, facing +z, with texture coordinates 0…1.
pub(crate) fn rectangle() -> Mesh {
    Mesh {
        positions: vec![[-1., -1., 0.], [1., -1., 0.], [1., 1., 0.], [-1., 1., 0.]],
        normals: vec![[0., 0., 1.]; 4],
        uvs: vec![[0., 0.], [1., 0.], [1., 1.], [0., 1.]],
        triangles: vec![[0, 1, 2], [2, 3, 0]].into(),
        ..Mesh::default()
    }
}

/// The cube [-1, 1]³ facing outwards; every face has the texture coordinates 0…1.
pub(crate) fn cube() -> Mesh {
    // Corner c has bit k set where axis k is +1; the four corners of each face with its normal.
    const FACES: [([f32; 3], [usize; 4]); 6] = [
        ([0., -1., 0.], [1, 5, 4, 0]),
        ([0., 1., 0.], [3, 2, 6, 7]),
        ([1., 0., 0.], [1, 3, 7, 5]),
        ([0., 0., 1.], [5, 7, 6, 4]),
        ([-1., 0., 0.], [4, 6, 2, 0]),
        ([0., 0., -1.], [3, 1, 0, 2]),
    ];
    let mut mesh = Mesh::default();
    for (face, (normal, corners)) in FACES.iter().enumerate() {
        for c in corners {
            mesh.positions.push([0, 1, 2].map(|axis| if c >> axis & 1 == 1 { 1. } else { -1. }));
        }
        mesh.normals.extend([*normal; 4]);
        mesh.uvs.extend([[0., 1.], [1., 1.], [1., 0.], [0., 0.]]);
        let first = 4 * face as u32;
        mesh.triangles.extend([[first, first + 1, first + 2], [first + 3, first, first + 2]]);
    }
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;
    use steradian_math::Vec3;

    #[test]
    fn faces_turn_the_way_their_normals_point() {
        for mesh in [rectangle(), cube()] {
            mesh.validate().unwrap();
            for t in &mesh.triangles {
                let [a, b, c] = t.map(|i| Vec3::from(mesh.positions[i as usize]));
                let normal = Vec3::from(mesh.normals[t[0] as usize]);
                assert!((b - a).cross(c - a).dot(normal) > 0.0);
                assert!(mesh.positions.len() == 4 || a.dot(normal) == 1.0);
            }
        }
        assert_eq!((cube().positions.len(), cube().triangles.len()), (24, 12));
    }
}
