//! World-space geometry and instances in one partition, as [`crate::TopLevel`] has them in one hierarchy.

use super::accel::Accelerator;
use super::partition::Partition;
use super::search::{Steps, Tally};
use crate::geometry::WORLD;
use crate::leaves::UserLeaves;
use crate::nearest::Nearest;
use crate::outline::Outline;
use crate::placement::Placement;
use crate::{Error, Geometry, Hit, Instance, PrimId, UserHit, UserPrimitives};
use std::cell::Cell;
use steradian_math::{Bounds3, Ray, Vec3};

/// Geometry and instances of objects.
#[derive(Clone, Debug)]
pub struct PartitionedScene {
    world: Partition,
    objects: Vec<Partition>,
    placements: Vec<Placement>,
    /// Index of the first instance among the primitives of the world.
    first_instance: u32,
}

impl PartitionedScene {
    /// Builds the structure over everything.
    pub(super) fn build(
        accelerator: Accelerator,
        world: &[Geometry],
        objects: Vec<Partition>,
        instances: &[Instance],
    ) -> Result<Self, Error> {
        for (i, instance) in instances.iter().enumerate() {
            if instance.object as usize >= objects.len() {
                return Err(Error::UnknownObject { instance: i, object: instance.object, objects: objects.len() });
            }
        }
        // Box of an instance in world space, over its whole motion.
        let bounds = |i: &Instance| {
            let bounds = objects[i.object as usize].bounds();
            if bounds.is_empty() { Bounds3::EMPTY } else { Outline::new(&[bounds]).of(i) }
        };
        let boxes: Vec<Bounds3> = instances.iter().map(bounds).collect();
        // Instances are appended to the world's geometries as boxes.
        let mut geometries = world.to_vec();
        geometries.push(Geometry::boxes(&boxes));
        let partition = Partition::build(accelerator, &geometries)?;
        Ok(Self {
            first_instance: partition.items().first[world.len()],
            world: partition,
            objects,
            placements: instances.iter().map(Placement::of).collect(),
        })
    }

    /// The box around everything, in world space.
    pub fn bounds(&self) -> Bounds3 {
        self.world.bounds()
    }

    /// Boxes at a level of the structure of the world, where instances are primitives.
    pub(super) fn boxes(&self, level: u32) -> Option<Vec<Bounds3>> {
        self.world.boxes(level)
    }

    /// Number of the leaf of a point; see [`Partition::cell`].
    pub(super) fn cell(&self, id: PrimId, p: Vec3, towards: Vec3) -> Option<u32> {
        let partition = match self.placements.get(id.instance as usize) {
            Some(place) => &self.objects[place.object as usize],
            None => &self.world,
        };
        partition.cell(partition.items().first[id.geom as usize] + id.prim, p, towards)
    }

    /// Memory in bytes.
    pub fn bytes(&self) -> usize {
        let objects = self.objects.iter().map(Partition::bytes).sum::<usize>();
        self.world.bytes() + objects + size_of_val(&self.placements[..])
    }

    /// The nearest hit, and what it cost.
    pub(super) fn intersect<U: UserPrimitives, T: Tally + Total>(
        &self,
        ray: &Ray,
        user: &U,
        tally: T,
    ) -> (Option<Hit>, T) {
        let leaves = Leaves { scene: self, user, below: Cell::new(T::default()) };
        let (nearest, tally) = self.world.nearest(ray, &leaves, tally);
        (nearest.map(|nearest| leaves.hit(nearest)), tally.plus(leaves.below.take()))
    }

    /// True if anything is hit, and the cost of the query.
    pub(super) fn occluded<U: UserPrimitives, T: Tally + Total>(&self, ray: &Ray, user: &U, tally: T) -> (bool, T) {
        let leaves = Leaves { scene: self, user, below: Cell::new(T::default()) };
        let (found, tally) = self.world.any(ray, &leaves, tally);
        (found, tally.plus(leaves.below.take()))
    }
}

#[cfg(test)]
impl PartitionedScene {
    /// True if the leaf of a number lists a primitive of the world, in a box with a property.
    pub(super) fn holds(&self, id: PrimId, cell: u32, is_in: impl Fn(Bounds3) -> bool) -> bool {
        self.world.holds(self.world.items().first[id.geom as usize] + id.prim, cell, is_in)
    }
}

