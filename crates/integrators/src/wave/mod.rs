//! Many paths at once: all rays of a bounce go through the scene together, and vertices at which the same model
//! scatters are computed in columns ([`block`]). Both give the bits of a path that is followed alone; what has no
//! columns is.

mod block;

use crate::{Counters, path::PathTracer, precomputed::Precomputed};
use block::{Block, GOES_ON, IS_NOT_FINITE, WIDTH, get3, get4, set3, set4};
use steradian_accel::Lanes;
use steradian_bsdf::Bsdf;
use steradian_core::{Scene, light::LightContext, material::Constant, scene::Hit};
use steradian_engine::{PathContext, PixelSample, dimension};
use steradian_math::{Ray, Spectrum, Vec2};
use steradian_transport::{Arrival, PathState, escape, meet};

/// A path under way.
#[derive(Clone, Copy, Debug)]
struct Walker {
    state: PathState,
    goes_on: bool,
}

/// Rays towards lights, and what these bring to samples if nothing is before them.
#[derive(Debug, Default)]
struct Shadows {
    rays: Vec<Ray>,
    light: Vec<(u32, Spectrum)>,
}

impl Shadows {
    fn clear(&mut self) {
        self.rays.clear();
        self.light.clear();
    }

    #[inline]
    fn push(&mut self, sample: u32, light: Spectrum, ray: Ray) {
        self.rays.push(ray);
        self.light.push((sample, light));
    }
}

/// Room for the paths of a wave; kept, so that nothing is allocated per sample.
#[derive(Debug, Default)]
pub struct WaveBuffer {
    /// As many as samples, in their order.
    walkers: Vec<Walker>,
    /// Those under way.
    live: Vec<u32>,
    rays: Vec<Ray>,
    hits: Vec<Option<Hit>>,
    /// Those under way that arrived at Lambertian surfaces, with their hits.
    diffuse: Vec<(u32, Hit)>,
    block: Box<Block>,
    shadows: Shadows,
    occluded: Vec<bool>,
}

/// What paths are followed with.
#[derive(Clone, Copy)]
struct Walk<'a, 's, const MEDIA: bool> {
    path: &'a PathTracer<MEDIA>,
    scene: &'s Scene,
    precomputed: &'a Precomputed,
    lanes: Lanes,
}

/// Takes samples that share nothing.
pub(crate) fn wave<const MEDIA: bool>(
    path: &PathTracer<MEDIA>,
    scene: &Scene,
    precomputed: &Precomputed,
    pixel_samples: &mut [PixelSample],
    buffer: &mut WaveBuffer,
    counters: &mut Counters,
) {
    buffer.walkers.clear();
    buffer.live.clear();
    for (number, s) in (0..).zip(&mut *pixel_samples) {
        (s.radiance, s.rays) = (Spectrum::ZERO, 0);
        buffer.walkers.push(Walker { state: PathState::camera(scene, s.ray), goes_on: true });
        buffer.live.push(number);
    }
    let walk = Walk { path, scene, precomputed, lanes: Lanes::best() };
    while !buffer.live.is_empty() {
        walk.bounce(buffer, pixel_samples, counters);
    }
}

