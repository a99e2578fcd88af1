//! The way between two vertices of subpaths, or from one to a light or to the camera: visibility, and among media the
//! transmittance through these, interfaces and thin panes.

use super::vertex::Vertex;
use crate::{Counters, Depth, MAX_PASSES};
use steradian_core::{
    Scene,
    light::{Light, emission::EmittedRay},
};
use steradian_math::{Ray, Spectrum, Vec3, spectra::Wavelengths};
use steradian_transport::attenuation::{self, Shadow};

/// Transmittance from a vertex over a distance in a unit direction. In media that vary it is an estimate by a number.
pub(super) fn between(
    v: &Vertex<'_>,
    (w, distance): (Vec3, f32),
    number: impl FnOnce() -> f32,
    (scene, lambda): (&Scene, &Wavelengths),
    counters: &mut Counters,
) -> Spectrum {
    let ray = v.spawn_towards(w, distance);
    if scene.has_media() {
        let medium = v.medium_towards(scene, w);
        return attenuation::towards(ray, distance, (medium, number()), &mut Shadow { scene, lambda, counters });
    }
    counters.rays += 1;
    if scene.occluded(&ray) { Spectrum::ZERO } else { Spectrum::ONE }
}

/// As [`between`], to the camera. A camera that hides lights sees nothing that emits, and sees past all that does.
pub(super) fn to_camera(
    v: &Vertex<'_>,
    (w, distance): (Vec3, f32),
    number: impl FnOnce() -> f32,
    (scene, depth): (&Scene, &Depth),
    counters: &mut Counters,
) -> Spectrum {
    if !depth.hide_emitters || scene.settings().hidden_emitters_block {
        return between(v, (w, distance), number, (scene, &v.lambda), counters);
    }
    if v.geometry().is_some_and(|g| depth.hides(scene, g, 0)) {
        return Spectrum::ZERO;
    }
    let ray = v.spawn_towards(w, distance);
    if scene.has_media() {
        let way = (v.medium_towards(scene, w), number());
        return attenuation::along(ray, way, None, true, &mut Shadow { scene, lambda: &v.lambda, counters });
    }
    counters.rays += 1;
    if scene.occluded_past_emitters(&ray) { Spectrum::ZERO } else { Spectrum::ONE }
}

/// The medium in which a ray leaves a light, and the part of the light that gets to where the ray begins: rays of
/// infinite lights begin close to the scene.
pub(super) fn from_light(
    scene: &Scene,
    emitted: &EmittedRay,
    number: impl FnOnce() -> f32,
    lambda: &Wavelengths,
    counters: &mut Counters,
) -> (Option<u32>, Spectrum) {
    if !scene.has_media() {
        return (None, Spectrum::ONE);
    }
    let ray = Ray { time: lambda.time, ..emitted.ray };
    let medium = medium_at(scene, &ray, counters);
    let is_infinite =
        matches!(scene.lights().lights[emitted.light as usize], Light::Distant(..) | Light::Environment(_));
    match medium {
        Some(m) if is_infinite => {
            let back = Ray { direction: -ray.direction, ..ray };
            let air = (scene, lambda, &counters.stop);
            (medium, attenuation::passed(m, (&back, f32::INFINITY), number(), air))
        }
        _ => (medium, Spectrum::ONE),
    }
}

/// The medium around the origin of a ray. The first surface that separates media on the way from there to the camera
/// tells it by its near side; where there is none, both are in the same medium.
fn medium_at(scene: &Scene, Ray { origin, time, .. }: &Ray, counters: &mut Counters) -> Option<u32> {
    let camera = scene.camera();
    let to = camera.world_from_camera.point(Vec3::ZERO) - *origin;
    let distance = to.length();
    if !(distance > 0.0 && distance.is_finite()) {
        return camera.medium;
    }
    let mut ray = Ray { time: *time, t_max: distance, ..Ray::new(*origin, to / distance) };
    for _ in 0..MAX_PASSES {
        counters.rays += 1;
        let Some(hit) = scene.intersect(&ray) else { break };
        let i = scene.interaction_of_light(&ray, &hit);
        if scene.geometries()[i.geometry as usize].media.is_some() {
            return scene.medium_towards(&i, i.wo, None);
        }
        ray = i.rest(&ray);
        if ray.t_max <= 0.0 {
            break;
        }
    }
    camera.medium
}
