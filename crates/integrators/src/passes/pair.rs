//! A light subpath and a camera subpath, joined in every way (Veach 1997, chapter 10): emission that the camera subpath
//! meets, light samples, connections of vertices, light vertices that the camera sees, and merging.

use super::{
    bidirectional::{Strategy, Tracer},
    passage,
    photons::Grid,
    subpath::{Arrival, LIGHT_EVENTS, Numbers, Subpath, Sums, Ways, squared},
    vertex::{Scattered, Vertex},
};
use crate::{Counters, dimension, nee};
use steradian_bsdf::TransportMode::{Importance, Radiance};
use steradian_core::{Scene, film::Splat, light::Light, scene::Interaction};
use steradian_engine::{CameraSample, Run};
use steradian_math::{Spectrum, Vec3, color::luminance, spectra::Wavelengths};

/// One of the ways to find paths with some number of scattering events. With n events there are n + 2: the camera
/// subpath meets a light (0 vertices of the light's side), a light sample (1), connections (2 to n), and a light vertex
/// that the camera sees (n + 1).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Technique {
    /// Scattering events of the whole path.
    pub events: u32,
    /// Vertices of the light's side: s of Veach 1997.
    pub light: u32,
}

impl Technique {
    /// True if a light vertex is joined to the camera itself.
    pub fn is_to_camera(self) -> bool {
        self.light > self.events
    }
}

/// Techniques by which a pair is joined.
#[derive(Clone, Copy, Debug)]
pub(super) enum Joins {
    /// All, up to the depth.
    All,
    /// All, with a list of what each brings.
    Listed,
    /// One alone. Subpaths end where it needs no more of them.
    One(Technique),
}

/// Contributions of a pair of subpaths.
#[derive(Debug, Default)]
pub(super) struct Found<'s> {
    /// To the camera ray's own place.
    pub own: Vec3,
    /// To others.
    pub splats: Vec<Splat>,
    /// The light subpath.
    pub vertices: Vec<Vertex<'s>>,
    /// Luminance that techniques bring, of [`Joins::Listed`]; a technique may be there several times.
    pub parts: Vec<(Technique, f32)>,
}