impl<'s, const MEDIA: bool> Walk<'_, 's, MEDIA> {
    /// Follows all paths by a ray, and from there on to the next.
    fn bounce(&self, buffer: &mut WaveBuffer, pixel_samples: &mut [PixelSample], counters: &mut Counters) {
        let scene = self.scene;
        let WaveBuffer { walkers, live, rays, hits, diffuse, shadows, occluded, block } = buffer;
        rays.clear();
        rays.extend(live.iter().map(|&w| walkers[w as usize].state.ray));
        hits.clear();
        hits.resize(rays.len(), None);
        scene.intersect_batch(rays, hits);
        counters.rays += rays.len() as u64;

        diffuse.clear();
        shadows.clear();
        let mut arrival = Arrival::End;
        for (&number, hit) in live.iter().zip(&*hits) {
            let (walker, sample) = (&mut walkers[number as usize], &mut pixel_samples[number as usize]);
            sample.rays += 1;
            match hit {
                Some(hit) if self.is_diffuse(hit, walker, sample) => diffuse.push((number, *hit)),
                _ => {
                    let before = counters.rays;
                    walker.goes_on =
                        self.step(number, &mut walker.state, *hit, sample, (&mut arrival, counters), shadows);
                    sample.rays += (counters.rays - before) as u32;
                }
            }
        }
        for vertices in diffuse.chunks(WIDTH) {
            gather(block, vertices, walkers, scene, pixel_samples);
            block::surfaces(self.lanes, block);
            block::numbers(self.lanes, block);
            illuminate(block, vertices, scene, pixel_samples);
            block::diffuse(self.lanes, block, self.path.depth);
            self.scatter(block, vertices, walkers, pixel_samples, shadows);
        }
        let is_stopped = counters.stop.is_asked();
        live.retain(|&w| walkers[w as usize].goes_on && !is_stopped);

        occluded.clear();
        occluded.resize(shadows.rays.len(), false);
        scene.occluded_batch(&shadows.rays, occluded);
        counters.rays += shadows.rays.len() as u64;
        for ((sample, light), is_occluded) in shadows.light.iter().zip(&*occluded) {
            let sample = &mut pixel_samples[*sample as usize];
            sample.rays += 1;
            if !is_occluded {
                sample.radiance += *light;
            }
        }
    }

    /// Whether a path arrived at a vertex that is computed in columns.
    #[inline]
    fn is_diffuse(&self, hit: &Hit, walker: &Walker, sample: &PixelSample) -> bool {
        let is_plain = self.precomputed.caustics.is_none() && (!MEDIA || walker.state.medium.is_none());
        let is_lambertian = |side: &Option<Constant>| matches!(side, Some((Bsdf::Diffuse(_), _)));
        is_plain
            && sample.own.sobol().is_some()
            && self.scene.uniform(hit.id).is_some_and(|(_, sides)| sides.iter().all(is_lambertian))
    }

    /// Follows one path from its hit to the next ray; whether it goes on.
    fn step(
        &self,
        number: u32,
        state: &mut PathState,
        hit: Option<Hit>,
        PixelSample { own, lambda, radiance, .. }: &mut PixelSample,
        (arrival, counters): (&mut Arrival<'s>, &mut Counters),
        shadows: &mut Shadows,
    ) -> bool {
        let (scene, depth) = (self.scene, &self.path.depth);
        let context = &mut PathContext { scene, sampler: own, lambda, counters };
        meet::<MEDIA>(state, hit, depth, radiance, arrival, context);
        let vertex = match &*arrival {
            Arrival::Vertex(vertex) => vertex,
            Arrival::End => return false,
            Arrival::Escaped => {
                escape(state, depth, radiance, context);
                return false;
            }
        };
        if MEDIA && scene.is_see_through() {
            // The way to a light may lead through several media, one ray after the other.
            *radiance += state.direct::<MEDIA>(vertex, context);
        } else if let Some((value, ray)) = vertex.direct_along::<MEDIA>(state.event_of_light(0), context) {
            shadows.push(number, state.beta * value, ray);
        }
        let guide = self.precomputed.caustics.as_ref();
        let Some(s) = state.sample(vertex, context.sampler, guide) else { return false };
        state.turn::<MEDIA>(scene, vertex, &s);
        if !state.beta.is_finite() {
            // Handed to the film, which counts it.
            *radiance = state.beta;
            return false;
        }
        state.survives(depth, context)
    }

    /// Lets paths go on as the block has it.
    fn scatter(
        &self,
        block: &Block,
        vertices: &[(u32, Hit)],
        walkers: &mut [Walker],
        pixel_samples: &mut [PixelSample],
        shadows: &mut Shadows,
    ) {
        for (k, (number, _)) in vertices.iter().enumerate() {
            let Walker { state, goes_on } = &mut walkers[*number as usize];
            // Of the last surface there is emission alone.
            *goes_on = state.events < self.path.depth.max && block.fate[k] == GOES_ON;
            if state.events >= self.path.depth.max {
                continue;
            }
            let time = state.ray.time;
            if block.is_lit[k] != 0 {
                let (origin, direction) = (get3(&block.shadow_origin, k), get3(&block.shadow_direction, k));
                let ray = Ray { origin, direction, t_max: block.shadow_end[k], time };
                shadows.push(*number, Spectrum::new(get4(&block.light, k)), ray);
            }
            let beta = Spectrum::new(get4(&block.beta, k));
            if block.fate[k] == IS_NOT_FINITE {
                pixel_samples[*number as usize].radiance = beta;
            }
            if !*goes_on {
                continue;
            }
            state.ray = Ray { time, ..Ray::new(get3(&block.origin, k), get3(&block.way_on, k)) };
            state.beta = beta;
            state.origin = Some((light_context(block, k), block.pdf[k]));
            state.events += 1;
            state.differential = None;
        }
    }
}

