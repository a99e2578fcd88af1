//! The stages before the rasteriser: vertices, patches, assembled primitives, geometry shaders.

mod assembly;
mod capture;
mod tessellator;
mod vertices;

pub(crate) use assembly::{Front, Sink};
pub(crate) use capture::Capture;
pub use tessellator::{TessellatedDomain, tessellate};
pub(crate) use vertices::{Source, Stream};
