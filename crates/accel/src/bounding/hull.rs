//! The convex hull by Quickhull (Barber, Dobkin, Huhdanpaa 1996).
//!
//! Points are moved to a lattice of 2²⁶ steps across their greatest extent, where determinants are exact in 128 bits.
//! So no face is ever wrong about its side, points in the plane of a face add nothing, and no face has zero area. The
//! planes of the result are then moved to where the points really are, so that all of them are inside.

use super::oriented::polygon;
use super::{ROUNDING, Volume, line};
use glam::DVec2;
use std::collections::HashMap;
use steradian_math::{Bounds3, DVec3, Vec3};

/// Steps of the lattice across the greatest extent.
const STEPS: f64 = 67_108_864.0;

type Point = [i64; 3];

/// A convex polytope. Its triangles share vertices; flat faces are several of them. Of points in a plane or on a line
/// it is flat.
#[derive(Clone, Debug, PartialEq)]
pub struct Hull {
    vertices: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    /// Outward unit normals and their greatest product with a point.
    planes: Vec<(DVec3, f64)>,
    /// Bound on the distance by which points may stick out of the triangles, though not of the planes, since points are
    /// moved to the lattice.
    error: f64,
}

impl Hull {
    /// Around points; `None` without any, or where one is not finite.
    pub fn around(points: &[Vec3]) -> Option<Self> {
        let bounds = Bounds3::from_points(points.iter().copied());
        if bounds.is_empty() || points.iter().any(|p| !p.is_finite()) {
            return None;
        }
        // Snap the points to the lattice, where all orientation tests are exact.
        let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        let step = (max - min).max_element() / STEPS;
        let on_lattice = |p: &Vec3| -> Point {
            let steps = if step > 0.0 { (p.as_dvec3() - min) / step } else { DVec3::ZERO };
            steps.to_array().map(|x| x.round() as i64)
        };
        let lattice: Vec<Point> = points.iter().map(on_lattice).collect();
        let (triangles, mut planes) = match simplex(&lattice) {
            Ok(simplex) => {
                let triangles = Quick::new(&lattice, simplex).run();
                let normal = |[a, b, c]: [usize; 3]| {
                    let n = cross(sub(lattice[b], lattice[a]), sub(lattice[c], lattice[a]));
                    DVec3::from_array(n.map(|x| x as f64)).normalize()
                };
                // Collect the planes; triangles of one flat face follow each other and share a normal.
                let mut planes: Vec<DVec3> = Vec::new();
                for &t in &triangles {
                    let n = normal(t);
                    if planes.last().is_none_or(|last| *last != n) {
                        planes.push(n);
                    }
                }
                (triangles, planes)
            }
            Err(found) => flat(points, &found),
        };
        planes.retain(|n| n.is_finite());
        let reach = |n: DVec3| (n, points.iter().map(|p| n.dot(p.as_dvec3())).fold(f64::NEG_INFINITY, f64::max));
        // Only the points that are vertices.
        let (mut vertices, mut numbers) = (Vec::new(), HashMap::new());
        let mut number = |i: usize| {
            *numbers.entry(i).or_insert_with(|| {
                vertices.push(points[i].as_dvec3());
                vertices.len() as u32 - 1
            })
        };
        let triangles: Vec<[u32; 3]> = triangles.into_iter().map(|t| t.map(&mut number)).collect();
        if vertices.is_empty() {
            // A line or a point: its ends.
            let along = if points.len() == 1 || step == 0.0 { 1 } else { 2 };
            let ends = planes
                .iter()
                .take(along)
                .filter_map(|n| points.iter().max_by(|a, b| n.dot(a.as_dvec3()).total_cmp(&n.dot(b.as_dvec3()))));
            for end in ends.map(|p| p.as_dvec3()) {
                if !vertices.contains(&end) {
                    vertices.push(end);
                }
            }
        }
        Some(Self {
            vertices,
            triangles,
            // Move each plane out to the farthest of the original points.
            planes: planes.into_iter().map(reach).collect(),
            error: step * 3.0_f64.sqrt(),
        })
    }

    /// The vertices.
    pub fn vertices(&self) -> &[DVec3] {
        &self.vertices
    }

    /// The faces, counter-clockwise as seen from outside; none for points on a line.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Bound on the distance by which points may stick out between the vertices: 2.6·10⁻⁸ of the greatest extent. None
    /// is outside the planes by which [`Volume::contains`] and [`Volume::intersect`] go.
    pub fn error(&self) -> f64 {
        self.error
    }

    /// Outward normals of the faces, no more than `most`, taken evenly.
    pub fn normals(&self, most: usize) -> impl Iterator<Item = DVec3> {
        self.planes.iter().step_by(self.planes.len().div_ceil(most.max(1)).max(1)).map(|plane| plane.0)
    }

