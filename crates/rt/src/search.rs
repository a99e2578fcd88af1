//! The search of a ray for hits: the fixed function behind pipelines and ray queries.
//!
//! What must be asked about is handed out from near to far, one after the other; in between the caller may commit
//! hits, which ends the interval there. The order depends on distance and index alone; a procedural primitive has the
//! distance at which the ray enters its box.
//!
//! * Where there is nothing to ask, the nearest triangle, or any where the first hit ends the search, is all.
//! * Else the ray goes through the hierarchy for the nearest few candidates, up to the nearest opaque triangle, and
//!   again for the next few as long as all are refused.

use crate::bottom_level::{BottomLevel, Content};
use crate::flags::{GeometryFlags, RayFlags};
use crate::plan::{Class, Plan};
use crate::queue::{Candidate, Queue};
use crate::ray::{Barycentrics, HitKind, PrimitiveId, RayDesc};
use crate::top_level::{Placed, TopLevel};
use std::cell::{Cell, RefCell};
use steradian_accel::{Hit, PrimId, UserHit, UserPrimitives};
use steradian_math::{Bounds3, Ray, Vec3};

/// A hit that counts.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Committed {
    pub t: f32,
    pub id: PrimitiveId,
    /// Reported kind of a procedural hit; `None` for a triangle, whose face is found when it is asked for.
    pub kind: Option<HitKind>,
    /// Position in a triangle.
    pub barycentrics: Barycentrics,
}

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
    pub scene: Option<&'a TopLevel>,
    pub ray: RayDesc,
    pub flags: RayFlags,
    pub committed: Option<Committed>,
    mask: u8,
    state: State,
    queue: Queue,
}

impl<'a> Search<'a> {
    /// A search that has not begun, for a valid ray with valid flags. `waiting` lends its memory.
    #[inline]
    pub fn new(
        scene: Option<&'a TopLevel>,
        flags: RayFlags,
        mask: u8,
        ray: RayDesc,
        mut waiting: Vec<Candidate>,
    ) -> Self {
        waiting.clear();
        let queue = Queue { waiting, ..Queue::default() };
        Self { scene, ray, flags, committed: None, mask, state: State::Start, queue }
    }

    /// The memory that was lent.
    #[inline]
    pub fn into_buffer(self) -> Vec<Candidate> {
        self.queue.waiting
    }

