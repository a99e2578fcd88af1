//! The ray-tracing acceleration structure: an 8-wide bounding volume hierarchy over triangles and user primitives, with one level
//! of instancing and SIMD traversal of single rays.
//!
//! * [`Geometry`] describes what goes in: indexed triangles, or boxes of primitives that the caller intersects itself.
//! * [`Bvh`] is the hierarchy over some geometries in one space.
//! * [`TopLevel`] is a hierarchy over world-space geometries and [`Instance`]s of other hierarchies.
//! * [`UserPrimitives`] is how a query calls back: user primitives, and the filtering of triangle hits (alpha masks).
//!
//! The traversal is compiled for several instruction sets and chosen at run time ([`Isa`]); every level gives the same bits.
//! A hit at equal distance goes to the smaller [`PrimId`], so results do not depend on the order of traversal either.
//!
//! Triangles are tested watertight, and a hit that rounding cannot tell from the origin of the ray is none: no ray slips between two
//! triangles that share an edge, and none meets again the triangle that it leaves. There is no epsilon to choose.
//!
//! This crate knows nothing of materials, and is the only one with `unsafe` code, which each module that needs it allows by name.

mod build;
mod bvh;
mod dispatch;
mod geometry;
mod isa;
mod layout;
mod simd;
mod stack;
mod storage;
#[cfg(test)]
mod tests;
mod top_level;
mod traverse;
mod triangle;

pub use bvh::Bvh;
pub use geometry::{Error, Geometry, Hit, PrimId, Shape, UserHit, UserPrimitives, WORLD};
pub use isa::Isa;
pub use top_level::{Instance, TopLevel};
