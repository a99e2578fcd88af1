//! Photon mapping with two maps and a final gather (Jensen 1996, "Global Illumination using Photon Maps"): direct light
//! by light samples, light that mirrors and glass focused by the map of caustics, all other by one bounce on to the
//! global map. Maps are made anew for each pass, with radii that shrink from pass to pass, so that the mean over passes
//! converges (Knaus, Zwicker 2011).

use super::{
    photons::{Grid, Photon},
    radius::{self, Radii, Radius},
    sppm::{brought, direct, gathered, land, next, paths},
    subpath::{Subpath, Ways},
    vertex::Vertex,
};
use crate::{Counters, Depth, support};
use std::sync::Arc;
use steradian_core::{Scene, film::PassFilm, light::emission::Emission, sampler::PixelSampler};
use steradian_engine::{Feature, Method, MethodKind, Pass, Passes, Plan, Refusal, Run, Session, Support};
use steradian_math::Vec3;

/// The settings.
#[derive(Clone, Copy, Debug)]
pub struct PhotonMap {
    /// Path depth: events of both subpaths count.
    pub depth: Depth,
    /// The largest distance of a photon that counts, in the first pass.
    pub radius: Radius,
    /// Light paths of a pass; 0 for one for each pixel, up to a million.
    pub photons: u32,
    /// Photons that an estimate takes, the nearest ones; 0 for all within the radius.
    pub nearest: u32,
    /// Enables the final gather: indirect light is gathered over a bounce, else read from the global map where it is
    /// seen.
    pub gather: bool,
}

/// `photon`.
pub const PHOTON: MethodKind = MethodKind::new("photon", |asked| {
    Ok(Arc::new(PhotonMap {
        depth: asked.depth(),
        radius: Radius::of(asked.options),
        photons: asked.options.count("photons"),
        nearest: asked.options.count("nearest"),
        gather: asked.options.flag("gather"),
    }))
});

impl Method for PhotonMap {
    fn supports(&self, feature: Feature) -> Support {
        support::of_photons(feature)
    }

    fn session(&self, scene: Arc<Scene>, plan: Plan) -> Result<Box<dyn Session>, Refusal> {
        Ok(Box::new(Passes::new(scene, Mapped::new(*self), plan)))
    }

    fn bias_pair(&self) -> Option<[Arc<dyn Method>; 2]> {
        Some([Arc::new(Self { radius: self.radius.times(0.5), ..*self }), Arc::new(*self)])
    }
}

/// The method with what it prepared.
#[derive(Debug)]
pub(super) struct Mapped {
    settings: PhotonMap,
    radii: Radii,
    emission: Option<Emission>,
}

/// The maps of a pass.
struct Maps {
    caustics: Grid,
    global: Grid,
    radii: Radii,
    number: u32,
}

impl Mapped {
    pub fn new(settings: PhotonMap) -> Self {
        Self { settings, radii: Radii::default(), emission: None }
    }

    /// Sends the photons of a pass.
    fn maps(&self, run: &Run<'_>, number: u32) -> Option<(Maps, Counters)> {
        let mut found = (Vec::new(), Counters::default());
        // Photons at every vertex that is not specular, those of direct light among them.
        if let Some(emission) = &self.emission {
            let lambda = super::pass_wavelengths(run, number);
            let seed = |k: u32| (run.sampler.pixel(k & 0xffff, (k >> 16) + 0x1_0000, number), lambda);
            found = land(run, emission, &self.settings.depth, paths(self.settings.photons, run), seed, |_| true)?;
        }
        let (photons, counters) = found;
        // Two maps: caustics, whose paths were specular from the light on, and the global one.
        let focused = photons.iter().filter(|p| p.is_focused).copied().collect();
        // Where photons are not gathered over a bounce, direct and focused light is not read from the global map.
        let counts = |p: &&Photon| self.settings.gather || (p.events > 0 && !p.is_focused);
        let global = photons.iter().filter(counts).copied().collect();
        let radii = self.radii.of_pass(number);
        let largest = radii.largest(run.scene);
        let (caustics, global) = (Grid::new(focused, largest), Grid::new(global, largest));
        Some((Maps { caustics, global, radii, number }, counters))
    }

