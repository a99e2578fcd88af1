//! Next-event estimation of media that glow: a direction to where one of them gives off light, and all that arrives
//! along it from this medium, weighted against directions that scattering draws.

use crate::{attenuation, power_heuristic, vertex::Vertex};
use steradian_core::{
    Scene,
    light::{LightContext, LightSample},
    medium::Lamp,
};
use steradian_engine::{PathContext, dimension};
use steradian_math::{Ray, Spectrum, Vec3};

/// Between the dimensions of an event and of the choice among media that glow at it.
const GLOW_EVENTS: u32 = 1000;

/// The probability with which light is asked of one of the media that glow.
fn share(scene: &Scene, lamp: &Lamp) -> f32 {
    lamp.power / scene.lamps().iter().map(|l| l.power).sum::<f32>()
}

/// A direction to one of the media that glow, and its density.
fn sample(p: Vec3, event: u32, context: &PathContext<'_, '_>) -> Option<(u32, Vec3, f32)> {
    let (scene, sampler) = (context.scene, context.sampler);
    let at = |decision| dimension::at(event + GLOW_EVENTS, decision);
    let mut u = sampler.get_1d(at(dimension::LIGHT));
    let last = scene.lamps().last()?;
    let chosen = scene.lamps().iter().find(|lamp| {
        let share = share(scene, lamp);
        let is_chosen = u < share;
        u = if is_chosen { u / share } else { u - share };
        is_chosen
    });
    let lamp = chosen.unwrap_or(last);
    if lamp.surrounds(p) {
        return None;
    }
    let within = sampler.get_2d(at(dimension::LIGHT_POINT)).extend(sampler.get_1d(at(dimension::LOBE)));
    let wi = lamp.sample(p, u, within)?;
    let pdf = lamp.pdf(p, wi) * share(scene, lamp);
    (pdf > 0.0 && pdf.is_finite()).then_some((lamp.medium, wi, pdf))
}

/// Light of one of the media that glow that arrives at a point along its whole way; `leave` gives the ray in a
/// direction, and the medium that it sets out in.
pub fn arriving(
    p: Vec3,
    event: u32,
    leave: impl Fn(Vec3) -> (Ray, Option<u32>),
    context: &mut PathContext<'_, '_>,
) -> Option<LightSample> {
    let (of, wi, pdf) = sample(p, event, context)?;
    let (ray, medium) = leave(wi);
    let number = context.sampler.get_1d(dimension::at(event + GLOW_EVENTS, dimension::FLIGHT));
    let mut radiance = Spectrum::ZERO;
    attenuation::along(ray, (medium, number), Some((of, &mut radiance)), context);
    let found = LightSample { wi, distance: f32::INFINITY, radiance, pdf, is_delta: false };
    (!radiance.is_black()).then_some(found)
}

/// Light of a medium that glows, scattered back along the path.
pub fn direct(v: &Vertex<'_>, event: u32, context: &mut PathContext<'_, '_>) -> Spectrum {
    if context.scene.lamps().is_empty() || v.is_unlit() {
        return Spectrum::ZERO;
    }
    let scene = context.scene;
    let leave = |wi: Vec3| (v.spawn(wi), v.medium_towards(scene, wi));
    let Some(found) = arriving(v.context().p, event, leave, context) else { return Spectrum::ZERO };
    v.reflected(&found)
}

/// The weight of light of a medium that a path goes through, which scattering drew the direction to.
pub fn weight(scene: &Scene, medium: u32, origin: &Option<(LightContext, f32)>, w: Vec3) -> f32 {
    match (origin, scene.lamps().iter().find(|lamp| lamp.medium == medium)) {
        (Some((ctx, pdf)), Some(lamp)) if !lamp.surrounds(ctx.p) => {
            power_heuristic(*pdf, lamp.pdf(ctx.p, w) * share(scene, lamp))
        }
        _ => 1.0,
    }
}