/// Tallies that can be added.
pub(super) trait Total: Default + Copy {
    /// The sum.
    fn plus(self, other: Self) -> Self;
}

impl Total for () {
    fn plus(self, (): ()) {}
}

impl Total for Steps {
    fn plus(self, other: Self) -> Self {
        Self { steps: self.steps + other.steps, tests: self.tests + other.tests }
    }
}

/// User primitives of the world: those of the caller, and instances.
struct Leaves<'a, U, T> {
    scene: &'a PartitionedScene,
    user: &'a U,
    /// Cost of the walks through instances.
    below: Cell<T>,
}

impl<'a, U, T: Tally + Total> Leaves<'a, U, T> {
    /// The instance with an index: its number, its object, and the ray in the object's space.
    fn enter(&self, index: u32, ray: &Ray) -> Option<(u32, &'a Partition, Ray)> {
        // Indices behind the world's own primitives are instances.
        let number = index.checked_sub(self.scene.first_instance)?;
        let place = &self.scene.placements[number as usize];
        Some((number, &self.scene.objects[place.object as usize], place.enter(ray)))
    }

    fn id(&self, index: u32) -> PrimId {
        self.scene.world.items().id(WORLD, index)
    }
}

impl<U: UserPrimitives, T: Tally + Total> UserLeaves for Leaves<'_, U, T> {
    type Extra = u32;

    fn triangle(&self) -> u32 {
        0
    }

    fn intersect(&self, index: u32, ray: &Ray) -> Option<(UserHit, u32)> {
        let Some((instance, object, ray)) = self.enter(index, ray) else {
            return self.user.intersect(self.id(index), ray).map(|hit| (hit, 0));
        };
        // Trace the object with the transformed ray; the cost is added to that of the query.
        let (nearest, below) =
            object.nearest(&ray, &ObjectLeaves { object, instance, user: self.user }, self.below.get());
        self.below.set(below);
        nearest.map(|n| (n.hit, n.index))
    }

    fn occluded(&self, index: u32, ray: &Ray) -> bool {
        let Some((instance, object, ray)) = self.enter(index, ray) else {
            return self.user.occluded(self.id(index), ray);
        };
        let (found, below) = object.any(&ray, &ObjectLeaves { object, instance, user: self.user }, self.below.get());
        self.below.set(below);
        found
    }

    fn accept(&self, index: u32, UserHit { t, u, v }: UserHit, ray: &Ray) -> bool {
        self.user.accept(&Hit { t, u, v, id: self.id(index) }, ray)
    }

    fn hit(&self, Nearest { hit: UserHit { t, u, v }, index, extra }: Nearest<u32>) -> Hit {
        let id = match index.checked_sub(self.scene.first_instance) {
            None => self.id(index),
            Some(instance) => {
                let object = self.scene.placements[instance as usize].object;
                self.scene.objects[object as usize].items().id(instance, extra)
            }
        };
        Hit { t, u, v, id }
    }
}

/// The user primitives of an object.
struct ObjectLeaves<'a, U> {
    object: &'a Partition,
    instance: u32,
    user: &'a U,
}

impl<U: UserPrimitives> UserLeaves for ObjectLeaves<'_, U> {
    type Extra = ();

    fn triangle(&self) {}

    fn intersect(&self, index: u32, ray: &Ray) -> Option<(UserHit, ())> {
        self.user.intersect(self.object.items().id(self.instance, index), ray).map(|hit| (hit, ()))
    }

    fn occluded(&self, index: u32, ray: &Ray) -> bool {
        self.user.occluded(self.object.items().id(self.instance, index), ray)
    }

    fn accept(&self, index: u32, UserHit { t, u, v }: UserHit, ray: &Ray) -> bool {
        self.user.accept(&Hit { t, u, v, id: self.object.items().id(self.instance, index) }, ray)
    }

    fn hit(&self, Nearest { hit: UserHit { t, u, v }, index, .. }: Nearest<()>) -> Hit {
        Hit { t, u, v, id: self.object.items().id(self.instance, index) }
    }
}
