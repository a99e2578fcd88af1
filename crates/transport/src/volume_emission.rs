//! Next-event estimation of emissive media: a direction to where one of them gives off light, and all that arrives
//! along it from this medium, weighted against directions that scattering draws.
//!
//! A light sample is a direction, and counts all the light that the medium emits along it. A path's own flight through
//! the medium is therefore weighted by the density of the direction that it took.

use crate::{
    attenuation::{self, Shadow},
    power_heuristic,
    vertex::Vertex,
};
use steradian_core::{
    Scene,
    light::{LightContext, LightSample},
};
use steradian_engine::{PathContext, dimension};
use steradian_math::{Ray, Spectrum, Vec3};

/// Between the dimensions of an event and of the choice among emissive media at it.
const VOLUME_EVENTS: u32 = 1000;

/// A direction to one of the emissive media, and its density.
fn sample(p: Vec3, event: u32, context: &PathContext<'_, '_>) -> Option<(u32, Vec3, f32)> {
    let (scene, sampler) = (context.scene, context.sampler);
    let at = |decision| dimension::at(event + VOLUME_EVENTS, decision);
    // One of the emissive media, by cumulative probability; the rest of the random number is used again.
    let mut u = sampler.get_1d(at(dimension::LIGHT));
    let last = scene.emissive_volumes().last()?;
    let chosen = scene.emissive_volumes().iter().find(|volume| {
        let is_chosen = u < volume.probability;
        u = if is_chosen { u / volume.probability } else { u - volume.probability };
        is_chosen
    });
    let volume = chosen.unwrap_or(last);
    // From within, scattered directions find the emission by themselves: no light sample is taken.
    if volume.surrounds(p) {
        return None;
    }
    let within = sampler.get_2d(at(dimension::LIGHT_POINT)).extend(sampler.get_1d(at(dimension::LOBE)));
    // A direction to a point of the medium that is drawn by its emission; its density is summed over all points along
    // it.
    let wi = volume.sample(p, u, within)?;
    let pdf = volume.pdf(p, wi) * volume.probability;
    (pdf > 0.0 && pdf.is_finite()).then_some((volume.medium, wi, pdf))
}

/// Light of one of the emissive media that arrives at a point along its whole way; `leave` gives the ray in a
/// direction, and the medium that it sets out in.
pub fn arriving(
    p: Vec3,
    event: u32,
    leave: impl Fn(Vec3) -> (Ray, Option<u32>),
    context: &mut PathContext<'_, '_>,
) -> Option<LightSample> {
    // The direction, then all that this medium emits along it, attenuated on the way.
    let (of, wi, pdf) = sample(p, event, context)?;
    let (ray, medium) = leave(wi);
    let number = context.sampler.get_1d(dimension::at(event + VOLUME_EVENTS, dimension::FLIGHT));
    let mut radiance = Spectrum::ZERO;
    attenuation::along(ray, (medium, number), Some((of, &mut radiance)), false, &mut Shadow::of(context));
    let found = LightSample { wi, distance: f32::INFINITY, radiance, pdf, is_delta: false };
    (!radiance.is_black()).then_some(found)
}

/// Light of an emissive medium, scattered back along the path.
pub fn direct(v: &Vertex<'_>, event: u32, context: &mut PathContext<'_, '_>) -> Spectrum {
    if context.scene.emissive_volumes().is_empty() || v.is_unlit() {
        return Spectrum::ZERO;
    }
    let scene = context.scene;
    let leave = |wi: Vec3| (v.spawn(wi), v.medium_towards(scene, wi));
    let Some(found) = arriving(v.context().p, event, leave, context) else { return Spectrum::ZERO };
    v.reflected(&found)
}

/// The weight of light of a medium that a path goes through, which scattering drew the direction to.
pub fn weight(scene: &Scene, medium: u32, origin: &Option<(LightContext, f32)>, w: Vec3) -> f32 {
    // Power heuristic of scattering against the light sample, which is only taken outside of the medium.
    match (origin, scene.emissive_volumes().iter().find(|volume| volume.medium == medium)) {
        (Some((ctx, pdf)), Some(volume)) if !volume.surrounds(ctx.p) => {
            power_heuristic(*pdf, volume.pdf(ctx.p, w) * volume.probability)
        }
        _ => 1.0,
    }
}
