//! Path tracing in the recursive form of the lab: the light that leaves a point is what it emits, what lights send it, and what
//! one random direction brings. The sum is carried along, so that it has the bits of the iterative form.

use crate::{
    Counters, Depth, Integrator, Survey, Tactics, dimension, nee,
    reuse::{self, Room, Seat, Suffix, whole},
    walk::{Leg, MAX_PASSES, Vertex},
};
use steradian_core::{Scene, sampler::PixelSampler};
use steradian_math::{Ray, Spectrum, spectra::Wavelengths};

/// Recursion goes no deeper than this, whatever the scene asks for: the stack is finite.
pub const DEEPEST: u32 = 256;

/// The recursive path tracer.
#[derive(Clone, Copy, Debug)]
pub struct PathRecursive {
    /// How far paths are followed.
    pub depth: Depth,
    /// What is done against noise.
    pub tactics: Tactics,
}

impl PathRecursive {
    /// Adds to `sum` what arrives along a leg.
    #[allow(clippy::too_many_arguments)]
    fn follow(
        &self,
        scene: &Scene,
        survey: &Survey,
        leg: Leg,
        sum: Spectrum,
        sampler: &PixelSampler,
        lambda: &mut Wavelengths,
        counters: &mut Counters,
    ) -> Spectrum {
        if counters.stop.is_asked() {
            return sum;
        }
        counters.rays += 1;
        let hidden = leg.events == 0 && self.depth.hide_emitters;
        // (2) Nothing is hit: the background.
        let Some(hit) = scene.intersect(&leg.ray) else {
            let background = nee::background(scene, leg.ray.origin, leg.ray.direction, &leg.origin, lambda);
            return if hidden { sum } else { sum + leg.beta * background };
        };
        // (1) A light is hit.
        let i = scene.interaction_of_light(&leg.ray, &hit);
        let sum = if hidden { sum } else { sum + leg.beta * nee::emission(scene, &i, &leg.origin, lambda) };
        // (3) The path is long enough, unless the surface lets it through.
        let is_last = leg.events >= self.depth.max.min(DEEPEST);
        if is_last && !scene.is_see_through {
            return sum;
        }
        let choice = sampler.get_1d_lazily(leg.dimension(dimension::MIXTURE), scene.has_mixtures);
        match scene.scattering_along(&i, leg.differential.as_ref(), choice, lambda) {
            Some(_) if is_last => sum,
            Some((scattering, frame)) => {
                let vertex = Vertex::Surface { i, scattering, frame, medium: None };
                let mut leg = leg;
                if leg.events == 0 {
                    leg.weigh(&vertex, survey, lambda);
                }
                self.scattered(scene, survey, &vertex, leg, sum, sampler, lambda, counters)
            }
            None if leg.passes >= MAX_PASSES.min(DEEPEST) => sum,
            None => {
                let differential = leg.differential.map(|d| d.advance(i.t));
                let leg = Leg { ray: i.spawn(leg.ray.direction), passes: leg.passes + 1, differential, ..leg };
                self.follow(scene, survey, leg, sum, sampler, lambda, counters)
            }
        }
    }

    /// Adds to `sum` what is scattered at a vertex.
    #[allow(clippy::too_many_arguments)]
    fn scattered(
        &self,
        scene: &Scene,
        survey: &Survey,
        vertex: &Vertex<'_>,
        mut leg: Leg,
        sum: Spectrum,
        sampler: &PixelSampler,
        lambda: &mut Wavelengths,
        counters: &mut Counters,
    ) -> Spectrum {
        let branches = leg.branches(vertex, survey, sampler, lambda);
        if branches == 1 {
            return self.branch(scene, survey, vertex, leg, sum, sampler, lambda, counters);
        }
        (0..branches).fold(sum, |sum, k| {
            let (mut left, sampler) = (*lambda, sampler.branch(leg.events, k));
            let branch = self.branch(scene, survey, vertex, leg, Spectrum::ZERO, &sampler, &mut left, counters);
            sum + whole(branch, &left, lambda, scene.mode)
        })
    }

    /// The same for one of the paths that go on there.
    #[allow(clippy::too_many_arguments)]
    fn branch(
        &self,
        scene: &Scene,
        survey: &Survey,
        vertex: &Vertex<'_>,
        mut leg: Leg,
        sum: Spectrum,
        sampler: &PixelSampler,
        lambda: &mut Wavelengths,
        counters: &mut Counters,
    ) -> Spectrum {
        let sum = sum + leg.direct::<false>(vertex, scene, sampler, lambda, counters);
        let Some(draw) = vertex.sample(&leg, sampler, survey) else { return sum };
        leg.turn::<false>(scene, vertex, &draw);
        if !leg.beta.is_finite() {
            return leg.beta;
        }
        if !leg.goes_on(survey, &self.depth, sampler, lambda) {
            return sum;
        }
        self.follow(scene, survey, leg, sum, sampler, lambda, counters)
    }
}

impl Suffix<false> for PathRecursive {
    fn depth(&self) -> &Depth {
        &self.depth
    }

    fn tactics(&self) -> &Tactics {
        &self.tactics
    }

    fn leaving<'s>(
        &self,
        scene: &'s Scene,
        survey: &Survey,
        vertex: &Vertex<'s>,
        leg: Leg,
        sampler: &PixelSampler,
        lambda: &mut Wavelengths,
        counters: &mut Counters,
    ) -> Spectrum {
        self.scattered(scene, survey, vertex, leg, Spectrum::ZERO, sampler, lambda, counters)
    }
}

impl Integrator for PathRecursive {
    fn radiance(
        &self,
        scene: &Scene,
        survey: &Survey,
        ray: Ray,
        sampler: &PixelSampler,
        lambda: &mut Wavelengths,
        counters: &mut Counters,
    ) -> Spectrum {
        self.follow(scene, survey, Leg::camera(scene, ray), Spectrum::ZERO, sampler, lambda, counters)
    }

    fn group<'s>(
        &self,
        scene: &'s Scene,
        survey: &Survey,
        seats: &mut [Seat],
        room: &mut Room<'s>,
        counters: &mut Counters,
    ) {
        reuse::group(self, scene, survey, seats, room, counters);
    }
}
