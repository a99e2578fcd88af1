//! Hierarchies of other widths than eight, and one whose boxes are quantised to eight bits: made by the same builder
//! with the same choices for each width, to be compared. They hold the primitives in an order of their own, but no copy
//! of them in blocks.

use super::items::{Items, slack};
use super::search::Visitor;
use crate::construct::{self, Part};
use crate::levels::{self, Levels};
use crate::ray_constants::RayConstants;
use crate::widened::widened;
use crate::{Builder, Error, Geometry};
use steradian_math::{Bounds3, Ray, Vec3};

/// Child of a node: nothing, a node, or up to eight slots. The number of slots is above, an index below.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Child(u32);

impl Child {
    const INDEX_BITS: u32 = 28;
    const NONE: Self = Self(u32::MAX);

    fn new(part: Part) -> Self {
        match part {
            Part::Node(index) => Self(index),
            Part::Leaf { first, count } => Self(count << Self::INDEX_BITS | first),
        }
    }

    /// Number of slots, zero for a node, and the index of the node or of the first slot.
    fn get(self) -> (usize, usize) {
        ((self.0 >> Self::INDEX_BITS) as usize, (self.0 & ((1 << Self::INDEX_BITS) - 1)) as usize)
    }
}

/// A way to store the boxes of a node.
trait Boxes<const WIDTH: usize> {
    /// Stores boxes, or larger ones.
    fn new(boxes: [Bounds3; WIDTH]) -> Self;
    /// The boxes by axis: least and greatest coordinates. Those of children that are none may be anything.
    fn get(&self) -> [[[f32; WIDTH]; 3]; 2];
}

/// As they are.
#[derive(Clone, Copy, Debug)]
struct Full<const WIDTH: usize>([[[f32; WIDTH]; 3]; 2]);

impl<const WIDTH: usize> Boxes<WIDTH> for Full<WIDTH> {
    fn new(boxes: [Bounds3; WIDTH]) -> Self {
        let by_axis = |corner: fn(&Bounds3) -> Vec3| [0, 1, 2].map(|axis| boxes.each_ref().map(|b| corner(b)[axis]));
        Self([by_axis(|b| b.min), by_axis(|b| b.max)])
    }

    #[inline]
    fn get(&self) -> [[[f32; WIDTH]; 3]; 2] {
        self.0
    }
}

/// In eight bits for each plane: steps of a power of two from the least corner of all (Ylitie, Karras, Laine,
/// "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", HPG 2017).
#[derive(Clone, Copy, Debug)]
struct Quantised<const WIDTH: usize> {
    origin: [f32; 3],
    step: [f32; 3],
    planes: [[[u8; WIDTH]; 3]; 2],
}

impl<const WIDTH: usize> Boxes<WIDTH> for Quantised<WIDTH> {
    fn new(boxes: [Bounds3; WIDTH]) -> Self {
        // The node's own box is the frame of the quantisation.
        let all = boxes.iter().fold(Bounds3::EMPTY, |all, b| all.union(*b));
        let mut node = Self { origin: all.min.to_array(), step: [1.0; 3], planes: [[[0; WIDTH]; 3]; 2] };
        for axis in 0..3 {
            // A step for which 255 of them reach the other end. Powers of two make products exact; the sum may be
            // rounded, so that a plane is moved until it is where it has to be.
            let size = f64::from(all.max[axis]) - f64::from(all.min[axis]);
            let mut step = 2.0_f64.powi(((size / 255.0).log2().ceil().max(-126.0)) as i32);
            let place = |step: f64, x: u8| all.min[axis] + (step * f64::from(x)) as f32;
            while place(step, 255) < all.max[axis] {
                step *= 2.0;
            }
            node.step[axis] = step as f32;
            for (child, b) in boxes.iter().enumerate().filter(|(_, b)| !b.is_empty()) {
                // Round low planes down and high planes up, so that the quantised box encloses the exact one.
                let steps = |x: f32| ((f64::from(x) - f64::from(all.min[axis])) / step).clamp(0.0, 255.0);
                let (mut low, mut high) = (steps(b.min[axis]).floor() as u8, steps(b.max[axis]).ceil() as u8);
                while place(step, low) > b.min[axis] && low > 0 {
                    low -= 1;
                }
                while place(step, high) < b.max[axis] && high < 255 {
                    high += 1;
                }
                node.planes[0][axis][child] = low;
                node.planes[1][axis][child] = high;
            }
        }
        node
    }

    #[inline]
    fn get(&self) -> [[[f32; WIDTH]; 3]; 2] {
        let planes = |side: usize| {
            [0, 1, 2].map(|axis| self.planes[side][axis].map(|x| self.origin[axis] + self.step[axis] * f32::from(x)))
        };
        [planes(0), planes(1)]
    }
}

/// A node.
#[derive(Clone, Copy, Debug)]
struct Node<B, const WIDTH: usize> {
    boxes: B,
    children: [Child; WIDTH],
}

