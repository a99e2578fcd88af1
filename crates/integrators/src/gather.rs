//! Gathering: N directions at each surface, and N at each surface that these meet, to a depth k. The light of each is
//! the mean of that of its directions, so that Nᵏ rays end at depth k where `path` has one. Directions are random, or
//! the midpoints of a grid over the unit square of the surface's sampling: the midpoint rule, without noise and with an
//! error that is alike in all pixels.

use crate::{Depth, Integrator, MAX_PASSES, dimension, nee, support};
use std::sync::Arc;
use steradian_bsdf::TransportMode;
use steradian_core::{
    Scene,
    footprint::{Bounce, RayDifferential},
    light::Light,
};
use steradian_engine::{Asked, Method, MethodKind, PathContext, Plan, Refusal, Session, Support, Tiles};
use steradian_math::{Ray, Spectrum, Vec2};

/// Rays of a sample that may end at the last surfaces.
const MOST_RAYS: u64 = 1 << 20;

/// Surfaces that are gathered at where no limit is given: light after one bounce.
const BOUNCES: u32 = 2;

/// Choice of the directions at a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Directions {
    /// By random numbers.
    Random,
    /// By the midpoints of a grid.
    Grid,
}

/// The estimator.
#[derive(Clone, Copy, Debug)]
pub struct Gather {
    /// Directions at each surface.
    pub rays: u32,
    /// Choice of these directions.
    pub directions: Directions,
    /// Most surfaces, and whether the camera sees lights.
    pub depth: Depth,
}

/// `gather`.
pub const GATHER: MethodKind = MethodKind::new("gather", |asked| Ok(Arc::new(Gather::of(asked)?)));

impl Gather {
    fn of(asked: &Asked<'_>) -> Result<Self, Refusal> {
        let (rays, depth) = (asked.options.count("rays"), asked.depth());
        // Limits of scenes are those of single paths.
        let is_given = asked.request.max_depth.is_some() || asked.options.given("max_depth").is_some();
        let depth = Depth { max: if is_given { depth.max } else { BOUNCES }, ..depth };
        let all = u64::from(rays).checked_pow(depth.max).filter(|all| *all <= MOST_RAYS);
        if rays > 1 && all.is_none() {
            return Err(Refusal(format!(
                "gather: {rays} rays at each of {} surfaces are more than {MOST_RAYS} for a sample; give fewer, or a \
                 smaller max_depth",
                depth.max
            )));
        }
        let directions = if asked.options.word("directions") == "grid" { Directions::Grid } else { Directions::Random };
        Ok(Self { rays, directions, depth })
    }
}

impl Method for Gather {
    fn supports(&self, feature: steradian_engine::Feature) -> Support {
        use steradian_engine::Feature;
        match feature {
            Feature::Media => Support::LeavesOut(""),
            _ => support::of_local_scattering(feature),
        }
    }

    fn session(&self, scene: Arc<Scene>, plan: Plan) -> Result<Box<dyn Session>, Refusal> {
        Ok(Box::new(Tiles::per_pixel(scene, *self, plan)))
    }
}

/// A ray of the tree.
struct Branch {
    ray: Ray,
    differential: Option<RayDifferential>,
    /// Surfaces before it.
    events: u32,
    /// Its number among the branches of its depth.
    number: u32,
}

impl Gather {
    /// Sides of the grid: the divisors of the number of rays that are nearest to each other.
    fn grid(&self) -> [u32; 2] {
        let columns =
            (1..=self.rays).take_while(|n| n * n <= self.rays).filter(|n| self.rays.is_multiple_of(*n)).last();
        columns.map_or([1, 1], |columns| [columns, self.rays / columns])
    }

