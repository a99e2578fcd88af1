//! The methods that work by passes, with their settings.

use super::{
    bidirectional::{Bidirectional, Strategy, Tracer},
    mlt::{Chains, Metropolis},
    photon_map::{Mapped, PhotonMap},
    radius::Radius,
    sppm::{Progressive, Sppm},
};
use crate::{Depth, Plan, Session};
use std::sync::Arc;
use steradian_core::{Scene, camera::Projection};
use steradian_engine::Passes;

/// What of a scene only `path` and `volpath` follow.
pub(crate) fn for_paths_alone(scene: &Scene) -> Option<&'static str> {
    let changed = "light that changes its wavelength (material 'fluorescent')";
    let what = scene.below_surfaces().or_else(|| scene.is_fluorescent().then_some(changed));
    if what.is_some() {
        return what;
    }
    scene.has_schedules().then_some("lights that go on and off (parameters 'on' and 'off')")
}

/// Names the light of so many shapes that methods that draw points of lights leave out.
pub fn left_to_chance(shapes: usize) -> String {
    let shapes = if shapes == 1 { "one shape".to_owned() } else { format!("{shapes} shapes") };
    format!("the light of {shapes} of which no point can be drawn, such as an infinite plane")
}

/// A method that works by passes, ready to run.
#[derive(Clone, Copy, Debug)]
pub enum PassKind {
    /// Light tracing, bidirectional path tracing, vertex connection and merging.
    Bidirectional(Bidirectional),
    /// Stochastic progressive photon mapping.
    Sppm(Sppm),
    /// Photon mapping.
    PhotonMap(PhotonMap),
    /// Metropolis light transport.
    Metropolis(Metropolis),
}

impl PassKind {
    /// Whether what pixels err depends on one another: they share photons or light paths, or chains visit one after the
    /// other. Between neighbours of a Cornell box, errors of `light` have a correlation of 0.3, and those of `bdpt`
    /// 0.04.
    pub fn correlates(&self) -> bool {
        !matches!(self, Self::Bidirectional(Bidirectional { strategy: Strategy::Connections, .. }))
    }

    /// By name.
    pub fn named(name: &str, depth: Depth) -> Option<Self> {
        // Where paths are connected too, narrower merging leaves less bias and no more noise.
        let radius = Radius::Pixels(0.6);
        let paths = |strategy| Self::Bidirectional(Bidirectional { depth, strategy, radius });
        Some(match name {
            "light" => paths(Strategy::Light),
            "bdpt" => paths(Strategy::Connections),
            "vcm" => paths(Strategy::Merging),
            "sppm" => Self::Sppm(Sppm { depth, radius: Radius::Pixels(3.0), photons: 0 }),
            "photon" => {
                Self::PhotonMap(PhotonMap { depth, radius: Radius::Pixels(1.0), photons: 0, nearest: 0, gather: true })
            }
            "pssmlt" => Self::Metropolis(Metropolis { depth, large_step: 0.3 }),
            _ => return None,
        })
    }

    /// Changes an option of the method; whether there is such an option and value.
    pub fn set(&mut self, key: &str, value: &str) -> bool {
        let length = || value.parse().ok().filter(|r: &f32| *r > 0.0 && r.is_finite());
        let radius = || Some(Radius::Fixed(length()?));
        let pixels = || Some(Radius::Pixels(length()?));
        let count = || value.parse::<u32>().ok();
        let done = match (self, key) {
            (Self::Bidirectional(b), "radius") if b.strategy == Strategy::Merging => radius().map(|r| b.radius = r),
            (Self::Bidirectional(b), "pixels") if b.strategy == Strategy::Merging => pixels().map(|r| b.radius = r),
            (Self::Sppm(s), "radius") => radius().map(|r| s.radius = r),
            (Self::Sppm(s), "pixels") => pixels().map(|r| s.radius = r),
            (Self::Sppm(s), "photons") => count().map(|n| s.photons = n),
            (Self::PhotonMap(p), "radius") => radius().map(|r| p.radius = r),
            (Self::PhotonMap(p), "pixels") => pixels().map(|r| p.radius = r),
            (Self::PhotonMap(p), "photons") => count().map(|n| p.photons = n),
            (Self::PhotonMap(p), "nearest") => count().map(|n| p.nearest = n),
            (Self::PhotonMap(p), "gather") => value.parse().ok().map(|g| p.gather = g),
            (Self::Metropolis(m), "large_step") => {
                value.parse().ok().filter(|p| *p > 0.0 && *p <= 1.0).map(|p| m.large_step = p)
            }
            _ => None,
        };
        done.is_some()
    }

    /// What of a scene is missing in its picture; `None` where nothing is.
    pub fn leaves_out(&self, scene: &Scene) -> Option<String> {
        let chance = scene.emitters_left_to_chance();
        let draws_lights = match self {
            Self::Bidirectional(m) => m.strategy == Strategy::Light,
            Self::Sppm(_) | Self::PhotonMap(_) => true,
            Self::Metropolis(_) => false,
        };
        let chance = (chance > 0 && draws_lights).then(|| left_to_chance(chance));
        let own = match self {
            Self::Bidirectional(m) => m.leaves_out(scene),
            _ => None,
        };
        own.into_iter().chain(chance).reduce(|a, b| format!("{a}, {b}"))
    }

    /// What of a scene it cannot do and refuses; `None` where there is a picture.
    pub fn cannot(&self, scene: &Scene) -> Option<String> {
        if scene.camera().motion.is_some() {
            return Some("a camera that moves".into());
        }
        if let Some(what) = for_paths_alone(scene) {
            return Some(what.into());
        }
        if matches!(scene.camera().projection, Projection::Realistic(_)) {
            return Some("a camera with a lens of several elements (realistic): what it sees has no inverse".into());
        }
        match self {
            Self::Bidirectional(m) => m.cannot(scene),
            Self::Sppm(m) => m.cannot(scene),
            Self::PhotonMap(m) => m.cannot(scene),
            Self::Metropolis(m) => m.cannot(scene),
        }
    }

    /// Where its mean differs from the true picture, by less the smaller its radius is: the same with a radius so many
    /// times as large.
    pub fn with_radius(&self, factor: f32) -> Option<Self> {
        let mut other = *self;
        match &mut other {
            Self::Bidirectional(b) if b.strategy == Strategy::Merging => b.radius = b.radius.times(factor),
            Self::Sppm(s) => s.radius = s.radius.times(factor),
            Self::PhotonMap(p) => p.radius = p.radius.times(factor),
            Self::Bidirectional(_) | Self::Metropolis(_) => return None,
        }
        Some(other)
    }

    /// A render with an empty film.
    pub fn session(&self, scene: Arc<Scene>, plan: Plan) -> Box<dyn Session> {
        match *self {
            Self::Bidirectional(m) => Box::new(Passes::new(scene, Tracer::new(m), plan)),
            Self::Sppm(m) => Box::new(Passes::new(scene, Progressive::new(m), plan)),
            Self::PhotonMap(m) => Box::new(Passes::new(scene, Mapped::new(m), plan)),
            Self::Metropolis(m) => Box::new(Passes::new(scene, Chains::new(m), plan)),
        }
    }
}
