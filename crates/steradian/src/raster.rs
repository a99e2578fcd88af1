//! Pictures by the graphics pipeline: the integrator `raster`.

pub use steradian_raster as pipeline;
pub use steradian_realtime::{Options, Projected, Rasterizer};

/// Name and description of the integrator, for the registry.
pub const RASTER: (&str, &str) = (
    "raster",
    "what is seen by the graphics pipeline, direct light on it, and mirrors and glass by rays, at once: one sample per pixel unless --spp says otherwise; shadows (ray, none, of maps: map, cube, trapezoid, perspective, cascades, variance, moments, pcss; volume, volume-pass, planar), size (1024), bias (1.5), bias-by (slope, constant, normal, plane), pcf (1), cascades (4) of shadow maps, visibility (zbuffer, painter, bsp, newell, warnock), points (4) on each light, bounces (8), show (picture, depth, normal, primitives, overdraw, wireframe, clip, tiles, stencil, shadow-map)",
);
