//! The steps of which path tracers are made: along a ray to the next point that scatters, and on from there. `MEDIA`
//! says whether light is scattered between surfaces, and seen through thin panes; without, media are ignored.

use crate::{
    Counters, Depth, MAX_PASSES, Precomputed, Stop,
    caustics::GuidedDirection,
    dimension,
    flight::{self, Flight},
    live_max, nee, power_heuristic, tracking,
};
use steradian_core::{
    Scene,
    bsdf::{Bsdf, BsdfEval, BsdfSample, Lobe, TransportMode},
    footprint::{Bounce, RayDifferential},
    light::LightContext,
    material::Scattering,
    medium::Medium,
    sampler::PixelSampler,
    scene::{Hit, Interaction, SHADOW_END},
};
use steradian_math::{Frame, Ray, Spectrum, Vec3, spectra::Wavelengths};

/// Roulette is played below this throughput only: stopping paths that carry much costs more in variance than it saves.
const ROULETTE_BELOW: f32 = 1.0 / 3.0;

/// After this many events roulette is played whatever the throughput, with the survival at most the second number:
/// between surfaces that absorb nothing, and in dense media, paths would never end.
pub(crate) const LONG_PATH: (u32, f32) = (1000, 0.99);

/// Russian roulette after `events` scattering events: what a path that carries `live`, in the eyes of roulette
/// ([`PathState::for_roulette`]), goes on with times as much, or `None` where it ends.
#[inline]
pub(crate) fn roulette(
    live: f32,
    events: u32,
    depth: &Depth,
    below: Option<f32>,
    sampler: &PixelSampler,
) -> Option<f32> {
    if live <= 0.0 {
        return None;
    }
    let mut survival = live / below.unwrap_or(ROULETTE_BELOW);
    if events > LONG_PATH.0 {
        survival = survival.min(LONG_PATH.1);
    }
    if survival >= 1.0 || (below.is_none() && events <= depth.roulette_after) {
        return Some(1.0);
    }
    (sampler.get_1d(dimension::at(events, dimension::ROULETTE)) < survival).then(|| 1.0 / survival)
}

/// A path that sets out along a ray.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PathState {
    /// Where it goes.
    pub ray: Ray,
    /// What it carries.
    pub beta: Spectrum,
    /// The throughput counts for this many times as much in roulette: without the compression of radiance by
    /// refraction, and as if surfaces alone had drawn the directions. A path that photons lead to light carries little
    /// because it is one of many, not because light was lost.
    pub for_roulette: f32,
    /// Where it last scattered.
    pub origin: nee::Origin,
    /// How often it scattered.
    pub events: u32,
    /// How many surfaces it passed straight.
    pub passes: u32,
    /// The medium that it goes through.
    pub medium: Option<u32>,
    /// What makes textures' footprints, up to the first event that blurs; from there on they are those of the camera
    /// seeing the point.
    pub differential: Option<RayDifferential>,
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
        beta: Spectrum::ZERO,
        for_roulette: 1.0,
        origin: None,
        events: 0,
        passes: 0,
        medium: None,
        differential: None,
        lights: 1,
        roulette_below: None,
    };

    /// From the camera.
    #[inline]
    pub fn camera(scene: &Scene, ray: Ray) -> Self {
        Self {
            ray,
            beta: Spectrum::ONE,
            for_roulette: 1.0,
            origin: None,
            events: 0,
            passes: 0,
            medium: scene.camera.medium,
            differential: scene.ray_differential(&ray),
            lights: 1,
            roulette_below: None,
        }
    }

    /// The event by whose dimensions the `k`th of the light samples is drawn, where it arrived.
    #[inline]
    pub fn event_of_light(&self, k: u32) -> u32 {
        self.events + k * LIGHT_EVENTS
    }

    /// Light straight from lights, scattered back along the path from the vertex where it arrived.
    #[inline]
    pub fn direct<const MEDIA: bool>(
        &self,
        v: &Vertex<'_>,
        scene: &Scene,
        sampler: &PixelSampler,
        lambda: &Wavelengths,
        counters: &mut Counters,
    ) -> Spectrum {
        let mut sample = |k| v.direct::<MEDIA>(scene, self.event_of_light(k), sampler, lambda, counters);
        let first = sample(0);
        if self.lights == 1 {
            let light = self.beta * first;
            let event = self.event_of_light(0);
            let chosen = || nee::choose(scene, &v.context(), event, sampler);
            counters.note(|| chosen().map(|(light, _)| scene.light_groups.of_lights[light as usize]), light);
            return light;
        }
        self.beta * (1..self.lights).fold(first, |sum, k| sum + sample(k)) / self.lights as f32
    }

    /// Russian roulette: whether the path goes on, with a throughput that makes up for those that do not.
    #[inline]
    pub fn survives(&mut self, depth: &Depth, sampler: &PixelSampler, lambda: &Wavelengths) -> bool {
        let live = live_max(self.beta, lambda) * self.for_roulette;
        let scale = roulette(live, self.events, depth, self.roulette_below, sampler);
        self.beta *= scale.unwrap_or(0.0);
        scale.is_some()
    }

    /// On from a vertex in the direction that was drawn there.
    #[inline]
    pub fn turn<const MEDIA: bool>(
        &mut self,
        scene: &Scene,
        v: &Vertex<'_>,
        GuidedDirection { sample: s, ratio }: &GuidedDirection,
    ) {
        self.beta *= s.weight;
        self.for_roulette *= s.eta * s.eta / ratio;
        if MEDIA && s.lobe.is_transmission() && v.passes_straight() {
            // Light that goes straight on has not scattered: next-event estimation sees through such surfaces too.
            self.pass::<MEDIA>(scene, v);
            return;
        }
        self.origin = if s.lobe.is_specular() { None } else { Some((v.context(), s.pdf)) };
        let direction = v.world(s.wi);
        if MEDIA {
            self.medium = v.medium_towards(scene, direction);
        }
        self.ray = v.spawn(direction);
        self.events += 1;
        self.lights = 1;
        self.differential = match (&self.differential, v, Bounce::of(s)) {
            (Some(d), Vertex::Surface { i, .. }, Some(bounce)) => scene.scatter_differential(i, d, direction, bounce),
            _ => None,
        };
    }

    /// Straight on.
    #[inline]
    fn pass<const MEDIA: bool>(&mut self, scene: &Scene, v: &Vertex<'_>) {
        self.passes += 1;
        if MEDIA {
            self.medium = v.medium_towards(scene, self.ray.direction);
        }
        self.ray = v.spawn(self.ray.direction);
        if let Vertex::Surface { i, .. } = v {
            self.differential = self.differential.map(|d| d.advance(i.t));
        }
    }

    /// The dimension of a decision of the next event. Numbers are drawn anew after each surface that was passed on the
    /// way to it.
    #[inline]
    pub fn dimension(&self, decision: u32) -> u32 {
        dimension::at(self.events, decision) ^ (self.passes << 16)
    }
}

