//! Subpaths from the camera and from lights, the vertices they leave, and what weighs the ways to find a path against
//! each other.
//!
//! Weights are those of the power heuristic over all ways to find a path: by scattering alone, by a light sample, by
//! connecting two vertices, by connecting to the camera, and by merging. They are computed from three sums that are
//! carried along a subpath (Georgiev 2012, "Implementing Vertex Connection and Merging", equations 31 to 38). Roulette
//! is left out of densities, which changes no mean.
//!
//! Subpaths fly through media, and scatter there by the phase function (Lafortune, Willems 1996, "Rendering
//! Participating Media with Bidirectional Path Tracing"). Points of media have densities by volume, with 1 in place of
//! the cosine. Weights leave out what draws the distances of flights: all ways to find a path draw each of its points
//! in a medium once, so that the extinction there cancels, and of the transmittances only that of the segment which a
//! technique connects remains. Weights of a path are thus a function of its vertices, and sum to one over all ways,
//! in media that vary too, where the density of a flight is not known. The cost is noise: connections through dense
//! media have the weight that they would have in clear air. Straight passage of interfaces and thin panes is no event,
//! and left out in the same way.

use super::{
    passage,
    surface::{Surface, View},
    vertex::{Drawn, Place, Vertex, Within},
};
use crate::{Counters, Depth, MAX_PASSES, dimension, live_max};
use steradian_bsdf::TransportMode;
use steradian_core::{
    Scene,
    light::{
        LightContext,
        emission::{Emission, EmittedRay},
    },
    sampler::PixelSampler,
    scene::Interaction,
};
use steradian_math::{Ray, Spectrum, Vec2, spectra::Wavelengths};
use steradian_transport::{flight::Flight, tracking};

/// Events of paths from lights take numbers from this one on.
pub(super) const LIGHT_EVENTS: u32 = 4096;

/// Random numbers by what they are for.
pub(super) trait Numbers {
    fn one(&self, dimension: u32) -> f32;
    fn two(&self, dimension: u32) -> Vec2;
}

impl Numbers for PixelSampler {
    #[inline]
    fn one(&self, dimension: u32) -> f32 {
        self.get_1d(dimension)
    }

    #[inline]
    fn two(&self, dimension: u32) -> Vec2 {
        self.get_2d(dimension)
    }
}

/// The square, in which ratios of densities count.
#[inline]
pub(super) fn squared(v: f32) -> f64 {
    f64::from(v) * f64::from(v)
}

/// The partial sums of weights (`dVCM` and `dVC` of the source). Its `dVM` is `dVC` over the expected number of paths
/// that merge, which is not the same at all vertices.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sums {
    pub vcm: f64,
    pub vc: f64,
}

/// Techniques that find a path, and the number of samples of each.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ways {
    /// Paths from lights for all camera rays of a pass.
    pub light_paths: f32,
    /// Square of the expected number of paths from lights that merge at an opaque surface, per unit density; 0 where
    /// none does.
    pub merge: f64,
    /// Enables connections of vertices to the camera.
    pub to_camera: bool,
}

impl Ways {
    /// Without merging.
    pub fn connections(light_paths: f32, to_camera: bool) -> Self {
        Self { light_paths, merge: 0.0, to_camera }
    }

    /// With merging within a radius.
    pub fn merging(light_paths: f32, to_camera: bool, radius: f32) -> Self {
        Self { light_paths, merge: squared(std::f32::consts::PI * radius * radius * light_paths), to_camera }
    }
}

/// A subpath on its way.
#[derive(Clone, Debug)]
pub(super) struct Subpath {
    pub ray: Ray,
    pub beta: Spectrum,
    pub lambda: Wavelengths,
    /// Scattering events so far.
    pub events: u32,
    /// Reference point of light sampling at the last event; `None` from the camera and after specular events.
    pub context: Option<LightContext>,
    /// True if all events so far were specular.
    pub is_specular: bool,
    /// Light of the media that the subpath went through, as it carries it. No other technique finds it.
    pub glow: Spectrum,
    /// The medium that it goes through.
    medium: Option<u32>,
    sums: Sums,
    mode: TransportMode,
    /// Emitted ray, until the first vertex.
    emitted: Option<EmittedRay>,
    /// True if densities do not fall with distance up to the first vertex.
    is_parallel: bool,
    /// The way so far since the last vertex.
    distance: f32,
    /// Factor on the throughput in Russian roulette: relative to the start of the subpath, without the compression of
    /// radiance by refraction.
    scale: f32,
    /// Surfaces passed straight.
    passes: u32,
    first_event: u32,
    /// True if the subpath passes emitters until its first event: camera rays do where lights are hidden from the
    /// camera.
    passes_emitters: bool,
}

