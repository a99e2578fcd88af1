//! A hybrid frame under way: what is seen comes from rasterisation, what light does from rays, term by term.

use super::{
    Setting,
    filter::{Filters, filter},
    graph::Resource,
    surface::{Surface, surface},
};
use crate::{
    Error,
    projection::Projected,
    shading::{CameraPath, Point, Shader},
    trace::Trace,
    visibility::{Visibility, Wanted},
};
use std::collections::BTreeMap;
use steradian_bsdf::{BsdfSample, Lobe};
use steradian_denoise::svgf::Denoiser;
use steradian_engine::Counters;
use steradian_math::{Ray, Spectrum, Vec3, spectra::Wavelengths, warp};
use steradian_transport::nee;

/// Reach of ambient occlusion, as a fraction of the scene's radius.
const OCCLUSION_REACH: f32 = 0.1;
/// Rounds between the random numbers of the terms.
const ROUNDS: u32 = 200;

/// A picture, by rows.
pub type Picture = Vec<Vec3>;

/// A frame under path.
pub struct Frame<'a> {
    pub setting: &'a Setting<'a>,
    pub projected: Projected,
    /// By the pass that rasterises.
    pub visibility: Option<Visibility>,
    /// By the pass of the G-buffer; `None` where nothing is seen.
    pub surfaces: Vec<Option<Surface>>,
    /// Pictures written by the other passes.
    pub pictures: BTreeMap<Resource, Picture>,
    pub counters: Counters,
    /// Denoisers with the history of frames before, and then of this one.
    pub filters: Filters,
}

/// The point that a pixel sees, with the ray of the eye.
struct Seen<'a> {
    ray: Ray,
    surface: &'a Surface,
    at: [u32; 2],
}

impl<'a> Frame<'a> {
    pub fn new(setting: &'a Setting<'a>, projected: Projected, filters: Filters) -> Self {
        Self {
            setting,
            projected,
            visibility: None,
            surfaces: Vec::new(),
            pictures: BTreeMap::new(),
            counters: Counters::default(),
            filters,
        }
    }

    /// Which primitive each pixel sees.
    pub fn rasterise(&mut self) -> Result<(), Error> {
        let Setting { run, list, pool, options, .. } = self.setting;
        // Each method of hidden surfaces fills the same visibility buffer.
        let wanted = || Wanted { method: Some(options.visibility), ..Wanted::default() };
        let draw = || Visibility::draw_wanted(run.scene, list, &self.projected, wanted());
        self.visibility = Some(pool.install(draw)?);
        Ok(())
    }

    /// The surfaces that pixels see: the G-buffer.
    pub fn gbuffer(&mut self) -> Result<(), Error> {
        // Intersect the pixel's ray with the primitive that rasterisation found: depth, normal and albedo are exact.
        let found = self.pixels(|frame, at, shader, _| {
            let Setting { run, list, before, .. } = frame.setting;
            let seen = frame.visibility.as_ref()?.seen(run.scene, list, &frame.projected, at)?;
            surface(run.scene, (&frame.projected, at), seen.hit, &shader.wavelengths(at), *before)
        })?;
        self.surfaces = found;
        Ok(())
    }

    /// Emission of visible surfaces, and the background.
    pub fn emission(&mut self) -> Result<(), Error> {
        self.write(Resource::Emission, |frame, at, shader, trace| {
            let lambda = shader.wavelengths(at);
            let ray = frame.projected.ray(shader.scene, at);
            if shader.depth.hide_emitters {
                return Vec3::ZERO;
            }
            // Emission and background carry no noise and are not filtered.
            let light = match frame.seen(at) {
                None => shader.background(&ray, 0, Spectrum::ONE, &lambda, trace),
                Some(seen) => {
                    let i = shader.scene.interaction_of_light(&seen.ray, &seen.surface.hit);
                    shader.emission(&i, Spectrum::ONE, &lambda, trace)
                }
            };
            // Tristimulus values of the light, developed as the film does it.
            frame.rgb(light, &lambda)
        })
    }

    /// Light of lights, with shadows by rays, over albedo.
    pub fn direct(&mut self) -> Result<(), Error> {
        self.write(Resource::Direct, |frame, at, shader, trace| {
            // Next-event estimation at the visible point, demodulated by albedo.
            let Some(seen) = frame.seen(at) else { return Vec3::ZERO };
            let light = frame.at(&seen, shader, 0, |point, _| shader.direct(point, trace));
            seen.surface.over_albedo(light)
        })
    }