    fn trace(&self, branch: Branch, context: &mut PathContext<'_, '_>) -> Spectrum {
        let Branch { mut ray, mut differential, events, number } = branch;
        let mut sum = Spectrum::ZERO;
        let is_hidden = events == 0 && self.depth.hide_emitters;
        // Each branch has dimensions of its own.
        let own = |dimension: u32| dimension::at(events, dimension) ^ number << 8;
        for _ in 0..MAX_PASSES {
            let PathContext { scene, sampler, lambda, counters } = &mut *context;
            if counters.stop.is_asked() {
                break;
            }
            counters.rays += 1;
            let Some(hit) = scene.intersect(&ray) else {
                let sky = nee::background(scene, ray.origin, ray.direction, &None, lambda);
                return if is_hidden { sum } else { sum + sky };
            };
            // Emission is found by the directions alone.
            let i = scene.interaction_of_light(&ray, &hit);
            if !is_hidden {
                sum += nee::emission(scene, &i, &None, lambda);
            }
            let choice = sampler.get_1d(own(dimension::MIXTURE));
            let surface = match self.depth.hides(scene, i.geometry, events) {
                true => None,
                false => scene.scattering_along(&i, differential.as_ref(), choice, lambda),
            };
            let Some((scattering, frame)) = surface else {
                ray = i.rest(&ray);
                differential = differential.map(|d| d.advance(i.t));
                continue;
            };
            if events >= self.depth.max {
                return sum;
            }
            let wo = frame.to_local(i.wo);
            // Lights without extent, which no direction finds, are asked one by one.
            let ctx = nee::context(&i, &frame, &scattering.bsdf);
            for (light, _) in (0..).zip(&scene.lights().lights).filter(|(_, l)| is_sharp(l)) {
                let Some(s) = scene.lights().sample(light, &ctx, Vec2::splat(0.5), lambda, scene.textures()) else {
                    continue;
                };
                let e = scattering.eval(wo, frame.to_local(s.wi), TransportMode::Radiance);
                if e.value.is_black() {
                    continue;
                }
                counters.rays += 1;
                if !scene.occluded(&i.spawn_towards(s.wi, s.distance)) {
                    sum += e.value * s.radiance / s.pdf;
                }
            }
            // Mirrors and glass have no area of directions to divide: one is drawn.
            let (rays, [columns, rows]) =
                if scattering.bsdf.is_specular() { (1, [1, 1]) } else { (self.rays, self.grid()) };
            let is_grid = self.directions == Directions::Grid && rays > 1;
            let mut gathered = Spectrum::ZERO;
            for k in 0..rays {
                let PathContext { scene, sampler, .. } = &mut *context;
                let branch = number * rays + k;
                let (u, u2) = if is_grid {
                    let cell = Vec2::new((k % columns) as f32 + 0.5, (k / columns) as f32 + 0.5);
                    // Lobes in turn, by the golden ratio.
                    (((k as f32 + 0.5) * 0.618_034).fract(), cell / Vec2::new(columns as f32, rows as f32))
                } else {
                    let of_branch = |dimension: u32| dimension::at(events, dimension) ^ branch << 8;
                    (sampler.get_1d(of_branch(dimension::LOBE)), sampler.get_2d(of_branch(dimension::DIRECTION)))
                };
                let Some(s) = scattering.sample(wo, u, u2, TransportMode::Radiance) else { continue };
                let ray = i.spawn(frame.to_world(s.wi));
                let differential = differential
                    .zip(Bounce::of(&s))
                    .and_then(|(d, bounce)| scene.scatter_differential(&i, &d, ray.direction, bounce));
                let next = Branch { ray, differential, events: events + 1, number: branch };
                gathered += s.weight * self.trace(next, context);
            }
            return sum + gathered / rays as f32;
        }
        sum
    }
}

/// True for points and parallel light.
fn is_sharp(light: &Light) -> bool {
    matches!(light, Light::Punctual(_) | Light::Distant(..) | Light::DirectionalArea(_))
}

impl Integrator for Gather {
    type Prepared = ();

    fn radiance(&self, (): &(), ray: Ray, context: &mut PathContext<'_, '_>) -> Spectrum {
        let differential = context.scene.ray_differential(&ray);
        self.trace(Branch { ray, differential, events: 0, number: 0 }, context)
    }
}