    /// Radiance by a map.
    fn estimate(&self, v: &Vertex<'_>, map: &Grid, radii: Radii, run: &Run<'_>) -> Vec3 {
        let (sent, depth) = (paths(self.settings.photons, run) as f32, &self.settings.depth);
        if self.settings.nearest == 0 {
            return gathered(v, map, radii, sent, depth, run);
        }
        // The k nearest photons on the surface: a density estimate with the radius of the next one.
        let radius = radii.at(v);
        let mut near: Vec<(f32, Photon)> = Vec::new();
        map.near(v.p(), radius, |photon| {
            if v.events + photon.events < depth.max && photon.lies_on(v) {
                near.push(((photon.p - v.p()).length_squared(), *photon));
            }
        });
        let k = self.settings.nearest as usize;
        let mut square = radius * radius;
        if near.len() > k {
            // The last of them tells the radius, and counts no more (k − 1 photons within it have the right mean).
            near.select_nth_unstable_by(k, |a, b| a.0.total_cmp(&b.0));
            square = near[k].0;
            near.truncate(k);
        }
        let scale = radius::kernel(v, square) / sent;
        // In an order that is the same for equal sets of photons.
        near.iter().map(|(_, photon)| brought(v, photon, scale, run)).sum()
    }

    fn pixel(&self, run: &Run<'_>, maps: &Maps, x: u32, y: u32, counters: &mut Counters) -> Vec3 {
        let (scene, depth) = (run.scene, &self.settings.depth);
        let sample = run.camera_sample(x, y, maps.number);
        let (ways, sampler) = (Ways::connections(1.0, false), &sample.sampler);
        let lambda = super::pass_wavelengths(run, maps.number);
        let mut path = Subpath::from_camera(scene, sample.ray, lambda, &ways, depth);
        let (mut sum, mut stage) = (Vec3::ZERO, Stage::Open);
        // Specular vertices are followed; at the first other one light is looked up, and with a final gather once more
        // behind it.
        loop {
            let (v, seen) = next(scene, &mut path, sampler, depth, counters);
            if path.context.is_none() && matches!(stage, Stage::Open | Stage::PastCurve) {
                sum += run.developed(seen, &path.lambda);
            }
            let Some(v) = v else { break };
            let is_curve = v.is_on_curve();
            if is_curve {
                sum += direct(run, &v, sampler, counters);
            } else if !v.is_specular() {
                // Direct light, caustics, and what the global map knows where no gather follows.
                sum += match stage {
                    Stage::Open => self.lit(run, &v, maps, sampler, counters),
                    Stage::Bounce | Stage::PastCurve => self.estimate(&v, &maps.global, maps.radii, run),
                    Stage::Gathered => Vec3::ZERO,
                };
            }
            if !path.scatter(scene, &v, sampler, &ways, depth) {
                break;
            }
            // Next stage by the event and the final gather.
            stage = match (is_curve, self.settings.gather) {
                (true, true) => Stage::PastCurve,
                (true, false) => Stage::Open,
                // Of surfaces that have a specular lobe too, that lobe goes on.
                _ if path.context.is_none() => stage,
                (false, true) if stage == Stage::Open => Stage::Bounce,
                (false, _) => Stage::Gathered,
            };
            if stage == Stage::Gathered && !scene.has_curves() {
                break;
            }
        }
        sum * sample.weight
    }

    /// Light of a surface that is seen, but for what a bounce brings.
    fn lit(&self, run: &Run<'_>, v: &Vertex<'_>, maps: &Maps, sampler: &PixelSampler, counters: &mut Counters) -> Vec3 {
        let focused = self.estimate(v, &maps.caustics, maps.radii, run);
        let direct = direct(run, v, sampler, counters);
        if self.settings.gather {
            return direct + focused;
        }
        direct + focused + self.estimate(v, &maps.global, maps.radii, run)
    }
}

/// Light that is still to be found along a camera path. Photons do not pass curves that face the ray; where there are
/// some, paths go on to them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    /// All light.
    Open,
    /// Light that leaves the next surface that is not specular: the global map has it. Light straight from lights, also
    /// by mirrors, was found where the bounce began.
    Bounce,
    /// Light of a bounce, for paths at mirrors.
    PastCurve,
    /// Only light that passes a curve.
    Gathered,
}

impl Pass for Mapped {
    fn prepare(&mut self, run: &Run<'_>) -> Option<()> {
        self.radii = Radii::of_scene(self.settings.radius, run.scene);
        self.emission = Emission::new(run.scene);
        Some(())
    }

    fn pass(&self, run: &Run<'_>, number: u32, film: &mut PassFilm<'_>) -> Option<Counters> {
        let (maps, mut total) = self.maps(run, number)?;
        let crop = film.crop();
        let (rows, counters) = run.in_order(crop.height() as usize, |row, counters| {
            let pixel = |x| {
                counters.samples += 1;
                self.pixel(run, &maps, x, crop.y0 + row as u32, counters)
            };
            (crop.x0..crop.x1).take_while(|_| !run.is_cancelled()).map(pixel).collect::<Vec<_>>()
        })?;
        total += &counters;
        film.add_rows(&rows);
        Some(total)
    }
}
