//! Gathering: N directions at each surface, and N at each surface that these meet. The light of each is the mean of
//! that of its directions, so that Nᵏ rays end at depth k where `path` has one. Beyond a number of branches each surface
//! sends a single ray, as paths do, which ends by Russian roulette: no light is left out. Directions are random, or the
//! midpoints of a grid over the unit square of the surface's sampling: the midpoint rule, without noise and with an
//! error that is alike in all pixels. Single rays are random.

use crate::{Depth, Integrator, MAX_PASSES, dimension, live_max, nee, support};
use std::sync::Arc;
use steradian_bsdf::TransportMode;
use steradian_core::{
    Scene,
    footprint::{Bounce, RayDifferential},
    light::Light,
};
use steradian_engine::{Asked, Method, MethodKind, PathContext, Plan, Refusal, Session, Support, Tiles};
use steradian_math::{Ray, Spectrum, Vec2, hash::combine32};
use steradian_transport::roulette::roulette;

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
    /// Most branches of a sample, if those of the first surface are not more.
    pub branches: u32,
    /// Choice of these directions.
    pub directions: Directions,
    /// Limits of paths.
    pub depth: Depth,
}

/// `gather`.
pub const GATHER: MethodKind = MethodKind::new("gather", |asked| Ok(Arc::new(Gather::of(asked))));

impl Gather {
    fn of(asked: &Asked<'_>) -> Self {
        let directions = if asked.options.word("directions") == "grid" { Directions::Grid } else { Directions::Random };
        let [rays, branches] = ["rays", "branches"].map(|name| asked.options.count(name));
        Self { rays, branches: branches.max(rays), directions, depth: asked.depth() }
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
    /// Part of its light that arrives at the camera.
    beta: Spectrum,
    /// Factor of this part in the eyes of roulette: the compression of radiance by refraction, and the number of
    /// branches among which surfaces have divided it.
    scale: f32,
    /// Number of these branches.
    branches: u32,
    /// Offset of its random numbers: each branch has its own.
    offset: u32,
}

impl Branch {
    fn dimension(&self, decision: u32) -> u32 {
        dimension::at(self.events, decision).wrapping_add(self.offset)
    }
}

impl Gather {
    /// Sides of the grid: the divisors of the number of rays that are nearest to each other.
    fn grid(&self) -> [u32; 2] {
        let columns =
            (1..=self.rays).take_while(|n| n * n <= self.rays).filter(|n| self.rays.is_multiple_of(*n)).last();
        columns.map_or([1, 1], |columns| [columns, self.rays / columns])
    }

    /// Directions at a surface. Mirrors and glass have no area of directions to divide: one is drawn.
    fn rays(&self, branch: &Branch, is_specular: bool) -> u32 {
        let all = u64::from(branch.branches) * u64::from(self.rays);
        if is_specular || all > u64::from(self.branches) { 1 } else { self.rays }
    }

    /// Light that a ray and those behind it bring to the camera.
    fn trace(&self, mut branch: Branch, context: &mut PathContext<'_, '_>) -> Spectrum {
        let (mut sum, mut passes) = (Spectrum::ZERO, 0);
        loop {
            let PathContext { scene, sampler, lambda, counters } = &mut *context;
            if counters.stop.is_asked() {
                return sum;
            }
            counters.rays += 1;
            let is_hidden = branch.events == 0 && self.depth.hide_emitters;
            let Some(hit) = scene.intersect(&branch.ray) else {
                let sky = nee::behind(scene, &branch.ray, branch.events, &None, lambda);
                return if is_hidden { sum } else { sum + branch.beta * sky };
            };
            // Emission is found by the directions alone.
            let i = scene.interaction_of_light(&branch.ray, &hit);
            if !is_hidden {
                sum += branch.beta * nee::emission(scene, &i, &None, lambda);
            }
            let surface = if self.depth.hides(scene, i.geometry, branch.events) {
                None
            } else {
                let choice = sampler.get_1d_lazily(branch.dimension(dimension::MIXTURE), scene.has_mixtures());
                scene.scattering_along(&i, branch.differential.as_ref(), choice, lambda)
            };
            let Some((scattering, frame)) = surface else {
                passes += 1;
                if passes > MAX_PASSES {
                    return sum;
                }
                branch.ray = i.rest(&branch.ray);
                branch.differential = branch.differential.map(|d| d.advance(i.t));
                continue;
            };
            if branch.events >= self.depth.max {
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
                    sum += branch.beta * e.value * s.radiance / s.pdf;
                }
            }
            let rays = self.rays(&branch, scattering.bsdf.is_specular());
            let [columns, rows] = self.grid();
            let next = |k: u32, offset: u32, context: &PathContext<'_, '_>| {
                let PathContext { scene, sampler, .. } = context;
                let drawn = Branch { offset, ..branch };
                let (u, u2) = if rays > 1 && self.directions == Directions::Grid {
                    let cell = Vec2::new((k % columns) as f32 + 0.5, (k / columns) as f32 + 0.5);
                    // Lobes in turn, by the golden ratio.
                    (((k as f32 + 0.5) * 0.618_034).fract(), cell / Vec2::new(columns as f32, rows as f32))
                } else {
                    (
                        sampler.get_1d(drawn.dimension(dimension::LOBE)),
                        sampler.get_2d(drawn.dimension(dimension::DIRECTION)),
                    )
                };
                let s = scattering.sample(wo, u, u2, TransportMode::Radiance)?;
                let ray = i.spawn(frame.to_world(s.wi));
                let differential = branch
                    .differential
                    .zip(Bounce::of(&s))
                    .and_then(|(d, bounce)| scene.scatter_differential(&i, &d, ray.direction, bounce));
                Some(Branch {
                    ray,
                    differential,
                    events: branch.events + 1,
                    beta: branch.beta * s.weight / rays as f32,
                    scale: branch.scale * s.eta * s.eta * rays as f32,
                    branches: branch.branches * rays,
                    offset,
                })
            };
            if rays > 1 {
                for k in 0..rays {
                    if let Some(next) = next(k, combine32(branch.offset, k), context) {
                        sum += self.trace(next, context);
                    }
                }
                return sum;
            }
            let Some(next) = next(0, branch.offset, context) else { return sum };
            branch = next;
            passes = 0;
            let PathContext { sampler, lambda, .. } = &*context;
            let live = live_max(branch.beta, lambda) * branch.scale;
            let number = || sampler.get_1d(branch.dimension(dimension::ROULETTE));
            match roulette(live, branch.events, &self.depth, None, number) {
                Some(scale) => branch.beta *= scale,
                None => return sum,
            }
        }
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
        let beta = Spectrum::splat(1.0);
        self.trace(Branch { ray, differential, events: 0, beta, scale: 1.0, branches: 1, offset: 0 }, context)
    }
}
