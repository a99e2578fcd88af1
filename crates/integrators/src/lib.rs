//! Light transport: estimators of the radiance that a camera ray carries, and methods by passes. The crate
//! `steradian-engine` turns them into a film.

pub mod ao;
pub mod passes;
pub mod path;
pub mod path_recursive;
pub mod radiosity;
pub mod raycast;
pub mod registry;
pub mod reuse;
pub mod stokes;
pub mod whitted;

mod caustics;
mod effort;
mod flight;
mod nee;
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
pub use registry::{INTEGRATORS, IntegratorKind, Render};
pub use steradian_core::film::Film;
pub use steradian_engine::{Control, Counters, Doubt, Integrator, Plan, SCALES, Session, Stop};

pub(crate) use steradian_engine::{adaptive, dimension, partition};
use steradian_math::{Spectrum, spectra::Wavelengths};

/// How far paths are followed.
#[derive(Clone, Copy, Debug)]
pub struct Depth {
    /// Most scattering events; `u32::MAX` for no limit.
    pub max: u32,
    /// Scattering events before Russian roulette.
    pub roulette_after: u32,
    /// Whether lights are invisible to the camera.
    pub hide_emitters: bool,
}

/// The power heuristic with exponent two for one sample of each of two techniques (Veach 1997, eq. 9.13).
#[inline]
pub fn power_heuristic(a: f32, b: f32) -> f32 {
    if a == 0.0 {
        return 0.0;
    }
    // By the ratio, so that squares of large densities stay finite.
    let r = b / a;
    1.0 / (1.0 + r * r)
}

/// The largest throughput over the lanes that still count.
#[inline]
pub(crate) fn live_max(beta: Spectrum, lambda: &Wavelengths) -> f32 {
    if lambda.is_secondary_terminated() { beta[0] } else { beta.max_element() }
}
