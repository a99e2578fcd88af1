//! Lights: sources of light, and how points of the scene find them.
//!
//! Each emitting triangle is a light; two triangles that form a rectangle are one. Points, spots and area lights are in
//! a [light tree](tree), which chooses one in proportion to a bound on its contribution. Infinite lights share a list
//! beside the tree. A tenth of all choices is spread evenly ([`Lights::choose`]).
//!
//! * [`area`]: a rectangle or triangle that subtends more than about a quarter of a steradian is sampled uniformly in
//!   solid angle, else by area. The decision is a pure function of the point, so that the density asked for later
//!   agrees. Whole spheres are sampled by their cone, other quadrics uniformly by area in object space, with the
//!   stretch of their placement in the density (`Affine::area`).
//! * Placements: the lights of a group are listed once more for each placement, from `Placement::first_light` on
//!   (`Scene::light`). Lights of moving objects are placed for the moment of the ray (`moving`).
//! * Emitting curves are meshes (`shape::tube`). The light of surfaces given by equations or distances has no samples:
//!   paths meet it by chance.
//! * Schedules: where a light does not always shine, `Lights::timetable` is asked for the moment of the exposure, less
//!   the time for which matter held the light back (`Wavelengths::delay`). Scenes of that kind are followed path by
//!   path (`Scene::needs_scalar_path_tracer`).

pub mod aims;
pub mod area;
pub mod cube;
pub mod emission;
pub mod environment;
pub mod groups;
mod moving;
pub mod punctual;
mod schedule;
pub mod sky;
pub mod tree;

pub use area::{AreaLight, AreaShape, Emitter};
pub use environment::Environment;
pub use groups::LightGroups;
pub use moving::Moving;
pub use punctual::{Goniometric, Isotropic, Own, OwnLight, Projection, Punctual, PunctualLight, Spot};
pub use schedule::{Schedule, Timetable};

use steradian_math::{
    Spectrum, Vec2, Vec3,
    spectra::{ColorMode, Wavelengths, role::Color},
};
use steradian_texture::Textures;
use tree::LightTree;

/// Reference point for light sampling.
#[derive(Clone, Copy, Debug)]
pub struct LightContext {
    /// The point.
    pub p: Vec3,
    /// Unit normal on the side from which light matters; zero where it may come from any side (media, transmitting
    /// surfaces).
    pub n: Vec3,
}

/// Light that arrives from a light.
#[derive(Clone, Copy, Debug)]
pub struct LightSample {
    /// Unit direction to the light.
    pub wi: Vec3,
    /// Distance to the point on the light; infinite for infinite lights.
    pub distance: f32,
    /// Radiance; for delta lights the irradiance on a facing surface.
    pub radiance: Spectrum,
    /// Density per solid angle; 1 for delta lights.
    pub pdf: f32,
    /// True if no other sampling technique can find the light.
    pub is_delta: bool,
}

/// A source of light.
#[derive(Clone, Debug)]
pub enum Light {
    /// A light at a point.
    Punctual(Punctual),
    /// Parallel light: the unit direction to the light, and the irradiance on a facing surface.
    Distant(Vec3, Color),
    /// Light from all directions.
    Environment(Box<Environment>),
    /// Part of a surface.
    Area(AreaLight),
    /// A flat part of a surface that shines along its normal.
    DirectionalArea(AreaLight),
}

/// All lights of a scene and the means to choose among them.
#[derive(Clone, Debug, Default)]
pub struct Lights {
    /// The lights.
    pub lights: Vec<Light>,
    /// Emission of surfaces.
    pub emitters: Vec<Emitter>,
    /// Indices of environments.
    pub environments: Vec<u32>,
    /// Lights without bounds that can be chosen, with an estimate of their irradiance: environments with bright parts,
    /// distant lights.
    infinite: Vec<(u32, f32)>,
    /// The others.
    tree: LightTree,
    mode: ColorMode,
    /// Schedules, where any light does not shine always.
    pub timetable: Option<Box<Timetable>>,
    /// Ambient light, for methods that have an ambient term.
    pub ambient: Vec<Ambient>,
    /// Backdrop that camera rays see in place of environments. It is no light.
    pub backdrop: Option<Box<Environment>>,
}

/// Ambient light: a constant that stands for light from all sides, of which a surface reflects `k_a L_a` whatever is
/// around it (Phong, "Illumination for computer generated pictures", 1975). It is no radiance that paths meet.
#[derive(Clone, Debug)]
pub struct Ambient {
    /// L_a.
    pub radiance: Color,
    /// Factor on it.
    pub scale: f32,
    /// Its group of lights.
    pub group: u32,
}

/// The share of choices that goes evenly to all lights, whatever their estimates.
const UNIFORM_SHARE: f32 = 0.1;

