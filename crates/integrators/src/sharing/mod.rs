//! Paths of neighbouring pixels share what they find (Bekaert, Sbert, Halton 2002, "Accelerating Path Tracing by
//! Re-Using Paths").
//!
//! The pixels of a group follow a path each to its first vertex that is not specular, x, and draw a direction there,
//! which leads to a vertex y. What one path finds there serves all members of the group that see y: of the technique
//! "member m drew y" there is one sample per member, and they are put together by the balance heuristic (Veach 1997,
//! eq. 9.8 ff.),
//!
//! `I_j = β_j Σ_k f_j |cos_j| G(x_j, y_k) V(x_j, y_k) L(y_k → x_j) / Σ_m p_m(y_k) G(x_m, y_k) V(x_m, y_k)`
//!
//! with `p_m` the density per solid angle with which m draws the direction to `y_k`, and `G = |cos_y| / d²`. Visibility
//! is traced for all pairs, so the weights of a point sum to one, and the estimate is unbiased; samples of one pixel
//! stay independent of each other. Where y is Lambertian, light that leaves it is the same towards everyone on its
//! side. Elsewhere the finder's light sample and its direction at y are evaluated towards each member, and directions
//! drawn there are weighed once more (`sharing/share.rs`): what comes to y from beyond is still the same for all. What
//! may not be shared is decided by x alone (who is a member), or by y alone (what serves its finder only). Light that y
//! emits, and that of environments, is the finder's own.
//!
//! In open scenes most directions lead to the sky, and surfaces stand in its place where they are met. There `L` is
//! held against the sky: the finder takes the sky in its direction whether or not something is before it, which needs
//! no visibility, and what is shared is the difference `L − L_sky`, negative where surfaces are darker than what they
//! hide (a control variate).
//!
//! Groups have 4 or 16 pixels and move with every sample index (`steradian_engine::partition`), so that no tile has
//! visible edges. No member receives more from a shared path than from its own. Errors of pixels up to 15 columns or
//! rows apart are correlated; `tiles::scales` of the engine measures the error of means over 4, 8 and 16 pixels from
//! the difference of even and odd samples. Pixels share by request; with `reuse=auto` a trial compares group sizes by
//! variance × cost (`trials::sharing`), for pictures that are not small. Scenes with media that vary do not share: the
//! densities of flights towards other members are unknown there.

mod share;

use crate::{Counters, path::PathTracer, precomputed::Precomputed};
use share::share;
use steradian_bsdf::{Bsdf, BsdfSample};
use steradian_core::{Scene, scene::Hit};
use steradian_engine::{PathContext, PixelSample, partition::MAX_GROUP};
use steradian_math::{Ray, Spectrum, spectra::Wavelengths};
use steradian_transport::{Arrival, PathState, Vertex, arrive, escape, live_max, meet};

const NO_RAY: Ray = PathState::NONE.ray;

/// Mean cosine from which on phase functions count as narrow.
const FORWARD: f32 = 0.9;

/// Roughness α below which lobes count as narrow.
const NARROW: f32 = 0.04;

/// A pixel that shares.
#[derive(Clone, Copy, Debug)]
struct Member<'s> {
    pixel_sample: usize,
    /// First vertex that is not specular.
    x: Arrival<'s>,
    /// Path throughput at x.
    beta: Spectrum,
    /// Scattering events before x.
    events: u32,
    /// The way on.
    sample: BsdfSample,
    /// The density by the surface over the one it was drawn with: claims are weighed by the former.
    ratio: f32,
    path_state: PathState,
    /// End of the ray beyond x.
    y: Arrival<'s>,
    /// The wavelengths that y left.
    lambda: Wavelengths,
}

/// Room for the paths of a group; kept, so that nothing is allocated per sample.
#[derive(Debug)]
pub struct GroupBuffer<'s>(Vec<Member<'s>>);

impl Default for GroupBuffer<'_> {
    fn default() -> Self {
        Self(vec![Member::NONE; MAX_GROUP])
    }
}

impl<'s> Member<'s> {
    const NONE: Self = Self {
        pixel_sample: 0,
        x: Arrival::End,
        beta: Spectrum::ZERO,
        events: 0,
        sample: BsdfSample::NONE,
        ratio: 1.0,
        path_state: PathState::NONE,
        y: Arrival::End,
        lambda: Wavelengths::RGB,
    };

