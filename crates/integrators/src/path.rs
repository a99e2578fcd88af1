//! Path tracing: at every vertex a light sample and a direction drawn by scattering, weighted by the power heuristic
//! (Veach 1997, ch. 9), and Russian roulette on the throughput; on surfaces alone or through media.

use crate::Depth;
use steradian_engine::{Integrator, PathContext};
use steradian_math::{Ray, Spectrum};
use steradian_transport::{Arrival, Guide, NoGuide, PathState, Sink, Vertex, arrive, escape, subsurface::EVENTS_BELOW};

/// The path tracer. Without `MEDIA` these are ignored; surfaces that scatter nothing are passed.
#[derive(Clone, Copy, Debug)]
pub struct PathTracer<const MEDIA: bool> {
    /// How far paths are followed; events in media count as those on surfaces. Passing straight through a thin pane is
    /// none.
    pub depth: Depth,
}

impl<const MEDIA: bool> PathTracer<MEDIA> {
    /// The radiance that arrives along a camera ray.
    #[inline]
    pub(crate) fn arriving(&self, ray: Ray, guide: Option<&impl Guide>, context: &mut PathContext<'_, '_>) -> Spectrum {
        self.along(PathState::camera(context.scene, ray), guide, context, Spectrum::ZERO)
    }

    /// The radiance that arrives along a path's ray, times what the path carries, in a sink.
    #[inline]
    pub(crate) fn along<S: Sink>(
        &self,
        mut path_state: PathState,
        guide: Option<&impl Guide>,
        context: &mut PathContext<'_, '_>,
        mut sink: S,
    ) -> S {
        let mut first = Arrival::End;
        arrive::<MEDIA>(&mut path_state, &self.depth, &mut sink, &mut first, context);
        match &first {
            Arrival::Vertex(v) => self.leaving(v, path_state, guide, context, sink),
            Arrival::End => sink,
            Arrival::Escaped => {
                escape(&path_state, &self.depth, &mut sink, context);
                sink
            }
        }
    }

    /// What a path brings that arrived at a vertex, what came before it in `sink`: light scattered there towards where
    /// it came from, without emission.
    #[inline]
    pub(crate) fn leaving<'s, S: Sink>(
        &self,
        vertex: &Vertex<'s>,
        mut path_state: PathState,
        guide: Option<&impl Guide>,
        context: &mut PathContext<'s, '_>,
        mut sink: S,
    ) -> S {
        let (mut vertex, mut next, mut depth) = (vertex, Arrival::End, self.depth);
        loop {
            // Light that arrives straight from a light.
            path_state.add_direct::<MEDIA>(vertex, &mut sink, context);
            // Scatter.
            let Some(s) = path_state.sample(vertex, context.sampler, guide) else { return sink };
            if s.sample.lobe.is_subsurface() {
                // Below the surface counts for none of the events that are asked for.
                depth.max = depth.max.saturating_add(EVENTS_BELOW);
                let Some(v) = path_state.emerge(vertex, &s.sample, context) else { return sink };
                if !path_state.survives(&depth, context) {
                    return sink;
                }
                next = Arrival::Vertex(v);
                let Arrival::Vertex(v) = &next else { return sink };
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
}

impl<const MEDIA: bool> Integrator for PathTracer<MEDIA> {
    type Prepared = ();

    fn radiance(&self, (): &(), ray: Ray, context: &mut PathContext<'_, '_>) -> Spectrum {
        self.arriving(ray, None::<&NoGuide>, context)
    }
}
