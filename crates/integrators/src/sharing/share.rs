//! Sharing of the light that one member of a group found at y with all who see it: claims on the point, and light that
//! leaves it.

use super::{MAX_GROUP, Member, NO_RAY, PixelSample, is_shareable};
use crate::{Counters, path::PathTracer, precomputed::Precomputed};
use steradian_bsdf::Bsdf;
use steradian_core::{ColorMode, Scene};
use steradian_engine::PathContext;
use steradian_math::{Spectrum, Vec3, spectra::Wavelengths};
use steradian_transport::{Arrival, PathState, Vertex, arrive, escape, flight, live_max, nee, power_heuristic};

/// A member's claim on a direction or point: `f |cos|`, and its density, both with the geometry term and visibility.
#[derive(Clone, Copy)]
struct MemberDensity {
    /// From x.
    direction: Vec3,
    value: Spectrum,
    pdf: f32,
    /// The sky that the point hides.
    sky: Spectrum,
}

impl MemberDensity {
    const NONE: Self = Self { direction: Vec3::ZERO, value: Spectrum::ZERO, pdf: 0.0, sky: Spectrum::ZERO };
}

/// The environment in a direction that was drawn with a density, as seen from x if nothing were before it.
fn sky(scene: &Scene, x: &Vertex<'_>, w: Vec3, pdf: f32, lambda: &Wavelengths) -> Spectrum {
    nee::background(scene, x.p(), w, &Some((x.context(), pdf)), lambda)
}

/// True if y is another point of a surface for each viewer: bumps bend the shading normal as the viewer's direction
/// asks, and curves turn towards the ray.
fn is_bent(scene: &Scene, y: &Vertex<'_>) -> bool {
    matches!(y, Vertex::Surface { scattering, i, .. } if scattering.detail.is_some() || scene.faces_rays(i.geometry))
}

/// True if light that leaves y is the same in all directions of a side.
fn is_lambertian(scene: &Scene, y: &Vertex<'_>) -> bool {
    match y {
        Vertex::Surface { scattering, .. } => {
            matches!(scattering.bsdf, Bsdf::Diffuse(_) | Bsdf::DiffuseTransmission(_)) && !is_bent(scene, y)
        }
        Vertex::Medium { scattering, .. } => scattering.phase.henyey_greenstein() == Some(0.0),
    }
}

/// Recipients of light that leaves y.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Shared {
    /// Its finder alone.
    No,
    /// All members alike.
    Alike,
    /// All members, each weighted by the light scattered towards it.
    ByDirection,
}

impl Shared {
    fn of(scene: &Scene, member: &Member<'_>, y: &Vertex<'_>, lambda: &Wavelengths) -> Self {
        // Specular directions have no density for others, and a path that lost wavelengths brings nothing to those that
        // have them.
        if member.sample.lobe.is_specular() || member.lambda != *lambda {
            Self::No
        } else if is_lambertian(scene, y) {
            Self::Alike
        } else if is_shareable(y) && !is_bent(scene, y) {
            Self::ByDirection
        } else {
            Self::No
        }
    }
}

