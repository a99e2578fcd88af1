//! Stochastic progressive photon mapping in its memoryless form: every pass sends photons of its own and gathers them
//! within a radius that shrinks from pass to pass (Hachisuka, Jensen 2009; Knaus, Zwicker 2011).

use super::{
    pair::common,
    photons::{Grid, Photon},
    radius::{self, Radii, Radius},
    subpath::{Arrival, Subpath, Ways},
    surface::Surface,
    vertex::{Place, Vertex, Within},
};
use crate::{Counters, Depth, MAX_PASSES, dimension, nee, support};
use std::sync::Arc;
use steradian_bsdf::TransportMode::Radiance;
use steradian_core::{Scene, film::PassFilm, light::emission::Emission, sampler::PixelSampler};
use steradian_engine::{Feature, Method, MethodKind, Pass, Passes, PathContext, Plan, Refusal, Run, Session, Support};
use steradian_math::{Spectrum, Vec3, spectra::Wavelengths};
use steradian_transport::{NoGuide, PathState, leaving};

/// Light paths and pixels of a piece of work.
const PIECE: usize = 256;

/// Most light paths of a pass, where their number is not given: the memory of photons is bounded by it.
const MOST: usize = 1 << 20;

/// Light paths of a pass: so many, or with 0 one for each pixel.
pub(super) fn paths(photons: u32, run: &Run<'_>) -> usize {
    let film = run.scene.film();
    match photons {
        0 => (film.width as usize * film.height as usize).min(MOST),
        n => n as usize,
    }
}

/// The settings.
#[derive(Clone, Copy, Debug)]
pub struct Sppm {
    /// Path depth: events of both subpaths count.
    pub depth: Depth,
    /// Radius within which photons are gathered in the first pass.
    pub radius: Radius,
    /// Light paths of a pass; 0 for one for each pixel, up to a million.
    pub photons: u32,
}

/// `sppm`.
pub const SPPM: MethodKind = MethodKind::new("sppm", |asked| {
    Ok(Arc::new(Sppm {
        depth: asked.depth(),
        radius: Radius::of(asked.options),
        photons: asked.options.count("photons"),
    }))
});

impl Method for Sppm {
    fn supports(&self, feature: Feature) -> Support {
        support::of_photons(feature)
    }

    fn session(&self, scene: Arc<Scene>, plan: Plan) -> Result<Box<dyn Session>, Refusal> {
        Ok(Box::new(Passes::new(scene, Progressive::new(*self), plan)))
    }

    fn bias_pair(&self) -> Option<[Arc<dyn Method>; 2]> {
        Some([Arc::new(Self { radius: self.radius.times(0.5), ..*self }), Arc::new(*self)])
    }
}

/// The method with what it prepared.
#[derive(Debug)]
pub(super) struct Progressive {
    settings: Sppm,
    emission: Option<Emission>,
    radii: Radii,
}

impl Progressive {
    pub fn new(settings: Sppm) -> Self {
        Self { settings, emission: None, radii: Radii::default() }
    }
}

