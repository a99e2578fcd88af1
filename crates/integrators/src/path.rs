//! Path tracing, iterative: next-event estimation at every event, weighted with scattering by the power heuristic; Russian roulette
//! on the throughput, on surfaces alone or through media. Paths of neighbouring pixels share what they
//! find from the first bounce on ([`crate::reuse`]).

use crate::{
    Counters, Depth, Integrator, Survey, Tactics,
    reuse::{self, Room, Seat, Suffix, whole},
    walk::{Arrival, Leg, Vertex, arrive, escape, escape_by_group},
};
use steradian_core::{Scene, sampler::PixelSampler};
use steradian_math::{Ray, Spectrum, spectra::Wavelengths};

/// The path tracer. Without `MEDIA` these are ignored; surfaces that scatter nothing are passed.
#[derive(Clone, Copy, Debug)]
pub struct PathTracer<const MEDIA: bool> {
    /// How far paths are followed; events in media count as those on surfaces.
    pub depth: Depth,
    /// What is done against noise.
    pub tactics: Tactics,
}

/// The path tracer between surfaces.
pub type Path = PathTracer<false>;

/// The path tracer through participating media. Passing straight through a thin pane is no scattering event.
pub type VolPath = PathTracer<true>;

impl<const MEDIA: bool> PathTracer<MEDIA> {
    /// Adds what a leg that meets nothing brings.
    #[inline]
    fn escape(&self, scene: &Scene, leg: &Leg, sum: &mut Spectrum, lambda: &Wavelengths, counters: &mut Counters) {
        if !counters.by_group.is_empty() {
            escape_by_group(scene, leg, &self.depth, lambda, counters);
        }
        escape(scene, leg, sum, &self.depth, lambda);
    }

    /// What a leg that arrived at a vertex brings from there; of a `branch` it is decided that it goes on.
    #[inline]
    #[allow(clippy::too_many_arguments)]
    fn follow<'s>(
        &self,
        scene: &'s Scene,
        survey: &Survey,
        vertex: &Vertex<'s>,
        mut leg: Leg,
        mut is_branch: bool,
        sampler: &PixelSampler,
        lambda: &mut Wavelengths,
        counters: &mut Counters,
    ) -> Spectrum {
        let mut vertex = vertex;
        let mut next = Arrival::End;
        let mut sum = Spectrum::ZERO;
        loop {
            let branches = if is_branch { 1 } else { leg.branches(vertex, survey, sampler, lambda) };
            is_branch = false;
            if branches != 1 {
                return self.split(scene, survey, vertex, leg, branches, sum, sampler, lambda, counters);
            }
            // Light that arrives straight from a light.
            sum += leg.direct::<MEDIA>(vertex, scene, sampler, lambda, counters);
            // Scatter.
            let Some(s) = vertex.sample(&leg, sampler, survey) else { return sum };
            leg.turn::<MEDIA>(scene, vertex, &s);
            if !leg.beta.is_finite() {
                // Handed to the film, which counts it.
                return leg.beta;
            }
            if !leg.goes_on(survey, &self.depth, sampler, lambda) {
                return sum;
            }
            // Follow the ray to the next vertex; collect what shines there.
            arrive::<MEDIA>(scene, &mut leg, &mut sum, &self.depth, sampler, lambda, counters, &mut next);
            match &next {
                Arrival::Vertex(v) => vertex = v,
                Arrival::End => return sum,
                Arrival::Escaped => {
                    self.escape(scene, &leg, &mut sum, lambda, counters);
                    return sum;
                }
            }
        }
    }

    /// Adds what several paths bring from a vertex to `sum`. Out of the way of paths that do not split.
    #[cold]
    #[inline(never)]
    #[allow(clippy::too_many_arguments)]
    fn split<'s>(
        &self,
        scene: &'s Scene,
        survey: &Survey,
        vertex: &Vertex<'s>,
        leg: Leg,
        branches: u32,
        mut sum: Spectrum,
        sampler: &PixelSampler,
        lambda: &Wavelengths,
        counters: &mut Counters,
    ) -> Spectrum {
        for k in 0..branches {
            let (mut left, sampler) = (*lambda, sampler.branch(leg.events, k));
            let branch = self.follow(scene, survey, vertex, leg, true, &sampler, &mut left, counters);
            sum += whole(branch, &left, lambda, scene.mode);
        }
        sum
    }
}

impl<const MEDIA: bool> Suffix<MEDIA> for PathTracer<MEDIA> {
    fn depth(&self) -> &Depth {
        &self.depth
    }

    fn tactics(&self) -> &Tactics {
        &self.tactics
    }

    #[inline]
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
        self.follow(scene, survey, vertex, leg, false, sampler, lambda, counters)
    }
}

impl<const MEDIA: bool> Integrator for PathTracer<MEDIA> {
    #[inline]
    fn radiance(
        &self,
        scene: &Scene,
        survey: &Survey,
        ray: Ray,
        sampler: &PixelSampler,
        lambda: &mut Wavelengths,
        counters: &mut Counters,
    ) -> Spectrum {
        let (mut leg, mut sum, mut first) = (Leg::camera(scene, ray), Spectrum::ZERO, Arrival::End);
        arrive::<MEDIA>(scene, &mut leg, &mut sum, &self.depth, sampler, lambda, counters, &mut first);
        match &first {
            Arrival::Vertex(v) => {
                leg.weigh(v, survey, lambda);
                sum + self.leaving(scene, survey, v, leg, sampler, lambda, counters)
            }
            Arrival::End => sum,
            Arrival::Escaped => {
                self.escape(scene, &leg, &mut sum, lambda, counters);
                sum
            }
        }
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
