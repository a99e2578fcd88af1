//! From the binary tree with its choices to the wide tree.
//!
//! The upper part of the tree is laid out first; the subtrees below it follow, each as a part of its own, so that
//! several threads lay out, and then write, a part each.

use super::binary::{BinaryNode, PARALLEL};
use super::nodes::BinaryTree;
use super::primitives::{Indices, Primitives, Tag};
use crate::arena::Arena;
use crate::layout::{Block, ChildRef, Node};
use crate::simd::LANES;
use crate::tree::Tree;
use crate::{Builder, Error};
use rayon::prelude::*;
use steradian_math::Bounds3;

/// Lays out the wide tree, parents before their children.
pub(super) fn emit(
    primitives: &Primitives,
    tags: &[Tag],
    binary: &BinaryTree<LANES>,
    builder: Builder,
) -> Result<Tree, Error> {
    let mut upper = Layout::new(Source::Whole(binary));
    let mut subtrees = Vec::new();
    let root = match binary.root() {
        None => ChildRef::EMPTY,
        Some(root) if root.is_leaf() => upper.leaf(root, tags),
        Some(root) => {
            // Lay out the upper levels down to subtrees of a size that is worth a task.
            subtrees = upper.lay_out(tags, if root.count as usize > PARALLEL { PARALLEL } else { 0 });
            ChildRef::node(0)
        }
    };
    let lower = |left_out: &LeftOut| {
        let nodes = binary.from(left_out.binary);
        let mut part = Layout::new(Source::Subtree(nodes));
        part.reserve(nodes[0].count as usize);
        part.lay_out(tags, 0);
        part
    };
    // Lay out the subtrees in parallel, each with indices of its own.
    let mut parts: Vec<Layout> = subtrees.par_iter().map(lower).collect();
    // Where the parts begin.
    // Assign every part its place behind the previous ones and link it to its parent's slot.
    let (mut nodes, mut blocks) = (upper.nodes.len(), upper.leaves.len());
    for (part, left_out) in parts.iter_mut().zip(&subtrees) {
        upper.nodes[left_out.node][left_out.slot].child = ChildRef::node(nodes as u32);
        part.first = [nodes, blocks];
        (nodes, blocks) = (nodes + part.nodes.len(), blocks + part.leaves.len());
    }
    let only_triangles = upper.only_triangles && parts.iter().all(|part| part.only_triangles);
    parts.insert(0, upper);

    // References address cache lines in a limited number of bits: refuse trees that exceed them.
    let lines = Arena::lines(nodes, blocks) as u64;
    let limit = u64::from(ChildRef::LIMIT);
    if lines >= limit {
        let count = tags.len() as u64;
        return Err(Error::TooManyPrimitives {
            count,
            limit: (u128::from(count) * u128::from(limit) / u128::from(lines)) as u64,
        });
    }
    let sizes: Vec<_> = parts.iter().map(|part| (part.nodes.len(), part.leaves.len())).collect();
    let node = |part: usize, i: usize| parts[part].node(i, nodes);
    let block = |part: usize, i: usize| block(primitives, tags, parts[part].leaves[i]);
    // A root that is a leaf is the first of all.
    let root = if root.is_block() { Arena::block_ref(nodes, 0) } else { root };
    Ok(Tree {
        arena: Arena::new(&sizes, node, block),
        root,
        bounds: binary.root().map_or(Bounds3::EMPTY, |root| root.bounds),
        first: primitives.first.clone(),
        primitives: tags.len(),
        only_triangles,
        builder,
    })
}

/// The block of a range of references.
fn block(primitives: &Primitives, tags: &[Tag], (first, count): (u32, u32)) -> Block {
    // Look up the indices of all triangles first, so that the loads of their vertices overlap.
    let mut triangles = [None; LANES];
    for (triangle, tag) in triangles.iter_mut().zip(&tags[first as usize..][..count as usize]) {
        *triangle = primitives.indices(tag.index());
    }
    let mut block = Block::EMPTY;
    for (lane, triangle) in triangles.into_iter().enumerate() {
        if let Some((corners, id)) = triangle.and_then(Indices::corners) {
            block.set(lane, corners, id);
        }
    }
    block
}

/// Source of the binary nodes of a part.
#[derive(Clone, Copy)]
enum Source<'a> {
    Whole(&'a BinaryTree<LANES>),
    /// Nodes that lie together, of which the first is the root.
    Subtree(&'a [BinaryNode<LANES>]),
}

impl<'a> Source<'a> {
    fn get(self, index: usize) -> &'a BinaryNode<LANES> {
        match self {
            Self::Whole(tree) => tree.node(index),
            Self::Subtree(nodes) => &nodes[index],
        }
    }
}

