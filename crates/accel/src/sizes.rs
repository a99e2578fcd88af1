//! Bounds on the memory of a hierarchy, known from the number of its primitives alone.

use crate::layout::{Block, Node};
use crate::simd::Row;
use crate::tree::Tree;
use crate::{Builder, Bvh};

impl Bvh {
    /// Most bytes of [`Bvh::bytes`] over so many triangles and user primitives in so many geometries, by any builder
    /// that cuts none. A leaf has a primitive at least, and a node two children: a tree of n leaves has at most n - 1
    /// nodes. Points at one place come near to it; meshes take about a seventh.
    pub fn most_bytes(triangles: u64, user: u64, geometries: u64) -> u64 {
        let (node, block, first) = (size_of::<Node>() as u64, size_of::<Block>() as u64, size_of::<u32>() as u64);
        let nodes = (triangles + user).saturating_sub(1);
        nodes * node + triangles * block + (geometries + 1) * first + size_of::<Tree>() as u64
    }

    /// Most bytes that building takes besides the hierarchy itself, for so many primitives in so many geometries, by a
    /// builder that cuts none. Arrays that grow count three times: they double, and are copied from the half.
    pub fn most_scratch_bytes(builder: Builder, primitives: u64, geometries: u64) -> u64 {
        // References of 32 bytes, their tags of 4, the two lists of what becomes nodes and blocks of 64 and 8, and
        // of binary nodes of 44 bytes twice as many as of references.
        let from_ranges = 32 + 4 + 3 * (64 + 8) + 2 * 3 * 44;
        let own = match builder {
            Builder::Sah => 0,
            // Explicit nodes of 36 bytes, with parents, areas, order, and moves of 12 bytes as lists and in one piece;
            // the binary nodes in one piece; the references again.
            Builder::Reinsertion | Builder::Spatial => 2 * (36 + 4 + 4 + 8 + 4 * 12 + 44) + 32,
            // Explicit nodes, keys of 8 bytes, clusters of 28 bytes twice, neighbours, order; the references again.
            Builder::Ploc => 2 * 3 * 36 + 8 + 3 * 28 + 4 + 2 * 8 + 32,
        };
        primitives * (from_ranges + own) + 3 * 4 * (geometries + 4) + SMALL_THINGS
    }

    /// True if two hierarchies hold the same bits.
    pub fn same_bits(&self, other: &Self) -> bool {
        let rows = |rows: &[Row]| rows.iter().flat_map(|row| row.0.map(f32::to_bits)).collect::<Vec<_>>();
        let (a, b) = (self.tree(), other.tree());
        a.root == b.root
            && (a.bounds, &a.first) == (b.bounds, &b.first)
            && (a.arena.nodes().len(), a.arena.blocks().len()) == (b.arena.nodes().len(), b.arena.blocks().len())
            && { a.arena.nodes().iter().zip(b.arena.nodes()) }
                .all(|(a, b)| rows(&a.rows) == rows(&b.rows) && a.children == b.children)
            && { a.arena.blocks().iter().zip(b.arena.blocks()) }
                .all(|(a, b)| rows(&a.rows) == rows(&b.rows) && a.ids == b.ids)
    }
}

/// Lists of pending nodes, and what threads need to share work.
const SMALL_THINGS: u64 = 64 << 10;
