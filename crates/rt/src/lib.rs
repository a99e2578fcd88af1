//! The ray-tracing model of DXR and Vulkan in software.

mod bottom_level;
pub mod error;
mod flags;
mod geometry;
mod plan;
mod query;
mod ray;
mod search;
mod top_level;
mod transform;

pub use bottom_level::{BottomLevel, BuildOptions, MAX_GEOMETRIES, MAX_PRIMITIVES, Preference};
pub use error::{BuildError, RayError};
pub use flags::{ExclusiveRayFlags, GeometryFlags, InstanceFlags, RayFlags};
pub use geometry::{BoxGeometry, Geometries, Indices, TriangleGeometry};
pub use query::{CommittedHit, ProceduralCandidate, QueryCandidate, RayQuery, TriangleCandidate};
pub use ray::{Barycentrics, HitKind, Primitive, PrimitiveId, RayDesc, RayValues};
pub use top_level::{Instance, TopLevel};
pub use transform::Transform3x4;
