//! Paths of neighbouring pixels share what they find (Bekaert, Sbert, Halton 2002, "Accelerating Path Tracing by Re-Using Paths").
//!
//! The pixels of a group follow a path each to its first vertex that is not specular, x, and draw a direction there, which leads to a
//! vertex y. What one path finds there serves all members of the group that see y: of the technique "member m drew y" there is one
//! sample per member, and they are put together by the balance heuristic (Veach 1997, eq. 9.8 ff.),
//!
//! `I_j = β_j Σ_k f_j |cos_j| G(x_j, y_k) V(x_j, y_k) L(y_k → x_j) / Σ_m p_m(y_k) G(x_m, y_k) V(x_m, y_k)`
//!
//! with `p_m` the density per solid angle with which m draws the direction to `y_k`, and `G = |cos_y| / d²`. Visibility is traced for all
//! pairs, so the weights of a point sum to one, and the estimate is unbiased; samples of one pixel stay independent of each other.
//! Where y is Lambertian, light that leaves it is the same towards everyone on its side. Elsewhere the finder's light sample and its
//! direction at y are evaluated towards each member, and directions drawn there are weighed once more (`scattered`): what comes to y from beyond is
//! still the same for all.
//! What may not be shared is decided by x alone (who is a member), or by y alone (what serves its finder only). Light that y emits, and that of
//! environments, is the finder's own.
//!
//! In open scenes most directions lead to the sky, and surfaces stand in its place where they are met. There `L` is held against the sky:
//! the finder takes the sky in its direction whether or not something is before it, which needs no visibility, and what is shared is the
//! difference `L − L_sky`, negative where surfaces are darker than what they hide (a control variate).

use crate::{
    Counters, Depth, Integrator, Survey, Tactics, dimension, flight, live_max, nee,
    partition::Place,
    power_heuristic,
    walk::{Arrival, Leg, Vertex, arrive, escape, meet},
};
use steradian_core::{
    ColorMode, Scene,
    bsdf::{Bsdf, BsdfSample, Lobe},
    sampler::{GroupSampler, PixelSampler, Sampler},
    scene::Hit,
};
use steradian_math::{Ray, Spectrum, Vec2, Vec3, spectra::Wavelengths};

const NO_RAY: Ray = Leg::NONE.ray;

/// Most paths that share.
pub const MAX_GROUP: usize = 16;

/// Mean cosine from which on phase functions count as narrow.
const FORWARD: f32 = 0.9;

/// Roughness α below which lobes count as narrow.
const NARROW: f32 = 0.04;

/// A pixel's part in a group: one sample of it.
#[derive(Clone, Copy, Debug)]
pub struct Seat {
    /// The camera ray.
    pub ray: Ray,
    /// The pixel's own numbers, for the path up to x and light samples there.
    pub own: PixelSampler,
    /// Numbers stratified over the group, for all that follows.
    pub joint: PixelSampler,
    /// Wavelengths, the same for the whole group; afterwards without the secondary ones where the path dispersed.
    pub lambda: Wavelengths,
    /// The result.
    pub radiance: Spectrum,
}

impl Seat {
    /// A sample of a pixel, by its number and the numbers of its group, and the weight that the film gives it.
    pub(crate) fn at(scene: &Scene, sampler: &Sampler, joint: &GroupSampler, index: u32, place: &Place) -> (Self, f32) {
        let (film, common) = (&scene.film, joint.member(0));
        let own = sampler.pixel(place.x, place.y, index);
        let (offset, weight) = film.filter.sample(own.get_2d(dimension::FILM));
        let point = Vec2::new(place.x as f32 + 0.5, place.y as f32 + 0.5) + offset;
        let lens = if scene.camera.lens_radius > 0.0 { own.get_2d(dimension::LENS) } else { Vec2::splat(0.5) };
        let ray = scene.camera.ray(film, point, lens);
        let lambda = scene.mode.wavelengths(|| common.get_1d(dimension::WAVELENGTH));
        let lambda = if scene.is_timed { lambda.at_time(common.get_1d(dimension::TIME)) } else { lambda };
        (Self { ray, own, joint: joint.member(place.rank), lambda, radiance: Spectrum::ZERO }, weight)
    }
}

/// How a path tracer goes on from a vertex.
pub(crate) trait Suffix<const MEDIA: bool>: Integrator {
    /// How far paths are followed.
    fn depth(&self) -> &Depth;

    /// What is done against noise.
    fn tactics(&self) -> &Tactics;

    /// What a leg that arrived at a vertex brings from there: light scattered towards where it came from, without emission.
    #[allow(clippy::too_many_arguments)]
    fn leaving<'s>(
        &self,
        scene: &'s Scene,
        survey: &Survey,
        vertex: &Vertex<'s>,
        leg: Leg,
        sampler: &PixelSampler,
        lambda: &mut Wavelengths,
        counters: &mut Counters,
    ) -> Spectrum;
}

