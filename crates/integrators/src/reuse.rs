//! Paths of neighbouring pixels share what they find (Bekaert, Sbert, Halton 2002, "Accelerating Path Tracing by Re-Using Paths").
//!
//! The pixels of a group follow a path each to its first vertex that is not specular, x, and draw a direction there, which leads to a
//! vertex y. Where y is Lambertian, light that leaves it is the same towards everyone on its side, so what one path finds there serves
//! all members of the group that see y: of the technique "member m drew y" there is one sample per member, and they are put together by
//! the balance heuristic (Veach 1997, eq. 9.8 ff.),
//!
//! `I_j = β_j Σ_k f_j |cos_j| G(x_j, y_k) V(x_j, y_k) L(y_k) / Σ_m p_m(y_k) G(x_m, y_k) V(x_m, y_k)`
//!
//! with `p_m` the density per solid angle with which m draws the direction to `y_k`, and `G = |cos_y| / d²`. Visibility is traced for all
//! pairs, so the weights of a point sum to one, and the estimate is unbiased; samples of one pixel stay independent of each other.
//! What may not be shared is decided by x alone (who is a member), or by y alone (what serves its finder only). Light that y emits, and that of
//! environments, is the finder's own.
//!
//! In open scenes most directions lead to the sky, and surfaces stand in its place where they are met. There `L` is held against the sky:
//! the finder takes the sky in its direction whether or not something is before it, which needs no visibility, and what is shared is the
//! difference `L − L_sky`, negative where surfaces are darker than what they hide (a control variate).

use crate::{
    Counters, Depth, live_max, nee,
    walk::{Arrival, Leg, Vertex, arrive, escape, roulette},
};
use steradian_core::{
    ColorMode, Scene,
    bsdf::{Bsdf, BsdfSample, Lobe, TransportMode},
    sampler::PixelSampler,
};
use steradian_math::{Frame, Ray, Spectrum, Vec2, Vec3, sobol, spectra::Wavelengths, warp};

/// Most paths that share.
pub const MAX_GROUP: usize = 16;

/// Roughness α below which lobes count as narrow.
const NARROW: f32 = 0.05;

/// Paths that share unless asked otherwise.
pub const DEFAULT_REUSE: u32 = 16;

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

/// How a path tracer goes on from a vertex.
pub(crate) trait Suffix {
    /// How far paths are followed.
    fn depth(&self) -> &Depth;

    /// What a leg that arrived at a vertex brings from there: light scattered towards where it came from, without emission.
    fn leaving<'s>(
        &self,
        scene: &'s Scene,
        vertex: Vertex<'s>,
        leg: Leg,
        sampler: &PixelSampler,
        lambda: &mut Wavelengths,
        counters: &mut Counters,
    ) -> Spectrum;
}

/// A pixel that shares.
struct Member<'s> {
    seat: usize,
    x: Vertex<'s>,
    wo: Vec3,
    /// What the path carries to x.
    beta: Spectrum,
    /// Scattering events before x.
    events: u32,
    /// The way on.
    sample: BsdfSample,
    leg: Leg,
    found: Found<'s>,
}

/// What a member met beyond x. In place, since nothing is allocated per sample.
#[allow(clippy::large_enum_variant)]
enum Found<'s> {
    Nothing,
    Sky,
    Surface(Vertex<'s>),
}

/// A member's claim on a direction or point: `f |cos|`, and its density, both with the geometry term and visibility.
#[derive(Clone, Copy)]
struct Claim {
    value: Spectrum,
    pdf: f32,
    /// The sky that the point hides.
    sky: Spectrum,
}

impl Claim {
    const NONE: Self = Self { value: Spectrum::ZERO, pdf: 0.0, sky: Spectrum::ZERO };
}

