//! The binary space partition (Fuchs, Kedem and Naylor, "On Visible Surface Generation by a Priori Tree Structures",
//! SIGGRAPH 1980): planes of any direction, those of the polygons themselves among them, which are split where a plane
//! cuts them.
//!
//! At most [`DEPTH`] levels, and [`FRAGMENTS_PER_ITEM`] fragments for each primitive.

mod build;
mod polygon;

use super::items::Items;
use super::line::{Line, is_beyond};
use super::lists::Lists;
use super::search::Visitor;
use steradian_math::DVec3;

/// Most levels below the root.
const DEPTH: u32 = 48;
/// Fragments beyond one for each primitive.
const FRAGMENTS_PER_ITEM: u64 = 3;

/// A plane `normal · p = offset` with a unit normal.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Plane {
    normal: DVec3,
    offset: f64,
}

impl Plane {
    /// The signed distance of a point.
    #[inline]
    fn height(&self, p: DVec3) -> f64 {
        self.normal.dot(p) - self.offset
    }
}

/// A child: an inner node or a list.
#[derive(Clone, Copy, Debug)]
enum Child {
    Node(u32),
    List(u32),
}

/// An inner node.
#[derive(Clone, Copy, Debug)]
struct Node {
    plane: Plane,
    /// List of the primitives in the plane.
    coplanar: u32,
    /// Behind and in front.
    children: [Child; 2],
}

/// A binary space partition.
#[derive(Clone, Debug)]
pub(super) struct Bsp {
    root: Child,
    nodes: Vec<Node>,
    /// Lists of slots.
    lists: Lists,
    padding: f64,
}

impl Bsp {
    /// Divides space.
    pub fn build(items: &Items) -> Self {
        build::partition(items)
    }

    /// Visits the leaves along a line in order, and what lies in the planes between them.
    pub fn walk(&self, line: &Line, visitor: &mut impl Visitor) {
        // Polygons that the builder took for being in a plane, or on one side of it, may be off by its tolerance.
        let reach = line.reach + self.padding;
        // Keep a stack of subtrees with the interval of the ray inside each.
        let mut stack = [(Child::List(0), [0.0_f64; 2]); 2 * DEPTH as usize + 2];
        stack[0] = (self.root, line.t);
        let mut len = 1;
        while len > 0 {
            len -= 1;
            let (child, t) = stack[len];
            if is_beyond(t[0], visitor.t_max()) {
                continue;
            }
            visitor.step();
            let node = match child {
                Child::Node(node) => &self.nodes[node as usize],
                Child::List(list) => {
                    if visitor.visit(self.lists.get(list)) {
                        return;
                    }
                    continue;
                }
            };
            // Solve for the distance of the plane: t = −(n·o − offset)/(n·d).
            let (height, d) = (node.plane.height(line.origin), node.plane.normal.dot(line.direction));
            let mut push = |child: Child, t: [f64; 2]| {
                if t[0] <= t[1] {
                    stack[len] = (child, t);
                    len += 1;
                }
            };
            let coplanar = Child::List(node.coplanar);
            if d == 0.0 {
                // Along the plane: what it does not come near is out of its way.
                let [behind, front] = [height <= reach, height >= -reach];
                for (child, is_near) in
                    [(node.children[0], behind), (coplanar, behind && front), (node.children[1], front)]
                {
                    if is_near {
                        push(child, t);
                    }
                }
                continue;
            }
            // Visit the half-space of the origin first, then what lies in the plane, then the other half-space.
            let [near, far] = if d > 0.0 { node.children } else { [node.children[1], node.children[0]] };
            let (crossing, width) = (-height / d, reach / d.abs());
            push(far, [t[0].max(crossing - width), t[1]]);
            push(coplanar, [t[0].max(crossing - width), t[1].min(crossing + width)]);
            push(near, [t[0], t[1].min(crossing + width)]);
        }
    }

    /// The list of the leaf of a point; of one in a plane, on the side towards a direction.
    pub fn leaf(&self, p: DVec3, towards: DVec3) -> u32 {
        let mut child = self.root;
        loop {
            let Node { plane, children, .. } = match child {
                Child::List(list) => return list,
                Child::Node(node) => &self.nodes[node as usize],
            };
            let height = plane.height(p);
            let side = if height.abs() > self.padding { height } else { plane.normal.dot(towards) };
            child = children[usize::from(side > 0.0)];
        }
    }

    /// True if a leaf, or a plane above it, lists a slot.
    #[cfg(test)]
    pub fn holds(&self, slot: u32, leaf: u32) -> bool {
        let holds = |list: u32| self.lists.get(list).contains(&slot);
        let mut pending = vec![(self.root, false)];
        while let Some((child, above)) = pending.pop() {
            match child {
                Child::List(list) if list == leaf => return above || holds(list),
                Child::List(_) => {}
                Child::Node(node) => {
                    let Node { coplanar, children, .. } = self.nodes[node as usize];
                    pending.extend(children.map(|child| (child, above || holds(coplanar))));
                }
            }
        }
        false
    }

    /// Memory in bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.nodes[..]) + self.lists.bytes() + size_of::<Self>()
    }
}
