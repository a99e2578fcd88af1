//! The candidates that wait to be asked about.

use crate::ray::{Barycentrics, PrimitiveId};
use std::cmp::Ordering;

/// Candidate hit that waits for a decision.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Candidate {
    /// Hit distance of a triangle; for a box, a lower bound of the entry distance.
    pub t: f32,
    pub id: PrimitiveId,
    /// Weights of a triangle; `None` for a box.
    pub triangle: Option<Barycentrics>,
    pub is_opaque: bool,
}

impl Candidate {
    /// True if it counts without a decision: an opaque triangle.
    pub fn is_certain(&self) -> bool {
        self.is_opaque && self.triangle.is_some()
    }

    /// From near to far; of those at equal distance, by their number.
    fn order(&self, other: &Self) -> Ordering {
        self.t.total_cmp(&other.t).then_with(|| self.id.cmp(&other.id))
    }
}

/// Largest number of waiting candidates. Those beyond are looked for when these have been refused: where most of the
/// ray's candidates are refused, it traverses the hierarchy once for so many.
const CAPACITY: usize = 2;

/// The nearest candidates of those beyond one, in order.
#[derive(Debug, Default)]
pub(crate) struct Queue {
    /// The nearest one last; what is certain has none beyond it.
    pub waiting: Vec<Candidate>,
    /// True if there are others beyond these.
    pub has_more: bool,
    /// The one before all of these.
    pub after: Option<Candidate>,
}

impl Queue {
    /// Takes a candidate in where it is among the nearest. Gives whether what is farther than it is of no interest for
    /// now.
    pub fn offer(&mut self, candidate: Candidate) -> bool {
        if self.after.is_some_and(|after| candidate.order(&after) != Ordering::Greater) {
            return false;
        }
        let farther = self.waiting.iter().take_while(|other| other.order(&candidate) == Ordering::Greater).count();
        if farther == 0 && self.waiting.first().is_some_and(Candidate::is_certain) {
            return true;
        }
        if farther == 0 && self.waiting.len() >= CAPACITY {
            self.has_more = true;
            return true;
        }
        if candidate.is_certain() {
            self.waiting.splice(..farther, [candidate]);
            return true;
        }
        let is_full = self.waiting.len() >= CAPACITY;
        if is_full {
            // The farthest makes room.
            self.waiting.copy_within(1..farther, 0);
            self.waiting[farther - 1] = candidate;
        } else {
            self.waiting.insert(farther, candidate);
        }
        // It is the last one that there is room for.
        let is_last = self.waiting.len() == CAPACITY && farther == usize::from(is_full);
        self.has_more |= is_full || is_last;
        is_last
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use steradian_math::hash::HashRng;

    /// Against sorting all of them: round after round, until something is certain.
    #[test]
    fn candidates_come_in_order() {
        let mut rng = HashRng::new(1);
        let (mut rounds, mut certain) = (0, 0);
        for _ in 0..2000 {
            let count = rng.next_u64() % 20;
            let candidate = |i: u64| Candidate {
                t: (rng.next_u64() % 8) as f32,
                id: PrimitiveId { instance: 0, geometry: 0, primitive: (i * 7 % 20) as u32 },
                triangle: (!rng.next_u64().is_multiple_of(4)).then(Barycentrics::default),
                is_opaque: rng.next_u64().is_multiple_of(8),
            };
            let all: Vec<Candidate> = (0..count).map(candidate).collect();
            let mut expected = all.clone();
            expected.sort_by(Candidate::order);
            let end = expected.iter().position(Candidate::is_certain).map_or(expected.len(), |i| i + 1);
            let mut queue = Queue::default();
            let mut found = Vec::new();
            loop {
                queue.has_more = false;
                let mut nearest = f32::INFINITY;
                for candidate in &all {
                    // As the hierarchy does: what is farther is left out.
                    if candidate.t <= nearest && queue.offer(*candidate) {
                        nearest = candidate.t;
                    }
                }
                rounds += 1;
                found.extend(queue.waiting.drain(..).rev());
                queue.after = found.last().copied();
                if !queue.has_more || queue.after.is_none_or(|last| last.is_certain()) {
                    break;
                }
            }
            let ids = |all: &[Candidate]| all.iter().map(|c| c.id).collect::<Vec<_>>();
            assert_eq!(ids(&found), ids(&expected[..end]));
            certain += usize::from(found.last().is_some_and(Candidate::is_certain));
        }
        assert!(rounds > 3000 && certain > 500, "{rounds} {certain}");
    }
}
