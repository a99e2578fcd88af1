//! Integrators: methods that render a scene, with the options of each, written `NAME:key=value,…` or as a node of a
//! scene.

use crate::{
    model::Model,
    parameter::{ANY, POSITIVE, Parameter, file, flag, integer, number, word},
};

/// Largest whole number of an option.
const MOST: f64 = u32::MAX as f64;

const MAX_DEPTH: Parameter =
    integer("max_depth", (-1.0, MOST), "-1; the scene's", "most scattering events; -1: no limit").refused();
const RR_DEPTH: Parameter =
    integer("rr_depth", (0.0, MOST), "2; the scene's", "scattering events before Russian roulette").refused();
const HIDE_EMITTERS: Parameter =
    flag("hide_emitters", "false; the scene's", "whether camera rays pass lights, to what is behind them");
const REUSE: Parameter =
    word("reuse", "auto, 1, 4, 16", "1", "neighbouring pixels that share what their paths find; auto: by a trial");
const CAUSTICS: Parameter = word(
    "caustics",
    "auto, true, false",
    "auto",
    "whether photons guide paths to light behind mirrors and glass; auto: by a trial",
);
const GUIDING: Parameter = word(
    "guiding",
    "auto, true, false",
    "false",
    "whether paths of a training guide the picture's to where light comes from; auto: where the training says it pays",
);
const EFFORT: Parameter = word(
    "effort",
    "auto, even",
    "auto",
    "whether trials choose light samples, roulette, and paths per sample by parts of the picture",
);
const RADIUS: Parameter =
    number("radius", POSITIVE, "pixels", "radius in which photons are gathered").unit("scene units").refused();
const PHOTONS: Parameter = integer("photons", (0.0, MOST), "0", "photons of a pass; 0: as many as pixels").refused();

const fn pixels(default: &'static str) -> Parameter {
    number("pixels", POSITIVE, default, "radius in which photons are gathered, in widths of a pixel").refused()
}

const PATHS: &[Parameter] = &[MAX_DEPTH, RR_DEPTH, HIDE_EMITTERS];
const GUIDED_PATHS: &[Parameter] = &[MAX_DEPTH, RR_DEPTH, HIDE_EMITTERS, REUSE, CAUSTICS, GUIDING, EFFORT];

const fn method(
    kind: &'static str,
    doc: &'static str,
    parameters: &'static [Parameter],
    source: &'static str,
) -> Model {
    Model { kind, doc, parameters, groups: &[], source }
}

const RADIOSITY: &[Parameter] = &[
    word(
        "method",
        "gauss-seidel, jacobi, direct, shooting, hierarchical, stochastic",
        "gauss-seidel",
        "how the system is solved",
    ),
    word("factors", "analytic, montecarlo, hemicube", "analytic", "how form factors are computed"),
    integer(
        "resolution",
        (2.0, 4096.0),
        "1000; 64 with factors=hemicube",
        "rays of a patch, or pixels of an edge of the hemicube",
    )
    .refused(),
    integer("patches", (1.0, 2e6), "2000", "patches of the scene; finer meshes share their light").refused(),
    integer("adaptive", (0.0, 8.0), "1", "how often patches are split that differ most from their neighbours")
        .refused(),
    number(
        "tolerance",
        (f64::MIN_POSITIVE, 0.999_999),
        "0.0001",
        "relative change, or share of light unshot, that ends solving",
    )
    .refused(),
    integer("rays", (1.0, 1e6), "1000", "rays of a patch").with("method", "stochastic").refused(),
    integer("wavelengths", (4.0, 256.0), "32", "wavelengths of a spectral solution").refused(),
    flag("ambient", "false", "whether light that is not shot is shown as ambient").with("method", "shooting"),
    integer("gather", (0.0, 4096.0), "0", "rays of a final gather for each camera sample").refused(),
    flag("smooth", "true", "whether irradiance is interpolated between vertices"),
    file("solution", "none", "where the solution is kept for further views"),
    MAX_DEPTH,
    HIDE_EMITTERS,
];

const METROPOLIS: &[Parameter] = &[
    MAX_DEPTH,
    RR_DEPTH,
    HIDE_EMITTERS,
    number("large_step", (f64::MIN_POSITIVE, 1.0), "0.3", "probability of a path that is independent of the last one")
        .refused(),
    integer("samples", (1.0, 16_777_216.0), "none", "mutations per pixel, instead of the sampler's samples").refused(),
];

const TRANSIENT: &[Parameter] = &[
    number("from", ANY, "0", "the optical length where the first interval begins").unit("m").refused(),
    number("to", ANY, "10", "the optical length where the last interval ends; more than from").unit("m").refused(),
    integer("bins", (1.0, 1024.0), "32", "into how many intervals of the same length that is cut").refused(),
    number("unit", POSITIVE, "1", "metres of a unit of the scene").refused(),
    flag("camera", "true", "whether the way from the camera to what it sees counts"),
    MAX_DEPTH,
    RR_DEPTH,
    HIDE_EMITTERS,
];

