//! From where light enters a surface to where it leaves the same object: by the profile of diffusion of the material,
//! along rays through the surface near by (King, Kulla, Conty, Fajardo 2013, "BSSRDF Importance Sampling"), or by a
//! walk at random through the medium below.
//!
//! A material `subsurface` has a lobe of its own (`Lobe::SUBSURFACE`, `steradian_bsdf::subsurface`). Where a path draws
//! it, `PathState::emerge` finds the point at which the light leaves, and the path goes on from a vertex that scatters
//! by `Emergence`. Scenes with subsurface or fluorescent materials are followed path by path, without waves, sharing
//! and photons (`Scene::needs_scalar_path_tracer`); the film sees the wavelengths with which a path began. Methods that do
//! not follow such paths refuse the scene, or render a local approximation (`Scene::with_local_scattering`).

use crate::{flight::lanes, live_max, state::PathState, vertex::Vertex};
use steradian_bsdf::{
    Bsdf, BsdfSample,
    subsurface::{Emergence, Profile},
};
use steradian_core::{
    Scene,
    material::{Below, Scattering},
    medium::transmittance,
    scene::Interaction,
};
use steradian_engine::{PathContext, dimension};
use steradian_math::{
    Frame, Ray, Spectrum, Vec2, Vec3,
    hash::{HashRng, combine64},
    warp,
};

/// By how much the count of events grows where a path goes below a surface.
pub const EVENTS_BELOW: u32 = 2;
/// Most events of a walk.
const MOST_STEPS: u32 = 1 << 14;
/// Events of a walk before roulette.
const STEPS_BEFORE_ROULETTE: u32 = 16;
/// Surfaces that a ray through the neighbourhood passes at most.
const MOST_CROSSINGS: u32 = 256;

/// A point of an object's surface, with its outward normals.
struct ExitPoint {
    i: Interaction,
    /// The shading normal, outwards.
    ns: Vec3,
}

/// The object on whose surface light enters and leaves.
struct Object<'s> {
    scene: &'s Scene,
    instance: u32,
    material: u32,
    /// True if normals point inwards.
    is_inside_out: bool,
}

impl Object<'_> {
    /// The surface at a hit of a ray, if it is the object's.
    fn exit(&self, i: Interaction) -> Option<ExitPoint> {
        let geometry = &self.scene.geometries()[i.geometry as usize];
        if i.id.instance != self.instance || geometry.material != self.material {
            return None;
        }
        Some(ExitPoint { ns: if self.is_inside_out { -i.surface.ns } else { i.surface.ns }, i })
    }
}

/// A walk under way: what it carries, and the densities with which each lane would have drawn it. One lane draws all of
/// its flights.
struct Way<'a> {
    below: &'a Below<'a>,
    lanes: usize,
    lane: usize,
    value: Spectrum,
    density: Spectrum,
}

impl<'a> Way<'a> {
    fn new(below: &'a Below<'a>, lanes: usize, numbers: &mut HashRng) -> Self {
        // One lane, drawn evenly, draws all flights of the walk.
        let lane = ((numbers.next_f32() * lanes as f32) as usize).min(lanes - 1);
        Self { below, lanes, lane, value: Spectrum::ONE, density: Spectrum::ONE }
    }

    /// Goes on by a free flight; where it ends, if before the distance.
    fn fly(&mut self, distance: f32, u: f32) -> Option<f32> {
        // t = −ln(1 − u)/σt of that lane.
        let rate = self.below.sigma_t[self.lane];
        let t = if rate > 0.0 { warp::exponential(u, rate) } else { f32::INFINITY };
        // Every lane has value and density of its own: σs Tr and σt Tr to scatter, Tr to reach the surface.
        let passed = transmittance(self.below.sigma_t, t.min(distance));
        let scatters = t < distance;
        // Only ratios count: numbers are kept near one.
        let density = if scatters { self.density * passed * self.below.sigma_t } else { self.density * passed };
        let value = if scatters { passed * self.below.sigma_t * self.below.albedo } else { passed };
        let most = (0..self.lanes).map(|lane| density[lane]).fold(f32::MIN_POSITIVE, f32::max);
        (self.density, self.value) = (density / most, self.value * value / most);
        scatters.then_some(t)
    }

    fn weight(&self) -> Spectrum {
        // Single-sample MIS over lanes: value over the mean density.
        let mean = (0..self.lanes).map(|lane| self.density[lane]).sum::<f32>() / self.lanes as f32;
        // Lanes that carry nothing are no part of it.
        Spectrum::new(std::array::from_fn(|lane| if lane < self.lanes { self.value[lane] / mean } else { 0.0 }))
    }
}

