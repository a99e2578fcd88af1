//! Metropolis light transport in primary sample space: chains that change the random numbers of bidirectional path
//! tracing (Kelemen et al. 2002, "A Simple and Robust Mutation Strategy for the Metropolis Light Transport Algorithm").
//!
//! A pass begins with independent samples, of which chains take theirs in proportion to what they bring; their mean is
//! the chains' scale. So a pass is right in the mean whatever its length (Veach 1997, 11.3.1), passes are independent,
//! and chains are too, given where they begin.

use super::{
    bidirectional::{Bidirectional, Strategy, Tracer},
    radius::Radius,
    subpath::Numbers,
};
use crate::{Counters, Depth, dimension, support};
use std::{cell::RefCell, collections::HashMap, sync::Arc};
use steradian_core::{
    Scene,
    film::{PassFilm, Splat},
};
use steradian_engine::{CameraSample, Feature, Method, MethodKind, Pass, Passes, Plan, Refusal, Run, Session, Support};
use steradian_math::{
    Vec2,
    color::luminance,
    hash::{HashRng, ONE_MINUS_EPSILON, combine64},
};

/// Samples per pixel of a pass.
const SAMPLES: u32 = 4;
/// Mutations of a chain, and independent samples from which a chain's beginning is chosen.
const MUTATIONS: usize = 512;
const BEGINNINGS: usize = 64;
/// The range of small changes.
const SMALLEST: f32 = 1.0 / 1024.0;
const LARGEST: f32 = 1.0 / 64.0;

/// The settings.
#[derive(Clone, Copy, Debug)]
pub struct Metropolis {
    /// Path depth: events of both subpaths count.
    pub depth: Depth,
    /// Probability of a sample that does not depend on the last one, above 0 and up to 1.
    pub large_step: f32,
}

impl Metropolis {
    fn paths(&self) -> Bidirectional {
        Bidirectional { depth: self.depth, strategy: Strategy::Connections, radius: Radius::Pixels(1.0) }
    }
}

/// `pssmlt`.
pub const PSSMLT: MethodKind = MethodKind::new("pssmlt", |asked| {
    let large_step = asked.options.number("large_step").unwrap_or_default() as f32;
    Ok(Arc::new(Metropolis { depth: asked.depth(), large_step }))
});

impl Method for Metropolis {
    fn supports(&self, feature: Feature) -> Support {
        support::of_passes(feature)
    }

    fn session(&self, scene: Arc<Scene>, plan: Plan) -> Result<Box<dyn Session>, Refusal> {
        Ok(Box::new(Passes::new(scene, Chains::new(*self), plan)))
    }
}

/// The method with what it prepared.
#[derive(Debug)]
pub(super) struct Chains {
    tracer: Tracer,
    large_step: f32,
}

impl Chains {
    pub fn new(settings: Metropolis) -> Self {
        Self { tracer: Tracer::new(settings.paths()), large_step: settings.large_step }
    }
}

/// A coordinate of a sample: its value, and the mutation after which it has it.
#[derive(Clone, Copy)]
struct Coordinate {
    value: f32,
    time: u64,
}

/// The random numbers of a chain's proposal, made when they are asked for.
struct State {
    rng: HashRng,
    coordinates: HashMap<u32, Coordinate>,
    /// Coordinates before the proposal, for rejection.
    before: Vec<(u32, Option<Coordinate>)>,
    time: u64,
    last_large: u64,
    is_large: bool,
}

struct Proposal(RefCell<State>);

impl Proposal {
    fn new(seed: u64) -> Self {
        Self(RefCell::new(State {
            rng: HashRng::new(seed),
            coordinates: HashMap::new(),
            before: Vec::new(),
            time: 0,
            last_large: 0,
            is_large: true,
        }))
    }

    /// Begins a mutation.
    fn mutate(&self, is_large: bool) {
        let s = &mut *self.0.borrow_mut();
        s.time += 1;
        s.is_large = is_large;
        s.before.clear();
    }

    fn accept(&self) {
        let s = &mut *self.0.borrow_mut();
        // An accepted large step has drawn all coordinates anew.
        if s.is_large {
            s.last_large = s.time;
        }
    }

