//! What a seen point sends to the eye.

use steradian_core::{
    Scene,
    bsdf::{Bsdf, TransportMode},
    light::{Light, LightContext},
    scene::Interaction,
};
use steradian_math::{Frame, Ray, Spectrum, Vec2, Vec3, spectra::Wavelengths};

use crate::{
    options::{Options, Show},
    shadow::Shadowing,
    visibility::Seen,
};

/// Scenes with more lights than this are lit by some of them, chosen for each point.
const FEW_LIGHTS: usize = 16;

/// What follows the way of a pixel's light.
pub struct Trace {
    /// Rays that were traced.
    pub rays: u64,
    /// The pixel, while what it sees itself is shaded.
    pub pixel: Option<usize>,
}

/// Shades points.
pub struct Shader<'a> {
    pub scene: &'a Scene,
    pub shadows: &'a Shadowing,
    pub options: &'a Options,
    /// Which of the samples of the pixel this is.
    pub pass: u32,
}

/// Numbers in [0, 1) for a purpose at a pixel: points of the R2 sequence, turned by a hash of pixel and purpose.
struct Numbers {
    pixel: u32,
    start: u32,
}

impl Numbers {
    fn hash(&self, purpose: u32) -> u32 {
        let mut h = self.pixel ^ purpose.wrapping_mul(0x9e37_79b9);
        h = (h ^ (h >> 16)).wrapping_mul(0x7feb_352d);
        h = (h ^ (h >> 15)).wrapping_mul(0x846c_a68b);
        h ^ (h >> 16)
    }

    fn get_2d(&self, purpose: u32, index: u32) -> Vec2 {
        let turn = |hash: u32, step: f64| {
            let x = f64::from(hash) / 4_294_967_296.0 + step * f64::from(self.start.wrapping_add(index));
            (x.fract() as f32).min(1.0 - f32::EPSILON)
        };
        let (first, second) = (self.hash(2 * purpose), self.hash(2 * purpose + 1));
        Vec2::new(turn(first, 0.754_877_666_246_692_7), turn(second, 0.569_840_290_998_053_2))
    }
}

fn shown(rgb: Vec3) -> Spectrum {
    Spectrum::rgb(rgb.x, rgb.y, rgb.z)
}

