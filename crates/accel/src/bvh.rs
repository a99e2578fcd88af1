//! The hierarchy over the geometries of one space.

use crate::geometry::WORLD;
use crate::leaves::UserLeaves;
use crate::many::{any_hits, nearest_hits};
use crate::nearest::Nearest;
use crate::refit::update;
use crate::single::{all_hits, any_hit, nearest_hit};
use crate::supported_isa::SupportedIsa;
use crate::tree::Tree;
use crate::{Builder, Error, Geometry, Hit, Isa, UserHit, UserPrimitives, construct, stream};
use steradian_math::{Bounds3, Ray};

/// A bounding volume hierarchy over triangles and user primitives. It owns what it needs of them.
#[derive(Clone, Debug)]
pub struct Bvh {
    tree: Tree,
    isa: SupportedIsa,
}

impl Bvh {
    /// Builds the hierarchy, in parallel in rayon's current thread pool. The result does not depend on the number of
    /// threads.
    ///
    /// # Errors
    /// When there are too many primitives.
    pub fn build(geometries: &[Geometry]) -> Result<Self, Error> {
        Self::build_by(Builder::default(), geometries)
    }

    /// Builds the hierarchy in a way of choice.
    ///
    /// # Errors
    /// When there are too many primitives.
    pub fn build_by(builder: Builder, geometries: &[Geometry]) -> Result<Self, Error> {
        Ok(Self { tree: construct::build(geometries, builder)?, isa: SupportedIsa::best() })
    }

    /// Follows geometry that has moved. When the numbers of primitives are the same and the same ones can be hit, the
    /// shape of the hierarchy is kept and its boxes are set anew, which is much faster than to build; gives `true`
    /// then. Else it is built anew. After great changes a hierarchy that keeps its shape is slow; [`Bvh::build`] makes
    /// a good one.
    ///
    /// # Errors
    /// When there are too many primitives; nothing is changed then.
    pub fn update(&mut self, geometries: &[Geometry]) -> Result<bool, Error> {
        update(&mut self.tree, geometries)
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
        self.isa = self.isa.with_level(isa);
        self
    }

    /// Packets of batches and streams have at most so many rays: `width`, which is made a power of two from four to
    /// thirty-two, and no more than two registers have lanes. Hits are the same for all.
    #[must_use]
    pub fn with_packet_width(mut self, width: usize) -> Self {
        self.isa = self.isa.with_width(width);
        self
    }

    /// The nearest hit in `(0, ray.t_max)`; `None` for a ray that is not valid.
    #[inline(always)]
    pub fn intersect<U: UserPrimitives>(&self, ray: &Ray, user: &U) -> Option<Hit> {
        let leaves = Leaves { tree: &self.tree, instance: WORLD, user };
        nearest_hit(self.isa, &self.tree, ray, &leaves).map(|nearest| leaves.hit(nearest))
    }

    /// True if anything is hit in `(0, ray.t_max)`; `false` for a ray that is not valid.
    #[inline]
    pub fn occluded<U: UserPrimitives>(&self, ray: &Ray, user: &U) -> bool {
        self.occluded_as(WORLD, ray, user)
    }

    /// All hits in `(0, ray.t_max)`, nearest first, and of hits at equal distance the smaller [`PrimId`](crate::PrimId)
    /// first: every triangle that is hit and, where it is filtered, accepted; of a user primitive its nearest hit.
    pub fn all_hits<U: UserPrimitives>(&self, ray: &Ray, user: &U) -> Vec<Hit> {
        let mut hits = Vec::new();
        all_hits(self.isa, &self.tree, ray, &Leaves { tree: &self.tree, instance: WORLD, user }, &mut hits);
        // Sort by distance, then by name, so that equal hits are neighbours.
        hits.sort_unstable_by(|a, b| a.t.total_cmp(&b.t).then(a.id.cmp(&b.id)));
        // A triangle may be in several leaves.
        hits.dedup_by_key(|hit| hit.id);
        hits
    }

