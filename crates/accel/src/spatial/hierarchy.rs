//! Cost of queries on the hierarchy. The hierarchy itself counts nothing, to lose no time; this walk visits the same
//! nodes, one box after another.

use super::line::is_askable;
use super::scene::Total;
use super::search::{Steps, Tally};
use super::shear::Shear;
use crate::arena::Arena;
use crate::geometry::WORLD;
use crate::layout::{Block, ChildRef, Node};
use crate::ray_constants::RayConstants;
use crate::simd::LANES;
use crate::tree::Tree;
use crate::{Hit, PrimId, TopLevel, UserHit, UserPrimitives};
use steradian_math::{Ray, Vec3};

/// Kind of query: for the nearest hit, or for any.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Query {
    Nearest,
    Any,
}

/// Cost of a query.
pub(super) fn cost<U: UserPrimitives>(top: &TopLevel, query: Query, ray: &Ray, user: &U) -> Steps {
    if !is_askable(ray) {
        return Steps::default();
    }
    // Behind an instance the walk goes on in the object's tree; its cost is added.
    let world = |index: u32, ray: &Ray| match top.enter(index, ray) {
        Some((instance, object, ray)) => {
            let objects =
                |index: u32, ray: &Ray| (ask(user, query, object.tree().id(instance, index), ray), Steps::default());
            walk(object.tree(), query, &ray, user, instance, objects)
        }
        None => (ask(user, query, top.tree().id(WORLD, index), ray), Steps::default()),
    };
    walk(top.tree(), query, ray, user, WORLD, world).1
}

/// A user primitive.
fn ask<U: UserPrimitives>(user: &U, query: Query, id: PrimId, ray: &Ray) -> Option<f32> {
    match query {
        Query::Nearest => user.intersect(id, ray).map(|hit| hit.t).filter(|t| *t > 0.0 && *t < ray.t_max),
        Query::Any => user.occluded(id, ray).then_some(0.0),
    }
}

/// Entry distance of a ray into the box of a slot, if before `t`, as [`crate::slabs::Slabs`] finds it.
fn entered(constants: &RayConstants, node: &Node, lane: usize, t: f32) -> Option<f32> {
    // The slab test of one box.
    let (mut enter, mut leave) = (0.0_f32, t);
    for axis in 0..3 {
        // The sign of the reciprocal selects the near plane.
        let inverse = constants.inverse[axis];
        let rows = if inverse.is_sign_negative() { [axis + 3, axis] } else { [axis, axis + 3] };
        let [near, far] = rows.map(|row| node.rows[row].0[lane] * inverse);
        (enter, leave) = (enter.max(near + constants.offset[0][axis]), leave.min(far + constants.offset[1][axis]));
    }
    (enter <= leave).then_some(enter)
}

/// Through one tree: the distance of the hit, and the cost.
fn walk<U: UserPrimitives>(
    tree: &Tree,
    query: Query,
    ray: &Ray,
    user: &U,
    instance: u32,
    below: impl Fn(u32, &Ray) -> (Option<f32>, Steps),
) -> (Option<f32>, Steps) {
    let (shear, constants) = (Shear::new(ray), RayConstants::new(ray, &tree.bounds));
    let mut steps = Steps::default();
    let (mut t, mut found) = (ray.t_max, None);
    let mut stack = vec![(tree.root, 0.0)];
    // Depth-first with a stack; entries that begin behind the hit are skipped.
    while let Some((child, entry)) = stack.pop() {
        if entry > t || child == ChildRef::EMPTY {
            continue;
        }
        steps.step();
        if child.is_node() {
            let node = &tree.arena.nodes()[Arena::node_index(child)];
            let entry = |lane: usize| entered(&constants, node, lane, t);
            let first = stack.len();
            stack.extend((0..LANES).filter_map(|lane| Some((node.children[lane], entry(lane)?))));
            // Push the children so that the nearest is on top; any order serves an occlusion query.
            match query {
                Query::Nearest => stack[first..].sort_by(|a, b| b.1.total_cmp(&a.1)),
                Query::Any => stack[first..].reverse(),
            }
        } else if child.is_block() {
            let block = &tree.arena.blocks()[tree.arena.block_index(child)];
            for (lane, &tagged) in block.ids.iter().enumerate() {
                let row = |i: usize| block.rows[i].0[lane];
                // Test the triangles of the block one by one, lanes without a triangle are NaN.
                if row(0).is_nan() {
                    continue;
                }
                steps.test();
                let corners = [0, 3, 6].map(|first| Vec3::new(row(first), row(first + 1), row(first + 2)));
                let Some(UserHit { t: at, u, v }) = shear.hit(&corners, t).filter(|hit| hit.t < t) else { continue };
                let index = tagged & !Block::FILTERED;
                let hit = Hit { t: at, u, v, id: tree.id(instance, index) };
                if tagged == index || user.accept(&hit, ray) {
                    (t, found) = (at, Some(at));
                }
            }
        } else {
            steps.test();
            // User primitives and instances see an interval that ends at the hit so far.
            let (hit, more) = below(child.index() as u32, &Ray { t_max: t, ..*ray });
            steps = steps.plus(more);
            if let Some(at) = hit {
                (t, found) = (at, Some(at));
            }
        }
        if found.is_some() && query == Query::Any {
            break;
        }
    }
    (found, steps)
}
