//! Light tracing, bidirectional path tracing, and vertex connection and merging: subpaths from the camera and from
//! lights, and every way to make one path of them (Veach 1997, chapter 10; Georgiev et al. 2012, "Light Transport
//! Simulation with Vertex Connection and Merging").

use super::{
    photons::{Grid, Photon},
    radius::{self, Radius},
    subpath::{Arrival, LIGHT_EVENTS, Numbers, Subpath, Sums, Ways, squared},
    vertex::{Scattered, Vertex},
};
use crate::{Counters, Depth, dimension, nee, support};
use std::sync::Arc;
use steradian_bsdf::TransportMode::{Importance, Radiance};
use steradian_core::{
    Scene,
    film::{PassFilm, Splat},
    light::{Light, emission::Emission},
    scene::Interaction,
};
use steradian_engine::{
    Asked, CameraSample, Feature, Method, MethodKind, Pass, Passes, Plan, Refusal, Run, Session,
    Support::{self, LeavesOut, Refuses},
};
use steradian_math::{Spectrum, Vec3, spectra::Wavelengths};

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
    settings: Bidirectional,
    emission: Option<Emission>,
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

/// Contributions of a pair of subpaths.
#[derive(Debug, Default)]
pub(super) struct Found<'s> {
    /// To the camera ray's own place.
    pub own: Vec3,
    /// To others.
    pub splats: Vec<Splat>,
    /// The light subpath.
    vertices: Vec<Vertex<'s>>,
}