/// End of a subpath's ray.
#[expect(
    clippy::large_enum_variant,
    reason = "values live on the stack of one step; a box would cost an allocation per vertex"
)]
pub(super) enum Arrival<'s> {
    Vertex(Vertex<'s>),
    Escaped,
    Ended,
}

impl Subpath {
    /// Subpath from the camera along one of its rays.
    pub fn from_camera(scene: &Scene, ray: Ray, lambda: Wavelengths, ways: &Ways, depth: &Depth) -> Self {
        let d = scene.camera().ray_density(scene.film(), &ray);
        // dVCM of a camera subpath: (n / p)², with n light paths and the density p of the camera ray.
        let vcm = if ways.to_camera { squared(ways.light_paths / d.density) } else { 0.0 };
        Self {
            ray: Ray { time: lambda.time, ..ray },
            beta: Spectrum::ONE,
            lambda,
            events: 0,
            context: None,
            is_specular: true,
            glow: Spectrum::ZERO,
            medium: scene.camera().medium,
            sums: Sums { vcm, ..Sums::default() },
            mode: TransportMode::Radiance,
            emitted: None,
            is_parallel: d.is_parallel,
            distance: d.start,
            scale: 1.0,
            passes: 0,
            first_event: 0,
            passes_emitters: depth.hide_emitters,
        }
    }

    /// Subpath from a light.
    pub fn from_light(
        scene: &Scene,
        emission: &Emission,
        numbers: &impl Numbers,
        lambda: Wavelengths,
        counters: &mut Counters,
    ) -> Option<Self> {
        let at = |decision| dimension::at(LIGHT_EVENTS - 1, decision);
        // A light, a point on it, and a direction: β = Le cosθ / p.
        let place = numbers.two(at(dimension::LIGHT_POINT));
        let direction = numbers.two(at(dimension::DIRECTION));
        let emitted = emission.sample(scene, numbers.one(at(dimension::LIGHT)), place, direction, &lambda)?;
        let kind = scene.lights().lights[emitted.light as usize].kind();
        let number = || numbers.one(at(dimension::FLIGHT));
        let (medium, passed) = passage::from_light(scene, &emitted, number, &lambda, counters);
        let beta = emitted.radiance * passed * (emitted.cos / emitted.pdf);
        let live = live_max(beta, &lambda);
        // dVC of a light subpath: (cosθ / p)², zero for lights that scattering cannot meet.
        let vc = if kind.is_delta { 0.0 } else { squared(emitted.cos / emitted.pdf) };
        (live > 0.0 && live.is_finite()).then(|| Self {
            ray: Ray { time: lambda.time, ..emitted.ray },
            beta,
            lambda,
            events: 0,
            context: None,
            is_specular: true,
            glow: Spectrum::ZERO,
            medium,
            sums: Sums { vcm: 0.0, vc },
            mode: TransportMode::Importance,
            emitted: Some(emitted),
            is_parallel: kind.is_parallel,
            distance: 0.0,
            scale: 1.0 / live,
            passes: 0,
            first_event: LIGHT_EVENTS,
            passes_emitters: false,
        })
    }

    /// True if it comes from a light without size; asked before it arrives anywhere.
    pub fn is_from_delta(&self, scene: &Scene) -> bool {
        self.emitted.as_ref().is_some_and(|e| scene.lights().lights[e.light as usize].kind().is_delta)
    }

    /// The dimension of a decision at the next event.
    fn at(&self, decision: u32) -> u32 {
        dimension::at(self.first_event + self.events, decision) ^ (self.passes << 16)
    }

    /// The sums where the subpath leaves the scene.
    pub fn sums(&self) -> Sums {
        self.sums
    }

    /// The sums where the subpath meets a surface at a distance and a cosine.
    fn sums_at(&self, distance: f32, cos: f32) -> Sums {
        let (mut sums, cos) = (self.sums, squared(cos));
        // Conversion from solid angle to area: ratios of densities grow with d², fall with cosθ; all sums hold squares
        // (power heuristic).
        if !(self.is_parallel && self.events == 0) {
            sums.vcm *= squared(distance) * squared(distance);
        }
        Sums { vcm: sums.vcm / cos, vc: sums.vc / cos }
    }

