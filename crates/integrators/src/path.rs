//! Path tracing, iterative: next-event estimation at every event, weighted with scattering by the power heuristic; Russian roulette
//! on the throughput (M150, M151, M155, M161). Paths of neighbouring pixels share what they find from the first bounce on ([`crate::reuse`]).

use crate::{
    Counters, Depth, Integrator,
    reuse::{self, Seat, Suffix},
    walk::{Arrival, Leg, Vertex, arrive, escape, roulette},
};
use steradian_core::{Scene, sampler::PixelSampler};
use steradian_math::{Ray, Spectrum, spectra::Wavelengths};

/// The path tracer. Media are ignored, surfaces that scatter nothing are passed.
#[derive(Clone, Copy, Debug)]
pub struct Path {
    /// How far paths are followed.
    pub depth: Depth,
    /// Paths that share what they find; 1 for none.
    pub reuse: u32,
}

impl Suffix for Path {
    fn depth(&self) -> &Depth {
        &self.depth
    }

    #[inline]
    fn leaving<'s>(
        &self,
        scene: &'s Scene,
        mut vertex: Vertex<'s>,
        mut leg: Leg,
        sampler: &PixelSampler,
        lambda: &mut Wavelengths,
        counters: &mut Counters,
    ) -> Spectrum {
        let mut sum = Spectrum::ZERO;
        loop {
            // Light that arrives straight from a light.
            sum += leg.beta * vertex.direct(scene, leg.events, sampler, lambda, counters);
            // Scatter.
            let Some(s) = vertex.sample(leg.events, sampler) else { return sum };
            leg.turn(&vertex, &s);
            if !leg.beta.is_finite() {
                // Handed to the film, which counts it.
                return leg.beta;
            }
            match roulette(leg.beta, leg.eta2, leg.events, &self.depth, sampler, lambda) {
                Some(b) => leg.beta = b,
                None => return sum,
            }
            // Follow the ray to the next surface; collect what shines there.
            match arrive(scene, &mut leg, &mut sum, &self.depth, sampler, lambda, counters) {
                Arrival::Vertex(v) => vertex = v,
                Arrival::End => return sum,
                Arrival::Escaped => {
                    escape(scene, &leg, &mut sum, &self.depth, lambda);
                    return sum;
                }
            }
        }
    }
}

impl Integrator for Path {
    #[inline]
    fn radiance(
        &self,
        scene: &Scene,
        ray: Ray,
        sampler: &PixelSampler,
        lambda: &mut Wavelengths,
        counters: &mut Counters,
    ) -> Spectrum {
        let (mut leg, mut sum) = (Leg::camera(ray), Spectrum::ZERO);
        match arrive(scene, &mut leg, &mut sum, &self.depth, sampler, lambda, counters) {
            Arrival::Vertex(v) => sum + self.leaving(scene, v, leg, sampler, lambda, counters),
            Arrival::End => sum,
            Arrival::Escaped => {
                escape(scene, &leg, &mut sum, &self.depth, lambda);
                sum
            }
        }
    }

    fn reuse(&self) -> u32 {
        self.reuse
    }

    fn group(&self, scene: &Scene, is_open: bool, seats: &mut [Seat], counters: &mut Counters) {
        reuse::group(self, scene, is_open, seats, counters);
    }
}
