//! Errors of structures: each value names the rule that was broken, and the numbers.

use crate::flags::{ExclusiveRayFlags, InstanceFlags};

/// Why a structure cannot be built or updated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BuildError {
    /// The number of corners is no multiple of three.
    #[error(
        "geometry {geometry} has {corners} corners: three make a triangle (DXR, \
         D3D12_RAYTRACING_GEOMETRY_TRIANGLES_DESC)"
    )]
    IncompleteTriangle {
        /// Index of the geometry.
        geometry: usize,
        /// Number of indices, or of vertices where there are no indices.
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
        /// Number of vertices.
        vertices: usize,
    },
    /// The transform of a geometry is singular, or has a number that is not finite.
    #[error(
        "the transform of geometry {geometry} has no inverse: its first three columns must be \
         invertible (Vulkan, VkTransformMatrixKHR)"
    )]
    GeometryTransform {
        /// Index of the geometry.
        geometry: usize,
    },
    /// The transform of an instance is singular, or has a number that is not finite.
    #[error(
        "the transform of instance {instance} has no inverse: its first three columns must be \
         invertible (Vulkan, VkTransformMatrixKHR)"
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
        /// Noun of the items counted.
        what: &'static str,
        /// Their number.
        count: u64,
        /// Largest number allowed.
        limit: u64,
    },
    /// A structure that was not built for updates cannot be updated.
    #[error("the structure was built without ALLOW_UPDATE (DXR, D3D12_RAYTRACING_ACCELERATION_STRUCTURE_BUILD_FLAGS)")]
    UpdateNotAllowed,
    /// A structure that was not built for compaction cannot be compacted.
    #[error(
        "the structure was built without ALLOW_COMPACTION (DXR, \
         D3D12_RAYTRACING_ACCELERATION_STRUCTURE_BUILD_FLAGS)"
    )]
    CompactionNotAllowed,
    /// An update changes what it may not change.
    #[error(
        "an update may not change {what} of geometry {geometry} (DXR, \"Bottom-level acceleration structure updates\")"
    )]
    UpdateChanges {
        /// The property that has changed.
        what: &'static str,
        /// Index of the geometry.
        geometry: usize,
    },
    /// An update changes how many there are.
    #[error(
        "an update may not change the number of {what}: {before} before, {now} now (DXR, \
         \"Acceleration structure update constraints\")"
    )]
    UpdateCount {
        /// Noun of the items counted.
        what: &'static str,
        /// Their number before the update.
        before: usize,
        /// Their number in the update.
        now: usize,
    },
    /// An update makes a primitive active that was not, or the other way round.
    #[error(
        "an update may not change whether primitive {primitive} of geometry {geometry} is active \
         (DXR, \"Inactive primitives and instances\")"
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
        /// Start of the ray's interval.
        t_min: f32,
        /// End of the ray's interval.
        t_max: f32,
    },
    /// Two of its flags exclude each other.
    #[error(transparent)]
    Flags(#[from] ExclusiveRayFlags),
    /// A query runs no shaders that could be skipped.
    #[error("SKIP_CLOSEST_HIT_SHADER is not allowed in a ray query (DXR, \"Ray flags\")")]
    SkipClosestHitInQuery,
}

/// Why a launch ended before its time. In the APIs the behaviour is undefined in these cases, or the device is lost.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Fault {
    /// A ray that cannot be traced.
    #[error(transparent)]
    Ray(#[from] RayError),
    /// A hit-group record that does not exist.
    #[error(
        "no hit-group record at {place} = {base} + {stride} * ({ray_contribution} + \
         {geometry_multiplier} * {geometry} + {instance_offset}): the table has {records} \
         (DXR, \"Hit group table indexing\")"
    )]
    HitGroupRecord {
        /// Base of the table.
        base: u32,
        /// Stride of the table.
        stride: u32,
        /// Contribution of the ray; its low 4 bits.
        ray_contribution: u32,
        /// Multiplier of the geometry index; its low 4 bits.
        geometry_multiplier: u32,
        /// Index of the geometry.
        geometry: u32,
        /// Offset of the instance.
        instance_offset: u32,
        /// Resulting record index.
        place: u64,
        /// Number of records in the table.
        records: usize,
    },
    /// A miss or callable record that does not exist.
    #[error(
        "no {table} record at {place} = {base} + {stride} * {index}: the table has {records} (DXR, \
         \"Addressing calculations within shader tables\")"
    )]
    Record {
        /// Which table.
        table: &'static str,
        /// Base of the table.
        base: u32,
        /// Stride of the table.
        stride: u32,
        /// The index; of a miss shader its low 16 bits.
        index: u32,
        /// Resulting record index.
        place: u64,
        /// Number of records in the table.
        records: usize,
    },
    /// A hit group is used on primitives of the other kind.
    #[error("the hit group of record {place} is for {group}, but the geometry has {geometry} (DXR, \"Hit groups\")")]
    GroupKind {
        /// Index of the hit group in the pipeline.
        place: u32,
        /// Kind of primitive that the group is for.
        group: &'static str,
        /// Kind of primitive in the geometry.
        geometry: &'static str,
    },
    /// An intersection shader reports a hit of a kind that belongs to triangles.
    #[error("hit kind {kind} is not in 0..=127 (DXR, \"ReportHit\")")]
    HitKind {
        /// The kind.
        kind: u8,
    },
    /// Rays are traced from shaders of rays more deeply than declared.
    #[error(
        "trace at depth {limit}: the pipeline declares a maximum recursion depth of {limit} (DXR, \
         \"Ray recursion limit\")"
    )]
    RecursionDepth {
        /// The declared limit.
        limit: u32,
    },
    /// The declared sizes of the shaders in a chain of calls exceed the stack.
    #[error("the stack of {limit} bytes is too small: this call needs {needed} (DXR, \"Pipeline stack\")")]
    Stack {
        /// Bytes that the shaders in the chain of calls have declared.
        needed: u64,
        /// Bytes of the pipeline's stack.
        limit: u64,
    },
    /// Callable shaders call each other too deeply.
    #[error("callable shaders call each other more than {limit} deep")]
    CallDepth {
        /// Largest depth allowed.
        limit: u32,
    },
}

