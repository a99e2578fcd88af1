//! Transient pictures: when light of one pulse of all lights arrives (Jarabo and others 2014, "A Framework for
//! Transient Rendering"). Time is told by the optical length of paths, the sum of n·d: light goes a metre of it in 1/c.

use crate::{Depth, path::PathTracer, support};
use std::sync::Arc;
use steradian_bsdf::Bsdf;
use steradian_core::Scene;
use steradian_engine::{
    CameraPaths, Feature, Integrator, Method, MethodKind, PathContext, Plan, Refusal, Session,
    Support::{self, Refuses},
    Tiles,
};
use steradian_math::{Ray, Spectrum, Vec3};
use steradian_transport::{NoGuide, PathState, Sink, Vertex};

/// The speed of light in empty space, m/s.
const SPEED: f64 = 299_792_458.0;

/// Path tracing that tells when light arrives.
#[derive(Clone, Copy, Debug)]
pub struct Transient {
    /// Path depth.
    pub depth: Depth,
    /// The optical lengths where the first interval begins and where the last one ends, m.
    pub range: [f64; 2],
    /// Number of bins of equal length in the range.
    pub bins: u32,
    /// Metres of a unit of the scene.
    pub unit: f64,
    /// Counts the way from the camera to the first surface.
    pub camera: bool,
}

/// `transient`.
pub const TRANSIENT: MethodKind = MethodKind::new("transient", |asked| {
    let number = |name| asked.options.number(name).unwrap_or_default();
    let [from, to] = [number("from"), number("to")];
    if from >= to {
        return Err(Refusal(format!("transient: intervals from {from} m to {to} m: 'to' must be more than 'from'")));
    }
    let (bins, camera) = (asked.options.count("bins"), asked.options.flag("camera"));
    Ok(Arc::new(Transient { depth: asked.depth(), range: [from, to], bins, unit: number("unit"), camera }))
});

impl Method for Transient {
    fn supports(&self, feature: Feature) -> Support {
        match feature {
            Feature::Fluorescence => Support::Exact,
            Feature::Subsurface => Refuses("its way there is not told"),
            Feature::Schedules => Refuses("all lights are one pulse"),
            Feature::GlowingMedia => Refuses(""),
            Feature::Adaptivity => Refuses("each interval has errors of its own"),
            Feature::Denoising => Refuses("the layers of arrival times would keep their noise"),
            _ => support::of_camera_rays(feature),
        }
    }

    fn session(&self, scene: Arc<Scene>, plan: Plan) -> Result<Box<dyn Session>, Refusal> {
        Ok(Box::new(Tiles::per_pixel(scene, *self, plan)))
    }

    fn bins(&self) -> u32 {
        self.bins
    }

    fn camera_paths(&self) -> Option<CameraPaths> {
        Some(CameraPaths { depth: self.depth, media: true, is_plain: false })
    }
}

/// Sink that sorts a path's light into time bins by optical length.
struct Clock<'c> {
    transient: &'c Transient,
    sum: Spectrum,
    bins: Vec<Spectrum>,
    /// Optical length from the camera so far, in units of the scene.
    length: f64,
    /// The index of refraction where the path is.
    index: f64,
    /// Number of segments so far.
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
        let bins = std::mem::take(&mut context.counters.parts);
        let PathContext { scene, sampler, counters, .. } = context;
        let (scene, sampler) = (*scene, *sampler);
        let mut inner = PathContext { scene, sampler, lambda: &mut shifted, counters };
        let sphere = scene.bounds().bounding_sphere();
        let clock = Clock { transient: self, sum: Spectrum::ZERO, bins, length: 0.0, index: 1.0, steps: 0, sphere };
        let state = PathState::camera(scene, ray);
        let clock = PathTracer::<true> { depth: self.depth }.along(state, None::<&NoGuide>, &mut inner, clock);
        context.counters.parts = clock.bins;
        if shifted.is_secondary_terminated() {
            context.lambda.terminate_secondary();
        }
        clock.sum
    }

    fn bins(&self) -> u32 {
        self.bins
    }
}
