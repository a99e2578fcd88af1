//! Two levels: world-space geometry and instances of other hierarchies, in one tree.

use crate::bvh::Leaves as ObjectLeaves;
use crate::geometry::WORLD;
use crate::leaves::UserLeaves;
use crate::many::{any_hits, any_packet_in, nearest_hits, nearest_packet_in};
use crate::nearest::Nearest;
use crate::outline::Outline;
use crate::packet_hits::Found;
use crate::packet_rays::Packet;
use crate::placement::{Instance, Placement};
use crate::refit::update;
use crate::single::{all_hits, any_hit, nearest_hit};
use crate::supported_isa::SupportedIsa;
use crate::tree::Tree;
use crate::{Builder, Bvh, Error, Geometry, Hit, Isa, PrimId, Shape, UserHit, UserPrimitives, construct, stream};
use glam::Mat4;
use rayon::prelude::*;
use steradian_math::{Bounds3, Ray};

/// World-space geometry and instances of objects. The instances are user primitives of the tree over the geometry, so
/// that both are visited in the order of distance, and a scene without instances costs what its [`Bvh`] costs.
#[derive(Clone, Debug)]
pub struct TopLevel {
    tree: Tree,
    isa: SupportedIsa,
    objects: Vec<Bvh>,
    placements: Vec<Placement>,
    /// True if the scene has only instances and triangles, here and in the objects.
    only_triangles: bool,
    /// True if instances move: rays then go one by one.
    moves: bool,
    /// Index of the first instance among the primitives of the tree.
    first_instance: u32,
}

impl TopLevel {
    /// Builds the hierarchy. Hits on `world` have the instance [`WORLD`]; the others have an index into `instances`,
    /// and their `geom` counts the geometries of the instance's object.
    ///
    /// # Errors
    /// When there are too many primitives, or an instance refers to an object that does not exist.
    pub fn build(world: &[Geometry], objects: Vec<Bvh>, instances: &[Instance]) -> Result<Self, Error> {
        Self::build_by(Builder::default(), world, objects, instances)
    }

    /// Builds the hierarchy with a builder of choice; the objects are there already.
    ///
    /// # Errors
    /// As [`TopLevel::build`].
    pub fn build_by(
        builder: Builder,
        world: &[Geometry],
        objects: Vec<Bvh>,
        instances: &[Instance],
    ) -> Result<Self, Error> {
        let boxes = boxes(&objects, instances)?;
        // Build one tree over world geometry and the boxes of instances.
        let tree = construct::build(&[world, &[Geometry::boxes(&boxes)]].concat(), builder)?;
        Ok(Self {
            first_instance: tree.first[world.len()],
            tree,
            isa: SupportedIsa::best(),
            only_triangles: only_triangles(world, &objects),
            objects,
            moves: instances.iter().any(|i| i.motion.is_some()),
            placements: instances.iter().map(Placement::of).collect(),
        })
    }

    /// Follows world geometry and instances that have moved, see [`Bvh::update`]: whether the shape of the hierarchy
    /// could be kept.
    ///
    /// # Errors
    /// As [`TopLevel::build`]; nothing is changed then.
    pub fn update(&mut self, world: &[Geometry], instances: &[Instance]) -> Result<bool, Error> {
        let boxes = boxes(&self.objects, instances)?;
        // Refit or rebuild, then replace what refers to the old instances.
        let kept = update(&mut self.tree, &[world, &[Geometry::boxes(&boxes)]].concat())?;
        self.first_instance = self.tree.first[world.len()];
        self.placements = instances.iter().map(Placement::of).collect();
        self.moves = instances.iter().any(|i| i.motion.is_some());
        self.only_triangles = only_triangles(world, &self.objects);
        Ok(kept)
    }

    /// The objects, for [`Bvh::update`]. [`TopLevel::update`] must follow, or rays may miss what has left its old box.
    pub fn objects_mut(&mut self) -> &mut [Bvh] {
        &mut self.objects
    }

    /// The box around everything, in world space.
    pub fn bounds(&self) -> Bounds3 {
        self.tree.bounds
    }

    /// Memory of the hierarchy and its objects, in bytes.
    pub fn bytes(&self) -> usize {
        self.tree.bytes() + self.objects.iter().map(Bvh::bytes).sum::<usize>() + size_of_val(&self.placements[..])
    }

    /// The instruction set that queries run on.
    pub fn isa(&self) -> Isa {
        self.isa.get()
    }

