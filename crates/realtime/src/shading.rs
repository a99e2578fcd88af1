//! Radiance of visible points towards the eye.

use steradian_bsdf::{Bsdf, BsdfSample, SplitSum, TransportMode};
use steradian_core::{
    Scene,
    footprint::{Bounce, RayDifferential},
    light::{Light, LightContext},
    material::Scattering,
    scene::{Hit, Interaction},
};
use steradian_math::{Frame, Ray, Spectrum, Vec2, Vec3, spectra::Wavelengths};
use steradian_transport::{Depth, nee, power_heuristic};

use crate::{
    clusters::Clusters,
    image_light::ImageLights,
    options::{FrameKind, LightChoice, Options, Show},
    shading_model::Normals,
    shadow::Shadowing,
    trace::Trace,
    visibility::Seen,
};

/// Scenes with more lights than this are lit by some of them, chosen for each point.
const FEW_LIGHTS: usize = 16;
/// Surfaces that scatter nothing and are passed, beside mirrors and glass.
pub const MOST_PASSED: u32 = 64;

/// Shades points.
pub struct Shader<'a> {
    pub scene: &'a Scene,
    pub shadows: &'a Shadowing,
    pub options: &'a Options,
    /// The most scattering events, and whether the camera sees lights.
    pub depth: &'a Depth,
    /// Which of the samples of the pixel this is.
    pub pass: u32,
    pub seed: u64,
    /// Environments that light diffuse surfaces by their coefficients, where the options ask for that.
    pub image_lights: Option<&'a ImageLights>,
    /// Lights by cells of the view, where the options ask for that.
    pub clusters: Option<&'a Clusters>,
}

/// A point that scatters, on the path of a pixel.
pub struct Point<'a> {
    pub i: Interaction,
    pub frame: Frame,
    pub scattering: Scattering<'a>,
    pub ctx: LightContext,
    pub lambda: Wavelengths,
    /// Path throughput β up to the point.
    pub beta: Spectrum,
    pub numbers: &'a Numbers,
    /// Its number among the points of the path.
    pub round: u32,
}

/// A path from the camera, as far as it is followed.
#[derive(Clone, Copy, Debug)]
pub struct CameraPath {
    /// Next ray of the path, and its hit.
    pub ray: Ray,
    pub hit: Option<Hit>,
    pub differential: Option<RayDifferential>,
    /// Path throughput β.
    pub beta: Spectrum,
    /// Scattering events so far.
    pub events: u32,
    /// The round whose random numbers come first.
    pub round: u32,
    /// True if lights on the path count.
    pub sees_lights: bool,
}

impl CameraPath {
    /// True if the path passes a surface straight: an emitter, where lights are hidden from the camera.
    pub fn passes_straight(&self, scene: &Scene, i: &Interaction) -> bool {
        self.events == 0 && !self.sees_lights && scene.geometries()[i.geometry as usize].emitter.is_some()
    }

    /// From the camera.
    pub fn start(shader: &Shader<'_>, ray: &Ray, seen: Option<Seen>) -> Self {
        let differential = shader.scene.ray_differential(ray);
        let sees_lights = !shader.depth.hide_emitters;
        let hit = seen.map(|s| s.hit);
        Self { ray: *ray, hit, differential, beta: Spectrum::ONE, events: 0, round: 0, sees_lights }
    }
}

/// The steps of sequences, by purpose: of the R2 sequence, and of square roots, which share no period with it.
const STEPS: [[f64; 2]; 4] = [
    [0.754_877_666_246_692_7, 0.569_840_290_998_053_2],
    [0.414_213_562_373_095_05, 0.732_050_807_568_877_3],
    [0.236_067_977_499_789_7, 0.645_751_311_064_590_6],
    [0.316_624_790_355_399_85, 0.605_551_275_463_989_3],
];

