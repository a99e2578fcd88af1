//! Meshes as formats expect them: triangles whose winding and normals say where the outside is, under transforms that
//! do not mirror.

use steradian_math::{DVec3, Transform};
use steradian_scene::{Domain, Mesh};

/// A mesh whose triangles turn the way its normals point, and a transform that keeps handedness: mirrored meshes are
/// placed in the world.
pub(crate) fn oriented(mesh: &Mesh, world: &Transform, reverse: bool, flat: bool) -> (Mesh, Transform) {
    let mut mesh = triangulated(mesh);
    if flat {
        mesh.normals.clear();
    }
    let mirrored = world.swaps_handedness();
    let world = if mirrored {
        mesh = placed(&mesh, world);
        Transform::IDENTITY
    } else {
        *world
    };
    if reverse {
        mesh.normals.iter_mut().for_each(|n| *n = n.map(|v| -v));
    }
    let vector = |v: [f32; 3]| DVec3::from(v.map(f64::from));
    for t in mesh.triangles.iter_mut() {
        let swap = if mesh.normals.is_empty() {
            reverse != mirrored
        } else {
            let [a, b, c] = t.map(|v| vector(mesh.positions[v as usize]));
            let n: DVec3 = t.iter().map(|&v| vector(mesh.normals[v as usize])).sum();
            (b - a).cross(c - a).dot(n) < 0.0
        };
        if swap {
            t.swap(1, 2);
        }
    }
    (mesh, world)
}

/// A mesh with a transform applied to it.
pub(crate) fn placed(mesh: &Mesh, world: &Transform) -> Mesh {
    let mut out = mesh.clone();
    let vector = |v: [f32; 3]| DVec3::from(v.map(f64::from));
    let back = |v: DVec3| v.as_vec3().to_array();
    out.positions.iter_mut().for_each(|p| *p = back(world.point(vector(*p))));
    out.tangents.iter_mut().for_each(|t| *t = back(world.vector(vector(*t))));
    if let Some(inverse) = world.inverse() {
        let m = inverse.matrix.transpose();
        out.normals.iter_mut().for_each(|n| *n = back(m.transform_vector3(vector(*n)).normalize_or_zero()));
    }
    out
}

/// Patches as two triangles each.
pub(crate) fn triangulated(mesh: &Mesh) -> Mesh {
    let mut out = mesh.clone();
    let triangles = mesh.triangles.len();
    out.triangles.extend(mesh.patches.iter().flat_map(|&[a, b, d, c]| [[a, b, c], [a, c, d]]));
    out.patches.clear();
    for a in out.attributes.iter_mut().filter(|a| a.domain == Domain::Face) {
        let patches = a.data.split_off(triangles * a.channels);
        a.data.extend(patches.chunks(a.channels.max(1)).flat_map(|c| [c, c]).flatten());
    }
    out
}

/// True if some bilinear patch is not flat, so that triangles are not the same surface.
pub(crate) fn has_curved_patches(mesh: &Mesh) -> bool {
    let at = |i: u32| DVec3::from(mesh.positions[i as usize].map(f64::from));
    mesh.patches.iter().any(|&[a, b, c, d]| {
        let (a, b, c, d) = (at(a), at(b), at(c), at(d));
        let size = (b - a).length().max((c - a).length()).max((d - a).length());
        (b - a).cross(c - a).dot(d - a).abs() > 1e-5 * size * size * size
    })
}

/// The area of a mesh in the world.
pub(crate) fn area(mesh: &Mesh, world: &Transform) -> f64 {
    let at = |i: u32| world.point(DVec3::from(mesh.positions[i as usize].map(f64::from)));
    let triangle = |[a, b, c]: [u32; 3]| 0.5 * (at(b) - at(a)).cross(at(c) - at(a)).length();
    let patches = mesh.patches.iter().flat_map(|&[a, b, d, c]| [[a, b, c], [a, c, d]]);
    mesh.triangles.iter().copied().chain(patches).map(triangle).sum()
}
