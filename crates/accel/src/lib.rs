//! The ray-tracing acceleration structure: an 8-wide bounding volume hierarchy over triangles and user primitives, with
//! one level of instancing and SIMD traversal of single rays, packets and sorted streams.
//!
//! * [`Geometry`] describes what goes in: indexed triangles, or boxes of primitives that the caller intersects itself.
//! * [`Bvh`] is the hierarchy over some geometries in one space.
//! * [`TopLevel`] is a hierarchy over world-space geometries and [`Instance`]s of other hierarchies.
//! * [`UserPrimitives`] is how a query calls back: user primitives, and the filtering of triangle hits (alpha masks).
//!
//! The traversal is compiled for several instruction sets and chosen at run time ([`Isa`]); every level gives the same
//! bits. A hit at equal distance goes to the smaller [`PrimId`], so results do not depend on the order of traversal
//! either.
//!
//! Rays that lie together in a slice and go nearly the same way are traced together by `intersect_batch` and
//! `occluded_batch`, several times as fast as alone; so are those that begin near each other. Others fly several at
//! once, where memory is what they wait for. `intersect_stream` and `occluded_stream` sort them first. Each ray gets
//! the bits that it gets alone.
//!
//! Triangles are tested watertight, and a hit that rounding cannot tell from the origin of the ray is none: no ray
//! slips between two triangles that share an edge, and none meets again the triangle that it leaves. There is no
//! epsilon to choose.
//!
//! This crate knows nothing of materials. Of the program's `unsafe` code it has all but the calls of Open Image
//! Denoise; each module that needs it allows it by name.

mod arena;
pub mod bounding;
mod builder;
mod bvh;
pub mod columns;
mod construct;
mod dispatch;
mod every;
mod geometry;
mod isa;
mod lanes;
mod layout;
mod leaves;
mod levels;
mod many;
mod nearest;
mod outline;
mod packet;
mod packet_hits;
mod packet_rays;
mod placement;
mod ray_constants;
mod refit;
mod search;
mod simd;
mod single;
mod sizes;
mod slabs;
mod spatial;
mod stack;
mod storage;
mod stream;
mod supported_isa;
#[cfg(test)]
mod tests;
mod top_level;
mod tree;
mod triangle;
mod widened;

pub use builder::Builder;
pub use bvh::Bvh;
pub use geometry::{Error, Geometry, Hit, PrimId, Shape, UserHit, UserPrimitives, WORLD};
pub use isa::Isa;
pub use lanes::{Kernel, Lanes};
pub use placement::Instance;
pub use spatial::{Accel, Accelerator, Object, Steps};
pub use top_level::TopLevel;