    /// The nearest hits of many rays at once, each with the bits of [`Bvh::intersect`]. Neighbours in the slice that go
    /// nearly the same way are traced together.
    ///
    /// # Panics
    /// When the slices differ in length.
    pub fn intersect_batch<U: UserPrimitives>(&self, rays: &[Ray], user: &U, hits: &mut [Option<Hit>]) {
        let leaves = Leaves { tree: &self.tree, instance: WORLD, user };
        nearest_hits(self.isa, &self.tree, rays, &leaves, hits);
    }

    /// [`Bvh::occluded`] of many rays at once.
    ///
    /// # Panics
    /// When the slices differ in length.
    pub fn occluded_batch<U: UserPrimitives>(&self, rays: &[Ray], user: &U, occluded: &mut [bool]) {
        any_hits(self.isa, &self.tree, rays, &Leaves { tree: &self.tree, instance: WORLD, user }, occluded);
    }

    /// [`Bvh::intersect_batch`] for rays in any order: they are sorted first.
    ///
    /// # Panics
    /// When the slices differ in length.
    pub fn intersect_stream<U: UserPrimitives>(&self, rays: &[Ray], user: &U, hits: &mut [Option<Hit>]) {
        stream::in_order(rays, hits, None, |rays, hits| self.intersect_batch(rays, user, hits));
    }

    /// [`Bvh::occluded_batch`] for rays in any order: they are sorted first.
    ///
    /// # Panics
    /// When the slices differ in length.
    pub fn occluded_stream<U: UserPrimitives>(&self, rays: &[Ray], user: &U, occluded: &mut [bool]) {
        stream::in_order(rays, occluded, false, |rays, occluded| self.occluded_batch(rays, user, occluded));
    }

    /// The nearest hit, when this hierarchy is seen as an instance with a number.
    #[inline]
    pub(crate) fn nearest_as<U: UserPrimitives>(&self, instance: u32, ray: &Ray, user: &U) -> Option<Nearest<()>> {
        nearest_hit(self.isa, &self.tree, ray, &Leaves { tree: &self.tree, instance, user })
    }

    /// Collects all hits, when this hierarchy is seen as an instance with a number.
    pub(crate) fn every_as<U: UserPrimitives>(&self, instance: u32, ray: &Ray, user: &U, hits: &mut Vec<Hit>) {
        all_hits(self.isa, &self.tree, ray, &Leaves { tree: &self.tree, instance, user }, hits);
    }

    /// [`Bvh::occluded`] with the number of the instance that this hierarchy is seen as.
    #[inline]
    pub(crate) fn occluded_as<U: UserPrimitives>(&self, instance: u32, ray: &Ray, user: &U) -> bool {
        any_hit(self.isa, &self.tree, ray, &Leaves { tree: &self.tree, instance, user })
    }

    /// The tree alone.
    pub(crate) fn tree(&self) -> &Tree {
        &self.tree
    }
}

/// The user primitives of one hierarchy.
pub(crate) struct Leaves<'a, U> {
    pub tree: &'a Tree,
    pub instance: u32,
    pub user: &'a U,
}

impl<U: UserPrimitives> UserLeaves for Leaves<'_, U> {
    type Extra = ();

    #[inline(always)]
    fn triangle(&self) {}

    fn intersect(&self, index: u32, ray: &Ray) -> Option<(UserHit, ())> {
        self.user.intersect(self.tree.id(self.instance, index), ray).map(|hit| (hit, ()))
    }

    fn occluded(&self, index: u32, ray: &Ray) -> bool {
        self.user.occluded(self.tree.id(self.instance, index), ray)
    }

    #[inline]
    fn accept(&self, index: u32, UserHit { t, u, v }: UserHit, ray: &Ray) -> bool {
        !U::FILTERS || self.user.accept(&Hit { t, u, v, id: self.tree.id(self.instance, index) }, ray)
    }

    #[inline(always)]
    fn hit(&self, Nearest { hit: UserHit { t, u, v }, index, .. }: Nearest<()>) -> Hit {
        Hit { t, u, v, id: self.tree.id(self.instance, index) }
    }
}
