//! The hit that a search has found.

use crate::ray::{Barycentrics, HitKind, PrimitiveId};

/// A hit that counts.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Committed {
    pub t: f32,
    pub id: PrimitiveId,
    /// Reported kind of a procedural hit; `None` for a triangle, whose face is found when it is asked for.
    pub kind: Option<HitKind>,
    /// Position in a triangle.
    pub barycentrics: Barycentrics,
}
