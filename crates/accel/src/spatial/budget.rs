//! A bound on how often primitives may be listed, for trees that list a primitive in every leaf it reaches.

/// Entries in lists that may still be added below a node. Children share in proportion to what they hold, so that the
/// tree is the same in whatever order its parts are built.
#[derive(Clone, Copy, Debug)]
pub(super) struct Budget(u64);

impl Budget {
    /// For a tree over `n` primitives: `each` entries for each of them and some more.
    pub fn new(n: usize, each: u64) -> Self {
        Self(each * n as u64 + 1024)
    }

    /// Budget that remains when `n` entries become `below`; `None` if that is too many.
    pub fn spend(self, n: usize, below: usize) -> Option<Self> {
        // Only copies are paid for: a division that duplicates nothing is free.
        let added = below.saturating_sub(n) as u64;
        self.0.checked_sub(added).map(Self)
    }

    /// The share of a child that holds `part` of `whole`.
    pub fn share(self, part: usize, whole: usize) -> Self {
        Self((u128::from(self.0) * part as u128 / whole.max(1) as u128) as u64)
    }
}