impl Shader<'_> {
    /// The light that arrives along a ray, and at which wavelengths.
    ///
    /// `rays` counts those that are traced.
    pub fn radiance(&self, ray: &Ray, seen: Option<Seen>, at: [u32; 2], rays: &mut u64) -> (Spectrum, Wavelengths) {
        let numbers =
            Numbers { pixel: at[0] ^ at[1].rotate_left(16), start: self.pass.wrapping_mul(self.options.points) };
        let lambda = self.scene.mode.wavelengths(|| numbers.get_2d(0, self.pass).x);
        if self.options.show != Show::Picture {
            return (self.lesson(ray, seen), Wavelengths::RGB);
        }
        let mut lambda = lambda;
        let pixel = (at[1] * self.scene.film.crop.width() + at[0]) as usize;
        let mut trace = Trace { rays: 0, pixel: Some(pixel) };
        let light = self.light(ray, seen, &numbers, &mut lambda, &mut trace);
        *rays += trace.rays;
        (light, lambda)
    }

    fn lesson(&self, ray: &Ray, seen: Option<Seen>) -> Spectrum {
        let Some(seen) = seen else { return Spectrum::ZERO };
        let i = self.scene.interaction(ray, &seen.hit);
        match self.options.show {
            Show::Depth => {
                let (center, radius) = crate::extent(self.scene);
                let eye = self.scene.camera.world_from_camera.point(Vec3::ZERO);
                let far = (center - eye).length() + radius;
                shown(Vec3::splat(1.0 - i.t / far).max(Vec3::ZERO))
            }
            Show::Normal => shown(i.surface.ns * 0.5 + 0.5),
            _ => {
                let h = Numbers { pixel: seen.number, start: 0 };
                shown(Vec3::from_array([1, 2, 3].map(|k| 0.1 + 0.9 * (h.hash(k) as f32 / 4_294_967_296.0))))
            }
        }
    }

    fn light(
        &self,
        ray: &Ray,
        seen: Option<Seen>,
        numbers: &Numbers,
        lambda: &mut Wavelengths,
        trace: &mut Trace,
    ) -> Spectrum {
        let scene = self.scene;
        let (mut ray, mut hit) = (*ray, seen.map(|s| s.hit));
        let (mut sum, mut throughput) = (Spectrum::ZERO, Spectrum::ONE);
        let mut bounce = 0;
        // Each mirror, pane and interface is one round.
        for round in 0..self.options.bounces + 64 {
            let Some(found) = hit else { return sum + throughput * self.background(&ray, lambda) };
            let i = scene.interaction_of_light(&ray, &found);
            sum += throughput * self.emission(&i, lambda);
            let choice = numbers.get_2d(1 + 8 * round, self.pass).x;
            let Some((scattering, frame)) = scene.scattering(&i, choice, lambda) else {
                ray = i.spawn(ray.direction);
                trace.pixel = None;
                trace.rays += 1;
                hit = scene.intersect(&ray);
                continue;
            };
            let bsdf = &scattering.bsdf;
            sum += throughput * self.direct(&i, &frame, bsdf, numbers, round, lambda, trace);
            // Mirrors and glass show what lies behind them.
            if bounce >= self.options.bounces {
                return sum;
            }
            bounce += 1;
            let (u, u2) = (numbers.get_2d(2 + 8 * round, self.pass).x, numbers.get_2d(3 + 8 * round, self.pass));
            let sample = bsdf.sample(frame.to_local(i.wo), u, u2, TransportMode::Radiance);
            let Some(s) = sample.filter(|s| s.lobe.is_specular()) else { return sum };
            throughput *= s.weight;
            ray = i.spawn(frame.to_world(s.wi));
            trace.pixel = None;
            trace.rays += 1;
            hit = scene.intersect(&ray);
        }
        sum
    }

    fn background(&self, ray: &Ray, lambda: &Wavelengths) -> Spectrum {
        let environments = self.scene.lights.environments.iter();
        environments.fold(Spectrum::ZERO, |sum, &light| match &self.scene.lights.lights[light as usize] {
            Light::Environment(e) => sum + e.radiance(ray.origin, ray.direction, lambda),
            _ => sum,
        })
    }

    fn emission(&self, i: &Interaction, lambda: &Wavelengths) -> Spectrum {
        let scene = self.scene;
        let Some(emitter) = scene.geometries[i.geometry as usize].emitter else { return Spectrum::ZERO };
        let at = || scene.texture_context(i);
        scene.lights.emitters[emitter as usize].radiance(i.surface.n, i.wo, at, lambda, &scene.textures)
    }

    /// The light of all lights, or of as many chosen ones as there are points on a light.
    #[allow(clippy::too_many_arguments)]
    fn direct(
        &self,
        i: &Interaction,
        frame: &Frame,
        bsdf: &Bsdf,
        numbers: &Numbers,
        round: u32,
        lambda: &Wavelengths,
        trace: &mut Trace,
    ) -> Spectrum {
        if bsdf.is_specular() {
            return Spectrum::ZERO;
        }
        let lights = &self.scene.lights;
        let ctx = LightContext { p: i.surface.p, n: if bsdf.has_transmission() { Vec3::ZERO } else { frame.z } };
        let points = self.options.points;
        let mut sum = Spectrum::ZERO;
        if lights.lights.len() > FEW_LIGHTS {
            for k in 0..points {
                let u = numbers.get_2d(4 + 8 * round, k).x;
                if let Some((light, p)) = lights.choose(&ctx, u) {
                    let u = numbers.get_2d(5 + 8 * round, k);
                    sum += self.one(light, p, None, u, i, &ctx, frame, bsdf, lambda, trace) / points as f32;
                }
            }
            return sum + self.sky(true, i, &ctx, frame, bsdf, numbers, round, lambda, trace);
        }
        for (number, light) in lights.lights.iter().enumerate() {
            // Points and parallel light have one place.
            let is_delta = !matches!(light, Light::Environment(_) | Light::Area(_));
            let count = if is_delta { 1 } else { points };
            let share = self.shadows.share(number as u32, i);
            for k in 0..count {
                let u = numbers.get_2d(1000 * (number as u32 + 1) + 6 + 8 * round, k);
                sum += self.one(number as u32, 1.0, share, u, i, &ctx, frame, bsdf, lambda, trace) / count as f32;
            }
        }
        sum + self.sky(false, i, &ctx, frame, bsdf, numbers, round, lambda, trace)
    }

    /// The light of environments in directions that the surface draws, weighted against those that the light draws.
    /// `chosen`: whether lights are chosen at random.
    #[allow(clippy::too_many_arguments)]
    fn sky(
        &self,
        chosen: bool,
        i: &Interaction,
        ctx: &LightContext,
        frame: &Frame,
        bsdf: &Bsdf,
        numbers: &Numbers,
        round: u32,
        lambda: &Wavelengths,
        trace: &mut Trace,
    ) -> Spectrum {
        let lights = &self.scene.lights;
        let mut sum = Spectrum::ZERO;
        if lights.environments.is_empty() {
            return sum;
        }
        for k in 0..self.options.points {
            let (u, u2) = (numbers.get_2d(6 + 8 * round, k).x, numbers.get_2d(7 + 8 * round, k));
            let sample = bsdf.sample(frame.to_local(i.wo), u, u2, TransportMode::Radiance);
            let Some(s) = sample.filter(|s| !s.lobe.is_specular()) else { continue };
            let wi = frame.to_world(s.wi);
            let mut arriving = Spectrum::ZERO;
            for &light in &lights.environments {
                let Light::Environment(e) = &lights.lights[light as usize] else { continue };
                let choice = lights.probability(ctx, light);
                let other = lights.environment_pdf(light, ctx, wi);
                let other = if chosen || choice <= 0.0 { other } else { other / choice };
                arriving += e.radiance(i.surface.p, wi, lambda) * power_heuristic(s.pdf, other);
            }
            if !arriving.is_black() && self.shadows.is_open(self.scene, &i.spawn(wi), trace) {
                sum += s.weight * arriving;
            }
        }
        sum / self.options.points as f32
    }

    /// The light of a place on a light that was chosen with probability `p`. `share`: how much of the light is seen,
    /// where that is known.
    #[allow(clippy::too_many_arguments)]
    fn one(
        &self,
        light: u32,
        p: f32,
        share: Option<f32>,
        u: Vec2,
        i: &Interaction,
        ctx: &LightContext,
        frame: &Frame,
        bsdf: &Bsdf,
        lambda: &Wavelengths,
        trace: &mut Trace,
    ) -> Spectrum {
        let Some(s) = self.scene.lights.sample(light, ctx, u, lambda, &self.scene.textures) else {
            return Spectrum::ZERO;
        };
        let e = bsdf.eval(frame.to_local(i.wo), frame.to_local(s.wi), TransportMode::Radiance);
        if e.value.is_black() || s.radiance.is_black() {
            return Spectrum::ZERO;
        }
        let lit = share.unwrap_or_else(|| self.shadows.lit(self.scene, light, i, &s, trace));
        if lit <= 0.0 {
            return Spectrum::ZERO;
        }
        // Environments are found by the surface's directions, too.
        let is_environment = matches!(self.scene.lights.lights[light as usize], Light::Environment(_));
        let weight = if is_environment { power_heuristic(s.pdf * p, e.pdf) } else { 1.0 };
        e.value * s.radiance * (lit * weight / (s.pdf * p))
    }
}

/// The power heuristic with exponent two for one sample of each of two techniques (Veach 1997, eq. 9.13).
fn power_heuristic(a: f32, b: f32) -> f32 {
    if a.is_infinite() {
        return 1.0;
    }
    let (a2, b2) = (a * a, b * b);
    if a2 + b2 > 0.0 { a2 / (a2 + b2) } else { 0.0 }
}