    /// Runs queries on another instruction set; one that is not supported changes nothing.
    #[must_use]
    pub fn with_isa(mut self, isa: Isa) -> Self {
        self.isa = self.isa.with_level(isa);
        self.objects = self.objects.into_iter().map(|object| object.with_isa(isa)).collect();
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
    #[inline]
    pub fn intersect<U: UserPrimitives>(&self, ray: &Ray, user: &U) -> Option<Hit> {
        if let Some(world) = self.world_alone(user) {
            return nearest_hit(self.isa, &self.tree, ray, &world).map(|nearest| world.hit(nearest));
        }
        let leaves = Leaves { scene: self, user };
        nearest_hit(self.isa, &self.tree, ray, &leaves).map(|nearest| leaves.hit(nearest))
    }

    /// All hits in `(0, ray.t_max)`, nearest first, and of hits at equal distance the smaller [`PrimId`](crate::PrimId)
    /// first: every triangle that is hit and, where it is filtered, accepted; of a user primitive its nearest hit.
    pub fn all_hits<U: UserPrimitives>(&self, ray: &Ray, user: &U) -> Vec<Hit> {
        // Collect, sort by distance and name, and drop duplicates.
        let mut hits = Vec::new();
        all_hits(self.isa, &self.tree, ray, &Leaves { scene: self, user }, &mut hits);
        hits.sort_unstable_by(|a, b| a.t.total_cmp(&b.t).then(a.id.cmp(&b.id)));
        // A triangle may be in several leaves.
        hits.dedup_by_key(|hit| hit.id);
        hits
    }

    /// The nearest hits of many rays at once, each with the bits of [`TopLevel::intersect`]. Neighbours in the slice
    /// that go nearly the same way are traced together.
    ///
    /// # Panics
    /// When the slices differ in length.
    pub fn intersect_batch<U: UserPrimitives>(&self, rays: &[Ray], user: &U, hits: &mut [Option<Hit>]) {
        match self.world_alone(user) {
            // Instances that move transform each ray by its own time: packets share one transformation and are ruled
            // out.
            None if self.moves => {
                assert_eq!(rays.len(), hits.len(), "one place for each ray");
                rays.iter().zip(hits).for_each(|(ray, hit)| *hit = self.intersect(ray, user));
            }
            Some(world) => nearest_hits(self.isa, &self.tree, rays, &world, hits),
            None => nearest_hits(self.isa, &self.tree, rays, &Leaves { scene: self, user }, hits),
        }
    }

    /// [`TopLevel::occluded`] of many rays at once.
    ///
    /// # Panics
    /// When the slices differ in length.
    pub fn occluded_batch<U: UserPrimitives>(&self, rays: &[Ray], user: &U, occluded: &mut [bool]) {
        match self.world_alone(user) {
            None if self.moves => {
                assert_eq!(rays.len(), occluded.len(), "one place for each ray");
                rays.iter().zip(occluded).for_each(|(ray, is)| *is = self.occluded(ray, user));
            }
            Some(world) => any_hits(self.isa, &self.tree, rays, &world, occluded),
            None => any_hits(self.isa, &self.tree, rays, &Leaves { scene: self, user }, occluded),
        }
    }

    /// [`TopLevel::intersect_batch`] for rays in any order: they are sorted first.
    ///
    /// # Panics
    /// When the slices differ in length.
    pub fn intersect_stream<U: UserPrimitives>(&self, rays: &[Ray], user: &U, hits: &mut [Option<Hit>]) {
        // Sort for coherence, then trace as batches.
        stream::in_order(rays, hits, None, |rays, hits| self.intersect_batch(rays, user, hits));
    }

    /// [`TopLevel::occluded_batch`] for rays in any order: they are sorted first.
    ///
    /// # Panics
    /// When the slices differ in length.
    pub fn occluded_stream<U: UserPrimitives>(&self, rays: &[Ray], user: &U, occluded: &mut [bool]) {
        stream::in_order(rays, occluded, false, |rays, occluded| self.occluded_batch(rays, user, occluded));
    }

    /// The tree that holds a primitive: that over geometry and instances, or an instance's.
    pub(crate) fn tree_of(&self, id: PrimId) -> &Tree {
        match self.placements.get(id.instance as usize) {
            Some(place) => self.objects[place.object as usize].tree(),
            None => &self.tree,
        }
    }

    /// The tree over geometry and instances.
    pub(crate) fn tree(&self) -> &Tree {
        &self.tree
    }

    /// The instance with an index in the tree: its number, its object, and the ray in the object's space.
    pub(crate) fn enter(&self, index: u32, ray: &Ray) -> Option<(u32, &Bvh, Ray)> {
        Leaves { scene: self, user: &() }.enter(index, ray)
    }

    /// True if anything is hit in `(0, ray.t_max)`; `false` for a ray that is not valid.
    #[inline]
    pub fn occluded<U: UserPrimitives>(&self, ray: &Ray, user: &U) -> bool {
        match self.world_alone(user) {
            Some(world) => any_hit(self.isa, &self.tree, ray, &world),
            None => any_hit(self.isa, &self.tree, ray, &Leaves { scene: self, user }),
        }
    }

    /// User leaves of a tree without instances, `None` with any: queries that need not ask for them are faster.
    #[inline(always)]
    fn world_alone<'a, U>(&'a self, user: &'a U) -> Option<ObjectLeaves<'a, U>> {
        self.placements.is_empty().then_some(ObjectLeaves { tree: &self.tree, instance: WORLD, user })
    }
}

/// True if there are only triangles in the world and in all objects.
fn only_triangles(world: &[Geometry], objects: &[Bvh]) -> bool {
    world.iter().all(|geometry| matches!(geometry.shape, Shape::Triangles { .. }))
        && objects.iter().all(|object| object.tree().only_triangles)
}

/// The boxes of instances in world space.
fn boxes(objects: &[Bvh], instances: &[Instance]) -> Result<Vec<Bounds3>, Error> {
    // Refuse instances of objects that do not exist before anything is built.
    for (i, instance) in instances.iter().enumerate() {
        if instance.object as usize >= objects.len() {
            return Err(Error::UnknownObject { instance: i, object: instance.object, objects: objects.len() });
        }
    }
    // Enclose each object by the boxes of its upper nodes: transformed, they are tighter than the root's box alone.
    let outline = |object: &Bvh| Outline::new(&object.tree().upper_boxes(BOXES));
    let outlines: Vec<Outline> = objects.par_iter().map(outline).collect();
    let placed = |i: &Instance| outlines[i.object as usize].of(i);
    Ok(instances.par_iter().map(placed).collect())
}

/// Number of boxes of an object that the box of an instance is made from.
const BOXES: usize = 100;

/// User references of the tree: primitives of the world, and instances behind them.
struct Leaves<'a, U> {
    scene: &'a TopLevel,
    user: &'a U,
}