impl PathState {
    /// Takes a path that enters a surface to where it leaves; `None` where it is lost below. Its count of events grows
    /// by [`EVENTS_BELOW`].
    pub fn emerge<'s>(
        &mut self,
        v: &Vertex<'s>,
        s: &BsdfSample,
        context: &mut PathContext<'s, '_>,
    ) -> Option<Vertex<'s>> {
        let Vertex::Surface { i, scattering, frame, medium } = v else { return None };
        let (scene, substance) = (context.scene, scattering.below?);
        // The path enters: the weight of the lobe, one event, and no differential that could be followed below.
        self.beta *= s.weight;
        self.events += 1;
        self.lights = 1;
        self.differential = None;
        // Light leaves by the surface of the same instance and material; the side that the viewer is on is outside.
        let object = Object {
            scene,
            instance: i.id.instance,
            material: scene.geometries()[i.geometry as usize].material,
            is_inside_out: i.surface.ns.dot(i.wo) < 0.0,
        };
        // Coefficients of the medium below, from the textures at the point of entry.
        let below = substance.below(scene.textures(), &scene.texture_context(i), context.lambda);
        // Exit point: by the diffusion profile of the material, if it has one, else by a random walk.
        let exit = match below.table {
            Some(table) => {
                let profile = Profile::new(table, below.sigma_t, below.albedo, lanes(scene, context.lambda));
                self.probe(&object, &profile, i, frame, context)?
            }
            None => self.walk(&object, &below, (substance.g, &substance.within), i, context)?,
        };
        // Where it leaves other numbers are drawn than on the way there.
        self.events += 1;
        // At the exit the path scatters by the emergence model, as seen along the outward normal.
        let mut i = exit.i;
        i.wo = exit.ns;
        let scattering = Scattering::plain(Bsdf::Emergence(substance.emergence));
        Some(Vertex::Surface { i, scattering, frame: Frame::from_z(exit.ns), medium: *medium })
    }

    /// Random numbers for what happens below.
    fn numbers(&self, context: &PathContext<'_, '_>) -> HashRng {
        let u = context.sampler.get_2d(dimension::at(self.events, dimension::DIRECTION));
        let v = context.sampler.get_1d(dimension::at(self.events, dimension::LANE));
        let seed = [u.x, u.y, v].iter().fold(u64::from(self.events), |seed, x| combine64(seed, x.to_bits().into()));
        HashRng::new(seed)
    }

    /// A point of the object at a distance that the profile draws, found along a ray through a disc: mostly across the
    /// surface, else along it. Each of the object's points on the ray is as likely, and each axis counts with the
    /// density with which it would have found the point.
    fn probe(
        &mut self,
        object: &Object<'_>,
        profile: &Profile<'_>,
        entered: &Interaction,
        frame: &Frame,
        context: &mut PathContext<'_, '_>,
    ) -> Option<ExitPoint> {
        // Probabilities of the probing axes: half for the normal, a quarter for each tangent (King et al. 2013).
        const AXES: [f32; 3] = [0.25, 0.25, 0.5];
        let mut numbers = self.numbers(context);
        let u = context.sampler.get_1d(dimension::at(self.events, dimension::LOBE));
        let place = context.sampler.get_2d(dimension::at(self.events, dimension::DIRECTION));
        let axes = [frame.x, frame.y, frame.z];
        let axis = if u < 0.25 {
            0
        } else if u < 0.5 {
            1
        } else {
            2
        };
        let (across, x, y) = (axes[axis], axes[(axis + 1) % 3], axes[(axis + 2) % 3]);
        // Radius r by the profile of a random lane, and the largest radius of the profile, which bounds the search.
        let (r, reach) = (profile.sample(numbers.next_f32(), place.x)?, profile.reach());
        if r >= reach || !reach.is_finite() {
            return None;
        }
        // The probe ray crosses the sphere of that radius, at distance r from its axis and at a uniform angle.
        let (sin, cos) = (std::f32::consts::TAU * place.y).sin_cos();
        let half = (reach * reach - r * r).sqrt();
        let p = entered.surface.p;
        let start = p + x * (r * cos) + y * (r * sin) + across * half;
        let end = start - across * (2.0 * half);
        let (mut ray, mut found, mut count) = (Ray { time: entered.time, ..Ray::new(start, -across) }, None, 0u32);
        // All crossings of the object's surface along the probe.
        for _ in 0..MOST_CROSSINGS {
            ray.t_max = (ray.origin - end).dot(across);
            let is_through = ray.t_max <= 0.0 || ray.t_max.is_nan();
            if is_through || context.counters.stop.is_asked() {
                break;
            }
            context.counters.rays += 1;
            let Some(hit) = object.scene.intersect(&ray) else { break };
            let i = object.scene.interaction_of_light(&ray, &hit);
            ray = i.spawn(ray.direction);
            let Some(exit) = object.exit(i) else { continue };
            // Reservoir sampling: the k-th crossing replaces the one before with probability 1/k, so each is as likely
            // as another.
            count += 1;
            if numbers.next_f32() * count as f32 <= 1.0 {
                found = Some(exit);
            }
        }
        let exit = found?;
        let offset = exit.i.surface.p - p;
        let distance = offset.length();
        if distance >= reach {
            return None;
        }
        // MIS over the axes (balance heuristic): Σ P(axis) |n·axis| p(r⊥), with r⊥ the distance across the axis: the
        // density per area of the exit point.
        let mut density = 0.0;
        for (k, axis) in axes.iter().enumerate() {
            let along = offset.dot(*axis);
            let flat = (distance * distance - along * along).max(0.0).sqrt();
            density += AXES[k] * exit.i.surface.n.dot(*axis).abs() * profile.pdf(flat);
        }
        // β ← β R(d) count / p, the profile at the true distance over the density of the point.
        self.beta *= profile.value(distance) * (count as f32 / density);
        (density > 0.0 && self.beta.is_finite() && !self.beta.is_black()).then_some(exit)
    }

    /// A walk through the medium, from a direction that light has below which entered as it leaves, until it comes to
    /// the surface and is not reflected there.
    fn walk(
        &mut self,
        object: &Object<'_>,
        below: &Below<'_>,
        (g, boundary): (f32, &Emergence),
        entered: &Interaction,
        context: &mut PathContext<'_, '_>,
    ) -> Option<ExitPoint> {
        // The walk begins with a cosine-distributed direction outside that is refracted into the body, as if light left
        // there.
        let mut numbers = self.numbers(context);
        let outside = warp::cosine_hemisphere(context.sampler.get_2d(dimension::at(self.events, dimension::DIRECTION)));
        // Bumps turn what the surface mirrors: light goes below, as it comes back, through the surface as it is.
        let [n, ns] = [entered.surface.n, entered.surface.ns].map(|n| if n.dot(entered.wo) < 0.0 { -n } else { n });
        let mut direction = Frame::from_z(ns).to_world(boundary.refracted(outside)?);
        // Fresnel transmittance of the entry, normalised as that of the exit.
        self.beta *= boundary.passed(outside.z);
        // A shading normal may send it above the surface as it is: it is mirrored back below.
        let above = direction.dot(n);
        if above >= 0.0 {
            direction -= n * (2.0 * above);
        }
        let lanes = lanes(object.scene, context.lambda);
        let mut way = Way::new(below, lanes, &mut numbers);
        let mut ray = entered.spawn(direction);
        let entering = self.beta;
        // The random walk: free flights, scattering by the phase function, and reflection at the surface from within.
        for step in 0..MOST_STEPS {
            if context.counters.stop.is_asked() {
                return None;
            }
            context.counters.rays += 1;
            // The next surface of any object bounds the flight.
            let hit = object.scene.intersect(&ray)?;
            let flight = way.fly(hit.t, numbers.next_f32());
            // The throughput of the walk so far, by the MIS weight over lanes.
            self.beta = entering * way.weight();
            let live = live_max(self.beta, context.lambda);
            if !(live > 0.0 && live.is_finite()) {
                return None;
            }
            // Russian roulette below a tenth of the throughput at entry: survivors are lifted to it.
            if step >= STEPS_BEFORE_ROULETTE && live < 0.1 {
                if numbers.next_f32() >= live * 10.0 {
                    return None;
                }
                way.value *= 0.1 / live;
                self.beta *= 0.1 / live;
            }
            // Scattered before the surface: a new direction by Henyey and Greenstein's phase function with mean cosine
            // g.
            if let Some(t) = flight {
                let u = Vec2::new(numbers.next_f32(), numbers.next_f32());
                let direction = warp::sample_hg(-ray.direction, g, u).0;
                ray = Ray { time: ray.time, ..Ray::new(ray.at(t), direction) };
                continue;
            }
            // The surface is reached.
            let i = object.scene.interaction_of_light(&ray, &hit);
            // Other objects are passed: what is below belongs to this one.
            let Some(exit) = object.exit(i) else {
                ray = i.spawn(ray.direction);
                continue;
            };
            // Fresnel reflection within, F(cosθ), decides whether the path leaves; total reflection never lets it.
            let cos = ray.direction.dot(exit.ns);
            if cos > 0.0 && numbers.next_f32() >= boundary.reflected_within(cos) {
                return Some(exit);
            }
            // Back below: reflected, or grazing by an interpolated normal.
            let n = if ray.direction.dot(i.surface.n) > 0.0 { i.surface.n } else { -i.surface.n };
            let m = if cos > 0.0 { exit.ns } else { n };
            let mut mirrored = ray.direction - m * (2.0 * ray.direction.dot(m));
            if mirrored.dot(n) >= 0.0 {
                mirrored = ray.direction - n * (2.0 * ray.direction.dot(n));
            }
            ray = i.spawn(mirrored.normalize_or_zero());
        }
        None
    }
}