    /// Follows the ray to the next point that scatters; `met` is told of every surface on the way.
    pub fn arrive<'s>(
        &mut self,
        scene: &'s Scene,
        numbers: &impl Numbers,
        counters: &mut Counters,
        mut met: impl FnMut(&Self, &Interaction, f32, Sums),
    ) -> Arrival<'s> {
        // Segment by segment: a flight through its medium, then the surface at its end, up to one that scatters.
        for _ in 0..MAX_PASSES {
            counters.rays += 1;
            let hit = scene.intersect(&self.ray);
            if let Some(index) = self.medium {
                let distance = hit.as_ref().map_or(self.ray.t_max, |h| h.t);
                let scattered = self.fly(scene, index, distance, numbers, counters);
                if live_max(self.beta, &self.lambda) <= 0.0 {
                    return Arrival::Ended;
                }
                if let Some(t) = scattered {
                    return self.within(scene, index, t);
                }
            }
            let Some(hit) = hit else { return Arrival::Escaped };
            let i = scene.interaction_of_light(&self.ray, &hit);
            let distance = self.distance + hit.t;
            let cos = i.surface.n.dot(i.wo).abs().max(1e-12);
            let sums = self.sums_at(distance, cos);
            // Emission is handled by the caller, at interfaces too.
            met(self, &i, distance, sums);
            let choice = if scene.has_mixtures() { numbers.one(self.at(dimension::MIXTURE)) } else { 0.5 };
            let passes_straight = self.passes_emitters && self.events == 0 && scene.is_passed_when_hidden(i.geometry);
            let surface = if passes_straight { None } else { scene.scattering(&i, choice, &mut self.lambda) };
            if let Some(side) = surface {
                let surface = Surface::new(scene, i, side, choice);
                let is_curve = surface.view == View::Curve;
                // Only camera subpaths pass curves.
                if is_curve && self.mode == TransportMode::Importance {
                    return Arrival::Ended;
                }
                let sums = if is_curve { Sums::default() } else { sums };
                return self.reached(scene, Place::Surface(surface), sums, (distance, cos));
            }
            self.pass(scene, &i);
        }
        Arrival::Ended
    }

    /// Draws a flight through a medium over at most a distance: the distance at which it scatters, if it does.
    fn fly(
        &mut self,
        scene: &Scene,
        medium: u32,
        distance: f32,
        numbers: &impl Numbers,
        counters: &Counters,
    ) -> Option<f32> {
        let (lane, u) = (numbers.one(self.at(dimension::LANE)), numbers.one(self.at(dimension::FLIGHT)));
        let (medium, mut glow) = (&scene.media()[medium as usize], Spectrum::ZERO);
        let around = (scene, &self.lambda, &counters.stop);
        let flight = tracking::fly(medium, (&self.ray, distance), (lane, u), around, &mut glow);
        self.glow += self.beta * glow;
        // β ← β Tr / p to pass, β σs Tr / p to scatter.
        let (scattered, factor) = match flight {
            Flight::Passed(factor) => (None, factor),
            Flight::Scattered(t, factor) => (Some(t), factor),
        };
        self.beta *= factor;
        scattered
    }

    /// Arrival at a point of a medium, so far along the ray.
    fn within<'s>(&mut self, scene: &'s Scene, medium: u32, t: f32) -> Arrival<'s> {
        let (ray, distance) = (&self.ray, self.distance + t);
        let medium = &scene.media()[medium as usize];
        let place = Place::Medium(Within { p: ray.at(t), wo: -ray.direction, time: ray.time, medium });
        self.reached(scene, place, self.sums_at(distance, 1.0), (distance, 1.0))
    }

    /// Arrival at a vertex, by a distance and a cosine.
    fn reached<'s>(&self, scene: &Scene, place: Place<'s>, sums: Sums, (distance, cos): (f32, f32)) -> Arrival<'s> {
        let Self { beta, lambda, events, medium, .. } = *self;
        let mut v = Vertex { place, beta, lambda, events, sums, medium };
        // First vertex of a light subpath: dVCM is the ratio of the light sample's density here to that of emission.
        if let Some(e) = &self.emitted {
            if !scene.lights().reaches(e.light, v.p(), -self.ray.direction, &lambda) {
                return Arrival::Ended;
            }
            v.sums.vcm = squared(asked(scene, e, &v.context(), (distance, lambda.time)) / (e.pdf * cos));
        }
        Arrival::Vertex(v)
    }

    /// Straight on behind a surface, which is no event.
    fn pass(&mut self, scene: &Scene, i: &Interaction) {
        self.passes += 1;
        self.distance += i.t;
        self.medium = scene.medium_towards(i, self.ray.direction, self.medium);
        self.ray = i.rest(&self.ray);
    }

    /// Straight on with what passes a vertex as if there were nothing; whether anything does, which is the case for
    /// thin panes among media.
    pub fn pass_pane(&mut self, scene: &Scene, v: &Vertex<'_>) -> bool {
        let Place::Surface(surface) = &v.place else { return false };
        let Some(part) = surface.straight_transmission().filter(|part| scene.has_media() && !part.is_black()) else {
            return false;
        };
        self.beta *= part;
        self.pass(scene, &surface.i);
        self.passes <= MAX_PASSES
    }

    /// On from a vertex in a direction.
    fn turn(&mut self, scene: &Scene, v: &Vertex<'_>, s: &Drawn, ways: &Ways) {
        let cos = v.cos(s.wi);
        // Update of the sums.
        match s.densities {
            // Specular: no other technique connects or merges here, dVCM = 0, and dVC only passes through.
            None => {
                let vc = if s.is_two_way { v.sums.vc * squared(cos) } else { 0.0 };
                self.sums = Sums { vcm: 0.0, vc };
                self.context = None;
            }
            // dVC = (cosθ/p)² (dVC p_back² + dVCM + merging), dVCM = 1/p².
            Some((pdf, back)) => {
                let vc = squared(cos / pdf) * (v.sums.vc * squared(back) + v.sums.vcm + v.merge(ways));
                self.sums = Sums { vcm: 1.0 / squared(pdf), vc };
                self.context = Some(v.context());
                self.is_specular = false;
            }
        }
        self.emitted = None;
        self.medium = v.medium_towards(scene, s.wi);
        self.ray = v.spawn(s.wi);
        self.distance = 0.0;
        self.events += 1;
    }

    /// On from a vertex; whether the subpath goes on.
    pub fn scatter(
        &mut self,
        scene: &Scene,
        v: &Vertex<'_>,
        numbers: &impl Numbers,
        ways: &Ways,
        depth: &Depth,
    ) -> bool {
        let (u, u2) = (numbers.one(self.at(dimension::LOBE)), numbers.two(self.at(dimension::DIRECTION)));
        let Some(s) = v.sample(scene, u, u2, self.mode) else { return false };
        // β ← β f |cosθ| / p; roulette does not see the compression of radiance.
        self.beta *= s.weight;
        if self.mode == TransportMode::Radiance {
            self.scale *= s.eta * s.eta;
        }
        match &v.place {
            // Among media, light that goes straight through a pane has not scattered: connections see through it too.
            Place::Surface(surface)
                if scene.has_media() && s.is_transmission && surface.straight_transmission().is_some() =>
            {
                self.pass(scene, &surface.i);
            }
            _ => self.turn(scene, v, &s, ways),
        }
        let live = live_max(self.beta, &self.lambda) * self.scale;
        if !(live > 0.0 && live.is_finite() && sums_are_sound(&self.sums)) {
            return false;
        }
        // Roulette: β/q, and a random number only for q below one.
        match survival(live, self.events, depth) {
            1.0.. => true,
            p => {
                self.beta *= 1.0 / p;
                numbers.one(self.at(dimension::ROULETTE)) < p
            }
        }
    }
}

