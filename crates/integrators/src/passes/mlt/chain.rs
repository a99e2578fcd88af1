//! Markov chains, where they begin, and the film.
//!
//! Chains begin at independent samples, chosen in proportion to what they bring; their mean is the chains' scale. So a
//! pass is right in the mean whatever its length (Veach 1997, 11.3.1), and passes are independent.

use super::{BEGINNINGS, MUTATIONS, proposal::Proposal, sample::Sample};
use crate::Counters;
use std::fmt::Debug;
use steradian_core::{
    Scene,
    film::{PassFilm, Splat},
};
use steradian_engine::{Pass, Run};
use steradian_math::hash::{HashRng, combine64};

/// Samples per pixel of a pass.
const SAMPLES: u32 = 4;
/// Chains whose beginnings are chosen together, and whose findings wait to be added to the film.
const WAVE: usize = 256;

/// A space for chains: a target function of the numbers.
pub(super) trait Space: Debug + Send + Sync {
    /// Kept by a chain from its beginning on.
    type Kind: Copy + Debug + Ord + Send + Sync;

    /// Makes ready for a scene.
    fn look(&mut self, scene: &Scene);

    /// Kinds of chains that may begin at numbers just drawn, with weights: about the value of the target function there
    /// times the part of the kind's space that it is drawn from.
    fn kinds(&self, run: &Run<'_>, numbers: &Proposal, counters: &mut Counters) -> Vec<(Self::Kind, f32)>;

    /// Brings the numbers to where a chain of a kind begins; the part of the kind's space that this is drawn from.
    fn begin(&self, kind: Self::Kind, run: &Run<'_>, numbers: &Proposal) -> f32;

    /// The sample of the numbers as they are.
    fn sample(&self, kind: Self::Kind, run: &Run<'_>, numbers: &Proposal, counters: &mut Counters) -> Sample;
}

/// A place where a chain may begin.
#[derive(Clone, Copy, Debug)]
struct Beginning<K> {
    kind: K,
    /// Seed of its numbers.
    seed: u64,
    /// The chance to be chosen, in proportion to which it is.
    weight: f64,
}

/// The method with what it prepared.
#[derive(Debug)]
pub(super) struct Chains<S> {
    space: S,
    large_step: f32,
}

impl<S: Space> Chains<S> {
    /// Chains through a space, with the probability of large steps.
    pub fn new(space: S, large_step: f32) -> Self {
        Self { space, large_step }
    }

    /// Beginnings at independent samples.
    fn beginnings(&self, run: &Run<'_>, seed: u64, counters: &mut Counters) -> Vec<Beginning<S::Kind>> {
        let seeds = (0..BEGINNINGS as u64).map(|k| combine64(seed, k)).take_while(|_| !run.is_cancelled());
        let at = |seed| (seed, self.space.kinds(run, &Proposal::new(seed), counters));
        seeds
            .map(at)
            .flat_map(|(seed, kinds)| kinds.into_iter().map(move |(kind, weight)| (kind, seed, f64::from(weight))))
            .filter(|(_, _, weight)| *weight > 0.0 && weight.is_finite())
            .map(|(kind, seed, weight)| Beginning { kind, seed, weight })
            .collect()
    }

    /// A chain from its beginning, as a part of the light: splats that its states and proposals bring.
    fn chain(
        &self,
        run: &Run<'_>,
        from: &Beginning<S::Kind>,
        seed: u64,
        light: f64,
        counters: &mut Counters,
    ) -> Vec<Splat> {
        // The numbers of the beginning are drawn again; those that follow are the chain's own.
        let numbers = Proposal::new(from.seed);
        self.space.kinds(run, &numbers, counters);
        numbers.reseed(seed);
        let part = f64::from(self.space.begin(from.kind, run, &numbers));
        let mut state = self.space.sample(from.kind, run, &numbers, counters);
        // Where a weight differs from the target function, as that of colours partly negative does, the scale makes up
        // for it.
        let scale = (light / MUTATIONS as f64 * (f64::from(state.importance) * part / from.weight)) as f32;
        let mut found = Vec::new();
        let mut add = |s: &Sample, share: f32| {
            if share > 0.0 && s.importance > 0.0 {
                let k = share * scale / s.importance;
                found.extend(s.splats.iter().map(|s| Splat { at: s.at, rgb: s.rgb * k }));
            }
        };
        // What a state brings is added when it is left.
        let mut stayed = 0.0;
        for _ in (0..MUTATIONS).take_while(|_| !run.is_cancelled()) {
            // Mutation: a large step, or small changes of all coordinates that are used.
            let is_large = numbers.uniform() < self.large_step;
            numbers.mutate(is_large);
            let proposed = self.space.sample(from.kind, run, &numbers, counters);
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
        counters.samples += MUTATIONS as u64;
        found
    }
}

/// As many as asked for, in proportion to their weights: at even steps through their sum from an offset in [0, 1), so
/// that each run of neighbours gets its share but for one.
fn chosen<K: Copy>(all: &[Beginning<K>], sum: f64, count: usize, offset: f32) -> Vec<Beginning<K>> {
    let step = sum / count as f64;
    let (mut left, mut found) = (f64::from(offset) * step, Vec::with_capacity(count));
    for one in all {
        left -= one.weight;
        while left < 0.0 && found.len() < count {
            found.push(*one);
            left += step;
        }
    }
    found
}

impl<S: Space> Pass for Chains<S> {
    fn samples_per_pass(&self) -> u32 {
        SAMPLES
    }

    fn prepare(&mut self, run: &Run<'_>) -> Option<()> {
        self.space.look(run.scene);
        Some(())
    }

    fn pass(&self, run: &Run<'_>, number: u32, film: &mut PassFilm<'_>) -> Option<Counters> {
        let spec = run.scene.film();
        let pixels = u64::from(spec.width) * u64::from(spec.height);
        // As many chains as it takes for the samples of the pass.
        let chains = (pixels * u64::from(SAMPLES)).div_ceil(MUTATIONS as u64).max(1) as usize;
        let mut total = Counters::default();
        for first in (0..chains).step_by(WAVE) {
            let count = WAVE.min(chains - first);
            let seed = combine64(combine64(run.sampler.seed, u64::from(number)), first as u64);
            let [of_beginnings, of_chains] = [0, 1].map(|k| combine64(seed, k));
            let (beginnings, counters) =
                run.in_order(count, |k, counters| self.beginnings(run, combine64(of_beginnings, k as u64), counters))?;
            total += &counters;
            // Kind by kind, so that each gets its share of the chains.
            let mut beginnings = beginnings.concat();
            beginnings.sort_by_key(|b| b.kind);
            let sum: f64 = beginnings.iter().map(|b| b.weight).sum();
            let chosen = chosen(&beginnings, sum, count, HashRng::new(seed).next_f32());
            // A chain's part of the light: the mean of all samples over the number of chains.
            let light = sum / (count * BEGINNINGS) as f64 / chains as f64;
            let (found, counters) = run.in_order(chosen.len(), |k, counters| {
                self.chain(run, &chosen[k], combine64(of_chains, k as u64), light, counters)
            })?;
            total += &counters;
            found.iter().flatten().for_each(|s| film.splat(s));
        }
        total.samples = u64::from(film.crop().width()) * u64::from(film.crop().height()) * u64::from(SAMPLES);
        Some(total)
    }
}
