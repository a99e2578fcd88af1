//! The hierarchy over the geometries of one space.
#![allow(unsafe_code)]

use crate::dispatch::{SupportedIsa, any_hit, nearest_hit};
use crate::geometry::WORLD;
use crate::layout::{Block, ChildRef, Node};
use crate::simd::LANES;
#[cfg(test)]
use crate::simd::Row;
use crate::storage::Storage;
use crate::traverse::Users;
use crate::{Error, Geometry, Hit, Isa, PrimId, UserHit, UserPrimitives, build};
use steradian_math::{Bounds3, Ray};

/// The parts of a hierarchy that traversal reads. Nodes and blocks are in depth-first order.
#[derive(Clone, Debug)]
pub(crate) struct Tree {
    pub nodes: Storage<Node>,
    pub blocks: Storage<Block>,
    pub root: ChildRef,
    pub bounds: Bounds3,
    /// For each geometry the index of its first primitive over all geometries, and at the end the number of primitives.
    pub first: Vec<u32>,
}

impl Tree {
    /// The node a reference is to.
    ///
    /// # Safety
    /// The reference must be to a node, and come from this tree.
    #[inline(always)]
    pub unsafe fn node(&self, child: ChildRef) -> &Node {
        debug_assert!(child.is_node());
        // SAFETY: the builder makes references to nodes that exist only, and nothing changes a tree.
        unsafe { self.nodes.get_unchecked(child.index()) }
    }

    /// The block of triangles a reference is to.
    ///
    /// # Safety
    /// The reference must be to a block, and come from this tree.
    #[inline(always)]
    pub unsafe fn block(&self, child: ChildRef) -> &Block {
        debug_assert!(child.is_block());
        // SAFETY: the builder makes references to blocks that exist only, and nothing changes a tree.
        unsafe { self.blocks.get_unchecked(child.index()) }
    }

    /// Which geometry and primitive an index over all geometries means.
    #[inline]
    pub fn locate(&self, index: u32) -> (u32, u32) {
        let geom = if self.first.len() == 2 { 0 } else { self.first.partition_point(|&first| first <= index) - 1 };
        (geom as u32, index - self.first[geom])
    }

    /// The boxes of the root's children, or of the tree if its root is not a node.
    pub fn root_boxes(&self) -> impl Iterator<Item = Bounds3> + '_ {
        let node = self.root.is_node().then(|| &self.nodes[self.root.index()]);
        let lanes = if node.is_some() { LANES } else { 1 };
        (0..lanes).map(move |lane| node.map_or(self.bounds, |node| node.child_bounds(lane))).filter(|b| !b.is_empty())
    }

    /// Memory in bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.nodes[..]) + size_of_val(&self.blocks[..]) + size_of_val(&self.first[..]) + size_of::<Self>()
    }
}

/// A bounding volume hierarchy over triangles and user primitives. It owns what it needs of them.
#[derive(Clone, Debug)]
pub struct Bvh {
    tree: Tree,
    isa: SupportedIsa,
}

impl Bvh {
    /// Builds the hierarchy, in parallel in rayon's current thread pool. The result does not depend on the number of threads.
    ///
    /// # Errors
    /// When there are too many primitives.
    pub fn build(geometries: &[Geometry]) -> Result<Self, Error> {
        Ok(Self { tree: build::build(geometries)?, isa: SupportedIsa::best() })
    }

    /// The box around all primitives; empty when there are none.
    pub fn bounds(&self) -> Bounds3 {
        self.tree.bounds
    }

    /// Memory of the hierarchy, in bytes.
    pub fn bytes(&self) -> usize {
        self.tree.bytes()
    }

    /// The instruction set that queries run on.
    pub fn isa(&self) -> Isa {
        self.isa.get()
    }

    /// Runs queries on another instruction set; one that is not supported changes nothing.
    #[must_use]
    pub fn with_isa(mut self, isa: Isa) -> Self {
        self.isa = SupportedIsa::new(isa).unwrap_or(self.isa);
        self
    }

    /// The nearest hit in `(0, ray.t_max)`; `None` for a ray that is not valid.
    #[inline]
    pub fn intersect<U: UserPrimitives>(&self, ray: &Ray, user: &U) -> Option<Hit> {
        self.intersect_as(WORLD, ray, user)
    }

    /// Whether anything is hit in `(0, ray.t_max)`; `false` for a ray that is not valid.
    #[inline]
    pub fn occluded<U: UserPrimitives>(&self, ray: &Ray, user: &U) -> bool {
        self.occluded_as(WORLD, ray, user)
    }

    /// [`Bvh::intersect`] with the number of the instance that this hierarchy is seen as.
    #[inline]
    pub(crate) fn intersect_as<U: UserPrimitives>(&self, instance: u32, ray: &Ray, user: &U) -> Option<Hit> {
        let leaves = Leaves { tree: &self.tree, instance, user };
        let nearest = nearest_hit(self.isa, &self.tree, ray, &leaves)?;
        let UserHit { t, u, v } = nearest.hit;
        Some(Hit { t, u, v, id: leaves.id(nearest.index) })
    }

    /// [`Bvh::occluded`] with the number of the instance that this hierarchy is seen as.
    #[inline]
    pub(crate) fn occluded_as<U: UserPrimitives>(&self, instance: u32, ray: &Ray, user: &U) -> bool {
        any_hit(self.isa, &self.tree, ray, &Leaves { tree: &self.tree, instance, user })
    }

    /// Whether two hierarchies hold the same bits.
    #[cfg(test)]
    pub(crate) fn same_bits(&self, other: &Self) -> bool {
        let rows = |rows: &[Row]| rows.iter().flat_map(|row| row.0.map(f32::to_bits)).collect::<Vec<_>>();
        let (a, b) = (&self.tree, &other.tree);
        a.root == b.root
            && (a.bounds, &a.first) == (b.bounds, &b.first)
            && (a.nodes.len(), a.blocks.len()) == (b.nodes.len(), b.blocks.len())
            && a.nodes.iter().zip(&b.nodes).all(|(a, b)| rows(&a.rows) == rows(&b.rows) && a.children == b.children)
            && a.blocks.iter().zip(&b.blocks).all(|(a, b)| rows(&a.rows) == rows(&b.rows) && a.ids == b.ids)
    }

    /// See [`Tree::root_boxes`].
    pub(crate) fn root_boxes(&self) -> impl Iterator<Item = Bounds3> + '_ {
        self.tree.root_boxes()
    }
}

/// The user primitives of one hierarchy.
struct Leaves<'a, U> {
    tree: &'a Tree,
    instance: u32,
    user: &'a U,
}

impl<U> Leaves<'_, U> {
    #[inline]
    fn id(&self, index: u32) -> PrimId {
        let (geom, prim) = self.tree.locate(index);
        PrimId { instance: self.instance, geom, prim }
    }
}

impl<U: UserPrimitives> Users for Leaves<'_, U> {
    type Extra = ();

    fn triangle(&self) {}

    fn intersect(&self, index: u32, ray: &Ray) -> Option<(UserHit, ())> {
        self.user.intersect(self.id(index), ray).map(|hit| (hit, ()))
    }

    fn occluded(&self, index: u32, ray: &Ray) -> bool {
        self.user.occluded(self.id(index), ray)
    }

    fn accept(&self, index: u32, UserHit { t, u, v }: UserHit, ray: &Ray) -> bool {
        self.user.accept(&Hit { t, u, v, id: self.id(index) }, ray)
    }
}