/// After this many events a subpath goes on with the second number as its chance at most: vertices of both are kept or
/// joined.
const LONG: (u32, f32) = (32, 0.9);

/// The chance to go on with a throughput, relative to what the subpath began with, after so many events: less than one
/// below one third.
fn survival(live: f32, events: u32, depth: &Depth) -> f32 {
    let p = if events > depth.roulette_after { 3.0 * live } else { 1.0 };
    if events > LONG.0 { p.min(LONG.1) } else { p }
}

fn sums_are_sound(s: &Sums) -> bool {
    s.vcm.is_finite() && s.vc.is_finite()
}

/// The density with which a light sample for a context finds the light that emitted a ray, so that it can be divided by
/// that of emission and the cosine where the ray arrives.
fn asked(scene: &Scene, e: &EmittedRay, context: &LightContext, (distance, time): (f32, f32)) -> f32 {
    let (lights, wi) = (scene.lights(), -e.ray.direction);
    let kind = lights.lights[e.light as usize].kind();
    // Area lights by solid angle times the emission's cosine; distant ones by direction; points by d².
    match (kind.is_delta, kind.is_parallel) {
        (false, false) => lights.area_pdf(e.light, context, (wi, distance), e.n, time) * e.cos,
        (false, true) => lights.environment_pdf(e.light, context, wi),
        (true, false) => lights.probability(context, e.light) * distance * distance,
        (true, true) => lights.probability(context, e.light),
    }
}
