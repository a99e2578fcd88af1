//! Input of a hierarchy's construction, and results of its queries.

use steradian_math::{Bounds3, Ray, Vec3};

/// Why a hierarchy could not be built.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// More primitives than child references can address.
    #[error("{count} primitives in one hierarchy are too many: at most {limit} can be addressed")]
    TooManyPrimitives {
        /// Number of primitives.
        count: u64,
        /// Largest number of primitives.
        limit: u64,
    },
    /// An instance names an object that does not exist.
    #[error("instance {instance} refers to object {object}, but there are only {objects} objects")]
    UnknownObject {
        /// Index of the instance.
        instance: usize,
        /// The object it names.
        object: u32,
        /// Number of objects.
        objects: usize,
    },
}

/// The primitives of one geometry.
#[derive(Clone, Copy, Debug)]
pub enum Shape<'a> {
    /// An indexed triangle mesh. Triangles with a vertex that is missing or not finite, or with two equal vertices, are
    /// left out: no ray can hit them.
    Triangles {
        /// Vertex positions.
        positions: &'a [Vec3],
        /// Three vertex indices for each triangle.
        indices: &'a [[u32; 3]],
    },
    /// The bounding boxes of user primitives, which [`UserPrimitives`] intersects. Boxes that are empty or not finite
    /// are left out.
    Boxes(&'a [Bounds3]),
}

/// One geometry of a hierarchy. Its index among the geometries given is [`PrimId::geom`].
#[derive(Clone, Copy, Debug)]
pub struct Geometry<'a> {
    /// Its primitives.
    pub shape: Shape<'a>,
    /// Submits hits on its triangles to [`UserPrimitives::accept`]. Geometries without this flag pay nothing for it.
    pub filtered: bool,
}

impl<'a> Geometry<'a> {
    /// An indexed triangle mesh, not filtered.
    pub fn triangles(positions: &'a [Vec3], indices: &'a [[u32; 3]]) -> Self {
        Self { shape: Shape::Triangles { positions, indices }, filtered: false }
    }

    /// User primitives, given by their bounding boxes.
    pub fn boxes(boxes: &'a [Bounds3]) -> Self {
        Self { shape: Shape::Boxes(boxes), filtered: false }
    }

    /// Sets the flag [`Geometry::filtered`].
    pub fn filtered(self, filtered: bool) -> Self {
        Self { filtered, ..self }
    }

    /// Number of primitives, including those that are left out.
    pub fn len(&self) -> usize {
        match self.shape {
            Shape::Triangles { indices, .. } => indices.len(),
            Shape::Boxes(boxes) => boxes.len(),
        }
    }

    /// True if it has no primitives.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// The value of [`PrimId::instance`] for geometry that is not instanced.
pub const WORLD: u32 = u32::MAX;

/// Names a primitive. The order of fields is the order in which ties are resolved: the smaller one wins.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct PrimId {
    /// Index of the instance, or [`WORLD`].
    pub instance: u32,
    /// Index of the geometry within its hierarchy.
    pub geom: u32,
    /// Index of the primitive within its geometry.
    pub prim: u32,
}

/// A hit of a ray on a primitive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Ray parameter of the hit: `0 < t < ray.t_max`.
    pub t: f32,
    /// For triangles the barycentric coordinate of the second vertex: `p = (1 − u − v) p0 + u p1 + v p2`. For user
    /// primitives what [`UserHit`] said.
    pub u: f32,
    /// For triangles the barycentric coordinate of the third vertex.
    pub v: f32,
    /// Primitive that was hit.
    pub id: PrimId,
}

/// A hit on a user primitive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UserHit {
    /// Ray parameter of the hit.
    pub t: f32,
    /// First surface parameter, handed through to [`Hit::u`].
    pub u: f32,
    /// Second surface parameter, handed through to [`Hit::v`].
    pub v: f32,
}

/// Callbacks of a query. The answers must be pure functions of the arguments.
///
/// Rays given to these functions are in the space of the hierarchy that holds the primitive, with unnormalised
/// directions, so that `t` means the same in every space.
pub trait UserPrimitives {
    /// False if [`accept`](Self::accept) is true for all hits: it is not called then.
    const FILTERS: bool = true;

    /// The nearest hit in `(0, ray.t_max)` on a user primitive. Hits outside of the interval, and NaN, are ignored.
    fn intersect(&self, id: PrimId, ray: &Ray) -> Option<UserHit>;

    /// True if a user primitive has any hit in `(0, ray.t_max)`.
    fn occluded(&self, id: PrimId, ray: &Ray) -> bool {
        self.intersect(id, ray).is_some()
    }

    /// True if a hit on a triangle of a geometry with the flag [`Geometry::filtered`] counts. If not, the ray goes on.
    fn accept(&self, hit: &Hit, ray: &Ray) -> bool {
        let _ = (hit, ray);
        true
    }
}

/// No user primitives, and no filter.
impl UserPrimitives for () {
    const FILTERS: bool = false;

    fn intersect(&self, _: PrimId, _: &Ray) -> Option<UserHit> {
        None
    }
}
