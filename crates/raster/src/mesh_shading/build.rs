//! Grows meshlets triangle by triangle.

use glam::{DVec3, Vec3};

use super::{
    adjacency::{Adjacency, distinct},
    bounds::{NormalCone, Sphere},
    meshlet::{Meshlet, MeshletLimits, Meshlets},
    spatial_order::SpatialOrder,
};

/// The most triangles around a cluster that are candidates for it.
const MOST_CANDIDATES: usize = 512;
/// Weight of the angle between normals against distance, from 0 to 1.
const NORMAL_WEIGHT: f64 = 0.25;
/// No vertex of the open cluster.
const OUTSIDE: u16 = u16::MAX;

/// Clusters a mesh whose indices and positions are checked.
pub(super) fn build(positions: &[Vec3], triangles: &[[u32; 3]], limits: MeshletLimits) -> Meshlets {
    let mut builder = Builder::new(positions, triangles, limits);
    let mut seed = builder.order.first();
    // Seed a cluster, grow it by the best candidate until nothing fits, close it and seed the next beside it.
    while let Some(first) = seed {
        let mut beside = builder.add(first);
        while let Some(next) = builder.best_candidate().or_else(|| builder.nearest_beside(beside)) {
            beside = builder.add(next);
        }
        seed = builder.close(beside);
    }
    builder.out
}

struct Builder<'a> {
    positions: &'a [Vec3],
    triangles: &'a [[u32; 3]],
    limits: MeshletLimits,
    centroids: Vec<DVec3>,
    /// Unit normals; zero where a triangle has no area.
    normals: Vec<DVec3>,
    /// About the radius of a meshlet.
    radius: f64,
    adjacency: Adjacency,
    order: SpatialOrder,
    /// Triangles that are in clusters, or candidates of the open one.
    taken: Vec<bool>,
    listed: Vec<bool>,
    candidates: Vec<u32>,
    /// The place of each vertex in the open cluster.
    local: Vec<u16>,
    open: Open,
    out: Meshlets,
}

/// The cluster that grows.
#[derive(Default)]
struct Open {
    first_vertex: usize,
    first_triangle: usize,
    centroids: DVec3,
    normals: DVec3,
}

