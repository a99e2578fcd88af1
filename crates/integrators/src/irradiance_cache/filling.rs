//! Making of records before the picture: points that the camera sees, from a coarse grid of pixels to all of them, get
//! a record where none counts yet.
//!
//! Points of a level are found at once, and taken in a scattered order, some at a time: those that no earlier record
//! covers are made at once and added in their order. So the records depend on nothing but the scene and the seed.

use super::{
    IrradianceCache,
    hemisphere::Irradiance,
    lambertian,
    records::{Record, Records},
};
use crate::{
    Counters, Plan, Stop,
    partition::{Partition, Place},
    radiosity::Bands,
};
use rayon::prelude::*;
use steradian_core::{
    Scene,
    sampler::{PixelSampler, Sampler, SamplerKind},
};
use steradian_engine::{PathContext, PixelSample, dimension};
use steradian_math::{Ray, Spectrum, Vec3, hash::combine32, spectra::Wavelengths};
use steradian_transport::{Arrival, NoGuide, PathState, Sink, Vertex, arrive, leaving};

/// Distance of pixels on the coarsest level.
const COARSEST: u32 = 64;
/// Pixels whose points are looked for at once.
const PIXELS: u64 = 1 << 16;
/// Records made at once, whatever the number of threads.
const BATCH: usize = 32;

/// A point that the camera sees, straight or by mirrors and glass.
struct Seen<'s> {
    vertex: Vertex<'s>,
    normal: Vec3,
    events: u32,
    /// Edge of a pixel there.
    pixel: f32,
}

/// Records and their colours.
#[derive(Clone, Debug)]
pub struct Cache {
    pub(super) records: Records,
    pub(super) bands: Bands,
}

/// A record and its irradiance.
struct Made {
    record: Record,
    irradiance: Vec<Irradiance>,
}

/// Makes all records; where a stop is asked for, some.
pub(super) fn fill(settings: &IrradianceCache, scene: &Scene, plan: &Plan, stop: &Stop) -> Cache {
    let bands = Bands::new(scene.mode(), settings.bands());
    let records = Records::new(settings.error, bands.count());
    let mut filling = Filling { settings, scene, stop, seed: plan.sampler.seed, cache: Cache { records, bands } };
    let mut step = COARSEST;
    while step > 0 {
        filling.level(step);
        step /= 2;
    }
    filling.cache
}

struct Filling<'a> {
    settings: &'a IrradianceCache,
    scene: &'a Scene,
    stop: &'a Stop,
    seed: u64,
    cache: Cache,
}

impl<'s> Filling<'s> {
    /// Covers the points of every `step`th pixel of every `step`th row of the whole frame, whatever its crop.
    fn level(&mut self, step: u32) {
        let [columns, rows] = [self.scene.film().width, self.scene.film().height].map(|n| u64::from(n.div_ceil(step)));
        let pixels = columns * rows;
        let mut start = 0;
        while start < pixels {
            let end = (start + PIXELS).min(pixels);
            let place = |k: u64| [(k % columns) as u32 * step, (k / columns) as u32 * step];
            let mut open: Vec<[u32; 2]> =
                (start..end).into_par_iter().map(place).filter(|pixel| self.is_open(*pixel)).collect();
            let scattered = |[x, y]: [u32; 2]| combine32(combine32(self.seed as u32, x), y);
            open.sort_by_key(|pixel| (scattered(*pixel), *pixel));
            self.cover(&open);
            start = end;
        }
    }

    /// Makes records for pixels, except where those made meanwhile count.
    fn cover(&mut self, open: &[[u32; 2]]) {
        let mut rest = open.iter().copied();
        loop {
            let left = (self.settings.records as usize).saturating_sub(self.cache.records.len());
            let batch: Vec<_> = rest.by_ref().filter(|p| self.is_open(*p)).take(BATCH.min(left)).collect();
            if batch.is_empty() || self.stop.is_asked() {
                return;
            }
            let made: Vec<Option<Made>> = batch.par_iter().map(|pixel| self.make(*pixel)).collect();
            for Made { record, irradiance } in made.into_iter().flatten() {
                if !self.cache.records.covers(record.p, record.n, record.events) {
                    self.cache.records.insert(record, &irradiance);
                }
            }
        }
    }

    /// True if a pixel shows a point that no record covers.
    fn is_open(&self, pixel: [u32; 2]) -> bool {
        if self.stop.is_asked() {
            return false;
        }
        let seen = self.seen(&mut self.sample(pixel));
        seen.is_some_and(|seen| !self.cache.records.covers(seen.vertex.p(), seen.normal, seen.events))
    }

    fn sample(&self, pixel: [u32; 2]) -> PixelSample {
        let sampler = Sampler { kind: SamplerKind::Sobol, spp: 1, seed: self.seed };
        PixelSample::at(self.scene, &sampler, &Partition::new(1, self.seed), 0, &Place::alone(pixel)).0
    }

