//! The hierarchy as it lies in memory.
#![expect(unsafe_code, reason = "unchecked reads; each place states why it is sound")]

use crate::simd::{LANES, Row};
use crate::widened::widened;
use steradian_math::{Bounds3, Vec3};

/// Child reference of a node, in 32 bits: the kind above, an index below.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(transparent)]
pub(crate) struct ChildRef(pub u32);

impl ChildRef {
    /// Number of bits of the index.
    const INDEX_BITS: u32 = 30;
    /// Most nodes, blocks or primitives that can be addressed.
    pub const LIMIT: u32 = 1 << Self::INDEX_BITS;
    /// Nothing. As a node it would be the first one, but its box is empty.
    pub const EMPTY: Self = Self(3 << Self::INDEX_BITS);

    /// An inner node.
    pub fn node(index: u32) -> Self {
        Self(index)
    }

    /// A block of triangles.
    pub fn block(index: u32) -> Self {
        Self(1 << Self::INDEX_BITS | index)
    }

    /// A user primitive.
    pub fn user(index: u32) -> Self {
        Self(2 << Self::INDEX_BITS | index)
    }

    /// The bits of several references.
    #[inline(always)]
    pub fn bits(references: &[Self; LANES]) -> &[u32; LANES] {
        // SAFETY: a reference is a `u32`.
        unsafe { &*std::ptr::from_ref(references).cast() }
    }

    /// True for an inner node.
    #[inline(always)]
    pub fn is_node(self) -> bool {
        self.0 < Self::LIMIT
    }

    /// True for a block of triangles.
    #[inline(always)]
    pub fn is_block(self) -> bool {
        self.0 >> Self::INDEX_BITS == 1
    }

    /// True for a user primitive.
    #[inline(always)]
    pub fn is_user(self) -> bool {
        self.0 >> Self::INDEX_BITS == 2
    }

    /// The index of the node, block or primitive.
    #[inline(always)]
    pub fn index(self) -> usize {
        (self.0 & (Self::LIMIT - 1)) as usize
    }
}

/// Eight children: their boxes by rows, and what they are. Four cache lines, so that an index becomes an address by a
/// shift.
#[repr(C, align(64))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Node {
    /// Minimum x, y, z, then maximum x, y, z, of [`widened`] boxes. Empty slots have an empty box, which no ray enters.
    pub rows: [Row; 6],
    /// The children.
    pub children: [ChildRef; LANES],
}

impl Node {
    /// A node without children.
    pub const EMPTY: Self = Self {
        rows: [
            Row([f32::INFINITY; LANES]),
            Row([f32::INFINITY; LANES]),
            Row([f32::INFINITY; LANES]),
            Row([f32::NEG_INFINITY; LANES]),
            Row([f32::NEG_INFINITY; LANES]),
            Row([f32::NEG_INFINITY; LANES]),
        ],
        children: [ChildRef::EMPTY; LANES],
    };

    /// Fills a slot.
    pub fn set(&mut self, lane: usize, bounds: &Bounds3, child: ChildRef) {
        let bounds = widened(bounds);
        for axis in 0..3 {
            self.rows[axis].0[lane] = bounds.min[axis];
            self.rows[axis + 3].0[lane] = bounds.max[axis];
        }
        self.children[lane] = child;
    }

    /// The box of a slot, widened, of finite size.
    pub fn child_bounds(&self, lane: usize) -> Bounds3 {
        let plane = |row: usize| self.rows[row].0[lane].clamp(-f32::MAX, f32::MAX);
        let corner = |row: usize| Vec3::from_array(std::array::from_fn(|axis| plane(row + axis)));
        Bounds3 { min: corner(0), max: corner(3) }
    }
}

/// Up to eight triangles by rows.
#[repr(C, align(64))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Block {
    /// Row `3·vertex + axis`. Unused lanes are NaN, which no test passes.
    pub rows: [Row; 9],
    /// Primitive indices over all geometries; [`Block::FILTERED`] is set where hits must be accepted by the caller.
    pub ids: [u32; LANES],
}

impl Block {
    /// Flag in [`Block::ids`].
    pub const FILTERED: u32 = 1 << 31;

    /// A block without triangles.
    pub const EMPTY: Self = Self { rows: [Row([f32::NAN; LANES]); 9], ids: [0; LANES] };

    /// The lanes that hold a triangle.
    pub fn lanes(&self) -> u32 {
        (0..LANES).map(|lane| u32::from(!self.rows[0].0[lane].is_nan()) << lane).sum()
    }

    /// The box around its triangles.
    pub fn bounds(&self) -> Bounds3 {
        let mut bounds = Bounds3::EMPTY;
        for lane in (0..LANES).filter(|lane| self.lanes() >> lane & 1 == 1) {
            for vertex in 0..3 {
                let corner = std::array::from_fn(|axis| self.rows[3 * vertex + axis].0[lane]);
                bounds = bounds.union_point(Vec3::from_array(corner));
            }
        }
        bounds
    }

    /// Fills a lane.
    pub fn set(&mut self, lane: usize, vertices: [Vec3; 3], id: u32) {
        for (v, p) in vertices.into_iter().enumerate() {
            for axis in 0..3 {
                self.rows[3 * v + axis].0[lane] = p[axis];
            }
        }
        self.ids[lane] = id;
    }
}
