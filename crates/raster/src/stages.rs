//! The programmable stages. A shader is a value with a method: what GLSL calls uniforms, textures and buffers are its
//! fields.
//!
//! All calls are resolved by the compiler; a pipeline of these shaders is one piece of machine code.

use std::marker::PhantomData;

use glam::{Vec3, Vec4};

use crate::{fragment::Fragment, fragment::Quad, output::FragmentOutput, varyings::Varyings};

/// Which vertex a vertex shader is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct VertexInput {
    /// Number of the vertex: the index (plus base vertex) of an indexed draw, else its place in the draw plus the first
    /// vertex.
    pub vertex: u32,
    /// Number of the instance, from the draw's first instance on.
    pub instance: u32,
    /// Number of the draw in a multi-draw.
    pub draw: u32,
}

/// Output vertex of a vertex, tessellation evaluation or geometry shader.
#[derive(Clone, Copy, Debug)]
pub struct Vertex<V> {
    /// Position in clip space: x right, y up; what is visible has −w ≤ x, y ≤ w and 0 ≤ z ≤ w (or −w ≤ z ≤ w, see
    /// [`DepthRange`](crate::state::DepthRange)).
    pub position: Vec4,
    /// Varyings, which are interpolated.
    pub varyings: V,
    /// Diameter of the vertex in pixels where points are drawn; 1 unless set.
    pub point_size: f32,
    /// The layer of the framebuffer; the provoking vertex's counts. Primitives of layers that are not there are
    /// dropped.
    pub layer: u32,
    /// The viewport; the provoking vertex's counts. Primitives of viewports that are not there are dropped.
    pub viewport: u32,
}

impl<V> Vertex<V> {
    /// A vertex of layer and viewport 0.
    #[inline(always)]
    pub fn new(position: Vec4, varyings: V) -> Self {
        Self { position, varyings, point_size: 1.0, layer: 0, viewport: 0 }
    }
}

/// Makes a vertex of its number. Closures `|input: VertexInput| -> Vertex<V>` are vertex shaders.
pub trait VertexShader: Sync {
    /// Varyings for the next stage.
    type Varyings: Varyings;
    /// The vertex. Called about once for each index that is near others of the same value; do not count on how often.
    fn shade(&self, input: VertexInput) -> Vertex<Self::Varyings>;
}

impl<F, V> VertexShader for F
where
    F: Fn(VertexInput) -> Vertex<V> + Sync,
    V: Varyings,
{
    type Varyings = V;
    #[inline(always)]
    fn shade(&self, input: VertexInput) -> Vertex<V> {
        self(input)
    }
}

/// The domain that a patch is tessellated over.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Domain {
    /// A triangle with barycentric coordinates; outer levels 0…2, inner level 0.
    Triangles,
    /// The unit square; outer levels 0…3, inner levels 0 and 1.
    Quads,
    /// Lines across the unit square: outer level 0 says how many, outer level 1 into how many segments each.
    Isolines,
}

/// Rounding of a tessellation level to a number of segments.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Spacing {
    /// Rounded up: n equal segments.
    Equal,
    /// To the next even number; two segments are shorter so that the change is continuous.
    FractionalEven,
    /// To the next odd number; two segments are shorter so that the change is continuous.
    FractionalOdd,
}

/// Levels of tessellation of a patch. A patch with an outer level of its domain ≤ 0 or NaN is dropped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Levels {
    /// For the edges.
    pub outer: [f32; 4],
    /// For the inside.
    pub inner: [f32; 2],
}

impl Levels {
    /// One level for all edges and the inside.
    pub const fn uniform(level: f32) -> Self {
        Self { outer: [level; 4], inner: [level; 2] }
    }
}

/// Tessellation: control and evaluation. Used with [`Topology::Patches`](crate::state::Topology::Patches).
pub trait Tessellation: Sync {
    /// Varyings of the vertex shader.
    type Input: Varyings;
    /// Data that control hands to evaluation, besides the levels.
    type Patch: Copy;
    /// For the geometry or fragment shader.
    type Output: Varyings;
    /// The domain.
    const DOMAIN: Domain;
    /// Rounding of levels to segments.
    const SPACING: Spacing = Spacing::Equal;
    /// True if triangles are clockwise in the domain, u to the right and v up.
    const CLOCKWISE: bool = false;
    /// True if the points of the domain are drawn instead of triangles or lines.
    const POINT_MODE: bool = false;
    /// False only in [`NoTessellation`].
    #[doc(hidden)]
    const ACTIVE: bool = true;
    /// Looks at the vertices of a patch (with its number) and says how finely it is divided.
    fn control(&self, vertices: &[Vertex<Self::Input>], patch: u32) -> (Levels, Self::Patch);
    /// The vertex at a point of the domain: (u, v, w) with u + v + w = 1 for triangles, else (u, v, 0).
    fn evaluate(&self, patch: &Self::Patch, levels: &Levels, coordinates: Vec3) -> Vertex<Self::Output>;
    /// Passes a vertex through in place of an absent stage; the two types are the same then.
    #[doc(hidden)]
    #[inline(always)]
    fn pass(vertex: &Vertex<Self::Input>) -> Vertex<Self::Output> {
        Vertex::new(vertex.position, Self::Output::from_floats(|_| 0.0))
    }
}

