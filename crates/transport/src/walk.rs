//! The loop of path tracing: at every vertex a light sample and a direction drawn by scattering, weighted by the power
//! heuristic (Veach 1997, ch. 9), and Russian roulette on the throughput. `MEDIA` says whether light is scattered
//! between surfaces; without, surfaces that scatter nothing are passed.

use crate::{
    Depth,
    follow::{Arrival, arrive, escape},
    guide::Guide,
    sink::{Sink, Step},
    state::PathState,
    subsurface::EVENTS_BELOW,
    vertex::Vertex,
};
use steradian_engine::PathContext;

/// The radiance that arrives along a path's ray, times what the path carries, in a sink.
#[inline]
pub fn along<const MEDIA: bool, S: Sink>(
    mut path_state: PathState,
    depth: &Depth,
    guide: Option<&impl Guide>,
    context: &mut PathContext<'_, '_>,
    mut sink: S,
) -> S {
    let mut first = Arrival::End;
    // The first vertex; emission on the way to it goes to the sink, where it counts fully for camera rays.
    arrive::<MEDIA>(&mut path_state, depth, &mut sink, &mut first, context);
    match &first {
        // All light that the vertex scatters back along the ray.
        Arrival::Vertex(v) => leaving::<MEDIA, S>(v, path_state, *depth, guide, context, sink),
        Arrival::End => sink,
        // Nothing was met: the environments.
        Arrival::Escaped => {
            escape(&path_state, depth, &mut sink, context);
            sink
        }
    }
}

/// Continues a path from a vertex at which it arrived, with the light before it in `sink`: adds light scattered there
/// towards where the path came from, without emission.
#[inline]
pub fn leaving<'s, const MEDIA: bool, S: Sink>(
    vertex: &Vertex<'s>,
    mut path_state: PathState,
    mut depth: Depth,
    guide: Option<&impl Guide>,
    context: &mut PathContext<'s, '_>,
    mut sink: S,
) -> S {
    // The vertex in hand is the caller's at first, then the one in `next`.
    let (mut vertex, mut next) = (vertex, Arrival::End);
    // One turn for each vertex: (1) light sample, (2) direction by the scattering model, (3) throughput and roulette,
    // (4) the next vertex with its emission. The estimator is `Σ_k β_k (NEE_k + Le_{k+1} w)`, with
    // `β_{k+1} = β_k f |cosθ| / p`.
    loop {
        // (1) Next-event estimation: β f |cosθ| L V w / p by a light sample, w weighted against (2) by the power
        // heuristic.
        path_state.add_direct::<MEDIA>(vertex, &mut sink, context);
        // (2) A direction with density p, by the scattering model, or by a mixture of it and the guide. None: absorbed.
        let Some(s) = path_state.sample(vertex, context.sampler, guide) else { return sink };
        sink.tell(Step::Scattered(&s.sample));
        // Subsurface scattering: the path enters the body here and goes on from the point where it leaves it.
        if s.sample.lobe.is_subsurface() {
            // Below the surface counts for none of the events that are asked for.
            depth.max = depth.max.saturating_add(EVENTS_BELOW);
            // The exit point is a vertex of its own, whose model scatters by `(1 − F)/(c π)`; the path is lost where
            // none is found.
            let Some(v) = path_state.emerge(vertex, &s.sample, context) else { return sink };
            if !path_state.survives(&depth, context) {
                sink.tell(Step::Roulette);
                return sink;
            }
            // At the exit the turn begins anew: a light sample there, and a direction out of the body.
            next = Arrival::Vertex(v);
            let Arrival::Vertex(v) = &next else { return sink };
            if let Vertex::Surface { i, .. } = v {
                sink.tell(Step::Surface(path_state.segment(), i));
            }
            vertex = v;
            continue;
        }
        // Optical path lengths (transient renders) go by the refractive index beyond the surface.
        if s.sample.lobe.is_transmission() {
            sink.refract(s.sample.eta);
        }
        // (3) β ← β f |cosθ| / p, and the ray in the new direction. Thin panes that are passed straight count as no
        // event.
        path_state.turn::<MEDIA>(context.scene, vertex, &s);
        if !path_state.beta.is_finite() {
            // Handed to the film, which counts it.
            sink.spoil(path_state.beta);
            return sink;
        }
        // Russian roulette on β: survivors carry β/q.
        if !path_state.survives(&depth, context) {
            sink.tell(Step::Roulette);
            return sink;
        }
        // (4) The next vertex. Emission on the way there is added to the sink with its MIS weight.
        arrive::<MEDIA>(&mut path_state, &depth, &mut sink, &mut next, context);
        match &next {
            // The loop goes on from there.
            Arrival::Vertex(v) => vertex = v,
            Arrival::End => return sink,
            // The path left the scene: environments, with their MIS weights.
            Arrival::Escaped => {
                escape(&path_state, &depth, &mut sink, context);
                return sink;
            }
        }
    }
}
