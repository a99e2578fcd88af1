//! Many paths at once: all rays of a bounce go through the scene together, and vertices at which the same model
//! scatters are computed in columns ([`block`]). Both give the bits of a path that is followed alone; what has no
//! columns is.

mod block;

use crate::{Counters, path::PathTracer, precomputed::Precomputed};
use block::{Block, GOES_ON, IS_NOT_FINITE};
use steradian_accel::{
    Lanes,
    columns::{Column, WIDTH, get3, get4, set3, set4},
};
use steradian_bsdf::BsdfSample;
use steradian_core::{
    Scene,
    light::{Choice, Light, LightContext, LightSample},
    scene::Hit,
};
use steradian_engine::{PathContext, PixelSample, dimension};
use steradian_math::{Ray, Spectrum, Vec2};
use steradian_transport::{Arrival, PathState, Vertex, escape, meet};

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

    /// Those of a vertex of a block.
    #[inline]
    fn push_of(&mut self, b: &Block, k: usize, sample: u32, time: f32) {
        let (origin, direction) = (get3(&b.shadow_origin, k), get3(&b.shadow_direction, k));
        let ray = Ray { origin, direction, t_max: b.shadow_end[k], time };
        self.push(sample, Spectrum::new(get4(&b.light, k)), ray);
    }
}

/// Vertices of any kind at which some paths arrived, up to a block of them.
#[derive(Debug)]
struct Vertices<'s> {
    numbers: Vec<u32>,
    arrivals: Vec<Arrival<'s>>,
    draws: Vec<BsdfSample>,
}

impl Default for Vertices<'_> {
    fn default() -> Self {
        Self { numbers: Vec::new(), arrivals: vec![Arrival::End; WIDTH], draws: vec![BsdfSample::NONE; WIDTH] }
    }
}

impl<'s> Vertices<'s> {
    fn clear(&mut self) {
        self.numbers.clear();
    }

    fn is_full(&self) -> bool {
        self.numbers.len() == WIDTH
    }

    /// Where the next one is to be written.
    fn next(&mut self) -> &mut Arrival<'s> {
        &mut self.arrivals[self.numbers.len()]
    }

    /// Keeps the one that was written, of a path.
    fn keep(&mut self, number: u32) {
        self.numbers.push(number);
    }

    /// The vertices of paths, and room for the directions that are drawn there.
    fn iter(&mut self) -> impl Iterator<Item = (u32, &Vertex<'s>, &mut BsdfSample)> {
        let places = self.numbers.iter().zip(&self.arrivals).zip(&mut self.draws);
        places.filter_map(|((number, arrival), draw)| match arrival {
            Arrival::Vertex(vertex) => Some((*number, vertex, draw)),
            _ => None,
        })
    }
}

/// Room for the paths of a wave; kept, so that nothing is allocated per sample.
#[derive(Debug, Default)]
pub struct WaveBuffer<'s> {
    /// As many as samples, in their order.
    walkers: Vec<Walker>,
    /// Those under way.
    live: Vec<u32>,
    order: Vec<u32>,
    rays: Vec<Ray>,
    hits: Vec<Option<Hit>>,
    /// Those under way that arrived at Lambertian surfaces, with their hits.
    diffuse: Vec<(u32, Hit)>,
    /// Those that arrived elsewhere.
    vertices: Vertices<'s>,
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
pub(crate) fn wave<'s, const MEDIA: bool>(
    path: &PathTracer<MEDIA>,
    scene: &'s Scene,
    precomputed: &Precomputed,
    pixel_samples: &mut [PixelSample],
    buffer: &mut WaveBuffer<'s>,
    counters: &mut Counters,
) {
    buffer.walkers.clear();
    buffer.walkers.resize(pixel_samples.len(), Walker { state: PathState::NONE, goes_on: true });
    for (s, Walker { state, .. }) in pixel_samples.iter_mut().zip(&mut buffer.walkers) {
        (s.radiance, s.rays) = (Spectrum::ZERO, 0);
        state.start(scene, s.ray);
    }
    buffer.live.clear();
    buffer.live.extend(0..pixel_samples.len() as u32);
    let walk = Walk { path, scene, precomputed, lanes: Lanes::best() };
    while !buffer.live.is_empty() {
        walk.bounce(buffer, pixel_samples, counters);
    }
}

