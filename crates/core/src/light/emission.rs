//! Lights that emit: rays from lights, with their densities (Veach 1997, chapter 8; PBR 4th ed., 12.1.2).
//!
//! A light is chosen in proportion to its flux, a place on it uniformly over its area (of infinite lights, over a disk
//! that covers the scene), a direction by the cosine, over a cone, or as the light is bright; a part of the rays is
//! [aimed](super::aims) at what matters. What is a delta distribution (the place of a point light, the direction of
//! parallel light) is left out of densities, here and in next-event estimation, so that their ratios are right.
//!
//! Tests hold emission to three laws: the emitted flux has its closed form, emission and light samples give the same
//! light, and the importance of cameras (`camera::importance`) integrates to the number of pixels.

use super::{AreaLight, AreaShape, Environment, Light, Lights, Punctual, aims::Aims};
use crate::Scene;
use std::f32::consts::{FRAC_1_PI, PI};
use steradian_math::{
    Bounds3, Frame, Ray, Spectrum, Vec2, Vec3,
    distribution::AliasTable,
    ray::{gamma, offset_ray_origin},
    spectra::Wavelengths,
    warp,
};
use steradian_texture::TextureContext;

/// Emission sampling of a scene's lights.
#[derive(Clone, Debug)]
pub struct Emission {
    choice: AliasTable,
    /// A sphere around all that light can reach.
    center: Vec3,
    radius: f32,
    aims: Aims,
}

/// A ray that leaves a light.
#[derive(Clone, Copy, Debug)]
pub struct EmittedRay {
    /// Index of the light.
    pub light: u32,
    /// The ray.
    pub ray: Ray,
    /// Oriented unit normal of the surface there; of other lights the direction.
    pub n: Vec3,
    /// Cosine between both; 1 of lights that are no surfaces.
    pub cos: f32,
    /// Radiance, intensity (of points), or irradiance across the ray (of parallel light).
    pub radiance: Spectrum,
    /// Density of choice, place and direction, without delta distributions.
    pub pdf: f32,
}

/// Kind of an emitting light, for path densities.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Kind {
    /// No ray can meet it by chance: points and parallel light.
    pub is_delta: bool,
    /// Its density over surfaces does not fall with the square of the distance: infinite and parallel lights.
    pub is_parallel: bool,
}

impl Light {
    /// Kind of the light.
    pub fn kind(&self) -> Kind {
        let (is_delta, is_parallel) = match self {
            Self::Punctual(_) => (true, false),
            Self::Distant(..) | Self::DirectionalArea(_) => (true, true),
            Self::Environment(_) => (false, true),
            Self::Area(_) => (false, false),
        };
        Kind { is_delta, is_parallel }
    }
}

impl Emission {
    /// Emission sampling of a scene; `None` if no light emits. Infinite planes are too large for light from infinity to
    /// be sent at them: it is left out then, with density zero.
    pub fn new(scene: &Scene) -> Option<Self> {
        // A slightly larger bounding sphere: rays from infinity start outside of everything.
        let (center, radius) = reach(scene).bounding_sphere();
        let radius = (radius * 1.001).max(f32::MIN_POSITIVE);
        let lights = scene.lights();
        let is_sent = |l: &Light| scene.planes().is_empty() || !matches!(l, Light::Distant(..) | Light::Environment(_));
        let aims = Aims::new(scene);
        let flux = |l: &Light| if is_sent(l) { lights.flux(l, radius) * l.reached(&aims) } else { 0.0 };
        // Choose lights in proportion to the flux that may meet something.
        let weights: Vec<f32> = lights.lights.iter().map(flux).map(|f| if f.is_finite() { f } else { 0.0 }).collect();
        let is_any = weights.iter().any(|w| *w > 0.0);
        is_any.then(|| Self { choice: AliasTable::new(&weights), center, radius, aims })
    }

    /// A ray from a light: `u` chooses the light, `place` where on it, `direction` where to.
    pub fn sample(
        &self,
        scene: &Scene,
        u: f32,
        place: Vec2,
        direction: Vec2,
        lambda: &Wavelengths,
    ) -> Option<EmittedRay> {
        // The alias table draws a light in constant time (Vose 1991).
        let (light, choice, u) = self.choice.sample(u);
        let mut emitted = self.sample_light(scene, light as u32, (u, place, direction), lambda)?;
        emitted.pdf *= choice;
        let is_sound = emitted.pdf > 0.0 && emitted.pdf.is_finite() && emitted.ray.is_valid();
        (is_sound && !emitted.radiance.is_black()).then_some(emitted)
    }