    fn reject(&self) {
        let s = &mut *self.0.borrow_mut();
        // Rejected: coordinates go back to what they were before the proposal.
        s.time -= 1;
        while let Some((key, was)) = s.before.pop() {
            match was {
                Some(c) => s.coordinates.insert(key, c),
                None => s.coordinates.remove(&key),
            };
        }
    }

    fn uniform(&self) -> f32 {
        self.0.borrow_mut().rng.next_f32()
    }

    fn get(&self, key: u32) -> f32 {
        let s = &mut *self.0.borrow_mut();
        // Lazy evaluation (Kelemen et al. 2002): a coordinate is brought up to date only when it is asked for.
        let was = s.coordinates.get(&key).copied();
        if let Some(c) = was.filter(|c| c.time == s.time) {
            return c.value;
        }
        // Coordinates that were not asked for since the last large step have been drawn anew by it.
        let mut c = match was {
            Some(c) if c.time >= s.last_large => c,
            _ => Coordinate { value: s.rng.next_f32(), time: s.last_large },
        };
        if s.is_large {
            c.value = s.rng.next_f32();
        } else {
            // Small steps that it did not take part in, all at once: in truth one for each, which only this many are
            // made of.
            for _ in 0..(s.time - c.time).min(MUTATIONS as u64) {
                c.value = perturbed(c.value, s.rng.next_f32());
            }
        }
        c.time = s.time;
        s.before.push((key, was));
        s.coordinates.insert(key, c);
        c.value
    }
}

/// A small change of a number, exponentially distributed, around the unit interval.
fn perturbed(value: f32, u: f32) -> f32 {
    // s₂ exp(−ln(s₂/s₁) u) in either direction, wrapped around [0, 1).
    let (u, sign) = if u < 0.5 { (2.0 * u, 1.0) } else { (2.0 * u - 1.0, -1.0) };
    let step = LARGEST * (-(LARGEST / SMALLEST).ln() * u).exp();
    let v = value + sign * step;
    (v - v.floor()).min(ONE_MINUS_EPSILON)
}

impl Numbers for Proposal {
    fn one(&self, dimension: u32) -> f32 {
        self.get(2 * dimension)
    }

    fn two(&self, dimension: u32) -> Vec2 {
        Vec2::new(self.get(2 * dimension), self.get(2 * dimension + 1))
    }
}

/// Contributions of a sample to the film, and its target function.
#[derive(Clone, Default)]
struct Sample {
    splats: Vec<Splat>,
    importance: f32,
}

impl Chains {
    /// The sample of the numbers as they are, of the picture as a whole.
    fn sample(&self, run: &Run<'_>, numbers: &Proposal, counters: &mut Counters) -> Sample {
        let (scene, film) = (run.scene, run.scene.film());
        // A place on the film, a camera ray, wavelengths and a moment: all from the coordinates of the chain.
        let size = Vec2::new(film.width as f32, film.height as f32);
        let margin = (film.filter.radius() - 0.5).max(Vec2::ZERO);
        // Filters of pixels at the edge reach beyond the frame.
        let at = numbers.two(dimension::FILM) * (size + 2.0 * margin) - margin;
        let ray = scene.camera().ray(film, at, numbers.two(dimension::LENS));
        let lambda = scene.mode().wavelengths(|| numbers.one(dimension::WAVELENGTH));
        let lambda = if scene.is_timed() { lambda.at_time(numbers.one(dimension::TIME)) } else { lambda };
        let sampler = run.sampler.pixel(0, 0, 0);
        let camera = CameraSample { at, ray, sampler, lambda, weight: 1.0 };
        // Bidirectional path tracing at that point of primary sample space.
        let (own, mut splats) = self.tracer.connect(run, &camera, numbers, counters);
        let pixels = size.x * size.y;
        splats.iter_mut().for_each(|s| s.rgb *= pixels);
        splats.push(Splat { at, rgb: own * ((size.x + 2.0 * margin.x) * (size.y + 2.0 * margin.y)) });
        splats.retain(|s| s.rgb.is_finite());
        // Target function: luminance of everything that the sample adds to the film.
        let importance = splats.iter().map(|s| luminance(s.rgb.abs())).sum::<f32>();
        Sample { importance: if importance.is_finite() { importance } else { 0.0 }, splats }
    }

