//! Boxes as nodes hold them, widened by a bound on rounding.

use steradian_math::{Bounds3, Vec3};

/// By how much of their coordinates planes are moved outwards, and distances for the origin. Rounding moves a distance
/// by at most half of it. Widening by more keeps every box that the exact ray touches (Ize, "Robust BVH Ray Traversal",
/// JCGT 2(2), 2013).
pub(crate) const WIDEN: f32 = 4.0 * f32::EPSILON;

/// A box as nodes hold it: its planes are moved outwards by the bound on what rounding does to the product of their
/// coordinate and the reciprocal of a direction. The bound belongs to the plane, not to the ray, so that a primitive
/// far away does not widen the boxes of others.
pub(crate) fn widened(b: &Bounds3) -> Bounds3 {
    let margin = |corner: Vec3| corner.abs() * WIDEN + f32::MIN_POSITIVE;
    Bounds3 { min: b.min - margin(b.min), max: b.max + margin(b.max) }
}
