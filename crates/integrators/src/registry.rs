//! The integrators by name.

use crate::{
    Depth, Plan, Precomputed, Stop, VarianceReduction,
    ao::AmbientOcclusion,
    passes::PassKind,
    path::{Path, VolPath},
    path_recursive::PathRecursive,
    radiosity::{self, View},
    raycast::Raycast,
    stokes::Stokes,
    whitted::Whitted,
};

use std::sync::Arc;
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
    ("ao", "ambient occlusion: the part of an even sky that a surface sees; distance (no limit)"),
    ("raycast", "the colour of the first surface"),
    (
        "path-recursive",
        "path tracing in recursive form, bit for bit equal to 'path'; max_depth, rr_depth, hide_emitters, reuse (auto), caustics (auto), effort (auto)",
    ),
    (
        "radiosity",
        "light exchanged by Lambertian patches, solved once for all cameras; method (gauss-seidel, jacobi, direct, shooting, hierarchical, stochastic), factors (analytic, montecarlo, hemicube), patches (2000), adaptive (1), tolerance, rays, gather (0), smooth (true), ambient, solution (a file that keeps it)",
    ),
    (
        "light",
        "light tracing: paths from lights, connected to the camera; for caustics on surfaces that are not smooth; max_depth, rr_depth, hide_emitters",
    ),
    (
        "bdpt",
        "bidirectional path tracing with all connections, weighted by the power heuristic; max_depth, rr_depth, hide_emitters",
    ),
    (
        "vcm",
        "vertex connection and merging: bidirectional path tracing and photons; max_depth, rr_depth, hide_emitters, radius or pixels (3)",
    ),
    (
        "sppm",
        "stochastic progressive photon mapping; max_depth, rr_depth, hide_emitters, radius or pixels (3), photons (one for a pixel)",
    ),
    (
        "photon",
        "photon mapping with a map of caustics and a final gather; max_depth, rr_depth, hide_emitters, radius or pixels (1), photons (one for a pixel), nearest (all), gather (true)",
    ),
    (
        "pssmlt",
        "Metropolis light transport over the random numbers of bidirectional paths; max_depth, rr_depth, hide_emitters, large_step (0.3)",
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
    /// Ambient occlusion.
    AmbientOcclusion(AmbientOcclusion),
    /// Views of radiosity.
    Radiosity(View),
    /// A method that works by passes.
    Passes(PassKind),
}

impl IntegratorKind {
    /// By name; `None` for names that are not in [`INTEGRATORS`].
    pub fn named(name: &str, depth: Depth, variance_reduction: VarianceReduction) -> Option<Self> {
        Some(match name {
            "path" => Self::Path(Path { depth, variance_reduction }),
            "volpath" => Self::VolPath(VolPath { depth, variance_reduction }),
            "direct" => Self::Path(Path { depth: Depth { max: depth.max.min(1), ..depth }, variance_reduction }),
            "whitted" => Self::Whitted(Whitted { depth }),
            "raycast" => Self::Raycast(Raycast),
            "path-recursive" => Self::PathRecursive(PathRecursive { depth, variance_reduction }),
            "ao" => Self::AmbientOcclusion(AmbientOcclusion { distance: f32::INFINITY }),
            "radiosity" => {
                Self::Radiosity(View { settings: radiosity::Settings::default(), depth, gather: 0, smooth: true })
            }
            "stokes" => Self::Stokes(Stokes { depth, component: 0 }),
            "stokes-s1" => Self::Stokes(Stokes { depth, component: 1 }),
            "stokes-s2" => Self::Stokes(Stokes { depth, component: 2 }),
            "stokes-s3" => Self::Stokes(Stokes { depth, component: 3 }),
            _ => return PassKind::named(name, depth).map(Self::Passes),
        })
    }

    /// Whether it has the options `reuse`, `caustics` and `effort`.
    pub fn has_tactics(&self) -> bool {
        matches!(self, Self::Path(_) | Self::VolPath(_) | Self::PathRecursive(_))
    }

    /// Changes an option that is the integrator's own; whether there is such an option and value.
    pub fn set(&mut self, key: &str, value: &str) -> bool {
        match self {
            Self::Passes(kind) => kind.set(key, value),
            _ => false,
        }
    }

    /// What of a scene it cannot do, or only in part; `None` where it can do all.
    pub fn cannot(&self, scene: &Scene) -> Option<String> {
        match self {
            Self::Passes(kind) => kind.cannot(scene),
            Self::Path(_) | Self::PathRecursive(_) if scene.has_media => Some("participating media".into()),
            Self::Radiosity(_) => match radiosity::beyond_lambert(scene) {
                Ok(names) if names.is_empty() => None,
                Ok(names) => Some(format!("materials that are not Lambertian: '{}'", names.join("', '"))),
                Err(refusal) => Some(refusal.to_string()),
            },
            _ => None,
        }
    }

    /// What the integrator wants to know of a scene before a render; of no use where a stop was asked for meanwhile.
    pub(crate) fn precomputed(&self, scene: &Scene, plan: &Plan, stop: &Stop) -> Precomputed {
        match self {
            Self::Path(i) if i.depth.max > 1 => Precomputed::new(scene, i, plan, stop),
            Self::PathRecursive(i) if i.depth.max > 1 => Precomputed::new(scene, i, plan, stop),
            Self::VolPath(i) if i.depth.max > 1 => Precomputed::new(scene, i, plan, stop),
            // What cannot be solved is refused before a session is made; it is black here.
            Self::Radiosity(i) => match radiosity::solve(scene, &i.settings, stop) {
                Ok(Some(solution)) => Precomputed::of_radiosity(Arc::new(solution)),
                _ => Precomputed::default(),
            },
            _ => Precomputed::default(),
        }
    }
}
