//! Many paths at once: all rays of a bounce go through the scene together, and vertices at which the same model
//! scatters are computed in columns ([`block`]). Both give the bits of a path that is followed alone.
//!
//! A wave has up to 1024 paths that share nothing: four samples of each pixel of a tile (`steradian_engine`,
//! `tiles::alone`). A bounce has five steps:
//!
//! 1. All rays are sorted by the signs and the greatest axis of their directions, and traced in one batch.
//! 2. Vertices are made from hits and free flights, 32 at a time in columns.
//! 3. Light samples are drawn, and all shadow rays are traced in one batch.
//! 4. Directions are drawn; throughputs and densities follow.
//! 5. Roulette ends paths; the others go on.
//!
//! A *kernel* (`accel::kernel!`) is a loop of plain `f32` arithmetic over the columns of a block, compiled for SSE2,
//! AVX2 and AVX-512 and chosen at run time. The compiler makes vector instructions of it; as no operation is reordered
//! or fused, all instruction sets give the same bits. Formulas are `#[inline(always)]` functions of one vertex, which
//! single paths call too. Lambert's law and the estimator of a phase function alone, two lines each, are written twice.
//!
//! Columns exist for camera rays, Sobol' numbers, points on triangles, the light tree, samples of flat lights,
//! Lambertian reflection (`diffuse`), flights, attenuation and phase functions of homogeneous media (`media`), spawned
//! rays and roulette. Directions that a guide draws (`guided`), other models, textures, media that vary or are seen
//! through interfaces, and other lights are computed vertex by vertex between kernels (`vertices`), so a new model or
//! light touches no file of this module.
//!
//! A loop becomes vector instructions only if all functions that it calls are inlined, if all columns that it writes
//! are fields of one value (else the compiler cannot know that they do not overlap), and if nothing in it may panic,
//! searches a table, or calls the system's mathematics. Failure is silent: `cargo xtask instructions` shows it.
//!
//! Single paths are followed for groups, for splitting at y, and where light is counted by groups of lights. A thread
//! takes about 360 KiB for paths and samples, and 20 KiB for a block.

mod block;
mod diffuse;
mod guided;
mod lights;
mod media;
mod vertices;

use crate::{Counters, Stop, path::PathTracer, precomputed::Precomputed};
use block::Block;
use std::mem::take;
use steradian_accel::{
    Lanes,
    columns::{WIDTH, get3, get4},
};
use steradian_core::{Scene, scene::Hit};
use steradian_engine::{PathContext, PixelSample};
use steradian_math::{Ray, Spectrum};
use steradian_transport::{Arrival, PathState, escape, meet};
use vertices::Vertices;

/// A path under way.
#[derive(Clone, Copy, Debug)]
struct Walker {
    state: PathState,
    /// Seed and reversed index of the sampler, if it is Sobol's.
    sampler: (u32, u32),
    /// Rays traced in batches for the path.
    rays: u32,
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

    /// Adds the shadow ray of a vertex of a block.
    #[inline]
    fn push_of(&mut self, b: &Block, k: usize, sample: u32, time: f32) {
        let (origin, direction) = (get3(&b.shadow_origin, k), get3(&b.shadow_direction, k));
        let ray = Ray { origin, direction, t_max: b.shadow_end[k], time };
        self.push(sample, Spectrum::new(get4(&b.light, k)), ray);
    }
}

/// Room for the paths of a wave; kept, so that nothing is allocated per sample.
#[derive(Debug, Default)]
pub struct WaveBuffer<'s> {
    /// Walkers, one for each sample in their order.
    walkers: Vec<Walker>,
    /// Live paths.
    live: Vec<u32>,
    order: Vec<u32>,
    classes: Vec<u8>,
    rays: Vec<Ray>,
    hits: Vec<Option<Hit>>,
    /// Live paths at Lambertian surfaces, with their hits.
    diffuse: Vec<(u32, Hit)>,
    /// Live paths in media that are the same everywhere.
    in_media: Vec<(u32, Option<Hit>)>,
    /// Live paths at vertices of other kinds.
    vertices: Vertices<'s>,
    block: Box<Block>,
    shadows: Shadows,
    occluded: Vec<bool>,
}

