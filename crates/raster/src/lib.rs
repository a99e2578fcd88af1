//! A programmable graphics pipeline in software.

mod counters;
mod draw;
pub mod error;
pub mod format;
pub mod fragment;
mod front;
pub mod output;
mod pipeline;
mod primitive;
mod samples;
pub mod stages;
pub mod state;
pub mod target;
mod tile;
pub mod varyings;

pub use counters::Counters;
pub use draw::Draw;
pub use error::{Error, Result};
pub use format::Format;
pub use fragment::Fragment;
pub use front::{TessellatedDomain, tessellate};
pub use glam;
pub use pipeline::Pipeline;
pub use samples::{SAMPLE_COUNTS, sample_position};
pub use stages::{Program, Vertex, VertexInput, fragment};
pub use state::State;
pub use target::{ColorTarget, DepthFormat, DepthTarget, Extent, Framebuffer, Layout, StencilTarget};
pub use varyings::Varyings;
