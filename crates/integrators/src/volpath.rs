//! Path tracing through participating media (M171): free flights are drawn from the transmittance of one lane chosen at random and
//! weighted by the mean density over lanes; shadow rays are attenuated by Beer–Lambert through every interface and thin pane on their
//! way, and passing straight through such a pane is no scattering event.

use crate::{
    Counters, Depth, Integrator, dimension, is_dead, nee, power_heuristic,
    walk::{MAX_PASSES, roulette},
};
use steradian_core::{
    ColorMode, Scene,
    bsdf::TransportMode,
    light::{LightContext, LightSample},
    medium::{Medium, transmittance},
    sampler::PixelSampler,
    scene::SHADOW_END,
};
use steradian_math::{Ray, Spectrum, Vec3, spectra::Wavelengths, warp};

/// The volumetric path tracer.
#[derive(Clone, Copy, Debug)]
pub struct VolPath {
    /// How far paths are followed; events in media count as those on surfaces.
    pub depth: Depth,
}

/// What became of a flight through a medium.
enum Flight {
    /// Scattered at a distance; factor on the throughput.
    Scattered(f32, Spectrum),
    /// Reached the surface; factor on the throughput.
    Passed(Spectrum),
}

/// Lanes that carry something.
fn lanes(scene: &Scene, lambda: &Wavelengths) -> usize {
    match scene.mode {
        ColorMode::Rgb => 3,
        ColorMode::Spectral if lambda.is_secondary_terminated() => 1,
        ColorMode::Spectral => 4,
    }
}

/// Draws a free flight over at most `distance`.
fn fly(medium: &Medium, distance: f32, lane: f32, u: f32, lanes: usize, lambda: &Wavelengths) -> Flight {
    let (sigma_a, sigma_s) = medium.coefficients(lambda);
    let sigma_t = sigma_a + sigma_s;
    let mean = |s: Spectrum| (0..lanes).map(|l| s[l]).sum::<f32>() / lanes as f32;
    // Where nothing scatters the flight passes for sure.
    if (0..lanes).all(|l| sigma_s[l] == 0.0) {
        return Flight::Passed(transmittance(sigma_t, distance));
    }
    let chosen = sigma_t[((lane * lanes as f32) as usize).min(lanes - 1)];
    let t = if chosen > 0.0 { warp::exponential(u, chosen) } else { f32::INFINITY };
    if t < distance {
        let tr = transmittance(sigma_t, t);
        let pdf = mean(tr * sigma_t);
        Flight::Scattered(t, if pdf > 0.0 { tr * sigma_s / pdf } else { Spectrum::ZERO })
    } else {
        let tr = transmittance(sigma_t, distance);
        let pdf = mean(tr);
        Flight::Passed(if pdf > 0.0 { tr / pdf } else { Spectrum::ZERO })
    }
}

/// Transmittance towards a light: zero behind anything that scatters.
fn visibility(
    scene: &Scene,
    mut ray: Ray,
    mut medium: Option<u32>,
    lambda: &Wavelengths,
    counters: &mut Counters,
) -> Spectrum {
    let mut t = Spectrum::ONE;
    for _ in 0..MAX_PASSES {
        counters.rays += 1;
        let hit = scene.intersect(&ray);
        if let Some(m) = medium {
            let distance = hit.as_ref().map_or(ray.t_max, |h| h.t);
            t *= scene.media[m as usize].transmittance(distance, lambda);
            if t.is_black() {
                return t;
            }
        }
        let Some(hit) = hit else { return t };
        let i = scene.interaction(&ray, &hit);
        // Interfaces pass everything, thin panes a part; what bends or stops light blocks the way.
        if let Some((s, frame)) = scene.scattering(&i, 0.5, &mut lambda.clone()) {
            match s.bsdf.straight_transmission(frame.to_local(i.wo)) {
                Some(part) => t *= part,
                None => return Spectrum::ZERO,
            }
        }
        medium = scene.medium_towards(&i, ray.direction, medium);
        let next = i.spawn(ray.direction);
        // What is left of the way.
        let left = ray.t_max - (next.origin - ray.origin).length();
        if left <= 0.0 {
            return t;
        }
        ray = Ray { t_max: left, ..next };
    }
    Spectrum::ZERO
}

impl VolPath {
    /// The transmittance of the way to a light along `ray`; zero where it is blocked.
    fn towards(
        scene: &Scene,
        ray: Ray,
        s: &LightSample,
        medium: Option<u32>,
        lambda: &Wavelengths,
        counters: &mut Counters,
    ) -> Spectrum {
        let ray = Ray { t_max: s.distance * SHADOW_END, ..ray };
        if scene.is_see_through {
            return visibility(scene, ray, medium, lambda, counters);
        }
        counters.rays += 1;
        if scene.occluded(&ray) {
            return Spectrum::ZERO;
        }
        medium.map_or(Spectrum::ONE, |m| scene.media[m as usize].transmittance(s.distance, lambda))
    }
}