impl<'s, const MEDIA: bool> Walk<'_, 's, MEDIA> {
    /// Follows all paths by a ray, and from there on to the next.
    fn bounce(&self, buffer: &mut WaveBuffer<'s>, pixel_samples: &mut [PixelSample], counters: &mut Counters) {
        let scene = self.scene;
        let WaveBuffer { walkers, live, order, rays, hits, diffuse, vertices, shadows, occluded, block } = buffer;
        sort(live, order, walkers);
        rays.clear();
        rays.extend(live.iter().map(|&w| walkers[w as usize].state.ray));
        hits.clear();
        hits.resize(rays.len(), None);
        scene.intersect_batch(rays, hits);
        counters.rays += rays.len() as u64;

        diffuse.clear();
        shadows.clear();
        vertices.clear();
        // Guides draw their numbers themselves, and the way to a light may lead through several media.
        let has_columns = self.precomputed.caustics.is_none()
            && !(MEDIA && scene.is_see_through())
            && pixel_samples.first().is_some_and(|s| s.own.sobol().is_some());
        for (&number, hit) in live.iter().zip(&*hits) {
            let (walker, sample) = (&mut walkers[number as usize], &mut pixel_samples[number as usize]);
            sample.rays += 1;
            if has_columns
                && let Some(hit) = hit
                && self.is_diffuse(hit, walker)
            {
                diffuse.push((number, *hit));
                continue;
            }
            let before = counters.rays;
            let PixelSample { own, lambda, radiance, .. } = sample;
            let context = &mut PathContext { scene, sampler: own, lambda, counters };
            let arrival = vertices.next();
            walker.goes_on = self.arrive(&mut walker.state, *hit, radiance, arrival, context);
            if walker.goes_on {
                if has_columns {
                    vertices.keep(number);
                } else {
                    walker.goes_on = self.step(number, &mut walker.state, arrival, radiance, context, shadows);
                }
            }
            sample.rays += (counters.rays - before) as u32;
            if vertices.is_full() {
                self.scatter(block, vertices, walkers, pixel_samples, (shadows, counters));
            }
        }
        self.scatter(block, vertices, walkers, pixel_samples, (shadows, counters));
        for vertices in diffuse.chunks(WIDTH) {
            gather(block, vertices, walkers, scene, pixel_samples);
            block::surfaces(self.lanes, block);
            block::numbers(self.lanes, block);
            materials(block, vertices, scene);
            let places = vertices.iter().map(|(number, _)| *number);
            illuminate(self.lanes, block, places.clone(), scene, pixel_samples);
            block::diffuse(self.lanes, block, self.path.depth);
            self.depart_diffuse(block, places, walkers, pixel_samples, shadows);
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

    /// Whether a path arrived at a surface that scatters by Lambert's law, the same everywhere.
    #[inline]
    fn is_diffuse(&self, hit: &Hit, walker: &Walker) -> bool {
        (!MEDIA || walker.state.medium.is_none()) && self.scene.is_lambertian(hit.id)
    }

    /// Follows a path from its hit to a vertex; whether there is one.
    #[inline]
    fn arrive(
        &self,
        state: &mut PathState,
        hit: Option<Hit>,
        radiance: &mut Spectrum,
        arrival: &mut Arrival<'s>,
        context: &mut PathContext<'s, '_>,
    ) -> bool {
        let depth = &self.path.depth;
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
        if MEDIA && self.scene.is_see_through() {
            *radiance += state.direct::<MEDIA>(vertex, context);
        } else if let Some((value, ray)) = vertex.direct_along::<MEDIA>(state.event_of_light(0), context) {
            shadows.push(number, state.beta * value, ray);
        }
        let guide = self.precomputed.caustics.as_ref();
        let Some(s) = state.sample(vertex, context.sampler, guide) else { return false };
        state.turn::<MEDIA>(self.scene, vertex, &s);
        if !state.beta.is_finite() {
            // Handed to the film, which counts it.
            *radiance = state.beta;
            return false;
        }
        state.survives(&self.path.depth, context)
    }

    /// Follows paths from vertices of any kind to their next rays, all but the model itself in columns.
    fn scatter(
        &self,
        b: &mut Block,
        vertices: &mut Vertices<'s>,
        walkers: &mut [Walker],
        pixel_samples: &mut [PixelSample],
        (shadows, counters): (&mut Shadows, &mut Counters),
    ) {
        if vertices.numbers.is_empty() {
            return;
        }
        let scene = self.scene;
        for (k, (number, vertex, _)) in vertices.iter().enumerate() {
            let (state, sample) = (&walkers[number as usize].state, &pixel_samples[number as usize]);
            let (ctx, (error, n)) = (vertex.context(), vertex.spread());
            set3(&mut b.p, k, ctx.p);
            set3(&mut b.error, k, error);
            set3(&mut b.n, k, n);
            set3(&mut b.light_n, k, ctx.n);
            b.is_lit[k] = u32::from(!vertex.is_unlit());
            (b.events[k], b.passes[k]) = (state.events, state.passes);
            let (seed, reversed) = sample.own.sobol().unwrap_or_default();
            (b.sampler[0][k], b.sampler[1][k]) = (seed, reversed);
        }
        block::numbers(self.lanes, b);
        illuminate(self.lanes, b, vertices.numbers.iter().copied(), scene, pixel_samples);
        for (k, (number, vertex, draw)) in vertices.iter().enumerate() {
            let state = &mut walkers[number as usize].state;
            let PixelSample { own, lambda, .. } = &mut pixel_samples[number as usize];
            let mut light = Spectrum::ZERO;
            if b.light_pdf[k] > 0.0 {
                let (wi, distance) = (get3(&b.light_wi, k), b.light_distance[k]);
                let s = LightSample {
                    wi,
                    distance,
                    radiance: Spectrum::new(get4(&b.light_radiance, k)),
                    pdf: b.light_pdf[k],
                    is_delta: b.light_is_delta[k] != 0,
                };
                light = vertex.reflected(&s);
                if !light.is_black() {
                    let context = &PathContext { scene, sampler: own, lambda, counters };
                    light = vertex.attenuated::<MEDIA>(light, (wi, distance), state.events, context);
                }
            }
            set4(&mut b.light, k, (state.beta * light).to_array());
            b.is_lit[k] = u32::from(!light.is_black());
            let drawn = vertex.draw(b.lobe_u[k], Vec2::new(b.bsdf_u[0][k], b.bsdf_u[1][k]));
            b.is_drawn[k] = drawn.is_some().into();
            let Some(s) = drawn else { continue };
            set3(&mut b.wi, k, vertex.world(s.wi));
            b.for_roulette[k] = state.for_roulette * (s.eta * s.eta);
            b.is_single[k] = lambda.is_secondary_terminated().into();
            set4(&mut b.beta, k, (state.beta * s.weight).to_array());
            *draw = s;
        }
        block::depart(self.lanes, b, self.path.depth);
        for (k, (number, vertex, draw)) in vertices.iter().enumerate() {
            let Walker { state, goes_on } = &mut walkers[number as usize];
            let time = state.ray.time;
            if b.is_lit[k] != 0 {
                shadows.push_of(b, k, number, time);
            }
            *goes_on = b.fate[k] == GOES_ON;
            if b.fate[k] == IS_NOT_FINITE {
                pixel_samples[number as usize].radiance = Spectrum::new(get4(&b.beta, k));
            }
            if *goes_on {
                let (ray, beta) = (Ray::new(get3(&b.origin, k), get3(&b.wi, k)), Spectrum::new(get4(&b.beta, k)));
                state.leave::<MEDIA>(scene, vertex, draw, Ray { time, ..ray });
                (state.beta, state.for_roulette) = (beta, b.for_roulette[k]);
            }
        }
        vertices.clear();
    }

    /// Lets paths go on from Lambertian surfaces as the block has it.
    fn depart_diffuse(
        &self,
        b: &Block,
        numbers: impl Iterator<Item = u32>,
        walkers: &mut [Walker],
        pixel_samples: &mut [PixelSample],
        shadows: &mut Shadows,
    ) {
        for (k, number) in numbers.enumerate() {
            let Walker { state, goes_on } = &mut walkers[number as usize];
            // Of the last surface there is emission alone.
            *goes_on = state.events < self.path.depth.max && b.fate[k] == GOES_ON;
            if state.events >= self.path.depth.max {
                continue;
            }
            let time = state.ray.time;
            if b.is_lit[k] != 0 {
                shadows.push_of(b, k, number, time);
            }
            let beta = Spectrum::new(get4(&b.beta, k));
            if b.fate[k] == IS_NOT_FINITE {
                pixel_samples[number as usize].radiance = beta;
            }
            if *goes_on {
                state.ray = Ray { time, ..Ray::new(get3(&b.origin, k), get3(&b.wi, k)) };
                state.beta = beta;
                state.origin = Some((LightContext { p: get3(&b.p, k), n: get3(&b.light_n, k) }, b.pdf[k]));
                state.events += 1;
                state.differential = None;
            }
        }
    }
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
        let Some((mesh, _)) = scene.lambertian(hit.id) else { continue };
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
        (block.for_roulette[k], block.events[k], block.passes[k]) = (state.for_roulette, state.events, state.passes);
        block.is_single[k] = pixel_samples[*number as usize].lambda.is_secondary_terminated().into();
        let (seed, reversed) = pixel_samples[*number as usize].own.sobol().unwrap_or_default();
        (block.sampler[0][k], block.sampler[1][k]) = (seed, reversed);
    }
}

