//! Light transport: estimators of the radiance that a camera ray carries, and methods by passes. The crate
//! `steradian-engine` turns them into a film.

pub mod ao;
pub mod meter;
pub mod passes;
pub mod path;
pub mod radiosity;
pub mod raycast;
pub mod registry;
pub mod stokes;
pub mod whitted;

mod caustics;
mod precomputed;
mod receiver;
mod shared_path;
mod sharing;
pub mod traced;
pub mod transient;
mod trials;
mod wave;

#[cfg(test)]
mod sizes_tests;
#[cfg(test)]
mod stop_tests;

pub use precomputed::{PathEffort, Precomputed, VarianceReduction};
pub use registry::IntegratorKind;
pub use shared_path::SharedPath;
pub use steradian_core::film::Film;
pub use steradian_engine::{Control, Counters, Doubt, History, Integrator, PathContext, Plan, SCALES, Session, Stop};

pub(crate) use steradian_engine::{adaptive, dimension, partition};
pub use steradian_transport::Depth;
pub(crate) use steradian_transport::{MAX_PASSES, live_max, nee};
