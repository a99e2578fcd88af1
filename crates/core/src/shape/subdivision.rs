//! Loop subdivision: the smooth limit surface of a triangle mesh (Loop 1987; weights of Warren and Hoppe et al. 1994;
//! Pharr, Jakob, Humphreys, PBR 3rd ed., 3.8).
//!
//! The mesh is kept as half-edges without explicit links: half-edge `3 f + j` leaves corner `j` of face `f` for corner
//! `j + 1`, so that refinement is arithmetic on indices (Dupuy and Vanhoey, "A Halfedge Refinement Rule for Parallel
//! Loop Subdivision", 2022).

use rayon::prelude::*;
use std::{
    collections::{HashMap, hash_map::Entry},
    f32::consts::{PI, TAU},
};
use steradian_math::Vec3;
use steradian_scene::Mesh;

/// Most triangles a subdivided mesh may have.
pub const MAX_TRIANGLES: u64 = 1 << 25;

/// Marks a half-edge without twin: a boundary.
const NONE: u32 = u32::MAX;

/// Subdivides the triangles of a mesh `levels` times and moves the vertices onto the limit surface.
///
/// Boundaries become the cubic B-splines of their vertices. The result has positions, triangles and limit normals
/// (which are zero where the surface has none). As in pbrt normals point to the side from which triangles wind
/// clockwise. Triangles with a repeated vertex and vertices without triangles are left out; a vertex where several fans
/// of triangles touch is one vertex for each fan. Vertices of the mesh come first, in their order.
///
/// # Errors
/// A message, where the mesh is not valid ([`Mesh::validate`]), holds patches, would grow beyond [`MAX_TRIANGLES`], or
/// is not a manifold with consistent winding.
pub fn loop_subdivide(mesh: &Mesh, levels: u32) -> Result<Mesh, String> {
    mesh.validate().map_err(|fault| fault.to_string())?;
    if !mesh.patches.is_empty() {
        return Err("only triangles can be subdivided by Loop's rules, not bilinear patches".into());
    }
    let count = 4u64.checked_pow(levels).and_then(|n| n.checked_mul(mesh.triangles.len() as u64));
    if count.is_none_or(|n| n > MAX_TRIANGLES) && !mesh.triangles.is_empty() {
        return Err(format!(
            "{levels} levels of subdivision of {} triangles are too many: at most {MAX_TRIANGLES} triangles may result",
            mesh.triangles.len()
        ));
    }
    let mut surface = HalfEdges::new(mesh)?;
    if !mesh.triangles.is_empty() {
        for _ in 0..levels {
            surface = surface.refine();
        }
    }
    Ok(surface.limit())
}

/// The next half-edge of the same face.
#[inline]
fn next(h: u32) -> u32 {
    if h % 3 == 2 { h - 2 } else { h + 1 }
}

/// The previous half-edge of the same face.
#[inline]
fn prev(h: u32) -> u32 {
    if h.is_multiple_of(3) { h + 2 } else { h - 1 }
}

/// The half-edges that leave a vertex, counter-clockwise from one of them up to a boundary or once around.
#[inline]
fn fan(twin: &[u32], start: u32) -> impl Iterator<Item = u32> {
    std::iter::successors(Some(start), move |&h| {
        let onward = twin[prev(h) as usize];
        (onward != NONE && onward != start).then_some(onward)
    })
}

/// A triangle mesh with its connectivity.
struct HalfEdges {
    /// The vertex each half-edge leaves.
    from: Vec<u32>,
    /// The half-edge that runs the other way, or [`NONE`].
    twin: Vec<u32>,
    positions: Vec<Vec3>,
    /// A half-edge that leaves the vertex: on a boundary the one that runs along it.
    leaving: Vec<u32>,
}

