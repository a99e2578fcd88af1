//! Receivers of light: what arrives at a point from a direction, on a plane, or from all sides.

use crate::{Depth, dimension, nee, path::PathTracer};
use std::f32::consts::PI;
use steradian_core::{
    light::{LightContext, LightSample},
    scene::SHADOW_END,
};
use steradian_engine::PathContext;
use steradian_math::{Frame, Ray, Spectrum, Vec2, Vec3, warp};
use steradian_transport::{
    NoGuide, PathState,
    attenuation::{self, Shadow},
    power_heuristic, volume_emission,
};

/// Receiver of a light meter. Its medium is that of the camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Receiver {
    /// Radiance that arrives at a point along a ray, from a unit direction.
    Radiance(Vec3, Vec3),
    /// Irradiance of a small plane at a point, on the side of a unit normal: `∫ L cosθ dω`.
    Plane(Vec3, Vec3),
    /// Scalar irradiance (fluence rate) at a point: `∫ L dω` over all directions.
    Sphere(Vec3),
    /// Flux that arrives on a disc about a point, on the side of a unit normal, by its radius.
    Disc(Vec3, Vec3, f32),
    /// Flux that leaves a ball about a point, by its radius: of a lamp within, all that it gives.
    Ball(Vec3, f32),
}

impl Receiver {
    /// The area that light is received on; `None` for a point.
    pub(crate) fn area(&self) -> Option<f32> {
        match self {
            Self::Disc(_, _, r) => Some(PI * r * r),
            Self::Ball(_, r) => Some(4.0 * PI * r * r),
            _ => None,
        }
    }

    /// A receiver at a point of the area, evenly drawn; one of a point is that.
    fn at(&self, u: Vec2) -> Self {
        match *self {
            Self::Disc(p, n, r) => {
                let place = warp::concentric_disk(u) * r;
                Self::Plane(p + Frame::from_z(n).to_world(place.extend(0.0)), n)
            }
            Self::Ball(p, r) => {
                let w = warp::uniform_sphere(u);
                Self::Plane(p + w * r, -w)
            }
            point => point,
        }
    }

    /// Weight of the radiance from a direction.
    fn weight(&self, w: Vec3) -> f32 {
        match self {
            Self::Plane(_, n) => n.dot(w).max(0.0),
            _ => 1.0,
        }
    }

    /// The integral of the weight over all directions, in proportion to which they are drawn.
    fn total(&self) -> f32 {
        if matches!(self, Self::Plane(..)) { PI } else { 4.0 * PI }
    }
}

/// The radius, in radians, of the cone of directions of which a meter takes the radiance of one direction.
const ACCEPTANCE: f32 = 1e-6;

impl<const MEDIA: bool> PathTracer<MEDIA> {
    /// One sample of what a receiver takes: of directions by a light sample and a direction in proportion to the
    /// weight, combined by the power heuristic.
    pub(crate) fn received(&self, receiver: &Receiver, context: &mut PathContext<'_, '_>) -> Spectrum {
        match receiver.area() {
            Some(area) => {
                let place = receiver.at(context.sampler.get_2d(dimension::FILM));
                self.received_at(&place, context) * area
            }
            None => self.received_at(receiver, context),
        }
    }

    fn received_at(&self, receiver: &Receiver, context: &mut PathContext<'_, '_>) -> Spectrum {
        let time = context.lambda.time;
        let (p, n) = match *receiver {
            Receiver::Radiance(p, w) => {
                // Opacity is decided by a hash of the ray: directions differ a little, so that a meter sees its mean.
                let aside = warp::concentric_disk(context.sampler.get_2d(dimension::FILM)) * ACCEPTANCE;
                let w = Frame::from_z(w).to_world(aside.extend(1.0)).normalize();
                let ray = Ray { time, ..Ray::new(p, w) };
                return self.along(PathState::camera(context.scene, ray), None::<&NoGuide>, context, Spectrum::ZERO);
            }
            Receiver::Plane(p, n) => (p, n),
            Receiver::Sphere(p) | Receiver::Disc(p, ..) | Receiver::Ball(p, _) => (p, Vec3::ZERO),
        };
        let at = LightContext { p, n };
        let sampled = match context.scene.lights().can_sample() {
            true => nee::sample_light(context.scene, &at, 0, context.sampler, context.lambda),
            false => None,
        };
        let direct = sampled.map_or(Spectrum::ZERO, |s| self.of_light(receiver, p, &s, context));
        let direct = direct + self.of_volume(receiver, p, context);
        let u = context.sampler.get_2d(dimension::at(0, dimension::DIRECTION));
        let w = match receiver {
            Receiver::Plane(..) => Frame::from_z(n).to_world(warp::cosine_hemisphere(u)),
            _ => warp::uniform_sphere(u),
        };
        let total = receiver.total();
        let mut path_state = PathState::NONE;
        path_state.ray = Ray { time, ..Ray::new(p, w) };
        path_state.medium = context.scene.camera().medium;
        path_state.origin = Some((at, receiver.weight(w) / total));
        path_state.events = 1;
        // Receiving is the first event, which is not among those of the scene.
        let Depth { max, roulette_after, .. } = self.depth;
        let one_more =
            Depth { max: max.saturating_add(1), roulette_after: roulette_after.saturating_add(1), ..self.depth };
        direct + Self { depth: one_more }.along(path_state, None::<&NoGuide>, context, Spectrum::ZERO) * total
    }

    /// Light of an emissive medium.
    fn of_volume(&self, receiver: &Receiver, p: Vec3, context: &mut PathContext<'_, '_>) -> Spectrum {
        if !MEDIA || context.scene.emissive_volumes().is_empty() {
            return Spectrum::ZERO;
        }
        let (time, medium) = (context.lambda.time, context.scene.camera().medium);
        let leave = |w: Vec3| (Ray { time, ..Ray::new(p, w) }, medium);
        volume_emission::arriving(p, 0, leave, context).map_or(Spectrum::ZERO, |s| {
            let weight = receiver.weight(s.wi);
            s.radiance * (weight * power_heuristic(s.pdf, weight / receiver.total()) / s.pdf)
        })
    }

    /// Light of a light sample.
    fn of_light(&self, receiver: &Receiver, p: Vec3, s: &LightSample, context: &mut PathContext<'_, '_>) -> Spectrum {
        let weight = receiver.weight(s.wi);
        let mis = if s.is_delta { 1.0 } else { power_heuristic(s.pdf, weight / receiver.total()) };
        let light = s.radiance * (weight * mis / s.pdf);
        if light.is_black() {
            return light;
        }
        let ray = Ray { t_max: s.distance * SHADOW_END, time: context.lambda.time, ..Ray::new(p, s.wi) };
        if MEDIA {
            let number = context.sampler.get_1d(dimension::at(0, dimension::FLIGHT));
            let medium = context.scene.camera().medium;
            return light * attenuation::towards(ray, s.distance, (medium, number), &mut Shadow::of(context));
        }
        context.counters.rays += 1;
        if context.scene.occluded(&ray) { Spectrum::ZERO } else { light }
    }
}
