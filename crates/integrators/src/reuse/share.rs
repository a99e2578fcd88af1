//! What one member of a group found at y is given to all who see it: claims on the point, and light that leaves it.

use super::{MAX_GROUP, Member, NO_RAY, Seat, Suffix, is_shareable};
use crate::{
    Counters, Depth, Survey, flight, live_max, nee, power_heuristic,
    walk::{Arrival, Leg, Vertex, arrive, escape},
};
use steradian_core::{ColorMode, Scene, bsdf::Bsdf};
use steradian_math::{Spectrum, Vec3, spectra::Wavelengths};

/// A member's claim on a direction or point: `f |cos|`, and its density, both with the geometry term and visibility.
#[derive(Clone, Copy)]
struct Claim {
    /// From x.
    direction: Vec3,
    value: Spectrum,
    pdf: f32,
    /// The sky that the point hides.
    sky: Spectrum,
}

impl Claim {
    const NONE: Self = Self { direction: Vec3::ZERO, value: Spectrum::ZERO, pdf: 0.0, sky: Spectrum::ZERO };
}

/// The environment in a direction that was drawn with a density, as seen from x if nothing were before it.
fn sky(scene: &Scene, x: &Vertex<'_>, w: Vec3, pdf: f32, lambda: &Wavelengths) -> Spectrum {
    nee::background(scene, x.p(), w, &Some((x.context(), pdf)), lambda)
}

/// Whether bumps bend the shading normal at y, which they do as the viewer's direction asks.
fn is_bent(y: &Vertex<'_>) -> bool {
    matches!(y, Vertex::Surface { scattering, .. } if scattering.detail.is_some())
}

/// Whether light that leaves y is the same in all directions of a side.
fn is_lambertian(y: &Vertex<'_>) -> bool {
    match y {
        Vertex::Surface { scattering, .. } => {
            matches!(scattering.bsdf, Bsdf::Diffuse(_) | Bsdf::DiffuseTransmission(_)) && !is_bent(y)
        }
        Vertex::Medium { scattering, .. } => scattering.g == 0.0,
    }
}

/// Who gets light that leaves y.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Shared {
    /// Its finder alone.
    No,
    /// All alike.
    Alike,
    /// All, each by what is scattered its way.
    ByDirection,
}

impl Shared {
    fn of(member: &Member<'_>, y: &Vertex<'_>, seat: &Seat) -> Self {
        if member.sample.lobe.is_specular() || member.lambda != seat.lambda {
            Self::No
        } else if is_lambertian(y) {
            Self::Alike
        } else if is_shareable(y) && !is_bent(y) {
            Self::ByDirection
        } else {
            Self::No
        }
    }
}