    /// A ray from the light `light`, whose aim `u` chooses; the density leaves the choice of the light out.
    fn sample_light(
        &self,
        scene: &Scene,
        light: u32,
        (u, place, direction): (f32, Vec2, Vec2),
        lambda: &Wavelengths,
    ) -> Option<EmittedRay> {
        let lights = scene.lights();
        // Parallel light through a disk across it, from outside of everything.
        let through_disk = |w: Vec3| {
            let (center, radius) = self.aims.disk(u).unwrap_or((self.center, self.radius));
            let d = warp::concentric_disk(place) * radius;
            let frame = Frame::from_z(w);
            let back = self.radius + (center - self.center).dot(w);
            let ray = Ray::new(center + frame.x * d.x + frame.y * d.y - w * back, w);
            (ray, self.disk_pdf(ray.origin, w))
        };
        Some(match &lights.lights[light as usize] {
            Light::Punctual(at) => {
                let p = at.position();
                let w = match self.aims.direction(p, u, direction) {
                    Some(w) => w,
                    None => at.draw(direction)?.0,
                };
                let pdf = self.aims.pdf(p, w, at.pdf(w));
                let radiance = at.intensity(p + w, lambda, scene.textures(), lights.mode());
                EmittedRay { light, ray: Ray::new(p, w), n: w, cos: 1.0, radiance, pdf }
            }
            Light::Distant(to, irradiance) => {
                let (ray, pdf) = through_disk(-*to);
                EmittedRay { light, ray, n: -*to, cos: 1.0, radiance: irradiance.eval(lambda), pdf }
            }
            Light::Environment(e) => {
                if let Some([corner, ex, ey]) = e.portal {
                    // A portal emits as its area does: a uniform place, and a cosine-distributed direction on either
                    // side.
                    let n = ex.cross(ey);
                    let area = n.length();
                    let z = if direction.x < 0.5 { n / area } else { -n / area };
                    let u = Vec2::new((direction.x * 2.0).fract(), direction.y);
                    let w = Frame::from_z(z).to_world(warp::cosine_hemisphere(u));
                    let q = corner + ex * place.x + ey * place.y;
                    let back = self.radius + (q - self.center).length();
                    let ray = Ray::new(q - w * back, w);
                    let radiance = e.beyond(-w, lambda);
                    // Both cosines cancel: of the direction, and of the portal seen along it.
                    return Some(EmittedRay { light, ray, n: w, cos: 1.0, radiance, pdf: 0.5 * FRAC_1_PI / area });
                }
                // Half of the directions by the image's distribution and half uniformly, so that dark parts are
                // covered.
                let to = match e.sampled_irradiance() > 0.0 {
                    true if e.celestial.is_some() => e.sample(self.center, direction)?.0,
                    true if direction.x < 0.5 => e.sample(self.center, Vec2::new(direction.x * 2.0, direction.y))?.0,
                    true => warp::uniform_sphere(Vec2::new(direction.x * 2.0 - 1.0, direction.y)),
                    false => warp::uniform_sphere(direction),
                };
                let radiance = e.beyond(to, lambda);
                let (ray, disk) = through_disk(-to);
                EmittedRay { light, ray, n: -to, cos: 1.0, radiance, pdf: self.sky_pdf(e, to) * disk }
            }
            Light::Area(a) => {
                let a = &*a.at(lambda.time);
                // A place uniform over the area and a cosine-distributed direction on each side that shines.
                let (p, n, at) = a.sample_place(place);
                let emitter = &lights.emitters[a.emitter as usize];
                let mut local = warp::cosine_hemisphere(direction);
                if emitter.two_sided {
                    let u = Vec2::new((direction.x * 2.0).fract(), direction.y);
                    local = warp::cosine_hemisphere(u);
                    local.z *= if direction.x < 0.5 { 1.0 } else { -1.0 };
                }
                let own = || Frame::from_z(n).to_world(local);
                let w = self.aims.direction(p, u, direction).unwrap_or_else(own);
                let cos = n.dot(w).abs();
                let radiance = emitter.drawn(n, w, || at, lambda, scene.textures());
                // p = p(place)·p(direction), with the light's own p(direction) = cos θ/π on one side.
                let pdf = self.aims.pdf(p, w, lobe(n.dot(w), emitter.two_sided)) / a.area_at(n);
                EmittedRay { light, ray: Ray::new(a.leave(p, n, w), w), n, cos, radiance, pdf }
            }
            Light::DirectionalArea(a) => {
                let a = &*a.at(lambda.time);
                let (p, n, at) = a.sample_place(place);
                let radiance = lights.emitters[a.emitter as usize].drawn(n, n, || at, lambda, scene.textures());
                let pdf = 1.0 / a.area_at(n);
                EmittedRay { light, ray: Ray::new(a.leave(p, n, n), n), n, cos: 1.0, radiance, pdf }
            }
        })
    }

