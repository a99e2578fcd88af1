//! Pictures of a solved scene. Where a camera ray meets a Lambertian surface it shows `(ρ H + τ H')/π`, with the
//! texture's own `ρ`; mirrors, glass and glossy lobes are followed. With a final gather, light is asked for once at the
//! surface and the solution is looked up one bounce further on, where its patches are not seen.

use super::{Settings, Solution, solve};
use crate::{Depth, Integrator, MAX_PASSES, Plan, Session, Stop, dimension, nee};
use std::{f32::consts::FRAC_1_PI, sync::Arc};
use steradian_bsdf::{Bsdf, Lobe, TransportMode};
use steradian_core::{Scene, light::LightContext, material::Scattering, scene::Interaction};
use steradian_engine::{OneByOne, PathContext, Tiles};
use steradian_math::{Frame, Ray, Spectrum, Vec2, Vec3};

/// Mirrors, panes and glossy lobes that a ray follows at most, where the scene has no limit.
const MOST_EVENTS: u32 = 32;

/// The integrator of a solved scene, which the preparation has.
#[derive(Clone, Copy, Debug)]
pub struct View {
    /// Settings of the solution.
    pub settings: Settings,
    /// Depth of rays.
    pub depth: Depth,
    /// Rays of the final gather for each camera sample; 0 for none.
    pub gather: u32,
    /// Enables interpolation of irradiance between vertices.
    pub smooth: bool,
}

impl View {
    /// Starts a render of a scene that is solved already.
    pub fn session_of(self, scene: &Arc<Scene>, plan: Plan, solution: Arc<Solution>) -> Box<dyn Session> {
        Box::new(Tiles::prepared(Arc::clone(scene), OneByOne(self), plan, Some(solution)))
    }
}

impl Integrator for View {
    type Prepared = Option<Arc<Solution>>;

    /// Solves the scene. A scene that cannot be solved is refused before a session is made; it is black here.
    fn prepare(&self, scene: &Scene, _: &Plan, stop: &Stop) -> Self::Prepared {
        solve(scene, &self.settings, stop).ok().flatten().map(Arc::new)
    }

    fn works_unprepared(&self) -> bool {
        false
    }

    fn radiance(&self, solution: &Self::Prepared, mut ray: Ray, context: &mut PathContext<'_, '_>) -> Spectrum {
        let Some(solution) = solution.as_deref() else { return Spectrum::ZERO };
        let seen = Seen { view: self, solution };
        let scene = context.scene;
        let (mut beta, mut l) = (Spectrum::ONE, Spectrum::ZERO);
        let mut is_camera_ray = true;
        let most = self.depth.max.min(MOST_EVENTS);
        let (mut event, mut passes) = (0, 0);
        // Specular and glossy events are followed like paths; a Lambertian surface ends the ray with the solution.
        loop {
            let PathContext { sampler, lambda, counters, .. } = &mut *context;
            counters.rays += 1;
            let shows_lights = !(is_camera_ray && self.depth.hide_emitters);
            // The environment, as far as the camera sees it.
            let Some(hit) = scene.intersect(&ray) else {
                if shows_lights {
                    l += beta * nee::behind(scene, &ray, u32::from(!is_camera_ray), &None, lambda);
                }
                break;
            };
            let i = scene.interaction(&ray, &hit);
            if shows_lights {
                l += beta * nee::emission(scene, &i, &None, lambda);
            }
            let u = sampler.get_1d_lazily(dimension::at(event, dimension::MIXTURE), scene.has_mixtures());
            let passes_straight = is_camera_ray && self.depth.hides(scene, i.geometry, 0);
            let surface = if passes_straight { None } else { scene.scattering(&i, u, lambda) };
            // Interfaces, and lights that are hidden from the camera, are passed.
            let Some((s, frame)) = surface else {
                passes += 1;
                if passes > MAX_PASSES {
                    break;
                }
                ray = i.rest(&ray);
                continue;
            };
            if event == most {
                break;
            }
            is_camera_ray = false;
            let wo = frame.to_local(i.wo);
            // The solution with the surface's own texture, ρ H/π.
            if let Bsdf::Diffuse(_) | Bsdf::DiffuseTransmission(_) = s.bsdf {
                return l + beta * seen.lambertian(&i, &s, &frame, event, context);
            }
            // Other models: by a sample of a lobe. Diffuse lobes take the solution, others a further ray.
            let choice = sampler.get_1d(dimension::at(event, dimension::LOBE));
            let u = sampler.get_2d(dimension::at(event, dimension::DIRECTION));
            let Some(drawn) = s.sample(wo, choice, u, TransportMode::Radiance) else { break };
            beta *= drawn.weight;
            let w = frame.to_world(drawn.wi);
            if drawn.lobe.contains(Lobe::DIFFUSE) {
                let front = i.surface.n.dot(w) > 0.0;
                let n = if front { i.surface.n } else { -i.surface.n };
                let sharp = seen.sharp(&i, n, context);
                return l + beta * (solution.irradiance(&i, front, self.smooth, context.lambda) + sharp) * FRAC_1_PI;
            }
            ray = i.spawn(w);
            event += 1;
        }
        l
    }
}

