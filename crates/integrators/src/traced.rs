//! Single paths, to be looked at: the vertices of one sample of a pixel as the path tracer meets them, with what the
//! path carries and the light that it finds there.

use crate::{Depth, path::PathTracer};
use std::sync::{
    Arc,
    atomic::{AtomicBool, Ordering},
};
use steradian_bsdf::Lobe;
use steradian_core::{ColorMode, Scene, sampler::Sampler};
use steradian_engine::{
    Counters, PathContext, PixelSample, Stop,
    partition::{Partition, Place},
};
use steradian_math::{Spectrum, Vec3, spectra::Wavelengths};
use steradian_transport::{NoGuide, PathState, Segment, Sink, Step, Vertex, subsurface::EVENTS_BELOW};

/// Kind of a vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VertexKind {
    /// Start of the path.
    Camera,
    /// A point of a surface.
    Surface,
    /// A point within a medium.
    Medium,
    /// The path left the scene, for the environment: there is no point.
    Escaped,
}

/// Reason why a path ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// The path left the scene.
    Escaped,
    /// The last vertex scatters nothing.
    Absorbed,
    /// The path reached the largest number of scattering events.
    Depth,
    /// Russian roulette.
    Roulette,
    /// Its throughput is not finite.
    NotFinite,
    /// The path has more than [`MOST_VERTICES`] vertices; the light found at the others is not in its value.
    TooLong,
}

/// Most vertices of a traced path.
pub const MOST_VERTICES: usize = 1 << 14;

/// Continuation of a path from a vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// In a direction that was drawn, by a lobe.
    Lobe(Lobe),
    /// In a direction that the phase function drew.
    Phase,
    /// Straight through a thin pane, which counts as no event.
    Straight,
    /// Straight through a surface that scatters nothing.
    Passed,
}

/// A light sample that a vertex took.
#[derive(Clone, Copy, Debug)]
pub struct DirectLight {
    /// Unit direction to the light.
    pub towards: Vec3,
    /// Distance to the point on the light; infinite for infinite lights.
    pub distance: f32,
    /// Contribution to the pixel's sample, linear Rec.709; zero where something is before the light.
    pub light: Vec3,
}

/// A vertex of a path.
#[derive(Clone, Debug)]
pub struct TracedVertex {
    /// Kind.
    pub kind: VertexKind,
    /// World position; of a path that escaped, the origin of its last ray.
    pub position: Vec3,
    /// The shading normal of surfaces, of unit length, without normal maps.
    pub normal: Option<Vec3>,
    /// Unit direction in which the path arrives; of the camera, in which it leaves.
    pub direction: Vec3,
    /// The number of the object ([`Scene::object_names`]) and of the material ([`Scene::material_names`]).
    pub surface: Option<(u32, u32)>,
    /// The weight of the path when it arrives, as factors of linear Rec.709. Of single wavelengths, which have no such
    /// factors, the mean three times.
    pub throughput: Vec3,
    /// Contribution of light that is emitted here to the pixel's sample, linear Rec.709: of surfaces, of environments,
    /// and of media on the way here.
    pub emitted: Vec3,
    /// The light sample that was taken here.
    pub direct: Option<DirectLight>,
    /// Continuation of the path; `None` where it ends.
    pub event: Option<Event>,
}

/// The path of one sample of a pixel.
#[derive(Clone, Debug)]
pub struct TracedPath {
    /// The camera first.
    pub vertices: Vec<TracedVertex>,
    /// Reason why the path ends.
    pub end: End,
    /// Value of the pixel's sample, linear Rec.709: the bits that the path tracer gives.
    pub value: Vec3,
    /// The moment of the exposure.
    pub time: f32,
}