    /// The density with which a ray leaves a light in direction `w` from the place `p` with oriented normal `n`, choice
    /// included, as in [`EmittedRay::pdf`], at a moment of the exposure. Of parallel light `p` is any point of the ray.
    pub fn pdf(&self, scene: &Scene, light: u32, (p, n): (Vec3, Vec3), w: Vec3, time: f32) -> f32 {
        let pdf = match &scene.lights().lights[light as usize] {
            Light::Punctual(light) => self.aims.pdf(light.position(), w, light.pdf(w)),
            Light::Distant(..) => self.disk_pdf(p, w),
            Light::Environment(e) => match e.portal {
                Some([_, ex, ey]) => 0.5 * FRAC_1_PI / ex.cross(ey).length(),
                None => self.sky_pdf(e, -w) * self.disk_pdf(p, w),
            },
            Light::Area(a) => {
                let two_sided = scene.lights().emitters[a.emitter as usize].two_sided;
                self.aims.pdf(p, w, lobe(n.dot(w), two_sided)) / a.at(time).area_at(n)
            }
            Light::DirectionalArea(a) => 1.0 / a.at(time).area_at(n),
        };
        pdf * self.choice.pmf(light as usize)
    }

    /// Density across a direction of parallel rays through a point.
    fn disk_pdf(&self, p: Vec3, w: Vec3) -> f32 {
        self.aims.disk_pdf(p, w, 1.0 / (PI * self.radius * self.radius))
    }

    /// The density of directions to an environment without a portal.
    fn sky_pdf(&self, e: &Environment, to: Vec3) -> f32 {
        let uniform = 0.25 * FRAC_1_PI;
        if e.celestial.is_some() {
            return e.pdf(self.center, to);
        }
        // Mixture of both strategies.
        if e.sampled_irradiance() > 0.0 { 0.5 * (uniform + e.pdf(self.center, to)) } else { uniform }
    }
}

/// Box around all that light from infinity meets first: surfaces, and media that vary around them.
fn reach(scene: &Scene) -> Bounds3 {
    let around = scene.camera().medium.into_iter().chain(scene.geometries().iter().filter_map(|g| g.media?.1));
    let fields = around.filter_map(|m| scene.media()[m as usize].field.as_ref());
    fields.fold(scene.bounds(), |bounds, field| bounds.union(field.world_bounds()))
}

/// The cosine density about the normal, on both sides where the surface shines to both.
fn lobe(cos: f32, two_sided: bool) -> f32 {
    FRAC_1_PI * if two_sided { 0.5 * cos.abs() } else { cos.max(0.0) }
}

impl Light {
    /// The share of its flux that may meet what does not shine, about: lamps far away send most of it past the scene.
    fn reached(&self, aims: &Aims) -> f32 {
        match self {
            Self::Area(a) => aims.reached(a.at(0.0).sample_place(Vec2::splat(0.5)).0),
            Self::Punctual(Punctual::Isotropic(light)) => aims.reached(light.position),
            _ => 1.0,
        }
    }
}

impl Lights {
    /// The luminous flux that a light sends into a sphere of a radius around the scene (an estimate for pictures and
    /// textures).
    fn flux(&self, light: &Light, radius: f32) -> f32 {
        let mode = self.mode();
        // Flux of parallel light: irradiance times the cross-section of the scene.
        let section = PI * radius * radius;
        match light {
            Light::Punctual(light) => light.flux(mode),
            Light::Distant(_, irradiance) => irradiance.luminance(mode) * section,
            Light::Environment(e) => {
                // A portal limits the flux to what passes its two sides.
                let through = e.portal.map_or(section, |[_, ex, ey]| 2.0 * ex.cross(ey).length());
                PI * e.mean_luminance() * through
            }
            Light::Area(a) => {
                let e = &self.emitters[a.emitter as usize];
                // Flux of a diffuse emitter: Φ = π·L·A on each side.
                PI * e.luminance * a.area() * if e.two_sided { 2.0 } else { 1.0 }
            }
            Light::DirectionalArea(a) => self.emitters[a.emitter as usize].luminance * a.area(),
        }
    }

    /// The oriented unit normal of a light at a point on it; of lights that are no surfaces the direction `w` of
    /// emission. At a moment of the exposure.
    pub fn normal_at(&self, light: u32, p: Vec3, w: Vec3, time: f32) -> Vec3 {
        match &self.lights[light as usize] {
            Light::Area(a) | Light::DirectionalArea(a) => a.at(time).normal_at(p),
            _ => w,
        }
    }

    /// True if light of an infinite light that comes along `-to` arrives at `p`: not if it comes past its portal.
    pub fn reaches(&self, light: u32, p: Vec3, to: Vec3, lambda: &Wavelengths) -> bool {
        match &self.lights[light as usize] {
            Light::Environment(e) if e.portal.is_some() => !e.radiance(p, to, lambda).is_black(),
            _ => true,
        }
    }
}

