//! Photons on their way from the lights through what focuses them, and where they land.

use crate::{Counters, Stop, live_max, nee};
use rayon::prelude::*;
use steradian_bsdf::{Bsdf, Diffuse, TransportMode};
use steradian_core::{
    Scene,
    light::{
        LightContext,
        aims::{self, BROAD},
    },
    material::Scattering,
    sampler::{PixelSampler, Sampler, SamplerKind},
    scene::{Interaction, SHADOW_END},
};
use steradian_engine::PathContext;
use steradian_math::{Bounds3, Frame, Ray, Spectrum, Vec3, spectra::Wavelengths, warp};
use steradian_transport::Vertex;

/// Pixels for each photon that is sent. One for a pixel costs more and guides no better.
const PIXELS: u32 = 8;
/// Fewest and most photons.
const PHOTONS: (u32, u32) = (1 << 12, 1 << 16);
/// Focusing events that a photon is followed through.
const EVENTS: u32 = 12;
/// Scattering focuses where directions are drawn with a greater density than this (sr⁻¹).
const FOCUSED: f32 = 2.0;
/// Most landings of one photon path.
const LANDINGS: usize = 3;
/// Weights of indirect light and of light samples against focused light, for the share. Indirect light is noise that
/// the photons add to.
const OTHER: (f32, f32) = (0.75, 0.025);
/// The share of the mean of that light that counts everywhere: what was not estimated.
const AMBIENT: f32 = 0.05;

/// Landing of a photon.
#[derive(Clone, Copy, Debug)]
pub(super) struct Photon {
    /// Landing point.
    pub p: Vec3,
    /// Last vertex before the landing.
    pub q: Vec3,
    /// Path length from the light, scene units; infinite from infinite lights.
    pub length: f32,
    /// Flux (luminance).
    pub power: f32,
    /// An estimate of the irradiance there that the surface's own sampling has to find, and some of that from light
    /// samples.
    pub other: f32,
}

/// Box around a focusing object, at which photons are aimed.
struct Target {
    bounds: Bounds3,
    /// Probabilities of this and the ones before it.
    sum: f32,
    /// Its own.
    probability: f32,
}

/// Sends photons towards everything that may focus light; those that land, in an order that depends on the scene alone.
pub(super) fn send(scene: &Scene, stop: &Stop) -> Vec<Photon> {
    let targets = targets(scene);
    if targets.is_empty() || !scene.lights().can_sample() {
        return Vec::new();
    }
    let pixels = scene.film().width.saturating_mul(scene.film().height);
    let count = (pixels / PIXELS).clamp(PHOTONS.0, PHOTONS.1).next_power_of_two();
    let sampler = Sampler { kind: SamplerKind::Sobol, spp: count, seed: 0 };
    let mut photons: Vec<_> = (0..count)
        .into_par_iter()
        .take_any_while(|_| !stop.is_asked())
        .flat_map_iter(|index| landings(scene, &targets, &sampler.pixel(0, 0, index)).into_iter().flatten())
        .collect();
    let ambient = AMBIENT * photons.iter().map(|p| p.other).sum::<f32>() / photons.len().max(1) as f32;
    for photon in &mut photons {
        photon.other += ambient;
        photon.power /= count as f32;
    }
    photons
}

/// True if a surface with this model is guided by photons.
#[inline]
pub(super) fn is_receiver(bsdf: &Bsdf) -> bool {
    match bsdf {
        Bsdf::Conductor(b) => b.microfacet.mean_alpha() > BROAD,
        Bsdf::Dielectric(_) | Bsdf::ThinDielectric(_) | Bsdf::Filter(_) | Bsdf::Hair(_) | Bsdf::Layered(_) => false,
        _ => true,
    }
}

/// Everything that may focus light, by its share of the cross-sections.
fn targets(scene: &Scene) -> Vec<Target> {
    let bounds = aims::focusing(scene);
    let total: f32 = bounds.iter().map(Bounds3::area).sum();
    let mut sum = 0.0;
    let even = 1.0 / bounds.len().max(1) as f32;
    bounds
        .iter()
        .map(|&bounds| {
            let probability = 0.5 * (bounds.area() / total + even);
            sum += probability;
            Target { bounds, sum, probability }
        })
        .collect()
}

/// The dimensions of a photon's random numbers.
mod dimension {
    pub const TARGET: u32 = 0;
    pub const POINT: u32 = 1;
    pub const DEPTH: u32 = 2;
    pub const WAVELENGTH: u32 = 3;
    /// Direction of the indirect ray in `irradiance`; among the decisions of an event.
    pub const AROUND: u32 = 8;
    /// Event of the light sample, beyond those of all scattering events.
    pub const LIGHT_EVENT: u32 = 100;
}

/// Follows a photon from a light towards a target, to where it lands after it was focused.
fn landings(scene: &Scene, targets: &[Target], sampler: &PixelSampler) -> [Option<Photon>; LANDINGS] {
    let mut landed = [None; LANDINGS];
    let mut count = 0;
    trace(scene, targets, sampler, |photon| {
        landed[count] = Some(photon);
        count += 1;
        count < LANDINGS
    });
    landed
}

