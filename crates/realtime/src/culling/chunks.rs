//! Chunks of the items of a draw list.

use super::{Bounding, BoundsKind, rooms::Rooms};
use crate::{
    draw_list::{DrawList, Item, box_count, part_bounds},
    projection::Projected,
};
use rayon::prelude::*;
use std::{ops::Range, sync::OnceLock};
use steradian_accel::WORLD;
use steradian_core::{Scene, scene::Shape};
use steradian_math::Vec3;

/// Most primitives of a chunk.
pub const CHUNK: u32 = 256;

/// Consecutive primitives of an item.
#[derive(Clone, Debug)]
pub struct Chunk {
    /// Index of the item in the draw list.
    pub item: u32,
    /// Number of the first primitive within the item.
    pub first: u32,
    /// Number of primitives.
    pub count: u32,
    /// Volume in the world; `None` for what has no bounds, which is always drawn.
    pub volume: Option<Bounding>,
}

/// All chunks, in the order of items and primitives.
#[derive(Debug)]
pub struct Chunks {
    chunks: Vec<Chunk>,
    /// Index of the first chunk of each item, and the number of all chunks.
    starts: Vec<usize>,
    /// Cells of the scene; made by the first method that needs them.
    rooms: OnceLock<Rooms>,
}

impl Chunks {
    /// Chunks of what a view does not leave out.
    pub fn new(scene: &Scene, list: &DrawList, projected: &Projected, kind: BoundsKind) -> Self {
        // Cut first, which is cheap; then bound all chunks in parallel.
        let (mut chunks, mut starts) = (Vec::new(), vec![0]);
        for (number, item) in list.items.iter().enumerate() {
            let geometry = list.geometry(scene, item);
            let count = if projected.hides(geometry) { 0 } else { part_count(&geometry.shape) };
            chunks.extend((0..count).step_by(CHUNK as usize).map(|first| Chunk {
                item: number as u32,
                first,
                count: CHUNK.min(count - first),
                volume: None,
            }));
            starts.push(chunks.len());
        }
        chunks.par_iter_mut().for_each(|chunk| {
            let item = &list.items[chunk.item as usize];
            let points = points(scene, item, &list.geometry(scene, item).shape, chunk.first..chunk.first + chunk.count);
            chunk.volume = Bounding::around(kind, &points);
        });
        Self { chunks, starts, rooms: OnceLock::new() }
    }

    /// The chunks.
    pub fn all(&self) -> &[Chunk] {
        &self.chunks
    }

    /// Cells of the scene.
    pub(super) fn rooms(&self, scene: &Scene, list: &DrawList, projected: &Projected) -> &Rooms {
        let volumes = self.chunks.iter().filter_map(|chunk| chunk.volume.as_ref());
        self.rooms.get_or_init(|| Rooms::new(scene, list, projected, volumes))
    }

    /// Cells, where they were made.
    pub(super) fn made_rooms(&self) -> Option<&Rooms> {
        self.rooms.get()
    }

    /// Numbers of the chunks of an item.
    pub fn of_item(&self, item: usize) -> Range<usize> {
        self.starts[item]..self.starts[item + 1]
    }

    /// Number of the chunk that has a primitive of an item.
    pub fn find(&self, item: u32, part: u32) -> Option<usize> {
        let range = self.of_item(item as usize);
        let chunk = range.start + (part / CHUNK) as usize;
        range.contains(&chunk).then_some(chunk)
    }
}

/// Number of primitives that a shape is drawn as.
fn part_count(shape: &Shape) -> u32 {
    match shape {
        Shape::Mesh(mesh) => mesh.triangles.len() as u32,
        Shape::Plane(_) => 1,
        _ => box_count(shape).unwrap_or(0),
    }
}

/// Corners of primitives in the world, by the arithmetic that draws them; of other shapes than meshes, those of their
/// boxes.
fn points(scene: &Scene, item: &Item, shape: &Shape, parts: Range<u32>) -> Vec<Vec3> {
    let place = item.place(scene);
    let in_world = |p| if item.instance == WORLD { p } else { place.point(p) };
    match shape {
        Shape::Mesh(mesh) => parts.flat_map(|part| mesh.corners(part)).map(in_world).collect(),
        Shape::Plane(_) => Vec::new(),
        _ => parts
            .flat_map(|part| {
                let bounds = part_bounds(shape, part);
                (0..8).map(move |i| in_world(bounds.corner(i)))
            })
            .collect(),
    }
}