/// Numbers in [0, 1) for a purpose at a pixel: points of the R2 sequence, turned by a hash of pixel and purpose. Those
/// of previews are one sequence for all pixels, along a curve through blocks within blocks, so that pixels side by side
/// have points that are spread evenly; then each purpose has steps of its own.
pub struct Numbers {
    pixel: u32,
    start: u32,
    is_shared: bool,
}

impl Numbers {
    fn hash(&self, purpose: u32) -> u32 {
        // Integer hash with good avalanche, of pixel and purpose.
        let mut h = self.pixel ^ purpose.wrapping_mul(0x9e37_79b9);
        h = (h ^ (h >> 16)).wrapping_mul(0x7feb_352d);
        h = (h ^ (h >> 15)).wrapping_mul(0x846c_a68b);
        h ^ (h >> 16)
    }

    pub fn get_2d(&self, purpose: u32, index: u32) -> Vec2 {
        // A rotation of the Kronecker sequence frac(n α) by a hash (Cranley, Patterson 1976).
        let turn = |hash: u32, step: f64| {
            let x = f64::from(hash) / 4_294_967_296.0 + step * f64::from(self.start.wrapping_add(index));
            (x.fract() as f32).min(1.0 - f32::EPSILON)
        };
        let (first, second) = (self.hash(2 * purpose), self.hash(2 * purpose + 1));
        let [x, y] = STEPS[if self.is_shared { purpose as usize % STEPS.len() } else { 0 }];
        Vec2::new(turn(first, x), turn(second, y))
    }
}

impl<'a> Shader<'a> {
    pub fn numbers(&self, at: [u32; 2]) -> Numbers {
        let seed = (self.seed ^ self.seed >> 32) as u32;
        let seed = seed.wrapping_mul(0x85eb_ca6b);
        if self.is_preview() {
            // Neighbouring pixels take neighbouring points of one sequence along the Z-order curve, so that the filter
            // averages a stratified set.
            let start = morton(at).wrapping_add(self.pass.wrapping_mul(0x9e37_79b9));
            return Numbers { pixel: seed, start, is_shared: true };
        }
        let pixel = at[0] ^ at[1].rotate_left(16) ^ seed;
        Numbers { pixel, start: self.pass.wrapping_mul(self.options.points), is_shared: false }
    }

    /// True for previews: rays drawn by surfaces find area lights, too, and pixels share a sequence.
    fn is_preview(&self) -> bool {
        self.options.frame == FrameKind::Preview
    }

    /// The wavelengths of a pixel's light.
    pub fn wavelengths(&self, at: [u32; 2]) -> Wavelengths {
        self.scene.mode().wavelengths(|| self.numbers(at).get_2d(0, self.pass).x)
    }

    /// A view that shows what is seen, not its light.
    pub fn view(&self, ray: &Ray, seen: Option<Seen>) -> Vec3 {
        let Some(seen) = seen else { return Vec3::ZERO };
        let i = self.scene.interaction(ray, &seen.hit);
        match self.options.show {
            Show::Depth => {
                let (center, radius) = crate::extent(self.scene);
                let eye = self.scene.camera().world_from_camera.point(Vec3::ZERO);
                let far = (center - eye).length() + radius;
                Vec3::splat(1.0 - i.t / far).max(Vec3::ZERO)
            }
            Show::Normal => i.surface.ns * 0.5 + 0.5,
            _ => {
                let h = Numbers { pixel: seen.number, start: 0, is_shared: false };
                Vec3::from_array([1, 2, 3].map(|k| 0.1 + 0.9 * (h.hash(k) as f32 / 4_294_967_296.0)))
            }
        }
    }

    /// The light that arrives along a ray which sees this.
    pub fn radiance(
        &self,
        ray: &Ray,
        seen: Option<Seen>,
        numbers: &Numbers,
        lambda: &mut Wavelengths,
        trace: &mut Trace<'_>,
    ) -> Spectrum {
        self.follow(CameraPath::start(self, ray, seen), numbers, lambda, trace)
    }