const GATHER: &[Parameter] = &[
    integer("rays", (1.0, 1048576.0), "4", "directions at each surface").refused(),
    integer(
        "branches",
        (1.0, 1048576.0),
        "256",
        "most branches of a ray, or as many as rays; surfaces at which there would be more send one, as paths do",
    )
    .refused(),
    word(
        "directions",
        "random, grid",
        "random",
        "by random numbers, or the midpoints of a grid: without noise, biased",
    ),
    MAX_DEPTH,
    RR_DEPTH,
    HIDE_EMITTERS,
];

const IRRADIANCE_CACHE: &[Parameter] = &[
    integer("rays", (1.0, 65536.0), "512", "rays of a record, about").refused(),
    number("error", (0.001, 1.0), "0.2", "largest error of a record that counts, Ward's a").refused(),
    flag("gradients", "true", "whether irradiance is extrapolated by its gradients"),
    number("min_spacing", POSITIVE, "3", "least reach of a record, in pixels").refused(),
    number("max_spacing", POSITIVE, "40", "largest reach of a record, in pixels").refused(),
    integer("records", (0.0, 1e7), "1000000", "most records; paths go on where there are none").refused(),
    integer("wavelengths", (4.0, 256.0), "16", "wavelengths of records in spectral renders").refused(),
    MAX_DEPTH,
    RR_DEPTH,
    HIDE_EMITTERS,
];

const RASTER: &[Parameter] = &[
    word(
        "frame",
        "forward, hybrid, preview",
        "forward; preview without options and --spp",
        "preview: smooth, with light after bounces; hybrid: light by rays",
    ),
    flag("filter", "true", "whether the terms of hybrid frames are freed of noise"),
    word(
        "shadows",
        "ray, none, map, cube, trapezoid, perspective, cascades, variance, moments, pcss, volume, volume-pass, planar",
        "ray",
        "how shadows are found",
    ),
    integer("size", (16.0, 8192.0), "1024", "edge of shadow maps").unit("texels").refused(),
    number("bias", ANY, "1.5", "bias of shadow maps").unit("texels").refused(),
    word("bias-by", "slope, constant, normal, plane", "slope", "what the bias of shadow maps goes by"),
    integer("pcf", (1.0, 15.0), "1", "edge of the filter of shadow maps").unit("texels").refused(),
    integer("pcf-samples", (0.0, 225.0), "0", "texels of that filter that are compared, spread evenly; 0 for all")
        .refused(),
    integer("cascades", (1.0, 16.0), "4", "shadow maps along the view").with("shadows", "cascades").refused(),
    word("visibility", "zbuffer, painter, bsp, newell, warnock", "zbuffer", "how hidden surfaces are removed"),
    word(
        "culling",
        "items, none, frustum, hiz, occlusion, portals, pvs, screen-size",
        "items",
        "what is not drawn; in frames frame=forward: items, or chunks of 256 primitives, outside the view, hidden, small",
    ),
    word("bounds", "aabb, sphere, obb, kdop, hull", "aabb", "bounding volumes of the chunks that culling tests"),
    word(
        "transparency",
        "a-buffer, peel, bsp, sorted, weighted, dither",
        "a-buffer",
        "how transparent surfaces are blended: exactly (a-buffer, peel, bsp), nearly, or by chance; hybrid frames dither",
    ),
    integer("layers", (1.0, 1024.0), "8", "transparent layers of a pixel").with("transparency", "peel").refused(),
    word(
        "lights",
        "chosen, all, clustered",
        "chosen",
        "lights of each point: some of many, by chance; all; those that matter in a cell of the view",
    ),
    integer("points", (1.0, 1024.0), "4", "points on each light with an area; previews take one").refused(),
    integer("bounces", (0.0, 64.0), "8", "mirrors and panes that are followed").refused(),
    word(
        "shading",
        "flat, flat-centre, gouraud, phong, pixel",
        "pixel",
        "where triangles are lit: at the first corner, the middle, all corners, or each pixel; pixel: with normal maps",
    ),
    word(
        "environment",
        "sampled, harmonics, prefiltered",
        "sampled",
        "light of environments: by rays; without shadows on diffuse surfaces by nine spherical harmonics, on rough ones \
         by blurred maps",
    ),
    word(
        "show",
        "picture, depth, normal, primitives, overdraw, wireframe, clip, tiles, culling, stencil, shadow-map, emission, \
         direct, indirect, reflections, transparency, occlusion, graph",
        "picture",
        "what is shown; from emission on, of hybrid frames",
    ),
    HIDE_EMITTERS,
];

const STRUCTURE: &[Parameter] = &[
    word(
        "structure",
        "bvh, bvh-reinsertion, bvh-spatial, bvh-ploc, bvh2, bvh4, bvh16, bvh-quantised, grid, octree, kdtree, \
         kdtree-ropes, kdtree-median, bsp, none",
        "--accelerator's",
        "acceleration structure that is built over the scene and shown (steradian list accelerators)",
    ),
    word(
        "show",
        "steps, boxes, cells",
        "steps",
        "steps: cost of the ray of each pixel; boxes: those of a level, before the surfaces; cells: a colour for each leaf",
    ),
    integer("most", (1.0, MOST), "100", "nodes visited and primitives tested at the end of the colour scale")
        .with("show", "steps")
        .refused(),
    integer("level", (0.0, 1000.0), "3", "level below the root whose boxes are shown, with the leaves above it")
        .with("show", "boxes")
        .refused(),
];

