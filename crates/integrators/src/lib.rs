//! Light transport: estimators of the radiance that a camera ray carries, and the session that turns them into a film.

pub mod adaptive;
pub mod ao;
pub mod features;
pub mod method;
pub mod passes;
pub mod path;
pub mod path_recursive;
pub mod radiosity;
pub mod raycast;
pub mod registry;
pub mod reuse;
pub mod session;
pub mod stokes;
pub mod whitted;

mod caustics;
mod effort;
mod flight;
mod nee;
mod partition;
mod precomputed;
mod probe;
mod splitting;
mod tracking;
mod walk;

#[cfg(test)]
mod differential_tests;

pub use effort::PathEffort;
pub use method::{Method, Session};
pub use precomputed::{Precomputed, VarianceReduction};
pub use registry::{INTEGRATORS, IntegratorKind};
pub use session::{Control, Doubt, Plan, SCALES};
pub use steradian_core::film::Film;

use std::sync::{
    Arc,
    atomic::{AtomicBool, Ordering},
};
use steradian_core::{Scene, sampler::PixelSampler};
use steradian_math::{Ray, Spectrum, spectra::Wavelengths};

/// A wish to stop that is asked about wherever paths go on, so that it is answered at once. By default there is none.
#[derive(Clone, Debug, Default)]
pub struct Stop(Option<Arc<AtomicBool>>);

impl Stop {
    /// By a flag that somebody else sets.
    pub fn by(flag: &Arc<AtomicBool>) -> Self {
        Self(Some(Arc::clone(flag)))
    }

    /// Whether to stop. What is found from then on counts for nothing.
    #[inline]
    pub fn is_asked(&self) -> bool {
        self.0.as_ref().is_some_and(|flag| flag.load(Ordering::Relaxed))
    }
}

/// What was done, for reports. They are equal where the numbers are.
#[derive(Clone, Debug, Default)]
pub struct Counters {
    /// Rays traced, shadow rays among them.
    pub rays: u64,
    /// Camera samples taken.
    pub samples: u64,
    /// Samples that were not finite and count as black.
    pub nonfinite: u64,
    /// Whether what is counted is to end.
    pub stop: Stop,
    /// The light of each group that the path under way brings; empty where nobody asks.
    pub by_group: Vec<Spectrum>,
}

impl Counters {
    /// None yet, of what is to end when somebody wishes.
    pub fn until(stop: &Stop) -> Self {
        Self { stop: stop.clone(), ..Self::default() }
    }

    /// Adds what a path brings to the sum of its light's group.
    #[inline]
    pub(crate) fn note(&mut self, group: impl FnOnce() -> Option<u32>, light: Spectrum) {
        if !self.by_group.is_empty()
            && let Some(sum) = group().and_then(|g| self.by_group.get_mut(g as usize))
        {
            *sum += light;
        }
    }
}

impl PartialEq for Counters {
    fn eq(&self, o: &Self) -> bool {
        (self.rays, self.samples, self.nonfinite) == (o.rays, o.samples, o.nonfinite)
    }
}

impl Eq for Counters {}

impl std::ops::AddAssign<&Self> for Counters {
    fn add_assign(&mut self, o: &Self) {
        self.rays += o.rays;
        self.samples += o.samples;
        self.nonfinite += o.nonfinite;
    }
}

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

/// An estimator of radiance.
pub trait Integrator: Sync {
    /// The radiance that arrives along a camera ray. A pure function of its arguments, `counters` aside; `lambda` loses
    /// its secondary wavelengths where the path disperses.
    fn radiance(
        &self,
        scene: &Scene,
        precomputed: &Precomputed,
        ray: Ray,
        sampler: &PixelSampler,
        lambda: &mut Wavelengths,
        counters: &mut Counters,
    ) -> Spectrum;

    /// Takes a sample for each pixel of a group. By default nothing is
    /// shared: [`Integrator::radiance`], with the pixels' own numbers.
    fn group<'s>(
        &self,
        scene: &'s Scene,
        precomputed: &Precomputed,
        pixel_samples: &mut [reuse::PixelSample],
        _room: &mut reuse::GroupBuffer<'s>,
        counters: &mut Counters,
    ) {
        for pixel_sample in pixel_samples {
            pixel_sample.radiance = self.radiance(
                scene,
                precomputed,
                pixel_sample.ray,
                &pixel_sample.own,
                &mut pixel_sample.lambda,
                counters,
            );
        }
    }
}

/// The dimensions of a camera sample and of each scattering event. Fixed, so that every number is a function of what it
/// is for.
pub(crate) mod dimension {
    /// Place on the film.
    pub const FILM: u32 = 0;
    /// Place on the lens.
    pub const LENS: u32 = 1;
    /// Wavelengths.
    pub const WAVELENGTH: u32 = 2;
    /// Moment of the exposure.
    pub const TIME: u32 = 3;
    const FIRST_EVENT: u32 = 4;
    const PER_EVENT: u32 = 10;
    /// Choice of a light.
    pub const LIGHT: u32 = 0;
    /// Place on the light.
    pub const LIGHT_POINT: u32 = 1;
    /// Choice of a lobe.
    pub const LOBE: u32 = 2;
    /// Direction.
    pub const DIRECTION: u32 = 3;
    /// Russian roulette.
    pub const ROULETTE: u32 = 4;
    /// Choice in a mixture of materials.
    pub const MIXTURE: u32 = 5;
    /// Free flight in a medium.
    pub const FLIGHT: u32 = 6;
    /// Lane by which the flight is drawn.
    pub const LANE: u32 = 7;
    /// How many paths go on.
    pub const BRANCHES: u32 = 8;

    /// The dimension of a decision at a scattering event.
    #[inline]
    pub const fn at(event: u32, decision: u32) -> u32 {
        FIRST_EVENT + event.wrapping_mul(PER_EVENT) + decision
    }
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
