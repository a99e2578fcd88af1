//! Light transport: estimators of the radiance that a camera ray carries, and methods by passes. The crate
//! `steradian-engine` turns them into a film.

pub mod ao;
pub mod gather;
pub mod irradiance_cache;
pub mod meter;
pub mod passes;
pub mod path;
pub mod radiosity;
pub mod raycast;
pub mod stokes;
pub mod structure;
pub mod whitted;

mod caustics;
mod guiding;
mod precomputed;
mod receiver;
mod regions;
mod shared_path;
mod sharing;
mod support;
pub mod traced;
pub mod transient;
mod trials;
mod wave;

#[cfg(test)]
mod sizes_tests;
#[cfg(test)]
mod stop_tests;

pub use precomputed::{PathEffort, Precomputed, VarianceReduction};
pub use shared_path::SharedPath;
pub use steradian_core::film::Film;
pub use steradian_engine::{
    Control, Counters, Doubt, History, Integrator, Method, MethodKind, PathContext, Plan, SCALES, Session, Stop,
};

pub(crate) use steradian_engine::{adaptive, dimension, partition};
pub use steradian_transport::Depth;
pub(crate) use steradian_transport::{MAX_PASSES, live_max, nee};

/// All methods of light transport, by name.
pub const METHODS: &[MethodKind] = &[
    shared_path::PATH,
    shared_path::VOLPATH,
    shared_path::DIRECT,
    whitted::WHITTED,
    ao::AO,
    gather::GATHER,
    irradiance_cache::IRRADIANCE_CACHE,
    raycast::RAYCAST,
    structure::STRUCTURE,
    radiosity::RADIOSITY,
    passes::LIGHT,
    passes::BDPT,
    passes::VCM,
    passes::SPPM,
    passes::PHOTON,
    passes::PSSMLT,
    passes::MMLT,
    transient::TRANSIENT,
    stokes::STOKES[0],
    stokes::STOKES[1],
    stokes::STOKES[2],
    stokes::STOKES[3],
];
