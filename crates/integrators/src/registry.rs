//! The integrators by name.

use crate::{Depth, path::Path, path_recursive::PathRecursive, raycast::Raycast, volpath::VolPath, whitted::Whitted};

/// The integrators: name, and what it does.
pub const INTEGRATORS: &[(&str, &str)] = &[
    (
        "path",
        "path tracing with next-event estimation, multiple importance sampling and Russian roulette; max_depth, rr_depth, hide_emitters",
    ),
    ("volpath", "path tracing through participating media; max_depth, rr_depth, hide_emitters"),
    ("direct", "light that scattered once; hide_emitters"),
    ("whitted", "mirrors and glass followed both ways, every light asked at every surface; max_depth"),
    ("raycast", "the colour of the first surface"),
    (
        "path-recursive",
        "path tracing in recursive form, bit for bit equal to 'path'; max_depth, rr_depth, hide_emitters",
    ),
];

/// An integrator, ready to run.
#[derive(Clone, Copy, Debug)]
pub enum IntegratorKind {
    /// Path tracing.
    Path(Path),
    /// Path tracing through media.
    VolPath(VolPath),
    /// Whitted's ray tracing.
    Whitted(Whitted),
    /// Ray casting.
    Raycast(Raycast),
    /// Path tracing, recursive.
    PathRecursive(PathRecursive),
}

impl IntegratorKind {
    /// By name; `None` for names that are not in [`INTEGRATORS`].
    pub fn named(name: &str, depth: Depth) -> Option<Self> {
        Some(match name {
            "path" => Self::Path(Path { depth }),
            "volpath" => Self::VolPath(VolPath { depth }),
            "direct" => Self::Path(Path { depth: Depth { max: depth.max.min(1), ..depth } }),
            "whitted" => Self::Whitted(Whitted { depth }),
            "raycast" => Self::Raycast(Raycast),
            "path-recursive" => Self::PathRecursive(PathRecursive { depth }),
            _ => return None,
        })
    }
}