/// A pixel that shares.
#[derive(Clone, Copy, Debug)]
struct Member<'s> {
    seat: usize,
    /// Where its path arrived first.
    x: Arrival<'s>,
    /// What the path carries to x.
    beta: Spectrum,
    /// Scattering events before x.
    events: u32,
    /// The way on.
    sample: BsdfSample,
    /// The density by the surface over the one it was drawn with: claims are weighed by the former.
    ratio: f32,
    leg: Leg,
    /// What it met beyond x.
    y: Arrival<'s>,
    /// The wavelengths that y left.
    lambda: Wavelengths,
}

/// Room for the paths of a group; kept, so that nothing is allocated per sample.
#[derive(Debug)]
pub struct Room<'s>(Vec<Member<'s>>);

impl Default for Room<'_> {
    fn default() -> Self {
        Self(vec![Member::NONE; MAX_GROUP])
    }
}

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

impl<'s> Member<'s> {
    const NONE: Self = Self {
        seat: 0,
        x: Arrival::End,
        beta: Spectrum::ZERO,
        events: 0,
        sample: BsdfSample { wi: Vec3::Z, weight: Spectrum::ZERO, pdf: 0.0, lobe: Lobe::DIFFUSE, eta: 1.0 },
        ratio: 1.0,
        leg: Leg::NONE,
        y: Arrival::End,
        lambda: Wavelengths::RGB,
    };

    /// Follows a path from the camera, of which the first hit is known, to its first vertex that is not specular; whether there is one.
    #[inline]
    fn reach<const MEDIA: bool>(
        &mut self,
        scene: &'s Scene,
        survey: &Survey,
        seat: &mut Seat,
        hit: Option<Hit>,
        depth: &Depth,
        counters: &mut Counters,
    ) -> bool {
        let Self { leg, x, .. } = self;
        *leg = Leg::camera(scene, seat.ray);
        meet::<MEDIA>(scene, leg, hit, &mut seat.radiance, depth, &seat.own, &mut seat.lambda, counters, x);
        loop {
            match x {
                Arrival::Vertex(v) if !v.is_specular() => {
                    leg.lights = survey.effort.lights;
                    return true;
                }
                Arrival::Vertex(v) => {
                    let Some(draw) = v.sample(leg, &seat.own, survey) else { return false };
                    leg.turn::<MEDIA>(scene, v, &draw.sample);
                    if !leg.beta.is_finite() {
                        seat.radiance = leg.beta;
                        return false;
                    }
                    if !leg.survives(depth, &seat.own, &seat.lambda) {
                        return false;
                    }
                    arrive::<MEDIA>(scene, leg, &mut seat.radiance, depth, &seat.own, &mut seat.lambda, counters, x);
                }
                Arrival::End => return false,
                Arrival::Escaped => {
                    escape(scene, leg, &mut seat.radiance, depth, &seat.lambda);
                    return false;
                }
            }
        }
    }

    /// Draws a direction at x; whether it is to be followed.
    #[inline]
    fn turn<const MEDIA: bool>(&mut self, scene: &'s Scene, survey: &Survey, seat: &mut Seat) -> bool {
        (self.beta, self.events, self.y) = (self.leg.beta, self.leg.events, Arrival::End);
        self.sample.pdf = 0.0;
        let Self { x, leg, .. } = self;
        let Arrival::Vertex(x) = x else { return false };
        let Some(draw) = x.sample(leg, &seat.joint, survey) else { return false };
        (self.sample, self.ratio) = (draw.sample, draw.ratio);
        leg.turn::<MEDIA>(scene, x, &self.sample);
        if !leg.beta.is_finite() {
            seat.radiance = leg.beta;
            return false;
        }
        live_max(leg.beta, &seat.lambda) > 0.0
    }
}

/// The environment in a direction that was drawn with a density, as seen from x if nothing were before it.
fn sky(scene: &Scene, x: &Vertex<'_>, w: Vec3, pdf: f32, lambda: &Wavelengths) -> Spectrum {
    nee::background(scene, x.p(), w, &Some((x.context(), pdf)), lambda)
}