    /// The interval that it covers in a direction.
    fn shadow(&self, d: DVec3) -> [f64; 2] {
        let heights = self.vertices.iter().map(|p| d.dot(*p));
        heights.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], h| [low.min(h), high.max(h)])
    }

    /// The directions of its edges, each once.
    fn edges(&self) -> Vec<DVec3> {
        let sides = |t: &[u32; 3]| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]];
        let once = self.triangles.iter().flat_map(sides).filter(|[a, b]| a < b);
        let edge = |[a, b]: [u32; 2]| self.vertices[b as usize] - self.vertices[a as usize];
        let mut edges: Vec<DVec3> = once.map(edge).collect();
        if let [a, b] = self.vertices[..] {
            edges.push(b - a);
        }
        edges
    }

    fn slack(&self) -> f64 {
        4.0 * ROUNDING * self.vertices.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max)
    }
}

impl Volume for Hull {
    fn contains(&self, p: DVec3) -> bool {
        let slack = self.slack();
        self.planes.iter().all(|(normal, reach)| normal.dot(p) <= reach + slack)
    }

    fn intersect(&self, origin: DVec3, direction: DVec3) -> Option<[f64; 2]> {
        let slack = self.slack() + ROUNDING * origin.abs().max_element();
        let mut t = line(origin, direction)?;
        for (normal, reach) in &self.planes {
            // Clip the line by each half-space: entering ones raise t₀, leaving ones lower t₁ (Cyrus and Beck 1978).
            let (above, along) = (normal.dot(origin) - reach - slack, normal.dot(direction));
            if along == 0.0 {
                if above > 0.0 {
                    return None;
                }
            } else if along > 0.0 {
                t[1] = t[1].min(-above / along);
            } else {
                t[0] = t[0].max(-above / along);
            }
        }
        (t[0] <= t[1]).then_some(t)
    }

    /// By all axes that may separate two polytopes: normals, and products of edges. Of hulls with many edges this is
    /// slow.
    fn overlaps(&self, other: &Self) -> bool {
        let slack = self.slack() + other.slack();
        let separates = |axis: DVec3| {
            let Some(axis) = axis.try_normalize() else { return false };
            let ([a, b], [c, d]) = (self.shadow(axis), other.shadow(axis));
            a > d + slack || c > b + slack
        };
        let others = other.edges();
        // Separating axes: face normals of both, and cross products of their edges.
        let products =
            self.edges().into_iter().flat_map(|a| others.iter().map(move |b| a.cross(*b)).collect::<Vec<_>>());
        !self.planes.iter().chain(&other.planes).map(|plane| plane.0).any(separates)
            && !products.into_iter().any(separates)
    }

    fn volume(&self) -> f64 {
        let Some(&o) = self.vertices.first() else { return 0.0 };
        // Sum signed tetrahedra over the faces: V = Σ a·(b × c)/6 with a vertex as the origin.
        let corner = |i: u32| self.vertices[i as usize] - o;
        self.triangles.iter().map(|&[a, b, c]| corner(a).dot(corner(b).cross(corner(c))) / 6.0).sum()
    }
}

fn sub(a: Point, b: Point) -> Point {
    std::array::from_fn(|i| a[i] - b[i])
}

