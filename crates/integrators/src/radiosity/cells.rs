//! Patches as leaves of quadtrees over the pieces of surface. Where a patch is split, in four, its children take its
//! place.

use super::{
    polygon::Polygon,
    surfaces::{Piece, Surfaces},
};
use glam::DVec3;
use std::{cmp::Ordering, collections::BinaryHeap};
use steradian_math::Vec2;

/// A patch, or what was one before it was split.
#[derive(Clone, Copy, Debug)]
pub struct Cell {
    /// Index of the piece.
    pub piece: u32,
    /// First of its four children; 0 for a leaf.
    pub children: u32,
    /// Corners in parameters, counterclockwise; the fourth counts for quadrilaterals only.
    corners: [Vec2; 4],
    /// Area of its polygon, m².
    pub area: f32,
    is_triangle: bool,
}

/// The quadtrees.
#[derive(Clone, Debug, Default)]
pub struct Cells {
    /// First the whole pieces, with their indices; then groups of four children.
    pub cells: Vec<Cell>,
    /// Indices of split cells, in the order of the splits.
    pub splits: Vec<u32>,
}

impl Cell {
    /// Corners in parameters, counterclockwise.
    pub fn corners(&self) -> &[Vec2] {
        &self.corners[..if self.is_triangle { 3 } else { 4 }]
    }

    /// True for a leaf.
    pub fn is_leaf(&self) -> bool {
        self.children == 0
    }

    /// The parameters at a point of the unit square, by a map that keeps areas of the parameters.
    pub fn at(&self, u: Vec2) -> Vec2 {
        let c = &self.corners;
        // Uniform in the triangle, bilinear in the rectangle of parameters.
        if self.is_triangle {
            let [a, b, w] = steradian_math::warp::uniform_triangle(u);
            c[0] * a + c[1] * b + c[2] * w
        } else {
            c[0] + (c[2] - c[0]) * u
        }
    }

    /// The weights of the corners at parameters within, which add up to one.
    pub fn weights(&self, uv: Vec2) -> [f32; 4] {
        let c = &self.corners;
        if self.is_triangle {
            let (a, b, p) = (c[1] - c[0], c[2] - c[0], uv - c[0]);
            // Barycentric coordinates by Cramer's rule.
            let det = a.perp_dot(b);
            let (s, t) = ((p.perp_dot(b) / det).clamp(0.0, 1.0), (a.perp_dot(p) / det).clamp(0.0, 1.0));
            [(1.0 - s - t).max(0.0), s, t, 0.0]
        } else {
            // Bilinear weights.
            let p = ((uv - c[0]) / (c[2] - c[0])).clamp(Vec2::ZERO, Vec2::ONE);
            let (s, t) = (p.x, p.y);
            [(1.0 - s) * (1.0 - t), s * (1.0 - t), s * t, (1.0 - s) * t]
        }
    }

    /// Index of the child that contains the parameters `uv`.
    fn child(&self, uv: Vec2) -> u32 {
        let w = self.weights(uv);
        // A corner's child holds all points whose weight of that corner is above one half; the rest is the middle one.
        if self.is_triangle {
            (0..3).find(|k| w[*k as usize] > 0.5).unwrap_or(3)
        } else {
            let middle = (self.corners[0] + self.corners[2]) * 0.5;
            match (uv.x >= middle.x, uv.y >= middle.y) {
                (false, false) => 0,
                (true, false) => 1,
                (true, true) => 2,
                (false, true) => 3,
            }
        }
    }

    fn corners_of_children(&self) -> [[Vec2; 4]; 4] {
        let c = self.corners;
        let m = |i: usize, j: usize| (c[i] + c[j]) * 0.5;
        if self.is_triangle {
            // Four congruent triangles by the middles of the edges.
            let (ab, bc, ca, z) = (m(0, 1), m(1, 2), m(2, 0), Vec2::ZERO);
            [[c[0], ab, ca, z], [ab, c[1], bc, z], [ca, bc, c[2], z], [bc, ca, ab, z]]
        } else {
            // Four quarters around the centre.
            let (ab, bc, cd, da, o) = (m(0, 1), m(1, 2), m(2, 3), m(3, 0), m(0, 2));
            [[c[0], ab, o, da], [ab, c[1], bc, o], [o, bc, c[2], cd], [da, o, cd, c[3]]]
        }
    }

    /// The polygon between its corners.
    pub fn polygon(&self, pieces: &[Piece]) -> Polygon {
        pieces[self.piece as usize].polygon(self.corners())
    }
}

