//! Light tracing, bidirectional path tracing, and vertex connection and merging: subpaths from the camera and from
//! lights, and every way to make one path of them (Veach 1997, chapter 10; Georgiev et al. 2012, "Light Transport
//! Simulation with Vertex Connection and Merging").

use super::{
    pair::{Found, Joins, Pair},
    photons::{Grid, Photon},
    radius::{self, Radius},
    subpath::{Numbers, Ways},
};
use crate::{Counters, Depth, support};
use std::sync::Arc;
use steradian_core::{Scene, film::PassFilm, light::emission::Emission};
use steradian_engine::{
    Asked, CameraSample, Feature, Method, MethodKind, Pass, Passes, Plan, Refusal, Run, Session,
    Support::{self, LeavesOut, Refuses},
};
use steradian_math::Vec3;

/// Camera rays of a piece of work, and pieces whose findings wait to be added to the film.
const PIECE: usize = 256;
const WAVE: usize = 128;

/// Pictures of more pixels follow light subpaths a second time where vertices merge, rather than keep all of them: some
/// 500 bytes for each vertex.
const KEPT: usize = 1 << 16;

/// Connections of light and camera subpaths that a method makes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Strategy {
    /// Vertices of light paths are connected to the camera, which sees lights directly: light tracing.
    Light,
    /// All connections.
    Connections,
    /// All connections, and merging.
    Merging,
}

/// The methods of this file, with their settings.
#[derive(Clone, Copy, Debug)]
pub struct Bidirectional {
    /// Path depth: events of both subpaths count.
    pub depth: Depth,
    /// Connections that are made.
    pub strategy: Strategy,
    /// Merging radius of vertices.
    pub radius: Radius,
}

/// `light`.
pub const LIGHT: MethodKind = MethodKind::new("light", |asked| Ok(Arc::new(Bidirectional::of(asked, Strategy::Light))));

/// `bdpt`.
pub const BDPT: MethodKind =
    MethodKind::new("bdpt", |asked| Ok(Arc::new(Bidirectional::of(asked, Strategy::Connections))));

/// `vcm`. Where paths are connected too, narrow merging leaves less bias and no more noise.
pub const VCM: MethodKind = MethodKind::new("vcm", |asked| Ok(Arc::new(Bidirectional::of(asked, Strategy::Merging))));

impl Bidirectional {
    fn of(asked: &Asked<'_>, strategy: Strategy) -> Self {
        Self { depth: asked.depth(), strategy, radius: Radius::of(asked.options) }
    }
}

impl Method for Bidirectional {
    fn supports(&self, feature: Feature) -> Support {
        match (self.strategy, feature) {
            // Between neighbours of a Cornell box, errors of `light` have a correlation of 0.3, and those of `bdpt`
            // 0.04.
            (Strategy::Connections, Feature::Denoising) => Support::Exact,
            (Strategy::Light, Feature::Curves) => Refuses("they face the ray, and light paths do not pass them"),
            (Strategy::Light, Feature::UnconnectedCamera | Feature::InfinitePlanes) => Refuses(""),
            (Strategy::Light, Feature::SpecularView) => LeavesOut("no light path meets the camera there"),
            (Strategy::Light, Feature::UnsampledEmitters) => LeavesOut(""),
            (Strategy::Light, Feature::GlowingMedia) => LeavesOut("what else scatters of their light"),
            _ => support::of_passes(feature),
        }
    }

    fn session(&self, scene: Arc<Scene>, plan: Plan) -> Result<Box<dyn Session>, Refusal> {
        Ok(Box::new(Passes::new(scene, Tracer::new(*self), plan)))
    }

    fn bias_pair(&self) -> Option<[Arc<dyn Method>; 2]> {
        let finer = Self { radius: self.radius.times(0.5), ..*self };
        (self.strategy == Strategy::Merging).then(|| [Arc::new(finer) as Arc<dyn Method>, Arc::new(*self)])
    }
}

/// A method with what it prepared.
#[derive(Debug)]
pub(super) struct Tracer {
    pub settings: Bidirectional,
    pub emission: Option<Emission>,
    radius: f32,
}

impl Tracer {
    pub fn new(settings: Bidirectional) -> Self {
        Self { settings, emission: None, radius: 0.0 }
    }

    /// The ways of a pass.
    pub(super) fn ways(&self, scene: &Scene, number: u32) -> Ways {
        let light_paths = scene.film().width as f32 * scene.film().height as f32;
        let to_camera = scene.camera().can_receive() && self.emission.is_some();
        match self.settings.strategy {
            Strategy::Merging => Ways::merging(light_paths, to_camera, radius::of_pass(self.radius, number)),
            _ => Ways::connections(light_paths, to_camera),
        }
    }

    /// Makes ready for a scene.
    pub(super) fn look(&mut self, scene: &Scene) {
        self.emission = Emission::new(scene);
        if self.settings.strategy == Strategy::Merging {
            self.radius = self.settings.radius.of_scene(scene);
        }
    }
}