/// Nodes of one kind.
#[derive(Clone, Debug)]
struct Tree<B, const WIDTH: usize> {
    nodes: Vec<Node<B, WIDTH>>,
    /// The slots of leaves.
    order: Vec<u32>,
}

impl<B: Boxes<WIDTH>, const WIDTH: usize> Tree<B, WIDTH> {
    fn build(items: &Items, geometries: &[Geometry]) -> Result<Self, Error> {
        let (nodes, indices) = construct::wide::<WIDTH>(geometries, Builder::Sah)?;
        let node = |parts: &[Option<(Bounds3, Part)>; WIDTH]| Node {
            boxes: B::new(parts.map(|part| part.map_or(Bounds3::EMPTY, |(bounds, _)| clamped(&widened(&bounds))))),
            children: parts.map(|part| part.map_or(Child::NONE, |(_, part)| Child::new(part))),
        };
        // Leaves of the builder hold indices over all geometries; slots are found by binary search.
        let slot = |index: &u32| items.list.partition_point(|item| item.index() < *index) as u32;
        Ok(Self { nodes: nodes.iter().map(node).collect(), order: indices.iter().map(slot).collect() })
    }

    /// Shows a visitor the leaves along a ray, nearest first.
    fn walk(&self, ray: &Ray, bounds: &Bounds3, visitor: &mut impl Visitor) {
        if self.nodes.is_empty() {
            return;
        }
        // Constants of the conservative slab test.
        let constants = RayConstants::new(ray, bounds);
        let (i, o) = (constants.inverse.to_array(), constants.offset.map(|offset| offset.to_array()));
        // Index of the far plane on each axis, by the sign of the reciprocal.
        let far = i.map(|x| usize::from(!x.is_sign_negative()));
        let mut pending = Vec::with_capacity(64);
        pending.push((0.0, Child(0)));
        while let Some((entry, child)) = pending.pop() {
            if entry > visitor.t_max() {
                continue;
            }
            // A leaf shows its primitives to the visitor.
            let (count, index) = child.get();
            visitor.step();
            if count > 0 {
                if visitor.visit(&self.order[index..index + count]) {
                    return;
                }
                continue;
            }
            let Node { boxes, children } = &self.nodes[index];
            let planes = boxes.get();
            // Slab test of all children.
            let (mut enter, mut leave) = ([0.0_f32; WIDTH], [visitor.t_max(); WIDTH]);
            for axis in 0..3 {
                let (near, far) = (&planes[1 - far[axis]][axis], &planes[far[axis]][axis]);
                for child in 0..WIDTH {
                    enter[child] = enter[child].max(near[child] * i[axis] + o[0][axis]);
                    leave[child] = leave[child].min(far[child] * i[axis] + o[1][axis]);
                }
            }
            let first = pending.len();
            // Insert the entered children sorted by entry distance, the nearest on top.
            for child in (0..WIDTH).filter(|&child| children[child] != Child::NONE && enter[child] <= leave[child]) {
                // Farther ones below.
                let nearer = pending[first..].partition_point(|&(entry, _)| entry > enter[child]);
                pending.insert(first + nearer, (enter[child], children[child]));
            }
        }
    }

    fn bytes(&self) -> usize {
        size_of_val(&self.nodes[..]) + size_of_val(&self.order[..])
    }
}

impl<B: Boxes<WIDTH>, const WIDTH: usize> Levels for (&Tree<B, WIDTH>, &Bounds3) {
    /// Child and box.
    type Node = (Child, Bounds3);

    fn root(&self) -> Self::Node {
        (if self.0.nodes.is_empty() { Child::NONE } else { Child(0) }, *self.1)
    }

    fn bounds(&self, (_, bounds): Self::Node) -> Bounds3 {
        bounds
    }

    fn open(&self, (child, _): Self::Node, children: &mut Vec<Self::Node>) -> bool {
        let (0, index) = child.get() else { return false };
        let node = &self.0.nodes[index];
        let [min, max] = node.boxes.get().map(|planes| {
            std::array::from_fn::<Vec3, WIDTH, _>(|i| Vec3::from_array(planes.map(|of_axis| of_axis[i])))
        });
        let all = (0..WIDTH).map(|i| (node.children[i], Bounds3 { min: min[i], max: max[i] }));
        children.extend(all.filter(|(child, _)| *child != Child::NONE));
        true
    }

    fn holder(&self, (leaf, _): Self::Node, slot: u32) -> Option<u32> {
        let (count, first) = leaf.get();
        (leaf != Child::NONE && self.0.order[first..first + count].contains(&slot)).then_some(leaf.0)
    }
}

/// Which of the hierarchies.
#[derive(Clone, Copy, Debug)]
pub(super) enum Kind {
    Two,
    Four,
    Sixteen,
    Quantised,
}

/// One of the hierarchies.
#[derive(Clone, Debug)]
pub(super) struct Wide(Trees);

#[derive(Clone, Debug)]
enum Trees {
    Two(Tree<Full<2>, 2>),
    Four(Tree<Full<4>, 4>),
    Sixteen(Tree<Full<16>, 16>),
    Quantised(Tree<Quantised<8>, 8>),
}