/// Fills the columns of Lambertian materials.
fn materials(b: &mut Block, vertices: &[(u32, Hit)], scene: &Scene) {
    for (k, (_, hit)) in vertices.iter().enumerate() {
        let Some((mesh, sides)) = scene.lambertian(hit.id) else { continue };
        if b.is_unusual[k] != 0 {
            let s = mesh.bare(hit.id.prim, hit.u, hit.v);
            set3(&mut b.n, k, s.n);
            set3(&mut b.ns, k, s.ns);
            b.is_front[k] = u32::from(s.ns.dot(-get3(&b.direction, k)) > 0.0);
        }
        let (reflectance, is_flipped) = sides[b.is_front[k] as usize & 1];
        set4(&mut b.reflectance, k, reflectance.to_array());
        set3(&mut b.light_n, k, get3(&b.ns, k) * if is_flipped { -1.0 } else { 1.0 });
        b.is_lit[k] = 1;
    }
}

/// Chooses lights, where light matters: fills `lights` with them, and the column of densities with the probabilities,
/// zero where there is none.
fn choose(
    lanes: Lanes,
    b: &mut Block,
    numbers: impl Iterator<Item = u32>,
    scene: &Scene,
    pixel_samples: &[PixelSample],
    lights: &mut Column<u32>,
) {
    let (all, nodes) = (scene.lights(), scene.lights().tree().nodes());
    // Those on their way down the tree, with the node where they are, and the probability of the tree.
    let (mut going, mut count) = ([(0, 0, 0.0); WIDTH], 0);
    for (k, number) in numbers.enumerate() {
        b.light_pdf[k] = 0.0;
        if b.is_lit[k] == 0 || !all.can_sample() {
            continue;
        }
        let ctx = LightContext { p: get3(&b.p, k), n: get3(&b.light_n, k) };
        let own = &pixel_samples[number as usize].own;
        let u = own.get_1d_lazily(dimension::at(b.events[k], dimension::LIGHT), all.are_many());
        match all.choose_kind(&ctx, u) {
            Some(Choice::Infinite(light, p)) => (lights[k], b.light_pdf[k]) = (light, p),
            Some(Choice::Tree(u, share)) => {
                (b.choice[k], b.chance[k]) = (u, 1.0);
                going[count] = (k, 0, share);
                count += 1;
            }
            None => {}
        }
    }
    loop {
        let mut on_their_way = 0;
        for at in 0..count {
            let (k, place, share) = going[at];
            let Some(node) = nodes.get(place) else { continue };
            if node.leaf {
                (lights[k], b.light_pdf[k]) = (node.index, b.chance[k] * share);
            } else {
                b.children[0].set(k, &nodes[place + 1].cluster);
                b.children[1].set(k, &nodes[node.index as usize].cluster);
                going[on_their_way] = (k, place, share);
                on_their_way += 1;
            }
        }
        count = on_their_way;
        if count == 0 {
            return;
        }
        block::children(lanes, b);
        on_their_way = 0;
        for at in 0..count {
            let (k, place, share) = going[at];
            if b.chance[k] > 0.0 {
                let next = if b.is_second[k] != 0 { nodes[place].index as usize } else { place + 1 };
                going[on_their_way] = (k, next, share);
                on_their_way += 1;
            }
        }
        count = on_their_way;
    }
}