    /// The light that comes along a path, past mirrors, glass and interfaces to the first surface that scatters
    /// otherwise, and from there straight from lights.
    pub fn follow(
        &self,
        mut path: CameraPath,
        numbers: &Numbers,
        lambda: &mut Wavelengths,
        trace: &mut Trace<'_>,
    ) -> Spectrum {
        let scene = self.scene;
        let mut sum = Spectrum::ZERO;
        // Each mirror, pane and interface is one round.
        for round in path.round..path.round + self.options.bounces + MOST_PASSED {
            // The background, unless a light sample has accounted for it.
            let CameraPath { ray, hit, beta, .. } = path;
            let Some(found) = hit else {
                return if path.sees_lights {
                    sum + self.background(&ray, path.events, beta, lambda, trace)
                } else {
                    sum
                };
            };
            // Emission, seen directly or by mirrors.
            let mut i = scene.interaction_of_light(&ray, &found);
            // The shading model holds for what the camera sees.
            let normals = if path.events == 0 { self.options.shading.normals() } else { Normals::Mapped };
            normals.set(&mut i);
            // What no light sample finds, such as an infinite plane, is found here alone.
            let is_sampled = || scene.light(&i).is_some();
            if path.sees_lights || (path.events > 0 && !is_sampled()) {
                sum += self.emission(&i, beta, lambda, trace);
            }
            // Scattering of the surface; interfaces and hidden lights have none, and are passed straight.
            let choice = numbers.get_2d(1 + 8 * round, self.pass).x;
            let surface = match path.passes_straight(scene, &i) {
                true => None,
                false => scene.scattering_along(&i, path.differential.as_ref(), choice, lambda),
            };
            match surface {
                None => {
                    path.differential = path.differential.map(|d| d.advance(i.t));
                    path.ray = i.rest(&ray);
                }
                Some(_) if path.events >= self.depth.max => return sum,
                Some((scattering, frame)) => {
                    // Direct light; then only specular lobes go on.
                    let (scattering, frame) = normals.unmapped(&i, (scattering, frame));
                    let ctx = nee::context(&i, &frame, &scattering.bsdf);
                    let point = Point { i, frame, scattering, ctx, lambda: *lambda, beta, numbers, round };
                    sum += self.ambient(&point, trace) + self.direct(&point, trace);
                    // Mirrors and glass show what lies behind them.
                    if path.events >= self.options.bounces {
                        return sum;
                    }
                    // Continue only by specular lobes, and by those of frosted glass, whose lights are found by light
                    // samples.
                    let is_glass = matches!(point.scattering.bsdf, Bsdf::Dielectric(_));
                    let goes_on = |s: &BsdfSample| s.lobe.is_specular() || is_glass;
                    let Some(s) = self.draw(&point).filter(goes_on) else { return sum };
                    path = CameraPath { sees_lights: s.lobe.is_specular(), ..self.extended(&point, &s, path) };
                }
            }
            // From here on the point is no longer the one that the pixel sees, so that shadow data of the picture do
            // not apply.
            trace.pixel = None;
            if trace.counters.stop.is_asked() {
                return sum;
            }
            path.hit = trace.nearest(scene, &path.ray);
        }
        sum
    }

    /// Radiance emitted by a surface point towards the eye.
    pub fn emission(&self, i: &Interaction, beta: Spectrum, lambda: &Wavelengths, trace: &mut Trace<'_>) -> Spectrum {
        let scene = self.scene;
        let Some(emitter) = scene.geometries()[i.geometry as usize].emitter else { return Spectrum::ZERO };
        let light = beta * nee::emission(scene, i, &None, lambda);
        trace.counters.note_group(|| Some(scene.light_groups().of_emitters[emitter as usize]), light);
        light
    }

    /// A direction drawn by the surface at a point.
    pub fn draw(&self, point: &Point<'_>) -> Option<BsdfSample> {
        let Point { i, frame, scattering, numbers, round, .. } = point;
        let u = numbers.get_2d(2 + 8 * round, self.pass).x;
        let u2 = numbers.get_2d(3 + 8 * round, self.pass);
        scattering.sample(frame.to_local(i.wo), u, u2, TransportMode::Radiance)
    }

