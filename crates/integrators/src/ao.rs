//! Ambient occlusion: the part of the light of an evenly bright sky that reaches a surface past what is within a
//! distance, `1/π ∫ V(ω) cosθ dω`, by rays with density cosθ/π. A floor at the foot of an endless wall has ½.

use crate::{Integrator, MAX_PASSES, dimension, support};
use std::sync::Arc;
use steradian_core::Scene;
use steradian_engine::{Feature, Method, MethodKind, PathContext, Plan, Refusal, Session, Support, Tiles, local_scene};
use steradian_math::{Frame, Ray, Spectrum, spectra::role, warp};

/// Ambient occlusion.
#[derive(Clone, Copy, Debug)]
pub struct AmbientOcclusion {
    /// Largest distance of an occluder; scene units.
    pub distance: f32,
}

/// `ao`.
pub const AO: MethodKind = MethodKind::new("ao", |asked| {
    let distance = asked.options.number("distance").map_or(f32::INFINITY, |d| d as f32);
    Ok(Arc::new(AmbientOcclusion { distance }))
});

impl Method for AmbientOcclusion {
    fn supports(&self, feature: Feature) -> Support {
        match feature {
            // Occlusion is of surfaces: media are not in it, nor is light.
            Feature::TransparencyBehindMedia | Feature::Polarization => Support::Exact,
            _ => support::of_camera_rays(feature),
        }
    }

    fn session(&self, scene: Arc<Scene>, plan: Plan) -> Result<Box<dyn Session>, Refusal> {
        Ok(Box::new(Tiles::per_pixel(local_scene(scene), *self, plan)))
    }
}

impl Integrator for AmbientOcclusion {
    type Prepared = ();

    fn radiance(&self, (): &(), mut ray: Ray, context: &mut PathContext<'_, '_>) -> Spectrum {
        let PathContext { scene, sampler, lambda, counters } = context;
        for _ in 0..MAX_PASSES {
            counters.rays += 1;
            let Some(hit) = scene.intersect(&ray) else { return Spectrum::ZERO };
            let i = scene.interaction(&ray, &hit);
            let u = sampler.get_1d_lazily(dimension::at(0, dimension::MIXTURE), scene.has_mixtures());
            let Some((_, frame)) = scene.scattering(&i, u, lambda) else {
                ray = i.rest(&ray);
                continue;
            };
            let up = if frame.z.dot(i.wo) < 0.0 { -frame.z } else { frame.z };
            let local = warp::cosine_hemisphere(sampler.get_2d(dimension::at(0, dimension::DIRECTION)));
            let w = Frame::from_z(up).to_world(local);
            counters.rays += 1;
            let is_open = !scene.occluded(&Ray { t_max: self.distance, ..i.spawn(w) });
            // In spectral mode white is the white of the colour space, not a flat spectrum.
            return role::under_white(Spectrum::splat(f32::from(is_open)), lambda, scene.mode());
        }
        Spectrum::ZERO
    }
}
