//! Path tracing, iterative: next-event estimation at every event, weighted with scattering by the power heuristic;
//! Russian roulette on the throughput, on surfaces alone or through media. Paths of neighbouring pixels share what they
//! find from the first bounce on ([`crate::reuse`]).

use crate::{
    Counters, Depth, Integrator, Plan, Precomputed, Stop, VarianceReduction,
    reuse::PathContinuation,
    walk::{Arrival, PathState, Vertex, arrive, escape, escape_by_group},
};
use steradian_core::{Scene, sampler::PixelSampler};
use steradian_math::{Ray, Spectrum, spectra::Wavelengths};

/// The path tracer. Without `MEDIA` these are ignored; surfaces that scatter nothing are passed.
#[derive(Clone, Copy, Debug)]
pub struct PathTracer<const MEDIA: bool> {
    /// How far paths are followed; events in media count as those on surfaces.
    pub depth: Depth,
    /// What is done against noise.
    pub variance_reduction: VarianceReduction,
}

/// The path tracer between surfaces.
pub type Path = PathTracer<false>;

/// The path tracer through participating media. Passing straight through a thin pane is no scattering event.
pub type VolPath = PathTracer<true>;

impl<const MEDIA: bool> PathTracer<MEDIA> {
    /// Adds what a path that meets nothing brings.
    #[inline]
    fn escape(
        &self,
        scene: &Scene,
        path_state: &PathState,
        sum: &mut Spectrum,
        lambda: &Wavelengths,
        counters: &mut Counters,
    ) {
        if !counters.by_group.is_empty() {
            escape_by_group(scene, path_state, &self.depth, lambda, counters);
        }
        escape(scene, path_state, sum, &self.depth, lambda);
    }

    /// What a path that arrived at a vertex brings from there.
    #[inline]
    fn follow<'s>(
        &self,
        scene: &'s Scene,
        precomputed: &Precomputed,
        vertex: &Vertex<'s>,
        mut path_state: PathState,
        sampler: &PixelSampler,
        lambda: &mut Wavelengths,
        counters: &mut Counters,
    ) -> Spectrum {
        let mut vertex = vertex;
        let mut next = Arrival::End;
        let mut sum = Spectrum::ZERO;
        loop {
            // Light that arrives straight from a light.
            sum += path_state.direct::<MEDIA>(vertex, scene, sampler, lambda, counters);
            // Scatter.
            let Some(s) = vertex.sample(&path_state, sampler, precomputed) else { return sum };
            path_state.turn::<MEDIA>(scene, vertex, &s);
            if !path_state.beta.is_finite() {
                // Handed to the film, which counts it.
                return path_state.beta;
            }
            if !path_state.survives(&self.depth, sampler, lambda) {
                return sum;
            }
            // Follow the ray to the next vertex; collect what shines there.
            arrive::<MEDIA>(scene, &mut path_state, &mut sum, &self.depth, sampler, lambda, counters, &mut next);
            match &next {
                Arrival::Vertex(v) => vertex = v,
                Arrival::End => return sum,
                Arrival::Escaped => {
                    self.escape(scene, &path_state, &mut sum, lambda, counters);
                    return sum;
                }
            }
        }
    }
}

impl<const MEDIA: bool> PathContinuation<MEDIA> for PathTracer<MEDIA> {
    fn depth(&self) -> &Depth {
        &self.depth
    }

    fn variance_reduction(&self) -> &VarianceReduction {
        &self.variance_reduction
    }

    #[inline]
    fn leaving<'s>(
        &self,
        scene: &'s Scene,
        precomputed: &Precomputed,
        vertex: &Vertex<'s>,
        path_state: PathState,
        sampler: &PixelSampler,
        lambda: &mut Wavelengths,
        counters: &mut Counters,
    ) -> Spectrum {
        self.follow(scene, precomputed, vertex, path_state, sampler, lambda, counters)
    }
}

impl<const MEDIA: bool> Integrator for PathTracer<MEDIA> {
    type Prepared = Precomputed;

    fn prepare(&self, scene: &Scene, plan: &Plan, stop: &Stop) -> Precomputed {
        Precomputed::new(scene, self, plan, stop)
    }

    #[inline]
    fn radiance(
        &self,
        scene: &Scene,
        precomputed: &Precomputed,
        ray: Ray,
        sampler: &PixelSampler,
        lambda: &mut Wavelengths,
        counters: &mut Counters,
    ) -> Spectrum {
        let (mut path_state, mut sum, mut first) = (PathState::camera(scene, ray), Spectrum::ZERO, Arrival::End);
        arrive::<MEDIA>(scene, &mut path_state, &mut sum, &self.depth, sampler, lambda, counters, &mut first);
        match &first {
            Arrival::Vertex(v) => sum + self.leaving(scene, precomputed, v, path_state, sampler, lambda, counters),
            Arrival::End => sum,
            Arrival::Escaped => {
                self.escape(scene, &path_state, &mut sum, lambda, counters);
                sum
            }
        }
    }
}
