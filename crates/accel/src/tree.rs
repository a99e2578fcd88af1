//! The tree that builders make and queries go through.

use crate::arena::Arena;
use crate::layout::{Block, ChildRef, Node};
use crate::levels::Levels;
use crate::simd::LANES;
use crate::{Builder, PrimId};
use steradian_math::Bounds3;

/// With more nodes than these a tree is large. In tests small ones are, too.
const LARGE: usize = if cfg!(test) { 8 } else { (2 << 20) / size_of::<Node>() };

/// The parts of a hierarchy that traversal reads.
#[derive(Clone, Debug)]
pub(crate) struct Tree {
    pub arena: Arena,
    pub root: ChildRef,
    pub bounds: Bounds3,
    /// For each geometry the index of its first primitive over all geometries, and at the end the number of primitives.
    pub first: Vec<u32>,
    /// Number of primitives.
    pub primitives: usize,
    /// True if all primitives are triangles.
    pub only_triangles: bool,
    /// Builder that made the tree.
    pub builder: Builder,
}

impl Tree {
    /// With so few primitives rays that go different ways visit much the same nodes. Measured.
    const SMALL: usize = 4096;

    /// True if the tree has few primitives.
    #[inline(always)]
    pub fn is_small(&self) -> bool {
        self.primitives <= Self::SMALL
    }

    /// True if the tree is larger than the caches near a processor: incoherent rays wait for memory.
    #[inline(always)]
    pub fn is_large(&self) -> bool {
        self.arena.nodes().len() > LARGE
    }

    /// Asks for the memory of children of a node, in a large tree.
    #[inline(always)]
    pub fn prefetch_children(&self, node: &Node, mut lanes: u32) {
        if self.is_large() {
            while lanes != 0 {
                self.arena.prefetch(node.children[lanes.trailing_zeros() as usize & (LANES - 1)]);
                lanes &= lanes - 1;
            }
        }
    }

    /// The name of the primitive with an index over all geometries, when the tree is seen as an instance with a number.
    #[inline(always)]
    pub fn id(&self, instance: u32, index: u32) -> PrimId {
        let geom = if index < self.first[1] { 0 } else { self.first.partition_point(|&first| first <= index) - 1 };
        PrimId { instance, geom: geom as u32, prim: index - self.first[geom] }
    }

    /// Boxes that contain everything in the tree, tighter together than its bounds: about `count` of its upper levels,
    /// where the greatest ones are opened.
    pub fn upper_boxes(&self, count: usize) -> Vec<Bounds3> {
        let mut boxes = vec![(self.bounds, self.root)];
        // Replace the box of greatest area by its children until there are enough boxes.
        while boxes.len() < count {
            let nodes = boxes.iter().enumerate().filter(|(_, (_, child))| child.is_node());
            let Some((greatest, _)) = nodes.max_by(|a, b| a.1.0.area().total_cmp(&b.1.0.area())) else { break };
            let node = &self.arena.nodes()[Arena::node_index(boxes.swap_remove(greatest).1)];
            let children = (0..LANES).map(|lane| (node.child_bounds(lane), node.children[lane]));
            boxes.extend(children.filter(|(bounds, _)| !bounds.is_empty()));
        }
        boxes.into_iter().map(|(bounds, _)| bounds).filter(|bounds| !bounds.is_empty()).collect()
    }

    /// The index over all geometries of a primitive.
    pub fn index(&self, id: PrimId) -> u32 {
        self.first[id.geom as usize] + id.prim
    }

    /// Memory in bytes.
    pub fn bytes(&self) -> usize {
        self.arena.bytes() + size_of_val(&self.first[..]) + size_of::<Self>()
    }
}

impl Levels for Tree {
    /// Reference and box.
    type Node = (ChildRef, Bounds3);

    fn root(&self) -> Self::Node {
        (self.root, self.bounds)
    }

    fn bounds(&self, (_, bounds): Self::Node) -> Bounds3 {
        bounds
    }

    fn open(&self, (node, _): Self::Node, children: &mut Vec<Self::Node>) -> bool {
        if node.is_node() {
            let node = &self.arena.nodes()[Arena::node_index(node)];
            let all = (0..LANES).map(|lane| (node.children[lane], node.child_bounds(lane)));
            children.extend(all.filter(|(child, _)| *child != ChildRef::EMPTY));
        }
        node.is_node()
    }

    fn holder(&self, (leaf, _): Self::Node, index: u32) -> Option<u32> {
        let is_here = match leaf.is_block() {
            true => {
                let block = &self.arena.blocks()[self.arena.block_index(leaf)];
                let lanes = block.lanes();
                (0..LANES).any(|lane| lanes >> lane & 1 == 1 && block.ids[lane] & !Block::FILTERED == index)
            }
            false => leaf.is_user() && leaf.index() == index as usize,
        };
        is_here.then_some(leaf.0)
    }
}
