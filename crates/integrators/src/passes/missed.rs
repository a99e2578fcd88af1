//! Light that path tracing from the camera cannot find: that of points and parallel lights that mirrors or glass focus.
//! No light sample passes a mirror, and no path meets a light without size.

use super::{
    passage,
    subpath::{Arrival, LIGHT_EVENTS, Subpath, Ways},
    vertex::Vertex,
};
use crate::{Control, Counters, Depth, dimension};
use steradian_bsdf::TransportMode;
use steradian_core::{
    Scene,
    light::emission::Emission,
    sampler::{PixelSampler, Sampler, SamplerKind},
};
use steradian_engine::Run;
use steradian_math::Vec3;

/// Light paths of the estimate.
const PATHS: u32 = 1 << 14;

/// Mean over the picture, in linear Rec.709, of the caustics of lights without size, where the camera sees them on
/// surfaces that are not specular: an estimate to a few per cent of itself, always the same for a scene.
pub fn missed_caustics(scene: &Scene, depth: &Depth) -> Vec3 {
    let lights = &scene.lights().lights;
    if scene.has_media()
        || scene.needs_scalar_path_tracer()
        || !scene.camera().can_receive()
        || !lights.iter().any(|l| l.kind().is_delta)
    {
        return Vec3::ZERO;
    }
    let Some(emission) = Emission::new(scene) else { return Vec3::ZERO };
    // Light tracing with a fixed number of independent paths, so that the estimate is always the same.
    let control = Control::default();
    let sampler = Sampler { kind: SamplerKind::Independent, spp: 1, seed: 0 };
    let run = Run { scene, sampler, threads: 1, control: &control };
    let sum: Vec3 = (0..PATHS).map(|k| path(&run, &emission, depth, &sampler.pixel(k & 0xff, k >> 8, 0))).sum();
    sum / (scene.film().crop.width() as f32 * scene.film().crop.height() as f32)
}

/// Contribution of a light path to the crop.
fn path(run: &Run<'_>, emission: &Emission, depth: &Depth, numbers: &PixelSampler) -> Vec3 {
    let (scene, ways) = (run.scene, Ways::connections(PATHS as f32, true));
    let (mut counters, mut sum) = (Counters::default(), Vec3::ZERO);
    let lambda = run.wavelengths(numbers);
    let path = Subpath::from_light(scene, emission, numbers, lambda, &mut counters);
    let Some(mut path) = path else { return sum };
    // Only lights without extent are missed by camera paths.
    if !path.is_from_delta(scene) {
        return sum;
    }
    let mut is_focused = false;
    while let Arrival::Vertex(v) = path.arrive(scene, numbers, &mut counters, |_, _, _, _| ()) {
        // Focused: all events so far were specular, and there was one at least.
        is_focused |= path.is_specular && v.events > 0;
        if v.events >= depth.max {
            break;
        }
        // Connect to the camera where no camera path could have found the light.
        if is_focused && !v.is_specular() {
            sum += seen(run, &v, numbers, depth, &mut counters);
        }
        if !path.scatter(scene, &v, numbers, &ways, depth) || !(is_focused || path.is_specular) {
            break;
        }
    }
    sum
}

/// Contribution of a vertex of a light path to the crop: its connection to the camera.
fn seen(run: &Run<'_>, v: &Vertex<'_>, numbers: &PixelSampler, depth: &Depth, counters: &mut Counters) -> Vec3 {
    let (scene, crop) = (run.scene, run.scene.film().crop);
    let lens = numbers.get_2d(dimension::at(LIGHT_EVENTS + v.events, dimension::BRANCHES));
    // The place on the film and the importance of the camera for this point.
    let Some(seen) = scene.camera().receive(scene.film(), v.p(), lens) else { return Vec3::ZERO };
    let within = |at: f32, from: u32, to: u32| at >= from as f32 && at < to as f32;
    if !within(seen.at.x, crop.x0, crop.x1) || !within(seen.at.y, crop.y0, crop.y1) {
        return Vec3::ZERO;
    }
    // f |cos| towards the camera; then visibility, and the mean over all light paths.
    let Some(e) = v.eval(scene, seen.to_camera, TransportMode::Importance) else { return Vec3::ZERO };
    let way = (seen.to_camera, seen.distance);
    let passed = passage::to_camera(v, way, || 0.5, (scene, depth), counters);
    run.developed(v.beta * passed * e.value * (seen.density / PATHS as f32), &v.lambda)
}
