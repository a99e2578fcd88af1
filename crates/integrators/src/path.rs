//! Path tracing, on surfaces alone or through media: the loop of [`steradian_transport::leaving`] from the camera.
//!
//! [`PathTracer`] is `path` without media and `volpath` with them. `SharedPath` wraps it with sharing, guides and
//! splitting against noise. The example `path_recursive` of `steradian` computes the same bits recursively; a test
//! compares them.

use crate::Depth;
use steradian_engine::{Integrator, PathContext};
use steradian_math::{Ray, Spectrum};
use steradian_transport::{Guide, NoGuide, PathState, Sink, Vertex};

/// The path tracer. Without `MEDIA` these are ignored; surfaces that scatter nothing are passed.
#[derive(Clone, Copy, Debug)]
pub struct PathTracer<const MEDIA: bool> {
    /// Path depth; events in media count as those on surfaces. Passing straight through a thin pane is none.
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
        path_state: PathState,
        guide: Option<&impl Guide>,
        context: &mut PathContext<'_, '_>,
        sink: S,
    ) -> S {
        steradian_transport::along::<MEDIA, S>(path_state, &self.depth, guide, context, sink)
    }

    /// Continues a path from a vertex at which it arrived; adds its light to a sink.
    #[inline]
    pub(crate) fn leaving<'s, S: Sink>(
        &self,
        vertex: &Vertex<'s>,
        path_state: PathState,
        guide: Option<&impl Guide>,
        context: &mut PathContext<'s, '_>,
        sink: S,
    ) -> S {
        steradian_transport::leaving::<MEDIA, S>(vertex, path_state, self.depth, guide, context, sink)
    }
}

impl<const MEDIA: bool> Integrator for PathTracer<MEDIA> {
    type Prepared = ();

    fn radiance(&self, (): &(), ray: Ray, context: &mut PathContext<'_, '_>) -> Spectrum {
        self.arriving(ray, None::<&NoGuide>, context)
    }
}