    /// The path on from a point in a direction that was drawn there; what it meets is yet to be found.
    pub fn extended(&self, point: &Point<'_>, s: &BsdfSample, path: CameraPath) -> CameraPath {
        // The footprint goes along with the ray (Igehy 1999), so that textures in mirrors are filtered too.
        let ray = point.i.spawn(point.frame.to_world(s.wi));
        let differential = path
            .differential
            .zip(Bounce::of(s))
            .and_then(|(d, bounce)| self.scene.scatter_differential(&point.i, &d, ray.direction, bounce));
        let beta = path.beta * s.weight;
        CameraPath { ray, hit: None, differential, beta, events: path.events + 1, sees_lights: true, ..path }
    }

    /// The ambient term k_a L_a of forward frames; the others find the light that it stands for.
    fn ambient(&self, point: &Point<'_>, trace: &mut Trace<'_>) -> Spectrum {
        if self.options.frame != FrameKind::Forward {
            return Spectrum::ZERO;
        }
        let Point { i, frame, scattering, lambda, beta, .. } = point;
        self.scene.ambient(i, scattering, frame.to_local(i.wo), lambda).fold(Spectrum::ZERO, |sum, (group, light)| {
            trace.counters.note_group(|| Some(group), *beta * light);
            sum + *beta * light
        })
    }

    /// Light from infinity, or the backdrop, along a ray that left the scene after a number of events.
    pub fn background(
        &self,
        ray: &Ray,
        events: u32,
        beta: Spectrum,
        lambda: &Wavelengths,
        trace: &mut Trace<'_>,
    ) -> Spectrum {
        let scene = self.scene;
        if events == 0 && scene.lights().backdrop.is_some() {
            return beta * nee::behind(scene, ray, events, &None, lambda);
        }
        scene.lights().environments.iter().fold(Spectrum::ZERO, |sum, &light| {
            let found = beta * nee::environment(scene, light, ray.origin, ray.direction, &None, lambda);
            trace.counters.note_group(|| Some(scene.light_groups().of_lights[light as usize]), found);
            sum + found
        })
    }

    /// The light of all lights, or of as many chosen ones as there are points on a light.
    pub fn direct(&self, point: &Point<'_>, trace: &mut Trace<'_>) -> Spectrum {
        if point.scattering.bsdf.is_specular() {
            return Spectrum::ZERO;
        }
        let lights = self.scene.lights();
        let (numbers, round, points) = (point.numbers, point.round, self.options.points);
        // Environments as image-based light, for surfaces that are split in two sums.
        let wo = point.frame.to_local(point.i.wo);
        let image_lights = self.image_lights.and_then(|known| Some((known, known.split(&point.scattering.bsdf, wo)?)));
        let is_done = |light: u32| image_lights.is_some_and(|(known, _)| known.has(light));
        let mut sum = image_lights.map_or(Spectrum::ZERO, |lights| self.by_image_lights(point, lights, trace));
        // Lights of the point's cell; beyond the view as without cells.
        let in_cell = self.clusters.and_then(|clusters| clusters.at(point.i.surface.p));
        // Many lights: one is chosen for each sample, in proportion to its bound in the light tree. Lights of the cell
        // are asked in any case.
        let is_asked = |light: &u32| in_cell.is_some_and(|in_cell| in_cell.binary_search(light).is_ok());
        // Previews, whose filter takes the noise, draw four of five lights and more.
        let (few, drawn) = match self.is_preview() && lights.lights.len() <= FEW_LIGHTS {
            true => (FEW_LIGHTS / 4, points.max(FEW_LIGHTS as u32 / 4)),
            false => (FEW_LIGHTS, points),
        };
        let is_chosen = lights.lights.len() > few && self.options.lights != LightChoice::All;
        if is_chosen {
            for k in 0..drawn {
                let u = numbers.get_2d(4 + 8 * round, k).x;
                let chosen = lights.choose(&point.ctx, u).filter(|(light, _)| !is_done(*light) && !is_asked(light));
                if let Some((light, p)) = chosen {
                    let u = numbers.get_2d(5 + 8 * round, k);
                    sum += self.light_of(point, (light, p), None, u, 1.0 / drawn as f32, trace);
                }
            }
        }
        if is_chosen && in_cell.is_none() {
            return sum + self.bsdf_sampled(point, true, is_done, trace);
        }
        // Few lights: each is asked, with as many points as the options say.
        let mut ask = |number: u32| {
            if is_done(number) {
                return;
            }
            // Points and parallel light have one place.
            let is_delta = !matches!(lights.lights[number as usize], Light::Environment(_) | Light::Area(_));
            let count = if is_delta { 1 } else { points };
            let share = self.shadows.share(number, &point.i);
            for k in 0..count {
                let u = numbers.get_2d(1000u32.wrapping_mul(number + 1).wrapping_add(6 + 8 * round), k);
                sum += self.light_of(point, (number, 1.0), share, u, 1.0 / count as f32, trace);
            }
        };
        match in_cell {
            Some(in_cell) => in_cell.iter().copied().for_each(&mut ask),
            None => (0..lights.lights.len() as u32).for_each(&mut ask),
        }
        sum + self.bsdf_sampled(point, false, is_done, trace)
    }