impl Tracer {
    /// One sample of the camera with a light subpath of its own, joined by techniques.
    pub(super) fn connect<'s>(
        &self,
        run: &Run<'s>,
        sample: &CameraSample,
        numbers: &impl Numbers,
        joins: Joins,
        counters: &mut Counters,
    ) -> Found<'s> {
        let pair = Pair { tracer: self, run, ways: self.ways(run.scene, 0), numbers, photons: None, joins };
        let mut found = Found::default();
        // A single technique needs the light subpath if it has two vertices of it, and the camera's unless it joins a
        // light vertex to the lens itself.
        let (to_light, to_camera) = match joins {
            Joins::One(t) => (t.light >= 2, t.light <= t.events),
            _ => (true, true),
        };
        if to_light {
            pair.light(sample.lambda, true, &mut found, counters);
        }
        if to_camera {
            pair.camera(sample, &mut found, counters);
        }
        found
    }

    /// The wavelengths of all paths of a pass, which merging needs to be the same.
    fn merges(&self) -> bool {
        self.settings.strategy == Strategy::Merging
    }
}

impl Pass for Tracer {
    fn prepare(&mut self, run: &Run<'_>) -> Option<()> {
        self.look(run.scene);
        Some(())
    }

    fn pass(&self, run: &Run<'_>, number: u32, film: &mut PassFilm<'_>) -> Option<Counters> {
        let scene = run.scene;
        let ways = self.ways(scene, number);
        // Merged vertices have to carry the same wavelengths: one draw for the pass.
        let shared = self.merges().then(|| super::pass_wavelengths(run, number));
        let (width, height) = (scene.film().width, scene.film().height);
        let pixels = width as usize * height as usize;
        let pieces = pixels.div_ceil(PIECE);
        let place = |k: usize| (k as u32 % width, k as u32 / width);
        let mut total = Counters::default();
        // Photons first, where vertices merge.
        let radius = radius::of_pass(self.radius, number);
        let (is_kept, mut kept) = (pixels <= KEPT, Vec::new());
        let grid = if self.merges() {
            let (photons, counters) = run.in_order(pieces, |piece, counters| {
                let (mut photons, mut subpaths) = (Vec::new(), Vec::new());
                for k in (piece * PIECE..pixels.min((piece + 1) * PIECE)).take_while(|_| !run.is_cancelled()) {
                    let (x, y) = place(k);
                    let sample = run.camera_sample(x, y, number);
                    let numbers = &sample.sampler;
                    let pair = Pair { tracer: self, run, ways, numbers, photons: None, joins: Joins::All };
                    let mut found = Found::default();
                    pair.light(shared.unwrap_or(sample.lambda), is_kept, &mut found, counters);
                    photons
                        .extend(found.vertices.iter().filter(|v| v.geometry().is_some()).map(|v| Photon::of(v, false)));
                    if is_kept {
                        subpaths.push((found.vertices, found.splats));
                    }
                }
                (photons, subpaths)
            })?;
            total += &counters;
            let (photons, subpaths): (Vec<_>, Vec<_>) = photons.into_iter().unzip();
            kept = subpaths;
            Some(Grid::new(photons.into_iter().flatten().collect(), radius))
        } else {
            None
        };
        let crop = film.crop();
        // Camera subpaths, wave by wave, so that findings are added to the film in order and memory stays bounded.
        for first in (0..pieces).step_by(WAVE) {
            let (found, counters) = run.in_order(WAVE.min(pieces - first), |piece, counters| {
                let mut all = (Vec::new(), Vec::new());
                let mut found = Found::default();
                let begin = (first + piece) * PIECE;
                for k in (begin..pixels.min(begin + PIECE)).take_while(|_| !run.is_cancelled()) {
                    let (x, y) = place(k);
                    let mut sample = run.camera_sample(x, y, number);
                    if let Some(lambda) = shared {
                        sample.lambda = lambda;
                    }
                    let photons = grid.as_ref().map(|g| (g, radius));
                    let pair = Pair { tracer: self, run, ways, numbers: &sample.sampler, photons, joins: Joins::All };
                    found.vertices.clear();
                    found.own = Vec3::ZERO;
                    // The light subpath of the pixel: kept from the photons, or followed again with the same random
                    // numbers.
                    match kept.get(first + piece).filter(|_| is_kept) {
                        Some(subpaths) => {
                            let (vertices, splats): &(Vec<_>, Vec<_>) = &subpaths[k - begin];
                            found.vertices.extend_from_slice(vertices);
                            found.splats.extend_from_slice(splats);
                        }
                        None => pair.light(sample.lambda, true, &mut found, counters),
                    }
                    if (crop.x0..crop.x1).contains(&x) && (crop.y0..crop.y1).contains(&y) {
                        pair.camera(&sample, &mut found, counters);
                        counters.samples += 1;
                        all.0.push((x, y, found.own * sample.weight));
                    }
                    all.1.append(&mut found.splats);
                }
                all
            })?;
            total += &counters;
            for (own, splats) in &found {
                own.iter().for_each(|(x, y, rgb)| film.add(*x, *y, *rgb));
                splats.iter().for_each(|s| film.splat(s));
            }
        }
        Some(total)
    }
}
