//! Pictures by the graphics pipeline: the integrator `raster`.

use steradian_integrators::options::{IntegratorInfo, option};
pub use steradian_raster as pipeline;
pub use steradian_realtime::{Options, Projected, Rasterizer};

/// The integrator, for the registry.
pub const RASTER: IntegratorInfo = IntegratorInfo {
    name: "raster",
    description: "rasterisation with direct light, mirrors and glass by rays; one sample unless --spp says otherwise",
    options: &[
        option("frame", "forward, hybrid", "forward", "hybrid: light by rays, pass by pass, with one diffuse bounce"),
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
        option("points", "1 to 1024", "4", "points on each light with an area"),
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
