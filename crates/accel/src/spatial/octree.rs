//! The octree. A ray goes from leaf to leaf by finding neighbours (Samet, "Implementing Ray Tracing with Octrees and
//! Neighbor Finding", Computers & Graphics 13(4), 1989): leaves have integer coordinates, and the bits in which those
//! of two neighbours differ tell how far up their common ancestor is.
//!
//! At most [`DEPTH`] levels, and [`LISTED_PER_ITEM`] entries in lists for each primitive.

use super::budget::Budget;
use super::items::Items;
use super::line::{Line, is_beyond};
use super::lists::Lists;
use super::overlap::overlaps;
use super::search::Visitor;
use crate::levels::Levels;
use steradian_math::{Bounds3, DVec3};

/// Most levels below the root; coordinates have as many bits.
const DEPTH: u32 = 16;
/// Leaves with no more primitives are not divided.
const LEAF: usize = 6;
/// Entries in lists, beyond one, for each primitive.
const LISTED_PER_ITEM: u64 = 16;

/// A node: the index of the first of eight children, or the list of a leaf.
#[derive(Clone, Copy, Debug)]
struct Node(u32);

impl Node {
    const LEAF: u32 = 1 << 31;

    /// The list, if it is a leaf.
    #[inline]
    fn list(self) -> Option<u32> {
        (self.0 & Self::LEAF != 0).then_some(self.0 & !Self::LEAF)
    }
}

/// An octree. Child `i` of a node is above the middle on axis `a` where bit `a` of `i` is set.
#[derive(Clone, Debug)]
pub(super) struct Octree {
    min: DVec3,
    /// Size of a cell of the lowest level.
    fine: DVec3,
    nodes: Vec<Node>,
    lists: Lists,
}

/// A node that is being built.
struct Pending {
    node: usize,
    /// Lowest coordinates and depth.
    low: [u32; 3],
    depth: u32,
    slots: Vec<u32>,
    budget: Budget,
}

impl Octree {
    /// Divides space.
    pub fn build(items: &Items) -> Self {
        let n = items.list.len();
        let [min, max] = items.padded_bounds();
        // Integer coordinates: 2^16 fine cells on each axis.
        let fine = (max - min) / f64::from(1_u32 << DEPTH);
        let mut tree = Self { min, fine, nodes: vec![Node(Node::LEAF)], lists: Lists::default() };
        let deepest = (3 + (n.max(1)).ilog2() / 2).min(DEPTH);
        let budget = Budget::new(n, LISTED_PER_ITEM);
        let mut pending = vec![Pending { node: 0, low: [0; 3], depth: 0, slots: (0..n as u32).collect(), budget }];
        while let Some(Pending { node, low, depth, slots, budget }) = pending.pop() {
            // Divide cells with many primitives while depth and budget allow; eight children lie side by side.
            let divided = (slots.len() > LEAF && depth < deepest).then(|| tree.divide(items, low, depth, &slots));
            let spent = divided.and_then(|parts| {
                let below = parts.iter().map(|(_, slots)| slots.len()).sum();
                Some((parts, below, budget.spend(slots.len(), below)?))
            });
            let Some((parts, below, budget)) = spent else {
                tree.nodes[node] = Node(Node::LEAF | tree.lists.push(&slots));
                continue;
            };
            let first = tree.nodes.len();
            tree.nodes[node] = Node(first as u32);
            tree.nodes.extend([Node(Node::LEAF); 8]);
            for (i, (low, slots)) in parts.into_iter().enumerate().rev() {
                let budget = budget.share(slots.len(), below);
                pending.push(Pending { node: first + i, low, depth: depth + 1, slots, budget });
            }
        }
        tree
    }

    /// Primitives in each of the eight octants of a cell.
    fn divide(&self, items: &Items, low: [u32; 3], depth: u32, slots: &[u32]) -> [([u32; 3], Vec<u32>); 8] {
        let half = 1 << (DEPTH - depth - 1);
        let padding = items.padding();
        std::array::from_fn(|child| {
            let low: [u32; 3] = std::array::from_fn(|axis| low[axis] + half * (child as u32 >> axis & 1));
            // An octant lists every primitive that overlaps it, padding included.
            let [min, max] = self.cell(low, half);
            let cell = [min - padding, max + padding];
            (low, slots.iter().copied().filter(|&slot| overlaps(&items.list[slot as usize], cell)).collect())
        })
    }

    /// The box of a cell.
    #[inline]
    fn cell(&self, low: [u32; 3], size: u32) -> [DVec3; 2] {
        let corner = |add: u32| DVec3::from_array(low.map(|x| f64::from(x + add)));
        [self.min + self.fine * corner(0), self.min + self.fine * corner(size)]
    }