/// No tessellation stage.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoTessellation<V>(PhantomData<V>);

impl<V> NoTessellation<V> {
    pub(crate) const fn new() -> Self {
        Self(PhantomData)
    }
}

impl<V: Varyings> Tessellation for NoTessellation<V> {
    type Input = V;
    type Patch = ();
    type Output = V;
    const DOMAIN: Domain = Domain::Triangles;
    const ACTIVE: bool = false;
    fn control(&self, _: &[Vertex<V>], _: u32) -> (Levels, ()) {
        (Levels::uniform(0.0), ())
    }
    fn evaluate(&self, (): &(), _: &Levels, _: Vec3) -> Vertex<V> {
        Vertex::new(Vec4::ZERO, V::from_floats(|_| 0.0))
    }
    #[inline(always)]
    fn pass(vertex: &Vertex<V>) -> Vertex<V> {
        *vertex
    }
}

/// Kind of primitives that a geometry shader emits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GeometryOutput {
    /// Single points.
    Points,
    /// Strips of lines.
    LineStrip,
    /// Strips of triangles.
    TriangleStrip,
}

/// The primitive that a geometry shader looks at.
#[derive(Clone, Copy, Debug)]
pub struct GeometryInput<'a, V> {
    /// 1 vertex of points, 2 of lines, 3 of triangles, 4 of lines with adjacency (previous, start, end, next), 6 of
    /// triangles with adjacency (corners at 0, 2, 4; the vertex across the edge from corner i to the next at i + 1).
    pub vertices: &'a [Vertex<V>],
    /// Number of the primitive in the draw.
    pub primitive: u32,
    /// Which of the [`GeometryShader::INVOCATIONS`] this is.
    pub invocation: u32,
}

/// Turns each primitive into any number of others.
pub trait GeometryShader: Sync {
    /// Varyings of the stage before.
    type Input: Varyings;
    /// For the fragment shader.
    type Output: Varyings;
    /// Kind of the emitted primitives.
    const OUTPUT: GeometryOutput;
    /// The most vertices that one call may emit; what comes after is dropped.
    const MAX_VERTICES: usize;
    /// Number of calls for each primitive.
    const INVOCATIONS: u32 = 1;
    /// False only in [`NoGeometry`].
    #[doc(hidden)]
    const ACTIVE: bool = true;
    /// Emits the primitives that take the place of this one.
    fn shade(&self, input: GeometryInput<Self::Input>, out: &mut Emitter<Self::Output>);
    /// Passes a vertex through in place of an absent stage; the two types are the same then.
    #[doc(hidden)]
    #[inline(always)]
    fn pass(vertex: &Vertex<Self::Input>) -> Vertex<Self::Output> {
        Vertex::new(vertex.position, Self::Output::from_floats(|_| 0.0))
    }
}

/// Takes what a geometry shader emits.
#[derive(Debug)]
pub struct Emitter<V> {
    pub(crate) vertices: Vec<Vertex<V>>,
    /// The primitive id of each vertex, and the place after each strip.
    pub(crate) ids: Vec<u32>,
    pub(crate) ends: Vec<usize>,
    pub(crate) limit: usize,
    /// The number of the primitive that the following vertices belong to; that of the input unless set.
    pub primitive_id: u32,
}

impl<V: Copy> Emitter<V> {
    pub(crate) fn new(limit: usize) -> Self {
        Self { vertices: Vec::new(), ids: Vec::new(), ends: Vec::new(), limit, primitive_id: 0 }
    }

    pub(crate) fn begin(&mut self, primitive_id: u32) {
        self.vertices.clear();
        self.ids.clear();
        self.ends.clear();
        self.primitive_id = primitive_id;
    }

    /// Adds a vertex to the strip.
    #[inline]
    pub fn vertex(&mut self, vertex: Vertex<V>) {
        if self.vertices.len() < self.limit {
            self.vertices.push(vertex);
            self.ids.push(self.primitive_id);
        }
    }

    /// Ends the strip; the next vertex starts another.
    #[inline]
    pub fn end_primitive(&mut self) {
        self.ends.push(self.vertices.len());
    }
}

/// No geometry stage.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoGeometry<V>(PhantomData<V>);

impl<V> NoGeometry<V> {
    pub(crate) const fn new() -> Self {
        Self(PhantomData)
    }
}

