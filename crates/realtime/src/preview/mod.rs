//! Previews: pictures at once that show what a scene looks like, without noise. What pixels see is rasterised; mirrors
//! and glass are followed; light of lights takes one sample for each and is freed of noise; light after bounces comes
//! of few paths. Where a scene has no light, one at the camera shows it.

mod filter;
mod indirect;
mod look;

use crate::{
    Error,
    draw_list::{DrawList, Item, box_count},
    options::Options,
    preparation::Preparation,
    projection::Projected,
    rasterizer::{first_ray, place},
    shading::{CameraPath, Point, Shader},
    shadow::Shadowing,
    trace::Trace,
    visibility::Visibility,
};
use indirect::Blocks;
use look::{look, object};
use rayon::prelude::*;
use steradian_bsdf::TransportMode;
use steradian_core::{
    ColorMode, Scene,
    camera::Projection,
    film::{LayerInputs, PassFilm},
    sampler::Sampler,
    scene::Shape,
};
use steradian_engine::{Counters, Pass, PathContext, Plan, Run, albedo, albedo_of, dimension, shadow_catcher};
use steradian_math::{Ray, Spectrum, Vec2, Vec3, spectra::Wavelengths};
use steradian_transport::{Depth, NoGuide, PathState, along};

/// Paths from a point of each block of pixels: at least, and at most where pictures are small.
const PATHS: [u32; 2] = [8, 128];
/// Paths of small pictures, all blocks together.
const ALL_PATHS: u32 = 1 << 14;
/// Above so many triangles for each pixel rays find sooner what is seen.
const TRIANGLES_PER_PIXEL: u64 = 4;
/// Points on each light for what is seen in reflections, which is not freed of noise.
const REFLECTED_POINTS: u32 = 2;
/// Points on each light for the transparent layers beside the one that is denoised.
const LAYER_POINTS: u32 = 16;
/// Transparent layers that are followed, and the least share of the light behind them that matters.
const MOST_LAYERS: usize = 64;
const LEAST_LAYER: f32 = 0.01;
/// Directions by each technique to find the opacity of shadow catchers, which is not freed of noise.
const SHADOW_DIRECTIONS: u32 = 48;
/// Albedos are taken for at least this, so that light over albedo is finite.
const LEAST_ALBEDO: f32 = 1e-3;

/// A surface that a pixel shows, maybe by mirrors and glass.
#[derive(Clone, Copy, Debug)]
struct Surface {
    p: Vec3,
    /// The shading normal, on the side that is seen.
    normal: Vec3,
    /// From the eye, along the path.
    distance: f32,
    object: u32,
    /// The part of light that it sends to the eye.
    albedo: Vec3,
    /// Light straight from lights, over albedo.
    direct: Vec3,
}

/// Contents of a pixel: light that needs no filter, and a surface that scatters.
#[derive(Clone, Copy, Debug, Default)]
struct Pixel {
    aside: Vec3,
    surface: Option<Surface>,
}

/// LayerInputs of a picture.
struct Drawing<'a> {
    run: &'a Run<'a>,
    list: &'a DrawList,
    /// The camera's projection to a plane and what pixels see by it. Without, rays find that: for cameras of all
    /// directions, and sooner where there are many more triangles than pixels.
    seen: Option<(Projected, Visibility)>,
    /// The place in pixels that is looked at.
    offset: Vec2,
    shadows: Shadowing,
    number: u32,
    /// True for a scene without lights, which is lit by a light at the camera.
    is_dark: bool,
    /// Options of the path that is filtered, of reflections beside it, and of transparent layers beside it.
    options: [Options; 3],
    depth: Depth,
}

/// A render of previews.
#[derive(Debug)]
pub struct Preview {
    options: Options,
    depth: Depth,
    preparation: Preparation,
}