impl Member<'_> {
    /// The environment in a direction that was drawn with a density, as seen from x if nothing were before it.
    fn sky(&self, w: Vec3, pdf: f32, scene: &Scene, lambda: &Wavelengths) -> Spectrum {
        let origin = Some((nee::context(&self.x.i, &self.x.frame, &self.x.scattering.bsdf), pdf));
        nee::background(scene, self.x.i.surface.p, w, &origin, lambda)
    }
}

/// Samples of all seats of a group.
pub(crate) fn group<S: Suffix>(suffix: &S, scene: &Scene, is_open: bool, seats: &mut [Seat], counters: &mut Counters) {
    let depth = suffix.depth();
    let mut slots: [Option<(usize, Vertex<'_>, Leg)>; MAX_GROUP] = [const { None }; MAX_GROUP];
    let mut members = 0;
    for (index, seat) in seats.iter_mut().enumerate() {
        let whole = seat.lambda;
        seat.radiance = Spectrum::ZERO;
        let Some((vertex, leg)) = prefix(scene, seat, depth, counters) else { continue };
        if seat.lambda == whole && is_shareable(&vertex.scattering.bsdf) {
            slots[members] = Some((index, vertex, leg));
            members += 1;
        } else {
            seat.radiance += suffix.leaving(scene, vertex, leg, &seat.own, &mut seat.lambda, counters);
        }
    }
    if let (1, Some((index, vertex, leg))) = (members, slots[0]) {
        let seat = &mut seats[index];
        seat.radiance += suffix.leaving(scene, vertex, leg, &seat.own, &mut seat.lambda, counters);
        return;
    }
    let mut group: [Option<Member<'_>>; MAX_GROUP] = [const { None }; MAX_GROUP];
    for (slot, member) in slots[..members].iter().zip(&mut group) {
        let Some((index, x, leg)) = *slot else { continue };
        *member = Some(bounce(scene, index, x, leg, &mut seats[index], depth, counters));
    }
    share(suffix, scene, is_open, &group[..members], seats, counters);
}

/// Follows a path from the camera to its first vertex that is not specular.
#[inline]
fn prefix<'s>(scene: &'s Scene, seat: &mut Seat, depth: &Depth, counters: &mut Counters) -> Option<(Vertex<'s>, Leg)> {
    let mut leg = Leg::camera(seat.ray);
    loop {
        match arrive(scene, &mut leg, &mut seat.radiance, depth, &seat.own, &mut seat.lambda, counters) {
            Arrival::Vertex(v) if !v.scattering.bsdf.is_specular() => return Some((v, leg)),
            Arrival::Vertex(v) => {
                let s = v.sample(leg.events, &seat.own)?;
                leg.turn(&v, &s);
                if !leg.beta.is_finite() {
                    seat.radiance = leg.beta;
                    return None;
                }
                leg.beta = roulette(leg.beta, leg.eta2, leg.events, depth, &seat.own, &seat.lambda)?;
            }
            Arrival::End => return None,
            Arrival::Escaped => {
                escape(scene, &leg, &mut seat.radiance, depth, &seat.lambda);
                return None;
            }
        }
    }
}

/// Direct light at x, a direction drawn there, and where it leads; emission met there is the pixel's own.
#[inline]
fn bounce<'s>(
    scene: &'s Scene,
    index: usize,
    x: Vertex<'s>,
    mut leg: Leg,
    seat: &mut Seat,
    depth: &Depth,
    counters: &mut Counters,
) -> Member<'s> {
    let (beta, events) = (leg.beta, leg.events);
    seat.radiance += beta * x.direct(scene, events, &seat.own, &seat.lambda, counters);
    let wo = x.frame.to_local(x.i.wo);
    let mut found = Found::Nothing;
    let mut sample = BsdfSample { wi: Vec3::Z, weight: Spectrum::ZERO, pdf: 0.0, lobe: Lobe::DIFFUSE, eta: 1.0 };
    if let Some(s) = x.sample(events, &seat.joint) {
        sample = s;
        leg.turn(&x, &s);
        if !leg.beta.is_finite() {
            seat.radiance = leg.beta;
        } else if live_max(leg.beta, &seat.lambda) > 0.0 {
            let mut lambda = seat.lambda;
            let arrival = arrive(scene, &mut leg, &mut seat.radiance, depth, &seat.joint, &mut lambda, counters);
            found = match arrival {
                Arrival::Vertex(v) => Found::Surface(v),
                Arrival::End => Found::Nothing,
                Arrival::Escaped => Found::Sky,
            };
        }
    }
    Member { seat: index, x, wo, beta, events, sample, leg, found }
}

