//! The search of a ray for hits: the fixed function behind pipelines and ray queries.
//!
//! What must be asked about is handed out from near to far, one after the other; in between the caller may commit
//! hits, which ends the interval there. The order depends on distance and index alone; a procedural primitive has the
//! distance at which the ray enters its box.
//!
//! * Where there is nothing to ask, the nearest triangle, or any where the first hit ends the search, is all.
//! * Else the ray goes through the hierarchy for the nearest few candidates, up to the nearest opaque triangle, and
//!   again for the next few as long as all are refused.

use crate::certain::{certain_hit, is_certain};
use crate::committed::Committed;
use crate::context::TraceRay;
use crate::entered::{Entered, Instances};
use crate::flags::RayFlags;
use crate::queue::{Candidate, Queue};
use crate::top_level::TopLevel;
use std::cell::{Cell, RefCell};

/// State of a search.
#[derive(Clone, Copy, Debug)]
enum State {
    Start,
    /// Candidates wait.
    Waiting,
    Done,
}

/// A search on its way.
#[derive(Debug)]
pub(crate) struct Search<'a> {
    pub call: TraceRay<'a>,
    pub committed: Option<Committed>,
    state: State,
    queue: Queue,
}

impl<'a> Search<'a> {
    /// A search that has not begun, for a valid ray with valid flags. `waiting` lends its memory.
    #[inline]
    pub fn new(call: TraceRay<'a>, mut waiting: Vec<Candidate>) -> Self {
        waiting.clear();
        let queue = Queue { waiting, ..Queue::default() };
        Self { call, committed: None, state: State::Start, queue }
    }

    /// The memory that was lent.
    #[inline]
    pub fn into_buffer(self) -> Vec<Candidate> {
        self.queue.waiting
    }

    /// Current end of the interval.
    #[inline]
    pub fn t_current(&self) -> f32 {
        self.committed.map_or(self.call.ray.t_max, |hit| hit.t)
    }

    /// Ends the search.
    #[inline]
    pub fn end(&mut self) {
        self.state = State::Done;
    }

    /// True if the search is over.
    #[inline]
    pub fn is_done(&self) -> bool {
        matches!(self.state, State::Done)
    }

    /// Commits a hit that is in the interval.
    #[inline]
    pub fn commit(&mut self, hit: Committed) {
        self.committed = Some(hit);
        if self.call.flags.contains(RayFlags::ACCEPT_FIRST_HIT_AND_END_SEARCH) {
            self.end();
        }
    }

    /// Commits a candidate that is a triangle, as long as it is in the interval.
    #[inline]
    pub fn commit_triangle(&mut self, candidate: &Candidate) {
        if let Some(barycentrics) = candidate.triangle
            && candidate.t < self.t_current()
        {
            self.commit(Committed { t: candidate.t, id: candidate.id, kind: None, barycentrics });
        }
    }

    /// Goes on to what must be asked about next; `None` when the search is over.
    #[inline]
    pub fn proceed(&mut self) -> Option<Candidate> {
        match self.state {
            State::Start => self.begin(),
            State::Waiting => self.next_waiting(),
            State::Done => None,
        }
    }

    #[inline]
    fn begin(&mut self) -> Option<Candidate> {
        let scene = self.call.scene?;
        self.state = State::Done;
        if is_certain(scene, self.call.flags) {
            self.committed = certain_hit(scene, &self.call);
            return None;
        }
        self.begin_among(scene)
    }

    /// Begins a search among several instances, or one with candidates that need a decision.
    #[inline(never)]
    fn begin_among(&mut self, scene: &'a TopLevel) -> Option<Candidate> {
        if self.call.flags.contains(RayFlags::ACCEPT_FIRST_HIT_AND_END_SEARCH) {
            let (found, is_all) = self.any(scene);
            if let Some(candidate) = found {
                self.commit_triangle(&candidate);
                return None;
            }
            if is_all {
                return None;
            }
        }
        self.state = State::Waiting;
        self.collect(scene);
        self.next_waiting()
    }

    /// The nearest of the candidates that wait and are in the interval.
    #[inline(never)]
    fn next_waiting(&mut self) -> Option<Candidate> {
        let t = self.t_current();
        // Boxes may be entered where the interval ends, triangles not be hit there.
        let is_inside = |c: &Candidate| if c.triangle.is_some() { c.t < t } else { c.t <= t.max(f32::MIN_POSITIVE) };
        loop {
            let Some(next) = self.queue.waiting.pop() else {
                match self.call.scene {
                    Some(scene) if self.queue.has_more => self.collect(scene),
                    _ => break,
                }
                continue;
            };
            self.queue.after = Some(next);
            if !is_inside(&next) {
                continue;
            }
            if !next.is_certain() {
                return Some(next);
            }
            // All others are farther.
            self.commit_triangle(&next);
            break;
        }
        self.state = State::Done;
        None
    }

    /// Enters an instance, up to `end`, which belongs to the interval for boxes.
    fn enter(&self, scene: &'a TopLevel, index: u32, end: f32) -> Option<Entered<'a>> {
        Entered::new(scene, &self.call, index, end, self.t_current())
    }

    /// The end of the interval, which belongs to it for boxes.
    #[inline]
    fn closed_end(&self) -> f32 {
        self.t_current().next_up().max(2.0 * f32::MIN_POSITIVE)
    }

    /// Asks instances where the ray goes, for the nearest of what is found or for any.
    fn among(&self, scene: &TopLevel, is_any: bool, find: impl Fn(u32, f32) -> Option<f32>) {
        let instances = Instances(find);
        let ray = self.call.ray.with_end(self.closed_end());
        match (scene.instances.len(), is_any) {
            (1, _) => {
                (instances.0)(0, ray.t_max);
            }
            (_, true) => {
                scene.bvh.occluded(&ray, &instances);
            }
            (_, false) => {
                scene.bvh.intersect(&ray, &instances);
            }
        }
    }

    /// Any opaque triangle, and whether there is nothing else in the instances that were asked.
    fn any(&self, scene: &'a TopLevel) -> (Option<Candidate>, bool) {
        let (found, is_all) = (Cell::new(None), Cell::new(true));
        self.among(scene, true, |index, end| {
            let entered = self.enter(scene, index, end)?;
            is_all.set(is_all.get() && entered.is_certain);
            let candidate = entered.candidate(&entered.any()?);
            found.set(Some(candidate));
            Some(candidate.t)
        });
        (found.get(), is_all.get())
    }

    /// Collects the candidates that are next.
    fn collect(&mut self, scene: &'a TopLevel) {
        let mut queue = std::mem::take(&mut self.queue);
        queue.has_more = false;
        let queue = RefCell::new(queue);
        self.among(scene, false, |index, end| self.enter(scene, index, end)?.collect(&queue));
        self.queue = queue.into_inner();
    }
}