impl<'a, U> Leaves<'a, U> {
    /// The instance with an index in the tree: its number, its object, and the way to the object's space.
    #[inline(always)]
    fn instance(&self, index: u32) -> Option<(u32, &'a Bvh, &'a Mat4)> {
        // Indices behind those of world geometry are instances.
        let number = index.checked_sub(self.scene.first_instance)?;
        let place = &self.scene.placements[number as usize];
        Some((number, &self.scene.objects[place.object as usize], &place.object_from_world))
    }

    /// The instance with an index in the tree: its number, its object, and the ray in the object's space.
    #[inline(always)]
    fn enter(&self, index: u32, ray: &Ray) -> Option<(u32, &'a Bvh, Ray)> {
        let (number, object, _) = self.instance(index)?;
        let ray = self.scene.placements[number as usize].enter(ray);
        Some((number, object, ray))
    }
}

impl<U: UserPrimitives> UserLeaves for Leaves<'_, U> {
    /// The index of the primitive within the instance's object.
    type Extra = u32;

    #[inline(always)]
    fn triangle(&self) -> u32 {
        0
    }

    #[inline]
    fn intersect(&self, index: u32, ray: &Ray) -> Option<(UserHit, u32)> {
        match self.enter(index, ray) {
            // Descend into the instance with the ray in object space; distances stay the same, as directions are not
            // normalised.
            Some((number, object, ray)) => object.nearest_as(number, &ray, self.user).map(|n| (n.hit, n.index)),
            None => self.user.intersect(self.scene.tree.id(WORLD, index), ray).map(|hit| (hit, 0)),
        }
    }

    #[inline]
    fn occluded(&self, index: u32, ray: &Ray) -> bool {
        match self.enter(index, ray) {
            Some((number, object, ray)) => object.occluded_as(number, &ray, self.user),
            None => self.user.occluded(self.scene.tree.id(WORLD, index), ray),
        }
    }

    #[inline]
    fn accept(&self, index: u32, UserHit { t, u, v }: UserHit, ray: &Ray) -> bool {
        !U::FILTERS || self.user.accept(&Hit { t, u, v, id: self.scene.tree.id(WORLD, index) }, ray)
    }

    fn every(&self, index: u32, ray: &Ray, hits: &mut Vec<Hit>) {
        if let Some((number, object, ray)) = self.enter(index, ray) {
            object.every_as(number, &ray, self.user, hits);
            return;
        }
        let hit = self.intersect(index, ray).filter(|(hit, _)| hit.t > 0.0 && hit.t < ray.t_max);
        hits.extend(hit.map(|(hit, extra)| self.hit(Nearest { hit, index, extra })));
    }

    #[inline(always)]
    fn hit(&self, Nearest { hit: UserHit { t, u, v }, index, extra }: Nearest<u32>) -> Hit {
        let id = match self.instance(index) {
            None => self.scene.tree.id(WORLD, index),
            Some((number, object, _)) => object.tree().id(number, extra),
        };
        Hit { t, u, v, id }
    }

    #[inline(always)]
    fn in_any_order(&self) -> bool {
        self.scene.only_triangles
    }

    fn intersect_packet(&self, isa: SupportedIsa, index: u32, packet: &Packet, lanes: u32, inner: &mut Found) -> bool {
        let Some((instance, object, place)) = self.instance(index) else { return false };
        let leaves = ObjectLeaves { tree: object.tree(), instance, user: self.user };
        // Transform the packet into object space and trace it there as a packet.
        nearest_packet_in(isa, object.tree(), (packet, place), lanes, &leaves, inner);
        true
    }

    fn occluded_packet(&self, isa: SupportedIsa, index: u32, packet: &Packet, lanes: u32) -> Option<u32> {
        let (instance, object, place) = self.instance(index)?;
        let leaves = ObjectLeaves { tree: object.tree(), instance, user: self.user };
        Some(any_packet_in(isa, object.tree(), (packet, place), lanes, &leaves))
    }
}