/// Where a path scatters. In place, since nothing is allocated per sample.
#[allow(clippy::large_enum_variant)]
#[derive(Clone, Copy, Debug)]
pub(crate) enum Vertex<'s> {
    /// On a surface.
    Surface {
        /// The point.
        i: Interaction,
        /// How it scatters.
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
        /// How it scatters.
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

    /// Whether light samples find nothing here.
    #[inline]
    pub fn is_specular(&self) -> bool {
        matches!(self, Self::Surface { scattering, .. } if scattering.bsdf.is_specular())
    }

    /// Whether part of the light goes through as if there were nothing.
    #[inline]
    fn passes_straight(&self) -> bool {
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

    /// The same towards another viewer than the path's, on its side.
    #[inline]
    pub fn eval_towards(&self, viewer: Vec3, w: Vec3) -> BsdfEval {
        match self {
            Self::Surface { scattering, frame, .. } => {
                scattering.eval(frame.to_local(viewer), frame.to_local(w), TransportMode::Radiance)
            }
            Self::Medium { scattering, .. } => {
                let phase = scattering.phase(viewer, w);
                BsdfEval { value: Spectrum::splat(phase), pdf: phase }
            }
        }
    }

    /// Light straight from a light, scattered back along the path, if nothing stands between: its value, unit direction
    /// and distance.
    #[inline]
    fn unoccluded(
        &self,
        scene: &Scene,
        event: u32,
        sampler: &PixelSampler,
        lambda: &Wavelengths,
    ) -> Option<(Spectrum, Vec3, f32)> {
        if self.is_specular() || !scene.lights.can_sample() {
            return None;
        }
        let s = nee::sample_light(scene, &self.context(), event, sampler, lambda)?;
        let light = match self {
            Self::Surface { i, scattering, frame, .. } => nee::unoccluded(&s, frame.to_local(i.wo), frame, scattering),
            Self::Medium { wo, scattering, .. } => {
                let phase = scattering.phase(*wo, s.wi);
                let weight = if s.is_delta { 1.0 } else { power_heuristic(s.pdf, phase) };
                s.radiance * (phase * weight / s.pdf)
            }
        };
        (!light.is_black()).then_some((light, s.wi, s.distance))
    }

    /// Light straight from a light, scattered back along the path.
    #[inline]
    pub fn direct<const MEDIA: bool>(
        &self,
        scene: &Scene,
        event: u32,
        sampler: &PixelSampler,
        lambda: &Wavelengths,
        counters: &mut Counters,
    ) -> Spectrum {
        let Some((light, wi, distance)) = self.unoccluded(scene, event, sampler, lambda) else { return Spectrum::ZERO };
        let number = shadow_number::<MEDIA>(sampler, event);
        self.transmitted::<MEDIA>(scene, light, (wi, distance), number, lambda, counters)
    }

    /// What arrives here of light that comes from a distance in a direction.
    #[inline]
    pub fn transmitted<const MEDIA: bool>(
        &self,
        scene: &Scene,
        light: Spectrum,
        (wi, distance): (Vec3, f32),
        number: f32,
        lambda: &Wavelengths,
        counters: &mut Counters,
    ) -> Spectrum {
        if MEDIA {
            let medium = self.medium_towards(scene, wi);
            return light
                * flight::towards(
                    scene,
                    self.spawn_towards(wi, distance),
                    distance,
                    (medium, number),
                    lambda,
                    counters,
                );
        }
        counters.rays += 1;
        if scene.occluded(&self.spawn_towards(wi, distance)) { Spectrum::ZERO } else { light }
    }

    /// As [`Vertex::direct`], with the ray that is not to meet anything; where nothing is passed straight.
    #[inline]
    pub fn direct_along<const MEDIA: bool>(
        &self,
        scene: &Scene,
        event: u32,
        sampler: &PixelSampler,
        lambda: &Wavelengths,
        stop: &Stop,
    ) -> Option<(Spectrum, Ray)> {
        let (mut light, wi, distance) = self.unoccluded(scene, event, sampler, lambda)?;
        if let (true, Some(m)) = (MEDIA, self.medium_towards(scene, wi)) {
            let number = shadow_number::<MEDIA>(sampler, event);
            light *= flight::passed(scene, m, (&self.spawn(wi), distance), number, lambda, stop);
        }
        Some((light, self.spawn_towards(wi, distance)))
    }

    /// A direction drawn by scattering, and by the photons near.
    #[inline]
    pub fn sample(
        &self,
        path_state: &PathState,
        sampler: &PixelSampler,
        precomputed: &Precomputed,
    ) -> Option<GuidedDirection> {
        let u2 = sampler.get_2d(dimension::at(path_state.events, dimension::DIRECTION));
        match self {
            Self::Surface { i, scattering, frame, .. } => {
                let has_one_lobe = matches!(scattering.bsdf, Bsdf::Diffuse(_) | Bsdf::Conductor(_));
                let is_asked = precomputed.caustics.is_some() || !has_one_lobe;
                let u = sampler.get_1d_lazily(path_state.dimension(dimension::LOBE), is_asked);
                let wo = frame.to_local(i.wo);
                match &precomputed.caustics {
                    Some(c) => c.sample(i.surface.p, frame, wo, scattering, u, u2),
                    None => scattering.sample(wo, u, u2, TransportMode::Radiance).map(GuidedDirection::by_surface),
                }
            }
            Self::Medium { wo, scattering, .. } => {
                let (wi, pdf) = scattering.sample_phase(*wo, u2);
                let sample = BsdfSample { wi, weight: Spectrum::ONE, pdf, lobe: Lobe::GLOSSY, eta: 1.0 };
                Some(GuidedDirection::by_surface(sample))
            }
        }
    }
}

/// A random number for the way of a shadow ray through media that vary.
#[inline]
fn shadow_number<const MEDIA: bool>(sampler: &PixelSampler, event: u32) -> f32 {
    if MEDIA { sampler.get_1d(dimension::at(event, dimension::FLIGHT)) } else { 0.0 }
}

/// What a ray leads to. In place, since nothing is allocated per sample.
#[allow(clippy::large_enum_variant)]
#[derive(Clone, Copy, Debug)]
pub(crate) enum Arrival<'s> {
    /// A point that scatters, within the depth.
    Vertex(Vertex<'s>),
    /// The path ends.
    End,
    /// Nothing is met.
    Escaped,
}

/// Follows a path to the next point that scatters, passing what does not; adds what surfaces emit on the way to `sum`.
/// The background is left to the caller. What it leads to is written where it stays, since it is large.
#[inline]
#[allow(clippy::too_many_arguments)]
pub(crate) fn arrive<'s, const MEDIA: bool>(
    scene: &'s Scene,
    path_state: &mut PathState,
    sum: &mut Spectrum,
    depth: &Depth,
    sampler: &PixelSampler,
    lambda: &mut Wavelengths,
    counters: &mut Counters,
    arrival: &mut Arrival<'s>,
) {
    counters.rays += 1;
    let hit = scene.intersect(&path_state.ray);
    meet::<MEDIA>(scene, path_state, hit, sum, depth, sampler, lambda, counters, arrival);
}

