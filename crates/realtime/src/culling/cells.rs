//! Cells and portals: a partition of the scene by its walls, and the open parts of the planes between cells.
//!
//! Cells are the leaves of a tree of planes along the axes, each through walls (Teller, Séquin 1991, "Visibility
//! Preprocessing for Interactive Walkthroughs"). Coordinates are compared and copied, never computed, so that walls
//! that meet leave no gaps and walls that do not meet leave portals however narrow.

use super::walls::{Block, Wall};
use std::collections::{HashMap, VecDeque};
use steradian_math::DVec3;
use steradian_raster::glam::DVec4;

/// Most cells; nodes that are left over stay undivided.
pub const MAX_CELLS: usize = 512;

/// Share of its cross-section that walls cover of a node at the plane that divides it.
const COVERED: f64 = 1.0 / 3.0;

/// Or their area there, relative to the most that walls of one plane have which cover less of the scene.
const LARGE: f64 = 0.25;

/// Most walls that are cut out of one face between two cells; more of them stay open.
const MAX_CUT: usize = 64;

/// An open rectangle between two cells.
#[derive(Clone, Copy, Debug)]
pub struct Portal {
    /// Axis that it is across.
    pub axis: usize,
    /// The cells before and behind it along the axis.
    pub cells: [usize; 2],
    pub block: Block,
}

#[derive(Debug)]
enum Node {
    Leaf(usize),
    /// Axis, place, and numbers of the nodes before and behind.
    Split(usize, f64, [usize; 2]),
}

/// Cells and portals.
#[derive(Debug)]
pub struct Cells {
    nodes: Vec<Node>,
    pub cells: Vec<Block>,
    pub portals: Vec<Portal>,
    /// Portals of each cell.
    pub of_cell: Vec<Vec<usize>>,
}

impl Cells {
    /// Partition of a box.
    pub fn new(root: Block, walls: &[Wall]) -> Self {
        let mut made = Self { nodes: vec![Node::Leaf(0)], cells: vec![root], portals: Vec::new(), of_cell: Vec::new() };
        let all: Vec<usize> = (0..walls.len()).collect();
        let most = best(walls, &all, &root, |area, section| if area < COVERED * section { area } else { 0.0 })
            .map_or(f64::INFINITY, |found| found.0);
        // Breadth first, so that a limit is shared by all parts of the scene.
        let mut open = VecDeque::from([(0, all)]);
        while let Some((node, within)) = open.pop_front() {
            let Node::Leaf(cell) = made.nodes[node] else { continue };
            let block = made.cells[cell];
            let share = |area: f64, section: f64| {
                if area >= COVERED * section || area >= LARGE * most { area / section } else { 0.0 }
            };
            if made.cells.len() == MAX_CELLS {
                break;
            }
            let Some((_, axis, at)) = best(walls, &within, &block, share) else { continue };
            let (mut low, mut high) = (block, block);
            (low.max[axis], high.min[axis]) = (at, at);
            let behind = made.cells.len();
            made.cells[cell] = low;
            made.cells.push(high);
            let next = made.nodes.len();
            made.nodes[node] = Node::Split(axis, at, [next, next + 1]);
            made.nodes.extend([Node::Leaf(cell), Node::Leaf(behind)]);
            for (node, block) in [(next, low), (next + 1, high)] {
                open.push_back((node, within.iter().copied().filter(|w| cut(&walls[*w], &block)).collect()));
            }
        }
        made.find_portals(walls);
        made
    }

    /// Numbers of the cells that a block touches.
    pub fn touched(&self, block: &Block) -> Vec<usize> {
        let (mut found, mut stack) = (Vec::new(), vec![0]);
        while let Some(node) = stack.pop() {
            match self.nodes[node] {
                Node::Leaf(cell) => found.push(cell),
                Node::Split(axis, at, [low, high]) => {
                    stack.extend((block.max[axis] >= at).then_some(high));
                    stack.extend((block.min[axis] <= at).then_some(low));
                }
            }
        }
        found
    }

    /// All cells in an order in which rays meet them: from a point where w is 1, in the direction away from it where w
    /// is 0.
    pub fn order(&self, eye: DVec4) -> Vec<usize> {
        let (mut found, mut stack) = (Vec::new(), vec![0]);
        while let Some(node) = stack.pop() {
            match self.nodes[node] {
                Node::Leaf(cell) => found.push(cell),
                Node::Split(axis, at, [low, high]) => {
                    stack.extend(if eye[axis] < at * eye.w { [high, low] } else { [low, high] });
                }
            }
        }
        found
    }