    /// The coordinate of a point on an axis.
    #[inline]
    fn coordinate(&self, p: DVec3, axis: usize) -> u32 {
        let x = (p[axis] - self.min[axis]) / self.fine[axis];
        x.clamp(0.0, f64::from((1_u32 << DEPTH) - 1)) as u32
    }

    /// Visits the leaves along a line in order.
    pub fn walk(&self, line: &Line, visitor: &mut impl Visitor) {
        if line.reach > 0.0 {
            return self.walk_down(line, visitor);
        }
        // Locate the leaf of the entry point by its integer coordinates.
        let start = line.at(line.t[0]);
        let mut at = [0, 1, 2].map(|axis| self.coordinate(start, axis));
        // The nodes above the leaf, by depth.
        let mut path = [0_usize; DEPTH as usize + 1];
        let mut depth = 0;
        loop {
            // Down to the leaf.
            let list = loop {
                visitor.step();
                let node = self.nodes[path[depth as usize]];
                if let Some(list) = node.list() {
                    break list;
                }
                // The bit of each coordinate at this level selects the octant.
                let shift = DEPTH - 1 - depth;
                let child = (at[0] >> shift & 1) | (at[1] >> shift & 1) << 1 | (at[2] >> shift & 1) << 2;
                depth += 1;
                path[depth as usize] = (node.0 + child) as usize;
            };
            if visitor.visit(self.lists.get(list)) {
                return;
            }
            // Where the line leaves it.
            // The leaf's extent in fine cells follows from its depth; its low corner clears the bits below.
            let size = 1 << (DEPTH - depth);
            let low = at.map(|x| x & !(size - 1));
            // Exit face: the nearest of the far planes.
            let (mut exit, mut across) = (f64::INFINITY, 0);
            for (axis, &low) in low.iter().enumerate() {
                let d = line.direction[axis];
                if d != 0.0 {
                    let plane = f64::from(low + if d > 0.0 { size } else { 0 });
                    let t = (self.min[axis] + self.fine[axis] * plane - line.origin[axis]) * line.inverse[axis];
                    if t < exit {
                        (exit, across) = (t, axis);
                    }
                }
            }
            if exit > line.t[1] || is_beyond(exit, visitor.t_max()) {
                return;
            }
            // The neighbour there. Coordinates never go back, so that rounding cannot make the walk turn in circles.
            let p = line.at(exit);
            let old = at;
            for axis in 0..3 {
                let (first, last) = (low[axis], low[axis] + size - 1);
                let is_up = line.direction[axis] > 0.0;
                at[axis] = match (axis == across, is_up) {
                    (true, true) if last + 1 == 1 << DEPTH => return,
                    (true, true) => last + 1,
                    (true, false) if first == 0 => return,
                    (true, false) => first - 1,
                    (false, true) => self.coordinate(p, axis).clamp(old[axis], last),
                    (false, false) if line.direction[axis] < 0.0 => self.coordinate(p, axis).clamp(first, old[axis]),
                    (false, false) => old[axis],
                };
            }
            // The highest bit that differs gives the depth of the common ancestor, whence the descent goes on.
            let differ = (at[0] ^ old[0]) | (at[1] ^ old[1]) | (at[2] ^ old[2]);
            depth = DEPTH - 1 - differ.ilog2();
        }
    }

    /// Visits the leaves within the line's reach, down from the root.
    fn walk_down(&self, line: &Line, visitor: &mut impl Visitor) {
        let mut stack = [(0_u32, [0_u32; 3], 0_u32, 0.0_f64); 7 * DEPTH as usize + 8];
        stack[0].3 = line.t[0];
        let mut len = 1;
        // Visiting children in the order `i ^ first` is front to back for the octant of the direction.
        let first = (0..3).map(|axis| u32::from(line.direction[axis] < 0.0) << axis).sum::<u32>();
        while len > 0 {
            len -= 1;
            let (node, low, depth, entry) = stack[len];
            if is_beyond(entry, visitor.t_max()) {
                continue;
            }
            visitor.step();
            let node = self.nodes[node as usize];
            if let Some(list) = node.list() {
                if visitor.visit(self.lists.get(list)) {
                    return;
                }
                continue;
            }
            // The nearest child on top.
            let half = 1 << (DEPTH - depth - 1);
            for i in (0..8).rev() {
                let child = i ^ first;
                let low = std::array::from_fn(|axis| low[axis] + half * (child >> axis & 1));
                let [min, max] = self.cell(low, half);
                if let Some([entry, _]) = line.clip([min - line.reach, max + line.reach], line.t) {
                    stack[len] = (node.0 + child, low, depth + 1, entry);
                    len += 1;
                }
            }
        }
    }

