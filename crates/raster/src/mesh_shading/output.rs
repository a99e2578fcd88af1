//! Outputs of work groups. Broken rules are recorded and refused by the draw; of several the first.

use glam::Vec4;

use super::stages::{MAX_GROUPS, MAX_GROUPS_PER_AXIS};

/// Fault of these numbers of groups along the axes, if any.
pub(super) fn fault_of_groups(groups: [u32; 3]) -> Option<String> {
    // The product in 64 bits: limits along the axes do not imply that of all.
    let total = groups.iter().try_fold(1u64, |all, &n| all.checked_mul(u64::from(n)));
    if groups.iter().any(|&n| n > MAX_GROUPS_PER_AXIS) {
        return Some(format!("{groups:?} groups; at most {MAX_GROUPS_PER_AXIS} along each axis"));
    }
    match total {
        Some(total) if total > MAX_GROUPS => {
            Some(format!("{groups:?} groups are {total}; at most {MAX_GROUPS} in all"))
        }
        _ => None,
    }
}

/// Output of a task group.
#[derive(Debug)]
pub struct TaskOutput<P> {
    /// Payload of its mesh groups.
    pub payload: P,
    groups: Option<[u32; 3]>,
    fault: Option<String>,
}

impl<P: Default> TaskOutput<P> {
    pub(super) fn new() -> Self {
        Self { payload: P::default(), groups: None, fault: None }
    }

    /// Emits mesh groups, so many along each axis: at most [`MAX_GROUPS_PER_AXIS`] each and [`MAX_GROUPS`] in all.
    /// A group does this once, or several of its invocations with the same numbers; one that never does emits none.
    /// (GLSL: `EmitMeshTasksEXT`, HLSL: `DispatchMesh`.)
    pub fn emit(&mut self, groups: [u32; 3]) {
        // Several invocations may emit, if all say the same.
        let fault = match self.groups {
            Some(before) if before != groups => Some(format!("{groups:?} groups are emitted after {before:?}")),
            _ => fault_of_groups(groups),
        };
        self.groups = Some(groups);
        keep(&mut self.fault, fault);
    }

    /// The payload and the groups.
    pub(super) fn finish(self) -> Result<(P, [u32; 3]), String> {
        match self.fault {
            Some(fault) => Err(fault),
            None => Ok((self.payload, self.groups.unwrap_or_default())),
        }
    }
}

fn keep(first: &mut Option<String>, fault: Option<String>) {
    if first.is_none() {
        *first = fault;
    }
}

/// The corners of a primitive by their vertices in the group.
pub trait Corners: Copy + AsRef<[u8]> + sealed::Sealed {}

impl Corners for [u8; 1] {}
impl Corners for [u8; 2] {}
impl Corners for [u8; 3] {}

mod sealed {
    pub trait Sealed {}
    impl Sealed for [u8; 1] {}
    impl Sealed for [u8; 2] {}
    impl Sealed for [u8; 3] {}
}

/// A vertex of a mesh group.
#[derive(Clone, Copy, Debug)]
pub struct MeshVertex<V> {
    /// Position in clip space, as [`Vertex::position`](crate::Vertex::position).
    pub position: Vec4,
    /// Its attributes.
    pub attributes: V,
    /// Diameter in pixels where points are drawn; 1 unless set.
    pub point_size: f32,
}

impl<V> MeshVertex<V> {
    /// A vertex.
    pub fn new(position: Vec4, attributes: V) -> Self {
        Self { position, attributes, point_size: 1.0 }
    }
}

/// A primitive of a mesh group.
#[derive(Clone, Copy, Debug)]
pub struct MeshPrimitive<P, C> {
    /// Its vertices, by their number in the group.
    pub corners: C,
    /// Its attributes.
    pub attributes: P,
    /// Value of [`Fragment::primitive_id`](crate::Fragment::primitive_id); 0 unless set.
    pub id: u32,
    /// The layer of the framebuffer; 0 unless set. Primitives of layers that are not there are dropped.
    pub layer: u32,
    /// The viewport; 0 unless set. Primitives of viewports that are not there are dropped.
    pub viewport: u32,
    /// True if it is dropped (`gl_CullPrimitiveEXT`, `SV_CullPrimitive`).
    pub culled: bool,
}

