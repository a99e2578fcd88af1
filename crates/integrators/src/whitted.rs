//! Whitted's ray tracing (M158): mirrors and glass are followed in both directions, every light is asked once at each surface, and
//! nothing else is gathered (Whitted 1980, "An Improved Illumination Model for Shaded Display").

use crate::{Counters, Depth, Integrator, dimension, nee, path::MAX_PASSES};
use steradian_core::{Scene, bsdf::TransportMode, light::LightContext, sampler::PixelSampler};
use steradian_math::{Ray, Spectrum, Vec2, hash::ONE_MINUS_EPSILON, spectra::Wavelengths};

/// Rays branch in two at glass, so the depth is held to this, whatever the scene asks for.
pub const DEEPEST: u32 = 16;

/// Whitted's ray tracer.
#[derive(Clone, Copy, Debug)]
pub struct Whitted {
    /// How far rays are followed.
    pub depth: Depth,
}

impl Whitted {
    fn trace(
        &self,
        scene: &Scene,
        mut ray: Ray,
        events: u32,
        sampler: &PixelSampler,
        lambda: &mut Wavelengths,
        counters: &mut Counters,
    ) -> Spectrum {
        let mut sum = Spectrum::ZERO;
        for _ in 0..MAX_PASSES {
            counters.rays += 1;
            let Some(hit) = scene.intersect(&ray) else {
                return sum + nee::background(scene, ray.origin, ray.direction, &None, lambda);
            };
            let i = scene.interaction(&ray, &hit);
            sum += nee::emission(scene, &i, &None, lambda);
            let choice = sampler.get_1d(dimension::at(events, dimension::MIXTURE));
            let Some((scattering, frame)) = scene.scattering(&i, choice, lambda) else {
                ray = i.spawn(ray.direction);
                continue;
            };
            let bsdf = &scattering.bsdf;
            let wo = frame.to_local(i.wo);
            // Every light in turn.
            let ctx = LightContext { p: i.surface.p, n: nee::context(&i, &frame, bsdf).n };
            for light in 0..scene.lights.lights.len() as u32 {
                if bsdf.is_specular() {
                    break;
                }
                let u = sampler.get_2d(dimension::at(events, dimension::LIGHT_POINT) ^ (light + 1) << 8);
                let Some(s) = scene.lights.sample(light, &ctx, u, lambda, &scene.textures) else { continue };
                let e = bsdf.eval(wo, frame.to_local(s.wi), TransportMode::Radiance);
                if e.value.is_black() {
                    continue;
                }
                counters.rays += 1;
                if !scene.occluded(&i.spawn_towards(s.wi, s.distance)) {
                    sum += e.value * s.radiance / s.pdf;
                }
            }
            if events >= self.depth.max.min(DEEPEST) {
                return sum;
            }
            // The lobe choice runs from reflection to transmission: its two ends give both.
            let center = Vec2::splat(0.5);
            let first = bsdf.sample(wo, 0.0, center, TransportMode::Radiance).filter(|s| s.lobe.is_specular());
            let last =
                bsdf.sample(wo, ONE_MINUS_EPSILON, center, TransportMode::Radiance).filter(|s| s.lobe.is_specular());
            let last = last.filter(|l| first.is_none_or(|f| f.lobe != l.lobe));
            for s in [first, last].into_iter().flatten() {
                let next = i.spawn(frame.to_world(s.wi));
                sum += s.weight * s.pdf * self.trace(scene, next, events + 1, sampler, lambda, counters);
            }
            return sum;
        }
        sum
    }
}

impl Integrator for Whitted {
    fn radiance(
        &self,
        scene: &Scene,
        ray: Ray,
        sampler: &PixelSampler,
        lambda: &mut Wavelengths,
        counters: &mut Counters,
    ) -> Spectrum {
        self.trace(scene, ray, 0, sampler, lambda, counters)
    }
}
