//! Ropes (Havran, Bittner and Žára, "Ray Tracing with Rope Trees", SCCG 1998; Popov et al. 2007): from each face of a
//! leaf to the smallest node that holds all of its neighbours there. A ray goes from leaf to leaf without a stack.

use super::{KdTree, Node};
use crate::spatial::line::{Line, is_beyond};
use crate::spatial::search::Visitor;
use steradian_math::DVec3;

/// Beyond the outer faces.
const NONE: u32 = u32::MAX;

/// Ropes of a leaf: faces in the order low x, y, z, high x, y, z.
#[derive(Clone, Copy, Debug)]
struct Leaf {
    faces: [f32; 6],
    ropes: [u32; 6],
}

/// The ropes of all leaves, by list.
#[derive(Clone, Debug)]
pub(super) struct Ropes(Vec<Leaf>);

impl Ropes {
    /// Ties all leaves.
    pub fn new(tree: &KdTree) -> Self {
        let [min, max] = tree.bounds.map(|p| p.as_vec3());
        let faces = [min.x, min.y, min.z, max.x, max.y, max.z];
        let empty = Leaf { faces, ropes: [NONE; 6] };
        let leaves = tree.nodes.iter().filter(|node| node.list().is_some()).count();
        let mut ropes = Self(vec![empty; leaves]);
        // Carry faces and ropes down the tree; each inner node ties its children to each other across its plane.
        let mut pending = vec![(0_u32, empty)];
        while let Some((index, mut leaf)) = pending.pop() {
            let node = tree.nodes[index as usize];
            // Push each rope down while one child alone covers the face ("rope optimisation").
            for face in 0..6 {
                leaf.ropes[face] = lower(&tree.nodes, &leaf, face);
            }
            if let Some(list) = node.list() {
                ropes.0[list as usize] = leaf;
                continue;
            }
            let axis = node.axis();
            let (mut low, mut high) = (leaf, leaf);
            (low.faces[axis + 3], low.ropes[axis + 3]) = (node.plane, node.second());
            (high.faces[axis], high.ropes[axis]) = (node.plane, index + 1);
            pending.extend([(index + 1, low), (node.second(), high)]);
        }
        ropes
    }

    /// Memory in bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.0[..])
    }
}

/// The lowest node beyond a face that still holds everything there.
fn lower(nodes: &[Node], leaf: &Leaf, face: usize) -> u32 {
    let mut rope = leaf.ropes[face];
    while rope != NONE {
        let node = nodes[rope as usize];
        if node.list().is_some() {
            break;
        }
        let axis = node.axis();
        let (below, above) = (rope + 1, node.second());
        // A split across the face's axis: the child that touches the face. Otherwise the child that covers the whole
        // face, if one does.
        rope = if axis == face % 3 {
            if face < 3 { above } else { below }
        } else if node.plane <= leaf.faces[axis] {
            above
        } else if node.plane >= leaf.faces[axis + 3] {
            below
        } else {
            break;
        };
    }
    rope
}

impl KdTree {
    /// Along the ropes.
    pub(super) fn walk_ropes(&self, ropes: &Ropes, line: &Line, visitor: &mut impl Visitor) {
        let mut at: DVec3 = line.at(line.t[0]).clamp(self.bounds[0], self.bounds[1]);
        let mut current = 0;
        loop {
            // Descend to the leaf that holds the point; on the plane the direction decides.
            let list = loop {
                visitor.step();
                let node = self.nodes[current as usize];
                if let Some(list) = node.list() {
                    break list;
                }
                let (axis, plane) = (node.axis(), f64::from(node.plane));
                let is_above = at[axis] > plane || at[axis] == plane && line.direction[axis] >= 0.0;
                current = if is_above { node.second() } else { current + 1 };
            };
            if visitor.visit(self.lists.get(list)) {
                return;
            }
            let leaf = &ropes.0[list as usize];
            // Find the face through which the ray leaves the leaf.
            let (mut exit, mut across) = (f64::INFINITY, 0);
            for axis in 0..3 {
                let d = line.direction[axis];
                if d != 0.0 {
                    let face = if d > 0.0 { axis + 3 } else { axis };
                    let t = (f64::from(leaf.faces[face]) - line.origin[axis]) * line.inverse[axis];
                    if t < exit {
                        (exit, across) = (t, face);
                    }
                }
            }
            // Follow the rope across that face.
            current = leaf.ropes[across];
            if current == NONE || exit > line.t[1] || is_beyond(exit, visitor.t_max()) {
                return;
            }
            // The point never goes back on any axis, nor out of the leaf, so that rounding cannot make the walk turn in
            // circles.
            let p = line.at(exit);
            for axis in 0..3 {
                let d = line.direction[axis];
                let (low, high) = (f64::from(leaf.faces[axis]), f64::from(leaf.faces[axis + 3]));
                if axis == across % 3 {
                    at[axis] = f64::from(leaf.faces[across]);
                } else if d > 0.0 {
                    at[axis] = p[axis].max(at[axis]).min(high);
                } else if d < 0.0 {
                    at[axis] = p[axis].min(at[axis]).max(low);
                }
            }
        }
    }
}