    /// Memory in bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.nodes[..]) + self.lists.bytes() + size_of::<Self>()
    }

    /// Entries in lists.
    #[cfg(test)]
    pub fn listed(&self) -> usize {
        self.lists.len()
    }
}

impl Levels for Octree {
    /// Index, lowest coordinates, and depth.
    type Node = (u32, [u32; 3], u32);

    fn root(&self) -> Self::Node {
        (0, [0; 3], 0)
    }

    fn bounds(&self, (_, low, depth): Self::Node) -> Bounds3 {
        let [min, max] = self.cell(low, 1 << (DEPTH - depth)).map(|p| p.as_vec3());
        Bounds3 { min, max }
    }

    fn open(&self, (node, low, depth): Self::Node, children: &mut Vec<Self::Node>) -> bool {
        let node = self.nodes[node as usize];
        if node.list().is_some() {
            return false;
        }
        let half = 1 << (DEPTH - depth - 1);
        let child = |i: u32| (node.0 + i, [0, 1, 2].map(|axis| low[axis] + half * (i >> axis & 1)), depth + 1);
        let holds = |i: &u32| self.nodes[(node.0 + i) as usize].list().is_none_or(|l| !self.lists.get(l).is_empty());
        children.extend((0..8).filter(holds).map(child));
        true
    }

    fn holder(&self, (leaf, ..): Self::Node, slot: u32) -> Option<u32> {
        self.nodes[leaf as usize].list().filter(|list| self.lists.get(*list).contains(&slot))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spatial::testing;

    #[test]
    fn the_caps_hold() {
        for (mesh, seed) in [(2000, 1.5), (2000, 0.01)].map(|(n, size)| (testing::soup(n, size, 85), size)) {
            let items = testing::items(&mesh);
            let tree = Octree::build(&items);
            assert!(tree.listed() as u64 <= (LISTED_PER_ITEM + 1) * 2000 + 1024, "{} for {seed}", tree.listed());
            assert!(tree.nodes.len() > 64, "{seed}");
        }
    }

    #[test]
    fn neighbours_share_a_face() {
        // From leaf to leaf the line goes on where it was: what it leaves at one number it enters at the same.
        struct Boxes<'a>(&'a Octree, Vec<[DVec3; 2]>);
        impl Visitor for Boxes<'_> {
            fn step(&mut self) {}
            fn visit(&mut self, slots: &[u32]) -> bool {
                // The first slot of each list is the number of a cell, see below.
                if let Some(&cell) = slots.first() {
                    let found = self.0.leaf_boxes()[cell as usize];
                    self.1.push(found);
                }
                false
            }
            fn t_max(&self) -> f32 {
                f32::INFINITY
            }
        }
        let items = testing::items(&testing::soup(60, 0.3, 86));
        let mut tree = Octree::build(&items);
        let leaves = tree.leaf_boxes().len();
        let mut lists = Lists::default();
        for leaf in 0..leaves {
            lists.push(&[leaf as u32]);
        }
        tree.lists = lists;
        let mut crossed = 0;
        for ray in testing::assorted_rays(steradian_math::Vec3::ZERO, 1.0, 1500, 87) {
            let Some(line) = Line::new(&ray, items.padded_bounds(), 1.0) else { continue };
            let mut boxes = Boxes(&tree, Vec::new());
            tree.walk(&line, &mut boxes);
            let walked = boxes.1;
            let mut t = line.t[0];
            for cell in &walked {
                let [enter, leave] = line.clip([cell[0] - 1e-9, cell[1] + 1e-9], line.t).expect("on the line");
                assert!(enter <= t + 1e-6 * (1.0 + t.abs()), "{ray:?} jumps");
                t = t.max(leave);
            }
            assert!(t >= line.t[1] - 1e-6 * (1.0 + t.abs()), "{ray:?} ends early");
            crossed += walked.len();
        }
        assert!(crossed > 2000 && leaves > 50, "{crossed} {leaves}");
    }

    impl Octree {
        /// The boxes of leaves by the number of their list.
        fn leaf_boxes(&self) -> Vec<[DVec3; 2]> {
            let mut boxes = Vec::new();
            let mut pending = vec![(0, [0; 3], 0)];
            while let Some((node, low, depth)) = pending.pop() {
                match self.nodes[node as usize].list() {
                    Some(list) => boxes.push((list, self.cell(low, 1 << (DEPTH - depth)))),
                    None => pending.extend((0..8).map(|child| {
                        let half: u32 = 1 << (DEPTH - depth - 1);
                        let low = std::array::from_fn(|axis| low[axis] + half * (child >> axis & 1));
                        (self.nodes[node as usize].0 + child, low, depth + 1)
                    })),
                }
            }
            boxes.sort_by_key(|b| b.0);
            boxes.into_iter().map(|b| b.1).collect()
        }
    }
}
