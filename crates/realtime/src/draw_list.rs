//! Draw list: the geometries of a scene to be drawn, in order.

use steradian_accel::WORLD;
use steradian_core::{
    Scene,
    scene::{Geometry, Shape},
};
use steradian_math::{Bounds3, Vec3, transform::Affine};

/// A geometry of the world, or of a placed group.
#[derive(Clone, Copy, Debug)]
pub struct Item {
    /// Index in [`Scene::geometries`].
    pub geometry: u32,
    /// Number of the geometry within its group, as hits have it.
    pub in_group: u32,
    /// Index of the placement, or [`WORLD`].
    pub instance: u32,
}

/// All that can be seen, in a fixed order.
#[derive(Clone, Debug)]
pub struct DrawList {
    /// Items to be drawn.
    pub items: Vec<Item>,
}

impl DrawList {
    /// Everything that scatters or emits light; surfaces that only separate media are left out.
    pub fn new(scene: &Scene) -> Self {
        // World geometry first, then each placed group: the order fixes the numbers of primitives.
        let mut items = Vec::new();
        let mut add = |from: u32, to: u32, instance: u32| {
            // Interfaces between media scatter no light and are not drawn.
            let drawn = (from..to).filter(|&g| !scene.geometries()[g as usize].is_interface);
            items.extend(drawn.map(|geometry| Item { geometry, in_group: geometry - from, instance }));
        };
        add(0, scene.world_count(), WORLD);
        for (number, placement) in scene.placements().iter().enumerate() {
            add(placement.base, placement.base + placement.count, number as u32);
        }
        Self { items }
    }

    /// The geometry of an item.
    pub fn geometry<'s>(&self, scene: &'s Scene, item: &Item) -> &'s Geometry {
        &scene.geometries()[item.geometry as usize]
    }
}

impl Item {
    /// World transform of its group.
    pub fn place(&self, scene: &Scene) -> Affine {
        match scene.placements().get(self.instance as usize) {
            Some(placement) if self.instance != WORLD => placement.world_from_group,
            _ => Affine::IDENTITY,
        }
    }
}

/// Number of boxes that a shape is drawn as; `None` for meshes, which are drawn by their triangles.
pub fn box_count(shape: &Shape) -> Option<u32> {
    match shape {
        Shape::Mesh(_) => None,
        Shape::Quadric(_) | Shape::Level(_) => Some(1),
        Shape::Patches(patches) => Some(patches.patches.len() as u32),
        Shape::Curves(curves) => Some(curves.count()),
        Shape::Field(field) => Some(field.count()),
        Shape::Sdf(grid) => Some(grid.count()),
        Shape::Plane(_) => Some(0),
    }
}

/// The box around a part of a shape, a little larger, so that no pixel at its border is missed.
pub fn part_bounds(shape: &Shape, part: u32) -> Bounds3 {
    let bounds = match shape {
        Shape::Quadric(q) => q.bounds(),
        Shape::Patches(m) => m.bounds(part),
        Shape::Curves(c) => c.bounds(part),
        Shape::Field(f) => f.bounds(part),
        Shape::Sdf(s) => s.bounds(part),
        Shape::Level(l) => l.bounds(),
        Shape::Mesh(_) | Shape::Plane(_) => Bounds3::EMPTY,
    };
    // Grow relative to the size of the box and to its distance from the origin, where rounding comes from.
    let more = bounds.diagonal().max_element() * 1e-3 + bounds.min.abs().max(bounds.max.abs()).max_element() * 1e-6;
    Bounds3::new(bounds.min - Vec3::splat(more), bounds.max + Vec3::splat(more))
}

/// Corners of the two triangles of each side of a box, counter-clockwise from outside.
pub const BOX: [[usize; 3]; 12] = [
    [0, 4, 6],
    [0, 6, 2],
    [1, 3, 7],
    [1, 7, 5],
    [0, 1, 5],
    [0, 5, 4],
    [2, 6, 7],
    [2, 7, 3],
    [0, 2, 3],
    [0, 3, 1],
    [4, 5, 7],
    [4, 7, 6],
];