/// Follows a photon while `land` says so.
fn trace(
    scene: &Scene,
    targets: &[Target],
    sampler: &PixelSampler,
    mut land: impl FnMut(Photon) -> bool,
) -> Option<()> {
    let mut lambda = scene.mode().wavelengths(|| sampler.get_1d(dimension::WAVELENGTH));
    let luminance = |s: Spectrum, lambda: &Wavelengths| scene.mode().luminance(s, lambda);
    let u = sampler.get_1d(dimension::TARGET);
    let target = targets.get(targets.partition_point(|t| t.sum <= u)).or(targets.last())?;
    let across = sampler.get_2d(dimension::POINT);
    let size = target.bounds.diagonal();
    let towards = target.bounds.min + size * Vec3::new(across.x, across.y, sampler.get_1d(dimension::DEPTH));
    let ctx = LightContext { p: towards, n: Vec3::ZERO };
    let s = nee::sample_light(scene, &ctx, dimension::LIGHT_EVENT, sampler, &lambda)?;
    let w = s.wi.abs();
    let section = w.x * size.y * size.z + w.y * size.z * size.x + w.z * size.x * size.y;
    let distance = if s.distance.is_finite() { s.distance } else { 2.0 * scene.bounds().bounding_sphere().1 };
    let mut ray = Ray::new(towards + s.wi * (distance * SHADOW_END), -s.wi);
    let mut beta = s.radiance * (section / (s.pdf * target.probability));
    let (mut q, mut focused, mut length) = (None, false, if s.distance.is_finite() { 0.0 } else { f32::INFINITY });
    for event in 0..EVENTS {
        let hit = scene.intersect(&ray)?;
        let i = scene.interaction_of_light(&ray, &hit);
        length += hit.t;
        let at = |decision| crate::dimension::at(event, decision);
        let choice = sampler.get_1d_lazily(at(crate::dimension::MIXTURE), scene.has_mixtures());
        let Some((scattering, frame)) = scene.scattering(&i, choice, &mut lambda) else {
            ray = i.spawn(ray.direction);
            continue;
        };
        let u = sampler.get_1d(at(crate::dimension::LOBE));
        let u2 = sampler.get_2d(at(crate::dimension::DIRECTION));
        let next = scattering.sample(frame.to_local(i.wo), u, u2, TransportMode::Importance)?;
        if next.lobe.is_specular() || next.pdf > FOCUSED {
            q = Some(i.surface.p);
            focused = true;
        } else {
            let power = luminance(beta, &lambda);
            if !(focused && power > 0.0 && power.is_finite()) {
                return None;
            }
            if let Some(q) = q.filter(|_| is_receiver(&scattering.bsdf)) {
                let (mut copy, mut counters) = (lambda, Counters::default());
                let context = &mut PathContext { scene, sampler, lambda: &mut copy, counters: &mut counters };
                let other = luminance(irradiance(&i, &frame, event, context), &lambda);
                if !land(Photon { p: i.surface.p, q, length, power, other }) {
                    return None;
                }
            }
            q = None;
        }
        let survival = live_max(next.weight, &lambda).min(1.0);
        if survival <= 0.0 || sampler.get_1d(at(crate::dimension::ROULETTE)) >= survival {
            return None;
        }
        beta *= next.weight / survival;
        ray = i.spawn(frame.to_world(next.wi));
    }
    None
}

/// One sample of the irradiance at a point, of what arrives directly and after one event, each as much as it counts.
fn irradiance(i: &Interaction, frame: &Frame, event: u32, context: &mut PathContext<'_, '_>) -> Spectrum {
    let scene = context.scene;
    let white = Bsdf::Diffuse(Diffuse { reflectance: Spectrum::ONE });
    let vertex = |i, scattering, frame| Vertex::Surface { i, scattering, frame, medium: None };
    let here = vertex(*i, Scattering::plain(white), *frame);
    let direct = here.direct::<false>(event, context);
    let w =
        frame.to_world(warp::cosine_hemisphere(context.sampler.get_2d(crate::dimension::at(event, dimension::AROUND))));
    let ray = i.spawn(w);
    let indirect = match scene.intersect(&ray) {
        None => {
            let pdf = frame.z.dot(w).max(0.0) * std::f32::consts::FRAC_1_PI;
            nee::background(scene, ray.origin, w, &Some((here.context(), pdf)), context.lambda)
        }
        Some(hit) => {
            let i = scene.interaction_of_light(&ray, &hit);
            scene.scattering(&i, 0.5, context.lambda).map_or(Spectrum::ZERO, |(scattering, frame)| {
                vertex(i, scattering, frame).direct::<false>(event + EVENTS, context)
            })
        }
    };
    (indirect * OTHER.0 + direct * OTHER.1) * std::f32::consts::PI
}
