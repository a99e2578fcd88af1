//! Two levels: world-space geometry and instances of other hierarchies, in one tree.

use crate::bvh::Tree;
use crate::dispatch::{SupportedIsa, any_hit, nearest_hit};
use crate::geometry::WORLD;
use crate::traverse::Users;
use crate::{Bvh, Error, Geometry, Hit, Isa, PrimId, UserHit, UserPrimitives, build};
use steradian_math::{Bounds3, Ray, Vec3, transform::Affine};

/// A placement of an object. Instances whose transform is not finite are left out.
#[derive(Clone, Copy, Debug)]
pub struct Instance {
    /// Index among the objects of the [`TopLevel`].
    pub object: u32,
    /// Where it is placed.
    pub world_from_object: Affine,
}

/// World-space geometry and instances of objects. The instances are user primitives of the tree over the geometry, so that both
/// are visited in the order of distance, and a scene without instances costs what its [`Bvh`] costs.
#[derive(Clone, Debug)]
pub struct TopLevel {
    tree: Tree,
    isa: SupportedIsa,
    objects: Vec<Bvh>,
    instances: Vec<Instance>,
    /// Index of the first instance among the primitives of the tree.
    first_instance: u32,
}

impl TopLevel {
    /// Builds the hierarchy. Hits on `world` have the instance [`WORLD`]; the others have an index into `instances`, and
    /// their `geom` counts the geometries of the instance's object.
    ///
    /// # Errors
    /// When there are too many primitives, or an instance refers to an object that does not exist.
    pub fn build(world: &[Geometry], objects: Vec<Bvh>, instances: &[Instance]) -> Result<Self, Error> {
        let boxes = instances
            .iter()
            .enumerate()
            .map(|(i, instance)| {
                let unknown = Error::UnknownObject { instance: i, object: instance.object, objects: objects.len() };
                let object = objects.get(instance.object as usize).ok_or(unknown)?;
                Ok(world_box(object, &instance.world_from_object))
            })
            .collect::<Result<Vec<_>, _>>()?;
        let mut geometries = world.to_vec();
        geometries.push(Geometry::boxes(&boxes));
        let tree = build::build(&geometries)?;
        let first_instance = tree.first[world.len()];
        Ok(Self { tree, isa: SupportedIsa::best(), objects, instances: instances.to_vec(), first_instance })
    }

    /// The box around everything, in world space.
    pub fn bounds(&self) -> Bounds3 {
        self.tree.bounds
    }

    /// Memory of the hierarchy and its objects, in bytes.
    pub fn bytes(&self) -> usize {
        self.tree.bytes() + self.objects.iter().map(Bvh::bytes).sum::<usize>() + size_of_val(&self.instances[..])
    }

    /// The instruction set that queries run on.
    pub fn isa(&self) -> Isa {
        self.isa.get()
    }

    /// Runs queries on another instruction set; one that is not supported changes nothing.
    #[must_use]
    pub fn with_isa(mut self, isa: Isa) -> Self {
        self.isa = SupportedIsa::new(isa).unwrap_or(self.isa);
        self.objects = self.objects.into_iter().map(|object| object.with_isa(isa)).collect();
        self
    }

    /// The nearest hit in `(0, ray.t_max)`; `None` for a ray that is not valid.
    #[inline]
    pub fn intersect<U: UserPrimitives>(&self, ray: &Ray, user: &U) -> Option<Hit> {
        let nearest = nearest_hit(self.isa, &self.tree, ray, &Leaves { scene: self, user })?;
        let UserHit { t, u, v } = nearest.hit;
        Some(Hit { t, u, v, id: nearest.extra.unwrap_or_else(|| self.world_id(nearest.index)) })
    }

    /// Whether anything is hit in `(0, ray.t_max)`; `false` for a ray that is not valid.
    #[inline]
    pub fn occluded<U: UserPrimitives>(&self, ray: &Ray, user: &U) -> bool {
        any_hit(self.isa, &self.tree, ray, &Leaves { scene: self, user })
    }

    /// The name of a primitive that is not instanced.
    fn world_id(&self, index: u32) -> PrimId {
        let (geom, prim) = self.tree.locate(index);
        PrimId { instance: WORLD, geom, prim }
    }
}

/// A box in world space that contains an instance, and every point where a ray that was transformed to object space may hit it.
fn world_box(object: &Bvh, world_from_object: &Affine) -> Bounds3 {
    let object_from_world = world_from_object.inverse();
    let corners = object.root_boxes().flat_map(|b| (0..8).map(move |i| b.corner(i)));
    let bounds = corners.fold(Bounds3::EMPTY, |bounds, p| {
        let q = world_from_object.point(p);
        // Rounding of the ray's way to object space, seen from the world.
        let error = world_from_object.point_error(p, object_from_world.point_error(q, Vec3::ZERO) * 2.0);
        bounds.union_point(q - error).union_point(q + error)
    });
    let finite = world_from_object.m.is_finite() && object_from_world.m.is_finite();
    if finite { bounds } else { Bounds3::EMPTY }
}

/// What is at the user references of the tree: primitives of the world, and instances behind them.
struct Leaves<'a, U> {
    scene: &'a TopLevel,
    user: &'a U,
}

impl<'a, U> Leaves<'a, U> {
    /// The instance with an index in the tree: its number, its object, and the ray in the object's space.
    #[inline]
    fn enter(&self, index: u32, ray: &Ray) -> Option<(u32, &'a Bvh, Ray)> {
        let number = index.checked_sub(self.scene.first_instance)?;
        let instance = &self.scene.instances[number as usize];
        let object_ray = instance.world_from_object.inverse().ray(ray);
        Some((number, &self.scene.objects[instance.object as usize], object_ray))
    }
}

impl<U: UserPrimitives> Users for Leaves<'_, U> {
    type Extra = Option<PrimId>;

    fn triangle(&self) -> Option<PrimId> {
        None
    }

    fn intersect(&self, index: u32, ray: &Ray) -> Option<(UserHit, Option<PrimId>)> {
        let Some((number, object, object_ray)) = self.enter(index, ray) else {
            return self.user.intersect(self.scene.world_id(index), ray).map(|hit| (hit, None));
        };
        let Hit { t, u, v, id } = object.intersect_as(number, &object_ray, self.user)?;
        Some((UserHit { t, u, v }, Some(id)))
    }

    fn occluded(&self, index: u32, ray: &Ray) -> bool {
        match self.enter(index, ray) {
            Some((number, object, object_ray)) => object.occluded_as(number, &object_ray, self.user),
            None => self.user.occluded(self.scene.world_id(index), ray),
        }
    }

    fn accept(&self, index: u32, UserHit { t, u, v }: UserHit, ray: &Ray) -> bool {
        self.user.accept(&Hit { t, u, v, id: self.scene.world_id(index) }, ray)
    }
}