/// As [`arrive`], where it is known what the ray hits first.
#[inline]
#[allow(clippy::too_many_arguments)]
pub(crate) fn meet<'s, const MEDIA: bool>(
    scene: &'s Scene,
    path_state: &mut PathState,
    mut hit: Option<Hit>,
    sum: &mut Spectrum,
    depth: &Depth,
    sampler: &PixelSampler,
    lambda: &mut Wavelengths,
    counters: &mut Counters,
    arrival: &mut Arrival<'s>,
) {
    *arrival = Arrival::End;
    loop {
        if counters.stop.is_asked() {
            return;
        }
        if let (true, Some(medium)) = (MEDIA, path_state.medium) {
            let scattering = &scene.media[medium as usize];
            let distance = hit.as_ref().map_or(f32::INFINITY, |h| h.t);
            let u = sampler.get_1d(path_state.dimension(dimension::FLIGHT));
            let lane = sampler.get_1d(path_state.dimension(dimension::LANE));
            let flight = match &scattering.field {
                None => {
                    *sum += path_state.beta * scattering.glow_over(distance, lambda);
                    flight::sample_flight(scene, scattering, distance, lane, u, lambda)
                }
                Some(field) => {
                    let (mut glow, ray) = (Spectrum::ZERO, &path_state.ray);
                    let way = (scattering, &**field);
                    let flight = tracking::sample_flight(
                        scene,
                        way,
                        ray,
                        distance,
                        (lane, u),
                        lambda,
                        &counters.stop,
                        &mut glow,
                    );
                    *sum += path_state.beta * glow;
                    flight
                }
            };
            let (factor, t) = match flight {
                Flight::Passed(factor) => (factor, None),
                Flight::Scattered(t, factor) => (factor, Some(t)),
            };
            path_state.beta *= factor;
            if live_max(path_state.beta, lambda) <= 0.0 {
                return;
            }
            if let Some(t) = t {
                if path_state.events < depth.max {
                    let (p, wo) = (path_state.ray.at(t), -path_state.ray.direction);
                    *arrival = Arrival::Vertex(Vertex::Medium { p, wo, time: path_state.ray.time, scattering, medium });
                }
                return;
            }
        }
        let Some(met) = hit else {
            *arrival = Arrival::Escaped;
            return;
        };
        let i = scene.interaction_of_light(&path_state.ray, &met);
        if !(path_state.events == 0 && depth.hide_emitters) {
            let light = path_state.beta * nee::emission(scene, &i, &path_state.origin, lambda);
            let emitter = || scene.geometries[i.geometry as usize].emitter;
            counters.note(|| emitter().map(|e| scene.light_groups.of_emitters[e as usize]), light);
            *sum += light;
        }
        let is_last = path_state.events >= depth.max;
        if is_last && !scene.is_see_through {
            return;
        }
        let choice = sampler.get_1d_lazily(path_state.dimension(dimension::MIXTURE), scene.has_mixtures);
        if let Some((scattering, frame)) = scene.scattering_along(&i, path_state.differential.as_ref(), choice, lambda)
        {
            if !is_last {
                *arrival = Arrival::Vertex(Vertex::Surface { i, scattering, frame, medium: path_state.medium });
            }
            return;
        }
        path_state.passes += 1;
        if MEDIA {
            path_state.medium = scene.medium_towards(&i, path_state.ray.direction, path_state.medium);
        }
        path_state.ray = i.spawn(path_state.ray.direction);
        path_state.differential = path_state.differential.map(|d| d.advance(i.t));
        if path_state.passes > MAX_PASSES {
            return;
        }
        counters.rays += 1;
        hit = scene.intersect(&path_state.ray);
    }
}

/// As [`escape`], by groups of lights.
#[cold]
pub(crate) fn escape_by_group(
    scene: &Scene,
    path_state: &PathState,
    depth: &Depth,
    lambda: &Wavelengths,
    counters: &mut Counters,
) {
    if path_state.events == 0 && depth.hide_emitters {
        return;
    }
    for &light in &scene.lights.environments {
        let found =
            nee::environment(scene, light, path_state.ray.origin, path_state.ray.direction, &path_state.origin, lambda);
        counters.note(|| Some(scene.light_groups.of_lights[light as usize]), path_state.beta * found);
    }
}

/// Adds the light of the environments that a path met to `sum`.
#[inline]
pub(crate) fn escape(scene: &Scene, path_state: &PathState, sum: &mut Spectrum, depth: &Depth, lambda: &Wavelengths) {
    if !(path_state.events == 0 && depth.hide_emitters) {
        *sum += path_state.beta
            * nee::background(scene, path_state.ray.origin, path_state.ray.direction, &path_state.origin, lambda);
    }
}
