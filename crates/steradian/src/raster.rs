//! Pictures by the graphics pipeline: the integrator `raster`.

use steradian_core::ColorMode;
pub use steradian_raster as pipeline;
pub use steradian_realtime::{FrameKind, Options, Projected, Rasterizer};

/// Its name.
pub const RASTER: &str = "raster";

/// The colour mode that suits an integrator, `NAME` or `NAME:key=value,…`, where its scene's format has no say: RGB for
/// the pipeline, since one sample of wavelengths would be noise.
pub fn suited_mode(integrator: &str) -> Option<ColorMode> {
    let name = integrator.split_once(':').map_or(integrator, |(name, _)| name);
    (name == RASTER).then_some(ColorMode::Rgb)
}