impl<'a> Builder<'a> {
    fn new(positions: &'a [Vec3], triangles: &'a [[u32; 3]], limits: MeshletLimits) -> Self {
        // Centroids, normals and areas in `f64`.
        let corners = |t: &[u32; 3]| t.map(|v| positions[v as usize].as_dvec3());
        let cross = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a);
        let centroids: Vec<DVec3> = triangles.iter().map(|t| corners(t).into_iter().sum::<DVec3>() / 3.0).collect();
        let area: f64 = triangles.iter().map(|t| 0.5 * cross(corners(t)).length()).sum();
        // Radius of a flat disc-like cluster with as many triangles of mean area as the limit.
        let mean = area / triangles.len().max(1) as f64;
        Self {
            positions,
            triangles,
            limits,
            normals: triangles.iter().map(|t| cross(corners(t)).normalize_or_zero()).collect(),
            radius: 0.5 * (mean * limits.triangles as f64).sqrt(),
            adjacency: Adjacency::new(positions.len(), triangles),
            order: SpatialOrder::new(&centroids),
            centroids,
            taken: vec![false; triangles.len()],
            listed: vec![false; triangles.len()],
            candidates: Vec::new(),
            local: vec![OUTSIDE; positions.len()],
            open: Open::default(),
            out: Meshlets::default(),
        }
    }

    fn count(&self) -> (usize, usize) {
        (self.out.vertices.len() - self.open.first_vertex, self.out.triangles.len() - self.open.first_triangle)
    }

    /// Number of vertices that a triangle would add, if it fits.
    fn added(&self, triangle: u32) -> Option<usize> {
        let corners = self.triangles[triangle as usize];
        let added = distinct(corners).filter(|&v| self.local[v as usize] == OUTSIDE).count();
        let (vertices, triangles) = self.count();
        (vertices + added <= self.limits.vertices && triangles < self.limits.triangles).then_some(added)
    }

    /// Adds a triangle that fits, and gives those beside it along the curve.
    fn add(&mut self, triangle: u32) -> [Option<u32>; 2] {
        let t = triangle as usize;
        let corners = self.triangles[t];
        self.taken[t] = true;
        self.adjacency.take(corners);
        for v in distinct(corners) {
            // New vertices bring the triangles around them in as candidates.
            if self.local[v as usize] == OUTSIDE {
                self.local[v as usize] = self.count().0 as u16;
                self.out.vertices.push(v);
                self.list_candidates(v);
            }
        }
        self.out.triangles.push(corners.map(|v| self.local[v as usize] as u8));
        self.out.sources.push(triangle);
        // Running sums give centre and axis of the cluster.
        self.open.centroids += self.centroids[t];
        self.open.normals += self.normals[t];
        self.order.remove(triangle)
    }

    fn list_candidates(&mut self, vertex: u32) {
        let (taken, listed) = (&self.taken, &mut self.listed);
        for t in self.adjacency.around(vertex, |t| taken[t as usize]) {
            if self.candidates.len() < MOST_CANDIDATES && !std::mem::replace(&mut listed[t as usize], true) {
                self.candidates.push(t);
            }
        }
    }

    /// Takes the best candidate that fits off the list.
    fn best_candidate(&mut self) -> Option<u32> {
        let (_, triangles) = self.count();
        let centre = self.open.centroids / triangles as f64;
        let axis = self.open.normals.normalize_or_zero();
        // Order by the class of the vertices added, then by distance, then along the curve, so that the choice is
        // unique.
        let mut best: Option<(usize, f64, u32, usize)> = None;
        for (place, &t) in self.candidates.iter().enumerate() {
            let Some(added) = self.added(t) else { continue };
            let class = self.class(t, added);
            if best.is_some_and(|b| b.0 < class) {
                continue;
            }
            let found = (class, self.distance(t, centre, axis), self.order.rank[t as usize], place);
            if best.is_none_or(|b| (found.0, found.1, found.2) < (b.0, b.1, b.2)) {
                best = Some(found);
            }
        }
        best.map(|(_, _, _, place)| self.candidates.swap_remove(place))
    }

    /// Vertices that a triangle adds. What is the last triangle of one of its vertices comes before others that add as
    /// many, since another cluster would have to repeat its vertices for it.
    fn class(&self, triangle: u32, added: usize) -> usize {
        // The last free triangle around a vertex saves a repeated vertex later.
        let is_last = || self.triangles[triangle as usize].iter().any(|&v| self.adjacency.live(v) == 1);
        if added == 0 {
            0
        } else if is_last() {
            1
        } else {
            1 + added
        }
    }

    /// Distance of a triangle from the cluster's centre, larger where its normal is far from the cluster's.
    fn distance(&self, triangle: u32, centre: DVec3, axis: DVec3) -> f64 {
        // Distance in units of the expected radius, weighted by how well the normals agree.
        let t = triangle as usize;
        let distance = (self.centroids[t] - centre).length();
        let relative = if self.radius > 0.0 { distance / self.radius } else { distance };
        (1.0 + relative) * (1.0 - NORMAL_WEIGHT * self.normals[t].dot(axis))
    }

    /// The nearer of two triangles to the cluster's centre, if it fits.
    fn nearest_beside(&self, beside: [Option<u32>; 2]) -> Option<u32> {
        if !self.candidates.is_empty() {
            return None;
        }
        // No neighbour is left: continue with a triangle that is close in space.
        let centre = self.open.centroids / self.count().1 as f64;
        let fits = beside.into_iter().flatten().filter(|&t| self.added(t).is_some());
        fits.min_by(|&a, &b| {
            let distance = |t: u32| (self.centroids[t as usize] - centre).length_squared();
            distance(a).total_cmp(&distance(b))
        })
    }

    /// Closes the cluster, and gives the triangle that the next one starts with: of the candidates that are left the
    /// one with the fewest neighbours, which would else stay behind alone.
    fn close(&mut self, beside: [Option<u32>; 2]) -> Option<u32> {
        // Seed the next cluster where fewest free neighbours are left.
        let neighbours = |t: u32| self.triangles[t as usize].iter().map(|&v| u64::from(self.adjacency.live(v))).sum();
        let seed = self.candidates.iter().copied().min_by_key(|&t| {
            let neighbours: u64 = neighbours(t);
            (neighbours, self.order.rank[t as usize])
        });
        // Candidates that are left belong to no cluster yet.
        for t in self.candidates.drain(..) {
            self.listed[t as usize] = false;
        }
        let (vertices, triangles) = self.count();
        let Open { first_vertex, first_triangle, .. } = std::mem::take(&mut self.open);
        // Reset the vertex map by the cluster's own table, not the whole mesh.
        let table = &self.out.vertices[first_vertex..];
        table.iter().for_each(|&v| self.local[v as usize] = OUTSIDE);
        let points: Vec<Vec3> = table.iter().map(|&v| self.positions[v as usize]).collect();
        self.out.meshlets.push(Meshlet {
            first_vertex: first_vertex as u32,
            vertices: vertices as u32,
            first_triangle: first_triangle as u32,
            triangles: triangles as u32,
            sphere: Sphere::around(&points),
            cone: NormalCone::of(&points, &self.out.triangles[first_triangle..]),
        });
        self.open =
            Open { first_vertex: self.out.vertices.len(), first_triangle: self.out.triangles.len(), ..Open::default() };
        seed.or(beside[0]).or(beside[1]).or(self.order.first())
    }
}
