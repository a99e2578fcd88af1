//! A chart as a mesh of its own: a disk with vertices that no two of its parts share but by an edge.

use crate::connect::{Connections, NONE, next, previous};
use crate::mesh::Mesh;
use steradian_math::DVec3;

/// Triangles of a chart over its own vertices.
pub struct Chart {
    /// Numbers of the triangles in the mesh, in order.
    pub triangles: Vec<u32>,
    /// Vertices of their corners.
    pub corners: Vec<[u32; 3]>,
    /// Positions of the vertices.
    pub positions: Vec<DVec3>,
    /// Vertices along the border, with the inside to the left.
    pub border: Vec<u32>,
    /// Sum of the areas.
    pub area: f64,
    /// Sum of the area vectors.
    pub vector: DVec3,
}

/// Arrays over the mesh that charts are cut out with.
pub struct Cutter<'a> {
    mesh: &'a Mesh<'a>,
    connections: &'a Connections,
    /// Chart that last had each triangle.
    owner: Vec<u32>,
    /// Vertex of each corner in its chart.
    vertex: Vec<u32>,
}

impl<'a> Cutter<'a> {
    pub fn new(mesh: &'a Mesh<'a>, connections: &'a Connections) -> Self {
        let count = mesh.triangles.len();
        Self { mesh, connections, owner: vec![NONE; count], vertex: vec![NONE; 3 * count] }
    }

    /// Cuts out a chart; `name` is that of no other chart.
    pub fn cut(&mut self, name: u32, triangles: Vec<u32>) -> Chart {
        for &t in &triangles {
            self.owner[t as usize] = name;
            self.vertex[3 * t as usize..][..3].fill(NONE);
        }
        let mut positions = Vec::new();
        for &t in &triangles {
            for (side, position) in (3 * t..).zip(self.mesh.corners(t)) {
                if self.vertex[side as usize] == NONE {
                    self.spread(side, positions.len() as u32, name);
                    positions.push(position);
                }
            }
        }
        let corners = triangles.iter().map(|t| [0, 1, 2].map(|c| self.vertex[(3 * t + c) as usize])).collect();
        let areas = triangles.iter().map(|t| self.connections.area[*t as usize]);
        let vectors = triangles.iter().map(|t| self.mesh.area_vector(*t));
        let (area, vector) = (areas.sum(), vectors.sum());
        let border = self.border(&triangles, name);
        Chart { triangles, corners, positions, border, area, vector }
    }

    /// The partner of a side within a chart, or [`NONE`].
    fn inner(&self, side: u32, name: u32) -> u32 {
        let partner = self.connections.partner[side as usize];
        if partner != NONE && self.owner[partner as usize / 3] == name { partner } else { NONE }
    }

    /// Gives a vertex to all corners around the start of a side.
    fn spread(&mut self, side: u32, vertex: u32, name: u32) {
        let mut at = side;
        // One way around the vertex, and where that ends at the border, the other way.
        while at != NONE && self.vertex[at as usize] == NONE {
            self.vertex[at as usize] = vertex;
            at = self.inner(previous(at), name);
        }
        at = self.inner(side, name);
        while at != NONE && self.vertex[next(at) as usize] == NONE {
            self.vertex[next(at) as usize] = vertex;
            at = self.inner(next(at), name);
        }
    }

    fn border(&self, triangles: &[u32], name: u32) -> Vec<u32> {
        let mut sides = triangles.iter().flat_map(|t| 3 * t..3 * t + 3);
        let Some(first) = sides.find(|side| self.inner(*side, name) == NONE) else { return Vec::new() };
        let (mut border, mut at) = (Vec::new(), first);
        loop {
            border.push(self.vertex[at as usize]);
            at = next(at);
            while self.inner(at, name) != NONE {
                at = next(self.inner(at, name));
            }
            if at == first {
                return border;
            }
        }
    }
}