/// Samples of all seats of a group.
pub(crate) fn group<'s, const MEDIA: bool, S: Suffix<MEDIA>>(
    suffix: &S,
    scene: &'s Scene,
    survey: &Survey,
    seats: &mut [Seat],
    Room(members): &mut Room<'s>,
    counters: &mut Counters,
) {
    let depth = suffix.depth();
    if MEDIA && scene.is_see_through {
        // Ways between points may lead through several media.
        for seat in seats {
            seat.radiance = suffix.radiance(scene, survey, seat.ray, &seat.own, &mut seat.lambda, counters);
        }
        return;
    }
    let (mut rays, mut hits) = ([NO_RAY; MAX_GROUP], [None; MAX_GROUP]);
    rays.iter_mut().zip(&*seats).for_each(|(ray, seat)| *ray = seat.ray);
    scene.intersect_batch(&rays[..seats.len()], &mut hits[..seats.len()]);
    counters.rays += seats.len() as u64;
    let mut count = 0;
    for (index, (seat, hit)) in seats.iter_mut().zip(hits).enumerate() {
        let whole = seat.lambda;
        seat.radiance = Spectrum::ZERO;
        let member = &mut members[count];
        if !member.reach::<MEDIA>(scene, survey, seat, hit, depth, counters) {
            continue;
        }
        let Arrival::Vertex(x) = &member.x else { continue };
        if seat.lambda == whole && is_shareable(x) {
            member.seat = index;
            count += 1;
        } else {
            seat.radiance += suffix.leaving(scene, survey, x, member.leg, &seat.own, &mut seat.lambda, counters);
        }
    }
    let group = &mut members[..count];
    if let [Member { seat, x: Arrival::Vertex(x), leg, .. }] = group {
        let seat = &mut seats[*seat];
        seat.radiance += suffix.leaving(scene, survey, x, *leg, &seat.own, &mut seat.lambda, counters);
        return;
    }
    for k in 0..survey.effort.lights {
        direct::<MEDIA>(scene, k, group, seats, counters);
    }
    bounce::<MEDIA>(scene, survey, group, seats, depth, counters);
    share(suffix, scene, survey, group, seats, counters);
}

/// Light straight from lights at all x, by the `k`th of their light samples.
fn direct<const MEDIA: bool>(scene: &Scene, k: u32, group: &[Member<'_>], seats: &mut [Seat], counters: &mut Counters) {
    let (mut rays, mut light, mut count) = ([NO_RAY; MAX_GROUP], [(0, Spectrum::ZERO); MAX_GROUP], 0);
    for Member { seat, x, leg, .. } in group {
        let (Arrival::Vertex(x), Seat { own, lambda, .. }) = (x, &seats[*seat]) else { continue };
        if let Some((value, ray)) = x.direct_along::<MEDIA>(scene, leg.event_of_light(k), own, lambda) {
            (rays[count], light[count]) = (ray, (*seat, leg.beta * value / leg.lights as f32));
            count += 1;
        }
    }
    let mut occluded = [false; MAX_GROUP];
    scene.occluded_batch(&rays[..count], &mut occluded[..count]);
    counters.rays += count as u64;
    for ((seat, light), _) in light[..count].iter().zip(occluded).filter(|(_, is_occluded)| !is_occluded) {
        seats[*seat].radiance += *light;
    }
}

/// Follows all members on from x; emission met there is the pixel's own.
fn bounce<'s, const MEDIA: bool>(
    scene: &'s Scene,
    survey: &Survey,
    group: &mut [Member<'s>],
    seats: &mut [Seat],
    depth: &Depth,
    counters: &mut Counters,
) {
    let (mut rays, mut places, mut count) = ([NO_RAY; MAX_GROUP], [0; MAX_GROUP], 0);
    for (m, member) in group.iter_mut().enumerate() {
        if member.turn::<MEDIA>(scene, survey, &mut seats[member.seat]) {
            (rays[count], places[count]) = (member.leg.ray, m);
            count += 1;
        }
    }
    let mut hits = [None; MAX_GROUP];
    scene.intersect_batch(&rays[..count], &mut hits[..count]);
    counters.rays += count as u64;
    for (m, hit) in places[..count].iter().zip(hits) {
        let Member { seat, leg, y, lambda, .. } = &mut group[*m];
        let seat = &mut seats[*seat];
        *lambda = seat.lambda;
        meet::<MEDIA>(scene, leg, hit, &mut seat.radiance, depth, &seat.joint, lambda, counters, y);
    }
}

/// Whether members may stand in for each other at a vertex: a model whose evaluation has the density of its samples, and not one that none are
/// drawn from, nor one with a lobe so narrow that nobody else ever would.
fn is_shareable(v: &Vertex<'_>) -> bool {
    match v {
        Vertex::Surface { scattering, .. } => match &scattering.bsdf {
            Bsdf::Diffuse(b) => !b.reflectance.is_black(),
            Bsdf::DiffuseTransmission(_) | Bsdf::Coated(_) => true,
            Bsdf::Conductor(b) => b.microfacet.mean_alpha() > NARROW,
            Bsdf::Dielectric(b) => b.microfacet.mean_alpha() > NARROW,
            _ => false,
        },
        Vertex::Medium { scattering, .. } => scattering.g.abs() < FORWARD,
    }
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
fn share<const MEDIA: bool, S: Suffix<MEDIA>>(
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
            _ => Leg { beta: Spectrum::ONE, eta2: 1.0, roulette_below, ..finder.leg },
        };
        if shared == Shared::No && !leg.survives(depth, &joint, &lambda) {
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
    leg.turn::<MEDIA>(scene, y, &draw.sample);
    if !leg.beta.is_finite() {
        seats[group[k].seat].radiance = leg.beta;
        return sums;
    }
    let depth = suffix.depth();
    let before = live_max(leg.beta, &lambda);
    if !(before > 0.0 && leg.survives(depth, &joint, &lambda)) {
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
fn whole(light: Spectrum, lambda: &Wavelengths, of: &Wavelengths, mode: ColorMode) -> Spectrum {
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
