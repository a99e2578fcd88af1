//! Whitted's ray tracing: mirrors and glass are followed in both directions, every light is asked once at each surface,
//! and nothing else is gathered (Whitted 1980, "An Improved Illumination Model for Shaded Display").

use crate::{Depth, Integrator, MAX_PASSES, dimension, nee, support};
use std::sync::Arc;
use steradian_bsdf::TransportMode;
use steradian_core::{
    Scene,
    footprint::{Bounce, RayDifferential},
    light::{Light, LightContext},
    material::Scattering,
    scene::Interaction,
};
use steradian_engine::{Feature, Method, MethodKind, PathContext, Plan, Refusal, Session, Support, Tiles};
use steradian_math::{Frame, Ray, Spectrum, Vec2, hash::ONE_MINUS_EPSILON};
use steradian_transport::power_heuristic;

/// Rays branch in two at glass, so the depth is held to this, whatever the scene asks for.
pub const DEEPEST: u32 = 16;

/// A sample that has taken more rays than this follows one of two ways, chosen by what each carries: the tree of rays
/// stays small.
const BRANCHING_RAYS: u64 = 1000;

/// A branch of the tree of rays.
struct Branch {
    ray: Ray,
    /// Ray differential for textures' footprints, where there are any (Igehy 1999).
    differential: Option<RayDifferential>,
    /// Surfaces before it.
    events: u32,
    /// Counter of rays from which on the tree does not branch.
    limit: u64,
}

/// Whitted's ray tracer.
#[derive(Clone, Copy, Debug)]
pub struct Whitted {
    /// Depth of rays.
    pub depth: Depth,
}

/// `whitted`.
pub const WHITTED: MethodKind = MethodKind::new("whitted", |asked| Ok(Arc::new(Whitted { depth: asked.depth() })));

impl Method for Whitted {
    fn supports(&self, feature: Feature) -> Support {
        match feature {
            Feature::Media | Feature::UnsampledEmitters => Support::LeavesOut(""),
            Feature::AmbientLight => Support::Exact,
            _ => support::of_local_scattering(feature),
        }
    }

    fn session(&self, scene: Arc<Scene>, plan: Plan) -> Result<Box<dyn Session>, Refusal> {
        Ok(Box::new(Tiles::per_pixel(scene, *self, plan)))
    }
}

impl Whitted {
    /// Light of the environments in one direction that is drawn by the surface, weighted against light samples of those
    /// that have some, such as the sun of a sky.
    fn sky(
        i: &Interaction,
        frame: &Frame,
        scattering: &Scattering<'_>,
        event: u32,
        context: &mut PathContext<'_, '_>,
    ) -> Spectrum {
        let PathContext { scene, sampler, lambda, counters } = context;
        if scene.lights().environments.is_empty() || scattering.bsdf.is_specular() {
            return Spectrum::ZERO;
        }
        let u = sampler.get_1d(dimension::at(event, dimension::LOBE));
        let u2 = sampler.get_2d(dimension::at(event, dimension::DIRECTION));
        match scattering.sample(frame.to_local(i.wo), u, u2, TransportMode::Radiance) {
            Some(s) if !s.lobe.is_specular() => {
                let ray = i.spawn(frame.to_world(s.wi));
                counters.rays += 1;
                if scene.occluded(&ray) {
                    return Spectrum::ZERO;
                }
                let ctx = LightContext { p: i.surface.p, n: nee::context(i, frame, &scattering.bsdf).n };
                let lights = scene.lights();
                lights.environments.iter().fold(Spectrum::ZERO, |sum, &light| {
                    let radiance = nee::environment(scene, light, ray.origin, ray.direction, &None, lambda);
                    let asked = lights.environment_pdf(light, &ctx, ray.direction);
                    let asked = if asked > 0.0 { asked / lights.probability(&ctx, light) } else { 0.0 };
                    sum + s.weight * radiance * power_heuristic(s.pdf, asked)
                })
            }
            _ => Spectrum::ZERO,
        }
    }

