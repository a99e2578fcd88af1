//! Path tracing in the recursive form of the lab: the light that leaves a point is what it emits, what lights send it,
//! and what one random direction brings. The sum is carried along, so that it has the bits of the iterative form.

use crate::{
    Counters, Depth, Integrator, MAX_PASSES, Plan, Precomputed, Stop, VarianceReduction, dimension, nee,
    reuse::{PathContinuation, for_all_wavelengths},
    walk::{PathState, Vertex},
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
    pub variance_reduction: VarianceReduction,
}

impl PathRecursive {
    /// Adds to `sum` what arrives along a leg.
    #[allow(clippy::too_many_arguments)]
    fn follow(
        &self,
        scene: &Scene,
        precomputed: &Precomputed,
        path_state: PathState,
        sum: Spectrum,
        sampler: &PixelSampler,
        lambda: &mut Wavelengths,
        counters: &mut Counters,
    ) -> Spectrum {
        if counters.stop.is_asked() {
            return sum;
        }
        counters.rays += 1;
        let hidden = path_state.events == 0 && self.depth.hide_emitters;
        // (2) Nothing is hit: the background.
        let Some(hit) = scene.intersect(&path_state.ray) else {
            let background =
                nee::background(scene, path_state.ray.origin, path_state.ray.direction, &path_state.origin, lambda);
            return if hidden { sum } else { sum + path_state.beta * background };
        };
        // (1) A light is hit.
        let i = scene.interaction_of_light(&path_state.ray, &hit);
        let sum =
            if hidden { sum } else { sum + path_state.beta * nee::emission(scene, &i, &path_state.origin, lambda) };
        // (3) The path is long enough, unless the surface lets it through.
        let is_last = path_state.events >= self.depth.max.min(DEEPEST);
        if is_last && !scene.is_see_through {
            return sum;
        }
        let choice = sampler.get_1d_lazily(path_state.dimension(dimension::MIXTURE), scene.has_mixtures);
        match scene.scattering_along(&i, path_state.differential.as_ref(), choice, lambda) {
            Some(_) if is_last => sum,
            Some((scattering, frame)) => {
                let vertex = Vertex::Surface { i, scattering, frame, medium: None };
                let mut path_state = path_state;
                if path_state.events == 0 {
                    path_state.weigh(&vertex, precomputed, lambda);
                }
                self.scattered(scene, precomputed, &vertex, path_state, sum, sampler, lambda, counters)
            }
            None if path_state.passes >= MAX_PASSES.min(DEEPEST) => sum,
            None => {
                let differential = path_state.differential.map(|d| d.advance(i.t));
                let path_state = PathState {
                    ray: i.spawn(path_state.ray.direction),
                    passes: path_state.passes + 1,
                    differential,
                    ..path_state
                };
                self.follow(scene, precomputed, path_state, sum, sampler, lambda, counters)
            }
        }
    }

    /// Adds to `sum` what is scattered at a vertex.
    #[allow(clippy::too_many_arguments)]
    fn scattered(
        &self,
        scene: &Scene,
        precomputed: &Precomputed,
        vertex: &Vertex<'_>,
        mut path_state: PathState,
        sum: Spectrum,
        sampler: &PixelSampler,
        lambda: &mut Wavelengths,
        counters: &mut Counters,
    ) -> Spectrum {
        let branches = path_state.branches(vertex, precomputed, sampler, lambda);
        if branches == 1 {
            return self.branch(scene, precomputed, vertex, path_state, sum, sampler, lambda, counters);
        }
        (0..branches).fold(sum, |sum, k| {
            let (mut left, sampler) = (*lambda, sampler.branch(path_state.events, k));
            let branch =
                self.branch(scene, precomputed, vertex, path_state, Spectrum::ZERO, &sampler, &mut left, counters);
            sum + for_all_wavelengths(branch, &left, lambda, scene.mode)
        })
    }

    /// The same for one of the paths that go on there.
    #[allow(clippy::too_many_arguments)]
    fn branch(
        &self,
        scene: &Scene,
        precomputed: &Precomputed,
        vertex: &Vertex<'_>,
        mut path_state: PathState,
        sum: Spectrum,
        sampler: &PixelSampler,
        lambda: &mut Wavelengths,
        counters: &mut Counters,
    ) -> Spectrum {
        let sum = sum + path_state.direct::<false>(vertex, scene, sampler, lambda, counters);
        let Some(draw) = vertex.sample(&path_state, sampler, precomputed) else { return sum };
        path_state.turn::<false>(scene, vertex, &draw);
        if !path_state.beta.is_finite() {
            return path_state.beta;
        }
        if !path_state.goes_on(precomputed, &self.depth, sampler, lambda) {
            return sum;
        }
        self.follow(scene, precomputed, path_state, sum, sampler, lambda, counters)
    }
}

impl PathContinuation<false> for PathRecursive {
    fn depth(&self) -> &Depth {
        &self.depth
    }

    fn variance_reduction(&self) -> &VarianceReduction {
        &self.variance_reduction
    }

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
        self.scattered(scene, precomputed, vertex, path_state, Spectrum::ZERO, sampler, lambda, counters)
    }
}

impl Integrator for PathRecursive {
    type Prepared = Precomputed;

    fn prepare(&self, scene: &Scene, plan: &Plan, stop: &Stop) -> Precomputed {
        Precomputed::new(scene, self, plan, stop)
    }

    fn radiance(
        &self,
        scene: &Scene,
        precomputed: &Precomputed,
        ray: Ray,
        sampler: &PixelSampler,
        lambda: &mut Wavelengths,
        counters: &mut Counters,
    ) -> Spectrum {
        self.follow(scene, precomputed, PathState::camera(scene, ray), Spectrum::ZERO, sampler, lambda, counters)
    }
}
