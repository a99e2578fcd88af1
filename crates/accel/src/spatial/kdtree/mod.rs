//! The k-d tree: planes across the axes, chosen by the surface area heuristic or through the median, and two walks:
//! with a stack, and along ropes from leaf to leaf.

mod build;
mod ropes;
mod split;

use super::items::Items;
use super::line::{Line, is_beyond};
use super::lists::Lists;
use super::search::Visitor;
use crate::levels::Levels;
pub(super) use build::Planes;
use ropes::Ropes;
use steradian_math::{Bounds3, DVec3};

/// Most levels below the root.
const DEPTH: u32 = 60;

/// A node in eight bytes: an inner one with its plane, whose first child follows it, or a leaf with its list.
#[derive(Clone, Copy, Debug)]
struct Node {
    plane: f32,
    /// Axis in the lowest two bits, 3 for leaves; above them the second child or the list.
    word: u32,
}

impl Node {
    fn leaf(list: u32) -> Self {
        Self { plane: 0.0, word: list << 2 | 3 }
    }

    fn inner(axis: usize, plane: f32, second: u32) -> Self {
        Self { plane, word: second << 2 | axis as u32 }
    }

    /// The list of a leaf.
    #[inline]
    fn list(self) -> Option<u32> {
        (self.word & 3 == 3).then_some(self.word >> 2)
    }

    #[inline]
    fn axis(self) -> usize {
        (self.word & 3) as usize
    }

    #[inline]
    fn second(self) -> u32 {
        self.word >> 2
    }
}

/// A k-d tree.
#[derive(Clone, Debug)]
pub(super) struct KdTree {
    bounds: [DVec3; 2],
    nodes: Vec<Node>,
    lists: Lists,
    ropes: Option<Ropes>,
}

impl KdTree {
    /// Divides space, and ties leaves to their neighbours where `roped`.
    pub fn build(items: &Items, planes: Planes, roped: bool) -> Self {
        let mut tree = build::build(items, planes);
        if roped {
            tree.ropes = Some(Ropes::new(&tree));
        }
        tree
    }

    /// Visits the leaves along a line in order.
    pub fn walk(&self, line: &Line, visitor: &mut impl Visitor) {
        match &self.ropes {
            Some(ropes) if line.reach == 0.0 => self.walk_ropes(ropes, line, visitor),
            _ => self.walk_down(line, visitor),
        }
    }

    /// With a stack of the far children.
    fn walk_down(&self, line: &Line, visitor: &mut impl Visitor) {
        // One far child waits for each level at most.
        let mut stack = [(0_u32, [0.0_f64; 2]); DEPTH as usize + 1];
        let mut len = 0;
        let (mut current, mut t) = (0, line.t);
        loop {
            visitor.step();
            let node = self.nodes[current as usize];
            if let Some(list) = node.list() {
                if visitor.visit(self.lists.get(list)) {
                    return;
                }
                // Pop the next subtree in front of the hit.
                loop {
                    if len == 0 {
                        return;
                    }
                    len -= 1;
                    (current, t) = stack[len];
                    if !is_beyond(t[0], visitor.t_max()) {
                        break;
                    }
                }
                continue;
            }
            let axis = node.axis();
            let (below, above) = (current + 1, node.second());
            let (plane, o, d) = (f64::from(node.plane), line.origin[axis], line.direction[axis]);
            // Parallel to the plane: visit every side within reach.
            if d == 0.0 {
                let (is_low, is_high) = (o <= plane + line.reach, o >= plane - line.reach);
                if is_low && is_high {
                    stack[len] = (above, t);
                    len += 1;
                }
                current = if is_low { below } else { above };
                continue;
            }
            // Order the children along the ray and find where it crosses the plane.
            let (near, far) = if d > 0.0 { (below, above) } else { (above, below) };
            let crossing = (plane - o) * line.inverse[axis];
            let width = line.reach * line.inverse[axis].abs();
            // Within the reach both sides may hold a hit: the intervals of near and far child overlap by it.
            let (enter_far, leave_near) = (crossing - width, crossing + width);
            // The ray has left the near side before its interval begins: go to the far child alone.
            if leave_near < t[0] {
                current = far;
                t[0] = t[0].max(enter_far);
            } else {
                current = near;
                // Descend to the near child; the far child waits unless the interval ends before it.
                if enter_far <= t[1] {
                    stack[len] = (far, [t[0].max(enter_far), t[1]]);
                    len += 1;
                }
                t[1] = t[1].min(leave_near);
            }
        }
    }

