//! Vertices of paths: light straight from lights, and the way on.

use crate::{
    attenuation::{self, Shadow},
    nee, power_heuristic,
};
use steradian_bsdf::{Bsdf, BsdfEval, BsdfSample, Lobe, TransportMode};
use steradian_core::{
    Scene,
    light::{LightContext, LightSample},
    material::Scattering,
    medium::Medium,
    sampler::PixelSampler,
    scene::{Interaction, SHADOW_END},
};
use steradian_engine::{PathContext, dimension};
use steradian_math::{Frame, Ray, Spectrum, Vec2, Vec3};

/// Vertex of a path: a point that scatters. In place, since nothing is allocated per sample.
#[expect(
    clippy::large_enum_variant,
    reason = "values live on the stack of one step; a box would cost an allocation per vertex"
)]
#[derive(Clone, Copy, Debug)]
pub enum Vertex<'s> {
    /// On a surface.
    Surface {
        /// The point.
        i: Interaction,
        /// Scattering model.
        scattering: Scattering<'s>,
        /// The shading frame.
        frame: Frame,
        /// The medium that the path came through.
        medium: Option<u32>,
    },
    /// Within a medium.
    Medium {
        /// The point.
        p: Vec3,
        /// Back along the path.
        wo: Vec3,
        /// The moment of the exposure.
        time: f32,
        /// Medium, with its phase function.
        scattering: &'s Medium,
        /// Its index.
        medium: u32,
    },
}