    fn trace(
        &self,
        Branch { mut ray, mut differential, events, limit }: Branch,
        context: &mut PathContext<'_, '_>,
    ) -> Spectrum {
        let mut sum = Spectrum::ZERO;
        let is_hidden = events == 0 && self.depth.hide_emitters;
        for _ in 0..MAX_PASSES {
            let PathContext { scene, sampler, lambda, counters } = &mut *context;
            if counters.stop.is_asked() {
                break;
            }
            counters.rays += 1;
            let Some(hit) = scene.intersect(&ray) else {
                let sky = nee::behind(scene, &ray, events, &None, lambda);
                return if is_hidden { sum } else { sum + sky };
            };
            let i = scene.interaction_of_light(&ray, &hit);
            if !is_hidden {
                sum += nee::emission(scene, &i, &None, lambda);
            }
            let choice = sampler.get_1d(dimension::at(events, dimension::MIXTURE));
            let surface = match self.depth.hides(scene, i.geometry, events) {
                true => None,
                false => scene.scattering_along(&i, differential.as_ref(), choice, lambda),
            };
            let Some((scattering, frame)) = surface else {
                ray = i.rest(&ray);
                differential = differential.map(|d| d.advance(i.t));
                continue;
            };
            let bsdf = &scattering.bsdf;
            let wo = frame.to_local(i.wo);
            // The ambient term k_a L_a.
            sum += scene.ambient(&i, &scattering, wo, lambda).fold(Spectrum::ZERO, |sum, (_, light)| sum + light);
            // Every light in turn.
            let ctx = LightContext { p: i.surface.p, n: nee::context(&i, &frame, bsdf).n };
            for light in 0..scene.lights().lights.len() as u32 {
                let environment = matches!(scene.lights().lights[light as usize], Light::Environment(_));
                if bsdf.is_specular() {
                    continue;
                }
                let u = sampler.get_2d(dimension::at(events, dimension::LIGHT_POINT) ^ (light + 1) << 8);
                let Some(s) = scene.lights().sample(light, &ctx, u, lambda, scene.textures()) else { continue };
                let e = scattering.eval(wo, frame.to_local(s.wi), TransportMode::Radiance);
                if e.value.is_black() {
                    continue;
                }
                counters.rays += 1;
                if counters.stop.is_asked() {
                    return sum;
                }
                if !scene.occluded(&i.spawn_towards(s.wi, s.distance)) {
                    let weight = if environment { power_heuristic(s.pdf, e.pdf) } else { 1.0 };
                    sum += e.value * s.radiance * (weight / s.pdf);
                }
            }
            sum += Self::sky(&i, &frame, &scattering, events, context);
            if events >= self.depth.max.min(DEEPEST) {
                return sum;
            }
            // The lobe choice runs from reflection to transmission: its two ends give both.
            let center = Vec2::splat(0.5);
            let first = scattering.sample(wo, 0.0, center, TransportMode::Radiance).filter(|s| s.lobe.is_specular());
            let last = scattering
                .sample(wo, ONE_MINUS_EPSILON, center, TransportMode::Radiance)
                .filter(|s| s.lobe.is_specular());
            let last = last.filter(|l| first.is_none_or(|f| f.lobe != l.lobe));
            let mut ways = [first, last].map(|s| s.map(|s| (s, s.weight * s.pdf)));
            if context.counters.rays > limit
                && let [Some((_, a)), Some((_, b))] = &mut ways
            {
                let (to_a, to_b) = (a.max_element(), b.max_element());
                let p = if to_a > 0.0 { to_a / (to_a + to_b) } else { 0.0 };
                let chosen = usize::from(context.sampler.get_1d(dimension::at(events, dimension::LOBE)) >= p);
                (*a, *b) = (*a / p, *b / (1.0 - p));
                ways[1 - chosen] = None;
            }
            for (s, factor) in ways.into_iter().flatten() {
                let ray = i.spawn(frame.to_world(s.wi));
                let bounce = Bounce::of(&s);
                let differential = differential
                    .zip(bounce)
                    .and_then(|(d, bounce)| context.scene.scatter_differential(&i, &d, ray.direction, bounce));
                let next = Branch { ray, differential, events: events + 1, limit };
                sum += factor * self.trace(next, context);
            }
            return sum;
        }
        sum
    }
}

impl Integrator for Whitted {
    type Prepared = ();

    fn radiance(&self, (): &(), ray: Ray, context: &mut PathContext<'_, '_>) -> Spectrum {
        let limit = context.counters.rays + BRANCHING_RAYS;
        self.trace(Branch { ray, differential: context.scene.ray_differential(&ray), events: 0, limit }, context)
    }
}
