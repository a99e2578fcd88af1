//! Geometry that moves while it stays the same in number: boxes and triangles are set anew, and the shape of the tree
//! is kept.

use crate::arena::Arena;
use crate::construct::{self, Primitives};
use crate::layout::{Block, ChildRef, Node};
use crate::simd::LANES;
use crate::tree::Tree;
use crate::{Error, Geometry};
use rayon::prelude::*;
use steradian_math::Bounds3;

/// Follows geometry that has moved: the shape of the tree is kept (`true`) when the same primitives can be hit as
/// before, else it is built anew.
pub(crate) fn update(tree: &mut Tree, geometries: &[Geometry]) -> Result<bool, Error> {
    let kept = refit(tree, &Primitives::new(geometries)?);
    if !kept {
        *tree = construct::build(geometries, tree.builder)?;
    }
    Ok(kept)
}

/// Sets the blocks and boxes of a tree by the present places of its primitives. `false`, and nothing changed, when
/// there are other primitives than those that the tree was built from, or one of them cannot be hit any more or could
/// not before.
fn refit(tree: &mut Tree, primitives: &Primitives) -> bool {
    if tree.first != primitives.first || primitives.count() != tree.primitives {
        return false;
    }
    // Keep the topology only if everything in the leaves can still be hit.
    let held = |index: u32| primitives.bounds(index).is_some();
    let is_in_place = |block: &Block| {
        let lanes = block.lanes();
        (0..LANES).all(|lane| lanes >> lane & 1 == 0 || held(block.ids[lane] & !Block::FILTERED))
    };
    let users_held = tree
        .arena
        .nodes()
        .iter()
        .flat_map(|node| &node.children)
        .all(|child| !child.is_user() || held(child.index() as u32));
    if !users_held || !tree.arena.blocks().par_iter().all(is_in_place) {
        return false;
    }
    // Write the present vertices into the blocks, in parallel.
    tree.arena.parts_mut().1.par_iter_mut().for_each(|block| {
        let lanes = block.lanes();
        for lane in (0..LANES).filter(|lane| lanes >> lane & 1 == 1) {
            let index = block.ids[lane] & !Block::FILTERED;
            if let Some((corners, id)) = primitives.triangle(index) {
                block.set(lane, corners, id);
            }
        }
    });
    // Children come after their parents.
    let arena = &tree.arena;
    let mut bounds = vec![Bounds3::EMPTY; arena.nodes().len()];
    let of_child = |child: ChildRef, bounds: &[Bounds3]| {
        if child.is_node() {
            bounds[Arena::node_index(child)]
        } else if child.is_block() {
            arena.blocks()[arena.block_index(child)].bounds()
        } else if child.is_user() {
            primitives.bounds(child.index() as u32).unwrap_or(Bounds3::EMPTY)
        } else {
            Bounds3::EMPTY
        }
    };
    // Rebuild the boxes from the last node to the first, each from its children.
    let mut nodes = vec![Node::EMPTY; bounds.len()];
    for i in (0..nodes.len()).rev() {
        let children = arena.nodes()[i].children;
        for (lane, child) in children.into_iter().enumerate().filter(|(_, child)| *child != ChildRef::EMPTY) {
            let b = of_child(child, &bounds);
            nodes[i].set(lane, &b, child);
            bounds[i] = bounds[i].union(b);
        }
    }
    tree.bounds = of_child(tree.root, &bounds);
    tree.arena.parts_mut().0.copy_from_slice(&nodes);
    true
}