impl Vertex<'_> {
    /// The point.
    #[inline]
    pub fn p(&self) -> Vec3 {
        match self {
            Self::Surface { i, .. } => i.surface.p,
            Self::Medium { p, .. } => *p,
        }
    }

    /// Unit direction back along the path.
    #[inline]
    pub fn wo(&self) -> Vec3 {
        match self {
            Self::Surface { i, .. } => i.wo,
            Self::Medium { wo, .. } => *wo,
        }
    }

    /// True if light samples find nothing here.
    #[inline]
    pub fn is_specular(&self) -> bool {
        matches!(self, Self::Surface { scattering, .. } if scattering.bsdf.is_specular())
    }

    /// True if part of the light goes through as if there were nothing.
    #[inline]
    pub(crate) fn passes_straight(&self) -> bool {
        match self {
            Self::Surface { i, scattering, frame, .. } => {
                scattering.bsdf.straight_transmission(frame.to_local(i.wo)).is_some()
            }
            Self::Medium { .. } => false,
        }
    }

    /// Reference point for light sampling.
    #[inline]
    pub fn context(&self) -> LightContext {
        match self {
            Self::Surface { i, scattering, frame, .. } => nee::context(i, frame, &scattering.bsdf),
            Self::Medium { p, .. } => LightContext { p: *p, n: Vec3::ZERO },
        }
    }

    /// A direction in world space from one in that of samples.
    #[inline]
    pub fn world(&self, w: Vec3) -> Vec3 {
        match self {
            Self::Surface { frame, .. } => frame.to_world(w),
            Self::Medium { .. } => w,
        }
    }

    /// A direction of samples from one in world space.
    #[inline]
    pub fn local(&self, w: Vec3) -> Vec3 {
        match self {
            Self::Surface { frame, .. } => frame.to_local(w),
            Self::Medium { .. } => w,
        }
    }

    /// True if a direction of samples leaves on the side of the viewer; in a medium, always.
    #[inline]
    pub fn is_reflection(&self, wi: Vec3) -> bool {
        match self {
            Self::Surface { i, frame, .. } => wi.z * frame.to_local(i.wo).z > 0.0,
            Self::Medium { .. } => true,
        }
    }

    /// A ray that leaves in a direction.
    #[inline]
    pub fn spawn(&self, direction: Vec3) -> Ray {
        match self {
            Self::Surface { i, .. } => i.spawn(direction),
            Self::Medium { p, time, .. } => Ray { time: *time, ..Ray::new(*p, direction) },
        }
    }

    /// A ray to a point at a distance in a unit direction, that ends just before it.
    #[inline]
    pub fn spawn_towards(&self, direction: Vec3, distance: f32) -> Ray {
        match self {
            Self::Surface { i, .. } => i.spawn_towards(direction, distance),
            Self::Medium { .. } => Ray { t_max: distance * SHADOW_END, ..self.spawn(direction) },
        }
    }

    /// The medium that a direction leads through.
    #[inline]
    pub fn medium_towards(&self, scene: &Scene, w: Vec3) -> Option<u32> {
        match self {
            Self::Surface { i, medium, .. } => scene.medium_towards(i, w, *medium),
            Self::Medium { medium, .. } => Some(*medium),
        }
    }

    /// `f |cos|` for a direction in world space, and the density with which it is drawn.
    #[inline]
    pub fn eval(&self, w: Vec3) -> BsdfEval {
        self.eval_towards(self.wo(), w)
    }

    /// `f |cos|` and its density for a viewer other than the path's, on its side.
    #[inline]
    pub fn eval_towards(&self, viewer: Vec3, w: Vec3) -> BsdfEval {
        match self {
            Self::Surface { scattering, frame, .. } => {
                scattering.eval(frame.to_local(viewer), frame.to_local(w), TransportMode::Radiance)
            }
            // A phase function is its own density: value and pdf are equal.
            Self::Medium { scattering, .. } => {
                let phase = scattering.phase(viewer, w);
                BsdfEval { value: Spectrum::splat(phase), pdf: phase }
            }
        }
    }

    /// True if light samples bring nothing.
    #[inline]
    pub fn is_unlit(&self) -> bool {
        match self {
            Self::Surface { scattering, .. } => {
                scattering.bsdf.is_specular()
                    || matches!(&scattering.bsdf, Bsdf::Diffuse(b) if b.reflectance.is_black())
            }
            Self::Medium { .. } => false,
        }
    }

    /// The half-size of the box that holds the point, and the geometric normal: rays leave beyond that box.
    #[inline]
    pub fn spread(&self) -> (Vec3, Vec3) {
        match self {
            Self::Surface { i, .. } => (i.surface.error, i.surface.n),
            Self::Medium { .. } => (Vec3::ZERO, Vec3::ZERO),
        }
    }

    /// Light of a light sample, scattered back along the path, if nothing stands between.
    #[inline]
    pub fn reflected(&self, s: &LightSample) -> Spectrum {
        match self {
            Self::Surface { i, scattering, frame, .. } => nee::unoccluded(s, frame.to_local(i.wo), frame, scattering),
            // phase · L w / p, as on surfaces but without a cosine.
            Self::Medium { wo, scattering, .. } => {
                let phase = scattering.phase(*wo, s.wi);
                let weight = if s.is_delta { 1.0 } else { power_heuristic(s.pdf, phase) };
                s.radiance * (phase * weight / s.pdf)
            }
        }
    }

    /// A direction drawn by what scatters here, with a number for the choice of a lobe and two for the direction.
    #[inline]
    pub fn draw(&self, u: f32, u2: Vec2) -> Option<BsdfSample> {
        match self {
            Self::Surface { i, scattering, frame, .. } => {
                scattering.sample(frame.to_local(i.wo), u, u2, TransportMode::Radiance)
            }
            // The phase function is sampled exactly: its weight is one.
            Self::Medium { wo, scattering, .. } => {
                let (wi, pdf) = scattering.sample_phase(*wo, u2);
                Some(BsdfSample { wi, weight: Spectrum::ONE, pdf, lobe: Lobe::GLOSSY, eta: 1.0 })
            }
        }
    }

    /// Light straight from a light, scattered back along the path, if nothing stands between: its value, unit direction
    /// and distance.
    #[inline]
    fn unoccluded(&self, event: u32, context: &PathContext<'_, '_>) -> Option<(Spectrum, Vec3, f32)> {
        let PathContext { scene, sampler, lambda, .. } = context;
        // Specular and black vertices reflect no light sample.
        if self.is_unlit() || !scene.lights().can_sample() {
            return None;
        }
        // One light and a point on it, then f |cosθ| L w / p; visibility comes later, if anything is left to hide.
        let s = nee::sample_light(scene, &self.context(), event, sampler, lambda)?;
        let light = self.reflected(&s);
        (!light.is_black()).then_some((light, s.wi, s.distance))
    }

    /// Attenuates light that comes from a distance in a direction by the medium on the way; where nothing is passed
    /// straight.
    #[inline]
    pub fn attenuated<const MEDIA: bool>(
        &self,
        light: Spectrum,
        (wi, distance): (Vec3, f32),
        event: u32,
        context: &PathContext<'_, '_>,
    ) -> Spectrum {
        // Without a medium in that direction all light arrives.
        let PathContext { scene, sampler, lambda, counters } = context;
        let (true, Some(m)) = (MEDIA, self.medium_towards(scene, wi)) else { return light };
        let number = shadow_number::<MEDIA>(sampler, event);
        light * attenuation::passed(m, (&self.spawn(wi), distance), number, (scene, lambda, &counters.stop))
    }

    /// Light straight from a light, scattered back along the path.
    #[inline]
    pub fn direct<const MEDIA: bool>(&self, event: u32, context: &mut PathContext<'_, '_>) -> Spectrum {
        self.direct_from::<MEDIA>(event, context).map_or(Spectrum::ZERO, |(light, ..)| light)
    }

    /// As [`Vertex::direct`], with the unit direction that it comes from, and the distance.
    #[inline]
    pub(crate) fn direct_from<const MEDIA: bool>(
        &self,
        event: u32,
        context: &mut PathContext<'_, '_>,
    ) -> Option<(Spectrum, Vec3, f32)> {
        // The unoccluded value first, since black ones need no shadow ray.
        let (light, wi, distance) = self.unoccluded(event, context)?;
        let number = shadow_number::<MEDIA>(context.sampler, event);
        Some((self.transmitted::<MEDIA>(light, (wi, distance), number, context), wi, distance))
    }

    /// Light from a distance in a direction that arrives here: by visibility, and through media by transmittance.
    #[inline]
    pub fn transmitted<const MEDIA: bool>(
        &self,
        light: Spectrum,
        (wi, distance): (Vec3, f32),
        number: f32,
        context: &mut PathContext<'_, '_>,
    ) -> Spectrum {
        // The shadow ray ends just before the light's point.
        let ray = self.spawn_towards(wi, distance);
        // With media: visibility and transmittance, past interfaces and thin panes.
        if MEDIA {
            let medium = self.medium_towards(context.scene, wi);
            return light * attenuation::towards(ray, distance, (medium, number), &mut Shadow::of(context));
        }
        // Without: a plain shadow ray.
        context.counters.rays += 1;
        if context.scene.occluded(&ray) { Spectrum::ZERO } else { light }
    }

    /// As [`Vertex::direct`], with the ray that is not to meet anything; where nothing is passed straight.
    #[inline]
    pub fn direct_along<const MEDIA: bool>(
        &self,
        event: u32,
        context: &PathContext<'_, '_>,
    ) -> Option<(Spectrum, Ray)> {
        let (light, wi, distance) = self.unoccluded(event, context)?;
        let light = self.attenuated::<MEDIA>(light, (wi, distance), event, context);
        Some((light, self.spawn_towards(wi, distance)))
    }
}

/// A random number for the way of a shadow ray through media that vary.
#[inline]
fn shadow_number<const MEDIA: bool>(sampler: &PixelSampler, event: u32) -> f32 {
    if MEDIA { sampler.get_1d(dimension::at(event, dimension::FLIGHT)) } else { 0.0 }
}
