//! Displacement of meshes: triangles are split until their edges are short, then vertices are moved: `d* = d + h m`.
//!
//! Whether an edge is split depends on its ends alone, and vertices that share a place move together, so no cracks
//! open: not within a mesh, not at seams of its parametrisation.

use std::collections::HashMap;
use steradian_math::{Vec2, Vec3};
use steradian_scene::{Domain, Mesh};

/// A vertex that is moved.
#[derive(Clone, Copy, Debug)]
pub struct Vertex {
    /// Position.
    pub p: Vec3,
    /// Unit normal there.
    pub n: Vec3,
    /// Texture coordinates.
    pub uv: Vec2,
    /// Unit tangent along u; any where there is no parametrisation.
    pub t: Vec3,
}

/// Too many triangles would be needed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("to split its edges as asked for would take more than {0} triangles")]
pub struct TooFine(pub usize);

/// Triangles that a displaced mesh may have.
pub const MAX_TRIANGLES: usize = 1 << 22;

/// Halvings of an edge at most.
const MAX_LEVELS: u32 = 24;

/// A mesh of triangles (patches are cut in two) whose edges are no longer than one by `length`, and moved by `offset`.
/// Normals are those of the moved surface.
///
/// # Errors
/// Where that takes more than `most` triangles.
pub fn displace(
    mesh: &Mesh,
    most: usize,
    length: impl Fn(Vec3, Vec3) -> f32,
    offset: impl Fn(&Vertex) -> Vec3,
) -> Result<Mesh, TooFine> {
    let mut fine = triangulated(mesh);
    if least_triangles(&fine, &length) > most as f64 {
        return Err(TooFine(most));
    }
    // Parents, for values per face.
    let mut faces: Vec<u32> = (0..mesh.triangles.len() as u32).collect();
    faces.extend((0..mesh.patches.len() as u32).flat_map(|i| [i + mesh.triangles.len() as u32; 2]));
    for _ in 0..MAX_LEVELS {
        if !split(&mut fine, &mut faces, most, &length)? {
            break;
        }
    }
    for (a, source) in fine.attributes.iter_mut().zip(&mesh.attributes) {
        if a.domain == Domain::Face {
            let c = source.channels;
            a.data = faces.iter().flat_map(|&f| source.data[f as usize * c..(f as usize + 1) * c].to_vec()).collect();
        }
    }
    move_vertices(&mut fine, &offset);
    Ok(fine)
}

/// Fewer triangles than this will not do: each has about half the product of the lengths of two of its edges. Known
/// before anything is split.
fn least_triangles(m: &Mesh, length: &impl Fn(Vec3, Vec3) -> f32) -> f64 {
    let one = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|i| Vec3::from(m.positions[i as usize]));
        let mut l =
            [length(a, b), length(b, c), length(c, a)].map(|l| f64::from(if l.is_nan() { f32::MAX } else { l }));
        l.sort_by(f64::total_cmp);
        // Long thin triangles are split along their length alone; lengths may vary over the triangle.
        0.1 * l[0].max(1.0) * l[1].max(1.0)
    };
    m.triangles.iter().map(one).sum()
}

fn triangulated(mesh: &Mesh) -> Mesh {
    let mut m = mesh.clone();
    m.triangles.extend(mesh.patches.iter().flat_map(|&[a, b, c, d]| [[a, b, d], [a, d, c]]));
    m.patches.clear();
    m
}

