//! Walls: rectangles along the axes of the world, of which the partition into cells is made.

use crate::{draw_list::DrawList, projection::Projected};
use std::collections::HashMap;
use steradian_accel::WORLD;
use steradian_core::{Scene, scene::Shape};
use steradian_math::{DVec3, Vec3};

/// Most walls, the largest ones. What is no wall is open, so that fewer walls hide less.
pub const MAX_WALLS: usize = 1024;

/// Least area of a wall, relative to the squared radius of the scene.
const LEAST: f64 = 1e-6;

/// A box, or a rectangle: a box without thickness along one axis. Its numbers are those of vertices, unrounded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Block {
    pub min: DVec3,
    pub max: DVec3,
}

impl Block {
    /// Common points; `None` where the blocks do not touch.
    pub fn common(&self, other: &Self) -> Option<Self> {
        let (min, max) = (self.min.max(other.min), self.max.min(other.max));
        min.cmple(max).all().then_some(Self { min, max })
    }

    /// Smallest block around both.
    pub fn joined(&self, other: &Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// Block with so much more on each side.
    pub fn grown(&self, by: f64) -> Self {
        Self { min: self.min - by, max: self.max + by }
    }

    /// Area across an axis.
    pub fn area(&self, axis: usize) -> f64 {
        let size = self.max - self.min;
        size[(axis + 1) % 3] * size[(axis + 2) % 3]
    }

    /// The eight corners.
    pub fn corners(&self) -> [DVec3; 8] {
        std::array::from_fn(|i| {
            let at = |axis: usize| if i >> axis & 1 == 0 { self.min[axis] } else { self.max[axis] };
            DVec3::new(at(0), at(1), at(2))
        })
    }
}

/// A rectangle across an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wall {
    pub axis: usize,
    pub block: Block,
}

impl Wall {
    pub fn area(&self) -> f64 {
        self.block.area(self.axis)
    }
}

/// The walls of a view, largest first: pairs of opaque triangles of meshes that together are a rectangle.
pub fn walls(scene: &Scene, list: &DrawList, projected: &Projected) -> Vec<Wall> {
    let least = LEAST * f64::from(crate::extent(scene).1).powi(2);
    // For each rectangle the corners that triangles of it leave out, as bits.
    let mut halves: HashMap<(usize, [u32; 6]), (Wall, u8)> = HashMap::new();
    for item in &list.items {
        let geometry = list.geometry(scene, item);
        let Shape::Mesh(mesh) = &geometry.shape else { continue };
        if geometry.is_masked() || projected.hides(geometry) {
            continue;
        }
        let place = item.place(scene);
        let in_world = |p| if item.instance == WORLD { p } else { place.point(p) };
        for part in 0..mesh.triangles.len() as u32 {
            let Some((wall, missing)) = half(mesh.corners(part).map(in_world)) else { continue };
            if wall.area() >= least {
                let Block { min, max } = wall.block;
                let key = [min.x, min.y, min.z, max.x, max.y, max.z].map(|v| (v as f32).to_bits());
                halves.entry((wall.axis, key)).or_insert((wall, 0)).1 |= 1 << missing;
            }
        }
    }
    let is_whole = |missing: u8| missing & 0b1001 == 0b1001 || missing & 0b0110 == 0b0110;
    let mut found: Vec<Wall> = halves.into_values().filter(|(_, missing)| is_whole(*missing)).map(|h| h.0).collect();
    let key = |wall: &Wall| [wall.block.min.to_array(), wall.block.max.to_array()].concat();
    let by_place = |a: &Wall, b: &Wall| {
        key(a)
            .iter()
            .zip(key(b))
            .map(|(a, b)| a.total_cmp(&b))
            .find(|order| order.is_ne())
            .unwrap_or(a.axis.cmp(&b.axis))
    };
    found.sort_by(|a, b| b.area().total_cmp(&a.area()).then_with(|| by_place(a, b)));
    found.truncate(MAX_WALLS);
    found
}

/// The rectangle that a right-angled triangle is half of, and the number of the corner that it leaves out.
fn half(corners: [Vec3; 3]) -> Option<(Wall, usize)> {
    // Zeros lose their sign, by which rectangles are compared.
    let corners = corners.map(|p| p.as_dvec3() + 0.0);
    let min = corners.into_iter().reduce(DVec3::min)?;
    let max = corners.into_iter().reduce(DVec3::max)?;
    let axis = (0..3).find(|&axis| min[axis] == max[axis])?;
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let block = Block { min, max };
    if !(block.area(axis) > 0.0 && min.is_finite() && max.is_finite()) {
        return None;
    }
    let mut met = 0;
    for p in corners {
        let is_corner = |i: usize| (p[i] == min[i]) != (p[i] == max[i]);
        if !is_corner(u) || !is_corner(v) {
            return None;
        }
        met |= 1 << (usize::from(p[u] == max[u]) + 2 * usize::from(p[v] == max[v]));
    }
    // Three different corners.
    let missing = !met & 0b1111_i32;
    (missing.count_ones() == 1).then_some((Wall { axis, block }, missing.trailing_zeros() as usize))
}
