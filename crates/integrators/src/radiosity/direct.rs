//! Light that reaches patches from lights that are no patches: points, spots, distant lights, environments.

use super::{
    bands::Bands,
    patches::{Patch, Point},
};
use glam::DVec4;
use rayon::prelude::*;
use steradian_core::{
    Scene,
    light::{Environment, Light, LightContext},
    scene::SHADOW_END,
};
use steradian_math::{Frame, Ray, Spectrum, Vec2, Vec3, ray::offset_ray_origin, spectra::Wavelengths, warp};

/// Directions to an environment from each point of a patch, for each way of choosing them.
const DIRECTIONS: u32 = 4;

/// Lights without extent, which can be asked for at any point without noise.
pub fn sharp_lights(scene: &Scene) -> Vec<u32> {
    let is_sharp = |l: &u32| !matches!(scene.lights().lights[*l as usize], Light::Area(_) | Light::Environment(_));
    (0..scene.lights().lights.len() as u32).filter(is_sharp).collect()
}

/// Irradiance by patch and band, the mean over the points of each: from lights without extent, or from environments.
/// Zero from where `tell` says to stop.
pub fn irradiance(
    scene: &Scene,
    patches: &[Patch],
    bands: &Bands,
    sharp: bool,
    tell: &(dyn Fn(usize) -> bool + Sync),
) -> Vec<DVec4> {
    let lights = if sharp { sharp_lights(scene) } else { scene.lights().environments.clone() };
    if lights.is_empty() {
        return vec![DVec4::ZERO; patches.len() * bands.count()];
    }
    // The mean irradiance over the points of each patch.
    patches
        .par_iter()
        .flat_map_iter(|patch| {
            let mut sum = vec![Spectrum::ZERO; bands.count()];
            let points = if tell(0) { &patch.points[..] } else { &[] };
            for (k, point) in points.iter().enumerate() {
                let seed = patch.cell.wrapping_mul(2).wrapping_add(u32::from(patch.front));
                for &light in &lights {
                    at_point(scene, light, point, seed, k as u32, bands.wavelengths(), &mut sum);
                }
            }
            let share = 1.0 / patch.points.len() as f32;
            sum.into_iter().map(move |s| (s * share).0.as_dvec4())
        })
        .collect()
}

/// Adds what a light sends to a point.
fn at_point(
    scene: &Scene,
    light: u32,
    point: &Point,
    seed: u32,
    k: u32,
    wavelengths: &[Wavelengths],
    sum: &mut [Spectrum],
) {
    let ctx = LightContext { p: point.p, n: point.n };
    // Environments are sampled by directions, other lights at their one point or direction.
    if let Light::Environment(e) = &scene.lights().lights[light as usize] {
        environment(scene, e, point, seed, k, wavelengths, sum);
        return;
    }
    // One shadow ray for all bands, traced when the first of them asks.
    let mut is_seen = None;
    for (sum, lambda) in sum.iter_mut().zip(wavelengths) {
        let Some(s) = scene.lights().sample(light, &ctx, Vec2::splat(0.5), lambda, scene.textures()) else { continue };
        let cos = s.wi.dot(point.n);
        if cos > 0.0
            && *is_seen
                .get_or_insert_with(|| !scene.occluded(&Ray { t_max: s.distance * SHADOW_END, ..spawn(point, s.wi) }))
        {
            *sum += s.radiance * (cos / s.pdf);
        }
    }
}

/// Adds the irradiance from an environment: directions by the cosine and by the environment, weighted by the balance
/// heuristic.
fn environment(
    scene: &Scene,
    e: &Environment,
    point: &Point,
    seed: u32,
    k: u32,
    wavelengths: &[Wavelengths],
    sum: &mut [Spectrum],
) {
    let frame = Frame::from_z(point.n);
    let samples_light = e.sampled_irradiance() > 0.0;
    // Two techniques with equal numbers of samples: by the cosine, and by the radiance of the environment.
    for j in 0..DIRECTIONS {
        let index = k * DIRECTIONS + j;
        let u = |salt: u32| Vec2::from(steradian_math::sobol::shuffled_scrambled_sobol_2d(index, seed ^ salt));
        let by_cosine = Some(frame.to_world(warp::cosine_hemisphere(u(0x7f4a_7c15))));
        let by_light = if samples_light { e.sample(point.p, u(0x1ce4_e5b9)).map(|s| s.0) } else { None };
        for w in [by_cosine, by_light].into_iter().flatten() {
            let cos = w.dot(point.n);
            if cos <= 0.0 || scene.occluded(&spawn(point, w)) {
                continue;
            }
            // Balance heuristic: cosθ L / (p_cos + p_env), over the number of samples.
            let other = if samples_light { e.pdf(point.p, w) } else { 0.0 };
            let density = cos * std::f32::consts::FRAC_1_PI + other;
            for (sum, lambda) in sum.iter_mut().zip(wavelengths) {
                *sum += e.radiance(point.p, w, lambda) * (cos / (density * DIRECTIONS as f32));
            }
        }
    }
}

/// A ray that leaves a point of a patch.
pub fn spawn(point: &Point, w: Vec3) -> Ray {
    Ray::new(offset_ray_origin(point.p, point.error, point.n, w), w)
}
