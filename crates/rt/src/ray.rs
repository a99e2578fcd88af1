//! Rays as shaders describe them, and what shaders can read of rays and of what they meet.

use crate::error::RayError;
use crate::flags::{InstanceFlags, RayFlags};
use crate::plan::is_clockwise;
use crate::top_level::{Placed, TopLevel};
use crate::transform::Transform3x4;
use std::fmt;
use steradian_math::{Ray, Vec3};

/// A ray (DXR, "Ray description structure"): points `origin + t·direction`. Triangles are hit where
/// `t_min < t < t_max`, procedural primitives where `t_min <= t <= t_max` (DXR, "Ray extents").
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayDesc {
    /// Origin in world space.
    pub origin: Vec3,
    /// Direction, of any length; `t` is in units of it. A ray with a direction of zero meets nothing.
    pub direction: Vec3,
    /// Start of the interval, at least zero.
    pub t_min: f32,
    /// End of the interval, at least `t_min`; may be infinite.
    pub t_max: f32,
}

impl RayDesc {
    /// A ray from zero to infinity.
    #[inline]
    pub const fn new(origin: Vec3, direction: Vec3) -> Self {
        Self { origin, direction, t_min: 0.0, t_max: f32::INFINITY }
    }

    /// As it is, but with another interval.
    #[must_use]
    pub const fn with_extents(self, t_min: f32, t_max: f32) -> Self {
        Self { t_min, t_max, ..self }
    }

    /// Checks that it keeps the rules.
    #[inline]
    pub(crate) fn check(&self) -> Result<(), RayError> {
        // Where the sum is finite there is no NaN.
        let (o, d) = (self.origin, self.direction);
        let sum = (o.x + o.y + o.z) + (d.x + d.y + d.z);
        let is_common = sum.is_finite() && 0.0 <= self.t_min && self.t_min <= self.t_max;
        if is_common { Ok(()) } else { self.check_each() }
    }

    #[cold]
    fn check_each(&self) -> Result<(), RayError> {
        let Self { t_min, t_max, .. } = *self;
        if self.origin.is_nan() || self.direction.is_nan() || t_min.is_nan() || t_max.is_nan() {
            return Err(RayError::NotANumber);
        }
        if !(0.0 <= t_min && t_min <= t_max) {
            return Err(RayError::Extents { t_min, t_max });
        }
        Ok(())
    }

    /// Ray for the hierarchy, with this end of its interval.
    #[inline]
    pub(crate) fn with_end(&self, t_max: f32) -> Ray {
        Ray { t_max, ..Ray::new(self.origin, self.direction) }
    }
}

/// Values of the current ray that shaders can read (DXR, "Ray system values").
#[derive(Clone, Copy, Debug)]
pub struct RayValues {
    /// `WorldRayOrigin`, `gl_WorldRayOriginEXT`.
    pub origin: Vec3,
    /// `WorldRayDirection`, `gl_WorldRayDirectionEXT`.
    pub direction: Vec3,
    /// `RayTMin`, `gl_RayTminEXT`.
    pub t_min: f32,
    /// `RayTCurrent`, `gl_RayTmaxEXT`: the end of the interval in intersection shaders, the distance of the hit in
    /// any-hit and closest-hit shaders, the end that was asked for in miss shaders.
    pub t_current: f32,
    /// `RayFlags`, `gl_IncomingRayFlagsEXT`.
    pub flags: RayFlags,
}

/// Names a primitive of a top-level structure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize)]
pub struct PrimitiveId {
    /// Index among the instances: `InstanceIndex`, `gl_InstanceID`.
    pub instance: u32,
    /// Index among the geometries of the bottom level: `GeometryIndex`, `gl_GeometryIndexEXT`.
    pub geometry: u32,
    /// Index within the geometry: `PrimitiveIndex`, `gl_PrimitiveID`.
    pub primitive: u32,
}

impl fmt::Display for PrimitiveId {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{}.{}.{}", self.instance, self.geometry, self.primitive)
    }
}

/// A primitive that a ray has met: what shaders can read of it (DXR, "Primitive/object space system values").
#[derive(Clone, Copy, Debug)]
pub struct Primitive<'a> {
    id: PrimitiveId,
    placed: &'a Placed,
    origin: Vec3,
    direction: Vec3,
}

impl<'a> Primitive<'a> {
    #[inline]
    pub(crate) fn new(scene: &'a TopLevel, id: PrimitiveId, ray: &RayDesc) -> Option<Self> {
        let placed = scene.instances.get(id.instance as usize)?;
        Some(Self { id, placed, origin: ray.origin, direction: ray.direction })
    }

    /// All three indices.
    #[inline]
    pub fn id(&self) -> PrimitiveId {
        self.id
    }

