//! The binary tree, and for each of its nodes the cheapest way to make a part of a wide tree of it.
//!
//! The cost of a wide tree is the area of its nodes and blocks, each weighted with the time of its test. The cheapest
//! tree is found from the leaves up by dynamic programming: for each binary node the cost as a forest of at most `i`
//! wide subtrees (Ylitie, Karras, Laine, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", HPG
//! 2017, section 3.1).

use super::nodes::{BinaryTree, Nodes};
use super::primitives::PrimRef;
use super::split::{Extent, half_area, split};
use crate::simd::LANES;
use steradian_math::Bounds3;

/// Down to this depth ranges are cut by the surface area heuristic, below they are halved.
pub(super) const SAH_DEPTH: u32 = 64;
/// Ranges of triangles up to this length are not cut further.
const SMALL: usize = 4;
/// Ranges longer than this are cut by several threads.
pub(super) const PARALLEL: usize = 1 << 12;
/// Time of the test of a node's boxes.
const NODE_COST: f32 = 1.0;
/// Time of the test of a block of triangles.
const BLOCK_COST: f32 = 1.0;
/// Parts of a tree that are smaller than this share of it have areas of their own scale.
const LEAST_SIZE: f32 = 1.0 / (1 << 30) as f32;
/// Several blocks instead of one must not cost more than this share of it.
const WORTH: f32 = 0.97;

/// Costs of a binary node as a forest of at most 1, 2, … subtrees, as many as a wide node has children.
pub(super) type Costs<const WIDTH: usize> = [f32; WIDTH];

/// A node of the binary tree, over a range of references.
#[derive(Clone, Copy, Debug)]
pub(super) struct BinaryNode<const WIDTH: usize> {
    pub bounds: Bounds3,
    /// Start of the range.
    pub first: u32,
    /// Length of the range.
    pub count: u32,
    /// Offset of the second child from this node; the first child is at 1. Zero: no children.
    pub second: u32,
    /// `forest[i]`: how many of `i + 1` subtrees the first child gets in the cheapest forest, or zero when one subtree
    /// less is as cheap. `forest[0]` is one when the range becomes a leaf.
    pub forest: [u8; WIDTH],
}

impl<const WIDTH: usize> BinaryNode<WIDTH> {
    /// True if the range becomes a leaf of the wide tree.
    pub fn is_leaf(&self) -> bool {
        self.forest[0] == 1
    }
}

/// Sorts the references and builds the tree over them.
pub(super) fn build<const WIDTH: usize>(refs: &mut [PrimRef]) -> BinaryTree<WIDTH> {
    let mut nodes = Nodes::new();
    if !refs.is_empty() {
        let extent = Extent::of(refs);
        build_range(refs, &mut nodes, 0, extent, scale(&extent.bounds), 0);
    }
    nodes.finish()
}

/// The factor for [`half_area`] in a tree with given bounds.
pub(super) fn scale(bounds: &Bounds3) -> f32 {
    let half = (bounds.max * 0.5 - bounds.min * 0.5).max_element();
    if half > 0.0 { half.recip().min(f32::MAX) } else { 1.0 }
}

/// The factor for a part of a tree: that of the tree, unless areas would vanish with it.
pub(super) fn fitted(scale: f32, bounds: &Bounds3) -> f32 {
    let half = (bounds.max * 0.5 - bounds.min * 0.5).max_element();
    if half * scale < LEAST_SIZE { self::scale(bounds) } else { scale }
}

/// The costs of a part with another factor as those of the tree.
pub(super) fn rescaled<const WIDTH: usize>(costs: Costs<WIDTH>, from: f32, to: f32) -> Costs<WIDTH> {
    let ratio = to / from;
    costs.map(|cost| cost * ratio * ratio)
}

/// True if `count` references fit into one leaf.
pub(super) fn fits_leaf(count: usize, triangles: bool) -> bool {
    count == 1 || count <= LANES && triangles
}

