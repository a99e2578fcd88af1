//! Common parts of all methods of light transport: the state of a path and its vertices, following it to the next
//! vertex, next-event estimation, emission and environments, media, Russian roulette, and weights of multiple
//! importance sampling.
//!
//! * `walk` is the loop of path tracing: at each vertex the light sample, the direction, roulette, and the way to the
//!   next vertex (`follow`). A `PathState` draws light samples and directions at a `Vertex`; a `PathContext` carries
//!   scene, random numbers, wavelengths and counters; a `Sink` takes the light that a path finds, or records its way.
//! * Light samples and BSDF samples are weighted by the power heuristic. The density of a light sample includes the
//!   probability of choosing that light.
//! * `flight` and `tracking` sample distances in homogeneous media and in media that vary; `attenuation` takes shadow
//!   rays through media, interfaces and thin panes. Passing an interface straight is not a scattering event.
//! * `volume_emission` draws light samples of emissive media, `subsurface` the points at which light leaves a body
//!   again.

pub mod attenuation;
#[cfg(test)]
mod differential_tests;
pub mod flight;
mod follow;
mod guide;
pub mod nee;
pub mod roulette;
mod sink;
mod state;
pub mod subsurface;
pub mod tracking;
mod vertex;
pub mod volume_emission;
mod walk;

pub use follow::{Arrival, arrive, escape, meet};
pub use guide::{Directions, Guide, GuidedDirection, NoGuide};
pub use sink::{Segment, Sink, Step};
pub use state::PathState;
pub use vertex::Vertex;
pub use walk::{along, leaving};

use steradian_math::{Spectrum, spectra::Wavelengths};

/// Surfaces that scatter nothing are passed at most this often on a path.
pub const MAX_PASSES: u32 = 1 << 16;

pub use steradian_engine::Depth;

/// The power heuristic with exponent two for one sample of each of two techniques (Veach 1997, eq. 9.13).
#[inline(always)]
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
pub fn live_max(beta: Spectrum, lambda: &Wavelengths) -> f32 {
    if lambda.is_secondary_terminated() { beta[0] } else { beta.max_element() }
}