/// Traces a sample of a pixel as path tracers do whose paths share nothing and are not guided; through media or not.
pub fn trace(
    scene: &Scene,
    sampler: &Sampler,
    (has_media, depth): (bool, Depth),
    pixel: [u32; 2],
    sample: u32,
) -> TracedPath {
    let (begun, weight) =
        PixelSample::at(scene, sampler, &Partition::new(1, sampler.seed), sample, &Place::alone(pixel));
    let full = Arc::new(AtomicBool::new(false));
    let (mut shifted, mut counters) = (begun.lambda, Counters::until(&Stop::by(&full)));
    let context = &mut PathContext { scene, sampler: &begun.own, lambda: &mut shifted, counters: &mut counters };
    let state = PathState::camera(scene, begun.ray);
    let recorder = Recorder::new(scene, &depth, state.segment(), full);
    let found = match has_media {
        true => PathTracer::<true> { depth }.along(state, None::<&NoGuide>, context, recorder),
        false => PathTracer::<false> { depth }.along(state, None::<&NoGuide>, context, recorder),
    };
    // The film sees the wavelengths that the path began with.
    let mut lambda = begun.lambda;
    if shifted.is_secondary_terminated() {
        lambda.terminate_secondary();
    }
    found.developed(&lambda, weight, begun.ray.time)
}

/// A vertex in the lanes of the path.
struct Found {
    kind: VertexKind,
    position: Vec3,
    direction: Vec3,
    /// Normal, and numbers of object and material.
    surface: Option<(Vec3, u32, u32)>,
    throughput: Spectrum,
    /// Scattering events before this vertex.
    events: u32,
    emitted: Spectrum,
    direct: Option<(Vec3, f32, Spectrum)>,
    event: Option<Event>,
}

/// Keeps what a path meets.
struct Recorder<'s> {
    scene: &'s Scene,
    vertices: Vec<Found>,
    /// True if the path is between two vertices; light emitted there follows.
    is_under_way: bool,
    on_the_way: Spectrum,
    total: Spectrum,
    end: Option<End>,
    /// Most events, those below surfaces included.
    most: u32,
    /// Set where there are so many vertices that the path is not followed further.
    full: Arc<AtomicBool>,
}

impl<'s> Recorder<'s> {
    fn new(scene: &'s Scene, depth: &Depth, segment: Segment, full: Arc<AtomicBool>) -> Self {
        let mut recorder = Self {
            scene,
            vertices: Vec::new(),
            is_under_way: true,
            on_the_way: Spectrum::ZERO,
            total: Spectrum::ZERO,
            end: None,
            most: depth.max,
            full,
        };
        recorder.push(VertexKind::Camera, segment, segment.ray.origin, None);
        recorder.is_under_way = true;
        recorder
    }

    fn push(&mut self, kind: VertexKind, segment: Segment, position: Vec3, surface: Option<(Vec3, u32, u32)>) {
        if self.vertices.len() >= MOST_VERTICES {
            self.full.store(true, Ordering::Relaxed);
            self.end = Some(End::TooLong);
            return;
        }
        // What passes a thin pane straight has not scattered there.
        if let Some(before) = self.vertices.last_mut()
            && let (Some(Event::Lobe(_)), true) = (before.event, before.events == segment.events)
        {
            before.event = Some(Event::Straight);
        }
        self.is_under_way = false;
        self.vertices.push(Found {
            kind,
            position,
            direction: segment.ray.direction,
            surface,
            throughput: segment.beta,
            events: segment.events,
            emitted: std::mem::replace(&mut self.on_the_way, Spectrum::ZERO),
            direct: None,
            event: None,
        });
    }

    fn go_on(&mut self, event: Event) {
        self.is_under_way = true;
        if let Some(vertex) = self.vertices.last_mut() {
            vertex.event = Some(event);
        }
    }