    /// Follows a path from the camera, of which the first hit is known, to its first vertex that is not specular;
    /// whether there is one.
    #[inline]
    fn reach<const MEDIA: bool>(
        &mut self,
        PathTracer { depth }: &PathTracer<MEDIA>,
        precomputed: &Precomputed,
        hit: Option<Hit>,
        radiance: &mut Spectrum,
        (ray, context): (Ray, &mut PathContext<'s, '_>),
    ) -> bool {
        let Self { path_state, x, .. } = self;
        // The camera path up to x: emission and specular vertices are the pixel's own, as in the loop of single paths.
        *path_state = PathState::camera(context.scene, ray);
        meet::<MEDIA>(path_state, (hit, false), depth, radiance, x, context);
        loop {
            match x {
                // x is found: the first vertex at which others' directions have a density.
                Arrival::Vertex(v) if !v.is_specular() => {
                    path_state.lights = precomputed.effort.lights;
                    return true;
                }
                Arrival::Vertex(v) => {
                    let guide = precomputed.guide();
                    let Some(draw) = path_state.sample(v, context.sampler, guide) else { return false };
                    // A mirror or clear pane: throughput, roulette, and on to the next vertex.
                    path_state.turn::<MEDIA>(context.scene, v, &draw);
                    if !path_state.beta.is_finite() {
                        *radiance = path_state.beta;
                        return false;
                    }
                    if !path_state.survives(depth, context) {
                        return false;
                    }
                    arrive::<MEDIA>(path_state, depth, radiance, x, context);
                }
                Arrival::End => return false,
                Arrival::Escaped => {
                    escape(path_state, depth, radiance, context);
                    return false;
                }
            }
        }
    }

    /// Draws a direction at x; whether it is to be followed.
    #[inline]
    fn turn<const MEDIA: bool>(
        &mut self,
        scene: &'s Scene,
        precomputed: &Precomputed,
        pixel_sample: &mut PixelSample,
    ) -> bool {
        // What the member carries to x stays; without a direction its density is zero and it finds no y.
        (self.beta, self.events, self.y) = (self.path_state.beta, self.path_state.events, Arrival::End);
        self.sample.pdf = 0.0;
        let Self { x, path_state, .. } = self;
        let Arrival::Vertex(x) = x else { return false };
        // The direction at x is drawn by random numbers that are stratified over the group.
        let Some(draw) = path_state.sample(x, &pixel_sample.joint, precomputed.guide()) else { return false };
        (self.sample, self.ratio) = (draw.sample, draw.ratio);
        path_state.turn::<MEDIA>(scene, x, &draw);
        if !path_state.beta.is_finite() {
            pixel_sample.radiance = path_state.beta;
            return false;
        }
        live_max(path_state.beta, &pixel_sample.lambda) > 0.0
    }
}

/// Takes the samples of all pixels of a group.
pub(crate) fn group<'s, const MEDIA: bool>(
    path: &PathTracer<MEDIA>,
    scene: &'s Scene,
    precomputed: &Precomputed,
    pixel_samples: &mut [PixelSample],
    GroupBuffer(members): &mut GroupBuffer<'s>,
    counters: &mut Counters,
) {
    let guide = precomputed.guide();
    if MEDIA && scene.is_see_through() {
        // Ways between points may lead through several media.
        for PixelSample { ray, own, lambda, radiance, .. } in pixel_samples {
            *radiance = path.arriving(*ray, guide, &mut PathContext { scene, sampler: own, lambda, counters });
        }
        return;
    }
    // 1. All camera rays of the group in one batch, each followed to its x.
    let (mut rays, mut hits) = ([NO_RAY; MAX_GROUP], [None; MAX_GROUP]);
    rays.iter_mut().zip(&*pixel_samples).for_each(|(ray, pixel_sample)| *ray = pixel_sample.ray);
    scene.intersect_batch(&rays[..pixel_samples.len()], &mut hits[..pixel_samples.len()]);
    counters.rays += pixel_samples.len() as u64;
    let mut count = 0;
    for (index, (pixel_sample, hit)) in pixel_samples.iter_mut().zip(hits).enumerate() {
        let PixelSample { ray, own, lambda, radiance, .. } = pixel_sample;
        let for_all_wavelengths = *lambda;
        *radiance = Spectrum::ZERO;
        let member = &mut members[count];
        let context = &mut PathContext { scene, sampler: own, lambda, counters };
        if !member.reach(path, precomputed, hit, radiance, (*ray, context)) {
            continue;
        }
        let Arrival::Vertex(x) = &member.x else { continue };
        // Members are those that still carry all wavelengths and whose model can stand in for others; all other paths
        // go on alone.
        if *context.lambda == for_all_wavelengths && is_shareable(x) {
            member.pixel_sample = index;
            count += 1;
        } else {
            *radiance = path.leaving(x, member.path_state, guide, context, *radiance);
        }
    }
    let group = &mut members[..count];
    // A single member has nobody to share with.
    if let [Member { pixel_sample, x: Arrival::Vertex(x), path_state, .. }] = group {
        let PixelSample { own, lambda, radiance, .. } = &mut pixel_samples[*pixel_sample];
        let context = &mut PathContext { scene, sampler: own, lambda, counters };
        *radiance = path.leaving(x, *path_state, guide, context, *radiance);
        return;
    }
    // 2. Light samples at every x, each the pixel's own.
    for k in 0..precomputed.effort.lights {
        direct::<MEDIA>(scene, k, group, pixel_samples, counters);
    }
    if counters.stop.is_asked() {
        return;
    }
    // 3. Every member draws a direction at x and finds its y.
    bounce(path, scene, precomputed, group, pixel_samples, counters);
    if counters.stop.is_asked() {
        return;
    }
    // 4. The light that leaves each y goes to all members that see it.
    share(path, scene, precomputed, group, pixel_samples, counters);
}