/// A pair of subpaths in the making.
struct Pair<'a, 's, N> {
    tracer: &'a Tracer,
    run: &'a Run<'s>,
    ways: Ways,
    numbers: &'a N,
    photons: Option<(&'a Grid, f32)>,
}

impl<'s, N: Numbers> Pair<'_, 's, N> {
    fn scene(&self) -> &'s Scene {
        self.run.scene
    }

    fn most_events(&self) -> u32 {
        self.tracer.settings.depth.max
    }

    /// Follows the light subpath: keeps its vertices, and connects each to the camera.
    fn light(&self, lambda: Wavelengths, to_camera: bool, found: &mut Found<'s>, counters: &mut Counters) {
        let (scene, depth) = (self.scene(), &self.tracer.settings.depth);
        let Some(emission) = &self.tracer.emission else { return };
        let Some(mut path) = Subpath::from_light(scene, emission, self.numbers, lambda) else { return };
        // Vertex by vertex: connection to the camera (t = 1), storage for connections and merging, and the next
        // direction.
        while let Arrival::Vertex(v) = path.arrive(scene, self.numbers, counters, |_, _, _, _| ()) {
            if v.events >= self.most_events() {
                return;
            }
            if !v.scattering.bsdf.is_specular() {
                if to_camera && self.ways.to_camera {
                    self.to_camera(&v, found, counters);
                }
                found.vertices.push(v);
            }
            if !path.scatter(scene, &v, self.numbers, &self.ways, depth) {
                return;
            }
        }
    }

    /// Connects a light vertex to the camera.
    fn to_camera(&self, v: &Vertex<'_>, found: &mut Found<'_>, counters: &mut Counters) {
        let scene = self.scene();
        // A point of the lens, and the pixel from which it sees the vertex.
        let lens = self.numbers.two(dimension::at(LIGHT_EVENTS + v.events, dimension::BRANCHES));
        let Some(seen) = scene.camera().receive(scene.film(), v.i.surface.p, lens) else { return };
        let Some(e) = v.eval(scene, seen.to_camera, Importance) else { return };
        // MIS weight of light tracing: 1 / (1 + ratios of all other techniques), from the carried sums.
        let weight = match self.tracer.settings.strategy {
            Strategy::Light => 1.0,
            _ => {
                let camera = squared(seen.density * v.cos(seen.to_camera) / self.ways.light_paths);
                1.0 / (1.0 + camera * (v.merge(&self.ways) + v.sums.vcm + v.sums.vc * squared(e.reverse)))
            }
        };
        counters.rays += 1;
        if super::is_hidden_from_camera(scene, &self.tracer.settings.depth, &v.i, (seen.to_camera, seen.distance)) {
            return;
        }
        // β f We / n, splatted where the camera sees the vertex.
        let light = v.beta * e.value * (seen.density / self.ways.light_paths * weight as f32);
        found.splats.push(Splat { at: seen.at, rgb: self.run.developed(light, &v.lambda) });
    }

    /// Follows the camera subpath, and joins it to the light subpath in every way.
    fn camera(&self, sample: &CameraSample, found: &mut Found<'s>, counters: &mut Counters) {
        let (scene, settings) = (self.scene(), &self.tracer.settings);
        let only_lights = settings.strategy == Strategy::Light;
        let mut path = Subpath::from_camera(scene, sample.ray, sample.lambda, &self.ways, &settings.depth);
        // One turn for each camera vertex: emission (s = 0), light sample (s = 1), connections (s ≥ 2), merging.
        loop {
            let mut emitted = Spectrum::ZERO;
            let arrival = path.arrive(scene, self.numbers, counters, |path, i, distance, sums| {
                emitted += self.emission(path, i, distance, sums);
            });
            found.own += self.run.developed(emitted, &path.lambda);
            let v = match arrival {
                Arrival::Vertex(v) => v,
                Arrival::Escaped => {
                    found.own += self.run.developed(self.sky(&path), &path.lambda);
                    return;
                }
                Arrival::Ended => return,
            };
            if only_lights || v.events >= self.most_events() {
                return;
            }
            if !v.scattering.bsdf.is_specular() {
                found.own += self.run.developed(self.light_sample(&v, counters), &v.lambda);
                for y in &found.vertices {
                    if y.events + v.events + 2 <= self.most_events() {
                        found.own += self.connection(&v, y, counters);
                    }
                }
                if let Some((photons, radius)) = self.photons {
                    found.own += self.merged(&v, photons, radius);
                }
            }
            if !path.scatter(scene, &v, self.numbers, &self.ways, &settings.depth) {
                return;
            }
        }
    }

    /// True if emission that the camera subpath meets here is hidden.
    fn is_hidden(&self, path: &Subpath) -> bool {
        path.events == 0 && self.tracer.settings.depth.hide_emitters
    }

    /// Light of a surface that the camera subpath met.
    fn emission(&self, path: &Subpath, i: &Interaction, distance: f32, sums: Sums) -> Spectrum {
        let scene = self.scene();
        if self.is_hidden(path) {
            return Spectrum::ZERO;
        }
        // Unweighted emission; camera rays that meet a light directly have no competing technique.
        let light = path.beta * nee::emission(scene, i, &None, &path.lambda);
        if path.events == 0 || light.is_black() {
            return light;
        }
        let Some(index) = scene.light(i) else { return light };
        let (n, wo) = (i.surface.n, i.wo);
        // Density of a light sample at the last vertex, per area of the light.
        let by_area = n.dot(wo).abs() / (distance * distance);
        let time = path.lambda.time;
        let density = |ctx| scene.lights().area_pdf(index, &ctx, (-wo, distance), n, time);
        let asked = path.context.map_or(0.0, |ctx| density(ctx) * by_area);
        light * self.met((index, time), asked, n, wo, sums)
    }

    /// Light of the environments in whose direction the camera subpath left the scene.
    fn sky(&self, path: &Subpath) -> Spectrum {
        let scene = self.scene();
        if self.is_hidden(path) {
            return Spectrum::ZERO;
        }
        let (p, w) = (path.ray.origin, path.ray.direction);
        let mut sum = Spectrum::ZERO;
        // Each environment has a weight of its own, in the measure of directions.
        for &index in &scene.lights().environments {
            let Light::Environment(e) = &scene.lights().lights[index as usize] else { continue };
            let light = path.beta * e.radiance(p, w, &path.lambda);
            if light.is_black() || path.events == 0 {
                sum += light;
                continue;
            }
            let asked = path.context.map_or(0.0, |ctx| scene.lights().environment_pdf(index, &ctx, w));
            sum += light * self.met((index, path.lambda.time), asked, -w, -w, path.sums());
        }
        sum
    }

    /// The weight of light that the camera subpath met at a moment, against the light sample and paths from the light.
    fn met(&self, (light, time): (u32, f32), asked: f32, n: Vec3, w: Vec3, sums: Sums) -> f32 {
        // w = 1 / (1 + p_sample² dVCM + p_emit² dVC).
        let emitted = self.tracer.emission.as_ref().map_or(0.0, |e| e.pdf(self.scene(), light, n, w, time));
        (1.0 / (1.0 + squared(asked) * sums.vcm + squared(emitted) * sums.vc)) as f32
    }

    /// Light straight from a light.
    fn light_sample(&self, v: &Vertex<'_>, counters: &mut Counters) -> Spectrum {
        let scene = self.scene();
        let lights = scene.lights();
        let at = |decision| dimension::at(v.events, decision);
        let (context, u) = (v.context(), self.numbers.one(at(dimension::LIGHT)));
        // Light and point as in path tracing.
        let Some((light, choice)) = lights.choose(&context, u) else { return Spectrum::ZERO };
        let u = self.numbers.two(at(dimension::LIGHT_POINT));
        let Some(s) = lights.sample(light, &context, u, &v.lambda, scene.textures()) else { return Spectrum::ZERO };
        let Some(e) = v.eval(scene, s.wi, Radiance) else { return Spectrum::ZERO };
        let kind = lights.lights[light as usize].kind();
        let pdf = s.pdf * choice;
        let at_light = v.i.surface.p + s.wi * s.distance.min(f32::MAX);
        let n = lights.normal_at(light, at_light, -s.wi, v.lambda.time);
        // The light sample's density in the measure of emission: by area at the light, but for parallel light.
        let cos_at_light = if kind.is_delta || kind.is_parallel { 1.0 } else { n.dot(s.wi).abs() };
        let asked = if kind.is_delta && !kind.is_parallel { pdf * s.distance * s.distance } else { pdf * cos_at_light };
        let emitted = self.tracer.emission.as_ref().map_or(0.0, |e| e.pdf(scene, light, n, -s.wi, v.lambda.time));
        // Ratios of the other techniques: met by scattering, and found by paths from the light.
        let by_scattering = if kind.is_delta { 0.0 } else { squared(e.pdf / pdf) };
        let by_light = squared(emitted * v.cos(s.wi) / asked)
            * (v.merge(&self.ways) + v.sums.vcm + v.sums.vc * squared(e.reverse));
        counters.rays += 1;
        if scene.occluded(&v.i.spawn_towards(s.wi, s.distance)) {
            return Spectrum::ZERO;
        }
        v.beta * e.value * s.radiance * ((1.0 / (1.0 + by_scattering + by_light)) as f32 / pdf)
    }

    /// A connection of a camera vertex and a light vertex.
    fn connection(&self, v: &Vertex<'_>, y: &Vertex<'_>, counters: &mut Counters) -> Vec3 {
        let scene = self.scene();
        // Geometry term 1/d²; the cosines are in the values of both ends.
        let to = y.i.surface.p - v.i.surface.p;
        let d2 = to.length_squared();
        let distance = d2.sqrt();
        if distance <= 0.0 {
            return Vec3::ZERO;
        }
        let w = to / distance;
        let (Some(at_v), Some(at_y)) = (v.eval(scene, w, Radiance), y.eval(scene, -w, Importance)) else {
            return Vec3::ZERO;
        };
        // β_v β_y f_v f_y |cos| |cos| / d².
        let light = v.beta * y.beta * at_v.value * at_y.value / d2;
        if light.is_black() {
            return Vec3::ZERO;
        }
        // Ratios of densities on one side of the connection: area density by the other end, times the sums there.
        let side = |from: &Scattered, to: &Vertex<'_>, back: &Scattered| {
            squared(from.pdf * to.cos(w) / d2)
                * (to.merge(&self.ways) + to.sums.vcm + to.sums.vc * squared(back.reverse))
        };
        let weight = 1.0 / (1.0 + side(&at_v, y, &at_y) + side(&at_y, v, &at_v));
        counters.rays += 1;
        if scene.occluded(&v.i.spawn_towards(w, distance)) {
            return Vec3::ZERO;
        }
        self.run.developed(light * weight as f32, common(&v.lambda, &y.lambda))
    }

    /// Light that photons near a camera vertex bring.
    fn merged(&self, v: &Vertex<'_>, photons: &Grid, radius: f32) -> Vec3 {
        let mut sum = Vec3::ZERO;
        // Kernel of merging: 1 / (π r² n) for n light paths.
        let (scale, merge) =
            (1.0 / (std::f32::consts::PI * radius * radius * self.ways.light_paths), v.merge(&self.ways));
        if merge == 0.0 {
            return sum;
        }
        // Photons on the same surface within the radius, up to the depth.
        photons.near(v.i.surface.p, radius, |photon| {
            if v.events + photon.events + 1 > self.most_events() || !photon.lies_on(&v.i) {
                return;
            }
            let Some(e) = v.eval(self.scene(), photon.wi, Radiance) else { return };
            let cos = v.cos(photon.wi);
            // Weight of merging against all connections.
            let by_light = photon.sums.vcm + photon.sums.vc * squared(e.pdf);
            let by_camera = v.sums.vcm + v.sums.vc * squared(e.reverse);
            let weight = 1.0 / (1.0 + (by_light + by_camera) / merge);
            let light = v.beta * photon.beta * e.value * (scale * weight as f32 / cos.max(1e-4));
            sum += self.run.developed(light, common(&v.lambda, &photon.lambda));
        });
        sum
    }
}

/// The wavelengths of both, which may have lost some on the way.
pub(super) fn common<'a>(a: &'a Wavelengths, b: &'a Wavelengths) -> &'a Wavelengths {
    if b.is_secondary_terminated() { b } else { a }
}

impl Tracer {
    /// One sample of the camera with a light subpath of its own: what connections bring.
    pub(super) fn connect(
        &self,
        run: &Run<'_>,
        sample: &CameraSample,
        numbers: &impl Numbers,
        counters: &mut Counters,
    ) -> (Vec3, Vec<Splat>) {
        let pair = Pair { tracer: self, run, ways: self.ways(run.scene, 0), numbers, photons: None };
        let mut found = Found::default();
        pair.light(sample.lambda, true, &mut found, counters);
        pair.camera(sample, &mut found, counters);
        (found.own, found.splats)
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
                    let pair = Pair { tracer: self, run, ways, numbers, photons: None };
                    let mut found = Found::default();
                    pair.light(shared.unwrap_or(sample.lambda), is_kept, &mut found, counters);
                    photons.extend(found.vertices.iter().map(|v| Photon::of(v, false)));
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
                    let pair = Pair { tracer: self, run, ways, numbers: &sample.sampler, photons };
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