impl HalfEdges {
    fn new(mesh: &Mesh) -> Result<Self, String> {
        let mut from: Vec<u32> =
            mesh.triangles.iter().filter(|[a, b, c]| a != b && b != c && a != c).flatten().copied().collect();

        // Two half-edges that run along each other in opposite directions are twins; no two may run in the same
        // direction.
        let mut twin = vec![NONE; from.len()];
        let mut by_ends = HashMap::with_capacity(from.len());
        for h in 0..from.len() as u32 {
            let (a, b) = (from[h as usize], from[next(h) as usize]);
            match by_ends.entry((a, b)) {
                Entry::Vacant(entry) => entry.insert(h),
                Entry::Occupied(_) => {
                    return Err(format!(
                        "the edge from vertex {a} to vertex {b} occurs in more than one triangle in this direction: the mesh is not \
                         a manifold, or its triangles are not wound consistently"
                    ));
                }
            };
            if let Some(&other) = by_ends.get(&(b, a)) {
                twin[h as usize] = other;
                twin[other as usize] = h;
            }
        }
        drop(by_ends);

        // Every fan of triangles around a vertex gets a vertex of its own, which drops vertices without triangles too.
        // Walks start on a boundary where there is one, so that they see the whole fan.
        let mut seen = vec![false; from.len()];
        let mut leaving = Vec::with_capacity(mesh.positions.len());
        let half_edges = 0..from.len() as u32;
        for start in half_edges.clone().filter(|&h| twin[h as usize] == NONE).chain(half_edges) {
            if !seen[start as usize] {
                leaving.push(start);
                fan(&twin, start).for_each(|h| seen[h as usize] = true);
            }
        }
        leaving.sort_by_key(|&h| from[h as usize]);
        let positions = leaving.iter().map(|&h| Vec3::from(mesh.positions[from[h as usize] as usize])).collect();
        for (vertex, &start) in leaving.iter().enumerate() {
            fan(&twin, start).for_each(|h| from[h as usize] = vertex as u32);
        }
        Ok(Self { from, twin, positions, leaving })
    }

    #[inline]
    fn is_boundary(&self, vertex: usize) -> bool {
        self.twin[self.leaving[vertex] as usize] == NONE
    }

    /// Positions of the neighbours of a vertex, counter-clockwise; on a boundary from one boundary neighbour to the
    /// other.
    fn ring(&self, vertex: usize) -> impl Iterator<Item = Vec3> {
        let at = |h: u32| self.positions[self.from[h as usize] as usize];
        let start = self.leaving[vertex];
        let first = self.is_boundary(vertex).then(|| at(next(start)));
        first.into_iter().chain(fan(&self.twin, start).map(move |h| at(prev(h))))
    }

    /// The two neighbours along the boundary of a boundary vertex.
    fn boundary_neighbours(&self, vertex: usize) -> [Vec3; 2] {
        let mut ring = self.ring(vertex);
        let first = ring.next().unwrap_or(self.positions[vertex]);
        [first, ring.last().unwrap_or(first)]
    }

    /// A vertex with the weight `weight(valence)` for each neighbour, or `boundary` for its two neighbours on a
    /// boundary, and the rest for itself.
    fn smooth(&self, vertex: usize, weight: impl Fn(f32) -> f32, boundary: f32) -> Vec3 {
        let p = self.positions[vertex];
        if self.is_boundary(vertex) {
            let [a, b] = self.boundary_neighbours(vertex);
            return p * (1.0 - 2.0 * boundary) + (a + b) * boundary;
        }
        let (sum, valence) = self.ring(vertex).fold((Vec3::ZERO, 0.0), |(sum, n), q| (sum + q, n + 1.0));
        let w = weight(valence);
        p * (1.0 - valence * w) + sum * w
    }