    /// The first Lambertian point with indirect light on the path of a pixel's sample, past mirrors and glass alone.
    fn seen(&self, sample: &mut PixelSample) -> Option<Seen<'s>> {
        let (scene, depth) = (self.scene, &self.settings.depth);
        let mut counters = Counters::until(self.stop);
        let context =
            &mut PathContext { scene, sampler: &sample.own, lambda: &mut sample.lambda, counters: &mut counters };
        let mut state = PathState::camera(scene, sample.ray);
        let (mut arrival, mut length, mut emitted) = (Arrival::End, 0.0, Spectrum::ZERO);
        loop {
            arrive::<false>(&mut state, depth, &mut emitted, &mut arrival, context);
            let Arrival::Vertex(vertex) = arrival else { return None };
            length += (vertex.p() - state.ray.origin).length();
            if let Some((_, normal)) = lambertian(&vertex) {
                let density = scene.camera().ray_density(scene.film(), &sample.ray);
                let distance = if density.is_parallel { 1.0 } else { length + density.start };
                let pixel = distance / density.density.sqrt();
                let events = self.settings.events(state.events)?;
                return Some(Seen { vertex, normal, events, pixel });
            }
            let drawn = state.sample(&vertex, context.sampler, None::<&NoGuide>)?;
            if !drawn.sample.lobe.is_specular() || drawn.sample.lobe.is_subsurface() {
                return None;
            }
            state.turn::<false>(scene, &vertex, &drawn);
            if !state.survives(depth, context) {
                return None;
            }
        }
    }

    /// The record of a pixel's point: rays over its hemisphere, each followed as a path.
    fn make(&self, pixel: [u32; 2]) -> Option<Made> {
        let mut sample = self.sample(pixel);
        let seen = self.seen(&mut sample)?;
        let Seen { vertex, normal, events, pixel } = seen;
        let frame = steradian_math::Frame::from_z(normal);
        let hemisphere = self.settings.hemisphere();
        let mut counters = Counters::until(self.stop);
        let mut distances = vec![f32::INFINITY; hemisphere.cells() as usize];
        let mut irradiance = Vec::new();
        for lambda in self.cache.bands.wavelengths() {
            let mut light = Vec::with_capacity(distances.len());
            for cell in 0..hemisphere.cells() {
                // Numbers of a cell's own, which are those of all bands.
                let sampler = sample.own.branch(events, cell);
                let u = sampler.get_2d(dimension::at(events, dimension::DIRECTION));
                let ray = vertex.spawn(frame.to_world(hemisphere.direction(cell, u)));
                let (l, distance) = self.arriving(ray, events, lambda, &sampler, &mut counters);
                distances[cell as usize] = distance;
                light.push(l);
            }
            irradiance.push(hemisphere.irradiance(&frame, &light, &distances));
        }
        if self.stop.is_asked() {
            return None;
        }
        // Bounds of R by the gradient, and by the reach a R in pixels.
        let mut radius = hemisphere.mean_distance(&distances);
        let error = self.settings.error;
        let [least, most] = self.settings.spacing.map(|pixels| (pixels * pixel / error).clamp(1e-30, 1e30));
        if self.settings.gradients {
            let sum = |of: &dyn Fn(&Irradiance) -> Spectrum| {
                irradiance.iter().map(|i| of(i).to_array().iter().sum::<f32>()).sum::<f32>()
            };
            let slope = Vec3::from([0, 1, 2].map(|axis| sum(&|i| i.by_place[axis]))).length();
            if slope > 0.0 {
                radius = radius.min(sum(&|i| i.value) / slope);
            }
            // Where the reach is wider than the gradient allows, the gradient is made flatter.
            if radius < least {
                let part = radius / least;
                irradiance.iter_mut().flat_map(|i| &mut i.by_place).for_each(|v| *v *= part);
            }
        } else {
            irradiance.iter_mut().for_each(|i| *i = Irradiance { value: i.value, ..Irradiance::default() });
        }
        let record = Record { p: vertex.p(), n: normal, radius: radius.min(most).max(least), least, events };
        Some(Made { record, irradiance })
    }

    /// Light that arrives along a ray and was scattered before, and the distance of what it meets.
    fn arriving(
        &self,
        ray: Ray,
        events: u32,
        lambda: &Wavelengths,
        sampler: &PixelSampler,
        counters: &mut Counters,
    ) -> (Spectrum, f32) {
        let scene = self.scene;
        let mut by = |mut lambda: Wavelengths| {
            let context = &mut PathContext { scene, sampler, lambda: &mut lambda, counters };
            let mut state = PathState::NONE;
            (state.ray, state.events) = (ray, events + 1);
            let (mut met, mut arrival) = (Met(f32::INFINITY, ray.origin), Arrival::End);
            arrive::<false>(&mut state, &self.settings.depth, &mut met, &mut arrival, context);
            let light = match &arrival {
                Arrival::Vertex(v) => {
                    leaving::<false, _>(v, state, self.settings.depth, None::<&NoGuide>, context, Spectrum::ZERO)
                }
                Arrival::Escaped => {
                    met.0 = f32::INFINITY;
                    Spectrum::ZERO
                }
                Arrival::End => Spectrum::ZERO,
            };
            let light = if light.is_finite() { light } else { Spectrum::ZERO };
            (light, met.0, lambda.is_secondary_terminated())
        };
        let (mut light, distance, has_dispersed) = by(*lambda);
        if has_dispersed {
            // The path kept its first wavelength: each of the four is followed by itself.
            light = Spectrum::new(lambda.lambda.map(|l| by(Wavelengths::at([l; 4])).0[0]));
        }
        (light, distance)
    }
}

/// Distance of the last surface met from a point; emission, which direct light has, counts for nothing.
struct Met(f32, Vec3);

impl Sink for Met {
    fn add(&mut self, _: Spectrum) {}

    fn spoil(&mut self, _: Spectrum) {}

    fn tell(&mut self, step: steradian_transport::Step<'_>) {
        if let steradian_transport::Step::Surface(_, i) = step {
            self.0 = (i.surface.p - self.1).length();
        }
    }
}
