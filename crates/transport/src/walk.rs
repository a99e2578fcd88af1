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
    arrive::<MEDIA>(&mut path_state, depth, &mut sink, &mut first, context);
    match &first {
        Arrival::Vertex(v) => leaving::<MEDIA, S>(v, path_state, *depth, guide, context, sink),
        Arrival::End => sink,
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
    let (mut vertex, mut next) = (vertex, Arrival::End);
    loop {
        // Light that arrives straight from a light.
        path_state.add_direct::<MEDIA>(vertex, &mut sink, context);
        // Scatter.
        let Some(s) = path_state.sample(vertex, context.sampler, guide) else { return sink };
        sink.tell(Step::Scattered(&s.sample));
        if s.sample.lobe.is_subsurface() {
            // Below the surface counts for none of the events that are asked for.
            depth.max = depth.max.saturating_add(EVENTS_BELOW);
            let Some(v) = path_state.emerge(vertex, &s.sample, context) else { return sink };
            if !path_state.survives(&depth, context) {
                sink.tell(Step::Roulette);
                return sink;
            }
            next = Arrival::Vertex(v);
            let Arrival::Vertex(v) = &next else { return sink };
            if let Vertex::Surface { i, .. } = v {
                sink.tell(Step::Surface(path_state.segment(), i));
            }
            vertex = v;
            continue;
        }
        if s.sample.lobe.is_transmission() {
            sink.refract(s.sample.eta);
        }
        path_state.turn::<MEDIA>(context.scene, vertex, &s);
        if !path_state.beta.is_finite() {
            // Handed to the film, which counts it.
            sink.spoil(path_state.beta);
            return sink;
        }
        if !path_state.survives(&depth, context) {
            sink.tell(Step::Roulette);
            return sink;
        }
        // Follow the ray to the next vertex; collect what shines there.
        arrive::<MEDIA>(&mut path_state, &depth, &mut sink, &mut next, context);
        match &next {
            Arrival::Vertex(v) => vertex = v,
            Arrival::End => return sink,
            Arrival::Escaped => {
                escape(&path_state, &depth, &mut sink, context);
                return sink;
            }
        }
    }
}