    /// Splits every triangle into four.
    fn refine(&self) -> Self {
        let half_edges = self.from.len() as u32;
        let old = self.positions.len();

        // Old vertices move.
        let mut positions: Vec<Vec3> =
            (0..old).into_par_iter().map(|v| self.smooth(v, even_weight, 1.0 / 8.0)).collect();
        // Child j of face f keeps the old corner j as its own corner j; child 3 is the middle one.
        let child = |h: u32, j: u32| 3 * (4 * (h / 3) + j);
        let corner = |h: u32| child(h, h % 3) + h % 3;
        let mut leaving: Vec<u32> = self.leaving.iter().map(|&h| corner(h)).collect();

        // Every edge gets a new vertex; the lower of two twins makes it.
        let mut middle = vec![NONE; half_edges as usize];
        for h in 0..half_edges {
            let twin = self.twin[h as usize];
            if twin < h {
                middle[h as usize] = middle[twin as usize];
                continue;
            }
            middle[h as usize] = positions.len() as u32;
            let at = |h: u32| self.positions[self.from[h as usize] as usize];
            let ends = at(h) + at(next(h));
            positions.push(match twin {
                NONE => ends * 0.5,
                _ => ends * (3.0 / 8.0) + (at(prev(h)) + at(prev(twin))) * (1.0 / 8.0),
            });
            // The second half of the old half-edge, in the child at its end.
            leaving.push(child(h, next(h) % 3) + h % 3);
        }

        let (mut from, mut twin) = (vec![0; 4 * half_edges as usize], vec![NONE; 4 * half_edges as usize]);
        for h in 0..half_edges {
            let (n, p) = (next(h), prev(h));
            let first = child(h, h % 3);
            let inner = child(h, 3);
            // The child at the corner: from the old vertex along this edge, across, and back along the previous one.
            let [along, across, back] = [first + h % 3, first + n % 3, first + p % 3];
            from[along as usize] = self.from[h as usize];
            from[across as usize] = middle[h as usize];
            from[back as usize] = middle[p as usize];
            from[(inner + h % 3) as usize] = middle[h as usize];
            twin[across as usize] = inner + p % 3;
            twin[(inner + p % 3) as usize] = across;
            let other = self.twin[h as usize];
            if other != NONE {
                // Our first half is the other's second: the half-edge that comes back to the corner where it ends.
                let end = next(other);
                twin[along as usize] = child(end, end % 3) + other % 3;
            }
            let other = self.twin[p as usize];
            if other != NONE {
                twin[back as usize] = corner(other);
            }
        }
        Self { from, twin, positions, leaving }
    }

    /// Moves every vertex to its limit, and finds the normal there.
    fn limit(mut self) -> Mesh {
        let vertices = self.positions.len();
        self.positions = (0..vertices).into_par_iter().map(|v| self.smooth(v, limit_weight, 1.0 / 5.0)).collect();
        let normals = (0..vertices).into_par_iter().map(|v| self.normal(v).to_array()).collect();
        Mesh {
            positions: self.positions.iter().map(Vec3::to_array).collect(),
            normals,
            triangles: self.from.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect(),
            ..Mesh::default()
        }
    }

    /// The normal from two tangents that are weighted sums of the neighbours.
    fn normal(&self, vertex: usize) -> Vec3 {
        let valence = self.ring(vertex).count();
        let p = self.positions[vertex];
        if !self.is_boundary(vertex) {
            let mut tangents = [Vec3::ZERO; 2];
            for (j, q) in self.ring(vertex).enumerate() {
                let (sin, cos) = (TAU * j as f32 / valence as f32).sin_cos();
                // Relative to the vertex: the weights sum to zero.
                tangents[0] += (q - p) * cos;
                tangents[1] += (q - p) * sin;
            }
            return tangents[1].cross(tangents[0]).normalize_or_zero();
        }
        let [first, last] = self.boundary_neighbours(vertex);
        let along = last - first;
        // Into the surface.
        let inward = match valence {
            2 => first + last - p * 2.0,
            3 => self.ring(vertex).nth(1).unwrap_or(p) - p,
            _ => {
                let theta = PI / (valence - 1) as f32;
                let (sin, cos) = theta.sin_cos();
                let mut sum = (first + last - p * 2.0) * -sin;
                for (k, q) in self.ring(vertex).enumerate().skip(1).take(valence - 2) {
                    sum += (q - p) * ((2.0 - 2.0 * cos) * (k as f32 * theta).sin());
                }
                sum
            }
        };
        along.cross(inward).normalize_or_zero()
    }
}