impl Wide {
    pub fn build(kind: Kind, items: &Items, geometries: &[Geometry]) -> Result<Self, Error> {
        Ok(Self(match kind {
            Kind::Two => Trees::Two(Tree::build(items, geometries)?),
            Kind::Four => Trees::Four(Tree::build(items, geometries)?),
            Kind::Sixteen => Trees::Sixteen(Tree::build(items, geometries)?),
            Kind::Quantised => Trees::Quantised(Tree::build(items, geometries)?),
        }))
    }

    /// Shows a visitor what is along a ray.
    pub fn walk(&self, ray: &Ray, bounds: &Bounds3, visitor: &mut impl Visitor) {
        match &self.0 {
            Trees::Two(tree) => tree.walk(ray, bounds, visitor),
            Trees::Four(tree) => tree.walk(ray, bounds, visitor),
            Trees::Sixteen(tree) => tree.walk(ray, bounds, visitor),
            Trees::Quantised(tree) => tree.walk(ray, &grown(bounds), visitor),
        }
    }

    /// Boxes at a level, see [`levels::boxes`].
    pub fn boxes(&self, bounds: &Bounds3, level: u32) -> Vec<Bounds3> {
        match &self.0 {
            Trees::Two(tree) => levels::boxes(&(tree, bounds), level),
            Trees::Four(tree) => levels::boxes(&(tree, bounds), level),
            Trees::Sixteen(tree) => levels::boxes(&(tree, bounds), level),
            Trees::Quantised(tree) => levels::boxes(&(tree, bounds), level),
        }
    }

    /// The leaf of a point of a primitive, see [`levels::leaf`].
    pub fn leaf(&self, bounds: &Bounds3, slot: u32, p: Vec3) -> Option<u32> {
        let slack = slack(bounds);
        match &self.0 {
            Trees::Two(tree) => levels::leaf(&(tree, bounds), slot, p, slack),
            Trees::Four(tree) => levels::leaf(&(tree, bounds), slot, p, slack),
            Trees::Sixteen(tree) => levels::leaf(&(tree, bounds), slot, p, slack),
            Trees::Quantised(tree) => levels::leaf(&(tree, bounds), slot, p, slack),
        }
    }

    /// Leaves that hold a slot.
    #[cfg(test)]
    pub fn holders(&self, bounds: &Bounds3, slot: u32) -> Vec<(u32, Bounds3)> {
        use super::cells_tests::holders;
        match &self.0 {
            Trees::Two(tree) => holders(&(tree, bounds), slot),
            Trees::Four(tree) => holders(&(tree, bounds), slot),
            Trees::Sixteen(tree) => holders(&(tree, bounds), slot),
            Trees::Quantised(tree) => holders(&(tree, bounds), slot),
        }
    }

    /// Memory in bytes.
    pub fn bytes(&self) -> usize {
        match &self.0 {
            Trees::Two(tree) => tree.bytes(),
            Trees::Four(tree) => tree.bytes(),
            Trees::Sixteen(tree) => tree.bytes(),
            Trees::Quantised(tree) => tree.bytes(),
        }
    }
}

/// A box of finite size.
fn clamped(b: &Bounds3) -> Bounds3 {
    Bounds3 { min: b.min.max(Vec3::MIN), max: b.max.min(Vec3::MAX) }
}

/// Bounds that hold quantised boxes too, which are greater by at most a step in 255, and steps by at most two.
fn grown(bounds: &Bounds3) -> Bounds3 {
    // Half as much again as two steps of 1/255 would need.
    let more = (bounds.max - bounds.min) * 0.01;
    Bounds3 { min: bounds.min - more, max: bounds.max + more }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spatial::testing::in_cube;
    use steradian_math::hash::HashRng;

    #[test]
    fn quantised_boxes_hold_the_full_ones_and_little_more() {
        let mut rng = HashRng::new(41);
        for round in 0..300 {
            let size = 10.0_f32.powi(round % 40 - 20);
            let offset = in_cube(&mut rng) * [0.0, 1.0, 1e4][round as usize % 3];
            let boxes: [Bounds3; 8] = std::array::from_fn(|_| {
                let (a, b) = (in_cube(&mut rng), in_cube(&mut rng));
                Bounds3::from_points([(a + offset) * size, (b + offset) * size])
            });
            let all = boxes.iter().fold(Bounds3::EMPTY, |all, b| all.union(*b));
            let [min, max] = <Quantised<8> as Boxes<8>>::new(boxes).get();
            for axis in 0..3 {
                // A step is at most two 255ths and a bit; far from zero there is rounding too.
                let slack =
                    (all.max[axis] - all.min[axis]) * 0.009 + all.max.abs().max(all.min.abs()).max_element() * 4e-7;
                for (child, b) in boxes.iter().enumerate() {
                    assert!(min[axis][child] <= b.min[axis] && max[axis][child] >= b.max[axis], "{round}");
                    assert!(
                        min[axis][child] >= b.min[axis] - slack && max[axis][child] <= b.max[axis] + slack,
                        "{round}"
                    );
                }
            }
        }
    }
}
