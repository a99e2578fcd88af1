//! The integrators by name.

use crate::{
    Depth, path::Path, path_recursive::PathRecursive, raycast::Raycast, stokes::Stokes, volpath::VolPath,
    whitted::Whitted,
};

/// The integrators: name, and what it does.
pub const INTEGRATORS: &[(&str, &str)] = &[
    (
        "path",
        "path tracing with next-event estimation, multiple importance sampling, Russian roulette and paths shared among pixels; max_depth, rr_depth, hide_emitters, reuse (16)",
    ),
    ("volpath", "path tracing through participating media; max_depth, rr_depth, hide_emitters"),
    ("direct", "light that scattered once; hide_emitters"),
    ("whitted", "mirrors and glass followed both ways, every light asked at every surface; max_depth"),
    ("raycast", "the colour of the first surface"),
    (
        "path-recursive",
        "path tracing in recursive form, bit for bit equal to 'path'; max_depth, rr_depth, hide_emitters, reuse (16)",
    ),
    ("stokes", "path tracing of polarised light: its radiance S0; max_depth, rr_depth, hide_emitters"),
    ("stokes-s1", "of polarised light, the horizontal over the vertical polarisation S1 (may be negative)"),
    ("stokes-s2", "of polarised light, the diagonal polarisation S2 (may be negative)"),
    ("stokes-s3", "of polarised light, the circular polarisation S3 (may be negative)"),
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
    /// Path tracing of polarised light.
    Stokes(Stokes),
}

impl IntegratorKind {
    /// By name; `None` for names that are not in [`INTEGRATORS`].
    pub fn named(name: &str, depth: Depth, reuse: u32) -> Option<Self> {
        Some(match name {
            "path" => Self::Path(Path { depth, reuse }),
            "volpath" => Self::VolPath(VolPath { depth }),
            "direct" => Self::Path(Path { depth: Depth { max: depth.max.min(1), ..depth }, reuse }),
            "whitted" => Self::Whitted(Whitted { depth }),
            "raycast" => Self::Raycast(Raycast),
            "path-recursive" => Self::PathRecursive(PathRecursive { depth, reuse }),
            "stokes" => Self::Stokes(Stokes { depth, component: 0 }),
            "stokes-s1" => Self::Stokes(Stokes { depth, component: 1 }),
            "stokes-s2" => Self::Stokes(Stokes { depth, component: 2 }),
            "stokes-s3" => Self::Stokes(Stokes { depth, component: 3 }),
            _ => return None,
        })
    }
}
