//! Path tracing as sessions run it: with what trials find to pay against noise.

use crate::{
    Counters, Depth, Plan, Session, Stop,
    path::PathTracer,
    precomputed::{Precomputed, VarianceReduction},
    sharing::{self, GroupBuffer},
    support, trials,
    wave::{WaveBuffer, wave},
};
use std::sync::Arc;
use steradian_core::Scene;
use steradian_engine::{
    Asked, CameraPaths, Feature, GroupIntegrator, Method, MethodKind, PathContext, PixelSample, Refusal, Support, Tiles,
};
use steradian_transport::NoGuide;

/// A path tracer whose paths share what they find, ask photons, and are more than one for a sample, where that pays.
#[derive(Clone, Copy, Debug)]
pub struct SharedPath<const MEDIA: bool> {
    /// The path tracer.
    pub path: PathTracer<MEDIA>,
    /// Variance reduction.
    pub variance_reduction: VarianceReduction,
}

/// `path`.
pub const PATH: MethodKind =
    MethodKind::new("path", |asked| Ok(Arc::new(SharedPath::<false>::of(asked, asked.depth()))));

/// `volpath`.
pub const VOLPATH: MethodKind =
    MethodKind::new("volpath", |asked| Ok(Arc::new(SharedPath::<true>::of(asked, asked.depth()))));

/// `direct`: paths of one event at most.
pub const DIRECT: MethodKind = MethodKind::new("direct", |asked| {
    let depth = asked.depth();
    Ok(Arc::new(SharedPath::<false>::of(asked, Depth { max: depth.max.min(1), ..depth })))
});

impl<const MEDIA: bool> Method for SharedPath<MEDIA> {
    fn supports(&self, feature: Feature) -> Support {
        match feature {
            Feature::LightGroups | Feature::Bounces => Support::Exact,
            Feature::Media if !MEDIA => Support::LeavesOut(""),
            _ => support::of_camera_rays(feature),
        }
    }

    fn session(&self, scene: Arc<Scene>, plan: Plan) -> Result<Box<dyn Session>, Refusal> {
        Ok(Box::new(Tiles::new(scene, *self, plan)))
    }

    fn camera_paths(&self) -> Option<CameraPaths> {
        Some(CameraPaths { depth: self.path.depth, media: MEDIA, is_plain: true })
    }
}

impl<const MEDIA: bool> SharedPath<MEDIA> {
    /// With the options of a request.
    fn of(asked: &Asked<'_>, depth: Depth) -> Self {
        Self { path: PathTracer { depth }, variance_reduction: VarianceReduction::of(asked.options) }
    }

    /// Follows one path that may change its wavelengths and its moment.
    fn alone(&self, scene: &Scene, sample: &mut PixelSample, counters: &mut Counters) {
        let PixelSample { ray, own, lambda, radiance, .. } = sample;
        // The film sees the wavelengths that the path began with.
        let mut shifted = *lambda;
        let context = &mut PathContext { scene, sampler: own, lambda: &mut shifted, counters };
        *radiance = self.path.arriving(*ray, None::<&NoGuide>, context);
        if shifted.is_secondary_terminated() {
            lambda.terminate_secondary();
        }
    }
}

impl<const MEDIA: bool> GroupIntegrator for SharedPath<MEDIA> {
    type Prepared = Precomputed;
    type Buffer<'s> = (GroupBuffer<'s>, WaveBuffer<'s>);

    fn prepare(&self, scene: &Scene, plan: &Plan, stop: &Stop) -> Precomputed {
        trials::run(scene, &self.path, &self.variance_reduction.by(plan), plan, stop)
    }

    fn works_unprepared(&self) -> bool {
        true
    }

    fn group<'s>(
        &self,
        scene: &'s Scene,
        precomputed: &Precomputed,
        pixel_samples: &mut [PixelSample],
        (buffer, _): &mut Self::Buffer<'s>,
        counters: &mut Counters,
    ) {
        match pixel_samples {
            [sample] if scene.needs_scalar_path_tracer() => self.alone(scene, sample, counters),
            [PixelSample { ray, own, lambda, radiance, .. }] => {
                let context = &mut PathContext { scene, sampler: own, lambda, counters };
                *radiance = self.path.arriving(*ray, precomputed.guide(), context);
            }
            _ => sharing::group(&self.path, scene, precomputed, pixel_samples, buffer, counters),
        }
    }

    fn wave<'s>(
        &self,
        scene: &'s Scene,
        precomputed: &Precomputed,
        pixel_samples: &mut [PixelSample],
        (_, buffer): &mut Self::Buffer<'s>,
        counters: &mut Counters,
    ) {
        if scene.needs_scalar_path_tracer() {
            for sample in pixel_samples {
                let before = counters.rays;
                self.alone(scene, sample, counters);
                sample.rays = (counters.rays - before) as u32;
            }
            return;
        }
        wave(&self.path, scene, precomputed, pixel_samples, buffer, counters);
    }

    fn max_events(&self) -> u32 {
        self.path.depth.max
    }

    fn group_size(&self, precomputed: &Precomputed) -> u32 {
        precomputed.reuse()
    }

    fn may_share(&self, plan: &Plan) -> bool {
        // Paths of one event share nothing.
        self.path.depth.max > 1 && self.variance_reduction.by(plan).reuse != Some(1)
    }

    fn paths(&self, precomputed: &Precomputed, pixel: [u32; 2]) -> u32 {
        precomputed.splitting.paths(pixel)
    }

    fn rarest_path_probability(&self, precomputed: &Precomputed) -> Option<f64> {
        precomputed.rarest_path_probability
    }

    fn asks_photons(&self, precomputed: &Precomputed) -> bool {
        precomputed.guides.caustics.is_some()
    }
}