    /// The path as the film holds it, with the weight that the film gives the sample.
    fn developed(mut self, lambda: &Wavelengths, weight: f32, time: f32) -> TracedPath {
        let mode = self.scene.mode();
        // What shone on a way that led nowhere.
        if let Some(last) = self.vertices.last_mut() {
            last.emitted += self.on_the_way;
        }
        let is_deep = self.vertices.last().is_some_and(|v| v.events >= self.most);
        let exposed = self.scene.film().exposed(self.total);
        // Films clamp samples as a whole.
        let (all, kept) = (self.total.max_element(), exposed.max_element());
        let scale = if all > 0.0 && all.is_finite() { kept / all } else { self.scene.film().imaging_ratio };
        let rgb = |light: Spectrum| self.scene.film().to_rgb(light * scale, lambda, mode) * weight;
        let factors = |beta: Spectrum| match mode {
            ColorMode::Rgb => mode.to_rgb(beta, lambda),
            ColorMode::Spectral if lambda.is_secondary_terminated() => Vec3::splat(beta[0]),
            ColorMode::Spectral => Vec3::splat(beta.mean()),
        };
        let vertices = self.vertices.into_iter().map(|v| TracedVertex {
            kind: v.kind,
            position: v.position,
            normal: v.surface.map(|s| s.0),
            direction: v.direction,
            surface: v.surface.map(|s| (s.1, s.2)),
            throughput: factors(v.throughput),
            emitted: rgb(v.emitted),
            direct: v.direct.map(|(towards, distance, light)| DirectLight { towards, distance, light: rgb(light) }),
            event: v.event,
        });
        TracedPath {
            vertices: vertices.collect(),
            end: self.end.unwrap_or(if is_deep { End::Depth } else { End::Absorbed }),
            value: self.scene.film().to_rgb(exposed, lambda, mode) * weight,
            time,
        }
    }
}

impl Sink for Recorder<'_> {
    fn add(&mut self, light: Spectrum) {
        self.total += light;
        match self.vertices.last_mut().filter(|_| !self.is_under_way) {
            Some(vertex) => vertex.emitted += light,
            None => self.on_the_way += light,
        }
    }

    fn is_timed(&self) -> bool {
        true
    }

    fn add_direct(&mut self, light: Spectrum, _: &Vertex<'_>, towards: Vec3, distance: f32) {
        self.total += light;
        if let Some(vertex) = self.vertices.last_mut() {
            vertex.direct = Some((towards, distance, light));
        }
    }

    fn spoil(&mut self, light: Spectrum) {
        self.total = light;
        self.end = Some(End::NotFinite);
    }

    fn tell(&mut self, step: Step<'_>) {
        match step {
            Step::Surface(segment, i) => {
                let geometry = &self.scene.geometries()[i.geometry as usize];
                let surface = (i.surface.ns, geometry.id, geometry.material);
                self.push(VertexKind::Surface, segment, i.surface.p, Some(surface));
            }
            Step::Medium(segment, p) => self.push(VertexKind::Medium, segment, p, None),
            Step::Escaped(segment) => {
                self.push(VertexKind::Escaped, segment, segment.ray.origin, None);
                self.end = Some(End::Escaped);
            }
            Step::Passed => self.go_on(Event::Passed),
            Step::Scattered(s) => {
                let is_phase = self.vertices.last().is_some_and(|v| v.kind == VertexKind::Medium);
                if s.lobe.is_subsurface() {
                    self.most = self.most.saturating_add(EVENTS_BELOW);
                }
                self.go_on(if is_phase { Event::Phase } else { Event::Lobe(s.lobe) });
            }
            Step::Roulette => self.end = Some(End::Roulette),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use steradian_math::Ray;

    /// A path of very many vertices is asked to stop, and keeps so many of them.
    #[test]
    fn vertices_are_bounded() {
        let scene = crate::stop_tests::ball("diffuse");
        let depth = Depth { max: u32::MAX, roulette_after: 0, hide_emitters: false };
        let segment = Segment { ray: Ray::new(Vec3::ZERO, Vec3::Z), beta: Spectrum::ONE, events: 0 };
        let full = Arc::new(AtomicBool::new(false));
        let mut recorder = Recorder::new(&scene, &depth, segment, Arc::clone(&full));
        for k in 0..MOST_VERTICES + 10 {
            assert_eq!(full.load(Ordering::Relaxed), k >= MOST_VERTICES);
            recorder.tell(Step::Medium(segment, Vec3::ZERO));
        }
        assert_eq!((recorder.vertices.len(), recorder.end), (MOST_VERTICES, Some(End::TooLong)));
    }
}