/// Splits every edge that is too long in the middle; whether there was one.
fn split(
    m: &mut Mesh,
    faces: &mut Vec<u32>,
    most: usize,
    length: &impl Fn(Vec3, Vec3) -> f32,
) -> Result<bool, TooFine> {
    let mut middles: HashMap<[u32; 2], Option<u32>> = HashMap::new();
    let mut triangles = Vec::with_capacity(m.triangles.len());
    let mut parents = Vec::with_capacity(m.triangles.len());
    let mut any = false;
    for (t, &face) in m.triangles.clone().iter().zip(faces.iter()) {
        let mid = [0, 1, 2].map(|k| middle(m, &mut middles, t[k], t[(k + 1) % 3], length));
        let cut: Vec<usize> = (0..3).filter(|&k| mid[k].is_some()).collect();
        any |= !cut.is_empty();
        let before = triangles.len();
        // Turned so that the cut edges come first.
        let turned = |k: usize| ([t[k], t[(k + 1) % 3], t[(k + 2) % 3]], [mid[k], mid[(k + 1) % 3], mid[(k + 2) % 3]]);
        match cut.len() {
            0 => triangles.push(*t),
            1 => {
                let ([a, b, c], [ab, ..]) = turned(cut[0]);
                let ab = ab.unwrap_or(a);
                triangles.extend([[a, ab, c], [ab, b, c]]);
            }
            2 => {
                let uncut = (0..3).find(|&k| mid[k].is_none()).unwrap_or(0);
                let ([a, b, c], [ab, bc, _]) = turned((uncut + 1) % 3);
                let (ab, bc) = (ab.unwrap_or(a), bc.unwrap_or(b));
                triangles.extend([[ab, b, bc], [a, ab, bc], [a, bc, c]]);
            }
            _ => {
                let ([a, b, c], [ab, bc, ca]) = turned(0);
                let (ab, bc, ca) = (ab.unwrap_or(a), bc.unwrap_or(b), ca.unwrap_or(c));
                triangles.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
            }
        }
        parents.extend(std::iter::repeat_n(face, triangles.len() - before));
        if triangles.len() > most {
            return Err(TooFine(most));
        }
    }
    m.triangles = triangles.into();
    *faces = parents;
    Ok(any)
}

/// The vertex in the middle of an edge that is too long.
fn middle(
    m: &mut Mesh,
    known: &mut HashMap<[u32; 2], Option<u32>>,
    a: u32,
    b: u32,
    length: &impl Fn(Vec3, Vec3) -> f32,
) -> Option<u32> {
    let key = [a.min(b), a.max(b)];
    if let Some(&v) = known.get(&key) {
        return v;
    }
    let [i, j] = key.map(|k| k as usize);
    let (p, q) = (Vec3::from(m.positions[i]), Vec3::from(m.positions[j]));
    // The same whichever way the edge is walked, and for other vertices at the same places.
    let (from, to) = if (p.x, p.y, p.z) <= (q.x, q.y, q.z) { (p, q) } else { (q, p) };
    let v = (length(from, to) > 1.0).then(|| {
        let half3 = |a: [f32; 3], b: [f32; 3]| ((Vec3::from(a) + Vec3::from(b)) * 0.5).to_array();
        m.positions.push(((from + to) * 0.5).to_array());
        if !m.normals.is_empty() {
            let n = half3(m.normals[i], m.normals[j]);
            m.normals.push(Vec3::from(n).normalize_or(Vec3::from(m.normals[i])).to_array());
        }
        if !m.uvs.is_empty() {
            let uv = (Vec2::from(m.uvs[i]) + Vec2::from(m.uvs[j])) * 0.5;
            m.uvs.push(uv.to_array());
        }
        if !m.tangents.is_empty() {
            m.tangents.push(half3(m.tangents[i], m.tangents[j]));
        }
        for a in m.attributes.iter_mut().filter(|a| a.domain == Domain::Vertex) {
            for k in 0..a.channels {
                a.data.push((a.data[i * a.channels + k] + a.data[j * a.channels + k]) * 0.5);
            }
        }
        m.positions.len() as u32 - 1
    });
    known.insert(key, v);
    v
}

/// For each vertex, the first that has the same place.
fn places(m: &Mesh) -> Vec<u32> {
    let mut first: HashMap<[u32; 3], u32> = HashMap::new();
    // Zero has two signs.
    let key = |p: [f32; 3]| p.map(|v| (v + 0.0).to_bits());
    m.positions.iter().enumerate().map(|(i, p)| *first.entry(key(*p)).or_insert(i as u32)).collect()
}