    /// The light of environments by two sums.
    fn by_image_lights(
        &self,
        point: &Point<'_>,
        (known, split): (&ImageLights, SplitSum),
        trace: &mut Trace<'_>,
    ) -> Spectrum {
        let (n, wo) = (point.frame.z, point.i.wo);
        let mirrored = n * (2.0 * n.dot(wo)) - wo;
        known.reflected(split, n, mirrored).fold(Spectrum::ZERO, |sum, (group, light)| {
            let found = point.beta * light;
            trace.counters.note_group(|| Some(group), found);
            sum + found
        })
    }

    /// The light of environments in directions that the surface draws, weighted against those that the light draws; in
    /// previews also that of lights with an area. `chosen`: whether lights are chosen at random; lights that are done
    /// already are left out.
    fn bsdf_sampled(
        &self,
        point: &Point<'_>,
        chosen: bool,
        is_done: impl Fn(u32) -> bool,
        trace: &mut Trace<'_>,
    ) -> Spectrum {
        let Point { i, frame, scattering, ctx, lambda, beta, numbers, round } = point;
        let lights = self.scene.lights();
        let mut sum = Spectrum::ZERO;
        if lights.environments.iter().all(|light| is_done(*light)) && !self.is_preview() {
            return sum;
        }
        let wo = frame.to_local(i.wo);
        for k in 0..self.options.points {
            let (u, u2) = (numbers.get_2d(6 + 8 * round, k).x, numbers.get_2d(7 + 8 * round, k));
            // The second technique of MIS: a direction by the BSDF, without specular lobes, which the path itself
            // follows.
            let drawn = scattering.sample(wo, u, u2, TransportMode::Radiance);
            let Some(s) = drawn.filter(|s| !s.lobe.is_specular()) else { continue };
            let wi = frame.to_world(s.wi);
            // Previews trace the direction and find area lights too; otherwise only environments matter.
            let mut open = None;
            if self.is_preview() {
                let ray = i.spawn(wi);
                let hit = trace.nearest(self.scene, &ray);
                open = Some(f32::from(u8::from(hit.is_none())));
                if let Some(hit) = hit {
                    let light = self.met(point, (&ray, &hit), s.pdf, chosen);
                    sum += *beta * s.weight * light / self.options.points as f32;
                }
            }
            for &light in lights.environments.iter().filter(|light| !is_done(**light)) {
                let Light::Environment(e) = &lights.lights[light as usize] else { continue };
                // Its density by light sampling. Where all lights are asked, the probability of the choice is divided
                // out.
                let choice = lights.probability(ctx, light);
                let other = lights.environment_pdf(light, ctx, wi);
                let other = if chosen || choice <= 0.0 { other } else { other / choice };
                let arriving = e.radiance(i.surface.p, wi, lambda) * power_heuristic(s.pdf, other);
                // One ray, and none where it is dark.
                if arriving.is_black() {
                    continue;
                }
                let open = *open.get_or_insert_with(|| self.shadows.of_sky(self.scene, &i.spawn(wi), trace));
                let group = self.scene.light_groups().of_lights[light as usize];
                let found = *beta * s.weight * arriving * (open / self.options.points as f32);
                trace.counters.note_group(|| Some(group), found);
                sum += found;
            }
        }
        sum
    }