impl Lights {
    /// Bytes of the records, of the pictures of environments, and of the light tree.
    pub fn bytes(&self) -> usize {
        let environments = self.lights.iter().filter_map(|light| match light {
            Light::Environment(e) => Some(e),
            _ => None,
        });
        let pictures = environments.chain(&self.backdrop).map(|e| {
            let image = e.image.as_ref().map(|image| image.texels.byte_size());
            let tables = image.or_else(|| e.celestial.as_ref().map(|c| c.bytes()));
            tables.map_or(0, |bytes| size_of_val(&**e) + bytes)
        });
        size_of_val(&self.lights[..]) + size_of_val(&self.emitters[..]) + self.tree.bytes() + pictures.sum::<usize>()
    }

    /// Prepares the choice among lights.
    pub fn new(lights: Vec<Light>, emitters: Vec<Emitter>, mode: ColorMode) -> Self {
        let mut bounded = Vec::new();
        // Separate lights with bounds, which go into the tree, from infinite ones, which are listed.
        let (mut infinite, mut environments) = (Vec::new(), Vec::new());
        for (i, light) in lights.iter().enumerate() {
            let i = i as u32;
            match light {
                Light::Environment(e) => {
                    environments.push(i);
                    if e.sampled_irradiance() > 0.0 {
                        infinite.push((i, e.sampled_irradiance()));
                    }
                }
                Light::Distant(_, irradiance) => infinite.push((i, irradiance.luminance(mode))),
                Light::Punctual(light) => bounded.push((i, light.bounds(mode))),
                Light::Area(a) | Light::DirectionalArea(a) => {
                    bounded.push((i, a.bounds(&emitters[a.emitter as usize])));
                }
            }
        }
        // Lights that estimate to nothing are never chosen.
        infinite.retain(|l| l.1 > 0.0);
        bounded.retain(|l| l.1.intensity > 0.0);
        Self {
            tree: LightTree::new(&bounded, lights.len()),
            lights,
            emitters,
            environments,
            infinite,
            mode,
            timetable: None,
            ambient: Vec::new(),
            backdrop: None,
        }
    }

    /// True if next-event estimation can find any light.
    pub fn can_sample(&self) -> bool {
        !self.infinite.is_empty() || !self.tree.is_empty()
    }

    /// True if there is more than one light to choose from.
    #[inline]
    pub fn are_many(&self) -> bool {
        self.infinite.len() + self.tree.len() > 1
    }

    /// The colour mode that radiances are in.
    pub fn mode(&self) -> ColorMode {
        self.mode
    }

    /// Probability of the tree, and the factor from an infinite light's irradiance to its probability and the even
    /// share each gets.
    #[inline]
    fn shares(&self, ctx: &LightContext) -> Shares {
        let groups = self.infinite.len() as f32 + f32::from(!self.tree.is_empty());
        // Without infinite lights the tree takes all; a single infinite light alone needs no choice.
        if self.infinite.is_empty() {
            return Shares { tree: 1.0, per_irradiance: 0.0, even: 0.0 };
        }
        if self.tree.is_empty() && self.infinite.len() == 1 {
            return Shares { tree: 0.0, per_irradiance: 0.0, even: 1.0 };
        }
        // Irradiance that the tree's root may give at the point, against the estimates of the infinite lights.
        let tree = self.tree.importance(ctx);
        let total = tree + self.infinite.iter().map(|l| l.1).sum::<f32>();
        // Defensive sampling: a share goes evenly to all, so that no estimate starves a light.
        let even = UNIFORM_SHARE / groups;
        let per_irradiance = (1.0 - UNIFORM_SHARE) / total;
        let tree = if self.tree.is_empty() { 0.0 } else { tree * per_irradiance + even };
        Shares { tree, per_irradiance, even }
    }

    /// Chooses a light for a point in proportion to an estimate of what it can contribute: index, and probability.
    #[inline]
    pub fn choose(&self, ctx: &LightContext, u: f32) -> Option<(u32, f32)> {
        match self.choose_kind(ctx, u)? {
            Choice::Infinite(light, p) => Some((light, p)),
            Choice::Tree(u, share) => self.tree.sample(ctx, u).map(|(light, p)| (light, p * share)),
        }
    }

    /// The first step of [`Lights::choose`]: an infinite light, or one of the tree.
    #[inline]
    pub fn choose_kind(&self, ctx: &LightContext, u: f32) -> Option<Choice> {
        let shares = self.shares(ctx);
        // Walk the list of infinite lights by their cumulative probability; what is left of u chooses in the tree.
        let mut u = u;
        for &(light, irradiance) in &self.infinite {
            // p = (1 − share)·E/ΣE + share/n, the mixture of importance and uniform sampling.
            let p = irradiance * shares.per_irradiance + shares.even;
            if u < p {
                return Some(Choice::Infinite(light, p));
            }
            u -= p;
        }
        let u = (u / shares.tree).min(steradian_math::hash::ONE_MINUS_EPSILON);
        (shares.tree > 0.0).then_some(Choice::Tree(u, shares.tree))
    }

