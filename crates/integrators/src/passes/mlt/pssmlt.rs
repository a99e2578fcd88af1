//! `pssmlt`: chains in the space of all numbers of a pair of subpaths, joined in every way (Kelemen et al. 2002, "A
//! Simple and Robust Mutation Strategy for the Metropolis Light Transport Algorithm").

use super::{
    Metropolis,
    chain::{Chains, Space},
    proposal::Proposal,
    sample::Sample,
};
use crate::{
    Counters,
    passes::{bidirectional::Tracer, pair::Joins},
    support,
};
use std::sync::Arc;
use steradian_core::Scene;
use steradian_engine::{Feature, Method, MethodKind, Passes, Plan, Refusal, Run, Session, Support};

#[derive(Clone, Copy, Debug)]
struct Pssmlt(Metropolis);

/// `pssmlt`.
pub const PSSMLT: MethodKind = MethodKind::new("pssmlt", |asked| Ok(Arc::new(Pssmlt(Metropolis::of(asked)))));

impl Method for Pssmlt {
    fn supports(&self, feature: Feature) -> Support {
        support::of_passes(feature)
    }

    fn session(&self, scene: Arc<Scene>, plan: Plan) -> Result<Box<dyn Session>, Refusal> {
        Ok(Box::new(Passes::new(scene, Chains::new(Joined(self.0.tracer()), self.0.large_step), plan)))
    }
}

/// Pairs of subpaths, joined in every way.
#[derive(Debug)]
struct Joined(Tracer);

impl Space for Joined {
    type Kind = ();

    fn look(&mut self, scene: &Scene) {
        self.0.look(scene);
    }

    fn kinds(&self, run: &Run<'_>, numbers: &Proposal, counters: &mut Counters) -> Vec<((), f32)> {
        vec![((), self.sample((), run, numbers, counters).importance)]
    }

    fn begin(&self, (): (), _: &Run<'_>, _: &Proposal) -> f32 {
        1.0
    }

    fn sample(&self, (): (), run: &Run<'_>, numbers: &Proposal, counters: &mut Counters) -> Sample {
        Sample::of(&self.0, run, numbers, Joins::All, counters)
    }
}
