//! The ray-tracing model of DXR and Vulkan in software: acceleration structures of two levels, shaders of six stages,
//! shader tables, and ray queries. It runs anywhere, gives the same bits on every machine and for every number of
//! threads, and says which rule was broken where an API's behaviour is undefined.
//!
//! # A triangle
//!
//! ```
//! use std::sync::Arc;
//! use steradian_math::Vec3;
//! use steradian_rt::{context::*, *};
//!
//! // The types that the shaders exchange: a payload and the output are colours, nothing else is needed.
//! enum Colors {}
//! impl Interface for Colors {
//!     type Payload = Vec3;
//!     type Attributes = ();
//!     type Parameter = ();
//!     type Local = ();
//!     type Output = Vec3;
//! }
//!
//! struct Camera<'s>(&'s TopLevel);
//! impl RayGeneration<Colors> for Camera<'_> {
//!     fn run(&self, context: &mut RayGenerationContext<Colors>) -> Result<Vec3, Fault> {
//!         let LaunchValues { id: [x, y, _], size: [width, height, _] } = context.launch();
//!         let (x, y) = ((x as f32 + 0.5) / width as f32, (y as f32 + 0.5) / height as f32);
//!         let ray = RayDesc::new(Vec3::new(2.0 * x - 1.0, 1.0 - 2.0 * y, -1.0), Vec3::Z);
//!         let mut color = Vec3::ZERO;
//!         context.trace(&TraceRay::new(self.0, ray), &mut color)?;
//!         Ok(color)
//!     }
//! }
//!
//! struct Weights;
//! impl ClosestHit<Colors, Barycentrics> for Weights {
//!     fn run(&self, _: &mut ClosestHitContext<Colors>, color: &mut Vec3, at: &Barycentrics) -> Result<(), Fault> {
//!         *color = at.interpolate([Vec3::X, Vec3::Y, Vec3::Z]);
//!         Ok(())
//!     }
//! }
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! // A structure over structures.
//! let corners = [Vec3::new(-0.8, -0.7, 0.0), Vec3::new(0.0, 0.8, 0.0), Vec3::new(0.8, -0.7, 0.0)];
//! let triangles = [TriangleGeometry::new(&corners)];
//! let object = BottomLevel::build(Geometries::Triangles(&triangles), BuildOptions::default())?;
//! let scene = TopLevel::build(&[Instance::new(Arc::new(object))], BuildOptions::default())?;
//!
//! // A pipeline, and tables that say which of its shaders runs where.
//! let library = Library::<Colors, _, _>::new()
//!     .with_ray_generation(Export::new("camera", Camera(&scene)))
//!     .with_hit_group(Export::new("weights", TriangleGroup { any_hit: (), closest_hit: Weights }))
//!     .with_miss(Export::new("black", ()));
//! let pipeline = Pipeline::link([library], PipelineConfig::default())?;
//! let tables = ShaderTables::new(Record::new(pipeline.ray_generation("camera").ok_or("no such name")?, ()))
//!     .with_hit_groups(ShaderTable::new(vec![Record::new(pipeline.hit_group("weights").ok_or("no such name")?, ())]))
//!     .with_miss(ShaderTable::new(vec![Record::new(pipeline.miss("black").ok_or("no such name")?, ())]));
//!
//! let picture = pipeline.launch(&tables, [64, 64, 1])?;
//! assert_eq!(picture[0], Vec3::ZERO);
//! assert!(picture[32 * 64 + 32].min_element() > 0.1);
//! # Ok(())
//! # }
//! ```
//!
//! # What there is
//!
//! * [`BottomLevel`] and [`TopLevel`]: structures, built, updated, traced in.
//! * [`RayGeneration`], [`Intersection`], [`AnyHit`], [`ClosestHit`], [`Miss`], [`Callable`]: the stages, as traits.
//!   Their [contexts](context) offer what is legal in a stage, so that what is not does not compile:
//!
//! | | ray generation | intersection | any hit | closest hit | miss | callable |
//! |---|---|---|---|---|---|---|
//! | `trace` | * | | | * | * | |
//! | `call` | * | | | * | * | * |
//! | `report_hit` | | * | | | | |
//! | `accept_hit` | | | * | | | |
//! | `ignore_hit` | | | * | | | |
//! | `accept_hit_and_end_search` | | | * | | | |
//! | `launch` | * | * | * | * | * | * |
//! | `local` | * | * | * | * | * | * |
//! | `ray` | | * | * | * | * | |
//! | `primitive` | | * | * | * | | |
//! | `hit_kind` | | | * | * | | |
//!
//! * [`TriangleGroup`], [`ProceduralGroup`]: hit groups. A pipeline of one type of them is compiled for it; several
//!   types are a `Box<dyn HitGroup<I>>`.
//! * [`Library`], [`Pipeline`], [`ShaderTables`]: shaders by name, linked; records that choose among them.
//! * [`BottomLevel::sizes`], [`DeferredBuild`], [`BottomLevel::compacted`], [`TopLevel::serialize`]: sizes known before
//!   building, builds by the caller's threads, compaction, structures as bytes.
//! * [`Pipeline::capture`], [`Pipeline::replay`]: launches as bytes, and again.
//! * [`RayQuery`]: tracing without shaders.
//! * [`Pipeline::inspect`]: what happens for one launch id, as text and as JSON.
//!
//! # Rules that always hold
//!
//! * Of hits at equal distance the one with the smaller [`PrimitiveId`] wins.
//! * Candidates are asked about from near to far, each at most once, which is more than the APIs promise; a procedural
//!   primitive has the distance where the ray enters its box.
//! * A triangle shows its front where its vertices are clockwise as seen from the ray's origin, in object space
//!   taken as left-handed, which is counter-clockwise taken as right-handed. An instance's mirror does not change that,
//!   a geometry's does.
//! * Nothing panics on any geometry, ray, flag or index.

