//! A programmable graphics pipeline in software: what a graphics card does between vertices and pixels, as a library.
//! It runs anywhere, gives the same bits on every machine and for every number of threads, and can be looked into.
//!
//! # A triangle in five minutes
//!
//! Shaders are Rust: a vertex shader is a closure (or any type with [`VertexShader`](stages::VertexShader)) from a
//! vertex number to a position in clip space and the values that are to be interpolated, a fragment shader one from
//! those values to a colour.
//!
//! ```
//! use steradian_raster::{
//!     Draw, Extent, Format, Fragment, Framebuffer, Pipeline, Program, State, Vertex, VertexInput, fragment,
//!     glam::{Vec3, Vec4},
//!     state::DepthState,
//!     varyings,
//! };
//!
//! // What the vertices hand to the fragments.
//! varyings! {
//!     struct Shaded {
//!         color: Vec3,
//!     }
//! }
//!
//! # fn main() -> steradian_raster::Result<()> {
//! // Where to draw: 256 × 256 pixels with 8 bits for each channel, and a depth buffer.
//! let mut framebuffer = Framebuffer::with_color_and_depth(Extent::new(256, 256), Format::Rgba8Unorm)?;
//! framebuffer.clear(Vec4::new(0.1, 0.1, 0.1, 1.0), 1.0, 0);
//!
//! // The two shaders. Clip space: x right, y up, both from −1 to 1; depth from 0 to 1.
//! let corners = [Vec3::new(-0.8, -0.7, 0.5), Vec3::new(0.8, -0.7, 0.5), Vec3::new(0.0, 0.8, 0.5)];
//! let vertex = |input: VertexInput| {
//!     let corner = input.vertex as usize;
//!     Vertex::new(corners[corner].extend(1.0), Shaded { color: [Vec3::X, Vec3::Y, Vec3::Z][corner] })
//! };
//! let shader = fragment(|f: &Fragment<Shaded>| f.varyings().color.extend(1.0));
//!
//! // Shaders and state are checked here, once; drawing has nothing left to check.
//! let state = State { depth: Some(DepthState::LESS), ..State::default() };
//! let pipeline = Pipeline::new(Program::new(vertex, shader), state, framebuffer.layout())?;
//! let counters = pipeline.draw(&mut framebuffer, &Draw::vertices(0..3))?;
//!
//! assert_eq!(counters.primitives, 1);
//! let middle = framebuffer.color(0).pixel(128, 140).unwrap();
//! assert!(middle.x > 0.2 && middle.y > 0.2 && middle.z > 0.2);
//! let picture: steradian_image::Image = framebuffer.color(0).to_image()?;
//! # Ok(())
//! # }
//! ```
//!
//! From here: give the shaders fields (a matrix, a texture) by writing a `struct` and implementing the traits of
//! [`stages`]; change what is fixed in the pipeline in [`State`]; draw with indices and instances by [`Draw`]; read
//! what happened from [`Counters`].
//!
//! # What there is
//!
//! * [`stages`]: vertex, tessellation, geometry and fragment shaders, any of which a [`Program`] may have. All calls
//!   are resolved by the compiler. Fragments run in 2×2 quads, so derivatives are there ([`Fragment::dx`]), with
//!   helpers where the primitive is not.
//! * [`varyings!`]: values from vertices to fragments, with perspective, linear, flat, at the centroid, at samples;
//!   clip and cull distances.
//! * [`state`]: topologies with adjacency, patches and restart; polygon modes, lines, points, depth bias, conservative
//!   rasterisation; depth and stencil tests; blending; samples; viewports.
//! * [`render_target`]: framebuffers of up to eight colour targets in any of the [`Format`]s that can be drawn to, with
//!   layers and samples.
//!
//! * [`mesh_shading`]: meshlets, and pipelines of task and mesh shaders.
//! * [`texture`]: textures of all kinds, views that reinterpret them, samplers; [`VertexArray`] reads attributes from
//!   bytes, [`block!`] and [`BlockRules`] lay out uniform and storage blocks; [`dispatch`] runs [`ComputeShader`]s.
//!
//! * [`objects`]: names, buffers, vertex arrays, textures, framebuffers, images, queries as OpenGL has them, in a
//!   context with their calls.
//!
//! # Rules that always hold
//!
//! * Positions are rounded to 1/256 pixel; of two triangles with a common edge exactly one covers a sample on it
//!   (top-left rule).
//! * Primitives take effect in their order, for any number of threads.
//! * The window has y down, row 0 is the top row; clip space has y up.
//! * Nothing panics on any position, index or state: primitives with positions that are not finite are dropped and
//!   counted.

mod block_layout;
mod compute;
mod counters;
mod draw;
pub mod error;
pub mod format;
pub mod fragment;
mod front;
pub mod mesh_shading;
pub mod objects;
pub mod output;
mod pipeline;
mod primitive;
pub mod render_target;
mod samples;
pub mod stages;
pub mod state;
pub mod texture;
mod tile;
pub mod varyings;
mod vertex_array;

pub use block_layout::{Block, BlockMember, BlockRules, BlockType};
pub use compute::{ComputeShader, Invocation, dispatch};
pub use counters::Counters;
pub use draw::Draw;
pub use error::{Error, Result};
pub use format::Format;
pub use fragment::Fragment;
pub use front::{TessellatedDomain, tessellate};
pub use glam;
pub use pipeline::Pipeline;
pub use render_target::{ColorTarget, DepthFormat, DepthTarget, Extent, Framebuffer, Layout, StencilTarget};
pub use samples::{SAMPLE_COUNTS, sample_position};
pub use stages::{Program, Vertex, VertexInput, fragment};
pub use state::State;
pub use varyings::Varyings;
pub use vertex_array::{
    Attribute, AttributeFormat, ComponentType, Components, Conversion, MAX_ATTRIBUTES, VertexArray,
};