/// Exact for differences of lattice points: components are below 2⁵⁶.
fn cross(a: Point, b: Point) -> Point {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn dot(a: Point, b: Point) -> i128 {
    (0..3).map(|i| i128::from(a[i]) * i128::from(b[i])).sum()
}

/// Four points that are not in a plane; else those that span what there is: one to three.
fn simplex(points: &[Point]) -> Result<[usize; 4], Vec<usize>> {
    let farthest = |measure: &dyn Fn(Point) -> i128| {
        let all = points.iter().enumerate().map(|(i, p)| (measure(*p), i));
        all.max_by(|a, b| a.0.cmp(&b.0).then(b.1.cmp(&a.1))).filter(|(m, _)| *m > 0).map(|(_, i)| i)
    };
    // Grow the simplex by the farthest point from a point, from a line and from a plane.
    let a = 0;
    let Some(b) = farthest(&|p| dot(sub(p, points[a]), sub(p, points[a]))) else { return Err(vec![a]) };
    let ab = sub(points[b], points[a]);
    // The length of the product, in one norm or another.
    let Some(c) = farthest(&|p| cross(ab, sub(p, points[a])).iter().map(|x| i128::from(x.abs())).sum()) else {
        return Err(vec![a, b]);
    };
    let n = cross(ab, sub(points[c], points[a]));
    let Some(d) = farthest(&|p| dot(n, sub(p, points[a])).abs()) else { return Err(vec![a, b, c]) };
    // Orient the base so that the fourth point lies behind it.
    Ok(if dot(n, sub(points[d], points[a])) < 0 { [a, b, c, d] } else { [a, c, b, d] })
}

/// Hull of points of a plane, a line, or one position: triangles and normals.
fn flat(points: &[Vec3], found: &[usize]) -> (Vec<[usize; 3]>, Vec<DVec3>) {
    let at = |i: usize| points[found[i]].as_dvec3();
    let both = |d: DVec3| [d, -d];
    match found.len() {
        1 => (Vec::new(), DVec3::AXES.into_iter().flat_map(both).collect()),
        2 => {
            let d = (at(1) - at(0)).normalize_or(DVec3::X);
            let u = d.any_orthonormal_vector();
            (Vec::new(), [d, u, d.cross(u)].into_iter().flat_map(both).collect())
        }
        _ => {
            let u = (at(1) - at(0)).normalize_or(DVec3::X);
            let n = u.cross(at(2) - at(0)).normalize_or(u.any_orthonormal_vector());
            let v = n.cross(u);
            // Project into the plane and take the hull there; both sides become fans of triangles.
            let shadow = |p: &Vec3| DVec2::new(u.dot(p.as_dvec3() - at(0)), v.dot(p.as_dvec3() - at(0)));
            let rim = polygon(&mut points.iter().map(shadow).collect());
            // The first point there.
            let number = |q: &DVec2| points.iter().position(|p| shadow(p) == *q).unwrap_or(found[0]);
            let corners: Vec<usize> = rim.iter().map(number).collect();
            let fan = (2..corners.len()).flat_map(|i| {
                let [a, b, c] = [corners[0], corners[i - 1], corners[i]];
                [[a, b, c], [a, c, b]]
            });
            // The rim contributes planes perpendicular to the polygon.
            let sides = (0..rim.len()).map(|i| {
                let d = rim[(i + 1) % rim.len()] - rim[i];
                (u * d.y - v * d.x).normalize_or(n)
            });
            (fan.collect(), both(n).into_iter().chain(sides).collect())
        }
    }
}

/// A face of a growing hull.
struct Face {
    corners: [usize; 3],
    /// The faces across the sides that begin at each corner.
    neighbors: [usize; 3],
    normal: Point,
    /// Points that are in front of it.
    outside: Vec<usize>,
    is_gone: bool,
}

/// Quickhull at work.
struct Quick<'a> {
    points: &'a [Point],
    faces: Vec<Face>,
}

impl<'a> Quick<'a> {
    /// With a tetrahedron whose first three points are counter-clockwise as seen from outside.
    fn new(points: &'a [Point], [a, b, c, d]: [usize; 4]) -> Self {
        let mut quick = Self { points, faces: Vec::new() };
        let corners = [[a, b, c], [a, d, b], [b, d, c], [c, d, a]];
        let neighbors = [[1, 2, 3], [3, 2, 0], [1, 3, 0], [2, 1, 0]];
        for (corners, neighbors) in corners.into_iter().zip(neighbors) {
            quick.add(corners, neighbors);
        }
        for i in 0..points.len() {
            quick.give(i, 0);
        }
        quick
    }

    fn add(&mut self, corners: [usize; 3], neighbors: [usize; 3]) {
        let [a, b, c] = corners.map(|i| self.points[i]);
        // Twice the face's area times its normal, in exact integers.
        let normal = cross(sub(b, a), sub(c, a));
        self.faces.push(Face { corners, neighbors, normal, outside: Vec::new(), is_gone: false });
    }

    /// Height of a point in front of a face, in units of the face's own.
    fn height(&self, face: usize, point: usize) -> i128 {
        let face = &self.faces[face];
        dot(face.normal, sub(self.points[point], self.points[face.corners[0]]))
    }

    /// Gives a point to the first of the faces from a number on that it is in front of.
    fn give(&mut self, point: usize, from: usize) {
        if let Some(face) = (from..self.faces.len()).find(|&face| self.height(face, point) > 0) {
            self.faces[face].outside.push(point);
        }
    }

    /// Grows until no point is outside.
    fn run(mut self) -> Vec<[usize; 3]> {
        let mut next = 0;
        while next < self.faces.len() {
            let face = &self.faces[next];
            let outside = if face.is_gone { &[][..] } else { &face.outside };
            // Take the farthest point in front of the face as the apex.
            let farthest =
                outside.iter().map(|&p| (self.height(next, p), p)).max_by(|a, b| a.0.cmp(&b.0).then(b.1.cmp(&a.1)));
            match farthest {
                Some((_, apex)) => self.grow(next, apex),
                None => next += 1,
            }
        }
        self.faces.iter().filter(|face| !face.is_gone).map(|face| face.corners).collect()
    }

