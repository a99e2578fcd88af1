//! Mesh shading: work groups that make clusters of primitives instead of vertex shaders that see one vertex at a time
//! (`VK_EXT_mesh_shader`; DirectX 12, "Mesh Shader").
//!
//! [`Meshlets`] are built once from a mesh with indices; each has a [`Sphere`] and a [`NormalCone`] to be culled by.
//! [`VertexReuse`], [`BytesRead`] and [`Overdraw`] measure how good an order of triangles is. [`Frustum`] and
//! [`DepthPyramid`] tell what is outside the view and behind what was drawn; task shaders ask them.
//!
//! A [`MeshPipeline`] runs a [`MeshShader`] for each group of a draw, before that by choice a [`TaskShader`] whose
//! groups say how many mesh groups there are, and draws what comes out as other pipelines do:
//!
//! ```
//! use steradian_raster::{
//!     Extent, Format, Fragment, Framebuffer, Invocation, State, fragment,
//!     glam::{Vec3, Vec4},
//!     mesh_shading::{MeshOutput, MeshPipeline, MeshPrimitive, MeshProgram, MeshShader, MeshVertex},
//!     varyings,
//! };
//!
//! varyings! {
//!     struct Flat {
//!         color: Vec3 => flat,
//!     }
//! }
//!
//! /// Each group makes a square: a column of the picture, whose halves have colours of their own.
//! struct Columns;
//!
//! impl MeshShader for Columns {
//!     type Payload = ();
//!     type Shared = ();
//!     type Private = ();
//!     type Vertex = ();
//!     type Primitive = Vec3;
//!     type Corners = [u8; 3];
//!     type Varyings = Flat;
//!     const LOCAL_SIZE: [u32; 3] = [4, 1, 1];
//!     const MAX_VERTICES: usize = 4;
//!     const MAX_PRIMITIVES: usize = 2;
//!
//!     fn shade(
//!         &self,
//!         _phase: u32,
//!         at: Invocation,
//!         _payload: &(),
//!         _private: &mut (),
//!         _shared: &mut (),
//!         out: &mut MeshOutput<(), Vec3, [u8; 3]>,
//!     ) {
//!         out.set_counts(4, 2);
//!         // Four invocations: one for each corner, and the first two for the triangles.
//!         let i = at.index as usize;
//!         let [x, y] = [at.group[0] + at.index % 2, at.index / 2].map(|x| x as f32);
//!         out.vertex(i, MeshVertex::new(Vec4::new(0.25 * x - 1.0, 2.0 * y - 1.0, 0.5, 1.0), ()));
//!         if i < 2 {
//!             out.primitive(i, MeshPrimitive::new([[0, 1, 2], [2, 1, 3]][i], [Vec3::X, Vec3::Y][i]));
//!         }
//!     }
//!
//!     fn varyings(_vertex: &(), color: &Vec3) -> Flat {
//!         Flat { color: *color }
//!     }
//! }
//!
//! # fn main() -> steradian_raster::Result<()> {
//! let mut framebuffer = Framebuffer::with_color_and_depth(Extent::new(64, 64), Format::Rgba8Unorm)?;
//! let shader = fragment(|f: &Fragment<Flat>| f.varyings().color.extend(1.0));
//! let pipeline = MeshPipeline::new(MeshProgram::new(Columns, shader), State::default(), framebuffer.layout())?;
//! let counters = pipeline.draw(&mut framebuffer, [8, 1, 1])?;
//! assert_eq!((counters.mesh_groups, counters.primitives, counters.rasterized.fragments), (8, 16, 64 * 64));
//! # Ok(())
//! # }
//! ```

mod adjacency;
mod bounds;
mod build;
mod depth_pyramid;
mod frustum;
mod meshlet;
mod output;
mod overdraw;
mod pipeline;
mod primitives;
mod spatial_order;
mod stages;
mod statistics;

pub use bounds::{NormalCone, Sphere};
pub use depth_pyramid::DepthPyramid;
pub use frustum::Frustum;
pub use meshlet::{Meshlet, MeshletLimits, Meshlets};
pub use output::{Corners, MeshOutput, MeshPrimitive, MeshVertex, TaskOutput};
pub use overdraw::Overdraw;
pub use pipeline::{MeshCounters, MeshPipeline, MeshProgram};
pub use stages::{
    MAX_GROUP_INVOCATIONS, MAX_GROUPS, MAX_GROUPS_PER_AXIS, MAX_OUTPUT_PRIMITIVES, MAX_OUTPUT_VERTICES,
    MAX_PAYLOAD_BYTES, MeshShader, NoTask, TaskShader,
};
pub use statistics::{BytesRead, VertexReuse};

#[cfg(test)]
mod tests;