/// A view and what it is of.
struct Seen<'a> {
    view: &'a View,
    solution: &'a Solution,
}

impl Seen<'_> {
    /// Light that leaves a Lambertian surface.
    fn lambertian(
        &self,
        i: &Interaction,
        surface: &Scattering<'_>,
        frame: &Frame,
        event: u32,
        context: &mut PathContext<'_, '_>,
    ) -> Spectrum {
        let front = i.surface.n.dot(i.wo) > 0.0;
        // Final gather: several rays with random numbers of their own.
        if self.view.gather > 0 {
            let mut sum = Spectrum::ZERO;
            for k in 0..self.view.gather {
                let sampler = context.sampler.branch(event, k);
                sum += self.gathered(i, surface, frame, event, &mut context.branch(&sampler));
            }
            return sum / self.view.gather as f32;
        }
        let mut at = |side: bool| {
            let n = if side { i.surface.n } else { -i.surface.n };
            self.solution.irradiance(i, side, self.view.smooth, context.lambda) + self.sharp(i, n, context)
        };
        // (ρ H + τ H')/π.
        let (reflectance, transmittance) = match &surface.bsdf {
            Bsdf::Diffuse(b) if frame.to_local(i.wo).z > 0.0 => (b.reflectance, Spectrum::ZERO),
            Bsdf::DiffuseTransmission(b) => (b.reflectance, b.transmittance),
            _ => return Spectrum::ZERO,
        };
        let through = if transmittance.is_black() { Spectrum::ZERO } else { transmittance * at(!front) };
        (reflectance * at(front) + through) * FRAC_1_PI
    }

    /// Irradiance from lights without extent on the side that a normal points to.
    fn sharp(&self, i: &Interaction, n: Vec3, context: &mut PathContext<'_, '_>) -> Spectrum {
        let PathContext { scene, lambda, counters, .. } = context;
        let ctx = LightContext { p: i.surface.p, n };
        let ns = if i.surface.ns.dot(n) < 0.0 { -i.surface.ns } else { i.surface.ns };
        let mut sum = Spectrum::ZERO;
        // Lights without extent, one by one: cosθ L with a shadow ray each.
        for &light in &self.solution.sharp_lights {
            let Some(s) = scene.lights().sample(light, &ctx, Vec2::splat(0.5), lambda, scene.textures()) else {
                continue;
            };
            let cos = s.wi.dot(ns);
            if cos > 0.0 && s.wi.dot(n) > 0.0 {
                counters.rays += 1;
                if !scene.occluded(&i.spawn_towards(s.wi, s.distance)) {
                    sum += s.radiance * (cos / s.pdf);
                }
            }
        }
        sum
    }

    /// One light sample and one ray to where the solution is looked up, weighted against each other.
    fn gathered(
        &self,
        i: &Interaction,
        surface: &Scattering<'_>,
        frame: &Frame,
        event: u32,
        context: &mut PathContext<'_, '_>,
    ) -> Spectrum {
        let PathContext { scene, sampler, lambda, counters } = context;
        let wo = frame.to_local(i.wo);
        let ctx = nee::context(i, frame, &surface.bsdf);
        let mut l = Spectrum::ZERO;
        // Technique 1: a light sample, with its MIS weight.
        if let Some(s) = nee::sample_light(scene, &ctx, event, sampler, lambda) {
            let light = nee::unoccluded(&s, wo, frame, surface);
            if !light.is_black() {
                counters.rays += 1;
                if !scene.occluded(&i.spawn_towards(s.wi, s.distance)) {
                    l += light;
                }
            }
        }
        // Technique 2: a direction by scattering; emission there has its MIS weight, and the solution gives what is
        // reflected.
        let choice = sampler.get_1d(dimension::at(event, dimension::LOBE));
        let u = sampler.get_2d(dimension::at(event, dimension::DIRECTION));
        let Some(drawn) = surface.sample(wo, choice, u, TransportMode::Radiance) else { return l };
        let origin = Some((ctx, drawn.pdf));
        let mut ray = i.spawn(frame.to_world(drawn.wi));
        for _ in 0..MAX_PASSES {
            counters.rays += 1;
            let Some(hit) = scene.intersect(&ray) else {
                return l + drawn.weight * nee::background(scene, ray.origin, ray.direction, &origin, lambda);
            };
            let y = scene.interaction(&ray, &hit);
            if scene.geometries()[y.geometry as usize].is_interface {
                ray = y.rest(&ray);
                continue;
            }
            let emitted = nee::emission(scene, &y, &origin, lambda);
            let front = y.surface.n.dot(y.wo) > 0.0;
            // Light is scattered here, and there once more.
            if event + 2 > self.view.depth.max {
                return l + drawn.weight * emitted;
            }
            return l + drawn.weight * (emitted + self.solution.reflected(&y, front, lambda) * FRAC_1_PI);
        }
        l
    }
}
