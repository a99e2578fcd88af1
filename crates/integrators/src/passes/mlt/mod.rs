//! Metropolis light transport in primary sample space: chains that change the random numbers of bidirectional path
//! tracing. `proposal` has these numbers, `sample` what they bring, `chain` the chains, their beginnings and the film.
//! `pssmlt` and `mmlt` differ in the space that a chain moves through.

mod chain;
mod mmlt;
mod proposal;
mod pssmlt;
mod sample;

pub use mmlt::MMLT;
pub use pssmlt::PSSMLT;

use super::{
    bidirectional::{Bidirectional, Strategy, Tracer},
    radius::Radius,
};
use crate::Depth;
use steradian_engine::Asked;

/// Mutations of a chain, and independent samples for each chain from which beginnings are chosen.
const MUTATIONS: usize = 128;
const BEGINNINGS: usize = 16;

/// The settings of both methods.
#[derive(Clone, Copy, Debug)]
struct Metropolis {
    /// Path depth: events of both subpaths count.
    depth: Depth,
    /// Probability of a sample that does not depend on the last one, above 0 and up to 1.
    large_step: f32,
}

impl Metropolis {
    fn of(asked: &Asked<'_>) -> Self {
        Self { depth: asked.depth(), large_step: asked.options.number("large_step").unwrap_or_default() as f32 }
    }

    /// Bidirectional path tracing, which the chains drive.
    fn tracer(&self) -> Tracer {
        Tracer::new(Bidirectional { depth: self.depth, strategy: Strategy::Connections, radius: Radius::Pixels(1.0) })
    }
}
