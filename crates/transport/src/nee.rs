//! Next-event estimation: what a light, chosen in proportion to what it can contribute, adds at a scattering event.

use crate::power_heuristic;
use steradian_bsdf::{Bsdf, TransportMode};
use steradian_core::{
    Scene,
    light::{Light, LightContext, LightSample},
    material::Scattering,
    sampler::PixelSampler,
    scene::Interaction,
};
use steradian_engine::dimension;
use steradian_math::{Frame, Ray, Spectrum, Vec3, spectra::Wavelengths};

/// Reference point for light sampling at a surface: models that only reflect take none from below.
#[inline]
pub fn context(i: &Interaction, frame: &Frame, bsdf: &Bsdf) -> LightContext {
    // A zero normal stands for both sides: models that transmit are lit from below, too.
    LightContext { p: i.surface.p, n: if bsdf.has_transmission() { Vec3::ZERO } else { frame.z } }
}

/// The light that is asked for at an event, and the probability of that.
#[inline]
pub fn choose(scene: &Scene, ctx: &LightContext, event: u32, sampler: &PixelSampler) -> Option<(u32, f32)> {
    // The random number is drawn only where there are several lights to choose from.
    let u = sampler.get_1d_lazily(dimension::at(event, dimension::LIGHT), scene.lights().are_many());
    scene.lights().choose(ctx, u)
}

/// A light chosen for the context and a point on it, with the density of both.
#[inline]
pub fn sample_light(
    scene: &Scene,
    ctx: &LightContext,
    event: u32,
    sampler: &PixelSampler,
    lambda: &Wavelengths,
) -> Option<LightSample> {
    // First the light, with probability P(light) by its importance for this point.
    let (light, p) = choose(scene, ctx, event, sampler)?;
    // Then a point on it. The density per solid angle is p(ω) = P(light) p(ω | light).
    let u = sampler.get_2d(dimension::at(event, dimension::LIGHT_POINT));
    let mut s = scene.lights().sample(light, ctx, u, lambda, scene.textures())?;
    s.pdf *= p;
    Some(s)
}

/// Light reflected from one light sample, without regard to visibility: `f |cos| L w / p`, with the weight `w` of
/// multiple importance sampling against sampling by the surface.
#[inline]
pub fn unoccluded(s: &LightSample, wo: Vec3, frame: &Frame, scattering: &Scattering<'_>) -> Spectrum {
    // f |cosθ| towards the light, and the density with which scattering would have drawn that direction.
    let e = scattering.eval(wo, frame.to_local(s.wi), TransportMode::Radiance);
    if e.value.is_black() {
        return Spectrum::ZERO;
    }
    // Scattering never meets lights without extent: their weight is one.
    let weight = if s.is_delta { 1.0 } else { power_heuristic(s.pdf, e.pdf) };
    e.value * s.radiance * (weight / s.pdf)
}

/// Last scattering event of a path, as a reference point for light sampling and the density of the direction drawn
/// there, for the weight of light that the path then meets; `None` from the camera and after specular events, when no
/// light sample could have found it.
pub type Origin = Option<(LightContext, f32)>;

/// Emission of the surface that a path met, weighted.
#[inline]
pub fn emission(scene: &Scene, i: &Interaction, origin: &Origin, lambda: &Wavelengths) -> Spectrum {
    let geometry = &scene.geometries()[i.geometry as usize];
    // Surfaces without an emitter, and emitters that are off at this moment, give nothing.
    let Some(emitter) = geometry.emitter else { return Spectrum::ZERO };
    if !scene.lights().emits(emitter, lambda) {
        return Spectrum::ZERO;
    }
    let at = || scene.texture_context(i);
    // Le towards the previous vertex, with its texture.
    let e = scene.lights().emitters[emitter as usize].radiance(i.surface.n, i.wo, at, lambda, scene.textures());
    if e.is_black() {
        return e;
    }
    // MIS: the density with which light sampling at the previous vertex would have found this point, choice of the
    // light included. Without such a light sample (camera, specular event, emitters that are not sampled) the weight is
    // one.
    match (origin, scene.light(i)) {
        (Some((ctx, pdf)), Some(light)) => {
            let distance = (i.surface.p - ctx.p).length();
            let other = scene.lights().area_pdf(light, ctx, (-i.wo, distance), i.surface.n, lambda.time);
            e * power_heuristic(*pdf, other)
        }
        _ => e,
    }
}

/// Light of the environments in a direction, weighted.
#[inline]
pub fn background(scene: &Scene, p: Vec3, w: Vec3, origin: &Origin, lambda: &Wavelengths) -> Spectrum {
    scene.lights().environments.iter().fold(Spectrum::ZERO, |sum, &e| sum + environment(scene, e, p, w, origin, lambda))
}

/// Light from infinity along a ray that left the scene, by the number of scattering events before, weighted: camera
/// rays see the backdrop, where there is one.
#[inline]
pub fn behind(scene: &Scene, ray: &Ray, events: u32, origin: &Origin, lambda: &Wavelengths) -> Spectrum {
    match &scene.lights().backdrop {
        Some(backdrop) if events == 0 => backdrop.radiance(ray.origin, ray.direction, lambda),
        _ => background(scene, ray.origin, ray.direction, origin, lambda),
    }
}

/// Light of one of the environments in a direction, weighted.
#[inline]
pub fn environment(scene: &Scene, light: u32, p: Vec3, w: Vec3, origin: &Origin, lambda: &Wavelengths) -> Spectrum {
    let Light::Environment(e) = &scene.lights().lights[light as usize] else { return Spectrum::ZERO };
    // Radiance of the environment along the ray, which left the scene.
    let radiance = e.radiance(p, w, lambda);
    if radiance.is_black() || !scene.lights().shines(light, lambda) {
        return Spectrum::ZERO;
    }
    // MIS as for emission: scattering against light sampling at the previous vertex.
    match origin {
        None => radiance,
        Some((ctx, pdf)) => radiance * power_heuristic(*pdf, scene.lights().environment_pdf(light, ctx, w)),
    }
}