/// Completes the paths of all members.
pub(super) fn share<const MEDIA: bool>(
    path: &PathTracer<MEDIA>,
    scene: &Scene,
    precomputed: &Precomputed,
    group: &[Member<'_>],
    pixel_samples: &mut [PixelSample],
    counters: &mut Counters,
) {
    // For every finder k with its y: light that leaves y, claims of all members on it, and their shares.
    let mut member_densities = [MemberDensity::NONE; MAX_GROUP];
    for (k, finder) in group.iter().enumerate() {
        let PixelSample { joint, lambda: common, radiance, .. } = &mut pixel_samples[finder.pixel_sample];
        let y = match &finder.y {
            Arrival::End => continue,
            // The sky that a member finds is its own.
            Arrival::Escaped => {
                let context = &mut PathContext { scene, sampler: joint, lambda: common, counters };
                escape(&finder.path_state, &path.depth, radiance, context);
                continue;
            }
            Arrival::Vertex(y) => y,
        };
        let mut lambda = finder.lambda;
        let shared = Shared::of(scene, finder, y, common);
        let roulette_below = precomputed.effort.roulette_below;
        // Shared light is followed with throughput one: every member multiplies it by its own later.
        let mut path_state = match shared {
            Shared::No => finder.path_state,
            _ => PathState { beta: Spectrum::ONE, roulette_scale: 1.0, roulette_below, ..finder.path_state },
        };
        let context = &mut PathContext { scene, sampler: joint, lambda: &mut lambda, counters };
        if shared == Shared::No && !path_state.survives(&path.depth, context) {
            continue;
        }
        let mut light = Spectrum::ZERO;
        // Light that leaves y alike in all directions, or for its finder alone: the path simply goes on from y.
        if shared != Shared::ByDirection {
            light = path.leaving(y, path_state, precomputed.guide(), context, Spectrum::ZERO);
            light = for_all_wavelengths(light, &lambda, common, scene.mode());
            if shared == Shared::No || !light.is_finite() {
                *radiance += light;
                continue;
            }
            if light.is_black() && !precomputed.is_open {
                continue;
            }
        }
        // Control variate: the finder takes the sky behind y with certainty, and y counts by its difference from the
        // sky.
        if precomputed.is_open {
            let Arrival::Vertex(x) = &finder.x else { continue };
            let w = finder.path_state.ray.direction;
            *radiance += finder.path_state.beta * sky(scene, x, w, finder.sample.pdf, common);
        }
        let found = Found { path, scene, precomputed, group, k, y };
        // Σ_m p_m, the denominator of the balance heuristic.
        let total = found.member_densities(&mut member_densities, pixel_samples, counters);
        let mut by_member = [light; MAX_GROUP];
        // Models at y that look different from each x: the light is evaluated towards every member.
        if shared == Shared::ByDirection {
            by_member = found.scattered(path_state, (&member_densities, total), pixel_samples, counters);
        }
        // I_j += β_j f_j |cos| G V (L − L_sky) / Σ_m p_m.
        for ((member, member_density), light) in group.iter().zip(&member_densities).zip(by_member) {
            if !member_density.value.is_black() {
                pixel_samples[member.pixel_sample].radiance +=
                    member.beta * member_density.value * (light - member_density.sky) / total;
            }
        }
    }
}

/// The y that member `k` of a group found.
struct Found<'a, 's, const MEDIA: bool> {
    path: &'a PathTracer<MEDIA>,
    scene: &'s Scene,
    precomputed: &'a Precomputed,
    group: &'a [Member<'s>],
    k: usize,
    y: &'a Vertex<'s>,
}

