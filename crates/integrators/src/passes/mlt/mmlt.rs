//! `mmlt`: multiplexed Metropolis light transport (Hachisuka, Kaplanyan, Dachsbacher 2014, "Multiplexed Metropolis
//! Light Transport"). A chain stays with paths of one number of scattering events; which of the techniques finds them
//! is one more coordinate of its space. So a chain joins a single pair of vertices for each mutation, and spends its
//! time with the techniques that bring most: those with a large MIS weight.
//!
//! A sample is `m w F`: the contribution F of the technique with its MIS weight w (section 4, equation 9), times the
//! number m of techniques that the coordinate chooses from. Where the source estimates the light of each path length by
//! samples of its own, a sample of bidirectional path tracing tells all of them at once here: of its techniques each is
//! a beginning.

use super::{
    Metropolis,
    chain::{Chains, Space},
    proposal::Proposal,
    sample::Sample,
};
use crate::{
    Counters,
    passes::{
        bidirectional::Tracer,
        pair::{Joins, Technique},
    },
    support,
};
use std::{collections::BTreeMap, sync::Arc};
use steradian_core::Scene;
use steradian_engine::{Feature, Method, MethodKind, Passes, Plan, Refusal, Run, Session, Support};

#[derive(Clone, Copy, Debug)]
struct Mmlt(Metropolis);

/// `mmlt`.
pub const MMLT: MethodKind = MethodKind::new("mmlt", |asked| Ok(Arc::new(Mmlt(Metropolis::of(asked)))));

impl Method for Mmlt {
    fn supports(&self, feature: Feature) -> Support {
        support::of_passes(feature)
    }

    fn session(&self, scene: Arc<Scene>, plan: Plan) -> Result<Box<dyn Session>, Refusal> {
        Ok(Box::new(Passes::new(scene, Chains::new(Multiplexed(self.0.tracer()), self.0.large_step), plan)))
    }
}

/// Pairs of subpaths of a number of events, joined by the technique that a coordinate chooses.
#[derive(Debug)]
struct Multiplexed(Tracer);

impl Multiplexed {
    /// The number of techniques for paths with so many events.
    fn techniques(&self, scene: &Scene, events: u32) -> u32 {
        match events {
            0 => 1,
            n => n.saturating_add(1 + u32::from(self.0.ways(scene, 0).to_camera)),
        }
    }
}

impl Space for Multiplexed {
    /// A technique where a chain begins, with the number of events where it stays.
    type Kind = Technique;

    fn look(&mut self, scene: &Scene) {
        self.0.look(scene);
    }

    fn kinds(&self, run: &Run<'_>, numbers: &Proposal, counters: &mut Counters) -> Vec<(Technique, f32)> {
        // A technique occurs several times where the ways lead through panes.
        let mut all = BTreeMap::new();
        for (technique, light) in Sample::of(&self.0, run, numbers, Joins::Listed, counters).parts {
            *all.entry(technique).or_insert(0.0) += light;
        }
        all.into_iter().collect()
    }

    fn begin(&self, technique: Technique, run: &Run<'_>, numbers: &Proposal) -> f32 {
        let count = self.techniques(run.scene, technique.events);
        numbers.set_technique(technique.light, count);
        1.0 / count as f32
    }

    fn sample(&self, kind: Technique, run: &Run<'_>, numbers: &Proposal, counters: &mut Counters) -> Sample {
        let count = self.techniques(run.scene, kind.events);
        let technique = Technique { light: numbers.technique(count), ..kind };
        Sample::of(&self.0, run, numbers, Joins::One(technique), counters).times(count as f32)
    }
}
