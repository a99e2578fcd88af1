//! The search of a ray that meets nothing but opaque triangles: no shader is asked, and the hierarchy finds the hit.

use crate::committed::Committed;
use crate::context::TraceRay;
use crate::entered::{Entered, Instances, object_ray};
use crate::flags::RayFlags;
use crate::ray::{Barycentrics, PrimitiveId};
use crate::top_level::TopLevel;
use std::cell::Cell;
use steradian_accel::Hit;

/// True if there is nothing but opaque triangles for a ray with these flags.
#[inline]
pub(crate) fn is_certain(scene: &TopLevel, flags: RayFlags) -> bool {
    let is_changed = flags.intersects(RayFlags::FORCE_NON_OPAQUE | RayFlags::CULL_OPAQUE);
    scene.only_triangles && (flags.contains(RayFlags::FORCE_OPAQUE) || scene.only_opaque && !is_changed)
}

/// The nearest hit, or any where the first ends the search.
#[inline(always)]
pub(crate) fn certain_hit(scene: &TopLevel, call: &TraceRay) -> Option<Committed> {
    let end = call.ray.t_max;
    if scene.instances.len() == 1 { hit_in(scene, call, 0, end) } else { hit_among(scene, call) }
}

/// The hit among several instances.
#[inline(never)]
fn hit_among(scene: &TopLevel, call: &TraceRay) -> Option<Committed> {
    let found = Cell::new(None);
    // The hierarchy asks for hits that are nearer than the one before, or as near in an instance with a smaller index:
    // the last one is the hit.
    let instances = Instances(|index, end| {
        let hit = hit_in(scene, call, index, end)?;
        found.set(Some(hit));
        Some(hit.t)
    });
    let ray = call.ray.with_end(call.ray.t_max);
    if call.flags.contains(RayFlags::ACCEPT_FIRST_HIT_AND_END_SEARCH) {
        scene.bvh.occluded(&ray, &instances);
    } else {
        scene.bvh.intersect(&ray, &instances);
    }
    found.get()
}

/// The hit in an instance, before `end`.
#[inline(always)]
fn hit_in(scene: &TopLevel, call: &TraceRay, index: u32, end: f32) -> Option<Committed> {
    /// Rays with any of these are not for the hierarchy alone.
    const SPECIAL: RayFlags = RayFlags::ACCEPT_FIRST_HIT_AND_END_SEARCH
        .union(RayFlags::CULL_BACK_FACING_TRIANGLES)
        .union(RayFlags::CULL_FRONT_FACING_TRIANGLES)
        .union(RayFlags::SKIP_TRIANGLES);
    let placed = scene.instances.get(index as usize)?;
    let hit = if call.ray.t_min == 0.0 && !call.flags.intersects(SPECIAL) {
        if u32::from(placed.mask) & call.mask == 0 {
            return None;
        }
        placed.bottom_level.bvh.intersect(&object_ray(placed, &call.ray, end), &())?
    } else {
        special_hit_in(scene, call, index, end)?
    };
    let id = PrimitiveId { instance: index, geometry: hit.id.geom, primitive: hit.id.prim };
    Some(Committed { t: hit.t, id, kind: None, barycentrics: Barycentrics { u: hit.u, v: hit.v } })
}

/// [`hit_in`] for a ray that culls, skips, begins behind its origin or ends at the first hit.
#[inline(never)]
fn special_hit_in(scene: &TopLevel, call: &TraceRay, index: u32, end: f32) -> Option<Hit> {
    let entered = Entered::new(scene, call, index, end, end)?;
    if call.flags.contains(RayFlags::ACCEPT_FIRST_HIT_AND_END_SEARCH) { entered.any() } else { entered.nearest() }
}
