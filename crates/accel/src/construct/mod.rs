//! Construction of hierarchies: a binary tree, then the cheapest eight-wide tree with the same splits.
//!
//! 1. `split` divides ranges of primitives by the surface area heuristic over bins. Triangles count by blocks of eight,
//!    since a query tests whole blocks.
//! 2. By choice, `spatial` also cuts triangles at planes, `ploc` builds from the leaves up, and `reinsert` moves
//!    subtrees of the finished tree.
//! 3. `binary` makes the binary tree eight-wide by dynamic programming.
//! 4. `emit` writes the wide nodes and the blocks of triangles.
//!
//! All builders give the same hits. Every step gives the same tree for any number of threads: work is cut at places
//! that depend on the input only. Areas of parts that are small beside the whole are taken in a scale of their own
//! (`binary::fitted`), so that they do not vanish in `f32`.

mod binary;
mod clip;
mod emit;
mod explicit;
#[cfg(target_arch = "x86_64")]
mod lanes;
mod nodes;
mod ploc;
mod primitives;
mod reinsert;
mod spatial;
mod split;

pub(crate) use primitives::Primitives;

use crate::tree::Tree;
use crate::{Builder, Error, Geometry};
use binary::BinaryNode;
use explicit::Explicit;
use nodes::{BinaryTree, Nodes};
use primitives::{PrimRef, Tag};
use rayon::prelude::*;
use steradian_math::Bounds3;

/// Greatest depth of a tree, in nodes on a way from the root to a leaf: below [`binary::SAH_DEPTH`] ranges are halved,
/// and they have less than 2^30 references.
pub(crate) const MAX_DEPTH: usize = binary::SAH_DEPTH as usize + 31;

/// Most rounds of the optimisation.
const ROUNDS: usize = 8;

/// Builds a tree.
pub(crate) fn build(geometries: &[Geometry], builder: Builder) -> Result<Tree, Error> {
    let primitives = Primitives::new(geometries)?;
    let refs = primitives.refs();
    let count = refs.len();
    let (refs, nodes) = binary_tree(&primitives, refs, builder);
    let tags: Vec<Tag> = refs.par_iter().map(PrimRef::tag).collect();
    // Their memory is half of what the tree takes, which is written next.
    drop(refs);
    Ok(Tree { primitives: count, ..emit::emit(&primitives, &tags, &nodes, builder)? })
}

/// Child of a wide node.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Part {
    /// Another node.
    Node(u32),
    /// A range of primitives.
    Leaf { first: u32, count: u32 },
}

/// A node of a wide tree.
pub(crate) type WideNode<const WIDTH: usize> = [Option<(Bounds3, Part)>; WIDTH];

/// The nodes of a tree of any width, the root first, and the indices of primitives in the order of its leaves.
pub(crate) fn wide<const WIDTH: usize>(
    geometries: &[Geometry],
    builder: Builder,
) -> Result<(Vec<WideNode<WIDTH>>, Vec<u32>), Error> {
    let primitives = Primitives::new(geometries)?;
    let (refs, binary) = binary_tree::<WIDTH>(&primitives, primitives.refs(), builder);
    let binary = binary.into_vec();
    let indices = refs.iter().map(PrimRef::index).collect();
    let leaf = |node: &BinaryNode<WIDTH>| (node.bounds, Part::Leaf { first: node.first, count: node.count });
    let mut nodes = vec![[None; WIDTH]];
    let mut pending = match binary.first() {
        None => return Ok((Vec::new(), indices)),
        Some(root) if root.is_leaf() => {
            nodes[0][0] = Some(leaf(root));
            Vec::new()
        }
        Some(_) => vec![(0, 0)],
    };
    // Open wide nodes from the root down by the choices of the dynamic programme.
    while let Some((from, index)) = pending.pop() {
        for (slot, child) in emit::children(|i| &binary[i], from).into_iter().flatten().enumerate() {
            let node = &binary[child];
            nodes[index][slot] = Some(if node.is_leaf() {
                leaf(node)
            } else {
                nodes.push([None; WIDTH]);
                pending.push((child, nodes.len() - 1));
                (node.bounds, Part::Node(nodes.len() as u32 - 1))
            });
        }
    }
    Ok((nodes, indices))
}

/// The binary tree, with the choices that make it wide.
fn binary_tree<const WIDTH: usize>(
    primitives: &Primitives,
    mut refs: Vec<PrimRef>,
    builder: Builder,
) -> (Vec<PrimRef>, BinaryTree<WIDTH>) {
    if refs.is_empty() {
        return (refs, Nodes::new().finish());
    }
    // Top-down builders yield ranges directly; the others pass through the explicit tree.
    let mut tree = match builder {
        Builder::Sah => {
            let nodes = binary::build(&mut refs);
            return (refs, nodes);
        }
        Builder::Reinsertion => {
            let nodes = binary::build::<WIDTH>(&mut refs);
            Explicit::of_ranges(refs, &nodes.into_vec())
        }
        Builder::Spatial => spatial::build(primitives, refs),
        Builder::Ploc => return ploc::build(refs).into_ranges(),
    };
    // Reinsert subtrees until the area hardly shrinks any more.
    reinsert::optimize(&mut tree, ROUNDS);
    tree.into_ranges()
}
