//! Counters of the work, and cancellation.

use std::sync::{
    Arc,
    atomic::{AtomicBool, Ordering},
};
use steradian_math::Spectrum;

/// Cancellation flag, polled along each path. By default there is none.
#[derive(Clone, Debug, Default)]
pub struct Stop(Option<Arc<AtomicBool>>);

impl Stop {
    /// Stop by a flag that somebody else sets.
    pub fn by(flag: &Arc<AtomicBool>) -> Self {
        Self(Some(Arc::clone(flag)))
    }

    /// True once a stop was asked for. All that is found from then on counts for nothing.
    #[inline]
    pub fn is_asked(&self) -> bool {
        self.0.as_ref().is_some_and(|flag| flag.load(Ordering::Relaxed))
    }
}

/// Counters of the work, for reports. They are equal where the numbers are.
#[derive(Clone, Debug, Default)]
pub struct Counters {
    /// Rays traced, shadow rays among them.
    pub rays: u64,
    /// Camera samples taken.
    pub samples: u64,
    /// Samples that were not finite and count as black.
    pub nonfinite: u64,
    /// Cancellation flag of the work that is counted.
    pub stop: Stop,
    /// The light that the path under way brings, in parts: by groups of lights, by numbers of scattering events, or by
    /// time bins; empty where nobody asks.
    pub parts: Vec<Spectrum>,
    /// True if the parts are numbers of scattering events.
    pub by_bounce: bool,
}

impl Counters {
    /// None yet, of what is to end when somebody wishes.
    pub fn until(stop: &Stop) -> Self {
        Self { stop: stop.clone(), ..Self::default() }
    }

    /// Adds what a path brings after so many scattering events to its part, by these or by its light's group. The last
    /// part of bounces holds all that are beyond.
    #[inline]
    pub fn note(&mut self, events: u32, group: impl FnOnce() -> Option<u32>, light: Spectrum) {
        if !self.by_bounce {
            self.note_group(group, light);
        } else if let Some(last) = self.parts.len().checked_sub(1) {
            self.parts[last.min(events as usize)] += light;
        }
    }

    /// Adds what a path brings to the part of its light's group.
    #[inline]
    pub fn note_group(&mut self, group: impl FnOnce() -> Option<u32>, light: Spectrum) {
        if !self.parts.is_empty()
            && let Some(sum) = group().and_then(|g| self.parts.get_mut(g as usize))
        {
            *sum += light;
        }
    }
}

impl PartialEq for Counters {
    fn eq(&self, o: &Self) -> bool {
        (self.rays, self.samples, self.nonfinite) == (o.rays, o.samples, o.nonfinite)
    }
}

impl Eq for Counters {}

impl std::ops::AddAssign<&Self> for Counters {
    fn add_assign(&mut self, o: &Self) {
        self.rays += o.rays;
        self.samples += o.samples;
        self.nonfinite += o.nonfinite;
    }
}