impl Integrator for VolPath {
    fn radiance(
        &self,
        scene: &Scene,
        mut ray: Ray,
        sampler: &PixelSampler,
        lambda: &mut Wavelengths,
        counters: &mut Counters,
    ) -> Spectrum {
        let mut sum = Spectrum::ZERO;
        let mut beta = Spectrum::ONE;
        let mut eta2 = 1.0_f32;
        let mut origin: nee::Origin = None;
        let mut medium = scene.camera.medium;
        let (mut events, mut passes) = (0, 0);
        loop {
            counters.rays += 1;
            let hit = scene.intersect(&ray);
            let hidden = events == 0 && self.depth.hide_emitters;
            // Numbers are drawn anew after each surface that was passed on the way to the next event.
            let salt = passes << 16;
            // Fly through the medium, if the ray is in one.
            if let Some(m) = medium {
                let medium_here = &scene.media[m as usize];
                let u = sampler.get_1d(dimension::at(events, dimension::FLIGHT) ^ salt);
                let lane = sampler.get_1d(dimension::at(events, dimension::LANE) ^ salt);
                let distance = hit.as_ref().map_or(f32::INFINITY, |h| h.t);
                match fly(medium_here, distance, lane, u, lanes(scene, lambda), lambda) {
                    Flight::Passed(factor) => beta *= factor,
                    Flight::Scattered(t, factor) => {
                        beta *= factor;
                        if events >= self.depth.max || is_dead(beta, lambda) {
                            return sum;
                        }
                        let p = ray.at(t);
                        let wo = -ray.direction;
                        let ctx = LightContext { p, n: Vec3::ZERO };
                        // Light straight from a light.
                        if let Some(s) = nee::sample_light(scene, &ctx, events, sampler, lambda) {
                            let phase = medium_here.phase(wo, s.wi);
                            let weight = if s.is_delta { 1.0 } else { power_heuristic(s.pdf, phase) };
                            let light = beta * s.radiance * (phase * weight / s.pdf);
                            if !light.is_black() {
                                let shadow = Ray::new(p, s.wi);
                                sum += light * Self::towards(scene, shadow, &s, medium, lambda, counters);
                            }
                        }
                        // Scatter.
                        let u2 = sampler.get_2d(dimension::at(events, dimension::DIRECTION));
                        let (wi, pdf) = medium_here.sample_phase(wo, u2);
                        origin = Some((ctx, pdf));
                        ray = Ray::new(p, wi);
                        events += 1;
                        match roulette(beta, eta2, events, &self.depth, sampler, lambda) {
                            Some(b) => beta = b,
                            None => return sum,
                        }
                        continue;
                    }
                }
                if is_dead(beta, lambda) {
                    return sum;
                }
            }
            let Some(hit) = hit else {
                if !hidden {
                    sum += beta * nee::background(scene, ray.origin, ray.direction, &origin, lambda);
                }
                return sum;
            };
            let i = scene.interaction(&ray, &hit);
            if !hidden {
                sum += beta * nee::emission(scene, &i, &origin, lambda);
            }
            let choice = sampler.get_1d_lazily(dimension::at(events, dimension::MIXTURE) ^ salt, scene.has_mixtures);
            let Some((scattering, frame)) = scene.scattering(&i, choice, lambda) else {
                passes += 1;
                if passes > MAX_PASSES {
                    return sum;
                }
                medium = scene.medium_towards(&i, ray.direction, medium);
                ray = i.spawn(ray.direction);
                continue;
            };
            if events >= self.depth.max {
                return sum;
            }
            let bsdf = &scattering.bsdf;
            let wo = frame.to_local(i.wo);
            if !bsdf.is_specular() && scene.lights.can_sample() {
                let ctx = nee::context(&i, &frame, bsdf);
                if let Some(s) = nee::sample_light(scene, &ctx, events, sampler, lambda) {
                    let light = beta * nee::unoccluded(&s, wo, &frame, bsdf);
                    if !light.is_black() {
                        let inside = scene.medium_towards(&i, s.wi, medium);
                        sum += light * Self::towards(scene, i.spawn(s.wi), &s, inside, lambda, counters);
                    }
                }
            }
            let u = sampler.get_1d(dimension::at(events, dimension::LOBE) ^ salt);
            let u2 = sampler.get_2d(dimension::at(events, dimension::DIRECTION));
            let Some(s) = bsdf.sample(wo, u, u2, TransportMode::Radiance) else { return sum };
            beta *= s.weight;
            if !beta.is_finite() {
                // Handed to the film, which counts it.
                return beta;
            }
            eta2 *= s.eta * s.eta;
            // Light that goes straight on has not scattered: next-event estimation sees through such surfaces too.
            if s.lobe.is_transmission() && bsdf.straight_transmission(wo).is_some() {
                passes += 1;
                if passes > MAX_PASSES || is_dead(beta, lambda) {
                    return sum;
                }
                medium = scene.medium_towards(&i, ray.direction, medium);
                ray = i.spawn(ray.direction);
                continue;
            }
            origin = if s.lobe.is_specular() { None } else { Some((nee::context(&i, &frame, bsdf), s.pdf)) };
            let direction = frame.to_world(s.wi);
            medium = scene.medium_towards(&i, direction, medium);
            ray = i.spawn(direction);
            events += 1;
            match roulette(beta, eta2, events, &self.depth, sampler, lambda) {
                Some(b) => beta = b,
                None => return sum,
            }
        }
    }
}
