//! What can be wrong with structures: each value names the rule that was broken, and the numbers.

use crate::flags::{ExclusiveRayFlags, InstanceFlags};

/// Why a structure cannot be built or updated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BuildError {
    /// The number of corners is no multiple of three.
    #[error(
        "geometry {geometry} has {corners} corners: three make a triangle (DXR, D3D12_RAYTRACING_GEOMETRY_TRIANGLES_DESC)"
    )]
    IncompleteTriangle {
        /// Index of the geometry.
        geometry: usize,
        /// How many indices, or vertices where there are no indices.
        corners: usize,
    },
    /// A triangle names a vertex that does not exist.
    #[error("triangle {triangle} of geometry {geometry} names vertex {index}, but there are only {vertices} vertices")]
    VertexIndex {
        /// Index of the geometry.
        geometry: usize,
        /// Index of the triangle.
        triangle: usize,
        /// The index that it names.
        index: u32,
        /// How many vertices there are.
        vertices: usize,
    },
    /// The transform of a geometry is singular, or has a number that is not finite.
    #[error(
        "the transform of geometry {geometry} has no inverse: its first three columns must be invertible (Vulkan, VkTransformMatrixKHR)"
    )]
    GeometryTransform {
        /// Index of the geometry.
        geometry: usize,
    },
    /// The transform of an instance is singular, or has a number that is not finite.
    #[error(
        "the transform of instance {instance} has no inverse: its first three columns must be invertible (Vulkan, VkTransformMatrixKHR)"
    )]
    InstanceTransform {
        /// Index of the instance.
        instance: usize,
    },
    /// A number of an instance has more than 24 bits.
    #[error("{field} {value} of instance {instance} has more than 24 bits (DXR, D3D12_RAYTRACING_INSTANCE_DESC)")]
    InstanceBits {
        /// Index of the instance.
        instance: usize,
        /// Which number.
        field: &'static str,
        /// Its value.
        value: u32,
    },
    /// Two flags of an instance exclude each other.
    #[error("flags {flags} of instance {instance} exclude each other (DXR, D3D12_RAYTRACING_INSTANCE_FLAGS)")]
    ExclusiveInstanceFlags {
        /// Index of the instance.
        instance: usize,
        /// Its flags.
        flags: InstanceFlags,
    },
    /// More geometries, primitives or instances than a structure may have.
    #[error("{count} {what} are too many: at most {limit} are allowed (DXR, \"Geometry limits\")")]
    TooMany {
        /// What there are too many of.
        what: &'static str,
        /// How many there are.
        count: u64,
        /// How many there may be.
        limit: u64,
    },
    /// A structure that was not built for updates cannot be updated.
    #[error("the structure was built without ALLOW_UPDATE (DXR, D3D12_RAYTRACING_ACCELERATION_STRUCTURE_BUILD_FLAGS)")]
    UpdateNotAllowed,
    /// An update changes what it may not change.
    #[error(
        "an update may not change {what} of geometry {geometry} (DXR, \"Bottom-level acceleration structure updates\")"
    )]
    UpdateChanges {
        /// What has changed.
        what: &'static str,
        /// Index of the geometry.
        geometry: usize,
    },
    /// An update changes how many there are.
    #[error(
        "an update may not change the number of {what}: {before} before, {now} now (DXR, \"Acceleration structure update constraints\")"
    )]
    UpdateCount {
        /// What has been counted.
        what: &'static str,
        /// How many there were.
        before: usize,
        /// How many there are.
        now: usize,
    },
    /// An update makes a primitive active that was not, or the other way round.
    #[error(
        "an update may not change whether primitive {primitive} of geometry {geometry} is active (DXR, \"Inactive primitives and instances\")"
    )]
    UpdateActivity {
        /// Index of the geometry.
        geometry: usize,
        /// Index of the primitive.
        primitive: usize,
    },
}

/// Why a ray cannot be traced.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RayError {
    /// A number of the ray is NaN.
    #[error("a number of the ray is NaN (DXR, \"Ray extents\")")]
    NotANumber,
    /// The interval of the ray is none.
    #[error("t_min {t_min} and t_max {t_max} break 0 <= t_min <= t_max (DXR, \"Ray extents\")")]
    Extents {
        /// Where the ray begins.
        t_min: f32,
        /// Where the ray ends.
        t_max: f32,
    },
    /// Two of its flags exclude each other.
    #[error(transparent)]
    Flags(#[from] ExclusiveRayFlags),
    /// A query runs no shaders that could be skipped.
    #[error("SKIP_CLOSEST_HIT_SHADER is not allowed in a ray query (DXR, \"Ray flags\")")]
    SkipClosestHitInQuery,
}