/// A child of a wide node.
#[derive(Clone, Copy)]
struct Child {
    /// Its binary node.
    binary: u32,
    /// Reference to the child. Nodes and blocks are counted within the part.
    child: ChildRef,
}

/// A subtree that is left out of a part.
struct LeftOut {
    /// The node of the part that it belongs to,
    node: usize,
    /// in this slot.
    slot: usize,
    /// Its binary node.
    binary: usize,
}

/// A part of the tree: its nodes, and the ranges of references that become blocks.
struct Layout<'a> {
    source: Source<'a>,
    nodes: Vec<[Child; LANES]>,
    leaves: Vec<(u32, u32)>,
    only_triangles: bool,
    /// The indices of the first node and of the first block among all.
    first: [usize; 2],
}

impl<'a> Layout<'a> {
    fn new(source: Source<'a>) -> Self {
        Self { source, nodes: Vec::new(), leaves: Vec::new(), only_triangles: true, first: [0; 2] }
    }

    /// Makes room for what so many references mostly become.
    fn reserve(&mut self, refs: usize) {
        self.nodes.reserve(refs / 6);
        self.leaves.reserve(refs / 4);
    }

    /// A leaf: a user primitive or a block of triangles.
    fn leaf(&mut self, node: &BinaryNode<LANES>, tags: &[Tag]) -> ChildRef {
        let tag = tags[node.first as usize];
        if tag.is_user() {
            self.only_triangles = false;
            return ChildRef::user(tag.index());
        }
        self.leaves.push((node.first, node.count));
        ChildRef::block(self.leaves.len() as u32 - 1)
    }

    /// All below the root, which is not a leaf, down to subtrees of at most so many references, which are left out.
    fn lay_out(&mut self, tags: &[Tag], small: usize) -> Vec<LeftOut> {
        const NOTHING: [Child; LANES] = [Child { binary: 0, child: ChildRef::EMPTY }; LANES];
        let mut left_out = Vec::new();
        self.nodes.push(NOTHING);
        let mut pending = vec![(0, 0)];
        while let Some((binary_index, index)) = pending.pop() {
            let mut node = NOTHING;
            // Open the binary subtree into up to eight children by the choices of the dynamic programme.
            let children = children(|i| self.source.get(i), binary_index);
            for (slot, binary) in children.into_iter().flatten().enumerate() {
                let below = self.source.get(binary);
                let child = if below.is_leaf() {
                    self.leaf(below, tags)
                } else if below.count as usize <= small {
                    left_out.push(LeftOut { node: index, slot, binary });
                    ChildRef::EMPTY
                } else {
                    self.nodes.push(NOTHING);
                    pending.push((binary, self.nodes.len() - 1));
                    ChildRef::node(self.nodes.len() as u32 - 1)
                };
                node[slot] = Child { binary: binary as u32, child };
            }
            self.nodes[index] = node;
        }
        left_out
    }

    /// A node as it is in memory, where blocks begin behind so many nodes.
    fn node(&self, index: usize, nodes: usize) -> Node {
        let mut node = Node::EMPTY;
        for (slot, &Child { binary, child }) in self.nodes[index].iter().enumerate() {
            let placed = if child == ChildRef::EMPTY {
                continue;
            } else if child.is_node() {
                Arena::node_ref(self.first[0] + child.index())
            } else if child.is_block() {
                Arena::block_ref(nodes, self.first[1] + child.index())
            } else {
                child
            };
            node.set(slot, &self.source.get(binary as usize).bounds, placed);
        }
        node
    }
}

/// The binary nodes that become the children of a wide node.
pub(super) fn children<'a, const WIDTH: usize>(
    binary: impl Fn(usize) -> &'a BinaryNode<WIDTH>,
    root: usize,
) -> [Option<usize>; WIDTH] {
    let mut found = [None; WIDTH];
    let mut len = 0;
    // Parts of the forest that are still to be opened: a binary node and how many subtrees it may become.
    let mut open = [(0, 0); WIDTH];
    let mut depth = 0;
    let (mut current, mut places) = (root, WIDTH);
    // Walk the choices depth-first: a binary node with one place, or without children, becomes a child of the wide
    // node.
    loop {
        let node = binary(current);
        if places == 1 || node.second == 0 {
            found[len] = Some(current);
            len += 1;
            if depth == 0 {
                return found;
            }
            depth -= 1;
            (current, places) = open[depth];
        } else if node.forest[places - 1] == 0 {
            // A forest with one subtree less is as cheap: give the place up.
            places -= 1;
        } else {
            // Distribute the places as the recurrence chose; the right child waits on a stack.
            let of_left = usize::from(node.forest[places - 1]);
            open[depth] = (current + node.second as usize, places - of_left);
            depth += 1;
            (current, places) = (current + 1, of_left);
        }
    }
}