    /// The tree of lights that have bounds.
    #[inline]
    pub fn tree(&self) -> &LightTree {
        &self.tree
    }

    /// The probability with which [`Lights::choose`] gives a light.
    #[inline]
    pub fn probability(&self, ctx: &LightContext, light: u32) -> f32 {
        let shares = self.shares(ctx);
        // Density of the mixture for a light that was found otherwise; the tree's part by its trail.
        match self.infinite.iter().find(|l| l.0 == light) {
            Some(l) => l.1 * shares.per_irradiance + shares.even,
            None => self.tree.probability(ctx, light) * shares.tree,
        }
    }

    /// True if a light shines at the moment of the sample.
    #[inline]
    pub fn shines(&self, light: u32, lambda: &Wavelengths) -> bool {
        self.timetable.as_ref().is_none_or(|t| t.shines(&t.of_lights[light as usize], lambda))
    }

    /// True if a surface emits at the moment of the sample.
    #[inline]
    pub fn emits(&self, emitter: u32, lambda: &Wavelengths) -> bool {
        self.timetable.as_ref().is_none_or(|t| t.shines(&t.of_emitters[emitter as usize], lambda))
    }

    /// Light that arrives at a point from one light, with `u` choosing where on the light.
    #[inline]
    pub fn sample(
        &self,
        light: u32,
        ctx: &LightContext,
        u: Vec2,
        lambda: &Wavelengths,
        textures: &Textures,
    ) -> Option<LightSample> {
        let delta = |to: Vec3, intensity: Spectrum| {
            // Inverse-square falloff: E = I/d².
            let d2 = to.length_squared();
            let distance = d2.sqrt();
            (d2 > 0.0 && !intensity.is_black()).then(|| LightSample {
                wi: to / distance,
                distance,
                radiance: intensity / d2,
                pdf: 1.0,
                is_delta: true,
            })
        };
        if !self.shines(light, lambda) {
            return None;
        }
        match &self.lights[light as usize] {
            Light::Punctual(light) => {
                // A point light is a delta distribution in direction.
                let light: &dyn PunctualLight = &**light;
                delta(light.position() - ctx.p, light.intensity(ctx.p, lambda, textures, self.mode))
            }
            Light::Distant(wi, irradiance) => Some(LightSample {
                wi: *wi,
                distance: f32::INFINITY,
                radiance: irradiance.eval(lambda),
                pdf: 1.0,
                is_delta: true,
            }),
            Light::Environment(e) => {
                // Direction by the distribution of the map, portal or sky; the radiance is looked up afterwards.
                let (wi, pdf) = e.sample(ctx.p, u)?;
                let radiance = e.radiance(ctx.p, wi, lambda);
                Some(LightSample { wi, distance: f32::INFINITY, radiance, pdf, is_delta: false })
            }
            Light::Area(a) => a.sample(&self.emitters[a.emitter as usize], ctx.p, u, lambda, textures),
            Light::DirectionalArea(a) => a.along_normal(&self.emitters[a.emitter as usize], ctx.p, lambda, textures),
        }
    }

    /// The density per solid angle, choice of light included, with which next-event estimation at `ctx` gives a point
    /// on an area light that was found otherwise: at `distance` in direction `wi`, with unit geometric normal `n`, at a
    /// moment of the exposure.
    #[inline]
    pub fn area_pdf(&self, light: u32, ctx: &LightContext, (wi, distance): (Vec3, f32), n: Vec3, time: f32) -> f32 {
        match &self.lights[light as usize] {
            // p_ω = P(light)·p(direction | light).
            Light::Area(a) => match self.probability(ctx, light) {
                p if p > 0.0 => p * a.pdf(ctx.p, wi, distance, n, time),
                _ => 0.0,
            },
            _ => 0.0,
        }
    }

    /// The density per solid angle, choice of light included, with which next-event estimation at `ctx` draws the
    /// direction `wi` to an environment.
    #[inline]
    pub fn environment_pdf(&self, light: u32, ctx: &LightContext, wi: Vec3) -> f32 {
        match &self.lights[light as usize] {
            Light::Environment(e) if e.sampled_irradiance() > 0.0 => self.probability(ctx, light) * e.pdf(ctx.p, wi),
            _ => 0.0,
        }
    }
}

/// Result of [`Lights::choose_kind`].
#[derive(Clone, Copy, Debug)]
pub enum Choice {
    /// An infinite light and its probability.
    Infinite(u32, f32),
    /// A number to choose a light of the tree with, and the probability that it is one of these.
    Tree(f32, f32),
}

struct Shares {
    tree: f32,
    per_irradiance: f32,
    even: f32,
}