mod bottom_level;
mod bytes;
mod capture;
mod certain;
mod committed;
mod compaction;
pub mod context;
mod decision;
mod deferred;
mod entered;
pub mod error;
mod event;
mod flags;
mod geometry;
mod group;
mod handle_bytes;
mod inspect;
mod interface;
mod launch;
mod pipeline;
mod plan;
mod query;
mod queue;
mod ray;
mod search;
mod serial;
mod serial_top;
mod sizes;
mod stages;
pub mod table;
mod top_level;
mod trace;
mod transform;

pub use bottom_level::{BottomLevel, BuildOptions, MAX_GEOMETRIES, MAX_PRIMITIVES, Preference};
pub use capture::Capture;
pub use context::{LaunchValues, TraceRay};
pub use decision::{Decision, EndSearch};
pub use deferred::{DeferredBuild, Join};
pub use error::{
    BuildError, DeferredError, Fault, LaunchError, LoadError, PipelineError, RayError, ReplayError, UnknownHandle,
};
pub use event::{Entry, Event, Stage};
pub use flags::{ExclusiveRayFlags, GeometryFlags, InstanceFlags, RayFlags};
pub use geometry::{BoxGeometry, Geometries, Indices, TriangleGeometry};
pub use group::{HitAttributes, HitGroup, ProceduralGroup, TriangleGroup};
pub use handle_bytes::{HANDLE_BYTES, Kind};
pub use inspect::Inspection;
pub use interface::Interface;
pub use launch::MAX_LAUNCH_IDS;
pub use pipeline::{Export, HitGroupStack, Library, MAX_CALL_DEPTH, MAX_RECURSION_DEPTH, Pipeline, PipelineConfig};
pub use query::{CommittedHit, ProceduralCandidate, QueryCandidate, RayQuery, TriangleCandidate};
pub use ray::{Barycentrics, HitKind, Primitive, PrimitiveId, RayDesc, RayValues};
pub use sizes::{BuildSizes, PrimitiveCounts};
pub use stages::{AnyHit, Callable, ClosestHit, Intersection, Miss, RayGeneration};
pub use table::{Handle, Place, Record, ShaderTable, ShaderTables};
pub use top_level::{Instance, TopLevel};
pub use transform::Transform3x4;