    /// Memory in bytes.
    pub fn bytes(&self) -> usize {
        let ropes = self.ropes.as_ref().map_or(0, Ropes::bytes);
        size_of_val(&self.nodes[..]) + self.lists.bytes() + ropes + size_of::<Self>()
    }
}

impl Levels for KdTree {
    /// Index and box.
    type Node = (u32, Bounds3);

    fn root(&self) -> Self::Node {
        let [min, max] = self.bounds.map(|p| p.as_vec3());
        (0, Bounds3 { min, max })
    }

    fn bounds(&self, (_, bounds): Self::Node) -> Bounds3 {
        bounds
    }

    fn open(&self, (index, bounds): Self::Node, children: &mut Vec<Self::Node>) -> bool {
        let node = self.nodes[index as usize];
        if node.list().is_some() {
            return false;
        }
        let (mut low, mut high) = (bounds, bounds);
        low.max[node.axis()] = node.plane;
        high.min[node.axis()] = node.plane;
        let holds = |i: u32| self.nodes[i as usize].list().is_none_or(|list| !self.lists.get(list).is_empty());
        children.extend([(index + 1, low), (node.second(), high)].into_iter().filter(|(i, _)| holds(*i)));
        true
    }

    fn holder(&self, (leaf, _): Self::Node, slot: u32) -> Option<u32> {
        self.nodes[leaf as usize].list().filter(|list| self.lists.get(*list).contains(&slot))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spatial::testing;

    /// The expected cost of a ray by the surface area heuristic, in steps and tests.
    fn sah(tree: &KdTree, node: u32, [min, max]: [DVec3; 2]) -> f64 {
        let area = |[min, max]: [DVec3; 2]| {
            let d: DVec3 = max - min;
            d.x * d.y + d.y * d.z + d.z * d.x
        };
        let n = tree.nodes[node as usize];
        if let Some(list) = n.list() {
            return 1.0 + tree.lists.get(list).len() as f64;
        }
        let (mut low, mut high) = ([min, max], [min, max]);
        low[1][n.axis()] = f64::from(n.plane);
        high[0][n.axis()] = f64::from(n.plane);
        let part = |child, b| area(b) / area([min, max]) * sah(tree, child, b);
        1.0 + part(node + 1, low) + part(n.second(), high)
    }

    #[test]
    fn the_heuristic_beats_the_median() {
        // Most triangles in one corner: the median does not cut off empty space.
        let (mut mesh, far) = (testing::soup(3000, 0.05, 88), testing::soup(40, 0.1, 89));
        mesh.0.iter_mut().for_each(|p| *p = *p * 0.1 + 0.9);
        let base = mesh.0.len() as u32;
        mesh.0.extend(far.0);
        mesh.1.extend(far.1.iter().map(|t| t.map(|i| i + base)));
        let items = testing::items(&mesh);
        let [cost, median] = [Planes::Sah, Planes::Median].map(|planes| {
            let tree = KdTree::build(&items, planes, false);
            sah(&tree, 0, tree.bounds)
        });
        assert!(cost < 0.6 * median, "{cost} against {median}");
    }

    #[test]
    fn the_caps_hold() {
        for size in [1.5, 0.01] {
            let items = testing::items(&testing::soup(2000, size, 90));
            for planes in [Planes::Sah, Planes::Median] {
                let tree = KdTree::build(&items, planes, true);
                let listed = tree.lists.len() as u64;
                assert!(listed <= (build::LISTED_PER_ITEM + 1) * 2000 + 1024, "{listed}");
                assert!(listed >= 2000 && (size > 1.0 || tree.nodes.len() > 500));
            }
        }
    }
}
