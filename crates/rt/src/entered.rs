//! An instance that a ray has entered: what it meets there, with flags and masks considered.

use crate::bottom_level::{BottomLevel, Content};
use crate::context::TraceRay;
use crate::flags::GeometryFlags;
use crate::plan::{Class, Plan};
use crate::queue::{Candidate, Queue};
use crate::ray::{Barycentrics, PrimitiveId, RayDesc};
use crate::top_level::{Placed, TopLevel};
use std::cell::{Cell, RefCell};
use steradian_accel::{Hit, PrimId, UserHit, UserPrimitives};
use steradian_math::{Bounds3, Ray, Vec3};

/// Instances as primitives of the upper hierarchy: a function of their index and the end of the interval that gives the
/// distance where the search may end.
pub(crate) struct Instances<F>(pub F);

impl<F: Fn(u32, f32) -> Option<f32>> UserPrimitives for Instances<F> {
    #[inline]
    fn intersect(&self, id: PrimId, ray: &Ray) -> Option<UserHit> {
        (self.0)(id.prim, ray.t_max).map(|t| UserHit { t, u: 0.0, v: 0.0 })
    }
}

/// A ray in the object space of an instance, with this end of its interval.
#[inline]
pub(crate) fn object_ray(placed: &Placed, ray: &RayDesc, t_max: f32) -> Ray {
    let (mut origin, mut direction) = (ray.origin, ray.direction);
    if !placed.is_in_place {
        origin = placed.place.inv.transform_point3(origin);
        direction = placed.place.inv.transform_vector3(direction);
    }
    Ray { t_max, ..Ray::new(origin, direction) }
}

/// An instance that a ray has entered.
pub(crate) struct Entered<'a> {
    plan: Plan,
    /// In object space.
    ray: Ray,
    instance: u32,
    bottom: &'a BottomLevel,
    t_min: f32,
    /// True if no hit in it needs a decision.
    pub is_certain: bool,
}

impl<'a> Entered<'a> {
    /// Enters an instance up to `end`, which belongs to the interval for boxes; for triangles the interval ends before
    /// `t_current` as well. `None` where the ray does not meet the instance at all.
    #[inline]
    pub fn new(scene: &'a TopLevel, call: &TraceRay, index: u32, end: f32, t_current: f32) -> Option<Self> {
        let placed: &'a Placed = scene.instances.get(index as usize)?;
        let bottom: &'a BottomLevel = &placed.bottom_level;
        let is_triangles = matches!(bottom.content, Content::Triangles(_));
        let plan = Plan::new(call.flags, call.mask as u8, placed, is_triangles)?;
        // For triangles the end of the interval does not belong to it.
        let ray = object_ray(placed, &call.ray, if is_triangles { end.min(t_current) } else { end });
        let is_certain = is_triangles && plan.is_certain(bottom.is_opaque);
        Some(Self { plan, ray, instance: index, bottom, t_min: call.ray.t_min, is_certain })
    }

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
    pub fn candidate(&self, hit: &Hit) -> Candidate {
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
    pub fn nearest(&self) -> Option<Hit> {
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
    pub fn any(&self) -> Option<Hit> {
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
    pub fn collect(&self, queue: &RefCell<Queue>) -> Option<f32> {
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