/// Builds the subtree over a range that begins at a place. The depth of the recursion is bounded by
/// [`super::MAX_DEPTH`].
pub(super) fn build_range<const WIDTH: usize>(
    refs: &mut [PrimRef],
    nodes: &mut Nodes<WIDTH>,
    first: u32,
    extent: Extent,
    scale: f32,
    depth: u32,
) -> Costs<WIDTH> {
    // Rescale subtrees whose areas would underflow in the scale of the whole tree.
    let own_scale = fitted(scale, &extent.bounds);
    if own_scale != scale {
        return rescaled(build_range(refs, nodes, first, extent, own_scale, depth), own_scale, scale);
    }
    let count = refs.len();
    let fits = fits_leaf(count, extent.triangles);
    let mut node = BinaryNode { bounds: extent.bounds, first, count: count as u32, second: 0, forest: [0; WIDTH] };
    // A small range becomes one block: as a forest of any size it costs the same.
    if fits && count <= SMALL {
        node.forest[0] = 1;
        nodes.push(node);
        return [half_area(&extent.bounds, scale) * BLOCK_COST; WIDTH];
    }

    // Split by the surface area heuristic, recurse on both parts and combine their costs.
    let (middle, [left_extent, right_extent]) = split(refs, &extent, scale, depth < SAH_DEPTH);
    let (left_refs, right_refs) = refs.split_at_mut(middle);
    let second = first + middle as u32;
    let left = |nodes: &mut Nodes<WIDTH>| build_range(left_refs, nodes, first, left_extent, scale, depth + 1);
    let right = |nodes: &mut Nodes<WIDTH>| build_range(right_refs, nodes, second, right_extent, scale, depth + 1);
    let (node, [left, right]) = nodes.join(node, count > PARALLEL, left, right);
    node.choose_forests(&left, &right, fits, scale)
}

impl<const WIDTH: usize> BinaryNode<WIDTH> {
    /// The recurrence: from the costs of the children to those of this node, and the choices that give them.
    pub fn choose_forests(
        &mut self,
        left: &Costs<WIDTH>,
        right: &Costs<WIDTH>,
        fits_leaf: bool,
        scale: f32,
    ) -> Costs<WIDTH> {
        let area = half_area(&self.bounds, scale);
        let leaf_cost = if fits_leaf { area * BLOCK_COST } else { f32::INFINITY };
        // The cheapest forests with exactly i + 1 places given to the two children, all of them side by side.
        let (mut shared, mut forest) = ([f32::INFINITY; WIDTH], [0; WIDTH]);
        let right = [[f32::INFINITY; WIDTH], *right];
        // C(n, i) = min over k of C(left, k) + C(right, i − k): distribute the places among the two children.
        for of_left in 1..WIDTH {
            let right = &right.as_flattened()[WIDTH - of_left..][..WIDTH];
            for i in 0..WIDTH {
                let cost = left[of_left - 1] + right[i];
                let is_cheaper = cost < shared[i];
                shared[i] = if is_cheaper { cost } else { shared[i] };
                forest[i] = if is_cheaper { of_left as u32 } else { forest[i] };
            }
        }
        let mut forest = forest.map(|of_left| of_left as u8);
        let mut costs = [0.0; WIDTH];
        // As one subtree: the node's own test and the cheapest forest that fills all slots; or a leaf where that is not
        // dearer.
        let inner_cost = area * NODE_COST + shared[WIDTH - 1];
        if leaf_cost <= inner_cost {
            forest[0] = 1;
        }
        costs[0] = leaf_cost.min(inner_cost);
        // A subtree with as many places as a node has is that node's: nobody asks for its cost.
        // What fits one block is cut into several only where that saves something: they take memory.
        let worth = if fits_leaf { WORTH } else { 1.0 };
        for i in 1..WIDTH - 1 {
            if costs[i - 1] * worth <= shared[i] {
                forest[i] = 0;
                costs[i] = costs[i - 1];
            } else {
                costs[i] = shared[i];
            }
        }
        self.forest = forest;
        costs
    }
}
