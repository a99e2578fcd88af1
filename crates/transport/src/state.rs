//! A path between two points that scatter.

use crate::{
    Depth,
    guide::{Guide, GuidedDirection},
    live_max, nee,
    roulette::{IN_MEDIUM, number, roulette},
    sink::{Segment, Sink},
    vertex::Vertex,
    volume_emission,
};
use steradian_bsdf::{Bsdf, BsdfSample};
use steradian_core::{
    Scene,
    footprint::{Bounce, RayDifferential},
    sampler::PixelSampler,
    scene::Interaction,
};
use steradian_engine::{PathContext, dimension};
use steradian_math::{Ray, Spectrum, Vec3};

/// A path that sets out along a ray.
#[derive(Clone, Copy, Debug)]
pub struct PathState {
    /// Next ray.
    pub ray: Ray,
    /// Path throughput β = ∏ f·cosθ/pdf.
    pub beta: Spectrum,
    /// The throughput counts for this many times as much in roulette: without the compression of radiance by
    /// refraction, and as if surfaces alone had drawn the directions. A path that photons lead to light carries little
    /// because it is one of many, not because light was lost.
    pub roulette_scale: f32,
    /// Last scattering event.
    pub origin: nee::Origin,
    /// Scattering events so far.
    pub events: u32,
    /// Surfaces passed straight.
    pub passes: u32,
    /// The medium that it goes through.
    pub medium: Option<u32>,
    /// Ray differential for textures' footprints, up to the first event that blurs; from there on these are those of
    /// the camera seeing the point.
    pub differential: Option<RayDifferential>,
    /// True if the last event was in a medium.
    pub is_from_medium: bool,
    /// Light samples to take where it arrives.
    pub lights: u32,
    /// The throughput below which roulette is played, where this was found to pay from the first event on.
    pub roulette_below: Option<f32>,
}

/// Between the dimensions of one light sample of an event and of the next.
const LIGHT_EVENTS: u32 = 2000;

impl PathState {
    /// One that leads nowhere.
    pub const NONE: Self = Self {
        ray: Ray { t_max: 0.0, ..Ray::new(Vec3::ZERO, Vec3::Z) },
        beta: Spectrum::ONE,
        roulette_scale: 1.0,
        origin: None,
        events: 0,
        passes: 0,
        medium: None,
        differential: None,
        is_from_medium: false,
        lights: 1,
        roulette_below: None,
    };

    /// From the camera.
    #[inline]
    pub fn camera(scene: &Scene, ray: Ray) -> Self {
        let mut state = Self::NONE;
        state.start(scene, ray);
        state
    }

    /// As [`PathState::camera`], written over one that leads nowhere.
    #[inline]
    pub fn start(&mut self, scene: &Scene, ray: Ray) {
        self.ray = ray;
        self.medium = scene.camera().medium;
        // Large, and not written where there is none.
        if let Some(differential) = scene.ray_differential(&ray) {
            self.differential = Some(differential);
        }
    }

    /// The event by whose dimensions the `k`th of the light samples is drawn, where it arrived.
    #[inline]
    pub fn event_of_light(&self, k: u32) -> u32 {
        self.events + k * LIGHT_EVENTS
    }

    /// Light straight from lights, scattered back along the path from the vertex where it arrived.
    #[inline]
    pub fn direct<const MEDIA: bool>(&self, v: &Vertex<'_>, context: &mut PathContext<'_, '_>) -> Spectrum {
        // Light samples of surfaces and environments, and one of an emissive medium where there are any.
        let of_lights = self.of_lights::<MEDIA>(v, context);
        if MEDIA && !context.scene.emissive_volumes().is_empty() {
            let of_media = self.beta * volume_emission::direct(v, self.events, context);
            context.counters.note(self.events + 1, || None, of_media);
            return of_lights + of_media;
        }
        of_lights
    }

    #[inline]
    fn of_lights<const MEDIA: bool>(&self, v: &Vertex<'_>, context: &mut PathContext<'_, '_>) -> Spectrum {
        let first = v.direct::<MEDIA>(self.event_of_light(0), context);
        // One sample: its light is noted by its number of events, or by the group of the light, which the same random
        // numbers choose again.
        if self.lights == 1 {
            let light = self.beta * first;
            let PathContext { scene, sampler, counters, .. } = context;
            let chosen = || nee::choose(scene, &v.context(), self.event_of_light(0), sampler);
            counters.note(
                self.events + 1,
                || chosen().map(|(light, _)| scene.light_groups().of_lights[light as usize]),
                light,
            );
            return light;
        }
        // Several samples of the same vertex: their mean.
        let mut sample = |k| v.direct::<MEDIA>(self.event_of_light(k), context);
        self.beta * (1..self.lights).fold(first, |sum, k| sum + sample(k)) / self.lights as f32
    }

    /// The segment that it is on.
    #[inline(always)]
    pub fn segment(&self) -> Segment {
        Segment { ray: self.ray, beta: self.beta, events: self.events }
    }