    /// `InstanceIndex`, `gl_InstanceID`: the index of the instance in its top-level structure.
    #[inline]
    pub fn instance_index(&self) -> u32 {
        self.id.instance
    }

    /// `InstanceID`, `gl_InstanceCustomIndexEXT`: the caller's number of the instance, 24 bits.
    #[inline]
    pub fn custom_index(&self) -> u32 {
        self.placed.custom_index
    }

    /// Contribution of the instance to the index of hit-group records, 24 bits.
    #[inline]
    pub fn hit_group_offset(&self) -> u32 {
        self.placed.hit_group_offset
    }

    /// `GeometryIndex`, `gl_GeometryIndexEXT`.
    #[inline]
    pub fn geometry_index(&self) -> u32 {
        self.id.geometry
    }

    /// `PrimitiveIndex`, `gl_PrimitiveID`.
    #[inline]
    pub fn primitive_index(&self) -> u32 {
        self.id.primitive
    }

    /// `ObjectRayOrigin`, `gl_ObjectRayOriginEXT`.
    #[inline]
    pub fn object_ray_origin(&self) -> Vec3 {
        self.placed.place.inv.transform_point3(self.origin)
    }

    /// `ObjectRayDirection`, `gl_ObjectRayDirectionEXT`: of any length, so that `t` means the same in both spaces.
    #[inline]
    pub fn object_ray_direction(&self) -> Vec3 {
        self.placed.place.inv.transform_vector3(self.direction)
    }

    /// `ObjectToWorld3x4`, `gl_ObjectToWorldEXT`.
    pub fn object_to_world(&self) -> Transform3x4 {
        Transform3x4::from_mat4(&self.placed.place.m)
    }

    /// `WorldToObject3x4`, `gl_WorldToObjectEXT`.
    pub fn world_to_object(&self) -> Transform3x4 {
        Transform3x4::from_mat4(&self.placed.place.inv)
    }

    /// A normal of object space in world space, of unit length: the inverse transpose of object-to-world takes normals
    /// to normals. `None` where the normal is zero.
    pub fn world_normal(&self, object_normal: Vec3) -> Option<Vec3> {
        self.placed.place.normal(object_normal).try_normalize()
    }

    /// Which face of the triangle the ray meets.
    pub(crate) fn face(&self) -> HitKind {
        let counterclockwise = self.placed.flags.contains(InstanceFlags::TRIANGLE_FRONT_COUNTERCLOCKWISE);
        let direction = self.object_ray_direction();
        let is_clockwise = self.triangle().is_some_and(|corners| is_clockwise(&corners, direction));
        HitKind::triangle(is_clockwise != counterclockwise)
    }

    /// The vertices of the triangle in object space; `None` for procedural primitives (`TriangleObjectPositions`;
    /// Vulkan, "Ray Tracing Position Fetch").
    pub fn triangle(&self) -> Option<[Vec3; 3]> {
        self.placed.bottom_level.triangle(self.id.geometry, self.id.primitive)
    }
}

/// Kind of a hit: one reported by an intersection shader, with a number of its own, or one on a triangle (DXR,
/// "HitKind").
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct HitKind(u8);

impl HitKind {
    /// A triangle that shows its front.
    pub const TRIANGLE_FRONT_FACE: Self = Self(254);
    /// A triangle that shows its back.
    pub const TRIANGLE_BACK_FACE: Self = Self(255);

    /// The kind of a procedural hit; `None` above 127.
    pub const fn procedural(kind: u8) -> Option<Self> {
        if kind <= 127 { Some(Self(kind)) } else { None }
    }

    /// The kind of a hit on a triangle.
    pub(crate) const fn triangle(is_front: bool) -> Self {
        if is_front { Self::TRIANGLE_FRONT_FACE } else { Self::TRIANGLE_BACK_FACE }
    }

    /// The number: up to 127 for procedural hits, 254 and 255 for triangles.
    #[inline]
    pub const fn get(self) -> u8 {
        self.0
    }

    /// True for a hit on a triangle.
    #[inline]
    pub const fn is_triangle(self) -> bool {
        self.0 >= 254
    }
}

/// Barycentric coordinates of a hit on a triangle: `p = (1 − u − v) p0 + u p1 + v p2` (DXR,
/// "BuiltInTriangleIntersectionAttributes").
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Barycentrics {
    /// Weight of the second vertex.
    pub u: f32,
    /// Weight of the third vertex.
    pub v: f32,
}

impl Barycentrics {
    /// The sum of three values at the vertices by their weights.
    #[inline]
    pub fn interpolate(&self, [a, b, c]: [Vec3; 3]) -> Vec3 {
        a * (1.0 - self.u - self.v) + b * self.u + c * self.v
    }
}
