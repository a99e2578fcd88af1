//! A binary tree whose nodes may lie anywhere, for builders that do not go from the root down, and the way from it to
//! the one that is made wide.

use super::binary::{BinaryNode, Costs, SAH_DEPTH, build_range, fits_leaf, fitted, rescaled, scale};
use super::nodes::{BinaryTree, Nodes};
use super::primitives::PrimRef;
use super::split::Extent;
use crate::simd::LANES;
use rayon::prelude::*;
use steradian_math::Bounds3;

/// Content of a node of the explicit tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NodeContent {
    /// Two nodes.
    Children([u32; 2]),
    /// A range of references, of which the builder of ranges makes a subtree.
    Refs { first: u32, count: u32 },
}

/// A node.
#[derive(Clone, Copy, Debug)]
pub(super) struct Branch {
    pub bounds: Bounds3,
    pub below: NodeContent,
}

/// The tree. It has a reference at least.
#[derive(Clone, Debug)]
pub(super) struct Explicit {
    pub nodes: Vec<Branch>,
    pub refs: Vec<PrimRef>,
    pub root: u32,
}

/// Subtrees with more references than these are laid out by several threads.
const PARALLEL: usize = 1 << 12;

impl Explicit {
    /// A tree of one node.
    pub fn leaf(bounds: Bounds3, refs: Vec<PrimRef>) -> Self {
        let below = NodeContent::Refs { first: 0, count: refs.len() as u32 };
        Self { nodes: vec![Branch { bounds, below }], refs, root: 0 }
    }

    /// A node over two trees.
    pub fn join(bounds: Bounds3, mut left: Self, right: Self) -> Self {
        // Append the right tree behind the left one and shift its indices.
        let (nodes, refs) = (left.nodes.len() as u32, left.refs.len() as u32);
        left.nodes.extend(right.nodes.into_iter().map(|node| Branch {
            below: match node.below {
                NodeContent::Children(children) => NodeContent::Children(children.map(|child| child + nodes)),
                NodeContent::Refs { first, count } => NodeContent::Refs { first: first + refs, count },
            },
            ..node
        }));
        left.refs.extend(right.refs);
        let children = [left.root, right.root + nodes];
        left.nodes.push(Branch { bounds, below: NodeContent::Children(children) });
        Self { root: left.nodes.len() as u32 - 1, ..left }
    }

    /// The tree that the builder of ranges has made, down to what fits a block.
    pub fn of_ranges<const WIDTH: usize>(refs: Vec<PrimRef>, ranges: &[BinaryNode<WIDTH>]) -> Self {
        let mut nodes = Vec::with_capacity(ranges.len());
        // Nodes that are still to be taken over: where they come from and where their parent refers to them.
        let mut pending = vec![(0, None)];
        while let Some((from, parent)) = pending.pop() {
            let node = &ranges[from];
            let index = nodes.len() as u32;
            // Ranges that fit a block stay whole.
            let below = if node.second == 0 || node.count <= LANES as u32 {
                NodeContent::Refs { first: node.first, count: node.count }
            } else {
                pending.push((from + node.second as usize, Some((index, 1))));
                pending.push((from + 1, Some((index, 0))));
                NodeContent::Children([0; 2])
            };
            nodes.push(Branch { bounds: node.bounds, below });
            if let Some((parent, side)) = parent {
                let parent: &mut Branch = &mut nodes[parent as usize];
                if let NodeContent::Children(children) = &mut parent.below {
                    children[side] = index;
                }
            }
        }
        Self { nodes, refs, root: 0 }
    }

    /// All nodes, parents before their children.
    pub fn downwards(&self) -> Vec<u32> {
        let mut order = Vec::with_capacity(self.nodes.len());
        let mut pending = vec![self.root];
        while let Some(node) = pending.pop() {
            order.push(node);
            if let NodeContent::Children(children) = self.nodes[node as usize].below {
                pending.extend(children);
            }
        }
        order
    }