    /// Light after a diffuse bounce, over albedo.
    pub fn indirect(&mut self) -> Result<(), Error> {
        self.write(Resource::Indirect, |frame, at, shader, trace| {
            let Some(seen) = frame.seen(at) else { return Vec3::ZERO };
            // The lobes are divided among three terms: each draws by the whole BSDF and keeps its own lobes, so that
            // the sum of the terms has the right expectation.
            let is_diffuse = |lobe: Lobe| !lobe.is_transmission() && lobe.is_diffuse();
            seen.surface.over_albedo(frame.bounce(&seen, shader, 1, is_diffuse, trace))
        })
    }

    /// Light by glossy and mirror reflection.
    pub fn reflections(&mut self) -> Result<(), Error> {
        self.write(Resource::Reflections, |frame, at, shader, trace| {
            let Some(seen) = frame.seen(at) else { return Vec3::ZERO };
            frame.bounce(&seen, shader, 2, |lobe| !lobe.is_transmission() && !lobe.is_diffuse(), trace)
        })
    }

    /// Light that surfaces let through.
    pub fn transparency(&mut self) -> Result<(), Error> {
        self.write(Resource::Transparency, |frame, at, shader, trace| {
            let Some(seen) = frame.seen(at) else { return Vec3::ZERO };
            frame.bounce(&seen, shader, 3, Lobe::is_transmission, trace)
        })
    }

    /// The part of the hemisphere, weighted by the cosine, in which nothing is near.
    pub fn occlusion(&mut self) -> Result<(), Error> {
        let (_, radius) = crate::extent(self.setting.run.scene);
        self.write(Resource::Occlusion, |frame, at, shader, trace| {
            let Some(seen) = frame.seen(at) else { return Vec3::ONE };
            // Ambient occlusion by rays: 1/π ∫ V(ω) cos θ dω, sampled in proportion to the cosine.
            let i = shader.scene.interaction_of_light(&seen.ray, &seen.surface.hit);
            let axis = seen.surface.normal;
            // The hemisphere on the side of the eye.
            let axis = if axis.dot(i.wo) < 0.0 { -axis } else { axis };
            let (numbers, points) = (shader.numbers(at), shader.options.points);
            let frame = steradian_math::Frame::from_z(axis);
            let open = (0..points).filter(|k| {
                // Cosine-distributed directions: the share of open ones estimates 1/π ∫ V cosθ dω.
                let w = frame.to_world(warp::cosine_hemisphere(numbers.get_2d(3 + 8 * 4 * ROUNDS, *k)));
                !trace.is_occluded(shader.scene, &i.spawn_towards(w, OCCLUSION_REACH * radius))
            });
            Vec3::splat(open.count() as f32 / points as f32)
        })
    }

    /// Terms without noise.
    pub fn filter(
        &mut self,
        terms: &[(Resource, Resource)],
        which: fn(&mut Filters) -> &mut Denoiser,
    ) -> Result<(), Error> {
        let noisy = terms.iter().map(|(from, _)| self.picture(*from)).collect();
        // The denoiser reprojects its history, accumulates, estimates variance and applies its wavelet passes.
        let crop = self.setting.run.scene.film().crop;
        let (size, denoiser) = ([crop.width(), crop.height()], which(&mut self.filters));
        let filtered = self.setting.pool.install(|| filter(denoiser, &self.surfaces, size, noisy))?;
        self.pictures.extend(terms.iter().map(|(_, to)| *to).zip(filtered));
        Ok(())
    }

    /// All terms together, those over albedo times that.
    pub fn composite(&mut self, terms: &[(Resource, bool)]) -> Result<(), Error> {
        self.write(Resource::Picture, |frame, at, _, _| {
            let k = frame.index(at);
            // Terms that were filtered over albedo get it back.
            let albedo = frame.surfaces[k].as_ref().map_or(Vec3::ZERO, |s| s.albedo);
            terms.iter().fold(Vec3::ZERO, |sum, (term, over_albedo)| {
                let light = frame.pictures.get(term).map_or(Vec3::ZERO, |picture| picture[k]);
                sum + if *over_albedo { light * albedo } else { light }
            })
        })
    }

    /// Takes the picture that a pass wrote.
    pub fn picture(&mut self, resource: Resource) -> Picture {
        self.pictures.remove(&resource).unwrap_or_default()
    }

