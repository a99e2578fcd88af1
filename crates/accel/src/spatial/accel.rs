//! The choice of a structure.

use super::hierarchy::{Query, cost};
use super::items::slack;
use super::partition::Partition;
use super::scene::PartitionedScene;
use super::search::Steps;
use crate::levels;
use crate::{Builder, Bvh, Error, Geometry, Hit, Instance, PrimId, TopLevel, UserPrimitives};
use steradian_math::{Bounds3, Ray, Vec3};

/// A structure by name.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Accelerator {
    /// The hierarchy of bounding volumes ([`TopLevel`]), the fast one.
    #[default]
    Bvh,
    /// The hierarchy of bounding volumes, optimised by moving subtrees.
    BvhReinsertion,
    /// The hierarchy of bounding volumes with spatial splits, which cut triangles.
    BvhSpatial,
    /// The hierarchy of bounding volumes, built from the leaves up (PLOC).
    BvhPloc,
    /// A hierarchy two wide.
    Bvh2,
    /// A hierarchy four wide.
    Bvh4,
    /// A hierarchy sixteen wide.
    Bvh16,
    /// An eight-wide hierarchy with boxes in eight bits for each plane.
    BvhQuantised,
    /// A uniform grid.
    Grid,
    /// An octree.
    Octree,
    /// A k-d tree by the surface area heuristic.
    KdTree,
    /// A k-d tree by the surface area heuristic, walked along ropes.
    KdTreeRopes,
    /// A k-d tree with planes through the median.
    KdTreeMedian,
    /// A binary space partition.
    Bsp,
    /// Every ray tests every primitive.
    None,
}

impl Accelerator {
    /// All of them.
    pub const ALL: [Self; 15] = [
        Self::Bvh,
        Self::BvhReinsertion,
        Self::BvhSpatial,
        Self::BvhPloc,
        Self::Bvh2,
        Self::Bvh4,
        Self::Bvh16,
        Self::BvhQuantised,
        Self::Grid,
        Self::Octree,
        Self::KdTree,
        Self::KdTreeRopes,
        Self::KdTreeMedian,
        Self::Bsp,
        Self::None,
    ];

    /// Its name and what it is.
    pub fn about(self) -> (&'static str, &'static str) {
        match self {
            Self::Bvh => ("bvh", "8-wide bounding volume hierarchy, the default"),
            Self::BvhReinsertion => ("bvh-reinsertion", "the same, optimised by moving subtrees: slower to build"),
            Self::BvhSpatial => {
                ("bvh-spatial", "the same, where triangles may be cut: for long ones and uneven meshes")
            }
            Self::BvhPloc => ("bvh-ploc", "the same, built from the leaves up"),
            Self::Bvh2 => ("bvh2", "2-wide hierarchy, without SIMD"),
            Self::Bvh4 => ("bvh4", "4-wide hierarchy, without SIMD"),
            Self::Bvh16 => ("bvh16", "16-wide hierarchy, without SIMD"),
            Self::BvhQuantised => {
                ("bvh-quantised", "8-wide hierarchy, boxes in 8 bits a plane: the smallest, without SIMD")
            }
            Self::Grid => ("grid", "uniform grid, walked by a 3-D DDA"),
            Self::Octree => ("octree", "octree, walked from neighbour to neighbour"),
            Self::KdTree => ("kdtree", "k-d tree by the surface area heuristic, walked with a stack"),
            Self::KdTreeRopes => ("kdtree-ropes", "k-d tree by the surface area heuristic, walked along ropes"),
            Self::KdTreeMedian => ("kdtree-median", "k-d tree through medians, walked with a stack"),
            Self::Bsp => ("bsp", "binary space partition along the planes of polygons"),
            Self::None => ("none", "every ray tests every primitive"),
        }
    }

    /// Builder of the eight-wide hierarchy; `None` for other structures.
    pub fn builder(self) -> Option<Builder> {
        match self {
            Self::Bvh => Some(Builder::Sah),
            Self::BvhReinsertion => Some(Builder::Reinsertion),
            Self::BvhSpatial => Some(Builder::Spatial),
            Self::BvhPloc => Some(Builder::Ploc),
            _ => None,
        }
    }