impl Preview {
    /// Draws previews of a scene.
    ///
    /// # Errors
    /// Cameras with lenses of several elements, and layers and backgrounds that previews do not have.
    pub fn new(scene: &Scene, options: Options, depth: Depth, plan: &Plan) -> Result<Self, Error> {
        if matches!(scene.camera().projection, Projection::Realistic(_)) {
            Projected::new(scene, Vec2::splat(0.5))?;
        }
        if plan.has(LayerInputs::LIGHT_GROUPS) {
            return Err(Error::Option("raster:frame=preview does not tell groups of lights apart".into()));
        }
        if plan.transparent {
            return Err(Error::Option("raster:frame=preview has no transparent background".into()));
        }
        Ok(Self { options, depth, preparation: Preparation::default() })
    }

    fn draw(&self, run: &Run<'_>, number: u32, film: &mut PassFilm<'_>) -> Result<Option<Counters>, Error> {
        let Some((list, pool)) = self.preparation.get() else { return Ok(None) };
        let (offset, weight) = place(run.scene.film(), number);
        // One sample alone is the whole pixel.
        let weight = if run.sampler.spp > 1 { weight } else { 1.0 };
        let crop = run.scene.film().crop;
        let size = [crop.width(), crop.height()];
        let pixels = u64::from(size[0]) * u64::from(size[1]);
        // Rasterisation costs a step for each triangle, rays a logarithm of their number for each pixel: where
        // triangles are many more than pixels, rays are faster. Rays find the transparent layers of a pixel, too.
        let is_flat = matches!(run.scene.camera().projection, Projection::Perspective | Projection::Orthographic);
        let blends = self.options.blends() && run.scene.has_layers();
        let seen = if is_flat && !blends && primitives(run.scene, list) <= TRIANGLES_PER_PIXEL * pixels {
            let projected = Projected::new(run.scene, offset)?.hiding_emitters(self.depth.hide_emitters);
            let visibility = pool.install(|| Visibility::draw(run.scene, list, &projected))?;
            Some((projected, visibility))
        } else {
            None
        };
        let options = [1, REFLECTED_POINTS, LAYER_POINTS].map(|points| Options { points, ..self.options });
        let (shadows, depth) = (Shadowing::by_rays(blends), self.depth);
        let is_dark = is_dark(run.scene);
        let drawing = Drawing { is_dark, run, list, seen, offset, shadows, number, options, depth };
        // Three parts of light: what needs no filter, direct light by pixels, light after bounces by blocks of pixels.
        let Some((pixels, mut counters)) = drawing.pixels(size) else { return Ok(None) };
        let Some((blocks, of_blocks)) = drawing.blocks(size, &pixels) else { return Ok(None) };
        counters += &of_blocks;
        // Direct light is filtered over albedo, so that the filter does not blur textures.
        let direct = pool.install(|| filter::filter(size, &pixels))?;
        let values: Vec<Vec3> = pool.install(|| {
            let value = |(k, pixel): (usize, &Pixel)| {
                let at = [k as u32 % size[0], k as u32 / size[0]];
                // And multiplied by the albedo again.
                let scattered = |s: &Surface| s.albedo * (direct[k] + blocks.light(s, at));
                pixel.aside + pixel.surface.as_ref().map_or(Vec3::ZERO, scattered)
            };
            pixels.par_iter().enumerate().map(value).collect()
        });
        for (k, value) in values.iter().enumerate() {
            film.add(crop.x0 + k as u32 % size[0], crop.y0 + k as u32 / size[0], *value * weight);
        }
        counters.samples = values.len() as u64;
        Ok(Some(counters))
    }
}

