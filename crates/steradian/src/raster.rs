//! Pictures by the graphics pipeline: the integrator `raster`.

pub use steradian_raster as pipeline;
pub use steradian_realtime::{FrameKind, Options, Projected, Rasterizer};