    /// The structure with a name.
    pub fn by_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|a| a.about().0 == name)
    }
}

/// The structure over the geometries of one space that instances place.
#[derive(Clone, Debug)]
pub enum Object {
    /// The hierarchy.
    Bvh(Bvh),
    /// Another structure.
    Partition(Box<Partition>),
}

impl Object {
    /// Builds it.
    ///
    /// # Errors
    /// When there are too many primitives.
    pub fn build(accelerator: Accelerator, geometries: &[Geometry]) -> Result<Self, Error> {
        Ok(match accelerator.builder() {
            Some(builder) => Self::Bvh(Bvh::build_by(builder, geometries)?),
            None => Self::Partition(Box::new(Partition::build(accelerator, geometries)?)),
        })
    }

    /// The box around all primitives; empty when there are none.
    pub fn bounds(&self) -> Bounds3 {
        match self {
            Self::Bvh(bvh) => bvh.bounds(),
            Self::Partition(partition) => partition.bounds(),
        }
    }
}

/// A structure over a scene, for queries.
#[derive(Clone, Debug)]
pub enum Accel {
    /// The hierarchy.
    Bvh(TopLevel),
    /// Another structure.
    Partition(Box<PartitionedScene>),
}

impl Accel {
    /// Builds the structure over geometry in world space and instances of objects. Objects of another kind than
    /// `accelerator` are an error only if they are instanced.
    ///
    /// # Errors
    /// When there are too many primitives, or an instance refers to an object that does not exist.
    pub fn build(
        accelerator: Accelerator,
        world: &[Geometry],
        objects: Vec<Object>,
        instances: &[Instance],
    ) -> Result<Self, Error> {
        if let Some(builder) = accelerator.builder() {
            let objects = objects.into_iter().map_while(|o| if let Object::Bvh(o) = o { Some(o) } else { None });
            return Ok(Self::Bvh(TopLevel::build_by(builder, world, objects.collect(), instances)?));
        }
        let objects = objects.into_iter().map_while(|o| if let Object::Partition(o) = o { Some(*o) } else { None });
        Ok(Self::Partition(Box::new(PartitionedScene::build(accelerator, world, objects.collect(), instances)?)))
    }

    /// The hierarchy, if it is that.
    pub fn as_bvh(&self) -> Option<&TopLevel> {
        if let Self::Bvh(top) = self { Some(top) } else { None }
    }

    /// The box around everything, in world space.
    pub fn bounds(&self) -> Bounds3 {
        match self {
            Self::Bvh(top) => top.bounds(),
            Self::Partition(scene) => scene.bounds(),
        }
    }

    /// Boxes of the nodes at a level below the root, of leaves above that level, and of cells of the grid from level 1 on;
    /// without leaves that hold nothing. Instances are leaves. `None` for a BSP, whose cells are no boxes.
    pub fn boxes(&self, level: u32) -> Option<Vec<Bounds3>> {
        match self {
            Self::Bvh(top) => Some(levels::boxes(top.tree(), level)),
            Self::Partition(scene) => scene.boxes(level),
        }
    }

    /// Number of the leaf, among those of its space, that holds a point of a primitive; the point is in the space of the
    /// primitive. In a BSP, whose planes are those of polygons, it is the cell on the side towards a direction. `None`
    /// for points that are not on the primitive.
    pub fn cell(&self, id: PrimId, p: Vec3, towards: Vec3) -> Option<u32> {
        match self {
            Self::Bvh(top) => {
                let tree = top.tree_of(id);
                levels::leaf(tree, tree.index(id), p, slack(&tree.bounds))
            }
            Self::Partition(scene) => scene.cell(id, p, towards),
        }
    }

    /// Memory in bytes.
    pub fn bytes(&self) -> usize {
        match self {
            Self::Bvh(top) => top.bytes(),
            Self::Partition(scene) => scene.bytes(),
        }
    }