impl<const MEDIA: bool> Found<'_, '_, MEDIA> {
    /// Light that leaves y towards each member, as `k` who found y goes on from there: by a light sample, and by a
    /// direction that k draws. Of the technique "m drew y, and a direction there" there is one sample per member too,
    /// and they are put together by the balance heuristic, so that with claims `p_m` on y and densities `q_m` of the
    /// direction the value of j is
    ///
    /// `Σ_k f_j |cos_j| G V · f_y(ω_k → j) |cos| L(ω_k) / Σ_m p_m q_m(ω_k)`.
    ///
    /// Against light samples the mean density `Σ_m p_m q_m / Σ_m p_m` counts, the same for all. All is given times
    /// `Σ_m p_m`.
    fn scattered(
        &self,
        mut path_state: PathState,
        (member_densities, total): (&[MemberDensity; MAX_GROUP], f32),
        pixel_samples: &mut [PixelSample],
        counters: &mut Counters,
    ) -> [Spectrum; MAX_GROUP] {
        let Self { path, scene, precomputed, group, k, y } = *self;
        let PixelSample { joint, mut lambda, .. } = pixel_samples[group[k].pixel_sample];
        let guide = precomputed.guide();
        let mut sums = [Spectrum::ZERO; MAX_GROUP];
        // Values towards all members, and the mean density.
        let towards_all = |w: Vec3| {
            let (mut values, mut density) = ([Spectrum::ZERO; MAX_GROUP], 0.0);
            for (value, member_density) in values.iter_mut().zip(&member_densities[..group.len()]) {
                if member_density.pdf > 0.0 || !member_density.value.is_black() {
                    let e = y.eval_towards(-member_density.direction, w);
                    *value = e.value;
                    density += member_density.pdf * e.pdf;
                }
            }
            (values, density / total)
        };
        // Light sample at y, weighted against the mean density with which members draw its direction there.
        if scene.lights().can_sample()
            && let Some(s) = nee::sample_light(scene, &y.context(), path_state.events, &joint, &lambda)
        {
            let (values, density) = towards_all(s.wi);
            let weight = if s.is_delta { 1.0 } else { power_heuristic(s.pdf, density) };
            if values[..group.len()].iter().any(|v| !v.is_black()) {
                let context = &mut PathContext { scene, sampler: &joint, lambda: &mut lambda, counters };
                let light = y.transmitted::<MEDIA>(s.radiance * (weight / s.pdf), (s.wi, s.distance), 0.0, context);
                sums.iter_mut().zip(values).for_each(|(sum, v)| *sum += v * light);
            }
        }
        // A direction at y by the finder; it serves all members unless its lobe is specular.
        let Some(draw) = path_state.sample(y, &joint, guide) else { return sums };
        path_state.turn::<MEDIA>(scene, y, &draw);
        if !path_state.beta.is_finite() {
            pixel_samples[group[k].pixel_sample].radiance = path_state.beta;
            return sums;
        }
        let (depth, mut left, before) = (&path.depth, lambda, live_max(path_state.beta, &lambda));
        let context = &mut PathContext { scene, sampler: &joint, lambda: &mut left, counters };
        if !(before > 0.0 && path_state.survives(depth, context)) {
            return sums;
        }
        let is_own = draw.sample.lobe.is_specular();
        let mut values = [Spectrum::ZERO; MAX_GROUP];
        // Σ_m p_m q_m over Σ_m p_m is the density of the direction; values are divided by it for every member.
        if !is_own {
            let (towards, density) = towards_all(path_state.ray.direction);
            if density <= 0.0 {
                return sums;
            }
            values = towards.map(|v| v * (draw.ratio / (density * before)));
            // Roulette goes on as for the finder, of a throughput without colour.
            path_state.beta = Spectrum::splat(live_max(path_state.beta, &lambda));
            path_state.origin = Some((y.context(), density));
        }
        // The path beyond y, whose light is the same for all members.
        let (mut next, mut light) = (Arrival::End, Spectrum::ZERO);
        arrive::<MEDIA>(&mut path_state, depth, &mut light, &mut next, context);
        match &next {
            Arrival::Vertex(v) => {
                let beyond = path.leaving(v, path_state, guide, context, Spectrum::ZERO);
                light += for_all_wavelengths(beyond, &left, &lambda, scene.mode());
            }
            Arrival::Escaped => {
                let context = &mut PathContext { scene, sampler: &joint, lambda: &mut lambda, counters };
                escape(&path_state, depth, &mut light, context);
            }
            Arrival::End => {}
        }
        if is_own {
            pixel_samples[group[k].pixel_sample].radiance += group[k].path_state.beta * light;
        } else {
            sums.iter_mut().zip(values).for_each(|(sum, v)| *sum += v * light);
        }
        sums
    }