impl Environment {
    /// Luminance of the radiance, averaged over directions; of pictures with what a grid of directions may miss of
    /// their bright parts.
    fn mean_luminance(&self) -> f32 {
        if let Some(celestial) = &self.celestial {
            return celestial.fluence() * self.scale * 0.25 * FRAC_1_PI;
        }
        if self.image.is_none() {
            return self.radiance.luminance(self.mode) * self.scale;
        }
        // Average the map over a grid of directions of equal solid angle.
        const EDGE: u32 = 64;
        let mut sum = 0.0;
        for k in 0..EDGE * EDGE {
            let u = Vec2::new((k % EDGE) as f32 + 0.5, (k / EDGE) as f32 + 0.5) / EDGE as f32;
            let lambda = self.mode.wavelengths(|| (k % 61) as f32 / 61.0);
            sum += self.mode.luminance(self.beyond(warp::equal_area_square_to_sphere(u), &lambda), &lambda);
        }
        sum.max(0.0) / (EDGE * EDGE) as f32 + self.sampled_irradiance() * FRAC_1_PI
    }
}

impl AreaLight {
    /// Its area.
    pub fn area(&self) -> f32 {
        match &self.shape {
            AreaShape::Triangle(_, _, area) | AreaShape::Rectangle { area, .. } => *area,
            AreaShape::Sphere(_, r, _) => 4.0 * PI * r * r,
            AreaShape::Quadric(q) => q.area(),
            AreaShape::Swept(swept) => swept.area(),
            AreaShape::Moving(_) => self.at(0.0).area(),
        }
    }

    /// The reciprocal of the density of [`AreaLight::sample_place`] per area, where the unit normal is `n`.
    fn area_at(&self, n: Vec3) -> f32 {
        match &self.shape {
            AreaShape::Quadric(q) => q.area_at(n),
            AreaShape::Swept(swept) => swept.area_at(n),
            _ => self.area(),
        }
    }

    /// A point, about uniform over the area, its oriented normal, and where textures are looked up there.
    fn sample_place(&self, u: Vec2) -> (Vec3, Vec3, TextureContext<'_>) {
        let (p, n, uv) = match &self.shape {
            AreaShape::Triangle(v, n, _) => {
                // Uniform over the triangle by barycentric coordinates.
                let b = warp::uniform_triangle(u);
                (v[0] * b[0] + v[1] * b[1] + v[2] * b[2], *n, Vec2::new(b[1], b[2]))
            }
            AreaShape::Rectangle { corner, ex, ey, n, .. } => (*corner + *ex * u.x + *ey * u.y, *n, u),
            AreaShape::Sphere(c, r, inward) => {
                let n = warp::uniform_sphere(u);
                (*c + n * *r, if *inward { -n } else { n }, Vec2::ZERO)
            }
            AreaShape::Quadric(q) => {
                let s = q.surface_at(q.sample(u));
                (s.p, s.n, s.uv)
            }
            AreaShape::Swept(swept) => {
                let s = swept.sample(u);
                (s.p, s.n, s.uv)
            }
            // Moments are chosen before places.
            AreaShape::Moving(_) => (Vec3::ZERO, Vec3::Z, Vec2::ZERO),
        };
        (p, n, self.texture_context(p, uv))
    }

    /// Oriented unit normal at a point on the light.
    fn normal_at(&self, p: Vec3) -> Vec3 {
        match &self.shape {
            AreaShape::Triangle(_, n, _) | AreaShape::Rectangle { n, .. } => *n,
            AreaShape::Sphere(c, r, inward) => (p - *c) / if *inward { -*r } else { *r },
            AreaShape::Quadric(q) => q.surface_at(q.place.inverse().point(p)).n,
            AreaShape::Swept(swept) => swept.normal_at(p),
            AreaShape::Moving(_) => Vec3::Z,
        }
    }

    /// Origin of a ray that leaves a point of the light.
    fn leave(&self, p: Vec3, n: Vec3, w: Vec3) -> Vec3 {
        let size = match &self.shape {
            AreaShape::Triangle(v, ..) => v.iter().map(|v| v.abs().max_element()).fold(0.0, f32::max),
            AreaShape::Rectangle { corner, ex, ey, .. } => (corner.abs() + ex.abs() + ey.abs()).max_element(),
            AreaShape::Sphere(c, r, _) => c.abs().max_element() + r,
            AreaShape::Quadric(q) => p.abs().max_element() + q.world_radius(),
            AreaShape::Swept(swept) => {
                let bounds = swept.level().bounds();
                bounds.min.abs().max(bounds.max.abs()).max_element()
            }
            AreaShape::Moving(_) => 0.0,
        };
        // Offset against the rounding of the point's coordinates.
        offset_ray_origin(p, Vec3::splat(size * gamma(16)), n, w)
    }
}