    /// The nearest hit in `(0, ray.t_max)`; `None` for a ray that is not valid.
    #[inline]
    pub fn intersect<U: UserPrimitives>(&self, ray: &Ray, user: &U) -> Option<Hit> {
        match self {
            Self::Bvh(top) => top.intersect(ray, user),
            Self::Partition(scene) => intersect(scene, ray, user),
        }
    }

    /// True if anything is hit in `(0, ray.t_max)`; `false` for a ray that is not valid.
    #[inline]
    pub fn occluded<U: UserPrimitives>(&self, ray: &Ray, user: &U) -> bool {
        match self {
            Self::Bvh(top) => top.occluded(ray, user),
            Self::Partition(scene) => occluded(scene, ray, user),
        }
    }

    /// [`TopLevel::intersect_batch`]; other structures take one ray after another.
    ///
    /// # Panics
    /// When the slices differ in length.
    pub fn intersect_batch<U: UserPrimitives>(&self, rays: &[Ray], user: &U, hits: &mut [Option<Hit>]) {
        match self {
            Self::Bvh(top) => top.intersect_batch(rays, user, hits),
            Self::Partition(scene) => {
                assert_eq!(rays.len(), hits.len(), "one place for each ray");
                rays.iter().zip(hits).for_each(|(ray, hit)| *hit = intersect(scene, ray, user));
            }
        }
    }

    /// [`TopLevel::occluded_batch`]; other structures take one ray after another.
    ///
    /// # Panics
    /// When the slices differ in length.
    pub fn occluded_batch<U: UserPrimitives>(&self, rays: &[Ray], user: &U, found: &mut [bool]) {
        match self {
            Self::Bvh(top) => top.occluded_batch(rays, user, found),
            Self::Partition(scene) => {
                assert_eq!(rays.len(), found.len(), "one place for each ray");
                rays.iter().zip(found).for_each(|(ray, found)| *found = occluded(scene, ray, user));
            }
        }
    }

    /// [`TopLevel::intersect_stream`]; other structures take one ray after another.
    ///
    /// # Panics
    /// When the slices differ in length.
    pub fn intersect_stream<U: UserPrimitives>(&self, rays: &[Ray], user: &U, hits: &mut [Option<Hit>]) {
        match self {
            Self::Bvh(top) => top.intersect_stream(rays, user, hits),
            Self::Partition(_) => self.intersect_batch(rays, user, hits),
        }
    }

    /// [`TopLevel::occluded_stream`]; other structures take one ray after another.
    ///
    /// # Panics
    /// When the slices differ in length.
    pub fn occluded_stream<U: UserPrimitives>(&self, rays: &[Ray], user: &U, found: &mut [bool]) {
        match self {
            Self::Bvh(top) => top.occluded_stream(rays, user, found),
            Self::Partition(_) => self.occluded_batch(rays, user, found),
        }
    }

    /// Cost of [`Accel::intersect`]. In the hierarchy, nodes and blocks are steps, and each triangle of a block is a
    /// test.
    pub fn intersect_cost<U: UserPrimitives>(&self, ray: &Ray, user: &U) -> Steps {
        match self {
            Self::Bvh(top) => cost(top, Query::Nearest, ray, user),
            Self::Partition(scene) => scene.intersect(ray, user, Steps::default()).1,
        }
    }

    /// Cost of [`Accel::occluded`].
    pub fn occluded_cost<U: UserPrimitives>(&self, ray: &Ray, user: &U) -> Steps {
        match self {
            Self::Bvh(top) => cost(top, Query::Any, ray, user),
            Self::Partition(scene) => scene.occluded(ray, user, Steps::default()).1,
        }
    }
}

/// Apart, so that it does not weigh on those who have a hierarchy.
#[cold]
#[inline(never)]
fn intersect<U: UserPrimitives>(scene: &PartitionedScene, ray: &Ray, user: &U) -> Option<Hit> {
    scene.intersect(ray, user, ()).0
}

/// As above.
#[cold]
#[inline(never)]
fn occluded<U: UserPrimitives>(scene: &PartitionedScene, ray: &Ray, user: &U) -> bool {
    scene.occluded(ray, user, ()).0
}
