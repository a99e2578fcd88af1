//! Vertex normals for meshes that come without.
//!
//! Faces that meet in an edge at less than the crease angle are taken for parts of one smooth surface. Around each
//! position, faces that are connected by such edges share a normal, the mean of theirs weighted by their angles there
//! (Thürmer, Wüthrich 1998). Vertices at which smooth surfaces meet in a crease are doubled.

use rayon::prelude::*;
use std::collections::HashMap;
use steradian_math::Vec3;
use steradian_scene::{Domain, Mesh};

/// The greatest angle in degrees between faces of a smooth surface, unless told otherwise.
pub(super) const CREASE: f32 = 30.0;

/// Corners in the order in which they surround a face.
const TRIANGLE_LOOP: [usize; 3] = [0, 1, 2];
const PATCH_LOOP: [usize; 4] = [0, 1, 3, 2];

/// A corner of a face.
struct Corner {
    face: u32,
    vertex: u32,
    /// Numbers of the positions at the other ends of its two edges.
    neighbors: [u32; 2],
    angle: f32,
}

/// Gives a mesh without normals those of smooth surfaces, of faces at `crease` degrees at most. It stays flat where all
/// its edges are creases.
pub(super) fn smooth(mesh: &mut Mesh, crease: f32) {
    let limit = crease.to_radians().cos();
    if crease <= 0.0 || !mesh.normals.is_empty() || mesh.validate().is_err() {
        return;
    }
    let position = positions(mesh);
    let triangles = mesh.triangles.iter().map(|t| (t.as_slice(), &TRIANGLE_LOOP[..]));
    let patches = mesh.patches.iter().map(|p| (p.as_slice(), &PATCH_LOOP[..]));
    let at = |vertex: u32| Vec3::from(mesh.positions[vertex as usize]);
    let mut normals = Vec::with_capacity(mesh.triangles.len() + mesh.patches.len());
    let mut corners = Vec::with_capacity(3 * mesh.triangles.len() + 4 * mesh.patches.len());
    for (face, order) in triangles.chain(patches) {
        let n = order.len();
        let [first, second] = if n == 3 { [[0, 1], [0, 2]] } else { [[0, 3], [1, 2]] };
        let edge = |[a, b]: [usize; 2]| at(face[b]) - at(face[a]);
        let normal = edge(first).cross(edge(second)).normalize_or_zero();
        for k in 0..n {
            let [vertex, next, last] = [0, 1, n - 1].map(|step| face[order[(k + step) % n]]);
            let angle = (at(next) - at(vertex)).angle_between(at(last) - at(vertex));
            corners.push(Corner {
                face: normals.len() as u32,
                vertex,
                neighbors: [next, last].map(|v| position[v as usize]),
                angle: if angle.is_finite() { angle } else { 0.0 },
            });
        }
        normals.push(normal);
    }
    let place = |corner: u32| position[corners[corner as usize].vertex as usize];
    let mut order: Vec<u32> = (0..corners.len() as u32).collect();
    order.par_sort_unstable_by_key(|&c| (place(c), c));
    let mut of_corner = vec![Vec3::ZERO; corners.len()];
    let mut is_smooth = false;
    for around in order.chunk_by(|&a, &b| place(a) == place(b)) {
        is_smooth |= share(around, &corners, &normals, limit, &mut of_corner);
    }
    if is_smooth {
        assign(mesh, &of_corner);
    }
}

/// A number for each vertex, the same for those at the same place.
fn positions(mesh: &Mesh) -> Vec<u32> {
    // Minus zero is zero.
    let key = |v: u32| mesh.positions[v as usize].map(|x| (x + 0.0).to_bits());
    let mut order: Vec<u32> = (0..mesh.positions.len() as u32).collect();
    order.par_sort_unstable_by_key(|&v| key(v));
    let mut numbers = vec![0; order.len()];
    let mut number = 0;
    for pair in order.windows(2) {
        number += u32::from(key(pair[0]) != key(pair[1]));
        numbers[pair[1] as usize] = number;
    }
    numbers
}

/// Finds the normals of the corners at one position, where faces whose normals have a cosine of `limit` at least are of
/// one surface; tells whether one of them is not its face's.
fn share(around: &[u32], corners: &[Corner], normals: &[Vec3], limit: f32, of_corner: &mut [Vec3]) -> bool {
    let normal = |i: usize| normals[corners[around[i] as usize].face as usize];
    // Edges from here, by their other end: what shares an edge stands together.
    let mut edges: Vec<(u32, usize)> = Vec::with_capacity(2 * around.len());
    for (i, &c) in around.iter().enumerate() {
        edges.extend(corners[c as usize].neighbors.map(|n| (n, i)));
    }
    edges.sort_unstable();
    let mut parent: Vec<usize> = (0..around.len()).collect();
    for pair in edges.windows(2) {
        let [(a, i), (b, j)] = [pair[0], pair[1]];
        if a == b && normal(i).dot(normal(j)) >= limit {
            let (i, j) = (root(&mut parent, i), root(&mut parent, j));
            parent[i.max(j)] = i.min(j);
        }
    }
    let mut sums = vec![Vec3::ZERO; around.len()];
    for i in 0..around.len() {
        sums[root(&mut parent, i)] += normal(i) * corners[around[i] as usize].angle;
    }
    let mut is_smooth = false;
    for i in 0..around.len() {
        let own = normal(i);
        let mean = sums[root(&mut parent, i)].normalize_or(own);
        is_smooth |= mean.dot(own) < 1.0 - 1e-6;
        of_corner[around[i] as usize] = mean;
    }
    is_smooth
}

fn root(parent: &mut [usize], mut i: usize) -> usize {
    while parent[i] != i {
        parent[i] = parent[parent[i]];
        i = parent[i];
    }
    i
}