impl<P, C> MeshPrimitive<P, C> {
    /// A primitive that is drawn, with id, layer and viewport 0.
    pub fn new(corners: C, attributes: P) -> Self {
        Self { corners, attributes, id: 0, layer: 0, viewport: 0, culled: false }
    }
}

/// Output of a mesh group.
#[derive(Debug)]
pub struct MeshOutput<V, P, C> {
    limits: [usize; 2],
    counts: Option<[usize; 2]>,
    pub(super) vertices: Vec<Option<MeshVertex<V>>>,
    pub(super) primitives: Vec<Option<MeshPrimitive<P, C>>>,
    fault: Option<String>,
}

impl<V: Copy, P: Copy, C: Corners> MeshOutput<V, P, C> {
    /// For groups of at most so many vertices and primitives.
    pub(super) fn new(limits: [usize; 2]) -> Self {
        Self { limits, counts: None, vertices: Vec::new(), primitives: Vec::new(), fault: None }
    }

    pub(super) fn begin(&mut self) {
        self.counts = None;
        self.vertices.clear();
        self.primitives.clear();
        self.fault = None;
    }

    /// Says how many vertices and primitives there are, before any is written: at most
    /// [`MAX_VERTICES`](super::MeshShader::MAX_VERTICES) and [`MAX_PRIMITIVES`](super::MeshShader::MAX_PRIMITIVES). A
    /// group does this once, or several of its invocations with the same numbers; one that never does puts out nothing.
    /// (GLSL: `SetMeshOutputsEXT`, HLSL: `SetMeshOutputCounts`.)
    pub fn set_counts(&mut self, vertices: usize, primitives: usize) {
        // The first call sets the sizes, later ones must repeat them; limits are those of the shader.
        let counts = [vertices, primitives];
        match self.counts {
            Some(before) if before == counts => {}
            Some(before) => {
                self.fail(format!("the output is set to {counts:?} vertices and primitives after {before:?}"))
            }
            None if vertices > self.limits[0] => {
                self.fail(format!("{vertices} vertices; MAX_VERTICES of the mesh shader is {}", self.limits[0]));
            }
            None if primitives > self.limits[1] => {
                self.fail(format!("{primitives} primitives; MAX_PRIMITIVES of the mesh shader is {}", self.limits[1]));
            }
            None => {
                self.counts = Some(counts);
                self.vertices.resize(vertices, None);
                self.primitives.resize(primitives, None);
            }
        }
    }

    /// Writes a vertex. Each that is counted must be written.
    pub fn vertex(&mut self, number: usize, vertex: MeshVertex<V>) {
        match self.vertices.get_mut(number) {
            Some(place) => *place = Some(vertex),
            None => self.fail(format!("vertex {number} is written; the output is set to {}", self.vertices.len())),
        }
    }

    /// Writes a primitive. Each that is counted must be written.
    pub fn primitive(&mut self, number: usize, primitive: MeshPrimitive<P, C>) {
        match self.primitives.get_mut(number) {
            Some(place) => *place = Some(primitive),
            None => self.fail(format!("primitive {number} is written; the output is set to {}", self.primitives.len())),
        }
    }

    fn fail(&mut self, fault: String) {
        keep(&mut self.fault, Some(fault));
    }

    /// Checks the output.
    pub(super) fn check(&mut self) -> Result<(), String> {
        if let Some(fault) = self.fault.take() {
            return Err(fault);
        }
        // Check counts, completeness and corner indices before anything is drawn.
        if let Some(number) = self.vertices.iter().position(Option::is_none) {
            return Err(format!("vertex {number} of {} is not written", self.vertices.len()));
        }
        // Corners must name vertices that the group has.
        let count = self.vertices.len();
        for (number, primitive) in self.primitives.iter().enumerate() {
            let Some(primitive) = primitive else {
                return Err(format!("primitive {number} of {} is not written", self.primitives.len()));
            };
            if let Some(corner) = primitive.corners.as_ref().iter().find(|&&corner| usize::from(corner) >= count) {
                return Err(format!("primitive {number} has a corner at vertex {corner} of {count}"));
            }
        }
        Ok(())
    }
}
