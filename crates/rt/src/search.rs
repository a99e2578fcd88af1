//! The search of a ray for hits: the fixed function behind pipelines and ray queries.
//!
//! What must be asked about is handed out from near to far, one after the other; in between the caller may commit
//! hits, which ends the interval there. Three ways through the hierarchy do this:
//!
//! * *nearest*: the nearest of all that may count. Where it is an opaque triangle that is all.
//! * *all*: where the nearest had to be asked about and was refused, all other candidates up to the nearest opaque
//!   triangle, sorted.
//! * *any*: some opaque triangle, for rays whose first hit ends the search.
//!
//! So a ray goes at most twice through the hierarchy, and the order of candidates depends on their distance and index
//! alone. A procedural primitive has the distance at which the ray enters its box.

use crate::bottom_level::{BottomLevel, Content};
use crate::flags::{GeometryFlags, RayFlags};
use crate::plan::{Class, Plan};
use crate::ray::{Barycentrics, HitKind, PrimitiveId, RayDesc};
use crate::top_level::{Placed, TopLevel};
use std::cell::{Cell, RefCell};
use steradian_accel::{Hit, PrimId, UserHit, UserPrimitives};
use steradian_math::{Bounds3, Ray, Vec3};

/// What must be asked about.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Candidate {
    /// Of a triangle the distance of the hit, of a box at most that where it is entered.
    pub t: f32,
    pub id: PrimitiveId,
    /// Weights of a triangle; `None` for a box.
    pub triangle: Option<Barycentrics>,
    pub is_opaque: bool,
}

/// A hit that counts.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Committed {
    pub t: f32,
    pub id: PrimitiveId,
    /// What was reported of a procedural hit; `None` for a triangle, whose face is looked at where it is asked for.
    pub kind: Option<HitKind>,
    /// Of a triangle.
    pub barycentrics: Barycentrics,
}

/// How far a search is.
#[derive(Clone, Copy, Debug)]
enum State {
    Start,
    /// The nearest candidate has been handed out.
    Nearest(PrimitiveId),
    /// Candidates wait.
    All,
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
    /// Candidates, the nearest one last.
    waiting: Vec<Candidate>,
}

impl<'a> Search<'a> {
    /// A search that has not begun, for a valid ray with valid flags. `waiting` lends its memory.
    pub fn new(
        scene: Option<&'a TopLevel>,
        flags: RayFlags,
        mask: u8,
        ray: RayDesc,
        mut waiting: Vec<Candidate>,
    ) -> Self {
        waiting.clear();
        Self { scene, ray, flags, committed: None, mask, state: State::Start, waiting }
    }

    /// The memory that was lent.
    pub fn into_buffer(self) -> Vec<Candidate> {
        self.waiting
    }

    /// Where the interval ends now.
    pub fn t_current(&self) -> f32 {
        self.committed.map_or(self.ray.t_max, |hit| hit.t)
    }

    /// Ends the search.
    pub fn end(&mut self) {
        self.state = State::Done;
    }

    /// Whether the search is over.
    pub fn is_done(&self) -> bool {
        matches!(self.state, State::Done)
    }

    /// Commits a hit that is in the interval.
    pub fn commit(&mut self, hit: Committed) {
        self.committed = Some(hit);
        if self.flags.contains(RayFlags::ACCEPT_FIRST_HIT_AND_END_SEARCH) {
            self.end();
        }
    }