/// Completes the paths of all members.
pub(super) fn share<const MEDIA: bool, S: Suffix<MEDIA>>(
    suffix: &S,
    scene: &Scene,
    survey: &Survey,
    group: &[Member<'_>],
    seats: &mut [Seat],
    counters: &mut Counters,
) {
    let depth = suffix.depth();
    let mut claims = [Claim::NONE; MAX_GROUP];
    for (k, finder) in group.iter().enumerate() {
        let seat = &mut seats[finder.seat];
        let y = match &finder.y {
            Arrival::End => continue,
            Arrival::Escaped => {
                escape(scene, &finder.leg, &mut seat.radiance, depth, &seat.lambda);
                continue;
            }
            Arrival::Vertex(y) => y,
        };
        let (joint, mut lambda) = (seat.joint, finder.lambda);
        let shared = Shared::of(finder, y, seat);
        let roulette_below = survey.effort.roulette_below;
        let mut leg = match shared {
            Shared::No => finder.leg,
            _ => {
                // By vertex, what is found for all counts for all, who err by that much less.
                let weight = live_max(finder.leg.beta, &lambda) * finder.leg.for_roulette / (group.len() as f32).sqrt();
                let for_roulette = if survey.local.is_some() { weight } else { 1.0 };
                Leg { beta: Spectrum::ONE, for_roulette, roulette_below, ..finder.leg }
            }
        };
        if shared == Shared::No && !leg.goes_on(survey, depth, &joint, &lambda) {
            continue;
        }
        let mut light = Spectrum::ZERO;
        if shared != Shared::ByDirection {
            light = suffix.leaving(scene, survey, y, leg, &joint, &mut lambda, counters);
            light = whole(light, &lambda, &seat.lambda, scene.mode);
            if shared == Shared::No || !light.is_finite() {
                seat.radiance += light;
                continue;
            }
            if light.is_black() && !survey.is_open {
                continue;
            }
        }
        if survey.is_open {
            let Arrival::Vertex(x) = &finder.x else { continue };
            let w = finder.leg.ray.direction;
            seat.radiance += finder.leg.beta * sky(scene, x, w, finder.sample.pdf, &seat.lambda);
        }
        let total = claim::<MEDIA>(scene, survey.is_open, group, k, y, depth, &mut claims, seats, counters);
        let mut by_member = [light; MAX_GROUP];
        if shared == Shared::ByDirection {
            by_member = scattered(suffix, scene, survey, group, k, y, leg, &claims, total, seats, counters);
        }
        for ((member, claim), light) in group.iter().zip(&claims).zip(by_member) {
            if !claim.value.is_black() {
                seats[member.seat].radiance += member.beta * claim.value * (light - claim.sky) / total;
            }
        }
    }
}

/// Light that leaves y towards each member, as `k` who found y goes on from there: by a light sample, and by a direction that k draws. Of the
/// technique "m drew y, and a direction there" there is one sample per member too, and they are put together by the balance heuristic, so
/// that with claims `p_m` on y and densities `q_m` of the direction the value of j is
///
/// `Σ_k f_j |cos_j| G V · f_y(ω_k → j) |cos| L(ω_k) / Σ_m p_m q_m(ω_k)`.
///
/// Against light samples the mean density `Σ_m p_m q_m / Σ_m p_m` counts, the same for all. All is given times `Σ_m p_m`.
#[allow(clippy::too_many_arguments)]
fn scattered<const MEDIA: bool, S: Suffix<MEDIA>>(
    suffix: &S,
    scene: &Scene,
    survey: &Survey,
    group: &[Member<'_>],
    k: usize,
    y: &Vertex<'_>,
    mut leg: Leg,
    claims: &[Claim; MAX_GROUP],
    total: f32,
    seats: &mut [Seat],
    counters: &mut Counters,
) -> [Spectrum; MAX_GROUP] {
    let Seat { joint, lambda, .. } = seats[group[k].seat];
    let mut sums = [Spectrum::ZERO; MAX_GROUP];
    // Values towards all members, and the mean density.
    let towards_all = |w: Vec3| {
        let (mut values, mut density) = ([Spectrum::ZERO; MAX_GROUP], 0.0);
        for (value, claim) in values.iter_mut().zip(&claims[..group.len()]) {
            if claim.pdf > 0.0 || !claim.value.is_black() {
                let e = y.eval_towards(-claim.direction, w);
                *value = e.value;
                density += claim.pdf * e.pdf;
            }
        }
        (values, density / total)
    };
    if scene.lights.can_sample()
        && let Some(s) = nee::sample_light(scene, &y.context(), leg.events, &joint, &lambda)
    {
        let (values, density) = towards_all(s.wi);
        let weight = if s.is_delta { 1.0 } else { power_heuristic(s.pdf, density) };
        if values[..group.len()].iter().any(|v| !v.is_black()) {
            let light =
                y.transmitted::<MEDIA>(scene, s.radiance * (weight / s.pdf), s.wi, s.distance, &lambda, counters);
            sums.iter_mut().zip(values).for_each(|(sum, v)| *sum += v * light);
        }
    }
    let Some(draw) = y.sample(&leg, &joint, survey) else { return sums };
    leg.turn::<MEDIA>(scene, y, &draw);
    if !leg.beta.is_finite() {
        seats[group[k].seat].radiance = leg.beta;
        return sums;
    }
    let depth = suffix.depth();
    let before = live_max(leg.beta, &lambda);
    if !(before > 0.0 && leg.goes_on(survey, depth, &joint, &lambda)) {
        return sums;
    }
    let is_own = draw.sample.lobe.is_specular();
    let mut values = [Spectrum::ZERO; MAX_GROUP];
    if !is_own {
        let (towards, density) = towards_all(leg.ray.direction);
        if density <= 0.0 {
            return sums;
        }
        values = towards.map(|v| v * (draw.ratio / (density * before)));
        // Roulette goes on as for the finder, of a throughput without colour.
        leg.beta = Spectrum::splat(live_max(leg.beta, &lambda));
        leg.origin = Some((y.context(), density));
    }
    let (mut next, mut light, mut left) = (Arrival::End, Spectrum::ZERO, lambda);
    arrive::<MEDIA>(scene, &mut leg, &mut light, depth, &joint, &mut left, counters, &mut next);
    match &next {
        Arrival::Vertex(v) => {
            let beyond = suffix.leaving(scene, survey, v, leg, &joint, &mut left, counters);
            light += whole(beyond, &left, &lambda, scene.mode);
        }
        Arrival::Escaped => escape(scene, &leg, &mut light, depth, &lambda),
        Arrival::End => {}
    }
    if is_own {
        seats[group[k].seat].radiance += group[k].leg.beta * light;
    } else {
        sums.iter_mut().zip(values).for_each(|(sum, v)| *sum += v * light);
    }
    sums
}

/// Radiance found along a path that may have lost its secondary wavelengths, as an estimate for all of them.
#[inline]
pub(crate) fn whole(light: Spectrum, lambda: &Wavelengths, of: &Wavelengths, mode: ColorMode) -> Spectrum {
    if mode == ColorMode::Rgb || lambda.pdf == of.pdf {
        return light;
    }
    Spectrum::new([light[0] * (of.pdf[0] / lambda.pdf[0]), 0.0, 0.0, 0.0])
}

/// The claims of all members that see it on the point that `k` found; the sum of their densities.
#[allow(clippy::too_many_arguments)]
fn claim<const MEDIA: bool>(
    scene: &Scene,
    is_open: bool,
    group: &[Member<'_>],
    k: usize,
    y: &Vertex<'_>,
    depth: &Depth,
    claims: &mut [Claim; MAX_GROUP],
    seats: &[Seat],
    counters: &mut Counters,
) -> f32 {
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
            Some(m) => flight::claim(scene, &scene.media[m as usize], distance, facing.is_none(), lambda),
            None => (Spectrum::ONE, 1.0),
        }
    };
    let sky = |x: &Vertex<'_>, w: Vec3, pdf: f32, lambda: &Wavelengths| {
        if is_open { sky(scene, x, w, pdf, lambda) } else { Spectrum::ZERO }
    };
    // The geometry term of the finder: others are held against it.
    let own_distance = (p - finders_x.p()).length();
    let g = facing.map_or(1.0, |(n, _)| n.dot(y.wo()).abs()) / (own_distance * own_distance);
    // Who may have drawn y, whether or not it is seen.
    let (mut rays, mut places, mut count) = ([NO_RAY; MAX_GROUP], [0; MAX_GROUP], 0);
    for (m, member) in group.iter().enumerate() {
        claims[m] = Claim::NONE;
        // The same number of events lies before y, unless it does not matter.
        if m == k || (member.events != finder.events && depth.max != u32::MAX) {
            continue;
        }
        let Arrival::Vertex(x) = &member.x else { continue };
        let to = p - x.p();
        let d2 = to.length_squared();
        let distance = d2.sqrt();
        let w = to / distance;
        let relative = cos(w) / (d2 * g);
        if !(relative > 0.0 && relative.is_finite()) {
            continue;
        }
        let e = x.eval(w);
        if e.value.is_black() && e.pdf <= 0.0 {
            continue;
        }
        if MEDIA && facing.is_none() && x.medium_towards(scene, w) != finder.leg.medium {
            continue;
        }
        let lambda = &seats[member.seat].lambda;
        let (passed, density) = flight(x, w, distance, lambda);
        claims[m] = Claim {
            direction: w,
            value: e.value * passed * (finder.ratio * relative),
            pdf: e.pdf * density * relative,
            sky: sky(x, w, e.pdf, lambda),
        };
        (rays[count], places[count]) = (x.spawn_towards(w, distance), m);
        count += 1;
    }
    let mut occluded = [false; MAX_GROUP];
    scene.occluded_batch(&rays[..count], &mut occluded[..count]);
    counters.rays += count as u64;
    for (m, _) in places[..count].iter().zip(occluded).filter(|(_, is_occluded)| *is_occluded) {
        claims[*m] = Claim::NONE;
    }
    let (pdf, w, lambda) = (finder.sample.pdf, -y.wo(), &seats[finder.seat].lambda);
    let (passed, density) = flight(finders_x, w, own_distance, lambda);
    claims[k] = Claim {
        direction: w,
        value: finder.sample.weight * passed * pdf,
        pdf: pdf * density,
        sky: sky(finders_x, finder.leg.ray.direction, pdf, lambda),
    };
    claims[..group.len()].iter().map(|c| c.pdf).sum()
}
