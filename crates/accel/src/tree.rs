//! The tree that builders make and queries go through.

use crate::arena::Arena;
use crate::layout::{ChildRef, Node};
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

    /// Memory in bytes.
    pub fn bytes(&self) -> usize {
        self.arena.bytes() + size_of_val(&self.first[..]) + size_of::<Self>()
    }
}