    /// Light by a direction drawn from the lobes that are asked for. Straight from lights it is found already, unless
    /// the surface mirrors.
    fn bounce(
        &self,
        seen: &Seen<'_>,
        shader: &Shader<'_>,
        term: u32,
        is_asked: impl Fn(Lobe) -> bool,
        trace: &mut Trace<'_>,
    ) -> Vec3 {
        let numbers = shader.numbers(seen.at);
        self.at(seen, shader, term * ROUNDS, |point, lambda| {
            // One direction for each pixel and frame; the filter does the rest.
            let drawn: Option<BsdfSample> = shader.draw(point).filter(|s| is_asked(s.lobe));
            let Some(s) = drawn.filter(|_| shader.depth.max > 0) else { return Spectrum::ZERO };
            let eye = CameraPath { round: point.round + 1, ..CameraPath::start(shader, &seen.ray, None) };
            // Emission counts behind specular lobes only: the term of direct light has the rest by light samples.
            let path = CameraPath { sees_lights: s.lobe.is_specular(), ..shader.extended(point, &s, eye) };
            if trace.counters.stop.is_asked() {
                return Spectrum::ZERO;
            }
            // The ray leaves the pixel's own surface: shadows told for the pixel no longer apply.
            trace.pixel = None;
            let hit = trace.nearest(shader.scene, &path.ray);
            shader.follow(CameraPath { hit, ..path }, &numbers, lambda, trace)
        })
    }

    /// Light found by `find` at the visible point of a pixel, as RGB.
    fn at(
        &self,
        seen: &Seen<'_>,
        shader: &Shader<'_>,
        round: u32,
        find: impl FnOnce(&Point<'_>, &mut Wavelengths) -> Spectrum,
    ) -> Vec3 {
        let (scene, numbers) = (shader.scene, shader.numbers(seen.at));
        let mut lambda = shader.wavelengths(seen.at);
        let i = scene.interaction_of_light(&seen.ray, &seen.surface.hit);
        let differential = scene.ray_differential(&seen.ray);
        // Evaluate textures with the footprint of the primary ray.
        let choice = numbers.get_2d(1, shader.pass).x;
        let found = scene.scattering_along(&i, differential.as_ref(), choice, &mut lambda);
        let Some((scattering, frame)) = found.filter(|_| shader.depth.max > 0) else { return Vec3::ZERO };
        // The context of light sampling has the normal's side and what the BSDF can scatter.
        let ctx = nee::context(&i, &frame, &scattering.bsdf);
        let numbers = &numbers;
        let point = Point { i, frame, scattering, ctx, lambda, beta: Spectrum::ONE, numbers, round };
        let light = find(&point, &mut lambda);
        self.rgb(light, &lambda)
    }

    fn seen(&self, at: [u32; 2]) -> Option<Seen<'_>> {
        let surface = self.surfaces.get(self.index(at))?.as_ref()?;
        Some(Seen { ray: self.projected.ray(self.setting.run.scene, at), surface, at })
    }

    fn rgb(&self, light: Spectrum, lambda: &Wavelengths) -> Vec3 {
        self.setting.run.developed(light, lambda)
    }

    fn index(&self, [x, y]: [u32; 2]) -> usize {
        (y * self.setting.run.scene.film().crop.width() + x) as usize
    }

    /// Writes a picture.
    fn write(
        &mut self,
        resource: Resource,
        pixel: impl Fn(&Self, [u32; 2], &Shader<'_>, &mut Trace<'_>) -> Vec3 + Sync,
    ) -> Result<(), Error> {
        let picture = self.pixels(pixel)?;
        self.pictures.insert(resource, picture);
        Ok(())
    }

    /// Something of each pixel, on all threads.
    fn pixels<T: Send>(
        &mut self,
        pixel: impl Fn(&Self, [u32; 2], &Shader<'_>, &mut Trace<'_>) -> T + Sync,
    ) -> Result<Vec<T>, Error> {
        let Setting { run, options, depth, shadows, world, number, .. } = self.setting;
        let crop = run.scene.film().crop;
        let (scene, seed) = (run.scene, run.sampler.seed);
        // Rows run in parallel; wavelengths and random numbers depend on pixel and pass alone.
        let rows = run.in_order(crop.height() as usize, |row, counters| {
            let shader =
                Shader { scene, shadows, options, depth, pass: *number, seed, image_lights: None, clusters: None };
            let of_pixel = |x| {
                let mut trace = Trace { counters, pixel: None, world: Some(world) };
                pixel(self, [x, row as u32], &shader, &mut trace)
            };
            (0..crop.width()).take_while(|_| !run.is_cancelled()).map(of_pixel).collect::<Vec<_>>()
        });
        let (rows, counters) = rows.ok_or(Error::Cancelled)?;
        self.counters += &counters;
        Ok(rows.into_iter().flatten().collect())
    }
}
