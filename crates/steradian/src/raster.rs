//! Pictures by the graphics pipeline: the integrator `raster`.

use steradian_core::ColorMode;
use steradian_integrators::options::{IntegratorInfo, option};
pub use steradian_raster as pipeline;
pub use steradian_realtime::{FrameKind, Options, Projected, Rasterizer};

/// The colour mode that suits an integrator, `NAME` or `NAME:key=value,…`, where its scene's format has no say: RGB for
/// the pipeline, since one sample of wavelengths would be noise.
pub fn suited_mode(integrator: &str) -> Option<ColorMode> {
    let name = integrator.split_once(':').map_or(integrator, |(name, _)| name);
    (name == RASTER.name).then_some(ColorMode::Rgb)
}

/// The integrator, for the registry.
pub const RASTER: IntegratorInfo = IntegratorInfo {
    name: "raster",
    description: "rasterisation: a smooth preview, with options or --spp direct light, mirrors and glass by rays",
    options: &[
        option(
            "frame",
            "forward, hybrid, preview",
            "forward",
            "preview: smooth, with light after bounces, as without options and --spp; hybrid: light by rays",
        ),
        option("filter", "true, false", "true", "whether the terms of hybrid frames are freed of noise"),
        option(
            "shadows",
            "ray, none, map, cube, trapezoid, perspective, cascades, variance, moments, pcss, volume, volume-pass, planar",
            "ray",
            "how shadows are found",
        ),
        option("size", "16 to 8192", "1024", "edge of shadow maps, texels"),
        option("bias", "number", "1.5", "bias of shadow maps, texels"),
        option("bias-by", "slope, constant, normal, plane", "slope", "what the bias of shadow maps goes by"),
        option("pcf", "1 to 15", "1", "edge of the filter of shadow maps, texels"),
        option("cascades", "1 to 16", "4", "shadow maps along the view, of shadows=cascades"),
        option("visibility", "zbuffer, painter, bsp, newell, warnock", "zbuffer", "how hidden surfaces are removed"),
        option("points", "1 to 1024", "4", "points on each light with an area; previews take one"),
        option("bounces", "0 to 64", "8", "mirrors and panes that are followed"),
        option(
            "show",
            "picture, depth, normal, primitives, overdraw, wireframe, clip, tiles, stencil, shadow-map; \
             of hybrid frames emission, direct, indirect, reflections, transparency, occlusion, graph",
            "picture",
            "what is shown",
        ),
    ],
};