/// Inputs of a wave.
#[derive(Clone, Copy)]
struct Walk<'a, 's, const MEDIA: bool> {
    path: &'a PathTracer<MEDIA>,
    scene: &'s Scene,
    precomputed: &'a Precomputed,
    /// Enables the columns for all that has some.
    has_columns: bool,
    lanes: Lanes,
}

/// Takes samples that share nothing.
pub(crate) fn wave<'s, const MEDIA: bool>(
    path: &PathTracer<MEDIA>,
    scene: &'s Scene,
    precomputed: &Precomputed,
    pixel_samples: &mut [PixelSample],
    buffer: &mut WaveBuffer<'s>,
    counters: &mut Counters,
) {
    let none = Walker { state: PathState::NONE, sampler: (0, 0), rays: 0, goes_on: true };
    buffer.walkers.clear();
    buffer.walkers.resize(pixel_samples.len(), none);
    // Every sample begins black, with its camera ray.
    for (s, Walker { state, sampler, .. }) in pixel_samples.iter_mut().zip(&mut buffer.walkers) {
        (s.radiance, s.rays) = (Spectrum::ZERO, 0);
        *sampler = s.own.sobol().unwrap_or_default();
        state.start(scene, s.ray);
    }
    buffer.live.clear();
    buffer.live.extend(0..pixel_samples.len() as u32);
    // The way to a light may lead through several media.
    let has_columns =
        !(MEDIA && scene.is_see_through()) && pixel_samples.first().is_some_and(|s| s.own.sobol().is_some());
    let walk = Walk { path, scene, precomputed, has_columns, lanes: Lanes::best() };
    // One turn for each bounce, until no path is left.
    while !buffer.live.is_empty() {
        walk.bounce(buffer, pixel_samples, counters);
    }
    pixel_samples.iter_mut().zip(&buffer.walkers).for_each(|(s, walker)| s.rays += walker.rays);
}