impl Drawing<'_> {
    /// The shaders of the way that is filtered, of reflections, and of transparent layers.
    fn shaders(&self) -> [Shader<'_>; 3] {
        let Self { run, shadows, number, depth, .. } = self;
        let shader = |options| Shader {
            scene: run.scene,
            shadows,
            options,
            depth,
            pass: *number,
            seed: run.sampler.seed,
            image_lights: None,
            clusters: None,
        };
        self.options.each_ref().map(shader)
    }

    /// Contents of the pixels, by rows.
    fn pixels(&self, [width, height]: [u32; 2]) -> Option<(Vec<Pixel>, Counters)> {
        let (rows, counters) = self.run.in_order(height as usize, |row, counters| {
            (0..width)
                .take_while(|_| !self.run.is_cancelled())
                .map(|x| self.pixel([x, row as u32], counters))
                .collect::<Vec<_>>()
        })?;
        Some((rows.into_iter().flatten().collect(), counters))
    }

    fn pixel(&self, at: [u32; 2], counters: &mut Counters) -> Pixel {
        let [shader, reflections, of_layers] = self.shaders();
        let numbers = shader.numbers(at);
        let mut lambda = shader.wavelengths(at);
        let mut trace = Trace { counters, pixel: None, world: None };
        // Follow the pixel's ray to the first surface that scatters diffusely or glossily.
        let (mut start, mut layers) = self.layers(self.start(&shader, at, &mut trace), &mut trace);
        // Of shadow catchers only the shadow is seen, before the background.
        let mut shadows = Spectrum::ZERO;
        if self.run.scene.has_shadow_catchers() {
            layers.push(start);
            shadows = self.take_shadows(&mut layers, &lambda);
            let Some(rest) = layers.pop() else {
                return Pixel { aside: self.run.developed(shadows, &lambda), surface: None };
            };
            start = rest;
        }
        let mut look = look(&shader, Some(&reflections), start, &numbers, &mut lambda, &mut trace);
        look.aside += shadows;
        look.distance += (start.ray.origin - self.ray(at).origin).length();
        for layer in layers {
            look.aside += of_layers.follow(layer, &numbers, &mut lambda, &mut trace);
        }
        let rgb = |light| self.run.developed(light, &lambda);
        let surface = look.point.as_ref().map(|point| {
            // Floor the albedo, so that demodulated light is finite.
            let albedo = self.albedo(point).max(Vec3::splat(LEAST_ALBEDO));
            let light = if self.is_dark { head_light(point) } else { shader.direct(point, &mut trace) };
            let normal = if point.frame.z.dot(point.i.wo) < 0.0 { -point.frame.z } else { point.frame.z };
            Surface {
                p: point.i.surface.p,
                normal,
                distance: look.distance,
                object: object(&point.i, point.round),
                albedo,
                direct: rgb(light) / albedo,
            }
        });
        Pixel { aside: rgb(look.aside), surface }
    }

    /// Takes the shadow catchers out of the layers of a pixel: the background behind them, less their opacity.
    fn take_shadows(&self, layers: &mut Vec<CameraPath>, lambda: &Wavelengths) -> Spectrum {
        let scene = self.run.scene;
        let mut sum = Spectrum::ZERO;
        layers.retain(|layer| {
            let Some(hit) = layer.hit.filter(|hit| scene.geometry(hit.id).catches_shadows) else { return true };
            let i = scene.interaction_of_light(&layer.ray, &hit);
            let normal = if i.surface.n.dot(i.wo) < 0.0 { -i.surface.n } else { i.surface.n };
            let opacity = shadow_catcher::opacity(scene, &i, normal, lambda, SHADOW_DIRECTIONS);
            sum += layer.beta * shadow_catcher::background(scene, &layer.ray, lambda) * (1.0 - opacity);
            false
        });
        sum
    }

    fn start(&self, shader: &Shader<'_>, at: [u32; 2], trace: &mut Trace<'_>) -> CameraPath {
        let (scene, ray) = (self.run.scene, self.ray(at));
        let hit = match &self.seen {
            Some((projected, visibility)) => visibility.seen(scene, self.list, projected, at).map(|seen| seen.hit),
            None => trace.nearest(scene, &ray),
        };
        CameraPath { hit, ..CameraPath::start(shader, &ray, None) }
    }

    /// The transparent layers along the ray of a pixel, each with its share of the light: the one with the largest, and
    /// the others.
    fn layers(&self, start: CameraPath, trace: &mut Trace<'_>) -> (CameraPath, Vec<CameraPath>) {
        let scene = self.run.scene;
        if !self.shadows.blends() {
            return (start, Vec::new());
        }
        // Front to back: each layer gets its opacity of what the layers before it let through.
        let (mut path, mut found, mut rest) = (start, Vec::new(), 1.0);
        for _ in 0..MOST_LAYERS {
            let Some((hit, opacity)) = scene.intersect_layer(&path.ray) else {
                found.push(CameraPath { hit: None, beta: path.beta * rest, ..path });
                break;
            };
            // The last layer that matters takes all that is left.
            let left = rest * (1.0 - opacity);
            let is_last = left < LEAST_LAYER;
            let share = if is_last { rest } else { rest - left };
            found.push(CameraPath { hit: Some(hit), beta: path.beta * share, ..path });
            if is_last || trace.counters.stop.is_asked() {
                break;
            }
            let i = scene.interaction_of_light(&path.ray, &hit);
            path.differential = path.differential.map(|d| d.advance(i.t));
            path.ray = i.rest(&path.ray);
            rest = left;
        }
        trace.counters.rays += found.len() as u64;
        let largest = (0..found.len())
            .max_by(|a, b| found[*a].beta.max_element().total_cmp(&found[*b].beta.max_element()).then(b.cmp(a)));
        let first = largest.map_or(start, |largest| found.swap_remove(largest));
        (first, found)
    }

    fn ray(&self, at: [u32; 2]) -> Ray {
        let scene = self.run.scene;
        match &self.seen {
            Some((projected, _)) => projected.ray(scene, at),
            None => {
                let (film, [x, y]) = (scene.film(), at);
                let place = Vec2::new((film.crop.x0 + x) as f32, (film.crop.y0 + y) as f32) + self.offset;
                scene.camera().ray(film, place, Vec2::splat(0.5))
            }
        }
    }

    /// The part of white light that a point sends to the eye.
    fn albedo(&self, point: &Point<'_>) -> Vec3 {
        let (scene, lambda) = (self.run.scene, &point.lambda);
        let of_surface = match scene.mode() {
            ColorMode::Rgb => albedo_of(scene, &point.scattering.bsdf, point.frame.to_local(point.i.wo), lambda),
            ColorMode::Spectral => albedo(scene, &point.i, lambda).map_or(Vec3::ZERO, |(a, _)| a),
        };
        // Directional albedo of the surface times the throughput of the specular path before it.
        of_surface * scene.mode().to_rgb(point.beta, lambda).max(Vec3::ZERO)
    }

    /// Light after bounces, over albedo, for blocks of pixels.
    fn blocks<'p>(&self, size: [u32; 2], pixels: &'p [Pixel]) -> Option<(Blocks<'p>, Counters)> {
        // The first pixel of a block, from its middle on, that shows a surface stands for the block. Two smoothing
        // steps with gaps of one and two blocks widen the filter as à-trous wavelets do.
        let [columns, rows] = indirect::blocks(size);
        let paths = (ALL_PATHS / columns.saturating_mul(rows).max(1)).clamp(PATHS[0], PATHS[1]);
        let (points, counters) = self.run.in_order(rows as usize, |row, counters| {
            // The first pixel of a block that shows a surface gives its point.
            let of_block = |column| {
                let mut found = indirect::pixels([column, row as u32], size);
                found.find_map(|at| {
                    let surface = pixels[(at[1] * size[0] + at[0]) as usize].surface.as_ref()?;
                    Some((surface, self.indirect(at, paths, counters) / surface.albedo))
                })
            };
            (0..columns).take_while(|_| !self.run.is_cancelled()).map(of_block).collect::<Vec<_>>()
        })?;
        let points = points.into_iter().flatten().collect();
        // Two smoothing passes with growing steps.
        let blocks = Blocks::new(size, points, self.pixel_angle(size)).smooth(1).smooth(2);
        Some((blocks, counters))
    }

    /// Light that a pixel's surface sends on after a bounce and more, the mean of some paths.
    fn indirect(&self, at: [u32; 2], paths: u32, counters: &mut Counters) -> Vec3 {
        let (run, [shader, ..]) = (self.run, self.shaders());
        if self.depth.max < 2 {
            return Vec3::ZERO;
        }
        // The point's own light is that of lights, found already.
        let depth = Depth { max: self.depth.max - 1, hide_emitters: true, ..self.depth };
        let sampler = Sampler { spp: paths.saturating_mul(run.sampler.spp), ..run.sampler };
        let numbers = shader.numbers(at);
        let mut lambda = shader.wavelengths(at);
        let mut trace = Trace { counters: &mut *counters, pixel: None, world: None };
        let (start, _) = self.layers(self.start(&shader, at, &mut trace), &mut trace);
        let found = look(&shader, None, start, &numbers, &mut lambda, &mut trace);
        let Some(point) = found.point else { return Vec3::ZERO };
        let wo = point.frame.to_local(point.i.wo);
        let mut sum = Vec3::ZERO;
        // Average some paths from the point.
        for k in (0..paths).take_while(|_| !run.is_cancelled()) {
            let sampler = &sampler.pixel(at[0], at[1], self.number.wrapping_mul(paths).wrapping_add(k));
            let (u, u2) = (sampler.get_1d(dimension::LOBE), sampler.get_2d(dimension::DIRECTION));
            // Draw a direction from the BSDF; specular samples were followed by the walk.
            let Some(s) = point.scattering.sample(wo, u, u2, TransportMode::Radiance) else { continue };
            if s.lobe.is_specular() {
                continue;
            }
            // A whole path from the second vertex on, by the path tracer.
            let ray = point.i.spawn(point.frame.to_world(s.wi));
            let state = PathState { ray, beta: point.beta * s.weight, ..PathState::NONE };
            let mut lambda = point.lambda;
            let mut context = PathContext { scene: run.scene, sampler, lambda: &mut lambda, counters };
            let light = along::<false, _>(state, &depth, None::<&NoGuide>, &mut context, Spectrum::ZERO);
            let light = run.developed(light, &lambda);
            if light.is_finite() {
                sum += light;
            }
        }
        sum / paths as f32
    }

    /// The angle between the rays of pixels side by side, in the middle of the picture.
    fn pixel_angle(&self, [width, height]: [u32; 2]) -> f32 {
        // Angle subtended by a pixel: distance between the directions of neighbouring rays.
        let direction = |x| self.ray([x, height / 2]).direction;
        let angle = (direction(width / 2 + 1) - direction(width / 2)).length();
        if angle > 0.0 && angle.is_finite() { angle } else { 1.0 / width as f32 }
    }
}

