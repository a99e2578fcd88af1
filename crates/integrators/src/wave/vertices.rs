//! Vertices of any kind: all but the model itself in columns.

use super::{
    Shadows, Walk, Walker,
    block::{self, Block, GOES_ON, IS_NOT_FINITE},
    guided::guided,
    lights::illuminate,
};
use crate::Counters;
use steradian_accel::columns::{WIDTH, get3, get4, set3, set4};
use steradian_bsdf::BsdfSample;
use steradian_core::light::LightSample;
use steradian_engine::{PathContext, PixelSample};
use steradian_math::{Ray, Spectrum, Vec2};
use steradian_transport::{Arrival, GuidedDirection, Vertex};

/// Vertices of any kind at which some paths arrived, up to a block of them.
#[derive(Debug)]
pub struct Vertices<'s> {
    pub numbers: Vec<u32>,
    arrivals: Vec<Arrival<'s>>,
    draws: Vec<BsdfSample>,
}

impl Default for Vertices<'_> {
    fn default() -> Self {
        Self { numbers: Vec::new(), arrivals: vec![Arrival::End; WIDTH], draws: vec![BsdfSample::NONE; WIDTH] }
    }
}

impl<'s> Vertices<'s> {
    pub fn clear(&mut self) {
        self.numbers.clear();
    }

    pub fn is_full(&self) -> bool {
        self.numbers.len() == WIDTH
    }

    /// Slot of the next vertex.
    pub fn next(&mut self) -> &mut Arrival<'s> {
        &mut self.arrivals[self.numbers.len()]
    }

    /// Keeps the one that was written, of a path.
    pub fn keep(&mut self, number: u32) {
        self.numbers.push(number);
    }

    /// The vertices of paths, and room for the directions that are drawn there.
    fn iter(&mut self) -> impl Iterator<Item = (u32, &Vertex<'s>, &mut BsdfSample)> {
        let places = self.numbers.iter().zip(&self.arrivals).zip(&mut self.draws);
        places.filter_map(|((number, arrival), draw)| match arrival {
            Arrival::Vertex(vertex) => Some((*number, vertex, draw)),
            _ => None,
        })
    }
}

impl<'s, const MEDIA: bool> Walk<'_, 's, MEDIA> {
    /// Follows paths from vertices of any kind to their next rays, all but the model itself in columns.
    pub fn scatter(
        &self,
        b: &mut Block,
        vertices: &mut Vertices<'s>,
        walkers: &mut [Walker],
        pixel_samples: &mut [PixelSample],
        (shadows, counters): (&mut Shadows, &mut Counters),
    ) {
        if vertices.numbers.is_empty() {
            return;
        }
        let (scene, guide) = (self.scene, self.precomputed.guide());
        for (k, (number, vertex, _)) in vertices.iter().enumerate() {
            let Walker { state, sampler, .. } = &walkers[number as usize];
            // What kernels need of the vertex: reference point, error bounds, normal, and random numbers.
            let (ctx, (error, n)) = (vertex.context(), vertex.spread());
            set3(&mut b.p, k, ctx.p);
            set3(&mut b.error, k, error);
            set3(&mut b.n, k, n);
            set3(&mut b.light_n, k, ctx.n);
            b.takes_light[k] = u32::from(!vertex.is_unlit());
            b.is_in_medium[k] = u32::from(MEDIA && matches!(vertex, Vertex::Medium { .. }));
            (b.events[k], b.passes[k]) = (state.events, state.passes);
            (b.sampler[0][k], b.sampler[1][k]) = *sampler;
        }
        // Random numbers and light samples in columns.
        block::numbers(self.lanes, b);
        illuminate(self.lanes, b, vertices.numbers.iter().copied(), scene, pixel_samples);
        for (k, (number, vertex, draw)) in vertices.iter().enumerate() {
            let state = &mut walkers[number as usize].state;
            let PixelSample { own, lambda, .. } = &mut pixel_samples[number as usize];
            let mut light = Spectrum::ZERO;
            // The model itself, one by one: f |cosθ| L w / p towards the light sample, attenuated by a medium.
            if b.light_pdf[k] > 0.0 {
                let (wi, distance) = (get3(&b.light_wi, k), b.light_distance[k]);
                let s = LightSample {
                    wi,
                    distance,
                    radiance: Spectrum::new(get4(&b.light_radiance, k)),
                    pdf: b.light_pdf[k],
                    is_delta: b.light_is_delta[k] != 0,
                };
                light = vertex.reflected(&s);
                if !light.is_black() {
                    let context = &PathContext { scene, sampler: own, lambda, counters };
                    light = vertex.attenuated::<MEDIA>(light, (wi, distance), state.events, context);
                }
            }
            set4(&mut b.light, k, (state.beta * light).to_array());
            b.is_lit[k] = u32::from(!light.is_black());
            // A direction by the model, or by the mixture with a guide; throughput β f |cosθ| / p.
            let drawn = guide.and_then(|guide| guided(vertex, guide, b, k)).unwrap_or_else(|| {
                let u2 = Vec2::new(b.bsdf_u[0][k], b.bsdf_u[1][k]);
                vertex.draw(b.lobe_u[k], u2).map(GuidedDirection::by_surface)
            });
            b.is_drawn[k] = drawn.is_some().into();
            let Some(GuidedDirection { sample: s, ratio }) = drawn else { continue };
            set3(&mut b.wi, k, vertex.world(s.wi));
            b.roulette_scale[k] = state.roulette_scale * (s.eta * s.eta / ratio);
            b.is_single[k] = lambda.is_secondary_terminated().into();
            set4(&mut b.beta, k, (state.beta * s.weight).to_array());
            *draw = s;
        }
        // Rays and roulette in columns again.
        block::depart(self.lanes, b, self.path.depth);
        for (k, (number, vertex, draw)) in vertices.iter().enumerate() {
            let Walker { state, rays, goes_on, .. } = &mut walkers[number as usize];
            let time = state.ray.time;
            if b.is_lit[k] != 0 {
                shadows.push_of(b, k, number, time);
                *rays += 1;
            }
            *goes_on = b.fate[k] == GOES_ON;
            if b.fate[k] == IS_NOT_FINITE {
                pixel_samples[number as usize].radiance = Spectrum::new(get4(&b.beta, k));
            }
            // The state after the event, as a single path's.
            if *goes_on {
                let (ray, beta) = (Ray::new(get3(&b.origin, k), get3(&b.wi, k)), Spectrum::new(get4(&b.beta, k)));
                state.leave::<MEDIA>(scene, vertex, draw, Ray { time, ..ray });
                (state.beta, state.roulette_scale) = (beta, b.roulette_scale[k]);
            }
        }
        vertices.clear();
    }
}