/// Where light is sampled from.
#[inline]
fn light_context(block: &Block, k: usize) -> LightContext {
    LightContext { p: get3(&block.p, k), n: get3(&block.ns, k) * block.side[k] }
}

/// Fills the columns that tell of hits and of the paths that come there.
fn gather(
    block: &mut Block,
    vertices: &[(u32, Hit)],
    walkers: &[Walker],
    scene: &Scene,
    pixel_samples: &[PixelSample],
) {
    for (k, (number, hit)) in vertices.iter().enumerate() {
        let Some((mesh, _)) = scene.uniform(hit.id) else { continue };
        let index = mesh.triangles[hit.id.prim as usize].map(|i| i as usize);
        block.corners.iter_mut().zip(index).for_each(|(corner, i)| set3(corner, k, mesh.positions[i]));
        let is_smooth = !mesh.normals.is_empty();
        if is_smooth {
            block.normals.iter_mut().zip(index).for_each(|(normal, i)| set3(normal, k, mesh.normals[i]));
        }
        (block.is_smooth[k], block.is_flipped[k]) = (is_smooth.into(), mesh.flip.into());
        (block.uv[0][k], block.uv[1][k]) = (hit.u, hit.v);
        let state = &walkers[*number as usize].state;
        set3(&mut block.direction, k, state.ray.direction);
        set4(&mut block.beta, k, state.beta.to_array());
        (block.for_roulette[k], block.events[k]) = (state.for_roulette, state.events);
        let (seed, reversed) = pixel_samples[*number as usize].own.sobol().unwrap_or_default();
        (block.sampler[0][k], block.sampler[1][k]) = (seed, reversed);
    }
}

/// Fills the columns of materials and light samples.
fn illuminate(block: &mut Block, vertices: &[(u32, Hit)], scene: &Scene, pixel_samples: &[PixelSample]) {
    let lights = scene.lights();
    for (k, (number, hit)) in vertices.iter().enumerate() {
        let Some((mesh, sides)) = scene.uniform(hit.id) else { continue };
        if block.is_unusual[k] != 0 {
            let s = mesh.bare(hit.id.prim, hit.u, hit.v);
            set3(&mut block.n, k, s.n);
            set3(&mut block.ns, k, s.ns);
            block.is_front[k] = u32::from(s.ns.dot(-get3(&block.direction, k)) > 0.0);
        }
        let Some((Bsdf::Diffuse(diffuse), is_flipped)) = &sides[block.is_front[k] as usize & 1] else { continue };
        set4(&mut block.reflectance, k, diffuse.reflectance.to_array());
        block.side[k] = if *is_flipped { -1.0 } else { 1.0 };
        block.light_pdf[k] = 0.0;
        if !lights.can_sample() {
            continue;
        }
        let (ctx, PixelSample { own, lambda, .. }) = (light_context(block, k), &pixel_samples[*number as usize]);
        let u = own.get_1d_lazily(dimension::at(block.events[k], dimension::LIGHT), lights.are_many());
        let Some((light, p)) = lights.choose(&ctx, u) else { continue };
        let u = Vec2::new(block.light_point[0][k], block.light_point[1][k]);
        let Some(s) = lights.sample(light, &ctx, u, lambda, scene.textures()) else { continue };
        set3(&mut block.light_wi, k, s.wi);
        set4(&mut block.light_radiance, k, s.radiance.to_array());
        (block.light_distance[k], block.light_pdf[k]) = (s.distance, s.pdf * p);
        block.light_is_delta[k] = s.is_delta.into();
    }
}
