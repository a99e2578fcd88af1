//! Regions of space by a k-d tree over points: each has about as many of them.

use steradian_math::{Bounds3, Vec3};

/// A node of the k-d tree: the axis and the place of the split, and the second child (the first one follows); or a
/// leaf.
#[derive(Clone, Copy, Debug)]
enum Node {
    Split {
        axis: u8,
        at: f32,
        second: u32,
    },
    Leaf(u32),
    /// Without knowledge.
    Nothing,
}

/// A k-d tree whose leaves are numbered in order.
#[derive(Clone, Debug)]
pub(crate) struct Regions {
    nodes: Vec<Node>,
    cells: Cells,
}

impl Regions {
    /// Halves items along the longest axis of their points until at most `capacity` are left, and hands each part to
    /// `make`, in the order in which `items` holds them afterwards. Parts for which it says `false` become no leaves.
    /// `None` where there are no leaves at all.
    pub fn new<T>(
        items: &mut [T],
        point: impl Fn(&T) -> Vec3 + Copy,
        capacity: usize,
        mut make: impl FnMut(&mut [T]) -> bool,
    ) -> Option<Self> {
        let mut builder = Builder { nodes: Vec::new(), leaves: 0, point, capacity, make: &mut make };
        builder.split(items).then(|| Self { nodes: builder.nodes, cells: Cells::default() })
    }

    /// With a grid over a box, from whose cells the search begins; outside of it there are no leaves.
    pub fn within(self, bounds: Bounds3) -> Self {
        Self { cells: Cells::new(&self.nodes, bounds), ..self }
    }

    /// The box of the grid.
    #[inline]
    pub fn bounds(&self) -> &Bounds3 {
        &self.cells.bounds
    }

    /// Number of the leaf about a point.
    #[inline]
    pub fn leaf(&self, p: Vec3) -> Option<usize> {
        let mut node = self.cells.node(p)?;
        loop {
            match self.nodes[node] {
                Node::Split { axis, at, second } => {
                    node = if p[axis as usize] < at { node + 1 } else { second as usize };
                }
                Node::Nothing => return None,
                Node::Leaf(leaf) => return Some(leaf as usize),
            }
        }
    }
}

struct Builder<'a, P, M> {
    nodes: Vec<Node>,
    leaves: u32,
    point: P,
    capacity: usize,
    make: &'a mut M,
}

impl<P, M> Builder<'_, P, M> {
    /// Builds the subtree of these items; true if there is any leaf in it.
    fn split<T>(&mut self, items: &mut [T]) -> bool
    where
        P: Fn(&T) -> Vec3 + Copy,
        M: FnMut(&mut [T]) -> bool,
    {
        let point = self.point;
        if items.len() <= self.capacity {
            let is_leaf = (self.make)(items);
            self.nodes.push(if is_leaf { Node::Leaf(self.leaves) } else { Node::Nothing });
            self.leaves += u32::from(is_leaf);
            return is_leaf;
        }
        let axis = Bounds3::from_points(items.iter().map(point)).longest_axis();
        let half = items.len() / 2;
        items.select_nth_unstable_by(half, |a, b| point(a)[axis].total_cmp(&point(b)[axis]));
        let (node, at) = (self.nodes.len(), point(&items[half])[axis]);
        self.nodes.push(Node::Nothing);
        let (low, high) = items.split_at_mut(half);
        let near = self.split(low);
        let second = self.nodes.len() as u32;
        if !(self.split(high) | near) {
            self.nodes.truncate(node + 1);
            return false;
        }
        self.nodes[node] = Node::Split { axis: axis as u8, at, second };
        true
    }
}

/// A grid over the tree that says from which node on a place of it is looked for.
#[derive(Clone, Debug, Default)]
struct Cells {
    bounds: Bounds3,
    /// Cells in a unit of length, by axis.
    scale: Vec3,
    /// The smallest node around each cell.
    nodes: Vec<u32>,
}

impl Cells {
    /// Cells along an axis.
    const EDGE: usize = 32;

    fn new(nodes: &[Node], bounds: Bounds3) -> Self {
        let size = bounds.diagonal() / Self::EDGE as f32;
        // Places are found to rounding.
        let margin = size * 1e-3;
        let node_around = |cell: usize| {
            let place = [cell, cell / Self::EDGE, cell / (Self::EDGE * Self::EDGE)].map(|c| (c % Self::EDGE) as f32);
            let min = bounds.min + size * Vec3::from(place) - margin;
            let max = min + size + margin * 2.0;
            let mut node = 0;
            while let Some(Node::Split { axis, at, second }) = nodes.get(node) {
                let axis = *axis as usize;
                node = match (max[axis] < *at, min[axis] >= *at) {
                    (true, _) => node + 1,
                    (_, true) => *second as usize,
                    _ => break,
                };
            }
            node as u32
        };
        let scale = size.map(|s| if s > 0.0 { 1.0 / s } else { 0.0 });
        Self { bounds, scale, nodes: (0..Self::EDGE.pow(3)).map(node_around).collect() }
    }

    /// The node to start from; `None` where there are no leaves.
    #[inline]
    fn node(&self, p: Vec3) -> Option<usize> {
        if !self.bounds.contains(p) {
            return None;
        }
        let place = ((p - self.bounds.min) * self.scale).to_array().map(|c| (c as usize).min(Self::EDGE - 1));
        self.nodes.get((place[2] * Self::EDGE + place[1]) * Self::EDGE + place[0]).map(|node| *node as usize)
    }
}
