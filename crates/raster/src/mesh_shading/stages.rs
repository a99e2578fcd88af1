//! Task and mesh shaders. A work group runs as a [`ComputeShader`](crate::ComputeShader) does: invocations with memory
//! in common, in phases between which they all meet.

use crate::{Invocation, Varyings};

use super::output::{Corners, MeshOutput, TaskOutput};

/// The most invocations of a work group (`maxTaskWorkGroupInvocations` and `maxMeshWorkGroupInvocations` of
/// `VK_EXT_mesh_shader` are at least 128; DirectX has 128).
pub const MAX_GROUP_INVOCATIONS: u64 = 128;
/// The most work groups along each axis, of a draw or that a task group emits (`maxTaskWorkGroupCount`).
pub const MAX_GROUPS_PER_AXIS: u32 = 65535;
/// The most work groups in all, of a draw or that a task group emits (`maxTaskWorkGroupTotalCount`).
pub const MAX_GROUPS: u64 = 1 << 22;
/// The most bytes of a payload (`maxTaskPayloadSize`).
pub const MAX_PAYLOAD_BYTES: usize = 16384;
/// The most vertices of a mesh group (`maxMeshOutputVertices`).
pub const MAX_OUTPUT_VERTICES: usize = 256;
/// The most primitives of a mesh group (`maxMeshOutputPrimitives`).
pub const MAX_OUTPUT_PRIMITIVES: usize = 256;

/// Decides which mesh groups run (DirectX: amplification shader).
pub trait TaskShader: Sync {
    /// Data that a task group hands to all mesh groups that it emits, with its value at the group's start; at most
    /// [`MAX_PAYLOAD_BYTES`].
    type Payload: Copy + Default + Send + Sync;
    /// Memory of a group, as it is at its start.
    type Shared: Default;
    /// Memory of an invocation that lasts from phase to phase.
    type Private: Default + Clone;
    /// Invocations of a group in x, y and z; at most [`MAX_GROUP_INVOCATIONS`] in all.
    const LOCAL_SIZE: [u32; 3];
    /// Number of phases.
    const PHASES: u32 = 1;
    /// False only in [`NoTask`].
    #[doc(hidden)]
    const ACTIVE: bool = true;
    /// Runs one invocation of a phase. The invocations of a group run one after the other, in the order of their index.
    fn shade(
        &self,
        phase: u32,
        invocation: Invocation,
        private: &mut Self::Private,
        shared: &mut Self::Shared,
        out: &mut TaskOutput<Self::Payload>,
    );
}

/// No task stage: the groups of a draw are mesh groups, without payload.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoTask;

impl TaskShader for NoTask {
    type Payload = ();
    type Shared = ();
    type Private = ();
    const LOCAL_SIZE: [u32; 3] = [1; 3];
    const ACTIVE: bool = false;
    fn shade(&self, _: u32, _: Invocation, (): &mut (), (): &mut (), _: &mut TaskOutput<()>) {}
}

/// Makes vertices and primitives of nothing but its group's number and the payload.
pub trait MeshShader: Sync {
    /// Payload of the task shader; `()` without one.
    type Payload: Copy + Default + Send + Sync;
    /// Memory of a group, as it is at its start.
    type Shared: Default;
    /// Memory of an invocation that lasts from phase to phase.
    type Private: Default + Clone;
    /// Attributes of a vertex.
    type Vertex: Copy;
    /// Attributes of a primitive.
    type Primitive: Copy;
    /// Triangles, lines or points: `[u8; 3]`, `[u8; 2]` or `[u8; 1]`.
    type Corners: Corners;
    /// Varyings: the input of the fragment shader.
    type Varyings: Varyings;
    /// Invocations of a group in x, y and z; at most [`MAX_GROUP_INVOCATIONS`] in all.
    const LOCAL_SIZE: [u32; 3];
    /// Number of phases.
    const PHASES: u32 = 1;
    /// The most vertices that a group puts out; at most [`MAX_OUTPUT_VERTICES`].
    const MAX_VERTICES: usize;
    /// The most primitives that a group puts out; at most [`MAX_OUTPUT_PRIMITIVES`].
    const MAX_PRIMITIVES: usize;
    /// Runs one invocation of a phase. The invocations of a group run one after the other, in the order of their index.
    fn shade(
        &self,
        phase: u32,
        invocation: Invocation,
        payload: &Self::Payload,
        private: &mut Self::Private,
        shared: &mut Self::Shared,
        out: &mut MeshOutput<Self::Vertex, Self::Primitive, Self::Corners>,
    );
    /// The varyings of a corner, from the attributes of its vertex and its primitive. What comes from the primitive
    /// should be `flat`; it is the same at all corners.
    fn varyings(vertex: &Self::Vertex, primitive: &Self::Primitive) -> Self::Varyings;
}
