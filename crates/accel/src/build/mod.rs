//! Building: a binary tree by the surface area heuristic, then the cheapest eight-wide tree with the same splits.
//!
//! Every step gives the same result for any number of threads: work is cut at places that depend on the input only.

mod binary;
mod emit;
mod primitives;
mod split;

pub(crate) use primitives::Primitives;

use crate::bvh::Tree;
use crate::{Error, Geometry};

/// Greatest depth of a tree, in nodes on a way from the root to a leaf: below [`binary::SAH_DEPTH`] ranges are halved, and they
/// have less than 2^30 primitives.
pub(crate) const MAX_DEPTH: usize = binary::SAH_DEPTH as usize + 31;

/// Builds a tree.
pub(crate) fn build(geometries: &[Geometry]) -> Result<Tree, Error> {
    let primitives = Primitives::new(geometries)?;
    let mut refs = primitives.refs();
    let nodes = binary::build(&mut refs);
    Ok(emit::emit(&primitives, &refs, &nodes))
}