    /// Adds light straight from lights, as [`PathState::direct`] has it, to `sink`.
    #[inline]
    pub fn add_direct<const MEDIA: bool>(
        &self,
        v: &Vertex<'_>,
        sink: &mut impl Sink,
        context: &mut PathContext<'_, '_>,
    ) {
        // Sinks without clocks take the sum of all light samples.
        if !sink.is_timed() {
            sink.add(self.direct::<MEDIA>(v, context));
            return;
        }
        // Timed sinks take the light with its direction and distance.
        if let Some((light, wi, distance)) = v.direct_from::<MEDIA>(self.event_of_light(0), context) {
            sink.add_direct(self.beta * light, v, wi, distance);
        }
        if MEDIA {
            sink.add(self.beta * volume_emission::direct(v, self.events, context));
        }
    }

    /// Russian roulette: whether the path goes on, with a throughput that makes up for those that do not.
    #[inline]
    pub fn survives(&mut self, depth: &Depth, context: &PathContext<'_, '_>) -> bool {
        // Throughput of the strongest lane, without refraction's 1/η² and without the guide's share of the density.
        let live = live_max(self.beta, context.lambda) * self.roulette_scale;
        let live = if self.is_from_medium { live * IN_MEDIUM } else { live };
        let number = || number(self.events, context.sampler);
        // β/q for survivors, zero for paths that end.
        let scale = roulette(live, self.events, depth, self.roulette_below, number);
        self.beta *= scale.unwrap_or(0.0);
        scale.is_some()
    }

    /// A direction drawn at the vertex where it arrived, by scattering, and by a guide if there is one.
    #[inline]
    pub fn sample(
        &self,
        v: &Vertex<'_>,
        sampler: &PixelSampler,
        guide: Option<&impl Guide>,
    ) -> Option<GuidedDirection> {
        let u2 = sampler.get_2d(dimension::at(self.events, dimension::DIRECTION));
        // Where the guide knows something the direction comes from the mixture of both densities.
        if let Some(directions) = guide.and_then(|guide| guide.at(v, self.events)) {
            let u = sampler.get_1d(self.dimension(dimension::LOBE));
            return GuidedDirection::by_mixture(v, &directions, u, u2);
        }
        // In a medium the phase function draws the direction; it has no lobes to choose from.
        let Vertex::Surface { scattering, .. } = v else {
            return v.draw(0.5, u2).map(GuidedDirection::by_surface);
        };
        // The number that chooses a lobe is drawn only where somebody asks for it.
        let has_one_lobe = matches!(scattering.bsdf, Bsdf::Diffuse(_) | Bsdf::Conductor(_));
        let u = sampler.get_1d_lazily(self.dimension(dimension::LOBE), !has_one_lobe);
        v.draw(u, u2).map(GuidedDirection::by_surface)
    }

    /// On from a vertex in the direction that was drawn there.
    #[inline]
    pub fn turn<const MEDIA: bool>(
        &mut self,
        scene: &Scene,
        v: &Vertex<'_>,
        GuidedDirection { sample: s, ratio }: &GuidedDirection,
    ) {
        // β ← β f |cosθ| / p.
        self.beta *= s.weight;
        // Roulette looks at β without the compression of radiance by refraction, 1/η², and as if scattering alone had
        // drawn the direction.
        self.roulette_scale *= s.eta * s.eta / ratio;
        if MEDIA
            && let Vertex::Surface { i, .. } = v
            && s.lobe.is_transmission()
            && v.passes_straight()
        {
            // Light that goes straight on has not scattered: next-event estimation sees through such surfaces too.
            self.pass::<MEDIA>(scene, i);
            return;
        }
        self.leave::<MEDIA>(scene, v, s, v.spawn(v.world(s.wi)));
    }

    /// On from a vertex by a ray in the direction that was drawn there; not straight on. What it carries is left as it
    /// is.
    #[inline]
    pub fn leave<const MEDIA: bool>(&mut self, scene: &Scene, v: &Vertex<'_>, s: &BsdfSample, ray: Ray) {
        // For the MIS weight of the next emission: the reference point and density of this event. Specular directions
        // have no competing light sample.
        self.origin = if s.lobe.is_specular() { None } else { Some((v.context(), s.pdf)) };
        // The medium on the side into which the ray leaves.
        if MEDIA {
            self.medium = v.medium_towards(scene, ray.direction);
            self.is_from_medium = matches!(v, Vertex::Medium { .. });
        }
        self.ray = ray;
        // One more scattering event; the next vertex takes one light sample.
        self.events += 1;
        self.lights = 1;
        // The ray differential follows the bounce, where the lobe is narrow enough for one.
        self.differential = match (&self.differential, v, Bounce::of(s)) {
            (Some(d), Vertex::Surface { i, .. }, Some(bounce)) => {
                scene.scatter_differential(i, d, ray.direction, bounce)
            }
            _ => None,
        };
    }

    /// Straight on from a surface.
    #[inline]
    pub(crate) fn pass<const MEDIA: bool>(&mut self, scene: &Scene, i: &Interaction) {
        // The count separates the random numbers before and after the surface.
        self.passes += 1;
        if MEDIA {
            self.medium = scene.medium_towards(i, self.ray.direction, self.medium);
        }
        // The rest of the same ray, behind the surface; its differential travels along.
        self.ray = i.rest(&self.ray);
        self.differential = self.differential.map(|d| d.advance(i.t));
    }

    /// The dimension of a decision of the next event. Numbers are drawn anew after each surface that was passed on the
    /// way to it.
    #[inline]
    pub fn dimension(&self, decision: u32) -> u32 {
        dimension::at(self.events, decision) ^ (self.passes << 16)
    }
}
