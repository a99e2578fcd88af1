//! Path tracing of polarised light: one component of the Stokes vector that reaches the camera.
//!
//! As `path`, but the throughput is a Mueller matrix: what lies between the camera and the current vertex acts on
//! Stokes vectors from right to left. Lights are unpolarised. The vector at the camera refers to the horizontal of the
//! picture: S₁ is positive for light that swings from left to right. In scenes that nothing polarises twice, S₀ is the
//! picture of `path`.

use crate::{Depth, Integrator, dimension, live_max, nee, support};
use std::sync::Arc;
use steradian_bsdf::{TransportMode, polarized};
use steradian_core::Scene;
use steradian_engine::{
    Asked, CameraPaths, Feature, Method, MethodKind, PathContext, Plan, Refusal, Session, Support, Tiles,
};
use steradian_math::{
    Ray, Spectrum,
    polarization::{Mueller, Stokes as Vector, basis},
};
use steradian_transport::roulette::{number, roulette};

/// The path tracer of polarised light.
#[derive(Clone, Copy, Debug)]
pub struct Stokes {
    /// Path depth.
    pub depth: Depth,
    /// Stokes component that is the picture, 0 to 3.
    pub component: usize,
}

/// `stokes`, `stokes-s1`, `stokes-s2`, `stokes-s3`.
pub const STOKES: [MethodKind; 4] = [
    MethodKind::new("stokes", |asked| component(asked, 0)),
    MethodKind::new("stokes-s1", |asked| component(asked, 1)),
    MethodKind::new("stokes-s2", |asked| component(asked, 2)),
    MethodKind::new("stokes-s3", |asked| component(asked, 3)),
];

fn component(asked: &Asked<'_>, component: usize) -> Result<Arc<dyn Method>, Refusal> {
    Ok(Arc::new(Stokes { depth: asked.depth(), component }))
}

impl Method for Stokes {
    fn supports(&self, feature: Feature) -> Support {
        match feature {
            Feature::Polarization => Support::Exact,
            Feature::Media => Support::LeavesOut(""),
            Feature::Denoising => Support::Refuses("Stokes parameters are no radiance"),
            _ => support::of_local_scattering(feature),
        }
    }

    fn session(&self, scene: Arc<Scene>, plan: Plan) -> Result<Box<dyn Session>, Refusal> {
        Ok(Box::new(Tiles::per_pixel(scene, *self, plan)))
    }

    fn camera_paths(&self) -> Option<CameraPaths> {
        Some(CameraPaths { depth: self.depth, media: false, is_plain: false })
    }
}

impl Integrator for Stokes {
    type Prepared = ();

    fn radiance(&self, (): &(), ray: Ray, context: &mut PathContext<'_, '_>) -> Spectrum {
        // Light travels against the ray; its horizontal is across the camera's view and up.
        let k = -ray.direction;
        let horizontal = context.scene.camera().right();
        let across = (horizontal - k * k.dot(horizontal)).try_normalize().unwrap_or_else(|| basis(k));
        let to_picture = Mueller::change_basis(k, basis(k), across);
        (to_picture * self.vector(ray, context)).0[self.component]
    }
}

impl Stokes {
    /// The Stokes vector that arrives against a ray, in the frame of its direction.
    fn vector(&self, mut ray: Ray, context: &mut PathContext<'_, '_>) -> Vector {
        let PathContext { scene, sampler, lambda, counters } = context;
        let mut sum = Vector::ZERO;
        let mut chain = Mueller::IDENTITY;
        let mut eta2 = 1.0_f32;
        let mut origin: nee::Origin = None;
        let (mut events, mut passes) = (0, 0);
        loop {
            if counters.stop.is_asked() {
                return sum;
            }
            counters.rays += 1;
            let hidden = events == 0 && self.depth.hide_emitters;
            let Some(hit) = scene.intersect(&ray) else {
                if !hidden {
                    let sky = nee::behind(scene, &ray, events, &origin, lambda);
                    sum = sum + chain.of_unpolarized(sky);
                }
                return sum;
            };
            let i = scene.interaction_of_light(&ray, &hit);
            if !hidden {
                sum = sum + chain.of_unpolarized(nee::emission(scene, &i, &origin, lambda));
            }
            let passes_straight = self.depth.hides(scene, i.geometry, events);
            if events >= self.depth.max && !passes_straight {
                return sum;
            }
            let choice = sampler.get_1d_lazily(dimension::at(events, dimension::MIXTURE), scene.has_mixtures());
            let surface = if passes_straight { None } else { scene.scattering(&i, choice, lambda) };
            let Some((scattering, frame)) = surface else {
                passes += 1;
                if passes > crate::MAX_PASSES {
                    return sum;
                }
                ray = i.rest(&ray);
                continue;
            };
            let bsdf = &scattering.bsdf;
            let wo = frame.to_local(i.wo);
            if !bsdf.is_specular() && scene.lights().can_sample() {
                let ctx = nee::context(&i, &frame, bsdf);
                if let Some(s) = nee::sample_light(scene, &ctx, events, sampler, lambda) {
                    let light = nee::unoccluded(&s, wo, &frame, &scattering);
                    if !light.is_black() {
                        counters.rays += 1;
                        if !scene.occluded(&i.spawn_towards(s.wi, s.distance)) {
                            let here = polarized::relative(bsdf, &frame, wo, frame.to_local(s.wi));
                            sum = sum + (chain * here).of_unpolarized(light);
                        }
                    }
                }
            }
            let u = sampler.get_1d(dimension::at(events, dimension::LOBE));
            let u2 = sampler.get_2d(dimension::at(events, dimension::DIRECTION));
            let Some(s) = scattering.sample(wo, u, u2, TransportMode::Radiance) else { return sum };
            chain = chain * polarized::relative(bsdf, &frame, wo, s.wi).scaled(s.weight);
            let beta = chain.0[0][0];
            if !beta.is_finite() {
                return Vector::unpolarized(beta);
            }
            eta2 *= s.eta * s.eta;
            origin = if s.lobe.is_specular() { None } else { Some((nee::context(&i, &frame, bsdf), s.pdf)) };
            ray = i.spawn(frame.to_world(s.wi));
            events += 1;
            // A chain may send on polarised light that it holds back from unpolarised: roulette looks at its largest
            // row sum.
            let strongest = chain.0[0].iter().fold(Spectrum::ZERO, |m, v| m + v.map(f32::abs));
            let live = live_max(strongest, lambda) * eta2;
            match roulette(live, events, &self.depth, None, || number(events, sampler)) {
                Some(scale) => chain = chain.scaled(Spectrum::splat(scale)),
                None => return sum,
            }
        }
    }
}