/// Weight of each neighbour of an old vertex.
fn even_weight(valence: f32) -> f32 {
    if valence == 3.0 { 3.0 / 16.0 } else { 3.0 / (8.0 * valence) }
}

/// Weight of each neighbour in the limit position of a vertex.
fn limit_weight(valence: f32) -> f32 {
    1.0 / (valence + 3.0 / (8.0 * even_weight(valence)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use steradian_math::hash::HashRng;

    fn mesh(positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> Mesh {
        Mesh { positions: positions.to_vec(), triangles: triangles.to_vec().into(), ..Mesh::default() }
    }

    const TETRAHEDRON: [[f32; 3]; 4] = [[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]];
    /// Wound counter-clockwise seen from outside.
    const TETRAHEDRON_FACES: [[u32; 3]; 4] = [[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]];

    fn icosahedron() -> Mesh {
        let g = 1.618_034_f32;
        let mut positions = Vec::new();
        for (a, b) in [(1.0, g), (-1.0, g), (1.0, -g), (-1.0, -g)] {
            positions.extend([[0.0, a, b], [a, b, 0.0], [b, 0.0, a]]);
        }
        let p: Vec<Vec3> = positions.iter().map(|&p| Vec3::from(p)).collect();
        let near = |a: usize, b: usize| (p[a].distance(p[b]) - 2.0).abs() < 1e-3;
        let mut triangles = Vec::new();
        for a in 0..12 {
            for b in 0..12 {
                for c in 0..12 {
                    let outward = (p[b] - p[a]).cross(p[c] - p[a]).dot(p[a]) > 0.0;
                    if a < b && a < c && near(a, b) && near(b, c) && near(a, c) && outward {
                        triangles.push([a as u32, b as u32, c as u32]);
                    }
                }
            }
        }
        mesh(&positions, &triangles)
    }

    fn corners(mesh: &Mesh) -> impl Iterator<Item = [Vec3; 3]> {
        mesh.triangles.iter().map(|t| t.map(|i| Vec3::from(mesh.positions[i as usize])))
    }

    fn volume(mesh: &Mesh) -> f32 {
        corners(mesh).map(|[a, b, c]| a.cross(b).dot(c) / 6.0).sum()
    }

    #[test]
    fn closed_meshes_shrink_and_stay_closed() {
        for (base, vertices) in [(mesh(&TETRAHEDRON, &TETRAHEDRON_FACES), 4), (icosahedron(), 12)] {
            let faces = base.triangles.len();
            assert_eq!(base.positions.len(), vertices);
            let mut last = volume(&base);
            assert!(last > 0.0);
            for levels in 0..5 {
                let fine = loop_subdivide(&base, levels).unwrap();
                fine.validate().unwrap();
                assert_eq!(fine.triangles.len(), faces << (2 * levels));
                // Euler's formula, V − E + F = 2.
                assert_eq!(fine.positions.len(), fine.triangles.len() / 2 + 2);
                let connectivity = HalfEdges::new(&fine).unwrap();
                assert!(connectivity.twin.iter().all(|&h| h != NONE));
                for h in 0..connectivity.twin.len() {
                    assert_eq!(connectivity.twin[connectivity.twin[h] as usize], h as u32);
                }
                if levels > 0 {
                    // Inscribed in a convex limit surface, volumes grow towards that of the limit, far below the base.
                    assert!(volume(&fine) < 0.7 * volume(&base));
                    assert!(volume(&fine) > last);
                }
                last = volume(&fine);
                for (p, n) in fine.positions.iter().zip(&fine.normals) {
                    let (p, n) = (Vec3::from(*p), Vec3::from(*n));
                    assert!((n.length() - 1.0).abs() < 1e-5);
                    // Counter-clockwise outside: as pbrt's, normals point inward.
                    assert!(n.dot(p.normalize()) < -0.8, "{p} {n}");
                }
            }
        }
    }

    #[test]
    fn limit_points_do_not_depend_on_the_level() {
        let base = icosahedron();
        let coarse = loop_subdivide(&base, 0).unwrap();
        // Known limit: (1 − 5γ) p + γ Σ neighbours, γ = 1/(5 + 3/(8·3/40)) = 1/10; neighbours of p sum to √5 p.
        for (p, q) in base.positions.iter().zip(&coarse.positions) {
            assert!((Vec3::from(*p) * (0.5 + 0.1 * 5.0_f32.sqrt()) - Vec3::from(*q)).length() < 1e-5);
        }
        for levels in 1..5 {
            let fine = loop_subdivide(&base, levels).unwrap();
            for v in 0..12 {
                assert!((Vec3::from(fine.positions[v]) - Vec3::from(coarse.positions[v])).length() < 1e-5);
                assert!((Vec3::from(fine.normals[v]) - Vec3::from(coarse.normals[v])).length() < 1e-3);
            }
        }
        // Limit normals are those of fine triangles.
        let fine = loop_subdivide(&base, 5).unwrap();
        for (t, [a, b, c]) in fine.triangles.iter().zip(corners(&fine)) {
            let n = (c - a).cross(b - a).normalize();
            assert!(t.iter().all(|&i| Vec3::from(fine.normals[i as usize]).dot(n) > 0.998));
        }
    }

    /// A square grid in z = 0, cut into triangles of which all inner vertices have valence 6.
    fn grid(n: u32) -> Mesh {
        let mut grid = Mesh::default();
        for j in 0..=n {
            grid.positions.extend((0..=n).map(|i| [i as f32, j as f32, 0.0]));
        }
        for j in 0..n {
            for i in 0..n {
                let a = j * (n + 1) + i;
                grid.triangles.extend([[a, a + 1, a + n + 2], [a, a + n + 2, a + n + 1]]);
            }
        }
        grid
    }

    #[test]
    fn regular_grids_stay_planar_and_boundaries_stay_boundaries() {
        let base = grid(5);
        for levels in 0..4 {
            let fine = loop_subdivide(&base, levels).unwrap();
            assert_eq!(fine.triangles.len(), base.triangles.len() << (2 * levels));
            let side = (5usize << levels) + 1;
            assert_eq!(fine.positions.len(), side * side);
            for (v, (p, n)) in fine.positions.iter().zip(&fine.normals).enumerate() {
                assert!(p[2] == 0.0 && p[0] >= 0.0 && p[0] <= 5.0 && p[1] >= 0.0 && p[1] <= 5.0);
                assert!((n[2] + 1.0).abs() < 1e-6, "{v} {n:?}");
            }
            assert!(corners(&fine).all(|[a, b, c]| (b - a).cross(c - a).z > 0.0));
        }
        // Regular vertices of the plane, away from the boundary, do not move at all.
        let coarse = loop_subdivide(&base, 0).unwrap();
        assert_eq!(coarse.positions[2 * 6 + 3], [3.0, 2.0, 0.0]);
        // Nor do those on straight parts of the boundary; corners are rounded off as by a cubic B-spline, (1, 3, 1)/5.
        assert!((Vec3::from(coarse.positions[3]) - Vec3::new(3.0, 0.0, 0.0)).length() < 1e-6);
        assert!((Vec3::from(coarse.positions[0]) - Vec3::new(0.2, 0.2, 0.0)).length() < 1e-6);
    }

    #[test]
    fn boundaries_do_not_depend_on_the_inside() {
        let flat = grid(3);
        let mut bumpy = flat.clone();
        for v in [5, 6, 9, 10] {
            bumpy.positions[v][2] = 2.0;
        }
        let (a, b) = (loop_subdivide(&flat, 3).unwrap(), loop_subdivide(&bumpy, 3).unwrap());
        let edges = HalfEdges::new(&b).unwrap();
        let mut boundary = 0;
        for (h, &twin) in edges.twin.iter().enumerate() {
            if twin == NONE {
                boundary += 1;
                let v = b.triangles[h / 3][h % 3] as usize;
                assert_eq!(a.positions[v], b.positions[v]);
            }
        }
        assert_eq!(boundary, (4 * 3) << 3);
        // Limit normals on the boundary agree with the triangles there.
        let mut sums = vec![Vec3::ZERO; b.positions.len()];
        for (t, [p, q, r]) in b.triangles.iter().zip(corners(&b)) {
            t.iter().for_each(|&i| sums[i as usize] += (r - p).cross(q - p).normalize());
        }
        for (n, sum) in b.normals.iter().zip(sums) {
            assert!(Vec3::from(*n).dot(sum.normalize()) > 0.95);
        }
    }

    #[test]
    fn odd_meshes_are_refused_or_repaired() {
        let error = |m: &Mesh, levels: u32| loop_subdivide(m, levels).unwrap_err();
        let p = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 1.0, 1.0]];
        // Three triangles on one edge, and two that wind against each other.
        assert!(error(&mesh(&p, &[[0, 1, 2], [1, 0, 3], [0, 1, 4]]), 1).contains("vertex 0 to vertex 1"));
        assert!(error(&mesh(&p, &[[0, 1, 2], [0, 1, 3]]), 1).contains("vertex 0 to vertex 1"));
        assert!(error(&mesh(&p, &[[0, 1, 9]]), 1).contains("refers to vertex 9"));
        let tetrahedron = mesh(&TETRAHEDRON, &TETRAHEDRON_FACES);
        assert!(error(&tetrahedron, 12).contains("12 levels"));
        assert!(error(&tetrahedron, u32::MAX).contains("too many"));
        let patch = Mesh { patches: vec![[0, 1, 2, 3]], ..tetrahedron.clone() };
        assert!(error(&patch, 1).contains("patches"));
        // Nothing in, nothing out, in no time.
        assert!(loop_subdivide(&mesh(&p, &[]), u32::MAX).unwrap().triangles.is_empty());
        assert!(loop_subdivide(&mesh(&p, &[[1, 1, 2]]), 3).unwrap().positions.is_empty());
        // A lone vertex is dropped; one where two triangles touch is split.
        let touching = loop_subdivide(&mesh(&p, &[[0, 1, 2], [0, 3, 4]]), 1).unwrap();
        assert_eq!((touching.triangles.len(), touching.positions.len()), (8, 12));
        // Two triangles back to back: closed, with valence 2.
        let flat = loop_subdivide(&mesh(&p, &[[0, 1, 2], [0, 2, 1]]), 2).unwrap();
        assert_eq!((flat.triangles.len(), flat.positions.len()), (32, 18));
        assert!(flat.validate().is_ok());
    }

    #[test]
    fn random_soups_never_panic() {
        let mut rng = HashRng::new(7);
        let mut draw = |n: u32| (rng.next_u64() % u64::from(n)) as u32;
        let (mut good, mut bad) = (0, 0);
        for _ in 0..3000 {
            let vertices = 3 + draw(12);
            let faces = 1 + draw(7);
            let positions: Vec<_> = (0..vertices).map(|_| [draw(5), draw(5), draw(5)].map(|x| x as f32)).collect();
            let triangles: Vec<_> = (0..faces).map(|_| [draw(vertices), draw(vertices), draw(vertices)]).collect();
            match loop_subdivide(&mesh(&positions, &triangles), 2) {
                Ok(fine) => {
                    good += 1;
                    fine.validate().unwrap();
                }
                Err(_) => bad += 1,
            }
        }
        assert!(good > 300 && bad > 100, "{good} {bad}");
    }
}