/// Number of triangles and boxes that are drawn.
fn primitives(scene: &Scene, list: &DrawList) -> u64 {
    let count = |item: &Item| match &list.geometry(scene, item).shape {
        Shape::Mesh(mesh) => mesh.triangles.len() as u64,
        shape => u64::from(box_count(shape).unwrap_or(0)),
    };
    list.items.iter().map(count).sum()
}

/// True if a scene has no light at all.
fn is_dark(scene: &Scene) -> bool {
    scene.lights().lights.is_empty() && scene.geometries().iter().all(|g| g.emitter.is_none())
}

/// Radiance reflected from a light at the camera without falloff: β · f(ωo, ωo) · π.
fn head_light(point: &Point<'_>) -> Spectrum {
    // A light at the eye: wi = wo, without falloff.
    let wo = point.frame.to_local(point.i.wo);
    point.beta * point.scattering.eval(wo, wo, TransportMode::Radiance).value * std::f32::consts::PI
}

impl Pass for Preview {
    fn prepare(&mut self, run: &Run<'_>) -> Option<()> {
        self.preparation.make(run)
    }

    fn pass(&self, run: &Run<'_>, number: u32, film: &mut PassFilm<'_>) -> Option<Counters> {
        self.preparation.outcome(self.draw(run, number, film))
    }

    fn first_ray(&self, run: &Run<'_>, pixel: [u32; 2], number: u32) -> (Ray, Wavelengths) {
        first_ray(run.scene, pixel, number)
    }

    fn notes(&self) -> Vec<String> {
        vec!["a preview: light is smoothed; --spp or raster:frame=forward gives direct light as it is".into()]
    }

    fn failure(&self) -> Option<String> {
        self.preparation.failure()
    }
}
