//! The integrators by name.

use crate::{
    Depth, Plan, Session, VarianceReduction,
    ao::AmbientOcclusion,
    passes::{PassKind, for_paths_alone, missed_caustics},
    path::PathTracer,
    radiosity::{self, Solution, View},
    raycast::Raycast,
    shared_path::SharedPath,
    stokes::Stokes,
    transient::Transient,
    whitted::Whitted,
};

use std::sync::Arc;
use steradian_core::Scene;
use steradian_engine::{Integrator as _, OneByOne, Tiles};
use steradian_math::Vec3;

/// An integrator, ready to run.
#[derive(Clone, Copy, Debug)]
pub enum IntegratorKind {
    /// Path tracing.
    Path(SharedPath<false>),
    /// Path tracing through media.
    VolPath(SharedPath<true>),
    /// Whitted's ray tracing.
    Whitted(Whitted),
    /// Ray casting.
    Raycast(Raycast),
    /// Path tracing of polarised light.
    Stokes(Stokes),
    /// Ambient occlusion.
    AmbientOcclusion(AmbientOcclusion),
    /// Views of radiosity.
    Radiosity(View),
    /// Path tracing by the arrival of light.
    Transient(Transient),
    /// A method that works by passes.
    Passes(PassKind),
}

impl IntegratorKind {
    /// What caustics of lights without size add to the mean of the picture where this method cannot find them; `None`
    /// of methods that can, or that do not claim to find all light.
    pub fn missed_caustics(&self, scene: &Scene) -> Option<Vec3> {
        let depth = match self {
            Self::Path(i) => i.path.depth,
            Self::VolPath(i) => i.path.depth,
            Self::Stokes(i) => i.depth,
            Self::Transient(i) => i.depth,
            _ => return None,
        };
        Some(missed_caustics(scene, &depth))
    }

    /// By name; `None` for other names and the graphics pipeline's.
    pub fn named(name: &str, depth: Depth, variance_reduction: VarianceReduction) -> Option<Self> {
        Some(match name {
            "path" => Self::Path(SharedPath { path: PathTracer { depth }, variance_reduction }),
            "volpath" => Self::VolPath(SharedPath { path: PathTracer { depth }, variance_reduction }),
            "direct" => {
                let path = PathTracer { depth: Depth { max: depth.max.min(1), ..depth } };
                Self::Path(SharedPath { path, variance_reduction })
            }
            "whitted" => Self::Whitted(Whitted { depth }),
            "raycast" => Self::Raycast(Raycast { hide_emitters: depth.hide_emitters }),
            "ao" => Self::AmbientOcclusion(AmbientOcclusion { distance: f32::INFINITY }),
            "radiosity" => {
                Self::Radiosity(View { settings: radiosity::Settings::default(), depth, gather: 0, smooth: true })
            }
            "transient" => Self::Transient(Transient::new(depth)),
            "stokes" => Self::Stokes(Stokes { depth, component: 0 }),
            "stokes-s1" => Self::Stokes(Stokes { depth, component: 1 }),
            "stokes-s2" => Self::Stokes(Stokes { depth, component: 2 }),
            "stokes-s3" => Self::Stokes(Stokes { depth, component: 3 }),
            _ => return PassKind::named(name, depth).map(Self::Passes),
        })
    }

    /// Changes an option that is the integrator's own; whether there is such an option and value.
    pub fn set(&mut self, key: &str, value: &str) -> bool {
        match self {
            Self::Passes(kind) => kind.set(key, value),
            Self::Transient(i) => i.set(key, value),
            _ => false,
        }
    }

    /// Into how many intervals of its arrival it cuts light; 0 where it does not.
    pub fn bins(&self) -> u32 {
        match self {
            Self::Transient(i) => i.bins(),
            _ => 0,
        }
    }

    /// What of a scene it refuses, having no picture of it; `None` where it has one.
    pub fn refuses(&self, scene: &Scene) -> Option<String> {
        match self {
            Self::Passes(kind) => kind.cannot(scene),
            Self::Transient(i) => i.refuses(scene),
            Self::Whitted(_) | Self::Stokes(_) => for_paths_alone(scene).map(Into::into),
            Self::Radiosity(_) if scene.has_schedules() || scene.is_fluorescent() => {
                for_paths_alone(scene).map(Into::into)
            }
            _ => None,
        }
    }

    /// What of a scene it cannot do, or only in part; `None` where it can do all.
    pub fn cannot(&self, scene: &Scene) -> Option<String> {
        match self {
            Self::Passes(kind) => self.refuses(scene).or_else(|| kind.leaves_out(scene)),
            Self::Transient(_) | Self::Whitted(_) | Self::Stokes(_) => self.refuses(scene),
            Self::Path(_) if scene.has_media() => Some("participating media".into()),
            Self::Radiosity(_) if scene.has_surface_detail() => Some("normal and bump maps".into()),
            Self::Radiosity(_) => match (radiosity::beyond_lambert(scene), radiosity::not_cut(scene)) {
                (Ok(names), Ok(kinds)) if names.is_empty() && kinds.is_empty() => None,
                (Ok(names), Ok(kinds)) if names.is_empty() => {
                    Some(format!("{}: they have no patches", kinds.join(", ")))
                }
                (Ok(names), Ok(_)) => Some(format!("materials that are not Lambertian: '{}'", names.join("', '"))),
                (Err(refusal), _) | (_, Err(refusal)) => Some(refusal.to_string()),
            },
            _ => None,
        }
    }

    /// A render with an empty film.
    pub fn session(&self, scene: Arc<Scene>, plan: Plan) -> Box<dyn Session> {
        let takes_all = matches!(self, Self::Path(_) | Self::VolPath(_) | Self::Transient(_));
        let scene = if scene.is_for_paths_alone() && !takes_all {
            Arc::new(Scene::clone(&scene).with_local_scattering())
        } else {
            scene
        };
        match *self {
            Self::Path(i) => Box::new(Tiles::new(scene, i, plan)),
            Self::VolPath(i) => Box::new(Tiles::new(scene, i, plan)),
            Self::Whitted(i) => Box::new(Tiles::per_pixel(scene, i, plan)),
            Self::Raycast(i) => Box::new(Tiles::per_pixel(scene, i, plan)),
            Self::Stokes(i) => Box::new(Tiles::per_pixel(scene, i, plan)),
            Self::AmbientOcclusion(i) => Box::new(Tiles::per_pixel(scene, i, plan)),
            Self::Transient(i) => Box::new(Tiles::per_pixel(scene, i, plan)),
            Self::Radiosity(i) => Box::new(Tiles::per_pixel(scene, i, plan)),
            Self::Passes(i) => i.session(scene, plan),
        }
    }
}

impl View {
    /// Starts a render of a scene that is solved already.
    pub fn session(self, scene: &Arc<Scene>, plan: Plan, solution: Arc<Solution>) -> Box<dyn Session> {
        Box::new(Tiles::prepared(Arc::clone(scene), OneByOne(self), plan, Some(solution)))
    }
}
