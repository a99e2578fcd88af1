//! Path tracing in the recursive form of the lab (M160): the light that leaves a point is what it emits, what lights send it, and what
//! one random direction brings. The sum is carried along, so that it has the bits of the iterative form.

use crate::{
    Counters, Depth, Integrator, dimension, nee,
    reuse::{self, Seat, Suffix},
    walk::{Leg, MAX_PASSES, Vertex, roulette},
};
use steradian_core::{Scene, bsdf::TransportMode, sampler::PixelSampler};
use steradian_math::{Ray, Spectrum, spectra::Wavelengths};

/// Recursion goes no deeper than this, whatever the scene asks for: the stack is finite.
pub const DEEPEST: u32 = 256;

/// The recursive path tracer.
#[derive(Clone, Copy, Debug)]
pub struct PathRecursive {
    /// How far paths are followed.
    pub depth: Depth,
    /// Paths that share what they find; 1 for none.
    pub reuse: u32,
}

impl PathRecursive {
    /// Adds to `sum` what arrives along a leg.
    fn follow(
        &self,
        scene: &Scene,
        leg: Leg,
        sum: Spectrum,
        sampler: &PixelSampler,
        lambda: &mut Wavelengths,
        counters: &mut Counters,
    ) -> Spectrum {
        let Leg { ray, beta, origin, events, passes, .. } = leg;
        counters.rays += 1;
        let hidden = events == 0 && self.depth.hide_emitters;
        // (2) Nothing is hit: the background.
        let Some(hit) = scene.intersect(&ray) else {
            let background = nee::background(scene, ray.origin, ray.direction, &origin, lambda);
            return if hidden { sum } else { sum + beta * background };
        };
        // (1) A light is hit.
        let i = scene.interaction(&ray, &hit);
        let sum = if hidden { sum } else { sum + beta * nee::emission(scene, &i, &origin, lambda) };
        // (3) The path is long enough.
        if events >= self.depth.max.min(DEEPEST) {
            return sum;
        }
        let choice = sampler.get_1d_lazily(dimension::at(events, dimension::MIXTURE), scene.has_mixtures);
        match scene.scattering(&i, choice, lambda) {
            Some((scattering, frame)) => {
                self.scattered(scene, Vertex { i, scattering, frame }, leg, sum, sampler, lambda, counters)
            }
            None if passes >= MAX_PASSES.min(DEEPEST) => sum,
            None => {
                let leg = Leg { ray: i.spawn(ray.direction), passes: passes + 1, ..leg };
                self.follow(scene, leg, sum, sampler, lambda, counters)
            }
        }
    }

    /// Adds to `sum` what is scattered at a vertex.
    #[allow(clippy::too_many_arguments)]
    fn scattered(
        &self,
        scene: &Scene,
        Vertex { i, scattering, frame }: Vertex<'_>,
        Leg { beta, eta2, events, passes, .. }: Leg,
        sum: Spectrum,
        sampler: &PixelSampler,
        lambda: &mut Wavelengths,
        counters: &mut Counters,
    ) -> Spectrum {
        let bsdf = &scattering.bsdf;
        let sum = if bsdf.is_specular() || !scene.lights.can_sample() {
            sum
        } else {
            sum + beta * nee::direct(scene, &i, &frame, bsdf, events, sampler, lambda, counters)
        };
        let u = sampler.get_1d(dimension::at(events, dimension::LOBE));
        let u2 = sampler.get_2d(dimension::at(events, dimension::DIRECTION));
        let Some(s) = bsdf.sample(frame.to_local(i.wo), u, u2, TransportMode::Radiance) else { return sum };
        let beta = beta * s.weight;
        if !beta.is_finite() {
            return beta;
        }
        let (eta2, events) = (eta2 * (s.eta * s.eta), events + 1);
        let Some(beta) = roulette(beta, eta2, events, &self.depth, sampler, lambda) else { return sum };
        let origin = if s.lobe.is_specular() { None } else { Some((nee::context(&i, &frame, bsdf), s.pdf)) };
        let leg = Leg { ray: i.spawn(frame.to_world(s.wi)), beta, eta2, origin, events, passes };
        self.follow(scene, leg, sum, sampler, lambda, counters)
    }
}

impl Suffix for PathRecursive {
    fn depth(&self) -> &Depth {
        &self.depth
    }

    fn leaving<'s>(
        &self,
        scene: &'s Scene,
        vertex: Vertex<'s>,
        leg: Leg,
        sampler: &PixelSampler,
        lambda: &mut Wavelengths,
        counters: &mut Counters,
    ) -> Spectrum {
        self.scattered(scene, vertex, leg, Spectrum::ZERO, sampler, lambda, counters)
    }
}

impl Integrator for PathRecursive {
    fn radiance(
        &self,
        scene: &Scene,
        ray: Ray,
        sampler: &PixelSampler,
        lambda: &mut Wavelengths,
        counters: &mut Counters,
    ) -> Spectrum {
        self.follow(scene, Leg::camera(ray), Spectrum::ZERO, sampler, lambda, counters)
    }

    fn reuse(&self) -> u32 {
        self.reuse
    }

    fn group(&self, scene: &Scene, is_open: bool, seats: &mut [Seat], counters: &mut Counters) {
        reuse::group(self, scene, is_open, seats, counters);
    }
}