impl<V: Varyings> GeometryShader for NoGeometry<V> {
    type Input = V;
    type Output = V;
    const OUTPUT: GeometryOutput = GeometryOutput::TriangleStrip;
    const MAX_VERTICES: usize = 0;
    const ACTIVE: bool = false;
    fn shade(&self, _: GeometryInput<V>, _: &mut Emitter<V>) {}
    #[inline(always)]
    fn pass(vertex: &Vertex<V>) -> Vertex<V> {
        *vertex
    }
}

/// Gives a fragment its colour. For a closure, see [`fragment`].
pub trait FragmentShader: Sync {
    /// Varyings of the last stage before.
    type Varyings: Varyings;
    /// Output: a colour ([`Vec4`]), several, none (`()`), with depth, with a sample mask, or perhaps nothing
    /// (`Option`).
    type Output: FragmentOutput;
    /// Depth and stencil are tested and written before the shader runs, whatever it does (GLSL:
    /// `early_fragment_tests`).
    const EARLY_TESTS: bool = false;
    /// Runs the shader at each sample rather than once for each pixel.
    const PER_SAMPLE: bool = false;
    /// True only in [`DepthOnly`]: nothing would change if it did not run.
    #[doc(hidden)]
    const EMPTY: bool = false;
    /// The output of one pixel. Called for the four pixels of a 2×2 quad if one is covered: those that are not are
    /// helpers ([`Fragment::is_helper`]), and nothing of theirs is written.
    fn shade(&self, fragment: &Fragment<Self::Varyings>) -> Self::Output;
    /// The outputs of a quad. By default one pixel after the other; a shader that computes in four lanes replaces it.
    #[inline(always)]
    fn shade_quad(&self, quad: &Quad<Self::Varyings>) -> [Self::Output; 4] {
        // Written out, so that the compiler sees which parts of the quad are used.
        let of = |lane| Fragment::new(quad, lane);
        [self.shade(&of(0)), self.shade(&of(1)), self.shade(&of(2)), self.shade(&of(3))]
    }
}

/// A fragment shader of a closure; see [`fragment`].
pub struct FragmentFn<F, V, O>(F, PhantomData<fn(V) -> O>);

/// The fragment shader `|fragment: &Fragment<V>| -> output`.
pub fn fragment<V, O, F>(shader: F) -> FragmentFn<F, V, O>
where
    V: Varyings,
    O: FragmentOutput,
    F: Fn(&Fragment<V>) -> O + Sync,
{
    FragmentFn(shader, PhantomData)
}

impl<V, O, F> FragmentShader for FragmentFn<F, V, O>
where
    V: Varyings,
    O: FragmentOutput,
    F: Fn(&Fragment<V>) -> O + Sync,
{
    type Varyings = V;
    type Output = O;
    #[inline(always)]
    fn shade(&self, fragment: &Fragment<V>) -> O {
        (self.0)(fragment)
    }
}

/// The fragment shader that writes nothing: depth and stencil alone.
#[derive(Clone, Copy, Debug, Default)]
pub struct DepthOnly<V>(PhantomData<fn(V)>);

impl<V> DepthOnly<V> {
    /// One for varyings of this type.
    pub const fn new() -> Self {
        Self(PhantomData)
    }
}

impl<V: Varyings> FragmentShader for DepthOnly<V> {
    type Varyings = V;
    type Output = ();
    const EMPTY: bool = true;
    #[inline(always)]
    fn shade(&self, _: &Fragment<V>) {}
}

/// The shaders of a pipeline. Start with [`Program::new`].
#[derive(Clone, Copy, Debug)]
pub struct Program<V, T, G, F> {
    /// The vertex shader. Fields of shaders may be changed between draws.
    pub vertex: V,
    /// The tessellation stages.
    pub tessellation: T,
    /// The geometry shader.
    pub geometry: G,
    /// The fragment shader.
    pub fragment: F,
}

impl<V: VertexShader, F: FragmentShader> Program<V, NoTessellation<V::Varyings>, NoGeometry<V::Varyings>, F> {
    /// Vertex and fragment shader. The compiler refuses a pipeline whose stages do not fit.
    pub fn new(vertex: V, fragment: F) -> Self {
        Self { vertex, tessellation: NoTessellation::new(), geometry: NoGeometry::new(), fragment }
    }

    /// With tessellation.
    pub fn tessellation<T: Tessellation<Input = V::Varyings>>(
        self,
        tessellation: T,
    ) -> Program<V, T, NoGeometry<T::Output>, F> {
        Program { vertex: self.vertex, tessellation, geometry: NoGeometry::new(), fragment: self.fragment }
    }
}

impl<V, T: Tessellation, F> Program<V, T, NoGeometry<T::Output>, F> {
    /// With a geometry shader.
    pub fn geometry<G: GeometryShader<Input = T::Output>>(self, geometry: G) -> Program<V, T, G, F> {
        Program { vertex: self.vertex, tessellation: self.tessellation, geometry, fragment: self.fragment }
    }
}
