//! The memory of a hierarchy: nodes, then blocks, in one piece. A reference says where either begins, so that it
//! becomes an address without asking what it is to.
#![expect(unsafe_code, reason = "unchecked reads; each place states why it is sound")]

use crate::layout::{Block, ChildRef, Node};
use crate::storage::Storage;
use rayon::prelude::*;
use std::mem::MaybeUninit;

/// A cache line, the unit of references.
#[repr(C, align(64))]
#[derive(Clone, Copy)]
struct Line([MaybeUninit<u8>; 64]);

/// Lines of a node and of a block.
const NODE: usize = size_of::<Node>() / size_of::<Line>();
const BLOCK: usize = size_of::<Block>() / size_of::<Line>();

/// Nodes and blocks.
#[derive(Clone)]
pub(crate) struct Arena {
    lines: Storage<Line>,
    nodes: usize,
    blocks: usize,
}

impl Arena {
    /// Number of cache lines taken by `nodes` nodes and `blocks` blocks.
    pub fn lines(nodes: usize, blocks: usize) -> usize {
        NODE * nodes + BLOCK * blocks
    }

    /// The reference to a node with an index.
    pub fn node_ref(index: usize) -> ChildRef {
        ChildRef::node((NODE * index) as u32)
    }

    /// The reference to a block with an index, behind so many nodes.
    pub fn block_ref(nodes: usize, index: usize) -> ChildRef {
        ChildRef::block(Self::lines(nodes, index) as u32)
    }

    /// Parts of so many nodes and blocks each, made in parallel by functions of the part and the index in it.
    pub fn new(
        parts: &[(usize, usize)],
        node: impl Fn(usize, usize) -> Node + Sync,
        block: impl Fn(usize, usize) -> Block + Sync,
    ) -> Self {
        let (nodes, blocks) = parts.iter().fold((0, 0), |sum, part| (sum.0 + part.0, sum.1 + part.1));
        // SAFETY: a line may be anything.
        let lines = unsafe { Storage::uninit(Self::lines(nodes, blocks)) };
        let mut arena = Self { lines, nodes, blocks };
        let (mut of_nodes, mut of_blocks) = arena.lines.split_at_mut(NODE * nodes);
        let mut places = Vec::with_capacity(parts.len());
        for &(nodes, blocks) in parts {
            let (own_nodes, more_nodes) = of_nodes.split_at_mut(NODE * nodes);
            let (own_blocks, more_blocks) = of_blocks.split_at_mut(BLOCK * blocks);
            places.push((own_nodes, own_blocks));
            (of_nodes, of_blocks) = (more_nodes, more_blocks);
        }
        places.into_par_iter().enumerate().for_each(|(part, (nodes, blocks))| {
            for (i, place) in nodes.chunks_exact_mut(NODE).enumerate() {
                // SAFETY: a line is aligned like a node, and so many lines have its size.
                unsafe { place.as_mut_ptr().cast::<Node>().write(node(part, i)) };
            }
            for (i, place) in blocks.chunks_exact_mut(BLOCK).enumerate() {
                // SAFETY: as above.
                unsafe { place.as_mut_ptr().cast::<Block>().write(block(part, i)) };
            }
        });
        arena
    }

    /// All nodes, in depth-first order.
    pub fn nodes(&self) -> &[Node] {
        // SAFETY: so many nodes have been written at the beginning.
        unsafe { std::slice::from_raw_parts(self.lines.as_ptr().cast(), self.nodes) }
    }

    /// All blocks, in the same order.
    pub fn blocks(&self) -> &[Block] {
        // SAFETY: so many blocks have been written behind the nodes.
        unsafe { std::slice::from_raw_parts(self.lines.as_ptr().add(NODE * self.nodes).cast(), self.blocks) }
    }

    /// Both, to be changed.
    pub fn parts_mut(&mut self) -> (&mut [Node], &mut [Block]) {
        let (nodes, blocks) = self.lines.split_at_mut(NODE * self.nodes);
        // SAFETY: as above, and the borrow is exclusive.
        unsafe {
            (
                std::slice::from_raw_parts_mut(nodes.as_mut_ptr().cast(), self.nodes),
                std::slice::from_raw_parts_mut(blocks.as_mut_ptr().cast(), self.blocks),
            )
        }
    }

    /// The index of the node a reference is to.
    pub fn node_index(child: ChildRef) -> usize {
        child.index() / NODE
    }

    /// The index of the block a reference is to.
    pub fn block_index(&self, child: ChildRef) -> usize {
        (child.index() - NODE * self.nodes) / BLOCK
    }

    /// The node a reference is to.
    ///
    /// # Safety
    /// The reference must be to a node, and come from this tree.
    #[inline(always)]
    pub unsafe fn node(&self, child: ChildRef) -> &Node {
        debug_assert!(child.is_node() && child.index() < NODE * self.nodes);
        // SAFETY: the builder makes references to nodes that exist only, and nothing changes a tree.
        unsafe { &*self.place(child).cast() }
    }

    /// The block of triangles a reference is to.
    ///
    /// # Safety
    /// The reference must be to a block, and come from this tree.
    #[inline(always)]
    pub unsafe fn block(&self, child: ChildRef) -> &Block {
        debug_assert!(child.is_block() && child.index() < self.lines.len());
        // SAFETY: the builder makes references to blocks that exist only, and nothing changes a tree.
        unsafe { &*self.place(child).cast() }
    }

    /// Address of the first cache line of a child reference.
    #[inline(always)]
    fn place(&self, child: ChildRef) -> *const Line {
        self.lines.as_ptr().wrapping_add(child.index())
    }

    /// Asks for the memory of a node or block that will be read soon.
    #[inline(always)]
    pub fn prefetch(&self, child: ChildRef) {
        for line in 0..NODE {
            prefetch(self.place(child).wrapping_add(line));
        }
    }

    /// Memory in bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.lines[..])
    }
}

/// Asks for the line of memory that a place is in.
#[inline(always)]
pub(crate) fn prefetch<T>(place: *const T) {
    #[cfg(target_arch = "x86_64")]
    {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        // SAFETY: a prefetch of any address does nothing but time.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(place.cast()) };
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = place;
}

impl std::fmt::Debug for Arena {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Arena").field("nodes", &self.nodes()).field("blocks", &self.blocks()).finish()
    }
}
