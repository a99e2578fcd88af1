//! Visitors of a walk's primitives: the two queries, and the counting of their steps.

use super::items::Items;
use super::shear::Shear;
use crate::leaves::UserLeaves;
use crate::nearest::Nearest;
use steradian_math::Ray;

/// Who is told of each cell and each test; `()` counts nothing and costs nothing.
pub(super) trait Tally {
    /// A node or cell is visited.
    fn step(&mut self);
    /// A primitive is tested.
    fn test(&mut self);
}

impl Tally for () {
    #[inline]
    fn step(&mut self) {}
    #[inline]
    fn test(&mut self) {}
}

/// Cost of queries, in numbers that do not depend on the machine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Steps {
    /// Nodes or cells visited.
    pub steps: u64,
    /// Primitives tested, one by one.
    pub tests: u64,
}

impl Tally for Steps {
    fn step(&mut self) {
        self.steps += 1;
    }
    fn test(&mut self) {
        self.tests += 1;
    }
}

/// Visitor of the primitives along a ray.
pub(super) trait Visitor {
    /// A node or cell is entered.
    fn step(&mut self);
    /// Tests the primitives in some slots. Whether the query is answered.
    fn visit(&mut self, slots: &[u32]) -> bool;
    /// Primitives that are farther do not matter.
    fn t_max(&self) -> f32;
}

/// The last primitives that were tested, so that those in several cells are tested once, mostly: a direct-mapped table
/// on the stack, which no other query shares (Benthin, "Realtime Ray Tracing on Current CPU Architectures", 2006, on
/// Arnaldi's mailboxes).
struct Mailbox([u32; 64]);

impl Mailbox {
    /// True if a primitive is new, as far as the table knows.
    #[inline]
    fn admits(&mut self, slot: u32) -> bool {
        // Direct-mapped: a collision only repeats a test.
        let place = &mut self.0[slot as usize % 64];
        let is_new = *place != slot;
        *place = slot;
        is_new
    }
}

/// The search for the nearest hit.
pub(super) struct NearestSearch<'a, U: UserLeaves, T> {
    items: &'a Items,
    users: &'a U,
    ray: &'a Ray,
    shear: Shear,
    mailbox: Mailbox,
    t: f32,
    pub best: Option<Nearest<U::Extra>>,
    pub tally: T,
}

impl<'a, U: UserLeaves, T: Tally> NearestSearch<'a, U, T> {
    /// For a valid ray.
    pub fn new(items: &'a Items, users: &'a U, ray: &'a Ray, tally: T) -> Self {
        let mailbox = Mailbox([u32::MAX; 64]);
        Self { items, users, ray, shear: Shear::new(ray), mailbox, t: ray.t_max, best: None, tally }
    }

    /// Tests one primitive. Of equal distances the smaller index wins.
    #[inline]
    fn test(&mut self, slot: u32) {
        let item = &self.items.list[slot as usize];
        let index = item.index();
        // The index decides between hits at equal distance, so that the order of cells does not matter.
        let wins_ties = self.best.as_ref().is_some_and(|best| index < best.index);
        self.tally.test();
        if item.is_user() {
            // One step beyond the hit so far, so that a tie can be won by the smaller index.
            let t_max = if wins_ties { self.t.next_up() } else { self.t };
            if let Some((hit, extra)) = self.users.intersect(index, &Ray { t_max, ..*self.ray })
                && hit.t > 0.0
                && hit.t < t_max
            {
                self.t = hit.t;
                self.best = Some(Nearest { hit, index, extra });
            }
        } else if let Some(hit) = self.shear.hit(&item.corners, self.t) {
            // A nearer hit, or a tie won by the smaller index, replaces the best if the filter accepts it.
            let closer = hit.t < self.t || wins_ties;
            if closer && (!item.is_filtered() || self.users.accept(index, hit, self.ray)) {
                self.t = hit.t;
                self.best = Some(Nearest { hit, index, extra: self.users.triangle() });
            }
        }
    }
}

impl<U: UserLeaves, T: Tally> Visitor for NearestSearch<'_, U, T> {
    #[inline]
    fn step(&mut self) {
        self.tally.step();
    }

    #[inline]
    fn visit(&mut self, slots: &[u32]) -> bool {
        for &slot in slots {
            if self.mailbox.admits(slot) {
                self.test(slot);
            }
        }
        false
    }

    #[inline]
    fn t_max(&self) -> f32 {
        self.t
    }
}

/// The search for any hit.
pub(super) struct AnySearch<'a, U: UserLeaves, T> {
    items: &'a Items,
    users: &'a U,
    ray: &'a Ray,
    shear: Shear,
    mailbox: Mailbox,
    pub found: bool,
    pub tally: T,
}

impl<'a, U: UserLeaves, T: Tally> AnySearch<'a, U, T> {
    /// For a valid ray.
    pub fn new(items: &'a Items, users: &'a U, ray: &'a Ray, tally: T) -> Self {
        Self { items, users, ray, shear: Shear::new(ray), mailbox: Mailbox([u32::MAX; 64]), found: false, tally }
    }

    #[inline]
    fn is_hit(&mut self, slot: u32) -> bool {
        let item = &self.items.list[slot as usize];
        self.tally.test();
        if item.is_user() {
            return self.users.occluded(item.index(), self.ray);
        }
        // The triangle test includes its end; the query excludes it.
        match self.shear.hit(&item.corners, self.ray.t_max) {
            Some(hit) if hit.t < self.ray.t_max => {
                !item.is_filtered() || self.users.accept(item.index(), hit, self.ray)
            }
            _ => false,
        }
    }
}

impl<U: UserLeaves, T: Tally> Visitor for AnySearch<'_, U, T> {
    #[inline]
    fn step(&mut self) {
        self.tally.step();
    }

    #[inline]
    fn visit(&mut self, slots: &[u32]) -> bool {
        for &slot in slots {
            if self.mailbox.admits(slot) && self.is_hit(slot) {
                self.found = true;
                return true;
            }
        }
        false
    }

    #[inline]
    fn t_max(&self) -> f32 {
        self.ray.t_max
    }
}
