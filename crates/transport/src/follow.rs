//! The steps of which path tracers are made: along a ray to the next point that scatters, and what shines on the way.
//! `MEDIA` says whether light is scattered between surfaces, and seen through thin panes; without, media are ignored.

use crate::{
    Depth, MAX_PASSES,
    flight::Flight,
    live_max, nee,
    sink::{Sink, Step},
    state::PathState,
    tracking,
    vertex::Vertex,
    volume_emission,
};
use steradian_core::{
    Scene,
    material::Scattering,
    scene::{Hit, Interaction},
};
use steradian_engine::{Counters, PathContext, dimension};
use steradian_math::{Frame, Spectrum};

/// End of a ray. In place, since nothing is allocated per sample.
#[expect(
    clippy::large_enum_variant,
    reason = "values live on the stack of one step; a box would cost an allocation per vertex"
)]
#[derive(Clone, Copy, Debug)]
pub enum Arrival<'s> {
    /// A point that scatters, within the depth.
    Vertex(Vertex<'s>),
    /// The path ends.
    End,
    /// Nothing is met.
    Escaped,
}

/// Follows a path to the next point that scatters, passing what does not; adds what surfaces emit on the way to `sink`.
/// The background is left to the caller. What it leads to is written where it stays, since it is large.
#[inline]
pub fn arrive<'s, const MEDIA: bool>(
    path_state: &mut PathState,
    depth: &Depth,
    sink: &mut impl Sink,
    arrival: &mut Arrival<'s>,
    context: &mut PathContext<'s, '_>,
) {
    // Nearest hit of the path's ray; all that happens on the way there and at the hit is told in `meet`.
    context.counters.rays += 1;
    let hit = context.scene.intersect(&path_state.ray);
    meet::<MEDIA>(path_state, (hit, false), depth, sink, arrival, context);
}

/// As [`arrive`], where it is known what the ray hits first, and maybe that the path gets there through the medium.
#[inline]
pub fn meet<'s, const MEDIA: bool>(
    path_state: &mut PathState,
    (mut hit, mut has_flown): (Option<Hit>, bool),
    depth: &Depth,
    sink: &mut impl Sink,
    arrival: &mut Arrival<'s>,
    PathContext { scene, sampler, lambda, counters }: &mut PathContext<'s, '_>,
) {
    let scene = *scene;
    *arrival = Arrival::End;
    // Each turn of the loop handles one segment of the ray: a flight through its medium, then the surface at its end.
    // Only surfaces that scatter nothing lead to a further turn.
    loop {
        if counters.stop.is_asked() {
            return;
        }
        // 1. The medium of the segment, unless the caller has flown through it already: the path either scatters before
        // the surface or passes to it (volumetric path tracing, with null collisions where the medium varies).
        if let (true, false, Some(medium)) = (MEDIA, std::mem::take(&mut has_flown), path_state.medium) {
            let scattering = &scene.media()[medium as usize];
            // The segment ends at the hit, or where the ray ends.
            let distance = hit.as_ref().map_or(path_state.ray.t_max, |h| h.t);
            // Two random numbers: for the distance, and for the lane (wavelength) whose extinction draws it.
            let u = sampler.get_1d(path_state.dimension(dimension::FLIGHT));
            let lane = sampler.get_1d(path_state.dimension(dimension::LANE));
            // MIS weight of emission along the segment: a light sample of the emissive medium at the last vertex could
            // have taken the same direction.
            let weight = volume_emission::weight(scene, medium, &path_state.origin, path_state.ray.direction);
            let mut glow = Spectrum::ZERO;
            let way = (&path_state.ray, distance);
            let flight = tracking::fly(scattering, way, (lane, u), (scene, lambda, &counters.stop), &mut glow);
            if scattering.glow.is_some() {
                let light = path_state.beta * glow * weight;
                counters.note(path_state.events, || None, light);
                sink.add(light);
            }
            // β is multiplied by the transmittance, times σs if the path scatters, over the density of the flight (the
            // mean over lanes).
            let (factor, t) = match flight {
                Flight::Passed(factor) => (factor, None),
                Flight::Scattered(t, factor) => (factor, Some(t)),
            };
            path_state.beta *= factor;
            // Nothing is left in any lane that counts: the path ends.
            if live_max(path_state.beta, lambda) <= 0.0 {
                return;
            }
            // The path scatters in the medium. This is its next vertex, if the depth allows one more event.
            if let Some(t) = t {
                sink.advance(t);
                let (p, wo) = (path_state.ray.at(t), -path_state.ray.direction);
                sink.tell(Step::Medium(path_state.segment(), p));
                if path_state.events < depth.max {
                    *arrival = Arrival::Vertex(Vertex::Medium { p, wo, time: path_state.ray.time, scattering, medium });
                }
                return;
            }
        }
        // 2. The flight reached the end of the segment without a surface: the path escapes, and the caller adds the
        // light of the environments (`escape`).
        let Some(met) = hit else {
            *arrival = Arrival::Escaped;
            return;
        };
        // 3. The surface: point, normals and parametrisation.
        let i = scene.interaction_of_light(&path_state.ray, &met);
        sink.advance(i.t);
        sink.tell(Step::Surface(path_state.segment(), &i));
        // 4. Its emission: β Le w, with w the power heuristic against the light sample of the last vertex. Camera rays
        // see no emission where lights are hidden from the camera.
        if !(path_state.events == 0 && depth.hide_emitters) {
            let light = path_state.beta * nee::emission(scene, &i, &path_state.origin, lambda);
            let emitter = || scene.geometries()[i.geometry as usize].emitter;
            // The light is noted by its number of events, or by the group of its emitter, where that is asked for.
            counters.note(path_state.events, || emitter().map(|e| scene.light_groups().of_emitters[e as usize]), light);
            sink.add(light);
        }
        // Camera rays go straight through emitters that are hidden from the camera.
        if depth.hides(scene, i.geometry, path_state.events) {
            let Some(next) = go_straight::<MEDIA>(path_state, &i, sink, (scene, counters)) else { return };
            hit = next;
            continue;
        }
        // 5. At the last vertex only emission counts, and black surfaces end every path. Where surfaces may be passed
        // straight, it takes the scattering model to tell the last vertex from an interface, which is no event.
        let is_last = path_state.events >= depth.max;
        if is_last && !scene.is_see_through() || scene.is_black(i.geometry) {
            return;
        }
        // Random number for the choice among the materials of a mixture; drawn only in scenes with mixtures.
        let choice = sampler.get_1d_lazily(path_state.dimension(dimension::MIXTURE), scene.has_mixtures());
        // 6. The scattering model: textures, bump and normal maps are evaluated with the footprint of the ray
        // differential, and the result is written into the vertex where it stays.
        let surface =
            Vertex::Surface { i, scattering: Scattering::NONE, frame: Frame::IDENTITY, medium: path_state.medium };
        *arrival = Arrival::Vertex(surface);
        let Arrival::Vertex(Vertex::Surface { i, scattering, frame, .. }) = arrival else { return };
        let differential = path_state.differential.as_ref();
        // The surface scatters: this is the next vertex of the path.
        if scene.write_scattering(i, differential, choice, lambda, (scattering, frame)) {
            // Phosphorescence holds light back for an exponential time of mean τ, t = −τ ln(1 − u): the path goes on at
            // an earlier moment of the lights.
            if scattering.lifetime > 0.0 {
                let u = sampler.get_1d(path_state.dimension(dimension::DELAY));
                let delay = -scattering.lifetime * (-u).ln_1p();
                lambda.delay += delay;
                sink.wait(delay);
            }
            if !is_last {
                return;
            }
            // The depth is reached, and emission was added. What light passes straight is no event: the path goes on to
            // what shines behind thin panes, as shadow rays do.
            let straight = if MEDIA { scattering.bsdf.straight_transmission(frame.to_local(i.wo)) } else { None };
            let Some(part) = straight else {
                *arrival = Arrival::End;
                return;
            };
            path_state.beta *= part;
        }
        // 7. The surface scatters nothing (an interface between media): the path goes on behind it, without an event.
        let i = *i;
        *arrival = Arrival::End;
        let Some(next) = go_straight::<MEDIA>(path_state, &i, sink, (scene, counters)) else { return };
        hit = next;
    }
}

