//! The nearest hit on a tree, and where the search for it starts.

use crate::UserHit;
use crate::layout::ChildRef;

/// Data of a hit beyond [`UserHit`]: nothing, or an index.
pub(crate) trait Extra: Copy {
    /// As bits.
    fn bits(self) -> u32;
    /// From [`Extra::bits`].
    fn from_bits(bits: u32) -> Self;
}

impl Extra for () {
    #[inline(always)]
    fn bits(self) -> u32 {
        0
    }

    #[inline(always)]
    fn from_bits(_: u32) {}
}

impl Extra for u32 {
    #[inline(always)]
    fn bits(self) -> u32 {
        self
    }

    #[inline(always)]
    fn from_bits(bits: u32) -> Self {
        bits
    }
}

/// The nearest hit on a tree.
#[derive(Clone, Copy)]
pub(crate) struct Nearest<E> {
    pub hit: UserHit,
    /// Index over all geometries of the tree.
    pub index: u32,
    pub extra: E,
}

/// Starting point of the search for the nearest hit.
#[derive(Clone, Copy)]
pub(crate) struct Start<E> {
    pub child: ChildRef,
    /// The distance of the best hit, or the end of the interval.
    pub t: f32,
    pub best: Option<Nearest<E>>,
}
