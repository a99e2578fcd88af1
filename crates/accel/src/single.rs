//! Queries of single rays, compiled for each instruction set.
#![expect(unsafe_code, reason = "unchecked reads; each place states why it is sound")]

use crate::Hit;
use crate::dispatch::queries;
use crate::every::every;
use crate::layout::ChildRef;
use crate::nearest::{Nearest, Start};
use crate::ray_constants::{RayConstants, is_traceable};
use crate::search::{any, nearest};
use crate::tree::Tree;
use steradian_math::Ray;

queries! {
    /// The nearest hit in `(0, ray.t_max)` on a tree; `None` for a ray that is not traceable.
    fn nearest_hit<U: UserLeaves>(tree: &Tree, ray: &Ray, users: &U) -> Option<Nearest<U::Extra>> = |isa, s, l| {
        if !is_traceable(ray) {
            return None;
        }
        nearest(s, tree, ray, users, &RayConstants::new(ray, &tree.bounds), Start { child: tree.root, t: ray.t_max, best: None })
    };
    /// The nearest hit of a traceable ray in `(0, ray.t_max)` on a tree, from a start on.
    fn nearest_hit_from<U: UserLeaves>(
        tree: &Tree, ray: &Ray, users: &U, constants: &RayConstants, start: Start<U::Extra>,
    ) -> Option<Nearest<U::Extra>> = |isa, s, l| nearest(s, tree, ray, users, constants, start);
    /// True if a tree is hit in `(0, ray.t_max)`; `false` for a ray that is not traceable.
    fn any_hit<U: UserLeaves>(tree: &Tree, ray: &Ray, users: &U) -> bool = |isa, s, l| {
        is_traceable(ray) && any(s, tree, ray, users, &RayConstants::new(ray, &tree.bounds), tree.root)
    };
    /// True if a tree is hit by a traceable ray in `(0, ray.t_max)` below a child.
    fn any_hit_from<U: UserLeaves>(tree: &Tree, ray: &Ray, users: &U, constants: &RayConstants, start: ChildRef) -> bool =
        |isa, s, l| any(s, tree, ray, users, constants, start);
    /// Collects all hits in `(0, ray.t_max)` on a tree, in any order.
    fn all_hits<U: UserLeaves>(tree: &Tree, ray: &Ray, users: &U, hits: &mut Vec<Hit>) = |isa, s, l| {
        if is_traceable(ray) {
            every(s, tree, ray, users, hits);
        }
    };
}
