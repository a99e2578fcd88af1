//! Transient pictures: when light of one pulse of all lights arrives (Jarabo and others 2014, "A Framework for
//! Transient Rendering"). Time is told by the optical length of paths, the sum of n·d: light goes a metre of it in 1/c.

use crate::{Depth, path::PathTracer};
use steradian_bsdf::Bsdf;
use steradian_core::Scene;
use steradian_engine::{Integrator, PathContext};
use steradian_math::{Ray, Spectrum, Vec3};
use steradian_transport::{NoGuide, PathState, Sink, Vertex};

/// The speed of light in empty space, m/s.
const SPEED: f64 = 299_792_458.0;

/// Most intervals.
const MOST_BINS: u32 = 1024;

/// Path tracing that tells when light arrives.
#[derive(Clone, Copy, Debug)]
pub struct Transient {
    /// How far paths are followed.
    pub depth: Depth,
    /// The optical lengths where the first interval begins and where the last one ends, m.
    pub range: [f64; 2],
    /// Into how many intervals of the same length that is cut.
    pub bins: u32,
    /// Metres of a unit of the scene.
    pub unit: f64,
    /// Whether the way from the camera to what it sees counts.
    pub camera: bool,
}

impl Transient {
    /// With the options that it has where none are given.
    pub fn new(depth: Depth) -> Self {
        Self { depth, range: [0.0, 10.0], bins: 32, unit: 1.0, camera: true }
    }

    /// Changes an option; whether there is such an option and value.
    pub fn set(&mut self, key: &str, value: &str) -> bool {
        let number = || value.parse().ok().filter(|v: &f64| v.is_finite());
        let done = match key {
            "from" => number().map(|v| self.range[0] = v),
            "to" => number().map(|v| self.range[1] = v),
            "bins" => value.parse().ok().filter(|n| (1..=MOST_BINS).contains(n)).map(|n| self.bins = n),
            "unit" => number().filter(|v| *v > 0.0).map(|v| self.unit = v),
            "camera" => value.parse().ok().map(|is| self.camera = is),
            _ => None,
        };
        done.is_some()
    }

    /// What it has no picture of; `None` where it has one.
    pub fn refuses(&self, scene: &Scene) -> Option<String> {
        let [from, to] = self.range;
        if from >= to {
            return Some(format!("intervals from {from} m to {to} m: 'to' must be more than 'from'"));
        }
        if let Some(below) = scene.below_surfaces() {
            return Some(format!("{below}, whose way there is not told"));
        }
        let what = if scene.has_schedules() {
            "lights that go on and off: all lights are one pulse"
        } else if scene.media().iter().any(|m| m.glow.is_some()) {
            "media that glow"
        } else {
            return None;
        };
        Some(what.into())
    }
}

/// What a path found, by the optical length of its way.
struct Clock<'c> {
    transient: &'c Transient,
    sum: Spectrum,
    bins: Vec<Spectrum>,
    /// Of the way from the camera so far, in units of the scene.
    length: f64,
    /// The index of refraction where the path is.
    index: f64,
    /// How often it went on.
    steps: u32,
    /// A sphere around the scene, from which light of infinity sets out.
    sphere: (Vec3, f32),
}

impl Clock<'_> {
    /// Adds light that sets out a distance beyond where the path is.
    fn add_at(&mut self, light: Spectrum, beyond: f64) {
        self.sum += light;
        let Transient { range: [from, to], bins, unit, .. } = *self.transient;
        let bin = ((self.length + beyond) * unit - from) / (to - from) * f64::from(bins);
        if bin >= 0.0
            && let Some(sum) = self.bins.get_mut(bin as usize)
        {
            *sum += light;
        }
    }

    /// The way to a point from a plane across a direction to infinity that touches the sphere.
    fn way_from_sphere(&self, point: Vec3, towards: Vec3) -> f64 {
        let (center, radius) = self.sphere;
        f64::from(radius - (point - center).dot(towards))
    }
}

impl Sink for Clock<'_> {
    fn add(&mut self, light: Spectrum) {
        self.add_at(light, 0.0);
    }

    fn add_from_infinity(&mut self, light: Spectrum, point: Vec3, towards: Vec3) {
        // Nothing was met on the way from the last surface.
        self.add_at(light, self.index * self.way_from_sphere(point, towards));
    }

    fn is_timed(&self) -> bool {
        true
    }

    fn add_direct(&mut self, light: Spectrum, vertex: &Vertex<'_>, towards: Vec3, distance: f32) {
        let is_infinite = distance.is_infinite();
        let way = if is_infinite { self.way_from_sphere(vertex.p(), towards) } else { f64::from(distance) };
        self.add_at(light, self.index * crossing(vertex, towards) * way);
    }

    fn spoil(&mut self, light: Spectrum) {
        self.sum = light;
    }

    fn advance(&mut self, distance: f32) {
        self.steps += 1;
        if self.steps > 1 || self.transient.camera {
            self.length += self.index * f64::from(distance);
        }
    }

    fn refract(&mut self, eta: f32) {
        self.index *= f64::from(eta);
    }

    fn wait(&mut self, seconds: f32) {
        self.length += f64::from(seconds) * SPEED / self.transient.unit;
    }
}

/// The index of refraction in a direction relative to that where a path comes from, of rough surfaces of dielectrics.
fn crossing(vertex: &Vertex<'_>, towards: Vec3) -> f64 {
    let Vertex::Surface { i, scattering, frame, .. } = vertex else { return 1.0 };
    let Bsdf::Dielectric(d) = &scattering.bsdf else { return 1.0 };
    match (frame.z.dot(i.wo) > 0.0, frame.z.dot(towards) > 0.0) {
        (true, false) => f64::from(d.eta),
        (false, true) => 1.0 / f64::from(d.eta),
        _ => 1.0,
    }
}

impl Integrator for Transient {
    type Prepared = ();

    fn radiance(&self, (): &(), ray: Ray, context: &mut PathContext<'_, '_>) -> Spectrum {
        // The film sees the wavelengths that the path began with.
        let mut shifted = *context.lambda;
        let bins = std::mem::take(&mut context.counters.by_group);
        let PathContext { scene, sampler, counters, .. } = context;
        let (scene, sampler) = (*scene, *sampler);
        let mut inner = PathContext { scene, sampler, lambda: &mut shifted, counters };
        let sphere = scene.bounds().bounding_sphere();
        let clock = Clock { transient: self, sum: Spectrum::ZERO, bins, length: 0.0, index: 1.0, steps: 0, sphere };
        let state = PathState::camera(scene, ray);
        let clock = PathTracer::<true> { depth: self.depth }.along(state, None::<&NoGuide>, &mut inner, clock);
        context.counters.by_group = clock.bins;
        if shifted.is_secondary_terminated() {
            context.lambda.terminate_secondary();
        }
        clock.sum
    }

    fn bins(&self) -> u32 {
        self.bins
    }
}
