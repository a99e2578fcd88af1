//! Building a k-d tree from the root down, in parallel; the tree does not depend on the number of threads.
//!
//! At most `8 + 1.3 log₂ n` levels, and [`LISTED_PER_ITEM`] entries in lists beyond one for each primitive.

use super::split::{Reference, best_plane, divide};
use super::{DEPTH, KdTree, Node};
use crate::spatial::budget::Budget;
use crate::spatial::items::Items;
use crate::spatial::lists::Lists;
use steradian_math::{Bounds3, DVec3};

/// Entries in lists, beyond one, for each primitive.
pub(super) const LISTED_PER_ITEM: u64 = 6;
/// Leaves by the median have no more primitives, if they may be divided.
const MEDIAN_LEAF: usize = 8;
/// Nodes with more are divided in parallel.
const PARALLEL: usize = 4096;

/// Placement of the splitting planes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::spatial) enum Planes {
    /// Minimum of the expected cost of a ray.
    Sah,
    /// Through the middle of the primitives, across the longest axis.
    Median,
}

/// A tree before it is laid out.
enum Built {
    Leaf(Vec<u32>),
    Inner(usize, f32, Box<[Built; 2]>),
}

/// Builds the tree.
pub(super) fn build(items: &Items, planes: Planes) -> KdTree {
    let n = items.list.len();
    let padding = items.padding();
    // Pad the boxes, so that what the rounded triangle test accepts is found in a visited leaf.
    let reference = |(slot, item): (usize, &crate::spatial::items::Item)| {
        let b = item.bounds();
        Reference::new(slot as u32, [b.min.as_dvec3() - padding, b.max.as_dvec3() + padding])
    };
    let references: Vec<Reference> = items.list.iter().enumerate().map(reference).collect();
    let bounds = references.iter().fold(Bounds3::EMPTY, |b, r| b.union(r.bounds));
    // The depth limit of pbrt: 8 + 1.3·log₂ n.
    let depth = (8 + (1.3 * (n.max(1) as f64).log2()) as u32).min(DEPTH);
    let built = subtree(items, planes, references, bounds, depth, Budget::new(n, LISTED_PER_ITEM));
    let (mut nodes, mut lists) = (Vec::new(), Lists::default());
    lay_out(&built, &mut nodes, &mut lists);
    let bounds =
        if n == 0 { [DVec3::INFINITY, DVec3::NEG_INFINITY] } else { [bounds.min.as_dvec3(), bounds.max.as_dvec3()] };
    KdTree { bounds, nodes, lists, ropes: None }
}

fn subtree(items: &Items, planes: Planes, refs: Vec<Reference>, bounds: Bounds3, depth: u32, budget: Budget) -> Built {
    let n = refs.len();
    let leaf = |refs: Vec<Reference>| Built::Leaf(refs.iter().map(|r| r.slot).collect());
    if depth == 0 || n < 2 {
        return leaf(refs);
    }
    let plane = match planes {
        Planes::Sah => best_plane(&refs, &bounds),
        Planes::Median => median(&refs, &bounds),
    };
    // Make a leaf where no plane pays, and where the copies of divided references exceed the budget.
    let Some((axis, plane)) = plane else { return leaf(refs) };
    let [low, high] = divide(items, &refs, axis, plane);
    let below = low.len() + high.len();
    // The median may leave everything on one side: stop where neither child is smaller.
    let is_progress = planes == Planes::Sah || low.len().max(high.len()) < n;
    let Some(budget) = budget.spend(n, below).filter(|_| is_progress) else { return leaf(refs) };
    drop(refs);
    let (mut left, mut right) = (bounds, bounds);
    left.max[axis] = plane;
    right.min[axis] = plane;
    // Divide the budget in proportion to the references and recurse.
    let shares = [&low, &high].map(|part| budget.share(part.len(), below));
    let below = || subtree(items, planes, low, left, depth - 1, shares[0]);
    let above = || subtree(items, planes, high, right, depth - 1, shares[1]);
    let (a, b) = if n > PARALLEL { rayon::join(below, above) } else { (below(), above()) };
    Built::Inner(axis, plane, Box::new([a, b]))
}

/// The plane through the middle of the primitives.
fn median(refs: &[Reference], bounds: &Bounds3) -> Option<(usize, f32)> {
    if refs.len() <= MEDIAN_LEAF {
        return None;
    }
    // In `f64`, where nothing overflows.
    let d = bounds.max.as_dvec3() - bounds.min.as_dvec3();
    // Cut the longest axis at the median of the centres.
    let axis = (0..3).fold(0, |best, axis| if d[axis] > d[best] { axis } else { best });
    let mut centers: Vec<f32> = refs.iter().map(|r| r.bounds.center()[axis]).collect();
    let middle = centers.len() / 2;
    let (_, plane, _) = centers.select_nth_unstable_by(middle, f32::total_cmp);
    (*plane > bounds.min[axis] && *plane < bounds.max[axis]).then_some((axis, *plane))
}

/// Nodes in depth-first order.
fn lay_out(built: &Built, nodes: &mut Vec<Node>, lists: &mut Lists) {
    match built {
        Built::Leaf(slots) => nodes.push(Node::leaf(lists.push(slots))),
        Built::Inner(axis, plane, children) => {
            // Reserve the inner node, lay out its first child right behind it, then fill in where the second one
            // begins.
            let place = nodes.len();
            nodes.push(Node::leaf(0));
            lay_out(&children[0], nodes, lists);
            nodes[place] = Node::inner(*axis, *plane, nodes.len() as u32);
            lay_out(&children[1], nodes, lists);
        }
    }
}