    /// Commits a candidate that is a triangle, as long as it is in the interval.
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
            State::Start => {
                let scene = self.scene?;
                if self.flags.contains(RayFlags::ACCEPT_FIRST_HIT_AND_END_SEARCH) {
                    return self.first(scene);
                }
                let candidate = self.nearest(scene);
                match candidate.filter(|c| c.triangle.is_none() || !c.is_opaque) {
                    Some(asked) => self.state = State::Nearest(asked.id),
                    None => self.state = State::Done,
                }
                let candidate = candidate?;
                if candidate.triangle.is_some() && candidate.is_opaque {
                    self.commit_triangle(&candidate);
                    return None;
                }
                Some(candidate)
            }
            State::Nearest(id) => self.rest(id),
            State::All => self.next_waiting(),
            State::Done => None,
        }
    }

    /// Where the first hit ends the search: an opaque triangle where there is one, else candidates.
    fn first(&mut self, scene: &'a TopLevel) -> Option<Candidate> {
        self.state = State::All;
        if let Some(candidate) = self.any(scene) {
            self.commit_triangle(&candidate);
            return None;
        }
        self.collect(scene, None);
        self.next_waiting()
    }

    /// After the nearest candidate has been asked about.
    fn rest(&mut self, nearest: PrimitiveId) -> Option<Candidate> {
        let is_hit_triangle = |hit: &Committed| hit.id == nearest && hit.kind.is_none();
        if self.committed.as_ref().is_some_and(is_hit_triangle) {
            // All others are farther.
            self.state = State::Done;
            return None;
        }
        self.state = State::All;
        self.collect(self.scene?, Some(nearest));
        self.next_waiting()
    }

    /// The nearest of the candidates that wait and are in the interval.
    fn next_waiting(&mut self) -> Option<Candidate> {
        let t = self.t_current();
        // Boxes may be entered where the interval ends, triangles not be hit there.
        let is_inside = |c: &Candidate| if c.triangle.is_some() { c.t < t } else { c.t <= t };
        while let Some(next) = self.waiting.pop() {
            if !is_inside(&next) {
                continue;
            }
            if next.triangle.is_none() || !next.is_opaque {
                return Some(next);
            }
            // All others are farther.
            self.commit_triangle(&next);
            break;
        }
        self.state = State::Done;
        None
    }

    /// What the ray does in an instance, and the ray in object space. Its end is that of the hierarchy's search.
    #[inline]
    fn enter(&self, scene: &'a TopLevel, index: u32, ray: &Ray) -> Option<Entered<'a>> {
        let placed: &'a Placed = scene.instances.get(index as usize)?;
        let is_triangles = matches!(placed.bottom_level.content, Content::Triangles(_));
        let plan = Plan::new(self.flags, self.mask, placed, is_triangles)?;
        let ray = Ray {
            origin: placed.place.inv.transform_point3(ray.origin),
            direction: placed.place.inv.transform_vector3(ray.direction),
            // For triangles the end of the interval does not belong to it.
            t_max: if is_triangles { ray.t_max.min(self.t_current()) } else { ray.t_max },
            ..*ray
        };
        Some(Entered { plan, ray, instance: index, bottom: &placed.bottom_level, t_min: self.ray.t_min })
    }

    /// The ray as the upper hierarchy takes it: up to the end of the interval, which belongs to it for boxes.
    fn world_ray(&self) -> Ray {
        self.ray.with_end(self.t_current().next_up().max(2.0 * f32::MIN_POSITIVE))
    }

    /// The nearest of all that may count.
    #[inline]
    fn nearest(&self, scene: &'a TopLevel) -> Option<Candidate> {
        let found = Cell::new(None);
        let instances = Instances(|index: u32, ray: &Ray| {
            let candidate = self.enter(scene, index, ray)?.nearest()?;
            found.set(Some(candidate));
            Some(candidate.t)
        });
        let ray = self.world_ray();
        if scene.instances.len() == 1 {
            // There is nothing to choose from.
            instances.0(0, &ray)?;
        } else {
            scene.bvh.intersect(&ray, &instances)?;
        }
        found.get()
    }

    /// Any opaque triangle.
    fn any(&self, scene: &'a TopLevel) -> Option<Candidate> {
        let found = Cell::new(None);
        let instances = Instances(|index: u32, ray: &Ray| {
            let candidate = self.enter(scene, index, ray)?.any()?;
            found.set(Some(candidate));
            Some(candidate.t)
        });
        let ray = self.world_ray();
        let is_found = match scene.instances.len() {
            1 => instances.0(0, &ray).is_some(),
            _ => scene.bvh.occluded(&ray, &instances),
        };
        if is_found { found.get() } else { None }
    }

    /// Collects all candidates but one up to the nearest opaque triangle, and it too.
    fn collect(&mut self, scene: &'a TopLevel, but: Option<PrimitiveId>) {
        let waiting = RefCell::new(std::mem::take(&mut self.waiting));
        let found = Cell::new(None);
        let instances = Instances(|index: u32, ray: &Ray| {
            let candidate = self.enter(scene, index, ray)?.collect(but, &waiting)?;
            found.set(Some(candidate));
            Some(candidate.t)
        });
        let is_found = scene.bvh.intersect(&self.world_ray(), &instances).is_some();
        let mut waiting = waiting.into_inner();
        waiting.extend(found.get().filter(|_| is_found));
        waiting.sort_unstable_by(|a, b| b.t.total_cmp(&a.t).then(b.id.cmp(&a.id)));
        self.waiting = waiting;
    }
}