    /// The references in the order of the tree, and the tree as ranges of them.
    pub fn into_ranges<const WIDTH: usize>(self) -> (Vec<PrimRef>, BinaryTree<WIDTH>) {
        // Count references from the leaves up: children come after their parents in the order.
        let mut counts = vec![0; self.nodes.len()];
        for &node in self.downwards().iter().rev() {
            counts[node as usize] = match self.nodes[node as usize].below {
                NodeContent::Children([a, b]) => counts[a as usize] + counts[b as usize],
                NodeContent::Refs { count, .. } => count,
            };
        }
        let mut refs = self.refs.clone();
        let mut ranges = Nodes::new();
        let scale = scale(&self.nodes[self.root as usize].bounds);
        Layout { tree: &self, counts }.place(self.root, &mut refs, &mut ranges, [0; 2], scale);
        (refs, ranges.finish())
    }
}

/// The laying out of a tree.
struct Layout<'a> {
    tree: &'a Explicit,
    /// Number of references below each node.
    counts: Vec<u32>,
}

impl Layout<'_> {
    /// Lays out a subtree behind what has been laid out before, at a depth. What is too deep is cut anew.
    fn place<const WIDTH: usize>(
        &self,
        index: u32,
        refs: &mut [PrimRef],
        ranges: &mut Nodes<WIDTH>,
        [first, depth]: [u32; 2],
        scale: f32,
    ) -> Costs<WIDTH> {
        let node = &self.tree.nodes[index as usize];
        // Rescale subtrees whose areas would underflow in the scale of the whole tree.
        let own_scale = fitted(scale, &node.bounds);
        if own_scale != scale {
            return rescaled(self.place(index, refs, ranges, [first, depth], own_scale), own_scale, scale);
        }
        // Below the depth limit keep the tree's own split; otherwise collect the references and rebuild the range.
        let children = match node.below {
            NodeContent::Children(children) if depth < SAH_DEPTH && refs.len() > 2 => children,
            _ => {
                self.gather(index, refs);
                return build_range(refs, ranges, first, Extent::of(refs), scale, depth);
            }
        };
        let count = refs.len();
        // The left subtree takes the front of the range, the right one the rest.
        let middle = self.counts[children[0] as usize] as usize;
        let (left, right) = refs.split_at_mut(middle);
        let second = first + middle as u32;
        let node = BinaryNode { bounds: node.bounds, first, count: count as u32, second: 0, forest: [0; WIDTH] };
        let left = |ranges: &mut Nodes<WIDTH>| self.place(children[0], left, ranges, [first, depth + 1], scale);
        let right = |ranges: &mut Nodes<WIDTH>| self.place(children[1], right, ranges, [second, depth + 1], scale);
        let (node, [left, right]) = ranges.join(node, count > PARALLEL, left, right);
        let fits = fits_leaf(count, refs.iter().take(LANES).all(|r| !r.is_user()));
        node.choose_forests(&left, &right, fits, scale)
    }

    /// The references below a node.
    fn gather(&self, index: u32, refs: &mut [PrimRef]) {
        let (mut pending, mut len) = (vec![index], 0);
        while let Some(node) = pending.pop() {
            match self.tree.nodes[node as usize].below {
                NodeContent::Children(children) => pending.extend(children),
                NodeContent::Refs { first, count } => {
                    let count = count as usize;
                    refs[len..len + count].copy_from_slice(&self.tree.refs[first as usize..][..count]);
                    len += count;
                }
            }
        }
    }
}

/// The box around some references.
pub(super) fn bounds_of(refs: &[PrimRef]) -> Bounds3 {
    refs.iter().fold(Bounds3::EMPTY, |bounds, r| bounds.union(r.bounds()))
}

/// A leaf for each reference.
pub(super) fn leaves(refs: &[PrimRef]) -> Vec<Branch> {
    let leaf = |(i, r): (usize, &PrimRef)| Branch {
        bounds: r.bounds(),
        below: NodeContent::Refs { first: i as u32, count: 1 },
    };
    refs.par_iter().enumerate().map(leaf).collect()
}