    /// The claims of all members that see it on the point that `k` found; the sum of their densities.
    fn member_densities(
        &self,
        member_densities: &mut [MemberDensity; MAX_GROUP],
        pixel_samples: &[PixelSample],
        counters: &mut Counters,
    ) -> f32 {
        let Self { path: PathTracer { depth }, scene, precomputed, group, k, y } = *self;
        let finder = &group[k];
        let Arrival::Vertex(finders_x) = &finder.x else { return 0.0 };
        let p = y.p();
        // The cosine at y towards a direction from x, on the side that is seen: by the normal that decides about it.
        let facing = match y {
            Vertex::Surface { i, .. } => {
                Some((i.surface.n, if i.surface.ns.dot(i.wo) > 0.0 { i.surface.ns } else { -i.surface.ns }))
            }
            Vertex::Medium { .. } => None,
        };
        let cos = |w: Vec3| match facing {
            Some((_, side)) if side.dot(w) >= 0.0 => 0.0,
            Some((n, _)) => n.dot(w).abs(),
            None => 1.0,
        };
        // Of the way from x to y, in the medium between them.
        let flight = |x: &Vertex<'_>, w: Vec3, distance: f32, lambda: &Wavelengths| {
            let medium = if MEDIA { x.medium_towards(scene, w) } else { None };
            match medium {
                Some(m) => {
                    flight::flight_density(scene, &scene.media()[m as usize], distance, facing.is_none(), lambda)
                }
                None => (Spectrum::ONE, 1.0),
            }
        };
        let sky = |x: &Vertex<'_>, w: Vec3, pdf: f32, lambda: &Wavelengths| {
            if precomputed.is_open { sky(scene, x, w, pdf, lambda) } else { Spectrum::ZERO }
        };
        // The geometry term of the finder: others are held against it.
        let own_distance = (p - finders_x.p()).length();
        let g = facing.map_or(1.0, |(n, _)| n.dot(y.wo()).abs()) / (own_distance * own_distance);
        // Who may have drawn y, whether or not it is seen.
        let (mut rays, mut places, mut count) = ([NO_RAY; MAX_GROUP], [0; MAX_GROUP], 0);
        for (m, member) in group.iter().enumerate() {
            member_densities[m] = MemberDensity::NONE;
            // The same number of events lies before y, unless it does not matter.
            if m == k || (member.events != finder.events && depth.max != u32::MAX) {
                continue;
            }
            let Arrival::Vertex(x) = &member.x else { continue };
            // Geometry term of member m relative to the finder's: cos_y / d² over its own.
            let to = p - x.p();
            let d2 = to.length_squared();
            let distance = d2.sqrt();
            let w = to / distance;
            let relative = cos(w) / (d2 * g);
            if !(relative > 0.0 && relative.is_finite()) {
                continue;
            }
            // f_m |cos_m| and the density per solid angle with which m would have drawn this direction.
            let e = x.eval(w);
            if e.value.is_black() && e.pdf <= 0.0 {
                continue;
            }
            // A point in a medium can only be claimed through the same medium.
            if MEDIA && facing.is_none() && x.medium_towards(scene, w) != finder.path_state.medium {
                continue;
            }
            let lambda = &pixel_samples[member.pixel_sample].lambda;
            // In a medium: transmittance on the way, and the density of a flight that ends there.
            let (passed, density) = flight(x, w, distance, lambda);
            member_densities[m] = MemberDensity {
                direction: w,
                value: e.value * passed * (finder.ratio * relative),
                pdf: e.pdf * density * relative,
                sky: sky(x, w, e.pdf, lambda),
            };
            (rays[count], places[count]) = (x.spawn_towards(w, distance), m);
            count += 1;
        }
        // Visibility of y from all members in one batch; those that do not see it have no claim.
        let mut occluded = [false; MAX_GROUP];
        scene.occluded_batch(&rays[..count], &mut occluded[..count]);
        counters.rays += count as u64;
        for (m, _) in places[..count].iter().zip(occluded).filter(|(_, is_occluded)| *is_occluded) {
            member_densities[*m] = MemberDensity::NONE;
        }
        // The finder's own claim, with the sampled weight times its density; its visibility is certain.
        let (pdf, w, lambda) = (finder.sample.pdf, -y.wo(), &pixel_samples[finder.pixel_sample].lambda);
        let (passed, density) = flight(finders_x, w, own_distance, lambda);
        member_densities[k] = MemberDensity {
            direction: w,
            value: finder.sample.weight * passed * pdf,
            pdf: pdf * density,
            sky: sky(finders_x, finder.path_state.ray.direction, pdf, lambda),
        };
        member_densities[..group.len()].iter().map(|c| c.pdf).sum()
    }
}

/// Radiance found along a path that may have lost its secondary wavelengths, as an estimate for all of them.
#[inline]
fn for_all_wavelengths(light: Spectrum, lambda: &Wavelengths, of: &Wavelengths, mode: ColorMode) -> Spectrum {
    if mode == ColorMode::Rgb || lambda.pdf == of.pdf {
        return light;
    }
    Spectrum::new([light[0] * (of.pdf[0] / lambda.pdf[0]), 0.0, 0.0, 0.0])
}