    /// A chain: splats that its states and proposals bring.
    fn chain(&self, run: &Run<'_>, seed: u64, mutations: usize, counters: &mut Counters) -> Vec<Splat> {
        // Where it begins, and the mean of all places where it might have.
        let seeds: Vec<u64> = (0..BEGINNINGS as u64).map(|k| combine64(seed, k)).collect();
        let weights: Vec<f32> = seeds
            .iter()
            .map_while(|s| (!run.is_cancelled()).then(|| self.sample(run, &Proposal::new(*s), counters).importance))
            .collect();
        // Start-up bias is avoided: the chain starts from independent samples by importance, and their mean is its
        // scale.
        let sum: f32 = weights.iter().sum();
        if !(sum > 0.0 && sum.is_finite()) {
            return Vec::new();
        }
        let scale = sum / BEGINNINGS as f32 / mutations as f32;
        let mut u = HashRng::new(combine64(seed, u64::MAX)).next_f32() * sum;
        let first = weights.iter().position(|w| {
            u -= w;
            u < 0.0 && *w > 0.0
        });
        let first = first.or_else(|| weights.iter().rposition(|w| *w > 0.0)).unwrap_or(0);
        let numbers = Proposal::new(seeds[first]);
        let mut state = self.sample(run, &numbers, counters);
        let mut found = Vec::new();
        let mut add = |s: &Sample, share: f32| {
            if share > 0.0 && s.importance > 0.0 {
                let k = share * scale / s.importance;
                found.extend(
                    s.splats.iter().map(|s| Splat { at: s.at, rgb: s.rgb * k }).filter(|s| s.rgb != glam::Vec3::ZERO),
                );
            }
        };
        // What a state brings is added when it is left.
        let mut stayed = 0.0;
        for _ in (0..mutations).take_while(|_| !run.is_cancelled()) {
            // Mutation: a large step, or small changes of all coordinates that are used.
            let is_large = numbers.uniform() < self.large_step;
            numbers.mutate(is_large);
            let proposed = self.sample(run, &numbers, counters);
            // Metropolis acceptance a = min(1, f(y)/f(x)); both states are added with their expected share.
            let accept = (proposed.importance / state.importance).min(1.0);
            stayed += 1.0 - accept;
            if numbers.uniform() < accept {
                add(&state, stayed);
                numbers.accept();
                (state, stayed) = (proposed, accept);
            } else {
                add(&proposed, accept);
                numbers.reject();
            }
        }
        add(&state, stayed);
        found
    }
}

impl Pass for Chains {
    fn samples_per_pass(&self) -> u32 {
        SAMPLES
    }

    fn prepare(&mut self, run: &Run<'_>) -> Option<()> {
        self.tracer.look(run.scene);
        Some(())
    }

    fn pass(&self, run: &Run<'_>, number: u32, film: &mut PassFilm<'_>) -> Option<Counters> {
        let spec = run.scene.film();
        let pixels = u64::from(spec.width) * u64::from(spec.height);
        // As many chains as it takes for the samples of the pass.
        let chains = (pixels * u64::from(SAMPLES)).div_ceil(MUTATIONS as u64).max(1) as usize;
        let mut total = Counters::default();
        const WAVE: usize = 64;
        for first in (0..chains).step_by(WAVE) {
            let (found, counters) = run.in_order(WAVE.min(chains - first), |k, counters| {
                let seed = combine64(combine64(run.sampler.seed, u64::from(number)), (first + k) as u64);
                let splats = self.chain(run, seed, MUTATIONS, counters);
                counters.samples += MUTATIONS as u64;
                splats
            })?;
            total += &counters;
            for s in found.iter().flatten() {
                film.splat(&Splat { rgb: s.rgb / chains as f32, ..*s });
            }
        }
        total.samples = u64::from(film.crop().width()) * u64::from(film.crop().height()) * u64::from(SAMPLES);
        Some(total)
    }
}