    /// Replaces the faces that a point sees by a cone from the point to their rim.
    fn grow(&mut self, start: usize, apex: usize) {
        let mut seen = vec![start];
        let mut orphans = Vec::new();
        // Sides of the rim: from, to, and the face beyond.
        let mut rim: HashMap<usize, (usize, usize)> = HashMap::new();
        self.faces[start].is_gone = true;
        // Flood from the first face over all faces that the apex sees; their outer sides are the horizon.
        let mut i = 0;
        while i < seen.len() {
            let face = seen[i];
            i += 1;
            orphans.append(&mut self.faces[face].outside);
            for side in 0..3 {
                let beyond = self.faces[face].neighbors[side];
                if self.faces[beyond].is_gone {
                    continue;
                }
                if self.height(beyond, apex) > 0 {
                    self.faces[beyond].is_gone = true;
                    seen.push(beyond);
                } else {
                    let corners = self.faces[face].corners;
                    rim.insert(corners[side], (corners[(side + 1) % 3], beyond));
                }
            }
        }
        // Sides to faces that were seen later are none.
        rim.retain(|_, (_, beyond)| !self.faces[*beyond].is_gone);
        // Around the rim in one turn, from its smallest corner, so that nothing depends on the order of the map.
        let Some(&first) = rim.keys().min() else { return };
        let base = self.faces.len();
        let count = rim.len();
        let mut from = first;
        // Join every side of the horizon to the apex and link neighbours both ways.
        for k in 0..count {
            let Some(&(to, beyond)) = rim.get(&from) else { break };
            let (before, after) = (base + (k + count - 1) % count, base + (k + 1) % count);
            self.add([from, to, apex], [beyond, after, before]);
            let side = (0..3).find(|&s| self.faces[beyond].corners[s] == to).unwrap_or(0);
            self.faces[beyond].neighbors[side] = base + k;
            from = to;
        }
        // Redistribute the points of removed faces over the new ones.
        for point in orphans {
            if point != apex {
                self.give(point, base);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::{in_cube, soup};
    use steradian_math::hash::HashRng;

    #[test]
    fn a_lattice_in_a_cube_has_eight_vertices() {
        let n = 6;
        let at = |i: i32| i as f32 / n as f32;
        let points: Vec<Vec3> = (0..=n)
            .flat_map(|x| (0..=n).flat_map(move |y| (0..=n).map(move |z| Vec3::new(at(x), at(y), at(z)))))
            .collect();
        let hull = Hull::around(&points).expect("finite");
        assert_eq!((hull.vertices().len(), hull.triangles().len()), (8, 12));
        assert!((hull.volume() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn random_hulls_are_closed_and_convex() {
        let mut rng = HashRng::new(103);
        for round in 0..40 {
            let points: Vec<Vec3> = (0..5 + round * 20).map(|_| in_cube(&mut rng)).collect();
            // Some are rounded to few places, so that many are in one plane.
            let coarse = |p: &Vec3| (*p * 3.0).round();
            let points = if round % 2 == 0 { points } else { points.iter().map(coarse).collect() };
            let hull = Hull::around(&points).expect("finite");
            assert!(points.iter().all(|p| hull.contains(p.as_dvec3())));
            // Every side is shared by two faces, in both directions; and by Euler F = 2 V − 4.
            let mut sides = std::collections::HashSet::new();
            for t in hull.triangles() {
                for i in 0..3 {
                    assert!(sides.insert([t[i], t[(i + 1) % 3]]));
                }
            }
            assert!(sides.iter().all(|[a, b]| sides.contains(&[*b, *a])));
            assert_eq!(hull.triangles().len(), 2 * hull.vertices().len() - 4);
        }
    }

    #[test]
    fn flat_sets_have_flat_hulls() {
        let square = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::X + Vec3::Y, Vec3::new(0.5, 0.5, 0.0), Vec3::X * 0.5];
        let segment = [Vec3::ONE, Vec3::ONE * 3.0, Vec3::ONE * 2.0];
        for (points, vertices, faces, out) in [
            (&square[..], 4, 4, DVec3::new(0.5, 0.5, 0.1)),
            (&segment[..], 2, 0, DVec3::new(2.0, 2.0, 2.1)),
            (&[Vec3::X, Vec3::X][..], 1, 0, DVec3::new(1.0, 1e-3, 0.0)),
        ] {
            let hull = Hull::around(points).expect("finite");
            assert_eq!((hull.vertices().len(), hull.triangles().len()), (vertices, faces));
            assert!(points.iter().all(|p| hull.contains(p.as_dvec3())) && !hull.contains(out));
            assert!(hull.volume().abs() < 1e-12);
        }
        assert_eq!(Hull::around(&[]), None);
    }

    #[test]
    fn all_points_on_a_sphere_are_vertices() {
        let points: Vec<Vec3> = soup(300, 1.0, 104).0.iter().map(|p| p.normalize() * 5.0).collect();
        let hull = Hull::around(&points).expect("finite");
        assert!(hull.vertices().len() > 880, "{}", hull.vertices().len());
    }
}
