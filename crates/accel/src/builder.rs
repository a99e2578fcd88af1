//! Ways to build a hierarchy.

/// Builder of the binary tree. All give the same hits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Builder {
    /// From the root down by the surface area heuristic over bins.
    #[default]
    Sah,
    /// [`Builder::Sah`], then optimised by moving subtrees: slower to build, faster to trace.
    Reinsertion,
    /// From the root down, with planes that cut triangles in two, then optimised: the slowest to build. It pays where
    /// triangles are long or of very different sizes.
    Spatial,
    /// From the leaves up along a Z-order curve (PLOC): the fastest to build where there are many processors.
    Ploc,
}

impl Builder {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Sah, Self::Reinsertion, Self::Spatial, Self::Ploc];
}
