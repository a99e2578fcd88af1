//! Stochastic iteration without a matrix (Neumann et al. 1995; Bekaert 1999, "incremental shooting"): the unshot light
//! of all patches is carried by rays, of which each patch sends as many as it has of the light; what they bring is the
//! unshot light of the next iteration, which has fewer rays in proportion. Any number of patches, memory of a few
//! numbers for each. Several runs are averaged.

use super::{
    factors::Exchange,
    patches::NONE,
    system::{Solved, System},
};
use glam::DVec4;
use rayon::prelude::*;
use std::ops::Range;

/// Iterations end when less than this share of the first light is left.
const LEAST: f64 = 1e-6;
/// Most iterations of a run.
const MOST: usize = 256;
/// Rays of a patch that are traced together, and of all of them before what they met is added up.
const TOGETHER: u32 = 1 << 12;
const AT_ONCE: u64 = 1 << 22;

/// Numbers of a patch's rays.
type Piece = (usize, Range<u32>);

/// Rays of patches, which have so many, in pieces.
fn pieces(counts: impl Iterator<Item = u32>) -> impl Iterator<Item = Piece> {
    counts.enumerate().flat_map(|(i, count)| {
        let starts = (0..count).step_by(TOGETHER as usize);
        starts.map(move |start| (i, start..count.min(start.saturating_add(TOGETHER))))
    })
}

/// Settings of a run.
#[derive(Clone, Copy, Debug)]
pub struct Shots {
    /// Rays for light as strong as the sources.
    pub rays: u64,
    /// Most times that light is carried from patch to patch; `None` for no limit.
    pub bounces: Option<u32>,
}

/// One run; irradiance by patch and band.
pub fn run(system: &System, exchange: &Exchange<'_>, shots: Shots, seed: u32) -> Option<Vec<DVec4>> {
    let n = system.bands;
    // What lights that are no patches send to a patch has been scattered once where it leaves: with a limit it is shot
    // one iteration later than what patches emit.
    let emission = &exchange.patches.emission;
    let (mut unshot, mut later) = match shots.bounces {
        None => (system.sources.clone(), None),
        Some(_) => (emission.clone(), Some(system.sources.iter().zip(emission).map(|(s, e)| *s - *e))),
    };
    let mut irradiance = vec![DVec4::ZERO; unshot.len()];
    // Power over all bands, by which rays are divided among patches.
    let power = |unshot: &[DVec4], i: usize| {
        unshot[i * n..(i + 1) * n].iter().map(|u| u.element_sum()).sum::<f64>() * system.areas[i]
    };
    let first: f64 = (0..system.len()).map(|i| power(&system.sources, i)).sum();
    // Each iteration carries the unshot light one bounce on.
    for iteration in 0..MOST.min(shots.bounces.map_or(MOST, |b| b as usize)) {
        let powers: Vec<f64> = (0..system.len()).map(|i| power(&unshot, i)).collect();
        let total: f64 = powers.iter().sum();
        if total <= LEAST * first && later.is_none() {
            break;
        }
        // As many rays as the light has left, so that each carries about the same.
        let budget = (shots.rays as f64 * total / first).ceil().max(64.0);
        // Systematic sampling: each patch has the rounded number of rays, up or down by one chance for all.
        let seed = steradian_math::hash::combine32(seed, iteration as u32);
        let chance = f64::from(steradian_math::hash::unit_f32(seed));
        let mut upto = 0.0;
        let shares: Vec<(f64, u32)> = powers
            .iter()
            .map(|p| {
                let before = upto;
                let share = if total > 0.0 { p / total * budget } else { 0.0 };
                upto += share;
                (share, ((upto + chance).floor() - (before + chance).floor()) as u32)
            })
            .collect();
        // What the rays bring is irradiance now, and unshot light of the next iteration.
        let mut next = vec![DVec4::ZERO; unshot.len()];
        let mut pieces = pieces(shares.iter().map(|share| share.1)).peekable();
        // Rays in pieces, many at once, added up in order.
        while pieces.peek().is_some() {
            let mut room = AT_ONCE;
            let some: Vec<Piece> = std::iter::from_fn(|| {
                pieces.next_if(|piece| piece.1.len() as u64 <= room).inspect(|piece| room -= piece.1.len() as u64)
            })
            .collect();
            let met: Vec<Vec<u32>> = some.par_iter().map(|piece| met(exchange, piece, seed)).collect();
            if !(exchange.tell)(0) {
                return None;
            }
            for (&(i, _), met) in some.iter().zip(&met) {
                for &j in met.iter().filter(|j| **j != NONE) {
                    let j = j as usize;
                    for b in 0..n {
                        // What the ray carries: the patch's light over the expected number of its rays.
                        let more = unshot[i * n + b] * (system.areas[i] / shares[i].0 / system.areas[j]);
                        let k = j * n + b;
                        irradiance[k] += more;
                        next[k] += system.reflectance[k] * more;
                        if system.twins[j] != NONE {
                            let other = system.twins[j] as usize * n + b;
                            next[other] += system.transmittance[other] * more;
                        }
                    }
                }
            }
        }
        for (next, more) in next.iter_mut().zip(later.take().into_iter().flatten()) {
            *next += more;
        }
        unshot = next;
    }
    Some(irradiance)
}

/// The patches that rays meet; none where told to stop.
fn met(exchange: &Exchange<'_>, (i, numbers): &Piece, seed: u32) -> Vec<u32> {
    if !(exchange.tell)(numbers.len()) {
        return Vec::new();
    }
    let patch = &exchange.patches.list[*i];
    let rays: Vec<_> = numbers.clone().map(|k| exchange.ray_from(patch, k, seed)).collect();
    exchange.met(&rays)
}

/// The mean of runs.
pub fn solve(system: &System, exchange: &Exchange<'_>, shots: Shots, runs: u32) -> Option<Solved> {
    let mut irradiance = vec![DVec4::ZERO; system.sources.len()];
    for k in 0..runs.max(1) {
        let seed = steradian_math::hash::combine32(exchange.seed, k ^ 0x6c07_8965);
        let one = run(system, exchange, shots, seed)?;
        irradiance.iter_mut().zip(one).for_each(|(sum, h)| *sum += h / f64::from(runs.max(1)));
    }
    Some(Solved { irradiance, steps: runs as usize, residual: 0.0 })
}