/// Traces light paths and stores photons at their vertices that are not specular and that `keeps` accepts, in an order
/// that does not depend on threads.
pub(super) fn land(
    run: &Run<'_>,
    emission: &Emission,
    depth: &Depth,
    count: usize,
    seed: impl Fn(u32) -> (PixelSampler, Wavelengths) + Sync,
    keeps: impl Fn(&Vertex<'_>) -> bool + Sync,
) -> Option<(Vec<Photon>, Counters)> {
    // Nothing is weighed.
    let ways = Ways::connections(1.0, false);
    let (found, counters) = run.in_order(count.div_ceil(PIECE), |piece, counters| {
        let mut photons = Vec::new();
        for k in (piece * PIECE..count.min((piece + 1) * PIECE)).take_while(|_| !run.is_cancelled()) {
            let (sampler, lambda) = seed(k as u32);
            // One light path: photons at its vertices that are not specular, until roulette or the depth.
            let path = Subpath::from_light(run.scene, emission, &sampler, lambda, counters);
            let Some(mut path) = path else { continue };
            while let Arrival::Vertex(v) = path.arrive(run.scene, &sampler, counters, |_, _, _, _| ()) {
                if v.events >= depth.max {
                    break;
                }
                if !v.is_specular() && keeps(&v) {
                    photons.push(Photon::of(&v, path.is_specular));
                }
                if !path.scatter(run.scene, &v, &sampler, &ways, depth) {
                    break;
                }
            }
        }
        photons
    })?;
    Some((found.into_iter().flatten().collect(), counters))
}

/// Radiance towards the camera by the photons within a radius.
pub(super) fn gathered(v: &Vertex<'_>, photons: &Grid, radii: Radii, paths: f32, depth: &Depth, run: &Run<'_>) -> Vec3 {
    let mut sum = Vec3::ZERO;
    // Density estimate with a constant kernel: Σ β f / (π r² n), or in media Σ β f / (4/3 π r³ n).
    let radius = radii.at(v);
    let scale = radius::kernel(v, radius * radius) / paths;
    photons.near(v.p(), radius, |photon| {
        if v.events + photon.events < depth.max && photon.lies_on(v) {
            sum += brought(v, photon, scale, run);
        }
    });
    sum
}

/// Radiance that a photon stands for.
pub(super) fn brought(v: &Vertex<'_>, photon: &Photon, scale: f32, run: &Run<'_>) -> Vec3 {
    let Some(e) = v.eval(run.scene, photon.wi, Radiance) else { return Vec3::ZERO };
    // f without its cosine, since a photon's flux is per area already.
    let light = v.beta * photon.beta * e.value * (scale / v.cos(photon.wi).max(1e-4));
    run.developed(light, common(&v.lambda, &photon.lambda))
}

/// Light straight from lights at a vertex of a camera path: by a light sample and by scattering, weighted against each
/// other.
pub(super) fn direct(run: &Run<'_>, v: &Vertex<'_>, sampler: &PixelSampler, counters: &mut Counters) -> Vec3 {
    let Place::Surface(Surface { i, scattering, frame, .. }) = &v.place else {
        return direct_in_media(run, v, sampler, counters);
    };
    if run.scene.has_media() {
        return direct_in_media(run, v, sampler, counters);
    }
    let (scene, context, wo) = (run.scene, v.context(), frame.to_local(i.wo));
    let mut sum = Spectrum::ZERO;
    // Technique 1: a light sample, with its MIS weight.
    if let Some(s) = nee::sample_light(scene, &context, v.events, sampler, &v.lambda) {
        let light = nee::unoccluded(&s, wo, frame, scattering);
        if !light.is_black() {
            counters.rays += 1;
            if !scene.occluded(&i.spawn_towards(s.wi, s.distance)) {
                sum += light;
            }
        }
    }
    let at = |decision| dimension::at(v.events, decision);
    let (u, u2) = (sampler.get_1d(at(dimension::LOBE)), sampler.get_2d(at(dimension::DIRECTION)));
    // Technique 2: a direction by scattering, and the light that it meets, with its MIS weight.
    if let Some(s) = scattering.sample(wo, u, u2, Radiance).filter(|s| !s.lobe.is_specular()) {
        let origin = Some((context, s.pdf));
        let mut ray = i.spawn(frame.to_world(s.wi));
        for _ in 0..MAX_PASSES {
            counters.rays += 1;
            let Some(hit) = scene.intersect(&ray) else {
                sum += s.weight * nee::background(scene, ray.origin, ray.direction, &origin, &v.lambda);
                break;
            };
            let i = scene.interaction_of_light(&ray, &hit);
            sum += s.weight * nee::emission(scene, &i, &origin, &v.lambda);
            if !scene.geometries()[i.geometry as usize].is_interface {
                break;
            }
            ray = i.rest(&ray);
        }
    }
    run.developed(v.beta * sum, &v.lambda)
}

/// As [`direct`], through media and thin panes: a path of one event.
fn direct_in_media(run: &Run<'_>, v: &Vertex<'_>, sampler: &PixelSampler, counters: &mut Counters) -> Vec3 {
    let vertex = match &v.place {
        Place::Surface(Surface { i, scattering, frame, .. }) => {
            steradian_transport::Vertex::Surface { i: *i, scattering: *scattering, frame: *frame, medium: v.medium }
        }
        Place::Medium(Within { p, wo, time, medium }) => {
            let Some(index) = v.medium else { return Vec3::ZERO };
            steradian_transport::Vertex::Medium { p: *p, wo: *wo, time: *time, scattering: medium, medium: index }
        }
    };
    let mut lambda = v.lambda;
    let context = &mut PathContext { scene: run.scene, sampler, lambda: &mut lambda, counters };
    let path = PathState { events: v.events, medium: v.medium, ..PathState::NONE };
    let depth = Depth { max: v.events + 1, roulette_after: u32::MAX, hide_emitters: false };
    let light = leaving::<true, Spectrum>(&vertex, path, depth, None::<&NoGuide>, context, Spectrum::ZERO);
    run.developed(v.beta * light, &lambda)
}

impl Pass for Progressive {
    fn prepare(&mut self, run: &Run<'_>) -> Option<()> {
        self.emission = Emission::new(run.scene);
        self.radii = Radii::of_scene(self.settings.radius, run.scene);
        Some(())
    }

    fn pass(&self, run: &Run<'_>, number: u32, film: &mut PassFilm<'_>) -> Option<Counters> {
        let (scene, depth) = (run.scene, &self.settings.depth);
        let lambda = super::pass_wavelengths(run, number);
        let (width, count) = (scene.film().width, paths(self.settings.photons, run));
        let mut total = Counters::default();
        // Photon pass: indirect photons only, since direct light is sampled.
        let photons = match &self.emission {
            None => Vec::new(),
            Some(emission) => {
                let seed = |k: u32| (run.sampler.pixel(k % width, k / width, number), lambda);
                let (photons, counters) = land(run, emission, depth, count, seed, |v| v.events > 0)?;
                total += &counters;
                photons
            }
        };
        // Camera pass: every pixel gathers within the radius of this pass.
        let radii = self.radii.of_pass(number);
        let landed =
            Landed { number, lambda, photons: Grid::new(photons, radii.largest(scene)), radii, paths: count as f32 };
        let crop = film.crop();
        let (rows, counters) = run.in_order(crop.height() as usize, |row, counters| {
            let pixel = |x| {
                counters.samples += 1;
                self.pixel(run, x, crop.y0 + row as u32, &landed, counters)
            };
            (crop.x0..crop.x1).take_while(|_| !run.is_cancelled()).map(pixel).collect::<Vec<_>>()
        })?;
        total += &counters;
        film.add_rows(&rows);
        Some(total)
    }
}

/// The photons of a pass.
struct Landed {
    /// Number of the pass.
    number: u32,
    lambda: Wavelengths,
    photons: Grid,
    radii: Radii,
    /// Light paths that were sent.
    paths: f32,
}

impl Progressive {
    /// A camera path: through what is specular to the first surface that is not, where photons are gathered. Photons do
    /// not pass curves; where there are some, paths go on to them.
    fn pixel(&self, run: &Run<'_>, x: u32, y: u32, landed: &Landed, counters: &mut Counters) -> Vec3 {
        let (scene, depth) = (run.scene, &self.settings.depth);
        let sample = run.camera_sample(x, y, landed.number);
        let (ways, sampler) = (Ways::connections(landed.paths, false), &sample.sampler);
        let mut path = Subpath::from_camera(scene, sample.ray, landed.lambda, &ways, depth);
        let mut sum = Vec3::ZERO;
        // Whether photons brought all light that comes without passing a curve.
        let mut is_gathered = false;
        loop {
            // The next vertex; lights seen by way of specular events count directly.
            let (v, seen) = next(scene, &mut path, sampler, depth, counters);
            if !is_gathered && path.context.is_none() {
                sum += run.developed(seen, &path.lambda);
            }
            let Some(v) = v else { break };
            let is_curve = v.is_on_curve();
            is_gathered &= !is_curve;
            // Direct light by sampling, indirect light by photons.
            if !v.is_specular() && !is_gathered {
                sum += direct(run, &v, sampler, counters);
                if !is_curve {
                    sum += gathered(&v, &landed.photons, landed.radii, landed.paths, depth, run);
                }
            }
            if !path.scatter(scene, &v, sampler, &ways, depth) {
                break;
            }
            // Of surfaces that have a specular lobe too, that lobe goes on.
            is_gathered |= !is_curve && path.context.is_some();
            if is_gathered && !scene.has_curves() {
                break;
            }
        }
        sum * sample.weight
    }
}

/// The next vertex of a camera path all of whose events were specular, and the light met on the way.
pub(super) fn next<'s>(
    scene: &'s Scene,
    path: &mut Subpath,
    sampler: &PixelSampler,
    depth: &Depth,
    counters: &mut Counters,
) -> (Option<Vertex<'s>>, Spectrum) {
    let mut seen = Spectrum::ZERO;
    let is_hidden = path.events == 0 && depth.hide_emitters;
    let arrival = path.arrive(scene, sampler, counters, |path, i, _, _| {
        if !is_hidden {
            seen += path.beta * nee::emission(scene, i, &None, &path.lambda);
        }
    });
    match arrival {
        Arrival::Vertex(v) if v.events < depth.max => (Some(v), seen),
        Arrival::Escaped if !is_hidden => {
            let sky = nee::behind(scene, &path.ray, path.events, &None, &path.lambda);
            (None, seen + path.beta * sky)
        }
        _ => (None, seen),
    }
}
