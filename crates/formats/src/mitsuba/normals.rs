//! Mitsuba's processing of a mesh after reading: vertex normals, orientation, texture coordinates.

use std::collections::HashMap;
use steradian_math::{DVec3, Transform};
use steradian_scene::Mesh;

/// Sets vertex normals to the mean of the face normals around each vertex as they are in the world, weighted by the
/// angle of the face there (Thürmer and Wüthrich, Computing Vertex Normals from Polygonal Facets, JGT 3(1), 1998). With
/// `weld`, vertices at the same place are one: they differ in texture coordinates only. The result is in object space.
/// Vertices without faces get +z.
pub(super) fn compute(mesh: &mut Mesh, world_from_object: &Transform, weld: bool) {
    let point_of = weld.then(|| welded(&mesh.positions));
    let point = |vertex: u32| point_of.as_ref().map_or(vertex, |p| p[vertex as usize]) as usize;
    let world: Vec<DVec3> =
        mesh.positions.iter().map(|&p| world_from_object.vector(DVec3::from(p.map(f64::from)))).collect();
    let mut sums = vec![DVec3::ZERO; mesh.positions.len()];
    for t in &mesh.triangles {
        let p = t.map(|i| world[i as usize]);
        let Some(normal) = (p[1] - p[0]).cross(p[2] - p[0]).try_normalize() else { continue };
        for corner in 0..3 {
            let (a, b) = (p[(corner + 1) % 3] - p[corner], p[(corner + 2) % 3] - p[corner]);
            sums[point(t[corner])] += normal * a.angle_between(b);
        }
    }
    // Normals go to the world by the inverse transpose, so they come back by the transpose. Mirrored faces are computed
    // inside out.
    let side = if world_from_object.swaps_handedness() { -1.0 } else { 1.0 };
    let m = &world_from_object.matrix;
    let axes = [m.x_axis, m.y_axis, m.z_axis].map(|c| c.truncate());
    let normal = |vertex: u32| {
        let object = DVec3::from(axes.map(|a| a.dot(sums[point(vertex)]))) * side;
        object.try_normalize().unwrap_or(DVec3::Z).as_vec3().to_array()
    };
    mesh.normals = (0..mesh.positions.len() as u32).map(normal).collect();
}

/// The first vertex at the place of each.
fn welded(positions: &[[f32; 3]]) -> Vec<u32> {
    let mut first = HashMap::with_capacity(positions.len());
    positions.iter().zip(0..).map(|(p, i)| *first.entry(p.map(f32::to_bits)).or_insert(i)).collect()
}

/// Tests for a conformal transform, under which normals computed in object space are right in the world.
pub(super) fn keeps_angles(t: &Transform) -> bool {
    let axes = [t.matrix.x_axis, t.matrix.y_axis, t.matrix.z_axis].map(|c| c.truncate());
    let size = axes[0].length_squared();
    let same = |v: f64| (v - size).abs() <= 1e-9 * size;
    let square = |a: DVec3, b: DVec3| a.dot(b).abs() <= 1e-9 * size;
    same(axes[1].length_squared())
        && same(axes[2].length_squared())
        && square(axes[0], axes[1])
        && square(axes[1], axes[2])
        && square(axes[2], axes[0])
}

/// Turns a mesh inside out: its normals and the order of its vertices.
pub(super) fn flip(mesh: &mut Mesh) {
    mesh.normals.iter_mut().for_each(|n| *n = n.map(|v| -v));
    mesh.triangles.iter_mut().for_each(|t| t.swap(0, 2));
    mesh.patches.iter_mut().for_each(|p| p.swap(0, 1));
    mesh.patches.iter_mut().for_each(|p| p.swap(2, 3));
}

/// Turns texture coordinates upside down.
pub(super) fn flip_uvs(mesh: &mut Mesh) {
    mesh.uvs.iter_mut().for_each(|uv| uv[1] = 1.0 - uv[1]);
}

#[cfg(test)]
mod tests {
    use super::{super::solids, *};

    fn corner_cube() -> Mesh {
        // The cube with its eight corners shared.
        let cube = solids::cube();
        let mut mesh = Mesh::default();
        for t in &cube.triangles {
            mesh.triangles.push(t.map(|i| {
                let p = cube.positions[i as usize];
                mesh.positions.iter().position(|q| *q == p).unwrap_or_else(|| {
                    mesh.positions.push(p);
                    mesh.positions.len() - 1
                }) as u32
            }));
        }
        mesh
    }

    #[test]
    fn smooth_normals_of_a_cube_point_to_its_corners() {
        for transform in [Transform::IDENTITY, Transform::scale(DVec3::new(-2.0, 2.0, 2.0))] {
            let mut mesh = corner_cube();
            compute(&mut mesh, &transform, false);
            for (n, p) in mesh.normals.iter().zip(&mesh.positions) {
                let (n, p) = (DVec3::from(n.map(f64::from)), DVec3::from(p.map(f64::from)).normalize());
                assert!((n - p).length() < 1e-6, "{n} {p}");
            }
        }
    }

    #[test]
    fn normals_are_those_of_the_stretched_shape() {
        let stretch = Transform::scale(DVec3::new(1.0, 1.0, 4.0));
        let mut there = corner_cube();
        compute(&mut there, &stretch, false);
        // The same computed on a stretched mesh.
        let mut stretched = corner_cube();
        stretched.positions.iter_mut().for_each(|p| p[2] *= 4.0);
        compute(&mut stretched, &Transform::IDENTITY, false);
        // The solid cube has its corners three times over; welded they are the same.
        let mut solid = solids::cube();
        compute(&mut solid, &stretch, true);
        let at = there.positions.iter().position(|p| *p == solid.positions[5]).unwrap();
        assert!(
            (DVec3::from(there.normals[at].map(f64::from)) - DVec3::from(solid.normals[5].map(f64::from))).length()
                < 1e-6
        );
        for (a, b) in there.normals.iter().zip(&stretched.normals) {
            let a = DVec3::new(f64::from(a[0]), f64::from(a[1]), f64::from(a[2]) / 4.0).normalize();
            assert!((a - DVec3::from(b.map(f64::from))).length() < 1e-6);
        }
        assert!(!keeps_angles(&stretch) && keeps_angles(&Transform::scale(DVec3::splat(-3.0))));
    }

    #[test]
    fn a_flipped_mesh_is_inside_out() {
        let (mut mesh, cube) = (solids::cube(), solids::cube());
        flip(&mut mesh);
        assert_eq!(mesh.normals[0], cube.normals[0].map(|v| -v));
        let [a, b, c] = mesh.triangles[0].map(|i| DVec3::from(mesh.positions[i as usize].map(f64::from)));
        assert!((b - a).cross(c - a).dot(DVec3::from(mesh.normals[0].map(f64::from))) > 0.0);
    }
}