impl Cells {
    /// One cell for each piece.
    pub fn new(surfaces: &Surfaces) -> Self {
        let cells = surfaces.pieces.iter().enumerate().map(|(k, piece)| {
            let c = piece.corners();
            let corners = std::array::from_fn(|i| c.get(i).copied().unwrap_or(Vec2::ZERO));
            let mut cell = Cell { piece: k as u32, children: 0, corners, area: 0.0, is_triangle: piece.is_triangle() };
            cell.area = cell.polygon(&surfaces.pieces).area() as f32;
            cell
        });
        Self { cells: cells.collect(), splits: Vec::new() }
    }

    /// Splits a leaf; gives the first of its four children.
    pub fn split(&mut self, pieces: &[Piece], cell: u32) -> u32 {
        let parent = self.cells[cell as usize];
        debug_assert!(parent.is_leaf());
        // Children lie one behind the other; leaves keep zero as first child.
        let first = self.cells.len() as u32;
        for corners in parent.corners_of_children() {
            let mut child = Cell { corners, children: 0, ..parent };
            child.area = child.polygon(pieces).area() as f32;
            self.cells.push(child);
        }
        self.cells[cell as usize].children = first;
        self.splits.push(cell);
        first
    }

    /// The leaves, in order.
    pub fn leaves(&self) -> impl Iterator<Item = u32> {
        (0..self.cells.len() as u32).filter(|k| self.cells[*k as usize].is_leaf())
    }

    /// Number of leaves.
    pub fn leaf_count(&self, surfaces: &Surfaces) -> usize {
        surfaces.pieces.len() + 3 * self.splits.len()
    }

    /// Splits the largest leaves until there are so many. Those that lie beyond a sphere count for less, by the square
    /// of the distance, as they look smaller from within. Ends early where `tell` says to stop.
    pub fn split_to(
        &mut self,
        surfaces: &Surfaces,
        count: usize,
        (center, radius): (DVec3, f64),
        tell: &dyn Fn(usize) -> bool,
    ) {
        // Area over squared distance, with all that lies within the sphere at full area.
        let need = |cells: &Self, k: u32| {
            let cell = &cells.cells[k as usize];
            let distance = cell.polygon(&surfaces.pieces).center().distance(center) / radius;
            cell.area / distance.max(1.0).powi(2) as f32
        };
        let needs: Vec<f32> = self.leaves().map(|k| need(self, k)).collect();
        self.split_most_needed(surfaces, count, &needs, tell, |cells, k, _| need(cells, k));
    }

    /// Splits the leaves with the largest needs, which are given in the order of leaves and of which each child
    /// inherits a quarter, until there are so many or none has any. Ends early where `tell` says to stop.
    pub fn split_by(&mut self, surfaces: &Surfaces, count: usize, needs: &[f32], tell: &dyn Fn(usize) -> bool) {
        self.split_most_needed(surfaces, count, needs, tell, |_, _, parent| 0.25 * parent);
    }

    fn split_most_needed(
        &mut self,
        surfaces: &Surfaces,
        count: usize,
        needs: &[f32],
        tell: &dyn Fn(usize) -> bool,
        of_child: impl Fn(&Self, u32, f32) -> f32,
    ) {
        // Greedy: the leaf of greatest need is split, and its four children join the heap.
        let mut heap: BinaryHeap<Urgent> = self.leaves().zip(needs).map(|(k, need)| Urgent(*need, k)).collect();
        let mut leaves = self.leaf_count(surfaces);
        while leaves + 3 <= count && tell(0) {
            let Some(Urgent(need, cell)) = heap.pop() else { break };
            if need.is_nan() || need <= 0.0 {
                break;
            }
            let first = self.split(&surfaces.pieces, cell);
            leaves += 3;
            heap.extend((first..first + 4).map(|k| Urgent(of_child(self, k, need), k)));
        }
    }

    /// The leaf that holds parameters of a piece.
    #[inline]
    pub fn find(&self, piece: u32, uv: Vec2) -> u32 {
        // Down the quadtree to the leaf.
        let mut k = piece;
        loop {
            let cell = &self.cells[k as usize];
            if cell.is_leaf() {
                return k;
            }
            k = cell.children + cell.child(uv);
        }
    }
}

/// A leaf by its need; of equal ones that with the smaller index.
struct Urgent(f32, u32);

impl PartialEq for Urgent {
    fn eq(&self, o: &Self) -> bool {
        self.cmp(o) == Ordering::Equal
    }
}

impl Eq for Urgent {}

impl PartialOrd for Urgent {
    fn partial_cmp(&self, o: &Self) -> Option<Ordering> {
        Some(self.cmp(o))
    }
}

impl Ord for Urgent {
    fn cmp(&self, o: &Self) -> Ordering {
        self.0.total_cmp(&o.0).then(o.1.cmp(&self.1))
    }
}
