//! Methods of rendering: their constructors by name, their limits, their sessions.

use crate::{Depth, Feature, Plan, Session, Support};
use std::{
    any::Any,
    fmt::{Debug, Display},
    sync::Arc,
};
use steradian_core::{ColorMode, Scene};
use steradian_request::{MethodRequest, Request};

/// Reason why a method renders no picture of a scene with these options.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct Refusal(pub String);

/// A kind of method, by its name in the schema.
#[derive(Clone, Copy, Debug)]
pub struct MethodKind {
    /// Name of its row in the schema.
    pub name: &'static str,
    /// Makes the method with the options of a request.
    pub new: fn(&Asked<'_>) -> Result<Arc<dyn Method>, Refusal>,
    /// Refuses options that exclude each other in every scene.
    pub check: fn(&MethodRequest) -> Result<(), Refusal>,
    /// Colour mode that suits it where the format of a scene has no say.
    pub mode: Option<ColorMode>,
}

impl MethodKind {
    /// A kind without a colour mode of its own, whose options go together.
    pub const fn new(name: &'static str, new: fn(&Asked<'_>) -> Result<Arc<dyn Method>, Refusal>) -> Self {
        Self { name, new, check: |_| Ok(()), mode: None }
    }
}

/// Inputs from which a method is made.
#[derive(Clone, Copy, Debug)]
pub struct Asked<'a> {
    /// The whole request.
    pub request: &'a Request,
    /// The method's options: those of the request over those of the scene.
    pub options: &'a MethodRequest,
    /// The scene.
    pub scene: &'a Scene,
}

impl Asked<'_> {
    /// Limits of paths: those of the request, else of the options, else of the scene.
    pub fn depth(&self) -> Depth {
        let settings = self.scene.settings();
        let given = |name| self.options.given(name).and_then(|v| v.number());
        // −1 is no limit.
        let of_options = given("max_depth").map(|d| if d < 0.0 { u32::MAX } else { d as u32 });
        Depth {
            max: self.request.max_depth.or(of_options).unwrap_or(settings.max_depth),
            roulette_after: given("rr_depth").map_or(settings.rr_depth, |d| d as u32),
            hide_emitters: self.hides_emitters(),
        }
    }

    /// True if lights are hidden from the camera. Methods without that option show them.
    pub fn hides_emitters(&self) -> bool {
        match self.options.given("hide_emitters") {
            Some(_) => self.options.flag("hide_emitters"),
            None => self.options.model().parameter("hide_emitters").is_some() && self.scene.settings().hide_emitters,
        }
    }

    /// Random seed.
    pub fn seed(&self) -> u64 {
        self.request.seed.unwrap_or(self.scene.settings().seed)
    }
}

/// Paths from the camera that a method follows.
#[derive(Clone, Copy, Debug)]
pub struct CameraPaths {
    /// Their limits.
    pub depth: Depth,
    /// True if media scatter and absorb them.
    pub media: bool,
    /// True for scalar radiance at one moment, which single paths can be traced of (`steradian path`).
    pub is_plain: bool,
}

/// A method of rendering with its options.
pub trait Method: Any + Debug + Send + Sync {
    /// Support of a feature.
    fn supports(&self, feature: Feature) -> Support;

    /// Limits of the method on a scene.
    fn limits(&self, scene: &Scene) -> Vec<Limit> {
        Limit::of(self, scene)
    }

    /// Starts with an empty film.
    ///
    /// # Errors
    /// [`Refusal`] of scenes that are too large, or that have nothing to begin with.
    fn session(&self, scene: Arc<Scene>, plan: Plan) -> Result<Box<dyn Session>, Refusal>;

    /// Samples per pixel without a request, by those of the scene.
    fn default_spp(&self, of_scene: u32) -> u32 {
        of_scene
    }

    /// Number of time bins of a transient render; 0 for pictures of all light.
    fn bins(&self) -> u32 {
        0
    }

    /// The paths that the method follows from the camera without a guide by photons; `None` for methods that start at
    /// lights, or that are not after all light.
    fn camera_paths(&self) -> Option<CameraPaths> {
        None
    }

    /// A biased method with about half of its bias, and with twice that; `None` for methods without a radius or
    /// patches.
    fn bias_pair(&self) -> Option<[Arc<dyn Method>; 2]> {
        None
    }
}

/// A limit of a method on a scene: a feature that the scene has and the method does not render as it is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Limit {
    /// The feature as the scene has it, with the reason.
    pub what: String,
    /// The method's answer.
    pub support: Support,
}

impl Limit {
    /// A limit with a feature's description and the answer to it.
    pub fn new(feature: impl Display, support: Support) -> Self {
        let what = match support.reason() {
            "" => feature.to_string(),
            reason => format!("{feature}: {reason}"),
        };
        Self { what, support }
    }

    /// All limits of a method on a scene by [`Method::supports`]. Features that it renders are not looked for.
    pub fn of(method: &(impl Method + ?Sized), scene: &Scene) -> Vec<Self> {
        let limit = |feature: Feature| {
            let support = method.supports(feature);
            let found = (support != Support::Exact).then(|| feature.found(scene)).flatten();
            found.map(|what| Self::new(what, support))
        };
        Feature::OF_SCENES.into_iter().filter_map(limit).collect()
    }

    /// True if there is no picture.
    pub fn refuses(&self) -> bool {
        matches!(self.support, Support::Refuses(_))
    }
}

/// A scene with what stands in for subsurface and wavelength-shifting materials, for methods that do not follow light
/// there.
pub fn local_scene(scene: Arc<Scene>) -> Arc<Scene> {
    match scene.needs_scalar_path_tracer() {
        true => Arc::new(Scene::clone(&scene).with_local_scattering()),
        false => scene,
    }
}