impl<'s, const MEDIA: bool> Walk<'_, 's, MEDIA> {
    /// Follows all paths by a ray, and from there on to the next.
    fn bounce(&self, buffer: &mut WaveBuffer<'s>, pixel_samples: &mut [PixelSample], counters: &mut Counters) {
        let scene = self.scene;
        // 1. Coherence: rays by direction, then all of them through the hierarchy in one batch.
        sort(buffer);
        let WaveBuffer { rays, hits, .. } = &mut *buffer;
        hits.clear();
        hits.resize(rays.len(), None);
        in_parts(rays, hits, &counters.stop, |rays, hits| scene.intersect_batch(rays, hits));
        counters.rays += rays.len() as u64;

        // 2. Vertices. Paths in homogeneous media wait for their free flights; all others go to their surfaces at once,
        // where Lambertian ones are put aside for the columns.
        buffer.diffuse.clear();
        buffer.in_media.clear();
        buffer.shadows.clear();
        buffer.vertices.clear();
        let (mut live, hits) = (take(&mut buffer.live), take(&mut buffer.hits));
        for (&number, hit) in live.iter().zip(&hits) {
            let walker = &mut buffer.walkers[number as usize];
            walker.rays += 1;
            if self.has_columns && self.plain_medium(walker).is_some() {
                buffer.in_media.push((number, *hit));
            } else {
                self.meet_surface(number, (*hit, false), buffer, pixel_samples, counters);
            }
        }
        // Free flights, a block at a time; those that pass go to their surfaces.
        let in_media = take(&mut buffer.in_media);
        in_media.chunks(WIDTH).for_each(|in_media| self.free_flights(in_media, buffer, pixel_samples, counters));
        buffer.in_media = in_media;
        let WaveBuffer { walkers, diffuse, vertices, shadows, occluded, block, .. } = &mut *buffer;
        // 3. to 5. for the vertices of other models that are left in an unfinished block, then for the Lambertian ones,
        // block by block: light samples, directions, roulette.
        self.scatter(block, vertices, walkers, pixel_samples, (shadows, counters));
        for vertices in diffuse.chunks(WIDTH) {
            self.scatter_diffuse(vertices, (block, walkers, shadows), pixel_samples);
        }
        // Paths that ended leave the wave.
        let is_stopped = counters.stop.is_asked();
        live.retain(|&w| walkers[w as usize].goes_on && !is_stopped);

        // All shadow rays of the bounce in one batch; light that arrives goes to the samples.
        occluded.clear();
        occluded.resize(shadows.rays.len(), false);
        in_parts(&shadows.rays, occluded, &counters.stop, |rays, is| scene.occluded_batch(rays, is));
        counters.rays += shadows.rays.len() as u64;
        for ((sample, light), is_occluded) in shadows.light.iter().zip(&*occluded) {
            if !is_occluded {
                pixel_samples[*sample as usize].radiance += *light;
            }
        }
        (buffer.live, buffer.hits) = (live, hits);
    }

    /// Takes a path to its hit, to scatter there with others of its kind; `has_flown` where it came through the medium
    /// before that.
    #[inline]
    fn meet_surface(
        &self,
        number: u32,
        (hit, has_flown): (Option<Hit>, bool),
        buffer: &mut WaveBuffer<'s>,
        pixel_samples: &mut [PixelSample],
        counters: &mut Counters,
    ) {
        let WaveBuffer { walkers, diffuse, vertices, shadows, block, .. } = buffer;
        let (walker, sample) = (&mut walkers[number as usize], &mut pixel_samples[number as usize]);
        // Lambertian surfaces are scattered in columns alone: the vertex needs no `Arrival`.
        if self.has_columns
            && let Some(hit) = &hit
            && (!MEDIA || has_flown || walker.state.medium.is_none())
            && self.scene.is_lambertian(hit.id)
        {
            diffuse.push((number, *hit));
            return;
        }
        // All other surfaces are met one by one, as by a single path.
        let before = counters.rays;
        let PixelSample { own, lambda, radiance, .. } = sample;
        let context = &mut PathContext { scene: self.scene, sampler: own, lambda, counters };
        let arrival = vertices.next();
        walker.goes_on = self.arrive(&mut walker.state, (hit, has_flown), radiance, arrival, context);
        if walker.goes_on {
            // With columns the vertex waits for others; without, the path takes its whole step now.
            if self.has_columns {
                vertices.keep(number);
            } else {
                let before = shadows.rays.len();
                walker.goes_on = self.step(number, &mut walker.state, arrival, radiance, context, shadows);
                walker.rays += (shadows.rays.len() - before) as u32;
            }
        }
        sample.rays += (counters.rays - before) as u32;
        // A full block of vertices is scattered at once.
        if vertices.is_full() {
            self.scatter(block, vertices, walkers, pixel_samples, (shadows, counters));
        }
    }

    /// Follows a path from its hit to a vertex; whether there is one.
    #[inline]
    fn arrive(
        &self,
        state: &mut PathState,
        hit: (Option<Hit>, bool),
        radiance: &mut Spectrum,
        arrival: &mut Arrival<'s>,
        context: &mut PathContext<'s, '_>,
    ) -> bool {
        let depth = &self.path.depth;
        // Emission, interfaces and the scattering model, as of a single path.
        meet::<MEDIA>(state, hit, depth, radiance, arrival, context);
        if let Arrival::Escaped = arrival {
            escape(state, depth, radiance, context);
        }
        matches!(arrival, Arrival::Vertex(_))
    }

    /// Follows one path from a vertex to the next ray; whether it goes on.
    fn step(
        &self,
        number: u32,
        state: &mut PathState,
        arrival: &Arrival<'s>,
        radiance: &mut Spectrum,
        context: &mut PathContext<'s, '_>,
        shadows: &mut Shadows,
    ) -> bool {
        let Arrival::Vertex(vertex) = arrival else { return false };
        // Next-event estimation: a shadow ray for the batch, or at once where it may pass interfaces.
        if MEDIA && self.scene.is_see_through() {
            *radiance += state.direct::<MEDIA>(vertex, context);
        } else if let Some((value, ray)) = vertex.direct_along::<MEDIA>(state.event_of_light(0), context) {
            shadows.push(number, state.beta * value, ray);
        }
        // Direction, throughput and roulette, as in the loop of single paths.
        let guide = self.precomputed.guide();
        let Some(s) = state.sample(vertex, context.sampler, guide) else { return false };
        state.turn::<MEDIA>(self.scene, vertex, &s);
        if !state.beta.is_finite() {
            // Handed to the film, which counts it.
            *radiance = state.beta;
            return false;
        }
        state.survives(&self.path.depth, context)
    }
}