/// All integrators.
pub const INTEGRATORS: &[Model] = &[
    method("path", "path tracing", GUIDED_PATHS, "Kajiya, The rendering equation (1986)"),
    method("volpath", "path tracing with participating media", GUIDED_PATHS, "pbrt-v4, 14.2"),
    method("direct", "direct light", &[HIDE_EMITTERS], "pbrt-v4, 13.2"),
    method(
        "whitted",
        "Whitted ray tracing: mirrors, glass, and direct light from every light",
        &[MAX_DEPTH, HIDE_EMITTERS],
        "Whitted, An improved illumination model for shaded display (1980)",
    ),
    method(
        "ao",
        "ambient occlusion",
        &[number("distance", POSITIVE, "none", "how far away something may be to stop light")
            .unit("scene units")
            .refused()],
        "",
    ),
    method(
        "gather",
        "many directions at each surface, and again at what they meet",
        GATHER,
        "Kajiya, The rendering equation (1986); Davis, Rabinowitz, Methods of numerical integration (1984)",
    ),
    method(
        "irradiance-cache",
        "indirect irradiance by many rays at few points, interpolated between them",
        IRRADIANCE_CACHE,
        "Ward, Rubinstein, Clear, A ray tracing solution for diffuse interreflection (1988)",
    ),
    method("raycast", "the colour of the first surface", &[HIDE_EMITTERS], ""),
    method("structure", "the acceleration structure: its steps, boxes or cells", STRUCTURE, ""),
    method(
        "radiosity",
        "radiosity of Lambertian patches",
        RADIOSITY,
        "Goral and others, Modeling the interaction of light between diffuse surfaces (1984)",
    ),
    method("light", "light tracing: paths from lights to the camera", PATHS, "pbrt-v3, 16.3"),
    method(
        "bdpt",
        "bidirectional path tracing",
        PATHS,
        "Veach, Robust Monte Carlo methods for light transport simulation (1997), ch. 10",
    ),
    method(
        "vcm",
        "vertex connection and merging",
        &[MAX_DEPTH, RR_DEPTH, HIDE_EMITTERS, RADIUS, pixels("0.6")],
        "Georgiev and others, Light transport simulation with vertex connection and merging (2012)",
    ),
    method(
        "sppm",
        "stochastic progressive photon mapping",
        &[MAX_DEPTH, RR_DEPTH, HIDE_EMITTERS, RADIUS, pixels("3"), PHOTONS],
        "Hachisuka, Jensen, Stochastic progressive photon mapping (2009)",
    ),
    method(
        "photon",
        "photon mapping",
        &[
            MAX_DEPTH,
            RR_DEPTH,
            HIDE_EMITTERS,
            RADIUS,
            pixels("1"),
            PHOTONS,
            integer("nearest", (0.0, MOST), "0", "most photons that are gathered at a point; 0: all").refused(),
            flag("gather", "true", "whether the map is looked up one bounce further on"),
        ],
        "Jensen, Global illumination using photon maps (1996)",
    ),
    method(
        "pssmlt",
        "Metropolis light transport in primary sample space",
        METROPOLIS,
        "Kelemen and others, A simple and robust mutation strategy for the Metropolis light transport algorithm (2002)",
    ),
    method(
        "mmlt",
        "multiplexed Metropolis light transport: chains choose how their paths are found",
        METROPOLIS,
        "Hachisuka, Kaplanyan, Dachsbacher, Multiplexed Metropolis light transport (2014)",
    ),
    method(
        "transient",
        "path tracing that tells when light of one pulse arrives: a layer bin.NNN of each interval",
        TRANSIENT,
        "Jarabo and others, A framework for transient rendering (2014)",
    ),
    method("stokes", "path tracing of polarised light: radiance S0", PATHS, "Mitsuba 3, stokes"),
    method("stokes-s1", "polarised light: S1, horizontal minus vertical (may be negative)", PATHS, "Mitsuba 3, stokes"),
    method("stokes-s2", "polarised light: S2, diagonal (may be negative)", PATHS, "Mitsuba 3, stokes"),
    method("stokes-s3", "polarised light: S3, circular (may be negative)", PATHS, "Mitsuba 3, stokes"),
    method(
        "raster",
        "rasterisation: a smooth preview, with options or --spp direct light, mirrors and glass by rays",
        RASTER,
        "",
    ),
];

/// The row of the path tracer: on surfaces alone (`path`), or through media (`volpath`).
pub const fn path_tracer(media: bool) -> &'static Model {
    &INTEGRATORS[if media { 1 } else { 0 }]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn path_tracers_come_first() {
        assert_eq!([false, true].map(|media| path_tracer(media).kind), ["path", "volpath"]);
    }
}