/// Fills the columns of light samples, where light matters.
fn illuminate(
    lanes: Lanes,
    b: &mut Block,
    numbers: impl Iterator<Item = u32> + Clone,
    scene: &Scene,
    pixel_samples: &[PixelSample],
) {
    let (all, mut lights) = (scene.lights(), [0; WIDTH]);
    let (mut has_flat, mut has_large) = (false, false);
    choose(lanes, b, numbers.clone(), scene, pixel_samples, &mut lights);
    for (k, number) in numbers.enumerate() {
        b.is_flat[k] = 0;
        let (p, light, lambda) = (b.light_pdf[k], lights[k], &pixel_samples[number as usize].lambda);
        if p <= 0.0 {
            continue;
        }
        let at = get3(&b.p, k);
        if let Light::Area(area) = &all.lights[light as usize] {
            let emitter = &all.emitters[area.emitter as usize];
            if let (Some(flat), Some(radiance)) = (area.flat(at), emitter.everywhere(lambda)) {
                if b.flat_number[k] != light {
                    b.flat_number[k] = light;
                    set3(&mut b.flat_corner, k, flat.corner);
                    set3(&mut b.flat_edges[0], k, flat.edges[0]);
                    set3(&mut b.flat_edges[1], k, flat.edges[1]);
                    set3(&mut b.flat_n, k, flat.n);
                    b.flat_area[k] = flat.area;
                    b.flat_is_triangle[k] = flat.is_triangle.into();
                    b.flat_is_two_sided[k] = emitter.two_sided.into();
                }
                set4(&mut b.light_radiance, k, radiance.to_array());
                (b.light_is_delta[k], b.is_flat[k], has_flat) = (0, 1, true);
                b.light_pdf[k] = if radiance.is_black() { 0.0 } else { p };
                has_large |= flat.is_large(at);
                continue;
            }
        }
        b.light_pdf[k] = 0.0;
        let ctx = LightContext { p: at, n: get3(&b.light_n, k) };
        let u = Vec2::new(b.light_u[0][k], b.light_u[1][k]);
        let Some(s) = all.sample(light, &ctx, u, lambda, scene.textures()) else { continue };
        set3(&mut b.light_wi, k, s.wi);
        set4(&mut b.light_radiance, k, s.radiance.to_array());
        (b.light_distance[k], b.light_pdf[k]) = (s.distance, s.pdf * p);
        b.light_is_delta[k] = s.is_delta.into();
    }
    match (has_flat, has_large) {
        (_, true) => block::flat_lights(lanes, b),
        (true, false) => block::small_lights(lanes, b),
        (false, false) => {}
    }
}

/// Puts paths next to each other whose rays have the same signs of direction and the same greatest axis.
fn sort(live: &mut Vec<u32>, order: &mut Vec<u32>, walkers: &[Walker]) {
    const CLASSES: usize = 24;
    let class = |w: u32| {
        let d = walkers[w as usize].state.ray.direction;
        let signs = d.x.to_bits() >> 31 | d.y.to_bits() >> 31 << 1 | d.z.to_bits() >> 31 << 2;
        let (x, y, z) = (d.x.abs(), d.y.abs(), d.z.abs());
        let axis = if x >= y && x >= z { 0 } else { 1 + u32::from(z > y) };
        (axis * 8 + signs) as usize
    };
    let mut starts = [0; CLASSES + 1];
    live.iter().for_each(|&w| starts[class(w) + 1] += 1);
    (0..CLASSES).for_each(|k| starts[k + 1] += starts[k]);
    order.clear();
    order.resize(live.len(), 0);
    for &w in &*live {
        let start = &mut starts[class(w)];
        order[*start] = w;
        *start += 1;
    }
    std::mem::swap(live, order);
}