    fn find_portals(&mut self, walls: &[Wall]) {
        let mut of_plane: HashMap<(usize, u64), Vec<&Wall>> = HashMap::new();
        for wall in walls {
            of_plane.entry((wall.axis, wall.block.min[wall.axis].to_bits())).or_default().push(wall);
        }
        for node in &self.nodes {
            let Node::Split(axis, at, children) = *node else { continue };
            let [low, high] = [0, 1].map(|side| self.beside(children[side], axis, at));
            let walls = of_plane.get(&(axis, at.to_bits())).map_or(&[][..], |walls| walls);
            for (a, b) in low.iter().flat_map(|a| high.iter().map(move |b| (*a, *b))) {
                let face = self.cells[a].common(&self.cells[b]).filter(|face| face.area(axis) > 0.0);
                let Some(face) = face else { continue };
                let blocks = opening(&face, axis, walls);
                self.portals.extend(blocks.into_iter().map(|block| Portal { axis, cells: [a, b], block }));
            }
        }
        self.of_cell = vec![Vec::new(); self.cells.len()];
        for (number, portal) in self.portals.iter().enumerate() {
            portal.cells.iter().for_each(|cell| self.of_cell[*cell].push(number));
        }
    }

    /// Cells under a node that have a face in a plane.
    fn beside(&self, node: usize, axis: usize, at: f64) -> Vec<usize> {
        let (mut found, mut stack) = (Vec::new(), vec![node]);
        while let Some(node) = stack.pop() {
            match self.nodes[node] {
                Node::Leaf(cell) => {
                    let Block { min, max } = self.cells[cell];
                    found.extend((min[axis] == at || max[axis] == at).then_some(cell));
                }
                Node::Split(_, _, children) => stack.extend(children),
            }
        }
        found
    }
}

/// True if the plane of a wall divides a box where the wall is.
fn cut(wall: &Wall, block: &Block) -> bool {
    let (axis, at) = (wall.axis, wall.block.min[wall.axis]);
    let common = wall.block.common(block);
    at > block.min[axis] && at < block.max[axis] && common.is_some_and(|common| common.area(axis) > 0.0)
}

/// The plane through walls that is worth the most by the area of its walls in a box and that of the cross-section:
/// worth, axis, place. The first one among equals; `None` where none is worth anything.
fn best(walls: &[Wall], within: &[usize], block: &Block, worth: impl Fn(f64, f64) -> f64) -> Option<(f64, usize, f64)> {
    let mut areas: HashMap<(usize, u64), f64> = HashMap::new();
    for wall in within.iter().map(|w| &walls[*w]).filter(|wall| cut(wall, block)) {
        let common = wall.block.common(block).map_or(0.0, |common| common.area(wall.axis));
        *areas.entry((wall.axis, wall.block.min[wall.axis].to_bits())).or_default() += common;
    }
    let worth = |((axis, at), area): ((usize, u64), f64)| (worth(area, block.area(axis)), axis, f64::from_bits(at));
    let order = |a: &(f64, usize, f64), b: &(f64, usize, f64)| {
        a.0.total_cmp(&b.0).then(b.1.cmp(&a.1)).then(b.2.total_cmp(&a.2))
    };
    areas.into_iter().map(worth).max_by(order).filter(|found| found.0 > 0.0)
}

/// Rectangles that together are a face between two cells without the walls in it.
fn opening(face: &Block, axis: usize, walls: &[&Wall]) -> Vec<Block> {
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let inside = |wall: &&Wall| wall.block.common(face).filter(|common| common.area(axis) > 0.0);
    let mut cuts: Vec<Block> = walls.iter().filter_map(inside).collect();
    cuts.sort_by(|a, b| b.area(axis).total_cmp(&a.area(axis)));
    cuts.truncate(MAX_CUT);
    // A grid by the sides of the walls, of whose open squares runs along one side are joined, then equal runs.
    let [us, vs] = [u, v].map(|side| {
        let mut at: Vec<f64> = cuts.iter().chain([face]).flat_map(|b| [b.min[side], b.max[side]]).collect();
        at.sort_by(f64::total_cmp);
        at.dedup();
        at
    });
    let mut found: Vec<Block> = Vec::new();
    for row in vs.windows(2) {
        let is_open = |low: f64, high: f64| {
            !cuts.iter().any(|b| b.min[u] <= low && b.max[u] >= high && b.min[v] <= row[0] && b.max[v] >= row[1])
        };
        let mut runs: Vec<[f64; 2]> = Vec::new();
        for square in us.windows(2).filter(|square| is_open(square[0], square[1])) {
            match runs.last_mut() {
                Some(run) if run[1] == square[0] => run[1] = square[1],
                _ => runs.push([square[0], square[1]]),
            }
        }
        for [low, high] in runs {
            let same = |b: &&mut Block| b.max[v] == row[0] && b.min[u] == low && b.max[u] == high;
            if let Some(below) = found.iter_mut().find(same) {
                below.max[v] = row[1];
                continue;
            }
            let (mut min, mut max): (DVec3, DVec3) = (face.min, face.max);
            (min[u], max[u], min[v], max[v]) = (low, high, row[0], row[1]);
            found.push(Block { min, max });
        }
    }
    found
}
