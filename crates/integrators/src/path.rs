//! Path tracing, iterative: next-event estimation at every event, weighted with scattering by the power heuristic; Russian roulette
//! on the throughput (M150, M151, M155, M161).

use crate::{Counters, Depth, Integrator, dimension, live_max, nee};
use steradian_core::{Scene, bsdf::TransportMode, sampler::PixelSampler};
use steradian_math::{Ray, Spectrum, spectra::Wavelengths};

/// Surfaces that scatter nothing are passed at most this often on the way to the next event.
pub(crate) const MAX_PASSES: u32 = 1 << 16;

/// The path tracer. Media are ignored, surfaces that scatter nothing are passed.
#[derive(Clone, Copy, Debug)]
pub struct Path {
    /// How far paths are followed.
    pub depth: Depth,
}

/// Roulette is played below this throughput only: stopping paths that carry much costs more in variance than it saves.
const ROULETTE_BELOW: f32 = 1.0 / 3.0;

/// After this many events roulette is played whatever the throughput, with the survival at most the second number: between surfaces
/// that absorb nothing, and in dense media, paths would never end.
const LONG_PATH: (u32, f32) = (1000, 0.99);

/// Russian roulette after `events` scattering events: the throughput to go on with, or `None` where the path ends. It plays on the
/// throughput with the compression of radiance by refraction (`eta2`) taken out.
#[inline]
pub(crate) fn roulette(
    beta: Spectrum,
    eta2: f32,
    events: u32,
    depth: &Depth,
    sampler: &PixelSampler,
    lambda: &Wavelengths,
) -> Option<Spectrum> {
    let live = live_max(beta, lambda);
    if live <= 0.0 {
        return None;
    }
    let mut survival = live * eta2 * (1.0 / ROULETTE_BELOW);
    if events > LONG_PATH.0 {
        survival = survival.min(LONG_PATH.1);
    }
    if events <= depth.roulette_after || survival >= 1.0 {
        return Some(beta);
    }
    (sampler.get_1d(dimension::at(events, dimension::ROULETTE)) < survival).then(|| beta / survival)
}

impl Integrator for Path {
    #[inline]
    fn radiance(
        &self,
        scene: &Scene,
        mut ray: Ray,
        sampler: &PixelSampler,
        lambda: &mut Wavelengths,
        counters: &mut Counters,
    ) -> Spectrum {
        let mut sum = Spectrum::ZERO;
        let mut beta = Spectrum::ONE;
        let mut eta2 = 1.0_f32;
        let mut origin: nee::Origin = None;
        let mut events = 0;
        let mut passes = 0;
        loop {
            // Follow the ray to the next surface; collect what shines there.
            counters.rays += 1;
            let hidden = events == 0 && self.depth.hide_emitters;
            let Some(hit) = scene.intersect(&ray) else {
                if !hidden {
                    sum += beta * nee::background(scene, ray.origin, ray.direction, &origin, lambda);
                }
                return sum;
            };
            let i = scene.interaction(&ray, &hit);
            if !hidden {
                sum += beta * nee::emission(scene, &i, &origin, lambda);
            }
            if events >= self.depth.max {
                return sum;
            }
            // Pass surfaces that scatter nothing.
            let choice = sampler.get_1d_lazily(dimension::at(events, dimension::MIXTURE), scene.has_mixtures);
            let Some((scattering, frame)) = scene.scattering(&i, choice, lambda) else {
                passes += 1;
                if passes > MAX_PASSES {
                    return sum;
                }
                ray = i.spawn(ray.direction);
                continue;
            };
            let bsdf = &scattering.bsdf;
            // Light that arrives straight from a light.
            if !bsdf.is_specular() && scene.lights.can_sample() {
                sum += beta * nee::direct(scene, &i, &frame, bsdf, events, sampler, lambda, counters);
            }
            // Scatter.
            let u = sampler.get_1d(dimension::at(events, dimension::LOBE));
            let u2 = sampler.get_2d(dimension::at(events, dimension::DIRECTION));
            let Some(s) = bsdf.sample(frame.to_local(i.wo), u, u2, TransportMode::Radiance) else { return sum };
            beta *= s.weight;
            if !beta.is_finite() {
                // Handed to the film, which counts it.
                return beta;
            }
            eta2 *= s.eta * s.eta;
            origin = if s.lobe.is_specular() { None } else { Some((nee::context(&i, &frame, bsdf), s.pdf)) };
            ray = i.spawn(frame.to_world(s.wi));
            events += 1;
            match roulette(beta, eta2, events, &self.depth, sampler, lambda) {
                Some(b) => beta = b,
                None => return sum,
            }
        }
    }
}