/// Light straight from lights at all x, by the `k`th of their light samples.
fn direct<const MEDIA: bool>(
    scene: &Scene,
    k: u32,
    group: &[Member<'_>],
    pixel_samples: &mut [PixelSample],
    counters: &mut Counters,
) {
    let (mut rays, mut light, mut count) = ([NO_RAY; MAX_GROUP], [(0, Spectrum::ZERO); MAX_GROUP], 0);
    for Member { pixel_sample, x, path_state, .. } in group {
        let PixelSample { own, lambda, .. } = &mut pixel_samples[*pixel_sample];
        let Arrival::Vertex(x) = x else { continue };
        let context = PathContext { scene, sampler: own, lambda, counters };
        if let Some((value, ray)) = x.direct_along::<MEDIA>(path_state.event_of_light(k), &context) {
            (rays[count], light[count]) = (ray, (*pixel_sample, path_state.beta * value / path_state.lights as f32));
            count += 1;
        }
    }
    // Shadow rays of all members in one batch.
    let mut occluded = [false; MAX_GROUP];
    scene.occluded_batch(&rays[..count], &mut occluded[..count]);
    counters.rays += count as u64;
    for ((pixel_sample, light), _) in light[..count].iter().zip(occluded).filter(|(_, is_occluded)| !is_occluded) {
        pixel_samples[*pixel_sample].radiance += *light;
    }
}

/// Follows all members on from x; emission met there is the pixel's own.
fn bounce<'s, const MEDIA: bool>(
    PathTracer { depth }: &PathTracer<MEDIA>,
    scene: &'s Scene,
    precomputed: &Precomputed,
    group: &mut [Member<'s>],
    pixel_samples: &mut [PixelSample],
    counters: &mut Counters,
) {
    let (mut rays, mut places, mut count) = ([NO_RAY; MAX_GROUP], [0; MAX_GROUP], 0);
    for (m, member) in group.iter_mut().enumerate() {
        if member.turn::<MEDIA>(scene, precomputed, &mut pixel_samples[member.pixel_sample]) {
            (rays[count], places[count]) = (member.path_state.ray, m);
            count += 1;
        }
    }
    // The rays of all members in one batch; emission met at y is the finder's.
    let mut hits = [None; MAX_GROUP];
    scene.intersect_batch(&rays[..count], &mut hits[..count]);
    counters.rays += count as u64;
    for (m, hit) in places[..count].iter().zip(hits) {
        let Member { pixel_sample, path_state, y, lambda, .. } = &mut group[*m];
        let PixelSample { joint, lambda: common, radiance, .. } = &mut pixel_samples[*pixel_sample];
        *lambda = *common;
        let context = &mut PathContext { scene, sampler: joint, lambda, counters };
        meet::<MEDIA>(path_state, (hit, false), depth, radiance, y, context);
    }
}

/// True if members may stand in for each other at a vertex: a model whose evaluation has the density of its samples,
/// and not one from which no samples are drawn, nor one with a lobe so narrow that nobody else ever would.
fn is_shareable(v: &Vertex<'_>) -> bool {
    match v {
        Vertex::Surface { scattering, .. } => match &scattering.bsdf {
            Bsdf::Diffuse(b) => !b.reflectance.is_black(),
            Bsdf::DiffuseTransmission(_) | Bsdf::Coated(_) => true,
            Bsdf::Conductor(b) => b.microfacet.mean_alpha() > NARROW,
            Bsdf::Dielectric(b) => b.microfacet.mean_alpha() > NARROW,
            _ => false,
        },
        Vertex::Medium { scattering, .. } => scattering.phase.sharpest() < FORWARD,
    }
}
