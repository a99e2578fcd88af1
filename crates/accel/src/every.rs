//! All hits of a ray.
#![expect(unsafe_code, reason = "unchecked reads; each place states why it is sound")]

use crate::layout::{Block, ChildRef};
use crate::leaves::UserLeaves;
use crate::nearest::Nearest;
use crate::ray_constants::RayConstants;
use crate::simd::{LANES, Simd};
use crate::slabs::Slabs;
use crate::stack::{Stack, Waiting};
use crate::tree::Tree;
use crate::triangle::Shear;
use crate::{Hit, UserHit};
use steradian_math::Ray;

/// Collects the hits of a traceable ray in `(0, ray.t_max)`, in any order.
#[inline(always)]
pub(crate) fn every<S: Simd, U: UserLeaves>(s: S, tree: &Tree, ray: &Ray, users: &U, hits: &mut Vec<Hit>) {
    let constants = RayConstants::new(ray, &tree.bounds);
    let slabs = Slabs::new(s, &constants);
    let shear = Shear::new(s, ray, &constants);
    let t_max = s.splat(ray.t_max);
    let mut stack = std::mem::MaybeUninit::uninit();
    let stack = Stack::emptied(&mut stack);
    let mut current = tree.root;
    loop {
        if current.is_node() {
            // SAFETY: the reference comes from the tree and is to a node.
            let node = unsafe { tree.arena.node(current) };
            let (_, mut lanes) = slabs.test(s, node, t_max);
            while lanes != 0 {
                // SAFETY: the stack is deep enough for the tree.
                unsafe { stack.push(node.children[lanes.trailing_zeros() as usize & (LANES - 1)]) };
                lanes &= lanes - 1;
            }
        } else if current.is_block() {
            // SAFETY: the reference comes from the tree and is to a block.
            let block = unsafe { tree.arena.block(current) };
            if let Some(candidates) = shear.test(s, block, t_max, true) {
                let mut lanes = candidates.lanes;
                while lanes != 0 {
                    let lane = lanes.trailing_zeros() as usize & (LANES - 1);
                    lanes &= lanes - 1;
                    let index = block.ids[lane] & !Block::FILTERED;
                    let (u, v) = (candidates.u[lane], candidates.v[lane]);
                    let hit = UserHit { t: candidates.t[lane], u, v };
                    if hit.t < ray.t_max && (block.ids[lane] == index || users.accept(index, hit, ray)) {
                        hits.push(users.hit(Nearest { hit, index, extra: users.triangle() }));
                    }
                }
            }
        } else if current != ChildRef::EMPTY {
            users.every(current.index() as u32, ray, hits);
        }
        match stack.pop() {
            Some(child) => current = child,
            None => return,
        }
    }
}
