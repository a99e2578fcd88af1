//! Light transport: estimators of the radiance that a camera ray carries, and methods by passes. The crate
//! `steradian-engine` turns them into a film.

pub mod ao;
pub mod passes;
pub mod path;
pub mod radiosity;
pub mod raycast;
pub mod registry;
pub mod reuse;
pub mod stokes;
pub mod whitted;

mod caustics;
mod effort;
mod flight;
mod precomputed;
mod probe;
mod splitting;
mod tracking;
mod walk;

#[cfg(test)]
mod differential_tests;
#[cfg(test)]
mod sizes_tests;
#[cfg(test)]
mod stop_tests;

pub use effort::PathEffort;
pub use precomputed::{Precomputed, VarianceReduction};
pub use registry::{INTEGRATORS, IntegratorKind};
pub use steradian_core::film::Film;
pub use steradian_engine::{Control, Counters, Doubt, Integrator, Plan, SCALES, Session, Stop};

pub(crate) use steradian_engine::{adaptive, dimension, partition};
pub use steradian_transport::Depth;
pub(crate) use steradian_transport::{MAX_PASSES, live_max, nee, power_heuristic};
