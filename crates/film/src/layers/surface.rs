//! Layers of the first surface along camera rays.

use super::{Layer, Names, Row, Write::Hits};
use crate::{FirstHit, LayerInputs};

const fn surface(
    name: &'static str,
    channels: &'static [&'static str],
    doc: &'static str,
    write: fn(&FirstHit, &Names) -> [f32; 3],
) -> Row {
    Row { name, channels, doc, in_all: true, inputs: LayerInputs::FIRST_HITS, write: Hits(write) }
}

/// Reflectance.
pub const ALBEDO: Layer = Layer(&surface(
    "albedo",
    &["albedo.R", "albedo.G", "albedo.B"],
    "reflectance of the first surface, linear Rec.709 in [0, 1]: albedo.R albedo.G albedo.B",
    |hit, _| hit.albedo,
));

/// Shading normal.
pub const NORMAL: Layer = Layer(&surface(
    "normal",
    &["N.X", "N.Y", "N.Z"],
    "shading normal in the world, zero where nothing is hit: N.X N.Y N.Z",
    |hit, _| hit.normal,
));

/// Albedo behind mirrors and smooth glass.
pub const DENOISE_ALBEDO: Layer = Layer(&Row {
    in_all: false,
    inputs: LayerInputs::SEEN_THROUGH,
    ..surface(
        "denoise_albedo",
        &["denoise_albedo.R", "denoise_albedo.G", "denoise_albedo.B"],
        "albedo of what is seen in mirrors and through smooth glass: denoise_albedo.R .G .B; not among 'all'",
        |hit, _| hit.seen_albedo,
    )
});

/// Shading normal behind mirrors and smooth glass.
pub const DENOISE_NORMAL: Layer = Layer(&Row {
    in_all: false,
    inputs: LayerInputs::SEEN_THROUGH,
    ..surface(
        "denoise_normal",
        &["denoise_normal.X", "denoise_normal.Y", "denoise_normal.Z"],
        "shading normal of what mirrors and smooth glass show: denoise_normal.X .Y .Z; not among 'all'",
        |hit, _| hit.seen_normal,
    )
});

/// Geometric normal.
pub const GEOMETRIC_NORMAL: Layer = Layer(&surface(
    "geometric_normal",
    &["Ng.X", "Ng.Y", "Ng.Z"],
    "geometric normal in the world, towards the camera: Ng.X Ng.Y Ng.Z",
    |hit, _| hit.geometric_normal,
));

/// World position.
pub const POSITION: Layer = Layer(&surface(
    "position",
    &["P.X", "P.Y", "P.Z"],
    "world position of the first surface: P.X P.Y P.Z",
    |hit, names| match hit.coverage > 0.0 {
        true => std::array::from_fn(|axis| (f64::from(hit.position[axis]) + names.origin[axis]) as f32),
        false => hit.position,
    },
));

/// Distance along the camera's axis, and along the ray.
pub const DEPTH: Layer = Layer(&surface(
    "depth",
    &["Z", "depth.Z"],
    "distance along the camera's axis (Z) and along the ray (depth.Z); infinite where nothing is hit",
    |hit, _| [hit.depth, hit.distance, 0.0],
));

/// Motion on the screen since the frame before.
pub const MOTION: Layer = Layer(&Row {
    in_all: false,
    inputs: LayerInputs::MOTION,
    ..surface(
        "motion",
        &["motion.X", "motion.Y", "motion.Z"],
        "pixels it has moved since the frame before, right and down, and how much away: motion.X .Y .Z; with \
         --frames; not among 'all'",
        |hit, _| hit.motion,
    )
});

/// Surface parameters.
pub const UV: Layer =
    Layer(&surface("uv", &["uv.U", "uv.V"], "surface parameters: uv.U uv.V", |hit, _| [hit.uv[0], hit.uv[1], 0.0]));

/// Numbers of shape and material.
pub const IDS: Layer = Layer(&surface(
    "ids",
    &["object_id.Y", "material_id.Y"],
    "numbers of shape and material from one, zero for nothing: object_id.Y material_id.Y",
    |hit, _| [hit.shape as f32, hit.material as f32, 0.0],
));

/// Coverage.
pub const ALPHA: Layer = Layer(&surface(
    "alpha",
    &["A"],
    "part of the pixel that surfaces cover, shadow catchers by their shadows: A; --transparent leaves out the \
     background",
    |hit, _| [hit.opacity, 0.0, 0.0],
));