fn move_vertices(m: &mut Mesh, offset: &impl Fn(&Vertex) -> Vec3) {
    let n = m.positions.len();
    let place = places(m);
    let (mut face_normals, mut tangents) = (vec![Vec3::ZERO; n], vec![Vec3::ZERO; n]);
    add_normals(m, &place, &mut face_normals);
    for t in &m.triangles {
        let [a, b, c] = t.map(|i| i as usize);
        let uv = |i: usize| m.uvs.get(i).copied().map_or(Vec2::ZERO, Vec2::from);
        let (e1, e2) = (
            Vec3::from(m.positions[b]) - Vec3::from(m.positions[a]),
            Vec3::from(m.positions[c]) - Vec3::from(m.positions[a]),
        );
        let (d1, d2) = (uv(b) - uv(a), uv(c) - uv(a));
        let det = d1.perp_dot(d2);
        let t = (e1 * d2.y - e2 * d1.y) * det.signum();
        if det != 0.0 {
            [a, b, c].into_iter().for_each(|i| tangents[i] += t.normalize_or_zero());
        }
    }
    // Vertices of one place move by their mean.
    let (mut sum, mut count) = (vec![Vec3::ZERO; n], vec![0_u32; n]);
    for i in 0..n {
        let given = m.normals.get(i).map_or(Vec3::ZERO, |n| Vec3::from(*n));
        let normal = given.normalize_or(face_normals[place[i] as usize].normalize_or(Vec3::Z));
        let tangent = tangents[i] - normal * normal.dot(tangents[i]);
        let v = Vertex {
            p: Vec3::from(m.positions[i]),
            n: normal,
            uv: m.uvs.get(i).copied().map_or(Vec2::ZERO, Vec2::from),
            t: tangent.normalize_or(normal.any_orthonormal_vector()),
        };
        let d = offset(&v);
        if d.is_finite() {
            sum[place[i] as usize] += d;
        }
        count[place[i] as usize] += 1;
    }
    for (p, &k) in m.positions.iter_mut().zip(&place) {
        let k = k as usize;
        *p = (Vec3::from(*p) + sum[k] / count[k] as f32).to_array();
    }
    if !m.normals.is_empty() {
        // Smooth where it was smooth: over all faces that share the place and nearly the normal.
        let mut moved = vec![Vec3::ZERO; n];
        add_normals(m, &place, &mut moved);
        let mut own = vec![Vec3::ZERO; n];
        add_normals(m, &(0..n as u32).collect::<Vec<_>>(), &mut own);
        for i in 0..n {
            let (k, old) = (place[i] as usize, Vec3::from(m.normals[i]).normalize_or_zero());
            let is_smooth = old.dot(Vec3::from(m.normals[k]).normalize_or_zero()) > 0.999;
            let new = if is_smooth { moved[k] } else { own[i] }.normalize_or(old);
            // Triangles may be wound against their normals.
            let turned = face_normals[k].dot(old) < 0.0;
            m.normals[i] = (if turned { -new } else { new }).to_array();
        }
    }
    m.tangents.clear();
}