/// Why a launch gave nothing.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LaunchError {
    /// A shader did what is not allowed. Of several, the one with the smallest launch id, x counting least.
    #[error("launch id {launch_id:?}: {fault}")]
    Fault {
        /// The launch id.
        launch_id: [u32; 3],
        /// Its fault.
        fault: Fault,
    },
    /// More launch ids than allowed.
    #[error("{size:?} are {count} launch ids: at most {limit} are allowed (DXR, \"DispatchRays\")")]
    TooLarge {
        /// The size that was asked for.
        size: [u32; 3],
        /// Their product.
        count: u128,
        /// The limit.
        limit: u64,
    },
    /// A launch id outside of the launch.
    #[error("there is no launch id {launch_id:?} in {size:?}")]
    NoLaunchId {
        /// The launch id that was asked for.
        launch_id: [u32; 3],
        /// The size of the launch.
        size: [u32; 3],
    },
    /// There is no memory for the output.
    #[error("no memory for the output of {count} launch ids")]
    NoMemory {
        /// Number of launch ids.
        count: u64,
    },
    /// A record has a handle of another pipeline.
    #[error("record {place} of the {table} table has a handle of another pipeline")]
    ForeignHandle {
        /// Which table.
        table: &'static str,
        /// Index of the record.
        place: usize,
    },
}

/// Why libraries cannot be linked to a pipeline.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum PipelineError {
    /// Two exports of one kind have the same name.
    #[error("two exports of kind {kind} are named {name:?}")]
    DuplicateName {
        /// Their kind.
        kind: &'static str,
        /// Their name.
        name: String,
    },
    /// A recursion depth that is too great.
    #[error("a maximum recursion depth of {declared} is more than {limit} (DXR, \"D3D12_RAYTRACING_PIPELINE_CONFIG\")")]
    RecursionDepth {
        /// Declared depth.
        declared: u32,
        /// Largest depth allowed.
        limit: u32,
    },
}

/// Why bytes are no structure.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LoadError {
    /// They do not begin as structures do.
    #[error("the bytes are not of a {what}")]
    NoStructure {
        /// Noun of the expected content.
        what: &'static str,
    },
    /// They are of another version.
    #[error("the structure has version {version}: only {readable} can be read")]
    Version {
        /// Their version.
        version: u32,
        /// The version that can be read.
        readable: u32,
    },
    /// They end too early.
    #[error("the bytes end within the structure")]
    TooShort,
    /// They go on after the structure.
    #[error("{bytes} bytes follow the structure")]
    TooLong {
        /// Number of bytes left over.
        bytes: usize,
    },
    /// A top-level structure refers to more or fewer bottom levels than are given.
    #[error("the structure has handles of {expected} bottom levels, but {given} are given (Vulkan, \"Serialization\")")]
    BottomLevelCount {
        /// Number of bottom levels that it refers to.
        expected: usize,
        /// Number of bottom levels given.
        given: usize,
    },
    /// A top-level structure refers to another bottom level than the one that is given.
    #[error(
        "the structure has handle {expected:#018x} of bottom level {place}, but one with {given:#018x} is given \
         (Vulkan, \"Serialization\")"
    )]
    BottomLevel {
        /// Index of the bottom level.
        place: usize,
        /// Its handle.
        expected: u64,
        /// The handle of what is given.
        given: u64,
    },
    /// Something in them has no meaning.
    #[error("there is no such {what}")]
    Invalid {
        /// Noun of the invalid value.
        what: &'static str,
    },
    /// They break a rule of structures.
    #[error(transparent)]
    Build(Box<BuildError>),
}

/// Why a deferred operation has no result.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DeferredError {
    /// It is not complete.
    #[error("the operation is not complete: {unfinished} builds are left (Vulkan, vkGetDeferredOperationResultKHR)")]
    NotReady {
        /// Number of unfinished builds.
        unfinished: usize,
    },
    /// A build failed.
    #[error("build {build}: {error}")]
    Build {
        /// Index of the first one that failed.
        build: usize,
        /// Its error.
        error: BuildError,
    },
}

/// Bytes that are the handle of nothing in a pipeline.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the pipeline has no {kind} with this handle (Vulkan, vkGetRayTracingCaptureReplayShaderGroupHandlesKHR)")]
pub struct UnknownHandle {
    /// Kind of export expected.
    pub kind: &'static str,
}

/// Why captured shader tables are none of a pipeline.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ReplayError {
    /// A handle that the pipeline does not have.
    #[error("record {place}: {error}")]
    Handle {
        /// Index of the record in its table.
        place: usize,
        /// The error of its handle.
        error: UnknownHandle,
    },
    /// Bytes that are no local data.
    #[error("record {place} of a {kind} has {bytes} bytes that are no local data")]
    Local {
        /// Kind of the table's records.
        kind: &'static str,
        /// Index of the record in its table.
        place: usize,
        /// Number of bytes.
        bytes: usize,
    },
}
