//! Volumes that are hidden by the partition of the scene into cells.

use super::{
    Bounding,
    cells::Cells,
    footprint::Screen,
    portals::{Window, windows},
    pvs::visible_sets,
    walls::{Block, walls},
};
use crate::{draw_list::DrawList, projection::Projected};
use std::{fmt, sync::OnceLock};
use steradian_core::Scene;
use steradian_math::{DVec3, Vec3};

/// Relative margin of places in the world, for rounding.
const MARGIN: f64 = 1e-5;

/// Cells of a view, and what may be seen from which.
#[derive(Debug)]
pub struct Rooms {
    cells: Cells,
    /// All of space that the cells fill.
    root: Block,
    walls: usize,
    sets: OnceLock<Vec<Vec<bool>>>,
}

/// Test of volumes.
pub type Sight<'a> = Box<dyn Fn(&Bounding) -> bool + Sync + 'a>;

/// Numbers of a partition.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Census {
    walls: usize,
    cells: usize,
    portals: usize,
    /// Pairs of different cells that may see each other, where sets were made.
    pairs: Option<usize>,
}

impl Rooms {
    /// Partition of a box around volumes, walls and eye.
    pub fn new<'a>(
        scene: &Scene,
        list: &DrawList,
        projected: &Projected,
        volumes: impl Iterator<Item = &'a Bounding>,
    ) -> Self {
        let walls = walls(scene, list, projected);
        let start = start(projected);
        let all = volumes.map(around).chain(walls.iter().map(|wall| wall.block));
        // Passes look from places a pixel apart.
        let all = all.fold(start.grown((start.max - start.min).length()), |all, block| all.joined(&block));
        let root = all.grown(1e-3 * (all.max - all.min).length());
        Self { cells: Cells::new(root, &walls), root, walls: walls.len(), sets: OnceLock::new() }
    }

    /// Test of volumes, true where a volume may be seen: through windows, or by the sets of the cells where the view
    /// starts. `None` where it starts outside all cells.
    pub fn sight<'a>(&'a self, projected: &Projected, screen: &Screen, by_sets: bool) -> Option<Sight<'a>> {
        let start = start(projected);
        let touched = self.cells.touched(&start);
        if self.root.common(&start) != Some(start) {
            return None;
        }
        if by_sets {
            let sets = self.sets.get_or_init(|| visible_sets(&self.cells));
            return Some(Box::new(move |volume| {
                let cells = self.cells.touched(&around(volume));
                cells.iter().any(|to| touched.iter().any(|from| sets[*from][*to]))
            }));
        }
        let (place, direction) = projected.eye();
        let eye = if projected.is_perspective() { place.extend(1.0) } else { (-direction).extend(0.0) };
        let windows = windows(&self.cells, screen, &touched, eye.as_dvec4());
        Some(Box::new(move |volume| {
            let block = around(volume);
            self.cells.touched(&block).into_iter().any(|cell| {
                let Some(part) = self.cells.cells[cell].common(&block) else { return false };
                let misses = |w: &Window| w.misses(&part.corners(), 0.0) || w.misses(&volume.corners, volume.radius);
                windows[cell].iter().any(|window| !misses(window))
            })
        }))
    }

    /// Its numbers.
    pub fn census(&self) -> Census {
        let (walls, cells, portals) = (self.walls, self.cells.cells.len(), self.cells.portals.len());
        let ordered = |sets: &Vec<Vec<bool>>| sets.iter().flatten().filter(|seen| **seen).count();
        Census { walls, cells, portals, pairs: self.sets.get().map(|sets| (ordered(sets) - cells) / 2) }
    }
}

/// A box around the eye and the rectangle at which the view begins.
fn start(projected: &Projected) -> Block {
    let near = projected.near();
    let [x0, x1, y0, y1] = projected.window();
    let scale = if projected.is_perspective() { near } else { 1.0 };
    let corner = |(x, y)| projected.world(Vec3::new(x * scale, y * scale, near)).as_dvec3();
    let corners = [(x0, y0), (x1, y0), (x0, y1), (x1, y1)].map(corner);
    let eye = if projected.is_perspective() { projected.eye().0.as_dvec3() } else { corners[0] };
    let fit = |block: Block, p: &DVec3| block.joined(&Block { min: *p, max: *p });
    safe(corners.iter().fold(Block { min: eye, max: eye }, fit))
}

/// A box around a volume.
fn around(volume: &Bounding) -> Block {
    let first = volume.corners[0];
    let fit = |block: Block, p: &DVec3| block.joined(&Block { min: *p, max: *p });
    safe(volume.corners.iter().fold(Block { min: first, max: first }, fit).grown(volume.radius))
}

/// A box with a margin for rounding.
fn safe(block: Block) -> Block {
    let size = (block.max - block.min).max_element() + block.min.abs().max(block.max.abs()).max_element();
    block.grown(MARGIN * size)
}

impl fmt::Display for Census {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { walls, cells, portals, pairs } = self;
        if *cells < 2 {
            return write!(f, "no wall along the axes divides the scene, so that nothing is hidden");
        }
        write!(f, "{walls} walls, {cells} cells, {portals} portals")?;
        pairs.map_or(Ok(()), |pairs| {
            write!(f, ", {pairs} of {} pairs of cells may see each other", cells * (cells - 1) / 2)
        })
    }
}
