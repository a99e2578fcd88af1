//! Boxes of the structures by levels, and the leaf of a point: the structures as pictures of them show them.

use steradian_math::{Bounds3, Vec3};

/// A tree of boxes.
pub(crate) trait Levels {
    /// A node or a leaf, with what tells its box.
    type Node: Copy;

    /// The root.
    fn root(&self) -> Self::Node;

    /// The box of a node.
    fn bounds(&self, node: Self::Node) -> Bounds3;

    /// Appends the children of a node, without leaves that hold nothing; false for a leaf.
    fn open(&self, node: Self::Node, children: &mut Vec<Self::Node>) -> bool;

    /// The number of a leaf, if it holds a primitive.
    fn holder(&self, leaf: Self::Node, primitive: u32) -> Option<u32>;
}

/// The boxes of the nodes at a level below the root, and of the leaves above that level.
pub(crate) fn boxes<L: Levels>(levels: &L, level: u32) -> Vec<Bounds3> {
    let mut nodes = vec![levels.root()];
    let mut boxes = Vec::new();
    for _ in 0..level {
        let mut below = Vec::new();
        for node in nodes {
            if !levels.open(node, &mut below) {
                boxes.push(levels.bounds(node));
            }
        }
        nodes = below;
        if nodes.is_empty() {
            break;
        }
    }
    boxes.extend(nodes.into_iter().map(|node| levels.bounds(node)));
    boxes.retain(|b| !b.is_empty());
    boxes
}

/// The number of the first leaf that holds a primitive and a point of it, up to a distance on each axis.
pub(crate) fn leaf<L: Levels>(levels: &L, primitive: u32, p: Vec3, slack: f32) -> Option<u32> {
    let mut pending = vec![levels.root()];
    while let Some(node) = pending.pop() {
        let b = levels.bounds(node);
        let is_inside = Bounds3 { min: b.min - slack, max: b.max + slack }.contains(p);
        if is_inside && !levels.open(node, &mut pending) {
            let found = levels.holder(node, primitive);
            if found.is_some() {
                return found;
            }
        }
    }
    None
}
