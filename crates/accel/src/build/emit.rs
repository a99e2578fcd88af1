//! From the binary tree with its choices to the wide tree.

use super::Builder;
use super::binary::BinaryNode;
use super::primitives::{Indices, PrimRef, Primitives};
use crate::Error;
use crate::arena::Arena;
use crate::bvh::Tree;
use crate::layout::{Block, ChildRef, Node};
use crate::simd::LANES;
use steradian_math::Bounds3;

/// Lays out the wide tree, depth first.
pub(super) fn emit(
    primitives: &Primitives,
    refs: &[PrimRef],
    binary: &[BinaryNode<LANES>],
    builder: Builder,
) -> Result<Tree, Error> {
    let mut layout = Layout { nodes: Vec::new(), leaves: Vec::new(), only_triangles: true };
    let root = match binary.first() {
        None => ChildRef::EMPTY,
        Some(root) if root.is_leaf() => layout.leaf(root, refs),
        Some(_) => layout.subtree(binary, refs),
    };
    let block = |i: usize| {
        let (first, count) = layout.leaves[i];
        let mut triangles = [None; LANES];
        for (triangle, r) in triangles.iter_mut().zip(&refs[first as usize..][..count as usize]) {
            *triangle = primitives.indices(r.index());
        }
        let mut block = Block::EMPTY;
        for (lane, triangle) in triangles.into_iter().enumerate() {
            if let Some((corners, id)) = triangle.and_then(Indices::corners) {
                block.set(lane, corners, id);
            }
        }
        block
    };
    let (nodes, blocks) = (layout.nodes.len(), layout.leaves.len());
    // The layout counts nodes and blocks; in memory blocks begin where nodes end.
    let placed = |child: ChildRef| {
        if child.is_node() {
            Arena::node_ref(child.index())
        } else if child.is_block() {
            Arena::block_ref(nodes, child.index())
        } else {
            child
        }
    };
    let node = |i: usize| Node { children: layout.nodes[i].children.map(placed), ..layout.nodes[i] };
    let lines = Arena::lines(nodes, blocks) as u64;
    let limit = u64::from(ChildRef::LIMIT);
    if lines >= limit {
        let count = refs.len() as u64;
        return Err(Error::TooManyPrimitives {
            count,
            limit: (u128::from(count) * u128::from(limit) / u128::from(lines)) as u64,
        });
    }
    Ok(Tree {
        arena: Arena::new((nodes, blocks), node, block),
        root: placed(root),
        bounds: binary.first().map_or(Bounds3::EMPTY, |root| root.bounds),
        first: primitives.first.clone(),
        primitives: refs.len(),
        only_triangles: layout.only_triangles,
        builder,
    })
}

/// Nodes, and the ranges of references that become blocks.
struct Layout {
    nodes: Vec<Node>,
    leaves: Vec<(u32, u32)>,
    only_triangles: bool,
}

impl Layout {
    /// A leaf: a user primitive or a block of triangles.
    fn leaf(&mut self, node: &BinaryNode<LANES>, refs: &[PrimRef]) -> ChildRef {
        let r = &refs[node.first as usize];
        if r.is_user() {
            self.only_triangles = false;
            return ChildRef::user(r.index());
        }
        self.leaves.push((node.first, node.count));
        ChildRef::block(self.leaves.len() as u32 - 1)
    }

    /// All below the root of the binary tree, which is not a leaf.
    fn subtree(&mut self, binary: &[BinaryNode<LANES>], refs: &[PrimRef]) -> ChildRef {
        self.nodes.push(Node::EMPTY);
        let mut pending = vec![(0, 0)];
        while let Some((binary_index, index)) = pending.pop() {
            let children = children(binary, binary_index);
            let mut node = Node::EMPTY;
            for (lane, child_index) in children.into_iter().flatten().enumerate() {
                let child = &binary[child_index];
                let child_ref = if child.is_leaf() {
                    self.leaf(child, refs)
                } else {
                    self.nodes.push(Node::EMPTY);
                    pending.push((child_index, self.nodes.len() - 1));
                    ChildRef::node(self.nodes.len() as u32 - 1)
                };
                node.set(lane, &child.bounds, child_ref);
            }
            self.nodes[index] = node;
        }
        ChildRef::node(0)
    }
}

/// The binary nodes that become the children of a wide node.
pub(super) fn children<const WIDTH: usize>(binary: &[BinaryNode<WIDTH>], root: usize) -> [Option<usize>; WIDTH] {
    let mut found = [None; WIDTH];
    let mut len = 0;
    // Parts of the forest that are still to be opened: a binary node and how many subtrees it may become.
    let mut open = [(0, 0); WIDTH];
    let mut depth = 0;
    let (mut current, mut places) = (root, WIDTH);
    loop {
        let node = &binary[current];
        if places == 1 || node.second == 0 {
            found[len] = Some(current);
            len += 1;
            if depth == 0 {
                return found;
            }
            depth -= 1;
            (current, places) = open[depth];
        } else if node.forest[places - 1] == 0 {
            places -= 1;
        } else {
            let of_left = usize::from(node.forest[places - 1]);
            open[depth] = (current + node.second as usize, places - of_left);
            depth += 1;
            (current, places) = (current + 1, of_left);
        }
    }
}