/// Adds the normals of triangles, by area, to the vertices that stand for their corners.
fn add_normals(m: &Mesh, stands_for: &[u32], sums: &mut [Vec3]) {
    for t in &m.triangles {
        let [a, b, c] = t.map(|i| Vec3::from(m.positions[i as usize]));
        let n = (b - a).cross(c - a);
        t.iter().for_each(|&i| sums[stands_for[i as usize] as usize] += n);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sphere() -> Mesh {
        // An octahedron's corners, as normals too.
        let p: Vec<[f32; 3]> = [Vec3::X, Vec3::Y, Vec3::Z, -Vec3::X, -Vec3::Y, -Vec3::Z].map(|v| v.to_array()).into();
        let triangles = vec![[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]];
        Mesh { positions: p.clone(), normals: p, triangles: triangles.into(), ..Mesh::default() }
    }

    fn edges_are_closed(m: &Mesh) {
        let place = places(m);
        let mut count: HashMap<[u32; 2], i32> = HashMap::new();
        for t in &m.triangles {
            for k in 0..3 {
                let (a, b) = (place[t[k] as usize], place[t[(k + 1) % 3] as usize]);
                *count.entry([a.min(b), a.max(b)]).or_default() += if a < b { 1 } else { -1 };
            }
        }
        assert!(count.values().all(|c| *c == 0), "a crack");
    }

    #[test]
    fn a_sphere_and_a_constant_are_a_larger_sphere() {
        let by = |a: Vec3, b: Vec3| (a - b).length() / 0.1;
        // First onto the sphere, then out by a half.
        let round = displace(&sphere(), 1 << 20, by, |v| v.p.normalize() - v.p).unwrap();
        edges_are_closed(&round);
        let out = displace(&round, 1 << 20, |_, _| 0.0, |v| v.n * 0.5).unwrap();
        assert!(out.triangles.len() > 1000);
        for (p, n) in out.positions.iter().zip(&out.normals) {
            let (p, n) = (Vec3::from(*p), Vec3::from(*n));
            // Normals are means over facets a tenth wide: off by the square of that.
            assert!((p.length() - 1.5).abs() < 2e-3 && n.dot(p.normalize()) > 0.999, "{p} {n}");
        }
    }

    #[test]
    fn seams_do_not_open() {
        // Two triangles with coordinates of their own, moved by a function of these.
        let p = |x: f32, y: f32| [x, y, 0.0];
        let m = Mesh {
            positions: vec![p(0., 0.), p(1., 0.), p(1., 1.), p(0., 0.), p(1., 1.), p(0., 1.)],
            uvs: vec![[0., 0.], [1., 0.], [1., 1.], [5., 0.], [6., 1.], [5., 1.]],
            triangles: vec![[0, 1, 2], [3, 4, 5]].into(),
            ..Mesh::default()
        };
        let fine = displace(&m, 10_000, |a, b| (a - b).length() / 0.2, |v| v.n * (v.uv.x * 3.0).sin()).unwrap();
        let at = |i: usize| fine.positions[i];
        assert_eq!((at(0), at(2)), (at(3), at(4)));
        let inner: Vec<Vec3> = fine.positions.iter().map(|p| Vec3::from(*p)).filter(|p| p.x == p.y).collect();
        assert!(inner.len() >= 18);
        for a in &inner {
            assert!(inner.iter().filter(|b| b.truncate() == a.truncate()).all(|b| b == a));
        }
    }

    #[test]
    fn splitting_follows_the_edges_that_are_long() {
        // Fine at one end only.
        let by = |a: Vec3, b: Vec3| (a - b).length() / (0.05 + 0.3 * a.x.min(b.x).max(0.0));
        let quad = Mesh {
            positions: vec![[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [1., 1., 0.]],
            patches: vec![[0, 1, 2, 3]],
            attributes: vec![steradian_scene::Attribute {
                name: "c".into(),
                domain: Domain::Face,
                channels: 1,
                data: vec![7.0],
            }],
            ..Mesh::default()
        };
        let fine = displace(&quad, 100_000, by, |_| Vec3::ZERO).unwrap();
        fine.validate().unwrap();
        assert!(
            fine.attributes[0].data.iter().all(|v| *v == 7.0) && fine.attributes[0].data.len() == fine.triangles.len()
        );
        let within = |low: f32, high: f32| fine.positions.iter().filter(|p| p[0] >= low && p[0] < high).count();
        assert!(within(0.0, 0.25) > 3 * within(0.75, 1.01), "{} {}", within(0.0, 0.25), within(0.75, 1.01));
        let area: f32 = fine
            .triangles
            .iter()
            .map(|t| {
                let [a, b, c] = t.map(|i| Vec3::from(fine.positions[i as usize]));
                0.5 * (b - a).cross(c - a).z
            })
            .sum();
        assert!((area - 1.0).abs() < 1e-5);
        assert_eq!(displace(&quad, 100, |_, _| 2.0, |_| Vec3::ZERO).unwrap_err(), TooFine(100));
    }
}