/// Whether members may stand in for each other at x: a model whose evaluation has the density of its samples, and not one that none are
/// drawn from, nor one with a lobe so narrow that nobody else ever would.
fn is_shareable(bsdf: &Bsdf<'_>) -> bool {
    match bsdf {
        Bsdf::Diffuse(b) => !b.reflectance.is_black(),
        Bsdf::DiffuseTransmission(_) | Bsdf::Coated(_) => true,
        Bsdf::Conductor(b) => b.microfacet.mean_alpha() > NARROW,
        Bsdf::Dielectric(b) => b.microfacet.mean_alpha() > NARROW,
        _ => false,
    }
}

/// Whether light that leaves a surface is the same in all directions of a side. Not where bumps bend the shading normal: they do so as
/// the viewer's direction asks.
fn is_lambertian(y: &Vertex<'_>) -> bool {
    y.scattering.detail.is_none() && matches!(y.scattering.bsdf, Bsdf::Diffuse(_) | Bsdf::DiffuseTransmission(_))
}

/// Completes the paths of all members.
fn share<S: Suffix>(
    suffix: &S,
    scene: &Scene,
    is_open: bool,
    group: &[Option<Member<'_>>],
    seats: &mut [Seat],
    counters: &mut Counters,
) {
    let depth = suffix.depth();
    let mut claims = [Claim::NONE; MAX_GROUP];
    for (k, finder) in group.iter().enumerate() {
        let Some(finder) = finder else { continue };
        let seat = &mut seats[finder.seat];
        let is_own = finder.sample.lobe.is_specular();
        match finder.found {
            Found::Nothing => {}
            Found::Sky => escape(scene, &finder.leg, &mut seat.radiance, depth, &seat.lambda),
            Found::Surface(y) => {
                let joint = seat.joint;
                let mut lambda = seat.lambda;
                if is_own || !is_lambertian(&y) {
                    let mut leg = finder.leg;
                    let Some(beta) = roulette(leg.beta, leg.eta2, leg.events, depth, &joint, &lambda) else { continue };
                    leg.beta = beta;
                    // What disperses at y does so for this pixel alone.
                    let light = suffix.leaving(scene, y, leg, &joint, &mut lambda, counters);
                    seat.radiance += whole(light, &lambda, &seat.lambda, scene.mode);
                } else {
                    let leg = Leg { beta: Spectrum::ONE, eta2: 1.0, ..finder.leg };
                    let light = suffix.leaving(scene, y, leg, &joint, &mut lambda, counters);
                    let light = whole(light, &lambda, &seat.lambda, scene.mode);
                    if !light.is_finite() {
                        seat.radiance = light;
                    } else if is_open || !light.is_black() {
                        if is_open {
                            seat.radiance += finder.leg.beta
                                * finder.sky(finder.leg.ray.direction, finder.sample.pdf, scene, &seat.lambda);
                        }
                        share_surface(scene, is_open, group, k, &y, light, depth, &mut claims, seats, counters);
                    }
                }
            }
        }
    }
}

/// Radiance found along a path that may have lost its secondary wavelengths, as an estimate for all of them.
#[inline]
fn whole(light: Spectrum, lambda: &Wavelengths, of: &Wavelengths, mode: ColorMode) -> Spectrum {
    if mode == ColorMode::Rgb || lambda.pdf == of.pdf {
        return light;
    }
    Spectrum::new([light[0] * (of.pdf[0] / lambda.pdf[0]), 0.0, 0.0, 0.0])
}

/// Gives the light that leaves the Lambertian point that `k` found to all members that see it.
#[allow(clippy::too_many_arguments)]
fn share_surface(
    scene: &Scene,
    is_open: bool,
    group: &[Option<Member<'_>>],
    k: usize,
    y: &Vertex<'_>,
    light: Spectrum,
    depth: &Depth,
    claims: &mut [Claim; MAX_GROUP],
    seats: &mut [Seat],
    counters: &mut Counters,
) {
    let Some(finder) = &group[k] else { return };
    let (p, n) = (y.i.surface.p, y.i.surface.n);
    // Which side of y is seen, by the normal that decides about it, and the geometry term of the finder: others are held against it.
    let side = if y.i.surface.ns.dot(y.i.wo) > 0.0 { y.i.surface.ns } else { -y.i.surface.ns };
    let g = n.dot(y.i.wo).abs() / (p - finder.x.i.surface.p).length_squared();
    let sky = |member: &Member<'_>, w: Vec3, pdf: f32| {
        if is_open { member.sky(w, pdf, scene, &seats[member.seat].lambda) } else { Spectrum::ZERO }
    };
    let mut total = 0.0;
    for (m, member) in group.iter().enumerate() {
        claims[m] = Claim::NONE;
        let Some(member) = member else { continue };
        if m == k {
            let pdf = finder.sample.pdf;
            claims[m] =
                Claim { value: finder.sample.weight * pdf, pdf, sky: sky(finder, finder.leg.ray.direction, pdf) };
        } else {
            // The same number of events lies before y, unless it does not matter.
            if member.events != finder.events && depth.max != u32::MAX {
                continue;
            }
            let to = p - member.x.i.surface.p;
            let d2 = to.length_squared();
            let distance = d2.sqrt();
            let w = to / distance;
            if side.dot(w) >= 0.0 {
                continue;
            }
            let e = member.x.scattering.bsdf.eval(member.wo, member.x.frame.to_local(w), TransportMode::Radiance);
            if e.value.is_black() && e.pdf <= 0.0 {
                continue;
            }
            let relative = n.dot(w).abs() / (d2 * g);
            if !(relative > 0.0 && relative.is_finite()) {
                continue;
            }
            counters.rays += 1;
            if scene.occluded(&member.x.i.spawn_towards(w, distance)) {
                continue;
            }
            claims[m] = Claim { value: e.value * relative, pdf: e.pdf * relative, sky: sky(member, w, e.pdf) };
        }
        total += claims[m].pdf;
    }
    for (member, claim) in group.iter().zip(&*claims) {
        let Some(member) = member else { continue };
        if !claim.value.is_black() {
            seats[member.seat].radiance += member.beta * claim.value * (light - claim.sky) / total;
        }
    }
}

/// Whether the sky is met by more than a quarter of the directions from what the camera sees, by a few hundred of them.
pub(crate) fn is_open(scene: &Scene) -> bool {
    if scene.lights.environments.is_empty() {
        return false;
    }
    const EDGE: u32 = 16;
    let (mut seen, mut escaped) = (0, 0);
    for k in 0..EDGE * EDGE {
        let size = Vec2::new(scene.film.width as f32, scene.film.height as f32);
        let place = Vec2::new((k % EDGE) as f32 + 0.5, (k / EDGE) as f32 + 0.5) / EDGE as f32;
        let ray = scene.camera.ray(&scene.film, place * size, Vec2::splat(0.5));
        let Some(hit) = scene.intersect(&ray) else { continue };
        let i = scene.interaction(&ray, &hit);
        let n = if i.surface.n.dot(i.wo) > 0.0 { i.surface.n } else { -i.surface.n };
        let w =
            Frame::from_z(n).to_world(warp::cosine_hemisphere(Vec2::from(sobol::shuffled_scrambled_sobol_2d(k, 1))));
        seen += 1;
        escaped += u32::from(!scene.occluded(&i.spawn(w)));
    }
    escaped * 4 > seen
}