/// Instances as primitives of the upper hierarchy: a function of their index and the ray in world space that gives the
/// distance where the search may end.
struct Instances<F>(F);

impl<F: Fn(u32, &Ray) -> Option<f32>> UserPrimitives for Instances<F> {
    #[inline]
    fn intersect(&self, id: PrimId, ray: &Ray) -> Option<UserHit> {
        (self.0)(id.prim, ray).map(|t| UserHit { t, u: 0.0, v: 0.0 })
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
}

impl Entered<'_> {
    fn id(&self, id: PrimId) -> PrimitiveId {
        PrimitiveId { instance: self.instance, geometry: id.geom, primitive: id.prim }
    }

    /// What is done with hits on a geometry.
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

    /// The class of a hit on a triangle, its face and its distance considered.
    fn class_of_hit(&self, hit: &Hit) -> Class {
        let is_culled = || {
            let corners = self.bottom.triangle(hit.id.geom, hit.id.prim);
            corners.is_none_or(|corners| self.plan.is_culled(&corners, self.ray.direction))
        };
        if hit.t <= self.t_min || self.plan.culls() && is_culled() {
            return Class::Skipped;
        }
        self.class(hit.id.geom)
    }

    /// Where the ray enters a box, at most; `None` where it does not or where hits on it do not count.
    fn entry(&self, id: PrimId, t_max: f32) -> Option<f32> {
        if self.class(id.geom) == Class::Skipped {
            return None;
        }
        let Content::Boxes(all) = &self.bottom.content else { return None };
        entry(all.get(id.geom as usize)?.boxes.get(id.prim as usize)?, &self.ray, self.t_min, t_max)
    }

    #[inline]
    fn nearest(&self) -> Option<Candidate> {
        let hit = match &self.bottom.content {
            Content::Triangles(_) if self.t_min == 0.0 && self.plan.skips_nothing() => {
                self.bottom.bvh.intersect(&self.ray, &())
            }
            Content::Triangles(_) => {
                self.bottom.bvh.intersect(&self.ray, &Filter(|hit: &Hit| self.class_of_hit(hit) != Class::Skipped))
            }
            Content::Boxes(_) => {
                self.bottom.bvh.intersect(&self.ray, &Boxes(|id: PrimId, ray: &Ray| self.entry(id, ray.t_max)))
            }
        };
        hit.map(|hit| self.candidate(&hit))
    }

    fn any(&self) -> Option<Candidate> {
        if !self.plan.has_opaque() || matches!(self.bottom.content, Content::Boxes(_)) {
            return None;
        }
        let found = Cell::new(None);
        let opaque = Filter(|hit: &Hit| {
            let counts = self.class_of_hit(hit) == Class::Opaque;
            if counts {
                found.set(Some(*hit));
            }
            counts
        });
        self.bottom.bvh.occluded(&self.ray, &opaque).then(|| found.get().map(|hit| self.candidate(&hit)))?
    }

    /// Collects what must be asked about, and gives the nearest opaque triangle.
    fn collect(&self, but: Option<PrimitiveId>, waiting: &RefCell<Vec<Candidate>>) -> Option<Candidate> {
        let push = |candidate: Candidate| {
            if Some(candidate.id) != but {
                waiting.borrow_mut().push(candidate);
            }
        };
        if matches!(self.bottom.content, Content::Boxes(_)) {
            let boxes = Boxes(|id: PrimId, ray: &Ray| {
                if let Some(t) = self.entry(id, ray.t_max) {
                    push(self.candidate(&Hit { t, u: 0.0, v: 0.0, id }));
                }
                None
            });
            self.bottom.bvh.intersect(&self.ray, &boxes);
            return None;
        }
        let triangles = Filter(|hit: &Hit| match self.class_of_hit(hit) {
            Class::Skipped => false,
            Class::Opaque => true,
            Class::NonOpaque => {
                push(self.candidate(hit));
                false
            }
        });
        self.bottom.bvh.intersect(&self.ray, &triangles).map(|hit| self.candidate(&hit))
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