/// Number of rays traced between checks for a stop, so that a stop takes effect soon where each ray takes long.
const PART: usize = 64;

/// Asks about rays part by part, until a stop is asked for; what is left then is as it was.
fn in_parts<T>(rays: &[Ray], found: &mut [T], stop: &Stop, mut ask: impl FnMut(&[Ray], &mut [T])) {
    for (rays, found) in rays.chunks(PART).zip(found.chunks_mut(PART)).take_while(|_| !stop.is_asked()) {
        ask(rays, found);
    }
}

/// Puts paths next to each other whose rays have the same signs of direction and the same greatest axis, and takes
/// these rays.
fn sort(buffer: &mut WaveBuffer<'_>) {
    const CLASSES: usize = 24;
    let WaveBuffer { walkers, live, order, classes, rays, .. } = buffer;
    let class = |w: u32| {
        let d = walkers[w as usize].state.ray.direction;
        // Class of a direction: the octant by the sign bits, and the axis of the greatest component.
        let signs = d.x.to_bits() >> 31 | d.y.to_bits() >> 31 << 1 | d.z.to_bits() >> 31 << 2;
        let (x, y, z) = (d.x.abs(), d.y.abs(), d.z.abs());
        let axis = if x >= y && x >= z { 0 } else { 1 + u32::from(z > y) };
        (axis * 8 + signs) as u8
    };
    classes.clear();
    classes.extend(live.iter().map(|&w| class(w)));
    // Counting sort: numbers of rays by class, their prefix sums, and each ray to the next place of its class.
    let mut starts = [0; CLASSES + 1];
    classes.iter().for_each(|&class| starts[usize::from(class) + 1] += 1);
    (0..CLASSES).for_each(|k| starts[k + 1] += starts[k]);
    order.resize(live.len(), 0);
    rays.resize(live.len(), PathState::NONE.ray);
    for (&w, &class) in live.iter().zip(&*classes) {
        let start = &mut starts[usize::from(class)];
        (order[*start], rays[*start]) = (w, walkers[w as usize].state.ray);
        *start += 1;
    }
    std::mem::swap(live, order);
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    };

    /// Rays are asked about up to the part in which a stop is asked for, and all of them where none is.
    #[test]
    fn rays_are_left_where_a_stop_is_asked_for() {
        let rays = [PathState::NONE.ray; 10 * PART + 7];
        for (stops_at, expected) in [(usize::MAX, rays.len()), (3, 3 * PART)] {
            let flag = Arc::new(AtomicBool::new(false));
            let (mut found, mut parts) = ([false; 10 * PART + 7], 0);
            in_parts(&rays, &mut found, &Stop::by(&flag), |rays, found| {
                assert_eq!(rays.len(), found.len());
                found.fill(true);
                parts += 1;
                flag.store(parts == stops_at, Ordering::Relaxed);
            });
            assert_eq!(found.iter().filter(|is_found| **is_found).count(), expected);
        }
    }
}