    /// Light from an area light that a ray drawn by the surface with density `pdf` meets, weighted by MIS.
    fn met(&self, point: &Point<'_>, (ray, hit): (&Ray, &Hit), pdf: f32, chosen: bool) -> Spectrum {
        let (scene, lights) = (self.scene, self.scene.lights());
        if scene.geometry(hit.id).emitter.is_none() {
            return Spectrum::ZERO;
        }
        let i = scene.interaction_of_light(ray, hit);
        let Some(light) = scene.light(&i) else { return Spectrum::ZERO };
        // Combine with light sampling, whose density is converted to solid angle.
        let choice = lights.probability(&point.ctx, light);
        let other = lights.area_pdf(light, &point.ctx, (ray.direction, i.t), i.surface.n, point.lambda.time);
        let other = if chosen || choice <= 0.0 { other } else { other / choice };
        nee::emission(scene, &i, &None, &point.lambda) * power_heuristic(pdf, other)
    }

    /// The light of a place on a light that was chosen with a probability, in this part. `share`: how much of the light
    /// is seen, where that is known.
    fn light_of(
        &self,
        Point { i, frame, scattering, ctx, lambda, beta, .. }: &Point<'_>,
        (light, p): (u32, f32),
        share: Option<f32>,
        u: Vec2,
        part: f32,
        trace: &mut Trace<'_>,
    ) -> Spectrum {
        let Some(s) = self.scene.lights().sample(light, ctx, u, lambda, self.scene.textures()) else {
            return Spectrum::ZERO;
        };
        // Before the shadow ray, since most samples behind the surface end here.
        let e = scattering.eval(frame.to_local(i.wo), frame.to_local(s.wi), TransportMode::Radiance);
        if e.value.is_black() || s.radiance.is_black() {
            return Spectrum::ZERO;
        }
        // Visibility by the technique of the options: a share of the light, or a shadow ray.
        let lit = share.unwrap_or_else(|| self.shadows.lit(self.scene, light, i, &s, trace));
        if lit <= 0.0 {
            return Spectrum::ZERO;
        }
        // These are found by the surface's directions, too.
        let is_met = match self.scene.lights().lights[light as usize] {
            Light::Environment(_) => true,
            Light::Area(_) => self.is_preview(),
            _ => false,
        };
        let weight = if is_met { power_heuristic(s.pdf * p, e.pdf) } else { 1.0 };
        // β · f cos θ · L · V · w / p, averaged over the samples.
        let found = *beta * e.value * s.radiance * (lit * weight * part / (s.pdf * p));
        trace.counters.note_group(|| Some(self.scene.light_groups().of_lights[light as usize]), found);
        found
    }
}

/// The place of a pixel on the Z-order curve.
fn morton([x, y]: [u32; 2]) -> u32 {
    // Interleaves zeros between 16 bits.
    let spread = |x: u32| {
        let x = (x | (x << 8)) & 0x00ff_00ff;
        let x = (x | (x << 4)) & 0x0f0f_0f0f;
        let x = (x | (x << 2)) & 0x3333_3333;
        (x | (x << 1)) & 0x5555_5555
    };
    spread(x & 0xffff) | (spread(y & 0xffff) << 1)
}
