//! Training of a field: rounds of paths of which each is guided by the field of those before.

use super::{
    Guides,
    field::{Field, Found, KINDS, is_guided, kind},
    quadtree::Find,
};
use crate::{Counters, Stop, dimension, live_max, path::PathTracer};
use rayon::prelude::*;
use steradian_core::{
    Scene,
    sampler::{Sampler, SamplerKind},
};
use steradian_engine::PathContext;
use steradian_math::{Spectrum, Vec2, Vec3, sobol};
use steradian_transport::{Arrival, PathState, arrive, escape};

/// Paths of the first round; each further one has twice as many.
const FIRST: u32 = 1 << 14;
/// Part of a picture's samples that all rounds together have at most.
const PART: u64 = 5;
/// Most rounds: 2²⁰ paths in the last one.
const ROUNDS: u32 = 7;
/// Most finds that are kept, 24 bytes each.
const MOST: usize = 1 << 22;
/// Paths of a piece of work, and finds after which no more of them are followed: this bounds the memory of a round.
const PIECE: u32 = 1 << 10;
const FINDS: usize = 4 << 10;

/// Trains guides for a picture of so many samples, in as many rounds as these allow.
pub(super) fn train<const MEDIA: bool>(
    scene: &Scene,
    path: &PathTracer<MEDIA>,
    mut guides: Guides,
    samples: u64,
    stop: &Stop,
) -> Guides {
    let rounds = (0..ROUNDS).take_while(|round| u64::from(FIRST) * ((2 << round) - 1) <= samples / PART);
    let mut found: [Vec<Found>; KINDS] = Default::default();
    for round in rounds {
        // 1. All paths of the round by the guides so far, a piece at a time.
        let pieces: Vec<Vec<(usize, Found)>> = (0..(FIRST << round) / PIECE)
            .into_par_iter()
            .map(|piece| {
                let mut found = Vec::new();
                for index in piece * PIECE..(piece + 1) * PIECE {
                    if found.len() >= FINDS || stop.is_asked() {
                        break;
                    }
                    trace(scene, path, &guides, (round, index), stop, &mut found);
                }
                found
            })
            .collect();
        if stop.is_asked() {
            return guides;
        }
        // 2. What all rounds found, or the last one alone where that is too much.
        let [before, new] = [found.iter().map(Vec::len).sum::<usize>(), pieces.iter().map(Vec::len).sum()];
        if before + new > MOST {
            found.iter_mut().for_each(Vec::clear);
        }
        pieces.into_iter().flatten().take(MOST).for_each(|(kind, f)| found[kind].push(f));
        // 3. The field anew.
        guides.field = Some(Field::new(&mut found));
    }
    guides
}

/// A vertex of a path under way: its kind and point, the direction in which the path leaves it, the throughput before,
/// and all light that was found up to it.
struct Passed {
    kind: usize,
    p: Vec3,
    direction: Vec3,
    beta: f32,
    light: f32,
}

/// Follows a path from the camera, and adds what it found by each of its directions.
fn trace<const MEDIA: bool>(
    scene: &Scene,
    PathTracer { depth }: &PathTracer<MEDIA>,
    guides: &Guides,
    (round, index): (u32, u32),
    stop: &Stop,
    found: &mut Vec<(usize, Found)>,
) {
    let film = scene.film();
    let sampler = &Sampler { kind: SamplerKind::Independent, spp: 1, seed: u64::from(round) + 1 }.pixel(index, 1, 0);
    let mut lambda = scene.mode().wavelengths(|| sampler.get_1d(dimension::WAVELENGTH));
    if scene.is_timed() {
        lambda = lambda.at_time(sampler.get_1d(dimension::TIME));
    }
    // Camera rays over the whole picture, evenly.
    let place = Vec2::from(sobol::shuffled_scrambled_sobol_2d(index, round));
    let place = place * Vec2::new(film.width as f32, film.height as f32);
    let (ray, _) = scene.camera().sample(film, place, sampler.get_2d(dimension::LENS), &mut lambda);
    let counters = &mut Counters::until(stop);
    let context = &mut PathContext { scene, sampler, lambda: &mut lambda, counters };
    let mut path_state = PathState::camera(scene, ray);
    let (mut light, mut arrival) = (Spectrum::ZERO, Arrival::End);
    let mut passed: Vec<Passed> = Vec::new();
    // The path tracer's loop, which notes each direction with a density.
    loop {
        arrive::<MEDIA>(&mut path_state, depth, &mut light, &mut arrival, context);
        match &arrival {
            Arrival::Escaped => escape(&path_state, depth, &mut light, context),
            Arrival::Vertex(v) => light += path_state.direct::<MEDIA>(v, context),
            Arrival::End => {}
        }
        let Arrival::Vertex(v) = &arrival else { break };
        let beta = live_max(path_state.beta, context.lambda);
        let Some(draw) = path_state.sample(v, sampler, Some(guides)) else { break };
        if draw.sample.lobe.is_subsurface() {
            break;
        }
        if is_guided(v) && !draw.sample.lobe.is_specular() {
            let (direction, light) = (v.world(draw.sample.wi), live_max(light, context.lambda));
            passed.push(Passed { kind: kind(v), p: v.p(), direction, beta, light });
        }
        path_state.turn::<MEDIA>(scene, v, &draw);
        if !(path_state.survives(depth, context) && path_state.beta.is_finite()) {
            break;
        }
    }
    // Light (C − C_k)/β_k = f L |cosθ| / p that each direction brought, with C_k what was found before it.
    let all = live_max(light, context.lambda);
    for Passed { kind, p, direction, beta, light } in passed {
        let light = (all - light) / beta;
        if light > 0.0 && light.is_finite() {
            found.push((kind, Found { p, find: Find { place: Find::place(direction), light } }));
        }
    }
}
