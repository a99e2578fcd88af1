//! Objects of a graphics API as OpenGL 4.6 (core profile) has them: names, bindings, attachments and deletion, buffers
//! with mappings, vertex arrays, textures with views, samplers, framebuffers, images, queries. A thin layer over the
//! pipeline, for who learns the API or ports a program.
//!
//! A [`Context`] has the calls under their names, `bind_buffer` for `glBindBuffer`. Contexts that were made from one
//! [`ShareGroup`] share buffers, textures, renderbuffers and samplers; vertex arrays, framebuffers and queries are of
//! one context. Calls that take a buffer take a target, as calls before OpenGL 4.5 do, or a name, as those of direct
//! state access do.
//!
//! Each call that breaks a rule returns an [`Error`](crate::Error) with the call, the rule and OpenGL's code, and
//! changes nothing. Nothing panics, and nothing is left undefined: bytes that OpenGL leaves undefined are zero.
//!
//! Shaders stay Rust: a draw is handed a closure that makes a [`Pipeline`](crate::Pipeline) over the attributes,
//! textures, images and blocks that are bound ([`Inputs`]), and a dispatch one that makes a kernel over them. Atomics
//! are those of Rust: images of 32-bit integers, storage and counters are seen as
//! [`AtomicU32`](std::sync::atomic::AtomicU32).
//!
//! ```
//! use steradian_raster::{
//!     Extent, Format, Framebuffer,
//!     objects::{BufferFlags, BufferTarget, Contents, Context, ShareGroup},
//! };
//!
//! # fn main() -> steradian_raster::Result<()> {
//! let picture = Framebuffer::with_color_and_depth(Extent::new(64, 64), Format::Rgba8Unorm)?;
//! let mut context = Context::new(&ShareGroup::new(), picture);
//! let name = context.gen_buffers(1)?[0];
//! context.bind_buffer(BufferTarget::CopyRead, name)?;
//! context.buffer_storage(BufferTarget::CopyRead, Contents::Bytes(b"immutable"), BufferFlags::MAP_READ)?;
//! let mapping = context.map_buffer_range(name, 2, 4, BufferFlags::MAP_READ)?;
//! assert_eq!(mapping.read(0, 4)?, b"muta");
//! let error = context.buffer_sub_data(name, 0, b"x").unwrap_err();
//! assert_eq!(error.call, "buffer_sub_data");
//! # Ok(())
//! # }
//! ```

mod attached;
mod blits;
mod buffer_calls;
mod buffers;
mod commands;
mod containers;
mod context;
mod dispatches;
mod draws;
mod error;
mod feedback;
mod framebuffers;
mod images;
mod indexed;
mod inputs;
mod lifecycle;
mod names;
mod queries;
mod renderbuffers;
mod resources;
mod samplers;
mod sampling;
mod storage;
#[cfg(test)]
mod tests;
mod texel_copies;
mod texture_storage;
mod textures;

pub use blits::BlitMask;
pub use buffers::{BufferFlags, BufferParameters, Contents, MAX_BUFFER_BYTES, Mapping, Usage};
pub use commands::{Elements, IndexType, Indirect};
pub use containers::VertexBuffer;
pub use context::{BufferRef, BufferTarget, Context, ShareGroup};
pub use dispatches::Groups;
pub use draws::Output;
pub use feedback::FeedbackPrimitive;
pub use framebuffers::{AttachmentPoint, FramebufferStatus, FramebufferTarget};
pub use images::{Image, ImageAccess};
pub use inputs::Inputs;
pub use queries::{ConditionalMode, QueryTarget};
pub use sampling::TextureParameter;
pub use textures::{PixelStore, Pixels, PixelsMut, Region};