/// Leaves a surface straight on the other side, and finds what is hit next; `None` where the path has passed too many.
#[inline]
fn go_straight<const MEDIA: bool>(
    path_state: &mut PathState,
    i: &Interaction,
    sink: &mut impl Sink,
    (scene, counters): (&Scene, &mut Counters),
) -> Option<Option<Hit>> {
    sink.tell(Step::Passed);
    // The ray starts anew behind the surface, in the medium of that side.
    path_state.pass::<MEDIA>(scene, i);
    // The nearest hit from there; the bound keeps paths from passing surfaces for ever.
    (path_state.passes <= MAX_PASSES).then(|| {
        counters.rays += 1;
        scene.intersect(&path_state.ray)
    })
}

/// Adds the light of the environments that a path met to `sink`.
#[inline]
pub fn escape(path_state: &PathState, depth: &Depth, sink: &mut impl Sink, context: &mut PathContext<'_, '_>) {
    sink.tell(Step::Escaped(path_state.segment()));
    // The background is hidden from camera rays together with the lights.
    if path_state.events == 0 && depth.hide_emitters {
        return;
    }
    let (ray, origin) = (&path_state.ray, &path_state.origin);
    let has_backdrop = path_state.events == 0 && context.scene.lights().backdrop.is_some();
    if !context.counters.parts.is_empty() && !has_backdrop {
        note_environments(path_state, context);
    }
    // β Σ Le w over all environments, with w the power heuristic against light sampling at the last vertex.
    let light = path_state.beta * nee::behind(context.scene, ray, path_state.events, origin, context.lambda);
    sink.add_from_infinity(light, ray.origin, ray.direction);
}

/// Notes the light of the environments one by one.
#[cold]
fn note_environments(path_state: &PathState, context: &mut PathContext<'_, '_>) {
    let PathContext { scene, lambda, counters, .. } = context;
    let (ray, origin) = (&path_state.ray, &path_state.origin);
    for &light in &scene.lights().environments {
        let found = nee::environment(scene, light, ray.origin, ray.direction, origin, lambda);
        let group = || Some(scene.light_groups().of_lights[light as usize]);
        counters.note(path_state.events, group, path_state.beta * found);
    }
}