    /// Current end of the interval.
    #[inline]
    pub fn t_current(&self) -> f32 {
        self.committed.map_or(self.ray.t_max, |hit| hit.t)
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
        if self.flags.contains(RayFlags::ACCEPT_FIRST_HIT_AND_END_SEARCH) {
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
        let scene = self.scene?;
        self.state = State::Done;
        if scene.instances.len() != 1 {
            return self.begin_among(scene);
        }
        // There is nothing to choose from.
        let entered = self.enter(scene, 0, self.closed_end())?;
        if !entered.is_certain {
            return self.begin_among(scene);
        }
        let is_any = self.flags.contains(RayFlags::ACCEPT_FIRST_HIT_AND_END_SEARCH);
        if let Some(hit) = if is_any { entered.any() } else { entered.nearest() } {
            let barycentrics = Barycentrics { u: hit.u, v: hit.v };
            self.committed = Some(Committed { t: hit.t, id: entered.id(hit.id), kind: None, barycentrics });
        }
        None
    }

    /// Begins a search among several instances, or one with candidates that need a decision.
    #[inline(never)]
    fn begin_among(&mut self, scene: &'a TopLevel) -> Option<Candidate> {
        if self.flags.contains(RayFlags::ACCEPT_FIRST_HIT_AND_END_SEARCH) {
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
                match self.scene {
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

    /// Enters an instance: the plan of hits, and the ray in object space, up to `end`, which belongs to it for boxes.
    #[inline]
    fn enter(&self, scene: &'a TopLevel, index: u32, end: f32) -> Option<Entered<'a>> {
        let placed: &'a Placed = scene.instances.get(index as usize)?;
        let bottom: &'a BottomLevel = &placed.bottom_level;
        let is_triangles = matches!(bottom.content, Content::Triangles(_));
        let plan = Plan::new(self.flags, self.mask, placed, is_triangles)?;
        let (mut origin, mut direction) = (self.ray.origin, self.ray.direction);
        if !placed.is_in_place {
            origin = placed.place.inv.transform_point3(origin);
            direction = placed.place.inv.transform_vector3(direction);
        }
        // For triangles the end of the interval does not belong to it.
        let t_max = if is_triangles { end.min(self.t_current()) } else { end };
        let ray = Ray { t_max, ..Ray::new(origin, direction) };
        let is_certain = is_triangles && plan.is_certain(bottom.is_opaque);
        Some(Entered { plan, ray, instance: index, bottom, t_min: self.ray.t_min, is_certain })
    }

    /// The end of the interval, which belongs to it for boxes.
    #[inline]
    fn closed_end(&self) -> f32 {
        self.t_current().next_up().max(2.0 * f32::MIN_POSITIVE)
    }

    /// Asks instances where the ray goes, for the nearest of what is found or for any.
    fn among(&self, scene: &TopLevel, is_any: bool, find: impl Fn(u32, f32) -> Option<f32>) {
        let instances = Instances(find);
        let ray = self.ray.with_end(self.closed_end());
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

/// Instances as primitives of the upper hierarchy: a function of their index and the end of the interval that gives the
/// distance where the search may end.
struct Instances<F>(F);

impl<F: Fn(u32, f32) -> Option<f32>> UserPrimitives for Instances<F> {
    #[inline]
    fn intersect(&self, id: PrimId, ray: &Ray) -> Option<UserHit> {
        (self.0)(id.prim, ray.t_max).map(|t| UserHit { t, u: 0.0, v: 0.0 })
    }
}

/// An instance that a ray has entered.
struct Entered<'a> {
    plan: Plan,
    /// In object space.
    ray: Ray,
    instance: u32,
    bottom: &'a BottomLevel,
    t_min: f32,
    /// True if no hit in it needs a decision.
    is_certain: bool,
}

impl Entered<'_> {
    #[inline]
    fn id(&self, id: PrimId) -> PrimitiveId {
        PrimitiveId { instance: self.instance, geometry: id.geom, primitive: id.prim }
    }

    /// Treatment of hits on a geometry.
    fn class(&self, geometry: u32) -> Class {
        let flags = match &self.bottom.content {
            Content::Triangles(all) => all.get(geometry as usize).map(|g| g.flags),
            Content::Boxes(all) => all.get(geometry as usize).map(|g| g.flags),
        };
        flags.map_or(Class::Skipped, |flags: GeometryFlags| self.plan.class(flags))
    }

    /// A hit on a triangle, or on a box by the distance where it is entered.
    fn candidate(&self, hit: &Hit) -> Candidate {
        let is_triangle = matches!(self.bottom.content, Content::Triangles(_));
        Candidate {
            t: hit.t,
            id: self.id(hit.id),
            triangle: is_triangle.then_some(Barycentrics { u: hit.u, v: hit.v }),
            is_opaque: self.class(hit.id.geom) == Class::Opaque,
        }
    }

    /// True if a hit on a triangle does not count for its distance or its face.
    #[inline]
    fn is_culled(&self, hit: &Hit) -> bool {
        let faces_away = || {
            let corners = self.bottom.triangle(hit.id.geom, hit.id.prim);
            corners.is_none_or(|corners| self.plan.is_culled(&corners, self.ray.direction))
        };
        hit.t <= self.t_min || self.plan.culls() && faces_away()
    }

    /// The class of a hit on a triangle, its face and its distance considered.
    fn class_of_hit(&self, hit: &Hit) -> Class {
        if self.is_culled(hit) { Class::Skipped } else { self.class(hit.id.geom) }
    }

    /// Lower bound of the ray parameter at entry into a box; `None` where the ray misses it or where hits on it do not
    /// count.
    fn entry(&self, id: PrimId, t_max: f32) -> Option<f32> {
        if self.class(id.geom) == Class::Skipped {
            return None;
        }
        let Content::Boxes(all) = &self.bottom.content else { return None };
        entry(all.get(id.geom as usize)?.boxes.get(id.prim as usize)?, &self.ray, self.t_min, t_max)
    }

    /// The nearest hit where all are certain.
    #[inline]
    fn nearest(&self) -> Option<Hit> {
        if self.t_min == 0.0 && !self.plan.culls() {
            self.bottom.bvh.intersect(&self.ray, &())
        } else {
            self.nearest_not_culled()
        }
    }

    #[inline(never)]
    fn nearest_not_culled(&self) -> Option<Hit> {
        self.bottom.bvh.intersect(&self.ray, &Filter(|hit: &Hit| !self.is_culled(hit)))
    }

    /// Any opaque triangle.
    #[inline(never)]
    fn any(&self) -> Option<Hit> {
        if !self.plan.has_opaque() || matches!(self.bottom.content, Content::Boxes(_)) {
            return None;
        }
        let found = Cell::new(None);
        let is_found = if self.is_certain && self.t_min == 0.0 && !self.plan.culls() {
            self.bottom.bvh.occluded(&self.ray, &Filter(|hit: &Hit| found.replace(Some(*hit)).is_none()))
        } else {
            let opaque = |hit: &Hit| {
                let counts = self.class_of_hit(hit) == Class::Opaque;
                if counts {
                    found.set(Some(*hit));
                }
                counts
            };
            self.bottom.bvh.occluded(&self.ray, &Filter(opaque))
        };
        found.get().filter(|_| is_found)
    }

    /// Collects what must be asked about and what is certain, and gives where the search may end.
    fn collect(&self, queue: &RefCell<Queue>) -> Option<f32> {
        let offer = |hit: &Hit| queue.borrow_mut().offer(self.candidate(hit));
        if self.is_certain {
            return self.nearest().filter(offer).map(|hit| hit.t);
        }
        let hit = match &self.bottom.content {
            Content::Triangles(_) => {
                let triangles = Filter(|hit: &Hit| self.class_of_hit(hit) != Class::Skipped && offer(hit));
                self.bottom.bvh.intersect(&self.ray, &triangles)
            }
            Content::Boxes(_) => {
                let boxes = Boxes(|id: PrimId, ray: &Ray| {
                    self.entry(id, ray.t_max).filter(|&t| offer(&Hit { t, u: 0.0, v: 0.0, id }))
                });
                self.bottom.bvh.intersect(&self.ray, &boxes)
            }
        };
        hit.map(|hit| hit.t)
    }
}

/// Which hits on triangles count.
struct Filter<F>(F);

impl<F: Fn(&Hit) -> bool> UserPrimitives for Filter<F> {
    fn intersect(&self, _: PrimId, _: &Ray) -> Option<UserHit> {
        None
    }

    #[inline]
    fn accept(&self, hit: &Hit, _: &Ray) -> bool {
        (self.0)(hit)
    }
}

/// Boxes as primitives: a function that gives the distance where one is entered.
struct Boxes<F>(F);

impl<F: Fn(PrimId, &Ray) -> Option<f32>> UserPrimitives for Boxes<F> {
    fn intersect(&self, id: PrimId, ray: &Ray) -> Option<UserHit> {
        (self.0)(id, ray).map(|t| UserHit { t, u: 0.0, v: 0.0 })
    }
}

/// The distance where a ray enters a box, or less by rounding, but positive; `None` where it misses it in the interval,
/// for certain.
fn entry(b: &Bounds3, ray: &Ray, t_min: f32, t_max: f32) -> Option<f32> {
    /// More than what rounds in a difference, a reciprocal and a product.
    const SLACK: f32 = 4.0 * f32::EPSILON;
    let inverse = ray.direction.recip();
    let (a, b) = ((b.min - ray.origin) * inverse, (b.max - ray.origin) * inverse);
    // What is not a number, where the ray goes along a side of the box, bounds nothing.
    let bounds = |v: Vec3, none: f32| Vec3::select(v.is_nan_mask() | !v.is_finite_mask(), Vec3::splat(none), v);
    let near = bounds(a, f32::NEG_INFINITY).min(bounds(b, f32::NEG_INFINITY));
    let far = bounds(a, f32::INFINITY).max(bounds(b, f32::INFINITY));
    let (near, far) = (near - near.abs() * SLACK, far + far.abs() * SLACK);
    let enter = near.max_element().max(t_min).max(f32::MIN_POSITIVE);
    (enter <= t_max && far.min_element() >= t_min).then_some(enter)
}
