//! The steps of which path tracers are made: along a ray to the next surface that scatters, and on from there.

use crate::{Counters, Depth, dimension, live_max, nee};
use steradian_core::{
    Scene,
    bsdf::{BsdfSample, TransportMode},
    material::Scattering,
    sampler::PixelSampler,
    scene::Interaction,
};
use steradian_math::{Frame, Ray, Spectrum, spectra::Wavelengths};

/// Surfaces that scatter nothing are passed at most this often on the way to the next event.
pub(crate) const MAX_PASSES: u32 = 1 << 16;

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

/// A path that sets out along a ray.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Leg {
    /// Where it goes.
    pub ray: Ray,
    /// What it carries.
    pub beta: Spectrum,
    /// The compression of radiance by refraction so far, inverted.
    pub eta2: f32,
    /// Where it last scattered.
    pub origin: nee::Origin,
    /// How often it scattered.
    pub events: u32,
    /// How many surfaces that scatter nothing it passed.
    pub passes: u32,
}

impl Leg {
    /// From the camera.
    #[inline]
    pub fn camera(ray: Ray) -> Self {
        Self { ray, beta: Spectrum::ONE, eta2: 1.0, origin: None, events: 0, passes: 0 }
    }

    /// On from a vertex in the direction that was drawn there.
    #[inline]
    pub fn turn(&mut self, v: &Vertex<'_>, s: &BsdfSample) {
        self.beta *= s.weight;
        self.eta2 *= s.eta * s.eta;
        self.origin =
            if s.lobe.is_specular() { None } else { Some((nee::context(&v.i, &v.frame, &v.scattering.bsdf), s.pdf)) };
        self.ray = v.i.spawn(v.frame.to_world(s.wi));
        self.events += 1;
    }
}

/// Where a path scatters.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Vertex<'s> {
    /// The point.
    pub i: Interaction,
    /// How it scatters.
    pub scattering: Scattering<'s>,
    /// The shading frame.
    pub frame: Frame,
}

impl Vertex<'_> {
    /// Light straight from a light, reflected back along the path.
    #[inline]
    pub fn direct(
        &self,
        scene: &Scene,
        event: u32,
        sampler: &PixelSampler,
        lambda: &Wavelengths,
        counters: &mut Counters,
    ) -> Spectrum {
        let bsdf = &self.scattering.bsdf;
        if bsdf.is_specular() || !scene.lights.can_sample() {
            return Spectrum::ZERO;
        }
        nee::direct(scene, &self.i, &self.frame, bsdf, event, sampler, lambda, counters)
    }

    /// A direction drawn by scattering.
    #[inline]
    pub fn sample(&self, event: u32, sampler: &PixelSampler) -> Option<BsdfSample> {
        let u = sampler.get_1d(dimension::at(event, dimension::LOBE));
        let u2 = sampler.get_2d(dimension::at(event, dimension::DIRECTION));
        self.scattering.bsdf.sample(self.frame.to_local(self.i.wo), u, u2, TransportMode::Radiance)
    }
}

/// What a ray leads to. In place, since nothing is allocated per sample.
#[allow(clippy::large_enum_variant)]
pub(crate) enum Arrival<'s> {
    /// A surface that scatters, within the depth.
    Vertex(Vertex<'s>),
    /// The path ends on a surface.
    End,
    /// Nothing is met.
    Escaped,
}

/// Follows a leg to the next surface that scatters, passing those that do not; adds what surfaces emit on the way to `sum`. The
/// background is left to the caller.
#[inline]
pub(crate) fn arrive<'s>(
    scene: &'s Scene,
    leg: &mut Leg,
    sum: &mut Spectrum,
    depth: &Depth,
    sampler: &PixelSampler,
    lambda: &mut Wavelengths,
    counters: &mut Counters,
) -> Arrival<'s> {
    loop {
        counters.rays += 1;
        let Some(hit) = scene.intersect(&leg.ray) else { return Arrival::Escaped };
        let i = scene.interaction(&leg.ray, &hit);
        if !(leg.events == 0 && depth.hide_emitters) {
            *sum += leg.beta * nee::emission(scene, &i, &leg.origin, lambda);
        }
        if leg.events >= depth.max {
            return Arrival::End;
        }
        let choice = sampler.get_1d_lazily(dimension::at(leg.events, dimension::MIXTURE), scene.has_mixtures);
        if let Some((scattering, frame)) = scene.scattering(&i, choice, lambda) {
            return Arrival::Vertex(Vertex { i, scattering, frame });
        }
        leg.passes += 1;
        if leg.passes > MAX_PASSES {
            return Arrival::End;
        }
        leg.ray = i.spawn(leg.ray.direction);
    }
}

/// Adds the light of the environments that a leg met to `sum`.
#[inline]
pub(crate) fn escape(scene: &Scene, leg: &Leg, sum: &mut Spectrum, depth: &Depth, lambda: &Wavelengths) {
    if !(leg.events == 0 && depth.hide_emitters) {
        *sum += leg.beta * nee::background(scene, leg.ray.origin, leg.ray.direction, &leg.origin, lambda);
    }
}