/// A pair of subpaths in the making.
pub(super) struct Pair<'a, 's, N> {
    pub tracer: &'a Tracer,
    pub run: &'a Run<'s>,
    pub ways: Ways,
    pub numbers: &'a N,
    pub photons: Option<(&'a Grid, f32)>,
    pub joins: Joins,
}

impl<'s, N: Numbers> Pair<'_, 's, N> {
    fn scene(&self) -> &'s Scene {
        self.run.scene
    }

    fn most_events(&self) -> u32 {
        self.tracer.settings.depth.max
    }

    /// True if paths with so many events and vertices of the light's side are made.
    fn makes(&self, events: u32, light: u32) -> bool {
        match self.joins {
            Joins::One(technique) => technique == Technique { events, light },
            _ => events <= self.most_events(),
        }
    }

    /// The most events of a camera vertex and of a light vertex that a join needs.
    fn last_events(&self) -> (u32, u32) {
        match self.joins {
            Joins::One(t) => (t.events.saturating_sub(t.light), t.light.saturating_sub(2)),
            _ => (u32::MAX, u32::MAX),
        }
    }

    /// Adds a technique's light to the camera ray's place.
    fn add(&self, found: &mut Found<'_>, (events, light): (u32, u32), rgb: Vec3) {
        found.own += rgb;
        self.list(found, (events, light), rgb);
    }

    fn list(&self, found: &mut Found<'_>, (events, light): (u32, u32), rgb: Vec3) {
        if matches!(self.joins, Joins::Listed) && rgb != Vec3::ZERO {
            found.parts.push((Technique { events, light }, luminance(rgb.abs())));
        }
    }

    /// Follows the light subpath: keeps its vertices, and connects each to the camera.
    pub fn light(&self, lambda: Wavelengths, to_camera: bool, found: &mut Found<'s>, counters: &mut Counters) {
        let (scene, depth) = (self.scene(), &self.tracer.settings.depth);
        let Some(emission) = &self.tracer.emission else { return };
        let path = Subpath::from_light(scene, emission, self.numbers, lambda, counters);
        let Some(mut path) = path else { return };
        // Vertex by vertex: connection to the camera (t = 1), storage for connections and merging, and the next
        // direction.
        while let Arrival::Vertex(v) = path.arrive(scene, self.numbers, counters, |_, _, _, _| ()) {
            if v.events >= self.most_events() {
                return;
            }
            if !v.is_specular() {
                if to_camera && self.ways.to_camera && self.makes(v.events + 1, v.events + 2) {
                    self.to_camera(&v, found, counters);
                }
                found.vertices.push(v);
            }
            if !path.scatter(scene, &v, self.numbers, &self.ways, depth) || path.events > self.last_events().1 {
                return;
            }
        }
    }

    /// Connects a light vertex to the camera.
    fn to_camera(&self, v: &Vertex<'_>, found: &mut Found<'_>, counters: &mut Counters) {
        let scene = self.scene();
        // A point of the lens, and the pixel from which it sees the vertex.
        let lens = self.numbers.two(dimension::at(LIGHT_EVENTS + v.events, dimension::BRANCHES));
        let Some(seen) = scene.camera().receive(scene.film(), v.p(), lens) else { return };
        let Some(e) = v.eval(scene, seen.to_camera, Importance) else { return };
        // MIS weight of light tracing: 1 / (1 + ratios of all other techniques), from the carried sums.
        let weight = match self.tracer.settings.strategy {
            Strategy::Light => 1.0,
            _ => {
                let camera = squared(seen.density * v.cos(seen.to_camera) / self.ways.light_paths);
                1.0 / (1.0 + camera * (v.merge(&self.ways) + v.sums.vcm + v.sums.vc * squared(e.reverse)))
            }
        };
        let number = || self.numbers.one(dimension::at(LIGHT_EVENTS + v.events, dimension::FLIGHT));
        let (way, around) = ((seen.to_camera, seen.distance), (scene, &self.tracer.settings.depth));
        let passed = passage::to_camera(v, way, number, around, counters);
        if passed.is_black() {
            return;
        }
        // β f Tr We / n, splatted where the camera sees the vertex.
        let light = v.beta * e.value * passed * (seen.density / self.ways.light_paths * weight as f32);
        let rgb = self.run.developed(light, &v.lambda);
        self.list(found, (v.events + 1, v.events + 2), rgb);
        found.splats.push(Splat { at: seen.at, rgb });
    }

    /// Follows the camera subpath, and joins it to the light subpath in every way.
    pub fn camera(&self, sample: &CameraSample, found: &mut Found<'s>, counters: &mut Counters) {
        let (scene, settings) = (self.scene(), &self.tracer.settings);
        let only_lights = settings.strategy == Strategy::Light;
        let mut path = Subpath::from_camera(scene, sample.ray, sample.lambda, &self.ways, &settings.depth);
        // One turn for each camera vertex: emission (s = 0), light sample (s = 1), connections (s ≥ 2), merging.
        loop {
            let (mut emitted, meets) = (Spectrum::ZERO, self.makes(path.events, 0));
            let arrival = path.arrive(scene, self.numbers, counters, |path, i, distance, sums| {
                if meets {
                    emitted += self.emission(path, i, distance, sums);
                }
            });
            let glow = std::mem::take(&mut path.glow);
            if meets {
                self.add(found, (path.events, 0), self.run.developed(emitted + glow, &path.lambda));
            }
            let v = match arrival {
                Arrival::Vertex(v) => v,
                Arrival::Escaped if meets => {
                    return self.add(found, (path.events, 0), self.run.developed(self.sky(&path), &path.lambda));
                }
                Arrival::Escaped => return,
                Arrival::Ended => return,
            };
            // At the end of the subpath emission alone counts, also behind panes.
            if only_lights || v.events >= self.most_events() {
                match path.pass_pane(scene, &v) {
                    true => continue,
                    false => return,
                }
            }
            if !v.is_specular() {
                if self.makes(v.events + 1, 1) {
                    let light = self.light_sample(&v, counters);
                    self.add(found, (v.events + 1, 1), self.run.developed(light, &v.lambda));
                }
                for k in 0..found.vertices.len() {
                    let y = &found.vertices[k];
                    let technique = (v.events + y.events + 2, y.events + 2);
                    if self.makes(technique.0, technique.1) {
                        let rgb = self.connection(&v, y, counters);
                        self.add(found, technique, rgb);
                    }
                }
                if let Some((photons, radius)) = self.photons {
                    found.own += self.merged(&v, photons, radius);
                }
            }
            if !path.scatter(scene, &v, self.numbers, &self.ways, &settings.depth) || path.events > self.last_events().0
            {
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
        light * self.met((index, time), asked, (i.surface.p, n), wo, sums)
    }

    /// Light of the environments in whose direction the camera subpath left the scene.
    fn sky(&self, path: &Subpath) -> Spectrum {
        let scene = self.scene();
        if self.is_hidden(path) {
            return Spectrum::ZERO;
        }
        if path.events == 0 {
            return path.beta * nee::behind(scene, &path.ray, 0, &None, &path.lambda);
        }
        let (p, w) = (path.ray.origin, path.ray.direction);
        let mut sum = Spectrum::ZERO;
        // Each environment has a weight of its own, in the measure of directions.
        for &index in &scene.lights().environments {
            let Light::Environment(e) = &scene.lights().lights[index as usize] else { continue };
            let light = path.beta * e.radiance(p, w, &path.lambda);
            if light.is_black() {
                continue;
            }
            let asked = path.context.map_or(0.0, |ctx| scene.lights().environment_pdf(index, &ctx, w));
            sum += light * self.met((index, path.lambda.time), asked, (p, -w), -w, path.sums());
        }
        sum
    }

    /// The weight of light that the camera subpath met at a moment, at a point with a normal, against the light sample
    /// and paths from the light.
    fn met(&self, (light, time): (u32, f32), asked: f32, at: (Vec3, Vec3), w: Vec3, sums: Sums) -> f32 {
        // w = 1 / (1 + p_sample² dVCM + p_emit² dVC).
        let emitted = self.tracer.emission.as_ref().map_or(0.0, |e| e.pdf(self.scene(), light, at, w, time));
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
        let at_light = v.p() + s.wi * s.distance.min(f32::MAX);
        let n = lights.normal_at(light, at_light, -s.wi, v.lambda.time);
        // The light sample's density in the measure of emission: by area at the light, but for parallel light.
        let cos_at_light = if kind.is_delta || kind.is_parallel { 1.0 } else { n.dot(s.wi).abs() };
        let asked = if kind.is_delta && !kind.is_parallel { pdf * s.distance * s.distance } else { pdf * cos_at_light };
        let at = (if kind.is_parallel { v.p() } else { at_light }, n);
        let emitted = self.tracer.emission.as_ref().map_or(0.0, |e| e.pdf(scene, light, at, -s.wi, v.lambda.time));
        // Ratios of the other techniques: met by scattering, and found by paths from the light.
        let by_scattering = if kind.is_delta { 0.0 } else { squared(e.pdf / pdf) };
        let by_light = squared(emitted * v.cos(s.wi) / asked)
            * (v.merge(&self.ways) + v.sums.vcm + v.sums.vc * squared(e.reverse));
        let way = (s.wi, s.distance);
        let passed = passage::between(v, way, || self.shadow_number(v), (scene, &v.lambda), counters);
        if passed.is_black() {
            return passed;
        }
        v.beta * e.value * s.radiance * passed * ((1.0 / (1.0 + by_scattering + by_light)) as f32 / pdf)
    }

    /// A connection of a camera vertex and a light vertex.
    fn connection(&self, v: &Vertex<'_>, y: &Vertex<'_>, counters: &mut Counters) -> Vec3 {
        let scene = self.scene();
        // Geometry term 1/d²; the cosines are in the values of both ends.
        let to = y.p() - v.p();
        let d2 = to.length_squared();
        let distance = d2.sqrt();
        if distance <= 0.0 {
            return Vec3::ZERO;
        }
        let w = to / distance;
        let (Some(at_v), Some(at_y)) = (v.eval(scene, w, Radiance), y.eval(scene, -w, Importance)) else {
            return Vec3::ZERO;
        };
        // β_v β_y f_v f_y |cos| |cos| / d²; the transmittance follows below, since it takes a ray.
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
        let lambda = common(&v.lambda, &y.lambda);
        let passed = passage::between(v, (w, distance), || self.shadow_number(v), (scene, lambda), counters);
        if passed.is_black() {
            return Vec3::ZERO;
        }
        self.run.developed(light * passed * weight as f32, lambda)
    }

    /// A number for the ways from a camera vertex through media that vary.
    fn shadow_number(&self, v: &Vertex<'_>) -> f32 {
        self.numbers.one(dimension::at(v.events, dimension::FLIGHT))
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
        photons.near(v.p(), radius, |photon| {
            if v.events + photon.events + 1 > self.most_events() || !photon.lies_on(v) {
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
