//! The integrators by name.

use crate::{
    Depth, Plan, Stop, Survey, Tactics,
    path::{Path, VolPath},
    path_recursive::PathRecursive,
    raycast::Raycast,
    stokes::Stokes,
    whitted::Whitted,
};

use steradian_core::Scene;

/// The integrators: name, and what it does.
pub const INTEGRATORS: &[(&str, &str)] = &[
    (
        "path",
        "path tracing with next-event estimation, multiple importance sampling, Russian roulette, paths shared among pixels, and photons that find light behind mirrors and glass where that pays; max_depth, rr_depth, hide_emitters, reuse (auto), caustics (auto), effort (auto)",
    ),
    (
        "volpath",
        "the same through participating media; max_depth, rr_depth, hide_emitters, reuse (auto), caustics (auto), effort (auto)",
    ),
    ("direct", "light that scattered once; hide_emitters"),
    ("whitted", "mirrors and glass followed both ways, every light asked at every surface; max_depth"),
    ("raycast", "the colour of the first surface"),
    (
        "path-recursive",
        "path tracing in recursive form, bit for bit equal to 'path'; max_depth, rr_depth, hide_emitters, reuse (auto), caustics (auto), effort (auto)",
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
    pub fn named(name: &str, depth: Depth, tactics: Tactics) -> Option<Self> {
        Some(match name {
            "path" => Self::Path(Path { depth, tactics }),
            "volpath" => Self::VolPath(VolPath { depth, tactics }),
            "direct" => Self::Path(Path { depth: Depth { max: depth.max.min(1), ..depth }, tactics }),
            "whitted" => Self::Whitted(Whitted { depth }),
            "raycast" => Self::Raycast(Raycast),
            "path-recursive" => Self::PathRecursive(PathRecursive { depth, tactics }),
            "stokes" => Self::Stokes(Stokes { depth, component: 0 }),
            "stokes-s1" => Self::Stokes(Stokes { depth, component: 1 }),
            "stokes-s2" => Self::Stokes(Stokes { depth, component: 2 }),
            "stokes-s3" => Self::Stokes(Stokes { depth, component: 3 }),
            _ => return None,
        })
    }

    /// What the integrator wants to know of a scene before a render; of no use where a stop was asked for meanwhile.
    pub(crate) fn survey(&self, scene: &Scene, plan: &Plan, stop: &Stop) -> Survey {
        match self {
            Self::Path(i) if i.depth.max > 1 => Survey::new(scene, i, plan, stop),
            Self::PathRecursive(i) if i.depth.max > 1 => Survey::new(scene, i, plan, stop),
            Self::VolPath(i) if i.depth.max > 1 => Survey::new(scene, i, plan, stop),
            _ => Survey::default(),
        }
    }
}