/// Gives the vertices the normals of their corners, and doubles those whose corners differ.
fn assign(mesh: &mut Mesh, of_corner: &[Vec3]) {
    let original = mesh.positions.len() as u32;
    let mut normals: Vec<Option<Vec3>> = vec![None; original as usize];
    // Vertices that are added, by what they are copies of and by their normals.
    let mut copies: HashMap<(u32, [u32; 3]), u32> = HashMap::new();
    let mut added: Vec<(u32, Vec3)> = Vec::new();
    let mut set = |vertex: &mut u32, normal: Vec3| {
        let first = normals[*vertex as usize].get_or_insert(normal);
        if *first != normal {
            let source = *vertex;
            *vertex = *copies.entry((source, normal.to_array().map(f32::to_bits))).or_insert_with(|| {
                added.push((source, normal));
                original + added.len() as u32 - 1
            });
        }
    };
    let mut next = of_corner.iter().copied();
    for (vertex, normal) in mesh.triangles.as_flattened_mut().iter_mut().zip(next.by_ref()) {
        set(vertex, normal);
    }
    for patch in &mut mesh.patches {
        for (k, normal) in PATCH_LOOP.into_iter().zip(next.by_ref()) {
            set(&mut patch[k], normal);
        }
    }
    let all = normals.into_iter().map(|n| n.unwrap_or(Vec3::Z)).chain(added.iter().map(|a| a.1));
    mesh.normals = all.map(|n| n.to_array()).collect();
    fn copy<T: Copy>(values: &mut Vec<T>, width: usize, added: &[(u32, Vec3)]) {
        if !values.is_empty() {
            for (source, _) in added {
                let start = *source as usize * width;
                values.extend_from_within(start..start + width);
            }
        }
    }
    copy(&mut mesh.positions, 1, &added);
    copy(&mut mesh.uvs, 1, &added);
    copy(&mut mesh.tangents, 1, &added);
    for attribute in mesh.attributes.iter_mut().filter(|a| a.domain == Domain::Vertex) {
        copy(&mut attribute.data, attribute.channels, &added);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tube of `n` flat sides with caps, of unit radius along z.
    fn tube(n: u32) -> Mesh {
        let mut mesh = Mesh::default();
        for z in [0.0, 2.0] {
            for k in 0..n {
                let (sin, cos) = (std::f32::consts::TAU * k as f32 / n as f32).sin_cos();
                mesh.positions.push([cos, sin, z]);
            }
        }
        mesh.positions.extend([[0.0, 0.0, 0.0], [0.0, 0.0, 2.0]]);
        for k in 0..n {
            let l = (k + 1) % n;
            mesh.triangles.extend([[k, l, n + k], [l, n + l, n + k], [2 * n, l, k], [2 * n + 1, n + k, n + l]]);
        }
        mesh
    }

    #[test]
    fn a_fine_tube_is_round_and_its_rims_stay_sharp() {
        let mut mesh = tube(24);
        smooth(&mut mesh, CREASE);
        mesh.validate().unwrap();
        assert_eq!((mesh.normals.len(), mesh.positions.len()), (98, 98), "the two rims are doubled");
        for (p, n) in mesh.positions.iter().zip(&mesh.normals) {
            let (p, n) = (Vec3::from(*p), Vec3::from(*n));
            let radial = Vec3::new(p.x, p.y, 0.0).normalize_or_zero();
            assert!(n.z.abs() > 0.999 || n.dot(radial) > 0.999, "{p} {n}");
        }
    }

    /// 8 sides meet at 45°, 24 at 15°: beyond the crease angle the mesh is as it was.
    #[test]
    fn what_has_only_creases_stays_flat() {
        for (sides, crease) in [(8, CREASE), (24, 10.0), (24, 0.0)] {
            let mut mesh = tube(sides);
            let before = mesh.clone();
            smooth(&mut mesh, crease);
            assert_eq!(mesh, before);
            smooth(&mut mesh, 50.0);
            assert!(!mesh.normals.is_empty());
        }
    }

    /// Corners with texture coordinates of their own are apart in the file and together in space.
    #[test]
    fn seams_of_texture_coordinates_do_not_show() {
        let mut mesh = tube(24);
        let split: Vec<u32> = mesh.triangles.as_flattened().to_vec();
        mesh.positions = split.iter().map(|&v| mesh.positions[v as usize]).collect();
        mesh.uvs = split.iter().map(|&v| [v as f32, 0.0]).collect();
        mesh.triangles = (0..split.len() as u32 / 3).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
        smooth(&mut mesh, CREASE);
        mesh.validate().unwrap();
        assert_eq!(mesh.positions.len(), split.len(), "nothing shares a vertex, so nothing is doubled");
        let radial = mesh.normals.iter().zip(&mesh.positions).filter(|(n, _)| n[2].abs() < 0.5);
        for (n, p) in radial {
            assert!(n[0] * p[0] + n[1] * p[1] > 0.999, "{n:?} {p:?}");
        }
    }

    /// A fan of many triangles about one vertex takes no time that grows with their square.
    #[test]
    fn a_vertex_may_have_many_faces() {
        let n = 200_000;
        let mut mesh = Mesh { positions: vec![[0.0, 0.0, 0.5]], ..Mesh::default() };
        for k in 0..n {
            let (sin, cos) = (std::f32::consts::TAU * k as f32 / n as f32).sin_cos();
            mesh.positions.push([cos, sin, 0.0]);
            mesh.triangles.push([0, 1 + k, 1 + (k + 1) % n]);
        }
        smooth(&mut mesh, CREASE);
        mesh.validate().unwrap();
        assert!(mesh.normals[0][2] > 0.999);
    }
}
