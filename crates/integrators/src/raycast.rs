//! Ray casting: the colour of the first surface, as if white light were everywhere the same.

use crate::{Integrator, MAX_PASSES, nee, support};
use std::sync::Arc;
use steradian_core::Scene;
use steradian_engine::{Feature, Method, MethodKind, PathContext, Plan, Refusal, Session, Support, Tiles, local_scene};
use steradian_math::{Ray, Spectrum, spectra::role};

/// The ray caster.
#[derive(Clone, Copy, Debug)]
pub struct Raycast {
    /// Makes lights invisible.
    pub hide_emitters: bool,
}

/// `raycast`.
pub const RAYCAST: MethodKind =
    MethodKind::new("raycast", |asked| Ok(Arc::new(Raycast { hide_emitters: asked.hides_emitters() })));

impl Method for Raycast {
    fn supports(&self, feature: Feature) -> Support {
        support::of_camera_rays(feature)
    }

    fn session(&self, scene: Arc<Scene>, plan: Plan) -> Result<Box<dyn Session>, Refusal> {
        Ok(Box::new(Tiles::per_pixel(local_scene(scene), *self, plan)))
    }
}

impl Integrator for Raycast {
    type Prepared = ();

    fn radiance(&self, (): &(), mut ray: Ray, context: &mut PathContext<'_, '_>) -> Spectrum {
        let PathContext { scene, lambda, counters, .. } = context;
        let mut differential = scene.ray_differential(&ray);
        for _ in 0..MAX_PASSES {
            if counters.stop.is_asked() {
                break;
            }
            counters.rays += 1;
            let Some(hit) = scene.intersect(&ray) else {
                if self.hide_emitters {
                    break;
                }
                return nee::behind(scene, &ray, 0, &None, lambda);
            };
            let i = scene.interaction_of_light(&ray, &hit);
            let passes_straight = self.hide_emitters && scene.is_passed_when_hidden(i.geometry);
            match scene.scattering_along(&i, differential.as_ref(), 0.5, lambda) {
                Some((s, frame)) if !passes_straight => {
                    let albedo = s.bsdf.albedo_estimate(frame.to_local(i.wo));
                    let color = role::under_white(albedo, lambda, scene.mode());
                    return if self.hide_emitters { color } else { color + nee::emission(scene, &i, &None, lambda) };
                }
                _ => {
                    ray = i.rest(&ray);
                    differential = differential.map(|d| d.advance(i.t));
                }
            }
        }
        Spectrum::ZERO
    }
}
