//! Two levels: world-space geometry and instances of other hierarchies, in one tree.

use crate::{Bvh, Error, Geometry, Hit, Isa, UserPrimitives};
use steradian_math::{Bounds3, Ray, transform::Affine};

/// A placement of an object. Instances whose transform is not finite are left out.
#[derive(Clone, Copy, Debug)]
pub struct Instance {
    /// Index among the objects of the [`TopLevel`].
    pub object: u32,
    /// Where it is placed.
    pub world_from_object: Affine,
}

/// World-space geometry and instances of objects.
#[derive(Clone, Debug)]
pub struct TopLevel {
    tree: Bvh,
    objects: Vec<Bvh>,
    instances: Vec<Instance>,
}

impl TopLevel {
    /// Builds the hierarchy. Hits on `world` have the instance [`crate::WORLD`]; the others have an index into `instances`, and
    /// their `geom` counts the geometries of the instance's object.
    ///
    /// # Errors
    /// When there are too many primitives, or an instance refers to an object that does not exist.
    pub fn build(world: &[Geometry], objects: Vec<Bvh>, instances: &[Instance]) -> Result<Self, Error> {
        Ok(Self { tree: Bvh::build(world)?, objects, instances: instances.to_vec() })
    }

    /// The box around everything, in world space.
    pub fn bounds(&self) -> Bounds3 {
        self.tree.bounds()
    }

    /// Memory of the hierarchy and its objects, in bytes.
    pub fn bytes(&self) -> usize {
        self.tree.bytes() + self.objects.iter().map(Bvh::bytes).sum::<usize>() + size_of_val(&self.instances[..])
    }

    /// Runs queries on another instruction set; one that is not supported changes nothing.
    #[must_use]
    pub fn with_isa(mut self, isa: Isa) -> Self {
        self.tree = self.tree.with_isa(isa);
        self.objects = self.objects.into_iter().map(|o| o.with_isa(isa)).collect();
        self
    }

    /// The nearest hit in `(0, ray.t_max)`; `None` for a ray that is not valid.
    pub fn intersect<U: UserPrimitives>(&self, ray: &Ray, user: &U) -> Option<Hit> {
        self.tree.intersect(ray, user)
    }

    /// Whether anything is hit in `(0, ray.t_max)`; `false` for a ray that is not valid.
    pub fn occluded<U: UserPrimitives>(&self, ray: &Ray, user: &U) -> bool {
        self.tree.occluded(ray, user)
    }
}
